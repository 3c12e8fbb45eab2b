# SPDX-License-Identifier: BSD-3-Clause
"""A diagnosis as plain data, in memory and in files."""
