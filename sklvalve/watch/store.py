# SPDX-License-Identifier: BSD-3-Clause
"""The state of a watch on disk: files that other tools read, each written whole or not at all.

    STATE/watch.json                                 schema and name of the plant
    STATE/days/valve=TAG/2026-01-31.parquet          sizes of all effects on that day
    STATE/histories/TAG/first.history.skops          what the valve is held against; one for each inspection
    STATE/histories/TAG/first.days.json              days it was learnt on, and those of reference
    STATE/reports/TAG/2026-01-31/                    diagnosis.zip and report.html of a diagnosis
    STATE/calls/TAG.json, STATE/inspections/TAG.json
    STATE/findings.parquet, STATE/trends.parquet     made from the others at the end of a run

A day's file depends on the day's rows and the history alone, so that days may be made in any order, and made
again to the same bytes after a run was killed.
"""

from __future__ import annotations

import datetime as dt
import json
import os
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sklvalve._locking import held
from sklvalve._replacing import replacing
from sklvalve.history import ValveHistory
from sklvalve.mismatch import load_history, save_history
from sklvalve.recording.errors import InputError, shown
from sklvalve.watch.record import DayRecord, Epoch, Finding, Inspection

if TYPE_CHECKING:
    import pyarrow as pa

SCHEMA = "sklvalve.watch/1"
#: Columns of the table of trends.
TRENDS = ("valve", "day", "rows", "mend", "evidence", "cusum")
_META = "sklvalve"
_FORGOTTEN = 3600.0  # seconds


