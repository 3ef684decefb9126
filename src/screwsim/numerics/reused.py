"""Arrays in memory that is used again once nobody holds it any more.

An allocator may return large arrays to the system, which then has to map their pages anew: in a virtual machine that
takes as long as filling them. Whoever holds an array, or a view of it, holds its memory.
"""

import mmap
import sys
import threading
from math import prod

import numpy as np

PRIVATE = {"flags": mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS} if hasattr(mmap, "MAP_PRIVATE") else {}  # each fork its own


Array = np.ndarray
LEAST = 1 << 14  # numbers from which on this pays
MOST = 1 << 23  # numbers kept by a thread, 64 MiB
WIDER = 1.25  # room of a new block, over what is asked: pages that are never written cost nothing


def _references(blocks: list[Array]) -> list[int]:
    """Return how many references there are to each block, those of this list and of the count itself among them."""
    return [sys.getrefcount(block) for block in blocks]


FREE = _references([np.empty(1)])[0]  # to a block that nobody holds: how many is Python's matter


class _Kept(threading.local):
    """The blocks of a thread, in the order in which they were made."""

    def __init__(self) -> None:
        self.blocks: list[Array] = []


_kept = _Kept()


def empty(*shape: int) -> Array:
    """Return an array of floats, of whatever stood there before."""
    size = prod(shape)
    if size < LEAST:
        return np.empty(shape)
    blocks = _kept.blocks
    free = [i for i, count in enumerate(_references(blocks)) if count == FREE and blocks[i].size >= size]
    if free:
        best = blocks[min(free, key=lambda i: blocks[i].size)]
    else:
        best = np.empty(int(WIDER * size))
        blocks.append(best)
        while sum(each.size for each in blocks) > MOST:
            del blocks[0]  # who holds it goes on to do so
    return best[:size].reshape(shape)


def zeros(*shape: int) -> Array:
    """Return an array of nothing."""
    found = empty(*shape)
    found.fill(0.0)
    return found


def room(*shape: int) -> Array:
    """Return zeros of a shape, in pages of their own.

    numpy's would be as cheap the first time only: what the allocator was given back it writes over, all of it.
    """
    count = prod(shape)
    pages = mmap.mmap(-1, max(count, 1) * np.dtype(float).itemsize, **PRIVATE)
    return np.frombuffer(pages, count=count).reshape(shape)
