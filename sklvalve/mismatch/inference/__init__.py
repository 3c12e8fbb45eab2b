# SPDX-License-Identifier: BSD-3-Clause
"""What a recording says of hypotheses: how probable they are, and how far apart."""
