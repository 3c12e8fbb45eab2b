# SPDX-License-Identifier: BSD-3-Clause
"""``python -m sklvalve`` is the command ``sklvalve``."""

import sys

from sklvalve.cli import main

if __name__ == "__main__":
    sys.exit(main())
