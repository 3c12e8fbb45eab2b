# SPDX-License-Identifier: BSD-3-Clause
"""Day files from a folder, or from a stand-in of the benchmark's page; nothing here uses a network."""

import hashlib
import zipfile
from http.client import IncompleteRead
from urllib.error import URLError

import pytest

from sklvalve.damadics import LUBLIN_EVENTS, fetch_lublin, fetching
from sklvalve.damadics.days import file_of

PARTS = {
    1: ["2001-11-01", "2001-11-02"],
    2: ["2001-11-09", "2001-11-10"],
    3: ["2001-11-17", "2001-11-20"],
    4: ["2001-10-30"],
}
DAYS = sorted(day for days in PARTS.values() for day in days)
WITH_FAULTS = {event.day for event in LUBLIN_EVENTS}


def content(day):
    return f"day {day}\n".encode()


def write_archive(path, days, folder="Lublin_all_data"):
    with zipfile.ZipFile(path, "w") as archive:
        for day in days:
            archive.writestr(zipfile.ZipInfo(f"{folder}/{file_of(day)}"), content(day))
        archive.writestr(zipfile.ZipInfo(f"{folder}/readme.txt"), b"not a day")
    return path


class Page:
    """Stands in for the benchmark's page: what is asked of it, and what it answers."""

    def __init__(self, folder):
        self.asked, self.error = [], None
        self.files = {
            part: write_archive(folder / f"served{part}.zip", days).read_bytes()
            for part, days in PARTS.items()
        }

    def download(self, url, path):
        part = int(url.removesuffix(".zip")[-1])
        self.asked.append(part)
        path.write_bytes(self.files[part] if self.error is None else self.files[part][:10])
        if self.error is not None:
            raise self.error


@pytest.fixture
def page(tmp_path_factory, monkeypatch):
    made = Page(tmp_path_factory.mktemp("page"))
    monkeypatch.setattr(fetching, "_download", made.download)
    archives = tuple(
        fetching.Archive(one.part, one.place, hashlib.sha256(made.files[one.part]).hexdigest(), one.days)
        for one in fetching.ARCHIVES
    )
    monkeypatch.setattr(fetching, "ARCHIVES", archives)
    checksums = {day: hashlib.sha256(content(day)).hexdigest() for day in fetching.DAYS}
    monkeypatch.setattr(fetching, "DAYS", checksums)
    return made


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_all_days(page, tmp_path):
    folder = tmp_path / "new" / "folder"
    files = fetch_lublin(folder)
    assert list(files) == DAYS
    assert sorted(page.asked) == [1, 2, 3, 4]
    assert all(path == folder / file_of(day) for day, path in files.items())
    assert all(path.read_bytes() == content(day) for day, path in files.items())
    # nothing else, and no draft, is left
    archives = [f"Lublin_all_data_part{part}.zip" for part in PARTS]
    assert names(folder) == sorted([*archives, *map(file_of, DAYS)])
    # the archives are there now
    assert fetch_lublin(folder) == files
    assert len(page.asked) == 4


@pytest.mark.parametrize(
    ("days", "parts"),
    [
        ("2001-11-09", [2]),
        ("30102001", [4]),
        (["2001-11-20", "2001-11-17"], [3]),
        (["2001-10-30", "2001-11-01"], [1, 4]),
        # in which archive these are is not known beforehand
        ("2001-11-02", [1]),
        ("2001-11-10", [1, 2]),
    ],
)
def test_no_more_is_downloaded_than_the_days_need(page, tmp_path, days, parts):
    files = fetch_lublin(tmp_path, days)
    assert page.asked == parts
    assert len(files) == len(days if isinstance(days, list) else [days])
    assert sorted(path.name for path in files.values()) == names(tmp_path)[: len(files)]
    fetch_lublin(tmp_path, days, download_if_missing=False)
    assert page.asked == parts


def test_a_folder_that_holds_the_day_files(page, tmp_path):
    inner = tmp_path / "Lublin_all_data"
    inner.mkdir()
    (inner / "09112001.txt").write_bytes(content("2001-11-09"))
    (tmp_path / "10112001.txt").write_bytes(b"of which no checksum is known")
    files = fetch_lublin(str(tmp_path), ["2001-11-10", "2001-11-09"])
    assert list(files.values()) == [inner / "09112001.txt", tmp_path / "10112001.txt"]
    assert page.asked == []
    # what is there is not written again
    fetch_lublin(tmp_path)
    assert files["2001-11-10"].read_bytes() == b"of which no checksum is known"
    assert not (tmp_path / "09112001.txt").exists()


def test_a_folder_that_holds_all_days_needs_no_archive(page, tmp_path):
    days = [f"2001-10-{day}" for day in (29, 30, 31)] + [f"2001-11-{day:02d}" for day in range(1, 23)]
    for day in days:
        (tmp_path / file_of(day)).write_bytes(content(day))
    assert list(fetch_lublin(tmp_path)) == days
    assert page.asked == []


def test_a_folder_that_holds_the_archives(page, tmp_path):
    for part, days in PARTS.items():
        write_archive(tmp_path / f"Lublin_all_data_part{part}.zip", days)
    files = fetch_lublin(tmp_path, "2001-11-09", download_if_missing=False)
    assert files == {"2001-11-09": tmp_path / "09112001.txt"}
    # only what was asked for is unpacked
    assert [name for name in names(tmp_path) if name.endswith(".txt")] == ["09112001.txt"]
    assert page.asked == []


def test_without_a_download_what_is_missing_is_told(page, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"Expected 09112001\.txt in .* which has 0 day files; name"):
        fetch_lublin(tmp_path / "none", "2001-11-09", download_if_missing=False)
    (tmp_path / "10112001.txt").write_bytes(b"")
    with pytest.raises(FileNotFoundError, match=r"Expected 25 day files in .* which has 1 day files"):
        fetch_lublin(tmp_path, download_if_missing=False)
    assert page.asked == []
    assert names(tmp_path) == ["10112001.txt"]


