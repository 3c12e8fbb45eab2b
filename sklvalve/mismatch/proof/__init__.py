# SPDX-License-Identifier: BSD-3-Clause
"""Rows that no fit has seen: left out, forecast, and beside a black box."""