class Store:
    """State of a watch.

    Parameters
    ----------
    folder : path-like
        Made if it is not there.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)

    def prepare(self, name: str) -> None:
        """Make the folder, or see that it is the state of such a watch.

        Raises
        ------
        InputError
            If it holds something else, or the state of another version.
        """
        mark = self.folder / "watch.json"
        if self.folder.is_dir() and not mark.exists() and any(self.folder.iterdir()):
            raise InputError(f"--state {self.folder}: this folder holds other files; name an empty one")
        if self.folder.exists() and not self.folder.is_dir():
            raise InputError(f"--state {self.folder}: this is a file; name a folder")
        if not mark.exists():
            _write(mark, _json({"schema": SCHEMA, "plant": name}))
            return
        schema = _read_json(mark).get("schema")
        if schema != SCHEMA:
            raise InputError(
                f"--state {self.folder}: it is of schema {shown(schema)}, and this version keeps {SCHEMA}; "
                "begin with a new folder"
            )

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Hold the state against other runs.

        Raises
        ------
        InputError
            If another run holds it.
        """
        with held(self.folder) as ours:
            if not ours:
                raise InputError(f"--state {self.folder}: another watch runs on it; wait until it has ended")
            self._sweep()
            yield

    def save_day(self, tag: str, record: DayRecord) -> None:
        """Keep a day."""
        import pyarrow as pa

        score = record.score
        rows = [("share", key, s.size, s.deviation) for key, s in sorted(score.shares.items())]
        rows += [("left", channel, value, 0.0) for channel, value in sorted(score.left.items())]
        columns = list(zip(*rows, strict=True)) or [(), (), (), ()]
        table = pa.table(
            {
                "day": pa.array([record.day] * len(rows), pa.date32()),
                "quantity": pa.array(columns[0], pa.string()),
                "key": pa.array(columns[1], pa.string()),
                "size": pa.array(columns[2], pa.float64()),
                "deviation": pa.array(columns[3], pa.float64()),
            }
        )
        note = json.dumps(record.to_dict(), separators=(",", ":"), sort_keys=True)
        _write_table(self._day(tag, record.day), table, note)

    def days(self, tag: str) -> list[DayRecord]:
        """All days of a valve that are kept, in their order."""
        import pyarrow.parquet as pq

        files = sorted((self.folder / "days" / f"valve={tag}").glob("*.parquet"))
        return [
            DayRecord.from_dict(json.loads(pq.read_metadata(file).metadata[_META.encode()])) for file in files
        ]

    def newest(self, tag: str) -> dt.date | None:
        """Last day of a valve that is kept; None where none is."""
        days = [file.stem for file in (self.folder / "days" / f"valve={tag}").glob("*.parquet")]
        return dt.date.fromisoformat(max(days)) if days else None

    def has_history(self, tag: str, epoch: Epoch) -> bool:
        """Whether a valve was learnt for the time since an inspection."""
        return self._history(tag, epoch).exists()

    def history(self, tag: str, epoch: Epoch) -> ValveHistory:
        """What was learnt of a valve for the time since an inspection."""
        return load_history(self._history(tag, epoch))

    def reference(self, tag: str, epoch: Epoch) -> list[dt.date]:
        """Sound days that later ones are compared with; none before the valve is learnt."""
        kept = _read_list(self._reference(tag, epoch))
        return [dt.date.fromisoformat(each["day"]) for each in kept if each["use"] == "reference"]

    def save_history(
        self,
        tag: str,
        epoch: Epoch,
        history: ValveHistory,
        learnt: Iterable[dt.date],
        reference: Iterable[dt.date],
    ) -> None:
        """Keep what was learnt of a valve on some days, and the days that later ones are compared with."""
        uses = [(day, "learnt") for day in learnt] + [(day, "reference") for day in reference]
        # first these: what has a history has its reference
        _write(
            self._reference(tag, epoch), _json([{"day": day.isoformat(), "use": use} for day, use in uses])
        )
        save_history(self._history(tag, epoch), history)

    def reports(self, tag: str, day: dt.date) -> Path:
        """Folder of a call's full report."""
        return self.folder / "reports" / tag / day.isoformat()

    def findings(self, tag: str) -> list[Finding]:
        """Calls of a valve, in their order."""
        made = _read_list(self.folder / "calls" / f"{tag}.json")
        # candidates that a diagnosis left open were once kept as names
        named = [tuple(each["names"]) if each["verdict"] == "named" else () for each in made]
        return [Finding(**(each | {"names": names})) for each, names in zip(made, named, strict=True)]

    def _sweep(self) -> None:
        """Remove drafts of runs that were killed long ago; a run that goes on has none so old."""
        for draft in self.folder.rglob(".*.????????"):
            with suppress(OSError):
                if time.time() - draft.stat().st_mtime > _FORGOTTEN:
                    draft.unlink()

    def save_finding(self, finding: Finding) -> None:
        """Keep a call for attention beside those before, unless it is there.

        A process of a run that was killed may go on for a while, and find the same.
        """
        kept = self.findings(finding.valve)
        if any((each.since, each.called) == (finding.since, finding.called) for each in kept):
            return
        file = self.folder / "calls" / f"{finding.valve}.json"
        _write(file, _json([*map(asdict, kept), asdict(finding)]))

    def inspections(self, tag: str) -> list[Inspection]:
        """Inspections of a valve, in the order of their days."""
        made = [Inspection(**each) for each in _read_list(self.folder / "inspections" / f"{tag}.json")]
        return sorted(made, key=lambda each: each.day)

    def save_inspection(self, inspection: Inspection) -> None:
        """Keep an inspection; another one of the same day is replaced."""
        others = [each for each in self.inspections(inspection.valve) if each.day != inspection.day]
        kept = sorted([*others, inspection], key=lambda each: each.day)
        _write(self.folder / "inspections" / f"{inspection.valve}.json", _json([*map(asdict, kept)]))

    def write_tables(self, findings: Iterable[dict[str, Any]], trends: Sequence[pa.Table]) -> None:
        """Write the tables of all valves' findings and trends, the latter from a table of each valve."""
        import pyarrow as pa

        made = list(findings)
        names = list(Finding.__dataclass_fields__)
        columns: dict[str, list[Any]] = {name: [each[name] for each in made] for name in names}
        columns["names"] = [" + ".join(each) for each in columns["names"]]
        schema = pa.schema([(n, pa.float64() if n in ("evidence", "limit") else pa.string()) for n in names])
        _write_table(self.folder / "findings.parquet", pa.table(columns, schema), SCHEMA)
        _write_table(self.folder / "trends.parquet", pa.concat_tables([trends_table(()), *trends]), SCHEMA)

    def _day(self, tag: str, day: dt.date) -> Path:
        return self.folder / "days" / f"valve={tag}" / f"{day}.parquet"

    def _history(self, tag: str, epoch: Epoch) -> Path:
        return self.folder / "histories" / tag / f"{epoch.label}.history.skops"

    def _reference(self, tag: str, epoch: Epoch) -> Path:
        return self.folder / "histories" / tag / f"{epoch.label}.days.json"


def trends_table(rows: Iterable[tuple]) -> pa.Table:
    """Rows of the table of trends: valve, day, number of rows, what is to be mended, evidence, CUSUM."""
    import pyarrow as pa

    kinds = (pa.string(), pa.date32(), pa.int64(), pa.string(), pa.float64(), pa.float64())
    columns = list(zip(*rows, strict=True)) or [()] * len(TRENDS)
    arrays = [pa.array(column, kind) for column, kind in zip(columns, kinds, strict=True)]
    return pa.table(arrays, names=list(TRENDS))


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, sort_keys=True) + "\n"


def _read_json(file: Path) -> Any:
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except ValueError:
        raise InputError(f"{file}: this is no JSON; remove it, or restore it from a copy") from None


def _read_list(file: Path) -> list[dict[str, Any]]:
    return _read_json(file) if file.exists() else []


def _write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with replacing(file) as draft:
        draft.write_text(text, encoding="utf-8")


def _write_table(file: Path, table: pa.Table, note: str) -> None:
    import pyarrow.parquet as pq

    file.parent.mkdir(parents=True, exist_ok=True)
    # without Arrow's own copy of the schema, which holds the note once more
    with (
        replacing(file) as draft,
        pq.ParquetWriter(draft, table.schema, compression="zstd", store_schema=False) as writer,
    ):
        writer.write_table(table)
        writer.add_key_value_metadata({_META: note})
