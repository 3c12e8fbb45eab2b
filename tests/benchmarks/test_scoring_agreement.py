# SPDX-License-Identifier: BSD-3-Clause
"""The same records, given in another way."""

from benchmarks.concealed.scoring.agreement import changed, same_outcome, same_verdict
from benchmarks.concealed.scoring.rates import Rate


def test_agreement_over_the_records_in_both(a_line, a_failure):
    def named(lines):
        return [line | {"record": f"r{i}"} for i, line in enumerate(lines)]

    first = named([a_line("a", "named", "a"), a_line("a", "named", "a"), a_line(), a_failure("a"), a_line()])
    second = named([a_line("a", "named", "a/b"), a_line("a", "named", "b"), a_line(), a_failure("a")])
    assert same_verdict(first, second) == Rate(3, 4)  # two that broke agree on nothing
    assert same_outcome(first, second) == Rate(3, 4)
    assert changed(first, second) == [("r1", "right", "wrong name")]
    assert same_verdict(first, []) == Rate(0, 0)
