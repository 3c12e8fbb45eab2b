# SPDX-License-Identifier: BSD-3-Clause
"""What would tell more: words, and tests planned sample by sample."""
