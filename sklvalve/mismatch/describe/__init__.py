# SPDX-License-Identifier: BSD-3-Clause
"""Where, when and how large: what was found, in the terms of the plant."""
