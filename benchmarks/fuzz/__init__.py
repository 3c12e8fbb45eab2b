# SPDX-License-Identifier: BSD-3-Clause
"""Mutated files of every kind that the package reads."""
