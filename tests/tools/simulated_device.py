"""A GPU simulated on this processor: the device's code is compiled for it, and its threads run one by one."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

import numpy as np

from screwsim.codegen import machine
from screwsim.codegen.device_library import DeviceLibrary
from screwsim.codegen.kinds import Kind, words_of
from screwsim.codegen.modules import Module
from screwsim.codegen.program import read

Array = np.ndarray
RESULTS = 3  # of a turn


@cache
def _entry(module: Module, name: str, kinds: tuple[Kind, ...], numbers: tuple[tuple[int, int], ...]) -> Any:
    """Return the machine code of a thread, once per module; a module's name is the hash of its text."""
    symbol = f"simulated.{name}"
    _, text = DeviceLibrary(read(module.text), dict(numbers)).entry(name, kinds, symbol)
    return machine.loaded(machine.compiled(text, fast=True), symbol)


class Simulated:
    """Device whose memory is that of this process; new memory is filled with NaN."""

    def __init__(self) -> None:
        self.held: dict[int, Array] = {}

    def turns(self, module: Module, name: str, kinds: tuple[Kind, ...], numbers: dict[int, int]) -> Any:
        return _entry(module, name, kinds, tuple(numbers.items())), sum(map(words_of, kinds))

    def room(self, words: int) -> int:
        table = np.full(words, np.nan)
        self.held[table.ctypes.data] = table
        return table.ctypes.data

    def free(self, address: int) -> None:
        del self.held[address]

    def up(self, address: int, table: Array) -> None:
        assert table.flags.c_contiguous
        ctypes.memmove(address, table.ctypes.data, table.nbytes)

    def down(self, table: Array, address: int, pitch: int) -> None:
        assert table.flags.c_contiguous
        width = table.nbytes // len(table)
        for i in range(len(table)):
            ctypes.memmove(table.ctypes.data + i * width, address + 8 * i * pitch, width)

    def run(self, turns: Any, words: int, results: int, count: int) -> None:
        entry, size = turns
        for i in range(count):
            assert entry(words + 8 * i * size, results + 8 * i * RESULTS) == 0
