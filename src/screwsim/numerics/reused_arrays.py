"""Arrays in memory that is reused once nobody holds it any more.

An allocator may return large arrays to the system, which then has to map their pages again: in a virtual machine that
takes as long as filling them. Memory is in use as long as an array, or a view of it, exists.

Arrays begin at a cache line: numpy's large ones begin 16 bytes behind one, so that every other register, or each, is
read from two lines.
"""

import mmap
import sys
import threading
from math import prod

import numpy as np

PRIVATE = {"flags": mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS} if hasattr(mmap, "MAP_PRIVATE") else {}  # private to a fork


Array = np.ndarray
LEAST = 1 << 14  # least size, in numbers, for which this pays
MOST = 1 << 23  # most numbers kept by a thread, 64 MiB
LINE = 8  # numbers in a cache line
WIDER = 1.25  # size of a new block over the requested one: pages that are never written cost nothing


def _references(blocks: list[Array]) -> list[int]:
    """Return the reference count of each block, including those of this list and of the call itself."""
    return [sys.getrefcount(block) for block in blocks]


FREE = _references([np.empty(1)])[0]  # count of a block that nobody holds, which depends on Python's version


class _ThreadBlocks(threading.local):
    """The blocks of a thread, in the order in which they were made."""

    def __init__(self) -> None:
        self.blocks: list[Array] = []


_kept = _ThreadBlocks()


def empty(*shape: int) -> Array:
    """Return an array of floats with arbitrary content, aligned to a cache line if it is large."""
    size = prod(shape)
    if size < LEAST:
        return np.empty(shape)
    blocks, size = _kept.blocks, size + LINE - 1
    free = [i for i, count in enumerate(_references(blocks)) if count == FREE and blocks[i].size >= size]
    if free:
        best = blocks[min(free, key=lambda i: blocks[i].size)]
    else:
        best = np.empty(int(WIDER * size))
        blocks.append(best)
        while sum(each.size for each in blocks) > MOST:
            del blocks[0]  # it stays alive while somebody holds it
    skip = -best.ctypes.data % (LINE * best.itemsize) // best.itemsize
    return best[skip : skip + prod(shape)].reshape(shape)


def zeros(*shape: int) -> Array:
    """Return an array of zeros."""
    found = empty(*shape)
    found.fill(0.0)
    return found


def room(*shape: int) -> Array:
    """Return an array of zeros in pages of its own.

    numpy's would be as cheap the first time only: memory that the allocator has got back it has to overwrite
    completely.
    """
    count = prod(shape)
    pages = mmap.mmap(-1, max(count, 1) * np.dtype(float).itemsize, **PRIVATE)
    return np.frombuffer(pages, count=count).reshape(shape)
