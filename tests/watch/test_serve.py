# SPDX-License-Identifier: BSD-3-Clause
"""Pages for a browser of this machine: what is answered, what is not, and how they are kept up to date."""

import http.client
import socket
from threading import Thread

import pytest

from sklvalve.recording import InputError
from sklvalve.watch.serve import serve, server_of
from tests.cli.refusal import refused


@pytest.fixture
def site(tmp_path):
    folder = tmp_path / "site"
    (folder / "valves").mkdir(parents=True)
    (folder / "index.html").write_text("<p>Nothing to do today")
    (folder / "valves" / "FV-1.html").write_text("<p>FV-1")
    (tmp_path / "secret.txt").write_text("secret")
    return folder


@pytest.fixture
def server(site):
    made = server_of(site, 0)
    with made:
        Thread(target=made.serve_forever, daemon=True).start()
        yield made
        made.shutdown()


def asked(server, path, method="GET", host=None):
    connection = http.client.HTTPConnection(*server.server_address, timeout=10)
    connection.request(method, path, headers={} if host is None else {"Host": host})
    answer = connection.getresponse()
    return answer.status, answer.read().decode(), dict(answer.getheaders())


def test_pages_are_shown_and_only_the_first_asks_again(server):
    status, text, headers = asked(server, "/")
    assert (status, text) == (200, "<p>Nothing to do today")
    assert headers["Refresh"] == "60"
    assert headers["Cache-Control"] == "no-store"
    status, text, headers = asked(server, "/valves/FV-1.html")
    assert (status, text) == (200, "<p>FV-1")
    assert "Refresh" not in headers


@pytest.mark.parametrize("path", ["/valves/", "/../secret.txt", "/%2e%2e/secret.txt", "/none.html"])
def test_what_is_no_page_of_the_site_is_not_found(server, path):
    status, text, _ = asked(server, path)
    assert status == 404
    assert "secret" not in text.replace("secret.txt", "")


def test_a_page_from_elsewhere_cannot_read_them_through_its_own_name(server):
    assert asked(server, "/", host="evil.example:8000")[0] == 421
    for host in ("127.0.0.1:80@evil", "localhost:evil.example", "", "[::1]:8000"):
        assert asked(server, "/", host=host)[0] == 421, host
    for host in ("localhost:8000", "LOCALHOST", "127.0.0.1"):
        assert asked(server, "/", host=host)[0] == 200, host


def test_nothing_can_be_written(server):
    assert asked(server, "/index.html", method="POST")[0] == 501
    assert asked(server, "/index.html", method="PUT")[0] == 501


def test_only_this_machine_is_served(server):
    assert server.server_address[0] == "127.0.0.1"


def test_a_port_that_is_taken_is_told(server, site):
    for port in (server.server_address[1], 70_000):
        with pytest.raises(InputError, match="give another port, such as 8001"):
            server_of(site, port)


def test_pages_are_brought_up_to_date_until_a_person_ends_it(site):
    seen = []

    def update():
        seen.append(1)
        if len(seen) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        serve(server_of(site, 0), update, update, 0.01)
    assert len(seen) == 3


def test_pages_of_an_earlier_run_are_shown_while_the_first_look_works(site):
    made, seen = server_of(site, 0), []

    def first():
        seen.append(asked(made, "/")[0])
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        serve(made, first, first, 0.01)
    assert seen == [200]


def test_what_is_no_request_is_met_with_no_word_of_ours(server, capfd):
    for line in (b"\x16\x03\x01\x02\x00\x01\r\n\r\n", b"GET / HTTP/2.0\r\n\r\n"):
        with socket.create_connection(server.server_address, timeout=10) as connection:
            connection.sendall(line)
            connection.recv(1024)
    assert "Traceback" not in capfd.readouterr().err
    assert asked(server, "/")[0] == 200


def test_only_pages_are_shown(server, site, tmp_path):
    (site / "notes.txt").write_text("secret")
    (site / "valves" / "link.html").symlink_to(tmp_path / "secret.txt")
    for path in ("/notes.txt", "/valves/link.html", "/%00", "/valves/FV-1.html/"):
        status, text, _ = asked(server, path)
        assert (status, "secret" in text) == (404, False), path


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--serve"], "--serve shows the pages of --site"),
        (["--site", "site", "--every", "5"], "--every belongs to --serve"),
        (["--site", "site", "--serve", "--every", "99999"], "expected whole minutes from 1 to 10080"),
        (["--site", "site", "--serve", "0"], "expected a port from 1 to 65535; got '0'"),
    ],
)
def test_wrong_uses_end_in_a_sentence(tmp_path, monkeypatch, capsys, words, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rows").mkdir()
    (tmp_path / "valve.toml").write_text('[recording]\ntime = "t"\ncommand = { column = "C", unit = "%" }\n')
    (tmp_path / "plant.toml").write_text('[valve.FV-1]\nsheet = "valve.toml"\n')
    refused(["watch", "plant.toml", "--data", "rows", "--state", "state", *words], said, capsys)
