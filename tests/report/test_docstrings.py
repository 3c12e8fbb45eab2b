# SPDX-License-Identifier: BSD-3-Clause
import doctest

import pytest

import sklvalve.report.html
import sklvalve.report.sentence
import sklvalve.report.text


@pytest.mark.parametrize(
    "module", [sklvalve.report.html, sklvalve.report.sentence, sklvalve.report.text], ids=lambda m: m.__name__
)
def test_examples_run(module):
    result = doctest.testmod(module)
    assert result.attempted > 0
    assert result.failed == 0
