# SPDX-License-Identifier: BSD-3-Clause
"""The day files of the Lublin sugar factory: from a folder, or from the page of the benchmark."""

import hashlib
import os
import secrets
import shutil
import zipfile
from contextlib import contextmanager
from dataclasses import dataclass
from http.client import HTTPException
from pathlib import Path
from urllib.request import Request, urlopen

from sklvalve.damadics.days import day_of, file_of, iso_day

PAGE = "https://iair.mchtr.pw.edu.pl/Damadics"
_SERVER, _TIMEOUT = "https://iair.mchtr.pw.edu.pl/content/download", 60.0
# days on which there are recordings
_MANY = 25


@dataclass(frozen=True)
class Archive:
    """One of the archives of the benchmark's page.

    Attributes
    ----------
    part : int
    place : str
        Of the download on the server.
    sha256 : str
    days : frozenset of str
        Those of its days that are known beforehand; there are more.
    """

    part: int
    place: str
    sha256: str
    days: frozenset[str]

    @property
    def name(self):
        """Of its file."""
        return f"Lublin_all_data_part{self.part}.zip"

    @property
    def url(self):
        """Where it is downloaded."""
        return f"{_SERVER}/{self.place}/file/{self.name}"


ARCHIVES = (
    Archive(
        1,
        "163/817",
        "4fea6d279b1077bc51a15a21170144125e9e973214de57b1f8b622e16ba774a3",
        frozenset({"2001-11-01"}),
    ),
    Archive(
        2,
        "164/821",
        "5e23c3b0e5adcb50541704024846d54f33bc374e1fd36f50b1043a663dfba803",
        frozenset({"2001-11-09"}),
    ),
    Archive(
        3,
        "165/825",
        "2e961f290e3a7fdd3ebf3e2688af207cd1affef065aae13e3fb68755f7ee9628",
        frozenset({"2001-11-17", "2001-11-20"}),
    ),
    Archive(
        4,
        "166/829",
        "d8a61f82c3b66df5f566bc8c78060db678cc886ab94f4059bab5de3b68784cf2",
        frozenset({"2001-10-30"}),
    ),
)
#: Checksums of the four days with faults.
DAYS = {
    "2001-10-30": "75706a15cff60b132ae7fd291ce08a06bb0ef0df6ed65a15cb05fe18889363d1",
    "2001-11-09": "b3af2f899fe23c2826a0821fd9024a9dcc6c1a7f99e2191b752bb6b4a218d488",
    "2001-11-17": "2744046eedf781c157f0bc02db96be2b3651063112d04d2e80f56260594b1538",
    "2001-11-20": "8ce1310dcfb8f4907aecc2414dc8dbd013b382cf9fc08e45b2e740b74f9fec79",
}


def fetch_lublin(data_home=None, days=None, *, download_if_missing=True):
    """Day files of the Lublin sugar factory, downloaded where they are not there yet.

    Parameters
    ----------
    data_home : str or path, default=None
        Folder of the day files, itself or its Lublin_all_data; or of the four archives as the benchmark's
        page gives them, Lublin_all_data_part1.zip and so on. What is missing is written there. None:
        sklvalve_data/lublin in the user's home.
    days : str, datetime.date or a sequence of them, default=None
        Dates, in ISO 8601, or as the files are named: ``"09112001"``. None: all 25, about 90 MB to download.
    download_if_missing : bool, default=True
        Otherwise the internet is left alone.

    Returns
    -------
    files : dict of str to Path
        By day in ISO 8601, in their order; for `read_lublin`.

    Raises
    ------
    FileNotFoundError
        If files are missing that may not be downloaded.
    ConnectionError
        If a download fails.
    OSError
        If a checksum is not what it should be, or nothing can be written.
    ValueError
        If a day is none of the recordings' period, or has no recording.

    Notes
    -----
    Downloads come from https://iair.mchtr.pw.edu.pl/Damadics. SHA-256 checksums, as users of the data have
    published them, are known of the four archives and of the four days with faults (see `LUBLIN_EVENTS`); any
    other day file that lies in the folder already is taken as it is. Which days an archive holds is known of
    a few only, so that for other days all archives may be downloaded, one after the other. They stay in the
    folder, and may be deleted. No licence is stated for the data.

    Examples
    --------
    >>> from sklvalve.damadics import fetch_lublin, read_lublin
    >>> files = fetch_lublin(days="2001-11-09")  # doctest: +SKIP
    >>> day = read_lublin(files["2001-11-09"], actuator=3)  # doctest: +SKIP
    """
    folder = Path.home() / "sklvalve_data" / "lublin" if data_home is None else Path(data_home).expanduser()
    wanted = None if days is None else _wanted(days)
    there = _there(folder)
    for archive in sorted(ARCHIVES, key=lambda one: not one.days & (wanted or set())):
        if _enough(there, wanted):
            break
        if download_if_missing or (folder / archive.name).is_file():
            _unpack(_archive(folder, archive), folder, wanted)
            there = _there(folder)
    if not _enough(there, wanted) and not (download_if_missing and wanted is None):
        raise _missing(folder, there, wanted, download_if_missing)
    found = {day: path for day, path in sorted(there.items()) if wanted is None or day in wanted}
    for day, path in found.items():
        _require_day(path, day, f"{path}: delete it and fetch it again")
    return found


