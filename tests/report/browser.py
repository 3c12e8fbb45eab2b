# SPDX-License-Identifier: BSD-3-Clause
"""A Chromium without a window, driven over two pipes by the DevTools protocol, without a package."""

import base64
import fcntl
import json
import os
import select
import shutil
import signal
import time
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# without a network no start of a browser should ask for one
_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--remote-debugging-pipe",
)
_PATIENCE = 60.0


def executable() -> str | None:
    """Path of a Chromium, or None where there is none that can be driven."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    return found if hasattr(os, "posix_spawn") else None


class Browser:
    """One Chromium; a context.

    Parameters
    ----------
    path : str
        Its executable.
    profile : str
        An empty folder.
    """

    def __init__(self, path: str, profile: str) -> None:
        self.words = [path, *_FLAGS, f"--user-data-dir={profile}", "about:blank"]
        self.count, self.rest, self.events = 0, b"", []

    def __enter__(self) -> "Browser":
        # the browser listens on descriptor 3 and speaks on 4; ours must not lie there already
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in (*os.pipe(), *os.pipe())]
        its_in, self.out, self.into, its_out = ends
        moves = [(os.POSIX_SPAWN_DUP2, its_in, 3), (os.POSIX_SPAWN_DUP2, its_out, 4)]
        silent = (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0)
        self.process = os.posix_spawn(self.words[0], self.words, os.environ, file_actions=[*moves, silent])
        os.close(its_in)
        os.close(its_out)
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self.out)
        os.close(self.into)
        os.kill(self.process, signal.SIGTERM)
        os.waitpid(self.process, 0)

    def call(self, method: str, session: str | None = None, **settings: Any) -> dict:
        """Result of a command."""
        self.count += 1
        told = {"id": self.count, "method": method, "params": settings}
        os.write(self.out, json.dumps(told | ({"sessionId": session} if session else {})).encode() + b"\0")
        number = self.count
        while True:
            message = self._next()
            if message.get("id") == number:
                assert "error" not in message, message["error"]
                return message["result"]
            self.events.append(message)

    def wait(self, event: str) -> None:
        """Read until an event came."""
        while not any(message.get("method") == event for message in self.events):
            self.events.append(self._next())

    def _next(self) -> dict:
        end = time.monotonic() + _PATIENCE
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.into], [], [], max(end - time.monotonic(), 0.0))
            read = os.read(self.into, 1 << 20) if ready else b""
            if not read:
                raise TimeoutError(f"the browser said nothing for {_PATIENCE:.0f} s, or has ended")
            self.rest += read
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)


class Page:
    """A file opened in a window of a size.

    Parameters
    ----------
    browser : Browser
    address : str
    width, height : int
        Of the window [px].
    dark : bool, default=False
        Whether the reader prefers dark pages.
    scripts : bool, default=True
        Whether scripts may run.
    """

    def __init__(
        self,
        browser: Browser,
        address: str,
        width: int,
        height: int = 900,
        *,
        dark: bool = False,
        scripts: bool = True,
    ) -> None:
        self.browser = browser
        browser.events.clear()
        self.target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        self.call("Emulation.setDeviceMetricsOverride", **size)
        self.prefer("dark" if dark else "light")
        self.call("Emulation.setScriptExecutionDisabled", value=not scripts)
        browser.events.clear()
        self.call("Page.navigate", url=address)
        browser.wait("Page.loadEventFired")

    def call(self, method: str, **settings: Any) -> dict:
        """Result of a command to this page."""
        return self.browser.call(method, self.session, **settings)

    def prefer(self, scheme: str, media: str = "") -> None:
        """Set light or dark, screen or print."""
        wanted = [{"name": "prefers-color-scheme", "value": scheme}]
        self.call("Emulation.setEmulatedMedia", media=media, features=wanted)

    def ask(self, expression: str) -> Any:
        """Value of an expression of the page's language."""
        told = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in told, told
        return told["result"].get("value")

    def complaints(self) -> list:
        """Errors and warnings that the browser told so far."""
        told = [event for event in self.browser.events if event.get("sessionId") == self.session]
        return [
            event["params"]
            for event in told
            if event["method"] == "Runtime.exceptionThrown"
            or (event["method"] == "Log.entryAdded" and event["params"]["entry"]["level"] != "verbose")
            or (
                event["method"] == "Runtime.consoleAPICalled"
                and event["params"]["type"] in ("error", "warning")
            )
        ]

    def addresses(self) -> set[str]:
        """All that was asked for."""
        events = [
            event for event in self.browser.events if event.get("method") == "Network.requestWillBeSent"
        ]
        return {event["params"]["request"]["url"] for event in events}

    def move(self, kind: str, x: float, y: float, *, held: bool = False, clicks: int = 0) -> None:
        """One step of the mouse: ``mouseMoved``, ``mousePressed`` or ``mouseReleased``."""
        button = "left" if held or clicks else "none"
        self.call(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x,
            y=y,
            button=button,
            buttons=int(held),
            clickCount=clicks,
        )

    def press(self, key: str, *, shift: bool = False) -> None:
        """One key down and up."""
        told = {"key": key, "modifiers": 8 if shift else 0, "windowsVirtualKeyCode": _CODES.get(key, 0)}
        self.call("Input.dispatchKeyEvent", type="keyDown", **told)
        self.call("Input.dispatchKeyEvent", type="keyUp", **told)

    def picture(self, path: str | os.PathLike[str], *, whole: bool = False) -> None:
        """Write what is seen, or the whole page, as PNG."""
        told = self.call(
            "Page.captureScreenshot", captureBeyondViewport=whole, **({} if not whole else self._whole())
        )
        with open(path, "wb") as file:
            file.write(base64.b64decode(told["data"]))

    def print(self, path: str | os.PathLike[str]) -> None:
        """Write the page as it is printed."""
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.printToPDF", preferCSSPageSize=True)["data"]))

    def close(self) -> None:
        """Shut the window."""
        self.browser.call("Target.closeTarget", targetId=self.target)

    def _whole(self) -> dict:
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        return {"clip": {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}}


_CODES = {
    "Tab": 9,
    "ArrowLeft": 37,
    "ArrowRight": 39,
    "Escape": 27,
    "Home": 36,
    "End": 35,
    "+": 187,
    "-": 189,
}
