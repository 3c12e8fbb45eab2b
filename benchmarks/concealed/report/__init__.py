# SPDX-License-Identifier: BSD-3-Clause
"""Tables and curves of a trial, arranged from the figures of `benchmarks.concealed.scoring`.

python -m benchmarks.concealed.report SCORES [SCORES ...] [--method NAME] [--out FOLDER]
"""
