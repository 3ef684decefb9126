"""New HDF5 files on disks that may be full: the error that stopped the writing is raised, not HDF5's consequence."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def new_hdf5(path: Path, **layout: Any) -> Iterator[Any]:
    """Give a new HDF5 file to write to; raise the OSError that stopped its writing, if any."""
    import h5py

    target = GuardedFile(path)
    try:
        with h5py.File(target, "w", **layout) as file:
            yield file
    except Exception:  # raised by HDF5, which reads back less than it wrote
        target.check()
        raise
    finally:
        target.close()
    target.check()


class GuardedFile(io.FileIO):
    """A new file that keeps a failure to write in `error` instead of raising it.

    HDF5 1.14 can crash the process when its own writing fails. So it is told that every write succeeded, and the writer
    calls `check` from time to time.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path, "w+b")
        self.error: OSError | None = None

    def check(self) -> None:
        """Raise the OSError that stopped the writing, if any."""
        if self.error is not None:
            raise self.error

    def write(self, data: Any) -> int:
        """Write all bytes; on failure keep the error."""
        left = whole = memoryview(data).cast("B")
        try:
            while len(left) and self.error is None:
                left = left[super().write(left) :]
        except OSError as error:
            self.error = error
        return len(whole)

    def truncate(self, size: int | None = None) -> int:
        """Set the size of the file."""
        try:
            if self.error is None:
                super().truncate(size)
        except OSError as error:
            self.error = error
        return self.tell() if size is None else size

    def readinto(self, buffer: Any) -> int:
        """Read, as h5py does; after a failed write fewer bytes may be there, and zeros replace the rest."""
        view = memoryview(buffer).cast("B")
        size = super().readinto(view) or 0
        view[size:] = bytes(len(view) - size)
        return len(view)
