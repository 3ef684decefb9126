"""Library of functions compiled for points side by side, and their entries from Python."""

from screwsim.codegen import lane_math, lane_rows
from screwsim.codegen.kinds import LANES, Kind
from screwsim.codegen.lane_operations import MASK
from screwsim.codegen.lanes import LaneEmitter
from screwsim.codegen.library import Library, Writer
from screwsim.codegen.program import Program, read


class LaneLibrary(Library):
    """A library whose functions compute all lanes at once; what differs between lanes takes one word for each."""

    lanes, aligned = LANES, ", align 8"

    def __init__(self, program: Program) -> None:
        written = read(lane_math.texts())
        functions = written.functions.and_those_of(program.functions)
        super().__init__(Program(functions, written.constants | program.constants))

    def emitter(self, name: str, kinds: tuple[Kind, ...]) -> Writer:
        if lane_rows.KINDS.get(name) == kinds:
            return lane_rows.WRITERS[name](self)
        return LaneEmitter(self, name, kinds)

    def beside(self) -> tuple[list[str], list[str]]:
        """Return what `Library.beside` does: the first word has one bit for each active lane."""
        bits, mask = f"  %bits = load i{LANES}, ptr %in", f"  %mask = bitcast i{LANES} %bits to {MASK}"
        return [bits, mask], [f"{MASK} %mask"]
