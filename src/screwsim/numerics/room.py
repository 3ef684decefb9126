"""Memory for many numbers of which few may ever be written: pages cost nothing until they are."""

import mmap
from math import prod

import numpy as np

Array = np.ndarray
PRIVATE = {"flags": mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS} if hasattr(mmap, "MAP_PRIVATE") else {}  # each fork its own


def room(*shape: int) -> Array:
    """Return zeros of a shape, in pages of their own.

    numpy's would be as cheap the first time only: what the allocator was given back it writes over, all of it.
    """
    count = prod(shape)
    pages = mmap.mmap(-1, max(count, 1) * np.dtype(float).itemsize, **PRIVATE)
    return np.frombuffer(pages, count=count).reshape(shape)
