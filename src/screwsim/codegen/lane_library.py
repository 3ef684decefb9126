"""Library of functions compiled for points side by side, and their entries from Python."""

from screwsim.codegen import lane_math, lane_rows
from screwsim.codegen.kinds import LANES, NOTHING, TRUTHS, Kind, words_of
from screwsim.codegen.lane_operations import MASK, WHOLE
from screwsim.codegen.lanes import LaneEmitter
from screwsim.codegen.library import Library, Writer
from screwsim.codegen.program import Program, read


class LaneLibrary(Library):
    """A library whose functions compute all lanes at once."""

    def __init__(self, program: Program) -> None:
        written = read(lane_math.texts())
        functions = written.functions.and_those_of(program.functions)
        super().__init__(Program(functions, written.constants | program.constants))

    def emitter(self, name: str, kinds: tuple[Kind, ...]) -> Writer:
        if lane_rows.KINDS.get(name) == kinds:
            return lane_rows.WRITERS[name](self)
        return LaneEmitter(self, name, kinds)

    def entry(self, name: str, kinds: tuple[Kind, ...], symbol: str) -> tuple[Kind, str]:
        """Return what `Library.entry` does; the first word has one bit for each active lane.

        An argument that differs between lanes takes one word for each lane.
        """
        lines = [f"  %bits = load i{LANES}, ptr %in", f"  %mask = bitcast i{LANES} %bits to {MASK}"]
        given, at = [f"{MASK} %mask"], 1
        for k, kind in enumerate(kinds):
            if kind.name == "c":
                lines.append(f"  %c{k} = getelementptr i64, ptr %in, i64 {at}")
                given.append(f"ptr %c{k}")
                at += words_of(kind)
                continue
            for i, part in enumerate(kind.parts):
                lines.append(f"  %p{k}.{i} = getelementptr i64, ptr %in, i64 {at}")
                lines.append(f"  %a{k}.{i} = load {part}, ptr %p{k}.{i}, align 8")
                given.append(f"{part} %a{k}.{i}")
                at += LANES if part[0] == "<" else 1
        called, returned = self.function(name, kinds)
        call = f"call {returned.returned} @{called}({', '.join(given)})"
        lines.append(f"  {call}" if returned == NOTHING else f"  %r = {call}")
        numbers = returned.of if returned.name == "t" else (returned,) if returned != NOTHING else ()
        for i, kind in enumerate(numbers):
            value, part = "%r", kind.parts[0]
            if returned.name == "t":
                value = f"%r{i}"
                lines.append(f"  {value} = extractvalue {returned.returned} %r, {i}")
            if kind == TRUTHS:
                lines.append(f"  %w{i} = zext {MASK} {value} to {WHOLE}")
                value, part = f"%w{i}", WHOLE
            if part[0] != "<":
                raise TypeError(f"{name} returns what is the same for all lanes")
            lines.append(f"  %o{i} = getelementptr i64, ptr %out, i64 {LANES * i}")
            lines.append(f"  store {part} {value}, ptr %o{i}, align 8")
        lines.append("  ret i64 0")
        return returned, self.whole_text((name, kinds), symbol, lines)
