# SPDX-License-Identifier: BSD-3-Clause
"""Whole exports of each kind become the course that was written into them."""

import gzip
import json

import numpy as np
import pytest

from sklvalve.recording.historian import ImportSettings, import_export
from tests.recording.historian.exports import course, iso, local, long_text, moments, wide_text


@pytest.fixture
def made(tmp_path):
    """Import texts, or bytes, as the files of one export."""

    def run(*contents, **settings):
        paths = []
        for number, content in enumerate(contents):
            path = tmp_path / f"export{number}.csv"
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
            paths.append(path)
        return import_export(paths, ImportSettings(**settings))

    return run


TIMES = moments("2024-06-28 10:00:00", 120, 5)
VALUES = course(120)
PLAIN = wide_text(["FIC1.PV", "FIC1.OP"], iso(TIMES), [VALUES, VALUES + 30.0])


def _is_the_course(imported, name="FIC1.PV"):
    np.testing.assert_allclose(imported.columns[name], VALUES, atol=1e-9)
    assert imported.account["base"]["period"] == 5.0
    assert len(imported.stamps) == 120


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp1252"]
)
def test_any_encoding(made, encoding):
    text = PLAIN.replace("FIC1.PV", "Durchfluß °")
    _is_the_course(made(text.encode(encoding)), "Durchfluß °")


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("separator", [",", ";", "\t", "|"])
def test_any_separator_and_line_end(made, separator, ending):
    _is_the_course(made(PLAIN.replace(",", separator).replace("\n", ending)))


def test_packed_file(made):
    _is_the_course(made(gzip.compress(PLAIN.encode())))


def test_separator_that_the_file_names(made):
    _is_the_course(made("sep=;\n" + PLAIN.replace(",", ";")))


@pytest.mark.parametrize(
    "form",
    [
        "%Y-%m-%dT%H:%M:%S",
        "%Y/%m/%d %H:%M:%S",
        "%d.%m.%Y %H:%M:%S",
        "%d/%m/%Y %H:%M:%S",
        "%m/%d/%Y %I:%M:%S %p",
        "%d-%b-%y %H:%M:%S",
        "%d-%b-%Y %H:%M:%S.000",
        "%Y%m%d %H%M%S",
        "%Y%m%d%H%M%S",
    ],
)
def test_any_form_of_local_time(made, form):
    imported = made(wide_text(["FIC1.PV"], [f"{time:{form}}" for time in TIMES], [VALUES]))
    _is_the_course(imported)
    assert imported.stamps[0] == "2024-06-28T10:00:00"


@pytest.mark.parametrize(("ending", "first"), [("Z", "Z"), ("+02:00", "+02:00"), (" CEST", "+02:00")])
def test_times_with_an_offset_keep_it(made, ending, first):
    imported = made(wide_text(["FIC1.PV"], [stamp + ending for stamp in iso(TIMES)], [VALUES]))
    _is_the_course(imported)
    assert imported.stamps[0] == f"2024-06-28T10:00:00{first}"


def test_counted_times(made):
    seconds = wide_text(["FIC1.PV"], [f"{5.0 * row:.1f}" for row in range(120)], [VALUES])
    imported = made(seconds)
    _is_the_course(imported)
    assert imported.stamps[:2].tolist() == [0.0, 5.0]
    unix = made(wide_text(["FIC1.PV"], [f"{time.timestamp() * 1000:.0f}" for time in TIMES], [VALUES]))
    assert unix.stamps[0] == "2024-06-28T10:00:00Z"
    serial = [f"{45471 + (10 * 3600 + 5 * row) / 86400:.11f}" for row in range(120)]
    assert made(wide_text(["FIC1.PV"], serial, [VALUES])).stamps[-1] == "2024-06-28T10:09:55"
    minutes = seconds.replace("time", "time [min]")
    assert made(minutes).account["base"]["period"] == 300.0


def test_long_format_with_decimal_commas(made):
    imported = made(long_text(["FIC1.PV", "FIC1.OP"], local(TIMES), VALUES), zone="Europe/Warsaw")
    _is_the_course(imported)
    _is_the_course(imported, "FIC1.OP")
    assert imported.stamps[0] == "2024-06-28T12:00:00+02:00"
    methods = {tag: each["method"] for tag, each in imported.account["tags"].items()}
    assert methods == {"FIC1.PV": "linear", "FIC1.OP": "held"}


@pytest.mark.parametrize(
    "header",
    [
        "Messstelle;Zeitstempel;Wert;Status",
        "Znacznik;Czas;Wartość;Jakość",
        "Repère;Horodatage;Valeur;Qualité",
        "Etiqueta;Fecha;Valor;Calidad",
        "TagName;DateTime;Value;OPCQuality",
    ],
)
def test_long_format_in_other_languages(made, header):
    _is_the_course(made(long_text(["FIC1.PV"], local(TIMES), VALUES, header=header)))


def test_long_format_without_a_header(made):
    text = long_text(["FIC1.PV", "FIC1.OP"], iso(TIMES), VALUES, comma=False)
    _is_the_course(made(text.split("\n", 1)[1]))


