# SPDX-License-Identifier: BSD-3-Clause
"""What a simulation leaves over, and what follows from that, with a name or without."""
