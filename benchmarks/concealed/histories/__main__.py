# SPDX-License-Identifier: BSD-3-Clause
"""Add histories to the records of a folder.

python -m benchmarks.concealed.histories FOLDER
"""

import argparse
import sys
from pathlib import Path

from benchmarks.concealed.histories.add import add_histories


def main(arguments=None):
    """Add them; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.histories", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folder", type=Path, help="of `python -m benchmarks.concealed`")
    options = parser.parse_args(arguments)
    try:
        names = add_histories(options.folder)
    except ValueError as error:
        parser.error(str(error))
    print(f"{len(names)} histories added")
    return 0


if __name__ == "__main__":
    sys.exit(main())
