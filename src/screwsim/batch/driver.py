"""A GPU through NVIDIA's driver: memory, copies, kernels in PTX.

Needs the package cuda-bindings (`pip install 'screwsim[gpu]'`) and the driver that comes with a device.
"""

import ctypes
import importlib.util
import os
import sys
from functools import cache
from typing import Any

import numpy as np

from screwsim.codegen.device_library import TURNS
from screwsim.codegen.kinds import Kind
from screwsim.inputs.faults import UsageError

Array = np.ndarray
THREADS = 32  # of a block: points take different paths, so one warp per multiprocessor is fastest
NEEDS = "points on a GPU need the package cuda-bindings (pip install 'screwsim[gpu]')"
NO_DEVICE = "points on a GPU need one that NVIDIA's driver finds ({}); otherwise use --batch"


class DeviceError(RuntimeError):
    """A call to the driver failed."""


class Driver:
    """The first device of this machine, which integrates turns: it has memory, addressed by integers.

    It runs one thread for each turn.
    """

    def __init__(self) -> None:
        try:
            from cuda.bindings import driver  # pyrefly: ignore[missing-import] - an extra
        except ImportError:
            raise UsageError(NEEDS) from None
        self._driver = driver
        try:
            self._do("cuInit", 0)
            device = self._do("cuDeviceGet", 0)
        except RuntimeError as error:  # also raised by the package where there is no driver
            raise UsageError(NO_DEVICE.format(str(error).strip().splitlines()[-1])) from None
        self.name: str = self._do("cuDeviceGetName", 256, device).split(b"\0")[0].decode()
        self._context = self._do("cuDevicePrimaryCtxRetain", device)

    def _do(self, name: str, *arguments: Any) -> Any:
        """Call the driver; raise DeviceError if it reports a failure, MemoryError if it has no room."""
        code, *found = getattr(self._driver, name)(*arguments)
        if code == self._driver.CUresult.CUDA_ERROR_OUT_OF_MEMORY:
            raise MemoryError
        if code != self._driver.CUresult.CUDA_SUCCESS:
            raise DeviceError(f"{name}: {code.name}")
        return found[0] if found else None

    def _here(self) -> None:
        """Make the device current for this thread."""
        self._do("cuCtxSetCurrent", self._context)

    def turns(self, module: Any, name: str, kinds: tuple[Kind, ...], numbers: dict[int, int]) -> Any:
        """Return a module's function as compiled for this device; `numbers` are arguments with one value in every run.

        The driver translates PTX for its device once and caches it itself.
        """
        self._here()
        loaded = self._do("cuModuleLoadData", module.of_device(name, kinds, numbers) + b"\0")
        return self._do("cuModuleGetFunction", loaded, TURNS.encode())

    def room(self, words: int) -> int:
        """Allocate `words` words of 8 bytes and return their address; raise MemoryError where there is no room."""
        self._here()
        return int(self._do("cuMemAlloc", 8 * words))

    def free(self, address: int) -> None:
        """Free what `room` allocated."""
        self._here()
        self._do("cuMemFree", address)

    def up(self, address: int, table: Array) -> None:
        """Copy a contiguous table to an address."""
        self._here()
        self._do("cuMemcpyHtoD", address, table.ctypes.data, table.nbytes)

    def down(self, table: Array, address: int, pitch: int) -> None:
        """Copy rows to a contiguous table; on the device a row begins `pitch` words after the one before."""
        width = table.nbytes // len(table)
        if width == 8 * pitch:
            self._do("cuMemcpyDtoH", table.ctypes.data, address, table.nbytes)
            return
        copy = self._driver.CUDA_MEMCPY2D()
        copy.srcMemoryType = self._driver.CUmemorytype.CU_MEMORYTYPE_DEVICE
        copy.dstMemoryType = self._driver.CUmemorytype.CU_MEMORYTYPE_HOST
        copy.srcDevice, copy.srcPitch = address, 8 * pitch
        copy.dstHost, copy.dstPitch = table.ctypes.data, width
        copy.WidthInBytes, copy.Height = width, len(table)
        self._do("cuMemcpy2D", copy)

    def run(self, turns: Any, words: int, results: int, count: int) -> None:
        """Run `count` threads, each with its own words and room for results; return when they have ended."""
        address = ctypes.c_uint64
        given = (words, results, count), (address, address, ctypes.c_int64)
        blocks = -(-count // THREADS)
        self._here()
        self._do("cuLaunchKernel", turns, blocks, 1, 1, THREADS, 1, 1, 0, 0, given, 0)
        self._do("cuCtxSynchronize")


def look_for_driver() -> None:
    """Raise UsageError where a GPU cannot be accessed; nothing is opened, so the process may still be forked."""
    if importlib.util.find_spec("cuda") is None or importlib.util.find_spec("cuda.bindings") is None:
        raise UsageError(NEEDS)
    name = "nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1"
    try:
        ctypes.CDLL(name)
    except OSError as error:
        raise UsageError(NO_DEVICE.format(error)) from None


def device() -> Driver:
    """Return the device of this process; raise UsageError where there is none, or no access to it."""
    return _device_of(os.getpid())  # one that a parent opened is useless after a fork


@cache
def _device_of(_process: int) -> Driver:
    return Driver()
