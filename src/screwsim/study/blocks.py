"""Blocks of cases: what is simulated in one go, each case started from the one before it.

The cut depends on the grid alone, so that results depend neither on the number of workers nor on interruptions.
"""

import math
from collections.abc import Sequence

from screwsim.scene import Scene, dimensions

BLOCK = 16  # cases at most in small sweeps: even work for all cores
LONG_BLOCK = 64  # in sweeps of
MANY = 512  # cases or more: longer chains of neighbours
SAMPLE_BLOCK = 4  # the points of a sample are no neighbours


class Blocks:
    """Consecutive cases of a grid of the given shape in blocks: parts of one row of the last axis, or whole rows."""

    def __init__(self, shape: Sequence[int], longest: int = BLOCK) -> None:
        self.cases = math.prod(shape)
        self._row = shape[-1] if shape else 1
        self._parts = -(-self._row // longest)  # blocks of a row
        self._size = max(1, longest // self._row) * self._row  # where rows are short
        long = self._parts > 1
        self.count = self.cases // self._row * self._parts if long else -(-self.cases // self._size)

    def cases_of(self, blocks: range) -> range:
        """Return the cases of consecutive blocks."""
        return range(self._start(blocks.start), self._start(blocks.stop))

    def _start(self, block: int) -> int:
        if self._parts == 1:
            return min(block * self._size, self.cases)
        row, part = divmod(block, self._parts)
        return row * self._row + part * self._row // self._parts

    def blocks_of(self, cases: range) -> range | None:
        """Return the blocks that consecutive cases are; None when they are not whole blocks."""
        first, last = (self._block_from(edge) for edge in (cases.start, cases.stop))
        found = range(first, last)
        return found if self.cases_of(found) == cases else None

    def _block_from(self, case: int) -> int:
        if self._parts == 1:
            return -(-case // self._size)
        row, place = divmod(case, self._row)
        return row * self._parts + -(-place * self._parts // self._row)

    def order(self, block: int) -> list[int]:
        """Return the places in a block in the order of simulation: every other row backwards, so neighbours follow."""
        size = len(self.cases_of(range(block, block + 1)))
        if size <= self._row:
            return list(range(size))
        rows = [range(start, start + self._row) for start in range(0, size, self._row)]
        return [place for number, row in enumerate(rows) for place in (reversed(row) if number % 2 else row)]


def blocks_of(scene: Scene) -> Blocks:
    """Return the blocks of a scene's sweep."""
    found = dimensions(scene)
    sampled = bool(found) and found[-1].joint is not None and found[-1].joint.sample is not None
    shape = [dimension.size for dimension in found]
    whole = LONG_BLOCK if math.prod(shape) >= MANY else BLOCK
    return Blocks(shape, SAMPLE_BLOCK if sampled else whole)
