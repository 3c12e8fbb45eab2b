# SPDX-License-Identifier: BSD-3-Clause
"""From fitted hypotheses to a decision: the table that compares them, and the rules that decide."""
