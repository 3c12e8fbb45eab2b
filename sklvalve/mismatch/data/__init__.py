# SPDX-License-Identifier: BSD-3-Clause
"""What a finder is given: gathered, checked, blanked, and laid out as a problem."""
