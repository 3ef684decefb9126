"""Copies that stand in one block: the same numbers, arrays of their own, read by compiled code where they stand."""

from __future__ import annotations

import threading

import numpy as np

from screwsim.codegen import calls
from screwsim.codegen.calls import Context, copied, take


def test_copies_are_what_they_are_made_of_and_nobody_elses():
    given = [np.arange(3.0), np.arange(24.0).reshape(2, 3, 4), np.arange(5), np.arange(12.0).reshape(3, 4)[:2]]
    copies = copied(given)
    for one, other in zip(given, copies, strict=True):
        assert np.array_equal(one, other) and one.dtype == other.dtype and other.flags.c_contiguous
        other[...] = -1
    assert given[0].tolist() == [0.0, 1.0, 2.0] and copies[2].tolist() == [-1] * 5


def test_where_copies_stand_is_known_right():
    for each in copied([np.arange(3.0), np.arange(4), np.arange(6.0).reshape(2, 3)]):
        kinds, words = [], []
        take(each, kinds, words)
        assert words == [each.ctypes.data, *each.shape]
        again = np.frombuffer(each.tobytes(), each.dtype).reshape(each.shape).copy()
        assert Context((each,)).number == Context((again,)).number


def test_contexts_that_two_threads_meet_first_are_not_taken_for_one_another(monkeypatch):
    """The number of a new kind is looked up after it was added: another thread may add one in between."""
    one, other = (1.5, np.arange(3.0), 1), (np.arange(4), 2.5)
    kinds, numbers = list(calls.KINDS), []

    def meet(argument):
        take(argument, found := [], [])
        numbers.append((argument, found[0]))

    class Interrupted(list):
        def append(self, kind):
            super().append(kind)
            if len(self) == len(kinds) + 1:  # the first: the other thread has its turn now, if it may
                thread.start()
                thread.join(0.2)

    thread = threading.Thread(target=meet, args=(other,))
    monkeypatch.setattr(calls, "KINDS", Interrupted(kinds))
    monkeypatch.setattr(calls, "_contexts", {})
    meet(one)
    thread.join()
    letters = {len(argument): [str(each) for each in calls.KINDS[number].of] for argument, number in numbers}
    assert letters == {3: ["f", "a1(f)", "i"], 2: ["a1(i)", "f"]}
