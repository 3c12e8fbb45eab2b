# SPDX-License-Identifier: BSD-3-Clause
"""The pages for a browser on this machine, kept up to date: a server on the loopback address alone."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from http import HTTPStatus
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

from sklvalve.recording.errors import InputError

LOOPBACK = "127.0.0.1"
#: Seconds after which a browser asks for the first page again.
REFRESH = 60


class Pages(SimpleHTTPRequestHandler):
    """Files of one folder, to browsers of this machine.

    A request must name this machine as its host, so that no page from elsewhere can read these through a name
    of its own (DNS rebinding). Folders are not listed.
    """

    def send_head(self) -> Any:
        """Answer, unless the host is another or the path a folder without a page."""
        name = self.headers.get("Host", "").rsplit(":", 1)[0]
        if name not in (LOOPBACK, "localhost"):
            self.send_error(HTTPStatus.MISDIRECTED_REQUEST, f"open http://{LOOPBACK} instead")
            return None
        return super().send_head()

    def list_directory(self, path: Any) -> None:
        """Say that there is no such page."""
        self.send_error(HTTPStatus.NOT_FOUND, "no such page")

    def end_headers(self) -> None:
        """Let the browser keep nothing, guess no type, load nothing from elsewhere, and ask again."""
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Content-Security-Policy", "default-src 'self' data: 'unsafe-inline'")
        if self.path in ("/", "/index.html"):
            self.send_header("Refresh", str(REFRESH))
        super().end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Keep requests out of the terminal, which tells of valves."""


def server_of(site: str | Path, port: int) -> ThreadingHTTPServer:
    """A server of a folder on this machine, not started yet.

    Parameters
    ----------
    site : path-like
    port : int
        0 takes any that is free.

    Raises
    ------
    InputError
        If the port cannot be used.
    """
    try:
        return ThreadingHTTPServer((LOOPBACK, port), partial(Pages, directory=str(site)))
    except OSError as error:
        raise InputError(
            f"--serve {port}: {error.strerror or error}; give another port, such as 8001"
        ) from None


def serve(server: ThreadingHTTPServer, update: Callable[[], object], every: float) -> None:
    """Show pages until interrupted, and bring them up to date again and again.

    Parameters
    ----------
    server : ThreadingHTTPServer
        As `server_of` makes it; closed in the end.
    update : callable
        Brings valves and pages up to date.
    every : float
        Seconds between two updates.
    """
    with server:
        Thread(target=server.serve_forever, daemon=True).start()
        try:
            while True:
                time.sleep(every)
                update()
        except KeyboardInterrupt:
            # how a person ends it
            return
        finally:
            server.shutdown()