@pytest.mark.parametrize(
    "error", [URLError("no route to host"), TimeoutError("timed out"), IncompleteRead(b"")]
)
def test_offline(page, tmp_path, error):
    page.error = error
    with pytest.raises(ConnectionError, match=r"part2\.zip cannot be downloaded .*as data_home\.") as told:
        fetch_lublin(tmp_path, "2001-11-09")
    assert "https://iair.mchtr.pw.edu.pl/content/download/164/821/file/" in str(told.value)
    assert "\n" not in str(told.value)
    # half of it is no file
    assert names(tmp_path) == []
    page.error = None
    assert list(fetch_lublin(tmp_path, "2001-11-09")) == ["2001-11-09"]


@pytest.mark.parametrize("denied", ["mkdir", "touch"])
def test_a_folder_that_cannot_be_written_is_told_before_a_download(page, tmp_path, monkeypatch, denied):
    def refuse(*arguments, **settings):
        raise PermissionError(13, "Permission denied")

    folder = tmp_path / "new"
    monkeypatch.setattr(fetching.Path, denied, refuse)
    with pytest.raises(
        OSError, match=r"part2\.zip cannot be written to '.*new' \(Permission denied\)"
    ) as told:
        fetch_lublin(folder, "2001-11-09")
    assert "as data_home" in str(told.value)
    assert not isinstance(told.value, ConnectionError)
    assert page.asked == []


def test_a_folder_that_is_a_file_is_told_before_a_download(page, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match=r"cannot be written to '.*file'"):
        fetch_lublin(tmp_path / "file", "2001-11-09")
    assert page.asked == []


def test_a_download_that_is_another_file(page, tmp_path):
    expected = fetching.ARCHIVES[1].sha256
    page.files[2] = b"<html>moved</html>"
    found = hashlib.sha256(page.files[2]).hexdigest()
    with pytest.raises(OSError, match=rf"checksum {expected}, got {found}, of https://.*: fetch it again"):
        fetch_lublin(tmp_path, "2001-11-09")
    assert names(tmp_path) == []


def test_an_archive_in_the_folder_that_is_another_file(page, tmp_path):
    (tmp_path / "Lublin_all_data_part2.zip").write_bytes(b"half of it")
    with pytest.raises(OSError, match=r"part2\.zip: delete it and fetch it again"):
        fetch_lublin(tmp_path, "2001-11-09")
    assert page.asked == []


def test_a_day_with_faults_that_is_another_file(page, tmp_path, monkeypatch):
    (tmp_path / "09112001.txt").write_bytes(b"edited")
    with pytest.raises(OSError, match=r"09112001\.txt: delete it and fetch it again"):
        fetch_lublin(tmp_path, "2001-11-09")
    monkeypatch.setitem(fetching.DAYS, "2001-11-17", "0" * 64)
    with pytest.raises(
        OSError, match=r"Lublin_all_data/17112001\.txt in .*part3\.zip: fetch the archive again"
    ):
        fetch_lublin(tmp_path, "2001-11-17")
    assert "17112001.txt" not in names(tmp_path)


def test_a_day_without_a_recording(page, tmp_path):
    with pytest.raises(ValueError, match=r"There is no recording of 2001-11-23; no archive"):
        fetch_lublin(tmp_path, ["2001-11-09", "2001-11-23"])
    with pytest.raises(ValueError, match="A day must be a date from 2001-10-27"):
        fetch_lublin(tmp_path, "2002-01-01")


def test_a_member_is_written_by_its_name_alone(page, tmp_path, monkeypatch):
    folder = tmp_path / "inner"
    folder.mkdir()
    path = write_archive(folder / "Lublin_all_data_part4.zip", PARTS[4], folder="../../outside")
    checksum = hashlib.sha256(path.read_bytes()).hexdigest()
    other = fetching.Archive(4, "166/829", checksum, frozenset(PARTS[4]))
    monkeypatch.setattr(fetching, "ARCHIVES", (*fetching.ARCHIVES[:3], other))
    assert fetch_lublin(folder, "2001-10-30") == {"2001-10-30": folder / "30102001.txt"}
    assert names(tmp_path) == ["inner"]


def test_the_home_of_data_is_in_the_home_of_the_user(page, tmp_path, monkeypatch):
    monkeypatch.setattr(fetching.Path, "home", lambda: tmp_path)
    files = fetch_lublin(days="2001-10-30")
    assert files == {"2001-10-30": tmp_path / "sklvalve_data" / "lublin" / "30102001.txt"}


def test_the_real_page_as_it_is_known():
    assert fetching.ARCHIVES[3].url == (
        "https://iair.mchtr.pw.edu.pl/content/download/166/829/file/Lublin_all_data_part4.zip"
    )
    checksums = [one.sha256 for one in fetching.ARCHIVES] + list(fetching.DAYS.values())
    assert len(set(checksums)) == 8
    assert all(len(one) == 64 and set(one) <= set("0123456789abcdef") for one in checksums)
    # each day with a fault can be checked, and is known to lie in one archive
    assert set(fetching.DAYS) == WITH_FAULTS
    assert frozenset().union(*(one.days for one in fetching.ARCHIVES)) > WITH_FAULTS


def test_a_download_is_written_as_it_comes(tmp_path, monkeypatch):
    served = tmp_path / "served.zip"
    served.write_bytes(b"0123456789" * 10000)
    fetching._download(served.as_uri(), tmp_path / "copy.zip")
    assert (tmp_path / "copy.zip").read_bytes() == served.read_bytes()
