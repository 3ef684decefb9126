"""Memory that others had before: nobody's while anybody holds it, and given out again after that."""

import threading

import numpy as np
import pytest

from screwsim.numerics import reused_arrays
from screwsim.numerics.reused_arrays import LEAST, empty, zeros


@pytest.fixture(autouse=True)
def own(monkeypatch):
    """Blocks of this test alone."""
    monkeypatch.setattr(reused_arrays, "_kept", reused_arrays._ThreadBlocks())


def test_what_nobody_holds_is_given_out_again():
    first = empty(LEAST)
    at = first.ctypes.data
    del first
    assert empty(2, LEAST // 2).ctypes.data == at


def test_what_is_held_is_not_given_out():
    first = empty(LEAST)
    assert not np.shares_memory(first, empty(LEAST))


def test_what_is_large_begins_at_a_cache_line():
    held = [empty(LEAST + i) for i in range(5)]
    assert [each.ctypes.data % 64 for each in held] == [0] * 5


def test_a_view_holds_the_memory_of_its_array():
    part = empty(4, LEAST).transpose()[:10, 2]
    part[:] = 7.0
    zeros(4, LEAST)
    assert np.all(part == 7.0)


def test_zeros_are_nothing_where_something_stood():
    found = empty(LEAST)
    found.fill(3.0)
    del found
    assert not zeros(LEAST).any()


def test_the_smallest_block_that_does_is_taken():
    large, small = empty(8 * LEAST), empty(LEAST)
    at = small.ctypes.data
    del large, small
    assert empty(LEAST).ctypes.data == at


def test_no_more_is_kept_than_its_bound(monkeypatch):
    monkeypatch.setattr(reused_arrays, "MOST", 4 * LEAST)
    held = [empty(LEAST) for _ in range(6)]
    assert sum(each.size for each in reused_arrays._kept.blocks) <= 4 * LEAST
    assert not any(np.shares_memory(one, other) for i, one in enumerate(held) for other in held[:i])


def test_threads_have_blocks_of_their_own():
    first = empty(LEAST)
    at, found = first.ctypes.data, []
    del first
    thread = threading.Thread(target=lambda: found.append(empty(LEAST)))
    thread.start()
    thread.join()
    assert found[0].ctypes.data != at
