# SPDX-License-Identifier: BSD-3-Clause
"""Figures of a trial, from its lines: one topic a file, pure functions, no diagnosis code.

A *line* is one record as one method saw it, a plain dict:

    {"record", "folder", "method", "code", "seconds", "learn_seconds", "peak_mb", "load", "failed",
     "found": {"verdict", "mismatch", "location", "effects"},     as diagnosis.json has them
     "rows": {"told", "boxes", "true", "of"},                     spans of rows, [begin, end)
     "errors": {"flow": {"nominal", "corrected", "oracle", "floor"}, "opening": {...}},
     "truth": {...}}                                              as truth.json has it

Anything but "truth" may be missing: a figure is then made of the lines that have what it needs, and is told
with their number, or as "-" where there are none. Rates come with Clopper and Pearson's 95 % interval.
"""