def _wanted(days):
    several = [days] if isinstance(days, str) or not hasattr(days, "__iter__") else days
    return {iso_day(day) for day in several}


def _there(folder):
    """Day files of a folder by day."""
    paths = [*folder.glob("Lublin_all_data/*.txt"), *folder.glob("*.txt")]
    return {day: path for path in paths if (day := day_of(path.name))}


def _enough(there, wanted):
    return len(there) >= _MANY if wanted is None else wanted <= there.keys()


def _missing(folder, there, wanted, asked):
    if asked:
        lacking = ", ".join(sorted(wanted - there.keys()))
        return ValueError(f"There is no recording of {lacking}; no archive of the benchmark's page has it.")
    what = f"{_MANY} day files" if wanted is None else ", ".join(map(file_of, sorted(wanted - there.keys())))
    return FileNotFoundError(
        f"Expected {what} in {str(folder)!r}, which has {len(there)} day files; name the folder that holds "
        "them, or let them be downloaded with download_if_missing=True."
    )


def _archive(folder, archive):
    """Path of an archive, which is downloaded where it is not there."""
    path = folder / archive.name
    if path.is_file():
        _require_checksum(path, archive.sha256, f"{path}: delete it and fetch it again")
        return path
    with _draft(path) as draft:
        try:
            _download(archive.url, draft)
        except (OSError, HTTPException) as error:
            raise ConnectionError(
                f"{archive.url} cannot be downloaded ({error}); try again with a connection, or get the "
                f"archives of {PAGE} yourself and name their folder as data_home."
            ) from None
        _require_checksum(draft, archive.sha256, f"{archive.url}: fetch it again, or see {PAGE}")
    return path


def _download(url, path):
    with (
        urlopen(Request(url, headers={"User-Agent": "sklvalve"}), timeout=_TIMEOUT) as answer,
        path.open("wb") as file,
    ):
        shutil.copyfileobj(answer, file)


def _unpack(path, folder, wanted):
    """Write those days of an archive that are wanted and not there."""
    there = _there(folder)
    with zipfile.ZipFile(path) as archive:
        for member in archive.infolist():
            # the name alone, so that nothing is written elsewhere
            day = day_of(Path(member.filename).name)
            if day is None or day in there or not (wanted is None or day in wanted):
                continue
            with _draft(folder / file_of(day)) as draft:
                with archive.open(member) as packed, draft.open("wb") as file:
                    shutil.copyfileobj(packed, file)
                _require_day(draft, day, f"{member.filename} in {path}: fetch the archive again")


def _require_day(path, day, mend):
    if day in DAYS:
        _require_checksum(path, DAYS[day], mend)


def _require_checksum(path, sha256, mend):
    with path.open("rb") as file:
        found = hashlib.file_digest(file, "sha256").hexdigest()
    if found != sha256:
        raise OSError(f"Expected the SHA-256 checksum {sha256}, got {found}, of {mend}.")


@contextmanager
def _draft(target):
    """A path to write to, which becomes the target once all is written."""
    draft = target.with_name(f".{target.name}.{secrets.token_hex(4)}")
    try:
        draft.parent.mkdir(parents=True, exist_ok=True)
        # a folder that cannot be written is told before anything is downloaded
        draft.touch()
    except OSError as error:
        raise OSError(
            f"{target.name} cannot be written to {str(target.parent)!r} ({error.strerror}); name a folder "
            "that can be, as data_home."
        ) from None
    try:
        yield draft
        os.replace(draft, target)
    finally:
        draft.unlink(missing_ok=True)
