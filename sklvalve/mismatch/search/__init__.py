# SPDX-License-Identifier: BSD-3-Clause
"""Which effects a recording asks for: screened, dated, fitted, and held against their rivals."""
