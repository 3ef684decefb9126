"""Chambers are held for the rows of slices that are alike, and free before and after."""

import numpy as np
import pytest

from screwsim.derivatives.held import Held
from screwsim.model.slots import FREE


@pytest.fixture
def held():
    """Two chambers, the second one in another phase from the third slice on."""
    return Held(np.full(2, FREE), np.array([[0.0, 1.0], [0.0, 1.0], [0.0, 0.0]]), 2)


def test_rows_of_slices_that_are_held_alike_are_one_run(held):
    of = np.repeat(np.arange(3), 3)
    seen = [(rows, held.cells.tolist()) for rows in held.runs(of)]
    assert seen == [(slice(0, 6), [0.0, 1.0]), (slice(6, 9), [0.0, 0.0])]
    assert held.cells.tolist() == [FREE, FREE]


def test_chambers_are_free_again_after_what_fails(held):
    with pytest.raises(ZeroDivisionError):
        for _ in held.runs(np.arange(3)):
            raise ZeroDivisionError
    with pytest.raises(ZeroDivisionError), held.on(2, np.array([1.0, 1.0])):
        assert held.cells.tolist() == [1.0, 1.0]
        raise ZeroDivisionError
    assert held.cells.tolist() == [FREE, FREE]


def test_where_nothing_is_held_all_rows_are_one_run():
    free = Held(np.full(2, FREE), np.full((3, 2), FREE), 2)
    assert list(free.runs(np.arange(3))) == [slice(0, 3)]
