"""Library of functions compiled for a GPU, one thread per point: LLVM IR without external calls.

A device has no C library: exponentials, logarithms and powers are those of the lanes (`codegen.lane_math`), the other
functions that a scene may call are written here. Products and sums are never fused, so that a device gives the same
bits as a processor with the same functions.
"""

import ast
import math
from collections.abc import Callable, Mapping, Sequence

from screwsim.codegen import lane_math
from screwsim.codegen.emit import Emitter
from screwsim.codegen.kinds import FLOAT, Kind, Value, words_of
from screwsim.codegen.lane_math import log_of_lanes
from screwsim.codegen.lane_operations import ANY_POWER, VECTORED, WRITTEN
from screwsim.codegen.library import Library
from screwsim.codegen.program import Program, read
from screwsim.numerics.kernel import Kernel, kernel

TURNS = "turns"  # symbol of the kernel for the driver
PER_LN10 = 1.0 / math.log(10.0)
PER_HALF_PI = 2.0 / math.pi
HALF_PI_HIGH, HALF_PI_LOW = 1.5707963267341256, 6.077100506506192e-11  # π/2; the high part has 33 bits: exact multiples
S3, S5, S7, S9, S11, S13, S15, S17 = ((-1.0) ** ((i - 1) // 2) / math.factorial(i) for i in range(3, 18, 2))
C4, C6, C8, C10, C12, C14, C16 = ((-1.0) ** (i // 2) / math.factorial(i) for i in range(4, 17, 2))
BY_INDEX = """define ptx_kernel void @{turns}(ptr %words, ptr %outs, i64 %count) {{
  %block = call i32 @llvm.nvvm.read.ptx.sreg.ctaid.x()
  %threads = call i32 @llvm.nvvm.read.ptx.sreg.ntid.x()
  %thread = call i32 @llvm.nvvm.read.ptx.sreg.tid.x()
  %before = mul i32 %block, %threads
  %index = add i32 %before, %thread
  %i = zext i32 %index to i64
  %ours = icmp slt i64 %i, %count
  br i1 %ours, label %turn, label %end
turn:
  %first = mul i64 %i, {words}
  %in = getelementptr i64, ptr %words, i64 %first
  %last = mul i64 %i, {results}
  %out = getelementptr i64, ptr %outs, i64 %last
  %done = call i64 @"{symbol}"(ptr %in, ptr %out)
  br label %end
end:
  ret void
}}
declare i32 @llvm.nvvm.read.ptx.sreg.ctaid.x()
declare i32 @llvm.nvvm.read.ptx.sreg.ntid.x()
declare i32 @llvm.nvvm.read.ptx.sreg.tid.x()
"""


@kernel
def log1p_on_device(x):
    """Return the logarithm of 1 + x, corrected for the rounding of the sum."""
    u = 1.0 + x
    found = log_of_lanes(u) - ((u - 1.0) - x) / u
    found = x if u == 1.0 else found
    return u if u == math.inf else found


@kernel
def log10_on_device(x):
    """Return the decimal logarithm."""
    return log_of_lanes(x) * PER_LN10


@kernel
def wave(r, quarter):
    """Return the sine of an angle within an eighth of a turn [rad] plus a number of quarter turns."""
    z = r * r
    z2 = z * z
    z4 = z2 * z2
    sine = r + r * (z * (S3 + z * S5 + z2 * (S7 + z * S9) + z4 * (S11 + z * S13 + z2 * (S15 + z * S17))))
    cosine = 1.0 - 0.5 * z + z2 * (C4 + z * C6 + z2 * (C8 + z * C10) + z4 * (C12 + z * C14 + z2 * C16))
    found = sine if quarter % 2 == 0 else cosine
    return found if quarter % 4 < 2 else -found


@kernel
def sin_on_device(x):
    """Return the sine of an angle of at most some thousand turns [rad]."""
    quarter = math.floor(x * PER_HALF_PI + 0.5)
    return wave((x - quarter * HALF_PI_HIGH) - quarter * HALF_PI_LOW, quarter)


@kernel
def cos_on_device(x):
    """Return the cosine of an angle of at most some thousand turns [rad]."""
    quarter = math.floor(x * PER_HALF_PI + 0.5)
    return wave((x - quarter * HALF_PI_HIGH) - quarter * HALF_PI_LOW, quarter + 1)


OWN: dict[str, Kernel] = {"log1p": log1p_on_device, "log10": log10_on_device}
OWN |= {"sin": sin_on_device, "cos": cos_on_device}
HELD = {**WRITTEN, **{name: each.__name__ for name, each in OWN.items()}}


class DeviceEmitter(Emitter):
    """Writes one function for a single thread."""

    def builtin(self, name: str) -> Callable[[Sequence[Value], ast.Call], Value] | None:
        found = super().builtin(name)
        if found is None or name.removeprefix("math.") in (*HELD, *VECTORED) or not name.startswith("math."):
            return found
        return lambda values, node: self._not_there(name, node)

    def _not_there(self, name: str, node: ast.AST) -> Value:
        raise self.fail(node, f"a GPU has no {name}")

    def called(self, function: str, values: Sequence[Value]) -> Value:
        if function not in HELD:
            return super().called(function, values)
        own_power = function == "pow" and self.library.program.has_own
        name = ANY_POWER if own_power else HELD[function]
        return self._kernel(name, [self.as_kind(value, FLOAT) for value in values])


class DeviceLibrary(Library):
    """A library of functions that run on a GPU."""

    def __init__(self, program: Program, known: Mapping[int, int] | None = None) -> None:
        written = read(lane_math.texts(*OWN.values(), wave))
        functions = written.functions.and_those_of(program.functions)
        super().__init__(Program(functions, written.constants | program.constants))
        self.known = known or {}

    def emitter(self, name: str, kinds: tuple[Kind, ...]) -> DeviceEmitter:
        return DeviceEmitter(self, name, kinds)

    def of_threads(self, name: str, kinds: tuple[Kind, ...]) -> str:
        """Return the text of a GPU kernel `turns(words, results, count)`, in which each thread evaluates one point."""
        symbol = "one"
        returned, text = self.entry(name, kinds, symbol)
        text = text.replace(f'define i64 @"{symbol}"', f'define internal i64 @"{symbol}"')
        words, results = sum(map(words_of, kinds)), len(returned.parts)
        return text + BY_INDEX.format(turns=TURNS, symbol=symbol, words=words, results=results)
