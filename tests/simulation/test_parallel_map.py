# SPDX-License-Identifier: BSD-3-Clause
"""Pieces run side by side come back in order, one level deep, and stop at the first that fails."""

import threading
import time

import pytest

from sklvalve.simulation.parallel_map import parallel_map, with_threads


@pytest.fixture(autouse=True)
def _several_threads():
    with with_threads(3):
        yield


def test_results_come_in_the_order_of_the_items():
    def slow_first(k):
        time.sleep(0.02 * (5 - k))
        return k * k

    assert list(parallel_map(slow_first, range(5))) == [0, 1, 4, 9, 16]
    assert list(parallel_map(slow_first, [])) == []


def test_pieces_of_a_piece_stay_in_its_thread():
    def names(_):
        own = threading.current_thread().name
        return own, {*parallel_map(lambda _: threading.current_thread().name, range(4))}

    assert all(inner == {own} for own, inner in parallel_map(names, range(4)))


def test_one_item_needs_no_thread():
    here = threading.current_thread().name
    assert list(parallel_map(lambda _: threading.current_thread().name, [1])) == [here]


def test_a_piece_that_fails_is_heard_and_what_has_not_begun_is_left():
    begun = []

    def fails(k):
        begun.append(k)
        if k == 0:
            raise RuntimeError("the first of them")
        time.sleep(0.05)

    with pytest.raises(RuntimeError, match="the first of them"):
        list(parallel_map(fails, range(50)))
    assert len(begun) < 50


def test_as_many_threads_as_asked_for():
    def name(_):
        time.sleep(0.01)
        return threading.current_thread().name

    assert len({*parallel_map(name, range(12))}) == 3
    with with_threads(1):
        assert {*parallel_map(name, range(4))} == {threading.current_thread().name}
    assert len({*parallel_map(name, range(12))}) == 3
