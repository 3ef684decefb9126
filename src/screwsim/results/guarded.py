"""New HDF5 files on disks that may be full: what stops the writing is raised, in place of what HDF5 makes of it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def new_hdf5(path: Path, **layout: Any) -> Iterator[Any]:
    """Give a new HDF5 file to write into; raise the OSError that stopped its writing, if any."""
    import h5py

    target = GuardedFile(path)
    try:
        with h5py.File(target, "w", **layout) as file:
            yield file
    except Exception:  # of HDF5, which reads back less than it wrote
        target.check()
        raise
    finally:
        target.close()
    target.check()


class GuardedFile:
    """A new file whose failure to write is kept in `error` and not raised.

    HDF5 1.14 can crash the process when its own writing fails: it is told that all went well, and whoever writes
    asks `check` now and then.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("w+b", buffering=0)
        self.error: OSError | None = None

    def check(self) -> None:
        """Raise the OSError that stopped the writing, if any."""
        if self.error is not None:
            raise self.error

    def write(self, data: memoryview) -> int:
        """Write all bytes, or keep the reason why not."""
        left = memoryview(data).cast("B")
        try:
            while len(left) and self.error is None:
                left = left[self._file.write(left) :]
        except OSError as error:
            self.error = error
        return len(data)

    def truncate(self, size: int) -> int:
        """Set the size of the file."""
        try:
            if self.error is None:
                self._file.truncate(size)
        except OSError as error:
            self.error = error
        return size

    def read(self, size: int) -> bytes:
        """Read; see `readinto`, which is what h5py calls."""
        buffer = bytearray(size)
        self.readinto(memoryview(buffer))
        return bytes(buffer)

    def readinto(self, buffer: memoryview) -> int:
        """Read; after a failure there may be less than was written, and zeros stand for it."""
        size = self._file.readinto(buffer) or 0
        buffer[size:] = bytes(len(buffer) - size)
        return len(buffer)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Return the place."""
        return self._file.tell()

    def flush(self) -> None:
        """Nothing is held back."""

    def close(self) -> None:
        """Close the file."""
        self._file.close()
