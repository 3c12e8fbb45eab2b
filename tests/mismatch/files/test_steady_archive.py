# SPDX-License-Identifier: BSD-3-Clause
"""The same content in the same bytes, and back."""

import copy

import numpy as np
import pytest

from sklvalve.mismatch.files.packed_model import require_plain_archive
from sklvalve.mismatch.files.steady_archive import steady_archive

skops = pytest.importorskip("skops.io")


def content():
    twice = np.arange(3.0)
    return {"a": twice, "b": [1, "x", {"c": 2.5, "none": None}], "same": twice, "equal": np.arange(3.0)}


def test_equal_contents_have_equal_bytes_whether_their_parts_are_shared_or_not():
    here = steady_archive(skops.dumps(content()))
    there = steady_archive(skops.dumps({key: copy.deepcopy(value) for key, value in content().items()}))
    assert here == there
    other = content() | {"b": [1, "y", {"c": 2.5, "none": None}]}
    assert steady_archive(skops.dumps(other)) != here


def test_it_is_a_plain_file_that_skops_reads():
    packed = steady_archive(skops.dumps(content()))
    require_plain_archive(packed)
    read = skops.loads(packed, trusted=[])
    assert read["b"] == content()["b"]
    for key in ("a", "same", "equal"):
        np.testing.assert_array_equal(read[key], np.arange(3.0))
