"""Rules of blocks: they tile the grid, keep to rows, and neighbours follow one another."""

import itertools
import math

from each_row import each_row
from result_fakes import SCENE, scene

from screwsim.study.sweep.cases import BLOCK_CASES, Blocks, blocks_of

SHAPES = [
    (),
    (1,),
    (7,),
    (BLOCK_CASES,),
    (BLOCK_CASES + 1,),
    (43,),
    (5, 43),
    (3, 16),
    (100, 3),
    (7, 5, 3),
    (4, 1),
    (3, 100, 1),
]


@each_row("shape", SHAPES)
def test_blocks_tile_the_cases_and_are_found_again(shape):
    blocks = Blocks(shape)
    spans = [blocks.cases_of(range(number, number + 1)) for number in range(blocks.count)]
    assert [case for span in spans for case in span] == list(range(math.prod(shape)))
    assert all(0 < len(span) <= BLOCK_CASES for span in spans)
    for start in range(blocks.count):
        for stop in range(start + 1, blocks.count + 1):
            assert blocks.blocks_of(blocks.cases_of(range(start, stop))) == range(start, stop)


@each_row("shape", [shape for shape in SHAPES if math.prod(shape) > BLOCK_CASES])
def test_cases_that_are_no_whole_blocks_are_told(shape):
    blocks = Blocks(shape)
    edges = {blocks.cases_of(range(number, number + 1)).start for number in range(blocks.count)} | {blocks.cases}
    for case in range(1, blocks.cases):
        assert (blocks.blocks_of(range(case)) is None) == (case not in edges)


@each_row("shape", SHAPES)
def test_the_order_has_each_case_once_and_steps_to_neighbours(shape):
    blocks = Blocks(shape)
    row = shape[-1] if shape else 1
    for number in range(blocks.count):
        span = blocks.cases_of(range(number, number + 1))
        order = blocks.order(number)
        assert sorted(order) == list(range(len(span)))
        for one, other in itertools.pairwise(order):
            steps = [(span.start + place) // row for place in (one, other)], [place % row for place in (one, other)]
            assert sum(abs(a - b) for a, b in steps) == 1


def test_blocks_of_a_long_row_are_even():
    assert [len(Blocks((2, 43)).cases_of(range(number, number + 1))) for number in range(6)] == [14, 14, 15] * 2


def test_a_sample_has_short_blocks_for_its_points_are_no_neighbours():
    sample = "sample: {kind: sobol, count: 64, over: {oil_supply.ratio: {from: 1, to: 2}}}"
    pressures = "operation.discharge.pressure: [9 bar, 10 bar, 11 bar, 12 bar, 13 bar]"
    assert blocks_of(scene(SCENE + f"sweep: {{{sample}}}\n")).count == 16
    assert blocks_of(scene(SCENE + f"sweep: {{{sample}, {pressures}}}\n")).count == -(-64 // 3)  # of three rows each
