"""Stage equations of a slice are solved, whatever their number: four columns at once, what is left over each alone."""

import numpy as np
from each_row import each_row

from screwsim.derivatives import chamber_stages, stages
from screwsim.derivatives.block_bidiagonal import BlockBidiagonal, follow_once
from screwsim.derivatives.radau import INTEGRALS, NODES
from screwsim.derivatives.stages import LITTLE

COUNT, COLUMNS, WIDTH = 4, 5, 0.02
SHAPES = [(8, 4, 5), (8, 3, 1), (5, 3, 1), (5, 5, 4), (3, 2, 2), (1, 4, 0), (7, 2, 3)]  # chambers, states, reach


def equations(draw, chambers, states, reach):
    """Return stiff derivatives of rates (COUNT, NODES, N, N) whose chambers meet `reach` others on either side."""
    J = 30.0 * draw.normal(size=(COUNT, NODES, chambers, states, chambers, states))
    for c in range(chambers):
        for d in range(chambers):
            if abs(c - d) > reach:
                J[:, :, c, :, d] = 0.0
    return J.reshape(COUNT, NODES, chambers * states, chambers * states)


@each_row("shape", SHAPES)
def test_stage_equations_are_solved_slice_by_slice(shape):
    draw = np.random.default_rng(3)
    J, (chambers, states, reach) = equations(draw, *shape), shape
    N, widths = chambers * states, np.full(COUNT, WIDTH)
    start, right = draw.normal(size=(N, COLUMNS)), draw.normal(size=(COUNT, NODES, N, COLUMNS))
    found = BlockBidiagonal(J, widths, states, reach).follow(start, right.copy())
    np.testing.assert_array_equal(follow_once(J, widths, states, reach, start, right.copy()), found)
    before = start
    for k in range(COUNT):
        matrix = np.eye(NODES * N) - WIDTH * np.block(
            [[INTEGRALS[i, j] * J[k, j] for j in range(NODES)] for i in range(NODES)]
        )
        expected = np.linalg.solve(matrix, (right[k] + before).reshape(NODES * N, COLUMNS))
        assert np.abs(found[k].reshape(expected.shape) - expected).max() < 1e-10 * np.abs(expected).max()
        before = found[k, -1]


@each_row("states", [1, 2, 3, 4, 8])
def test_a_chamber_alone_has_the_bits_of_one_among_others(states):
    draw = np.random.default_rng(4)
    J, widths, size = equations(draw, 1, states, 0), np.full(COUNT, WIDTH), NODES * states
    band, own = ((np.empty((COUNT, size, size)), np.empty((COUNT, size), np.int64)) for _ in range(2))
    stages.compiled().stages__factor(J.reshape(-1, states, states), widths, states, 0, *band)
    chamber_stages.compiled().chamber_stages__factor(J.reshape(-1, states, states), widths, states, *own)
    for one, other in zip(band, own, strict=True):
        np.testing.assert_array_equal(one, other)
    blocks, right = BlockBidiagonal(J, widths, states, 0), draw.normal(size=(COUNT, NODES, states, 1))
    through = blocks.follow(np.zeros((states, 1)), right.copy())[..., 0]
    np.testing.assert_array_equal(blocks.follow_one_by_one(right[..., 0], np.zeros((states, states))), through)


def test_shapes_are_of_all_kinds():
    rows = {NODES * chambers * states for chambers, states, _ in SHAPES}
    assert {size % 4 for size in rows if size > LITTLE} >= {0, 1, 2}
    assert min(rows) <= LITTLE
