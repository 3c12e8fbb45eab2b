# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of the package: each script prints a table."""
