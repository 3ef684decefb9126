"""The gas dissolved in oil, in the ledger: its exergy rise, its mixing, what a line takes of it.

It applies where the dissolved gas is a state of the chambers. Source: docs/model.md M233, M234.
"""

from collections.abc import Callable, Mapping

from screwsim.cycle.suction_line import Stream
from screwsim.effects.base import DISCHARGE, OilSolution
from screwsim.evaluate.ledger.book import FlowEnd, LedgerCycle, State, exergy_over
from screwsim.fluid.reservoir import Reservoir
from screwsim.model import ledger as kernels
from screwsim.model.slots import DISCHARGE_IN, DISCHARGE_OUT, DISSOLVED, OF_HELD, OF_OIL, PORT_OIL, R_DISCHARGE


class DissolvedGas:
    """The gas dissolved in oil: entropy and exergy (M233, M234) over gas at the state (h, s) of the suction line."""

    def __init__(self, cycle: LedgerCycle, suction: State) -> None:
        self.cycle, self.suction = cycle, suction
        assert isinstance(cycle.parts.oil_content, OilSolution)  # `Parts.dissolves`
        self.content = cycle.parts.oil_content

    def entropies(self, w: float) -> tuple[float, float]:
        """Return the entropy of the dissolved gas [J/(kg K)] in oil that holds w, and the total per kilogram of oil."""
        c = self.cycle.composition
        s, total = self.cycle.life.module.solution_entropy(w, c.P, c.TAB)
        return float(s), float(total)

    def exergy(self, held: float, entropy: float) -> float:
        """Return the exergy [W] of dissolved gas [kg/s] with an entropy [W/K]."""
        h, s, T_0 = self.suction.h, self.suction.s, self.cycle.T_0
        return held * (self.content.enthalpy - h) - T_0 * (entropy - held * s)

    def of_oil(self, oil: float, w: float) -> float:
        """Return the exergy [W] of the gas dissolved in oil [kg/s], w per kilogram of oil."""
        return self.exergy(oil * w, oil * self.entropies(w)[1])

    def of_stream(self, stream: Stream) -> float:
        """Return the exergy [W] of the gas dissolved in the oil of a stream, uniform in all its oil."""
        return self.of_oil(stream.oil, stream.held / stream.oil) if stream.oil > 0.0 else 0.0

    def mix(self, paths: list[tuple[str, list[float]]], stream: Stream, add: Callable[..., None]) -> None:
        """Enter the mixing of oil from several paths to the mean content of the whole stream (M233)."""
        w = stream.held / stream.oil if stream.oil > 0.0 else 0.0
        s, total = self.entropies(w)
        for name, row in paths:
            oil, gas, entropy = (row[i] for i in (kernels.OUT_OIL, kernels.OUT_HELD, kernels.OUT_HELD_ENTROPY))
            if oil > 0.0:
                add(name, entropy=oil * total + s * (gas - oil * w) - entropy)

    def of_gas(self, gas: float, state: Reservoir) -> float:
        """Return the exergy [W] of gas [kg/s] of a state."""
        return gas * exergy_over(state, self.suction, self.cycle.T_0)

    def at_lines(self, ends: Mapping[FlowEnd, list[tuple[str, list[float]]]], add: Callable[..., None]) -> None:
        """Enter the mixing of the oil that leaves to the discharge line, by path, and what other ends take (M234).

        `ends` holds the paths that lead to each end, with their sums.
        """
        out, held = self.flow_out()
        self.mix(
            [each for end, some in ends.items() if end.name == DISCHARGE for each in some],
            Stream(oil=out, held=held),
            add,
        )
        for end, paths in ends.items():
            for _, row in paths if not end.kept else ():
                if row[kernels.OUT_OIL] > 0.0:
                    add(end.entry, exergy=self.exergy(row[kernels.OUT_HELD], row[kernels.OUT_HELD_ENTROPY]))

    def flow_out(self) -> tuple[float, float]:
        """Return the oil [kg/s] that leaves to the discharge line, and the gas [kg/s] dissolved in it."""
        out = self.cycle.streams[DISCHARGE_OUT]
        return -self.cycle.rate * float(out[OF_OIL]), -self.cycle.rate * float(out[OF_HELD])

    def rise(self) -> float:
        """Return the exergy [W] of what leaves to the discharge line, less that of what comes with the oil."""
        cycle = self.cycle
        out, held = self.flow_out()
        back, supplied = (cycle.rate * float(cycle.streams[row, OF_OIL]) for row in (DISCHARGE_IN, PORT_OIL))
        w_line = float(cycle.R[R_DISCHARGE + DISSOLVED])
        found = self.of_oil(out, held / out) if out > 0.0 else 0.0
        return found - self.of_oil(back, w_line) - self.of_oil(supplied, self.content.supply)