def test_newest_first(made):
    header, *rows = PLAIN.splitlines()
    imported = made("\n".join([header, *rows[::-1]]))
    _is_the_course(imported)
    assert imported.account["tags"]["FIC1.PV"]["out_of_order"] == 0


def test_date_and_time_of_day_in_two_columns(made):
    text = PLAIN.replace("time,", "Date,Time,").replace("2024-06-28 ", "28.06.2024,")
    _is_the_course(made(text))


def test_columns_with_times_of_their_own(made):
    late = moments("2024-06-28 10:00:01", 120, 5)
    rows = ["FIC1.PV Time;FIC1.PV ValueY;FIC1.OP Time;FIC1.OP ValueY"]
    rows += [
        f"{one};{value:.2f};{other};{value:.2f}"
        for one, other, value in zip(iso(TIMES), iso(late), VALUES, strict=True)
    ]
    imported = made("\n".join(rows), linear=("FIC1.OP",))
    np.testing.assert_allclose(imported.columns["FIC1.PV"], VALUES, atol=1e-9)
    between = VALUES[:-1] + 0.8 * np.diff(VALUES)
    np.testing.assert_allclose(imported.columns["FIC1.OP"][1:], between, atol=1e-9)


def test_one_file_for_each_tag_is_named_by_the_file(made):
    one, other = (wide_text(["value"], iso(TIMES), [VALUES + shift]) for shift in (0.0, 7.0))
    imported = made(one, other)
    np.testing.assert_allclose(imported.columns["export1"] - imported.columns["export0"], 7.0)


def test_units_in_brackets_in_a_row_and_in_a_column(made):
    text = wide_text(["F [m³/h]", "P (bar(g))", "X_pct"], iso(TIMES), [VALUES, VALUES, VALUES])
    assert list(made(text).columns) == ["F [m3/h]", "P [bar(g)]", "X [%]"]
    header, rest = wide_text(["F", "P", "Z"], iso(TIMES), [VALUES] * 3).split("\n", 1)
    imported = made(f"Export of plant 7\n\n{header}\n,m3/h,[barg],%\n,flow,pressure,travel\n{rest}")
    assert list(imported.columns) == ["F [m3/h]", "P [bar(g)]", "Z [%]"]
    assert imported.account["files"][0]["lines_above"] == 1
    united = long_text(["F"], iso(TIMES), VALUES, header="tag;time;value;units", quality="t/h")
    assert list(made(united).columns) == ["F [t/h]"]
    behind = wide_text(["F"], iso(TIMES), [[f"{value:.2f} kPa" for value in VALUES]])
    np.testing.assert_allclose(made(behind).columns["F [kPa]"], VALUES)


def test_lines_that_are_no_rows_are_skipped_and_told(made):
    imported = made(PLAIN + "-- end of export --\n\n(120 rows affected)\n")
    _is_the_course(imported)
    assert imported.account["files"][0]["lines_skipped"] == 2


def test_files_of_one_export_are_joined_whatever_their_order(made):
    header, *rows = PLAIN.splitlines()
    halves = ["\n".join([header, *part]) for part in (rows[55:], rows[:60])]
    imported = made(*halves)
    _is_the_course(imported)
    assert imported.account["tags"]["FIC1.PV"]["doubled"] == 5
    assert imported.account["tags"]["FIC1.PV"]["contradicting"] == 0


def test_states_are_left_out_and_told(made):
    modes = long_text(["FIC1.MODE"], iso(TIMES), ["AUTO", "MAN"] * 60)
    imported = made(long_text(["FIC1.PV"], iso(TIMES), VALUES) + modes.split("\n", 1)[1])
    assert list(imported.columns) == ["FIC1.PV"]
    assert imported.account["left_out"] == {"FIC1.MODE": "holds states (AUTO, MAN), no numbers"}


def test_long_silence_of_all_has_no_rows_a_short_one_empty_rows(made):
    kept = [*range(40), *range(60, 80), *range(110, 120)]
    times = moments("2024-06-28 10:00:00", 800, 5)
    stamps = [iso(times)[row] for row in kept] + iso(times)[790:]
    imported = made(wide_text(["FIC1.PV"], stamps, [course(len(stamps))]))
    assert imported.account["base"]["rows_without_any_value"] == 670
    assert np.isnan(imported.columns["FIC1.PV"]).sum() == 20 + 30
    assert len(imported.stamps) == 130


def test_account_is_plain_data_and_counts_add_up(made):
    account = made(PLAIN).account
    assert json.loads(json.dumps(account, allow_nan=False)) == account
    for each in account["tags"].values():
        assert sum(each[key] for key in ("exact", "resampled", "filled", "missing")) == 120


def test_period_as_asked(made):
    imported = made(PLAIN, period=10.0)
    np.testing.assert_allclose(imported.columns["FIC1.PV"], VALUES[::2])
    assert imported.account["tags"]["FIC1.PV"]["unused"] == 60
