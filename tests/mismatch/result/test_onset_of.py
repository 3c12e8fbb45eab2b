# SPDX-License-Identifier: BSD-3-Clause
"""When what was found began: the likeliest of a class says it, wherever the search ended."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.result.contents import onset_of
from sklvalve.mismatch.search.rivals import Finding, Rival

MODEL = SimpleNamespace(chain=SimpleNamespace(clock=np.array([50.0, 51.0])))
LEAK = next(e for e in CATALOGUE if e.key == "seat_leakage")


@pytest.mark.parametrize(("share_throughout", "onset"), [(0.6, None), (0.3, 900.0)])
def test_the_likeliest_of_a_class_says_when_it_began(share_throughout, onset):
    throughout, within = Term(LEAK), Term(LEAK, 950.0)
    rivals = [
        Rival(throughout, MODEL, share_throughout, 0.0),
        Rival(within, MODEL, 1.0 - share_throughout, 0.0),
    ]
    found = SimpleNamespace(findings=[Finding(within, rivals, 9.0, {"flow": 0.1})], model=MODEL)
    assert onset_of(found) == onset
