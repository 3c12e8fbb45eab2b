# SPDX-License-Identifier: BSD-3-Clause
"""Fitted estimators in files, read back without running code."""
