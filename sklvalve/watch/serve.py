# SPDX-License-Identifier: BSD-3-Clause
"""The pages for a browser on this machine, kept up to date: a server on the loopback address alone."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable
from functools import partial
from http import HTTPStatus
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any
from urllib.parse import unquote, urlsplit

from sklvalve.recording.errors import InputError

LOOPBACK = "127.0.0.1"
#: Seconds after which a browser asks for the first page again.
REFRESH = 60
_FIRST = ("/", "/index.html")
_HOST = re.compile(r"(127\.0\.0\.1|localhost)(:\d+)?", re.IGNORECASE)
# what `write_site` writes, and nothing else that a folder may hold
_PAGE = re.compile(r"/(index\.html|valves/[^/]+\.html|reports/[^/]+/[^/]+\.html)?")


class Pages(SimpleHTTPRequestHandler):
    """Pages of a plant, to browsers of this machine.

    A request must name this machine as its host, so that no page from elsewhere can read these through a name
    of its own (DNS rebinding). Files that are no pages, and links out of the folder, are not shown.
    """

    path = ""  # until a request is read

    def send_head(self) -> Any:
        """Answer, unless the host is another or the path is no page."""
        if not _HOST.fullmatch(self.headers.get("Host", "")):
            self.send_error(HTTPStatus.MISDIRECTED_REQUEST, f"open http://{LOOPBACK} instead")
            return None
        if not self._is_page():
            self.send_error(HTTPStatus.NOT_FOUND, "no such page")
            return None
        return super().send_head()

    def _is_page(self) -> bool:
        path = unquote(urlsplit(self.path).path)
        if not _PAGE.fullmatch(path) or "\0" in path:
            return False
        root = Path(self.directory).resolve()
        file = (root / path.lstrip("/")).resolve()
        return file.is_relative_to(root) and (path == "/" or file.is_file())

    def list_directory(self, path: Any) -> None:
        """Say that there is no such page: a folder without its first page is not listed."""
        self.send_error(HTTPStatus.NOT_FOUND, "no such page")

    def end_headers(self) -> None:
        """Let the browser keep nothing, guess no type, load nothing from elsewhere, and ask again."""
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Content-Security-Policy", "default-src 'self' data: 'unsafe-inline'")
        if self.path in _FIRST:
            self.send_header("Refresh", str(REFRESH))
        super().end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Keep requests out of the terminal, which tells of valves."""


class _Server(ThreadingHTTPServer):
    # on Windows two servers could else listen on one port
    allow_reuse_address = sys.platform != "win32"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a browser that went away."""


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
        return _Server((LOOPBACK, port), partial(Pages, directory=str(site)))
    except (OSError, OverflowError) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(f"--serve {port}: {why}; give another port, such as 8001") from None


def serve(
    server: ThreadingHTTPServer,
    first: Callable[[], object],
    again: Callable[[], object],
    every: float,
) -> None:
    """Show pages, and bring them up to date again and again, until interrupted.

    Parameters
    ----------
    server : ThreadingHTTPServer
        As `server_of` makes it; closed in the end.
    first, again : callable
        Bring valves and pages up to date. While the first one works, pages of an earlier run are shown.
    every : float
        Seconds between two updates.
    """
    with server:
        Thread(target=server.serve_forever, daemon=True).start()
        try:
            first()
            while True:
                time.sleep(every)
                again()
        finally:
            server.shutdown()
