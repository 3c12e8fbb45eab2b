# SPDX-License-Identifier: BSD-3-Clause
"""Real recordings by the command line, judged by written rules."""
