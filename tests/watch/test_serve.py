# SPDX-License-Identifier: BSD-3-Clause
"""Pages for a browser of this machine: what is answered, what is not, and how they are kept up to date."""

import http.client
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
    assert asked(server, "/", host="localhost:8000")[0] == 200


def test_nothing_can_be_written(server):
    assert asked(server, "/index.html", method="POST")[0] == 501
    assert asked(server, "/index.html", method="PUT")[0] == 501


def test_only_this_machine_is_served(server):
    assert server.server_address[0] == "127.0.0.1"


def test_a_port_that_is_taken_is_told(server, site):
    with pytest.raises(InputError, match="give another port, such as 8001"):
        server_of(site, server.server_address[1])


def test_pages_are_brought_up_to_date_until_a_person_ends_it(site):
    seen = []

    def update():
        seen.append(1)
        if len(seen) == 3:
            raise KeyboardInterrupt

    serve(server_of(site, 0), update, 0.01)
    assert len(seen) == 3


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--serve"], "--serve shows the pages of --site"),
        (["--site", "site", "--every", "5"], "--every belongs to --serve"),
        (["--site", "site", "--serve", "0"], "expected a port from 1 to 65535; got '0'"),
    ],
)
def test_wrong_uses_end_in_a_sentence(tmp_path, monkeypatch, capsys, words, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rows").mkdir()
    (tmp_path / "valve.toml").write_text('[recording]\ntime = "t"\ncommand = { column = "C", unit = "%" }\n')
    (tmp_path / "plant.toml").write_text('[valve.FV-1]\nsheet = "valve.toml"\n')
    refused(["watch", "plant.toml", "--data", "rows", "--state", "state", *words], said, capsys)
