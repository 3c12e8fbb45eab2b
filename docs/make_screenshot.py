# SPDX-License-Identifier: BSD-3-Clause
"""Make docs/report.png: the top of the demo's report, taken by a Chromium without a window."""

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from sklvalve.cli import main

TARGET = Path(__file__).with_name("report.png")
# down to the end of the recorded signals
WIDTH, HEIGHT = 960, 1340
_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--hide-scrollbars",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def take(seed: int | None, target: Path) -> None:
    """Run the demo and photograph its report."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if browser is None:
        sys.exit("no Chromium found: install it (apt-get install chromium), then run this again")
    with tempfile.TemporaryDirectory() as folder:
        drawn = [] if seed is None else ["--seed", str(seed)]
        if main(["demo", *drawn, "--out", folder]) != 0:
            sys.exit("the demo failed")
        page = Path(folder, "report.html").as_uri()
        words = [browser, *_FLAGS, f"--user-data-dir={folder}/profile"]
        words += [f"--window-size={WIDTH},{HEIGHT}", f"--screenshot={target}", page]
        subprocess.run(words, check=True, capture_output=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, help="of the draw, instead of the one that the demo takes")
    take(parser.parse_args().seed, TARGET)
