# SPDX-License-Identifier: BSD-3-Clause
"""What signals tell by themselves, without any simulation."""
