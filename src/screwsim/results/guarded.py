"""New HDF5 files on disks that may be full: the error that stopped the writing is raised, not HDF5's consequence."""

import os
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


class GuardedFile:
    """A new file that keeps a failure to write in `error` instead of raising it.

    HDF5 1.14 can crash the process when its own writing fails. So it is told that every write succeeded, and the writer
    calls `check` from time to time.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("w+b", buffering=0)
        self.error: OSError | None = None

    def check(self) -> None:
        """Raise the OSError that stopped the writing, if any."""
        if self.error is not None:
            raise self.error

    def write(self, data: memoryview) -> int:
        """Write all bytes; on failure keep the error."""
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
        """Read; after a failed write there may be fewer bytes than were written, and zeros replace the rest."""
        size = self._file.readinto(buffer) or 0
        buffer[size:] = bytes(len(buffer) - size)
        return len(buffer)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to an offset."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Return the offset."""
        return self._file.tell()

    def flush(self) -> None:
        """Do nothing: the file is unbuffered."""

    def close(self) -> None:
        """Close the file."""
        self._file.close()
