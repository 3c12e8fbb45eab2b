# SPDX-License-Identifier: BSD-3-Clause
"""Detectors on the DAMADICS benchmark: ours, or any with ``fit`` and ``predict``, on its 44 scenarios."""
