# SPDX-License-Identifier: BSD-3-Clause
"""Whether the test that a diagnosis asks for keeps its promise, on the plant that knows the truth."""
