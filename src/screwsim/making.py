"""What a cycle makes beside its states and that acts back on it: the discharge line, and what effects declare."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np

from screwsim.effects.base import LineFlow, Made, Turn
from screwsim.effects.gap import ClearanceParameters
from screwsim.faults import UsageError, own_number
from screwsim.model import close as closing
from screwsim.model import residues
from screwsim.model.slots import (
    DENSITY,
    DISSOLVED,
    ENTHALPY,
    OIL_RATIO,
    OIL_TEMPERATURE,
    PLACE,
    PRESSURE,
    R_DISCHARGE,
    R_SUCTION,
)
from screwsim.prepared import Prepared

LINE_POINTS = 64  # of a pitch, at which the flow to a pulsating line is taken


class Making(Prepared):
    """A prepared scene that turns quadratures of a cycle into what that cycle makes."""

    def once(self, name: str, q: closing.Array, read: Callable[[], Any]) -> Any:
        """Return what `read` gives of the last history, whose quadratures are q; read once for as long as it stands.

        That of the history before is kept, too: an estimate leaves a history for another one and comes back to it.
        """
        machinery = self.machinery
        state = machinery.stamp, q.tobytes(), machinery.composition.P.tobytes(), machinery.R.tobytes()
        found = self._read.get(state)
        if found is None:
            if len(self._read) > 1:
                del self._read[next(iter(self._read))]
            found = self._read[state] = {}
        if name not in found:
            found[name] = read()
        return found[name]

    def made(self) -> closing.Array:
        """Return what the cycle makes, as the next turn meets it: the discharge line, and what effects declare."""
        composition = self.machinery.composition
        return np.concatenate([self._line(), composition.P[list(composition.made)]])

    def set_made(self, values: closing.Array) -> None:
        """Let the next turn be integrated with these."""
        line = len(values) - len(self.parts.made)
        self._set_line(values[:line])
        self.machinery.composition.P[list(self.machinery.composition.made)] = values[line:]

    def image(self, q: closing.Array) -> closing.Array:
        """Return what a cycle of these quadratures makes."""
        line = self._outflow(q)
        return np.concatenate([line, list(self._imaged(q).made.values())]) if self.parts.made else line

    def _imaged(self, q: closing.Array) -> Turn:
        """Return the turn of these quadratures with what it makes."""
        return self.once("turn", q, lambda: self._newly_imaged(q))

    def turn(self, q: closing.Array) -> Turn:
        """Return what the last turn, whose quadratures are q, tells of itself."""
        return self._imaged(q)

    def _newly_imaged(self, q: closing.Array) -> Turn:
        made: dict[str, float] = {}
        turn = self._turn(q, made)
        for name, part in self.parts.all(Made):
            image = part.image(turn)
            if np.isfinite(q[0]):
                own_number(name, f"what the cycle makes of {part.entry.name}", image)
            made[part.entry.name] = max(float(image), part.least)
        return turn

    def _turn(self, q: closing.Array, made: dict[str, float]) -> Turn:
        """Return what a turn of these quadratures tells effects that declare what the cycle makes.

        `made`, empty as yet, gets the numbers with which the turn was integrated.
        """
        P, rate = self.machinery.composition.P, self.parts.omega / self.parts.geometry.pitch
        sums = rate * self.balances.walls(q)
        names = [wall.name for _, wall in self.parts.walls]
        held = dict(zip(self.parts.made, P[list(self.machinery.composition.made)].tolist(), strict=True))
        made |= held
        return Turn(
            held,
            made,
            dict(zip(names, sums[:, 0].tolist(), strict=True)),
            dict(zip(names, sums[:, 1].tolist(), strict=True)),
            dict(self._gaps()),
            self.scene.operation.ambient_temperature,
            self._line_flows(q),
            self.parts.omega,
            self.parts.geometry.pitch,
            not self.parts.plenums,
        )

    def _line_flows(self, q: closing.Array) -> Callable[[str], LineFlow]:
        """Return a function that tells of the flow to a line; all is read once, when it is first asked."""
        taken = cache(lambda: self.machinery.into_lines(LINE_POINTS))
        return cache(lambda to: self._line_flow(q, self.parts.number(to), *taken()))

    def _line_flow(self, q: closing.Array, number: int, flows: closing.Array, volumes: closing.Array) -> LineFlow:
        """Return the flow of the chambers into a line over one pitch; its mean is that of the quadratures."""
        R, flow = self.machinery.R, flows[number]
        streams = self.balances.streams(q)[2 * number : 2 * number + 2, 0]
        mean = -float(streams.sum()) * self.parts.omega / self.parts.geometry.pitch
        place = R[number * PLACE : (number + 1) * PLACE]
        p, rho, _h, exponent, *_ = self.parts.gas.place_of_enthalpy(float(place[PRESSURE]), float(place[ENTHALPY]))
        return LineFlow(flow + (mean - flow.mean()), float(volumes[number]), p, rho, 1.0 / exponent)

    def _gaps(self) -> Iterator[tuple[str, float]]:
        """Yield the stated clearances [m] by effect."""
        for name, active in self.scene.effects.items():
            if isinstance(active.parameters, ClearanceParameters):
                yield name, active.parameters.gap

    def beyond(self) -> str:
        """Return why what the cycle makes stopped at its end, and what to do; empty where nothing did."""
        values = self.machinery.composition.P[list(self.machinery.composition.made)]
        parts = (part for _, part in self.parts.all(Made))
        reasons = [
            part.beyond
            for part, value in zip(parts, values, strict=True)
            if value <= part.least + 1e-9 * abs(part.least)
        ]
        return reasons[0] if reasons else ""

    def _line(self) -> closing.Array:
        """Return the discharge line's enthalpy [J/kg]; with carried oil ratio, temperature [K], gas held if a state."""
        place = self.machinery.R[R_DISCHARGE:]
        cells = (ENTHALPY, OIL_RATIO, OIL_TEMPERATURE) if self.machinery.composition.carried else (ENTHALPY,)
        cells = (*cells, DISSOLVED) if self.parts.dissolves else cells
        return np.array([max(float(place[cell]), 1e-9) for cell in cells])

    def _outflow(self, q: closing.Array) -> closing.Array:
        """Return the discharge line that an outflow makes (M27): its flow-weighted mean, or the given temperature.

        What flows back beyond the outflow comes from the line and brings no oil. So the plenum is a continuous function
        of the flows: a state that jumped where the net flow passes zero would leave such a machine without a cycle.
        A check valve lets nothing of the line back: what flows back had flowed out, in this turn or before.
        """
        streams = self.balances.streams(q)
        mean = residues.discharge_enthalpy(streams)
        plenum = self._line()
        if self.parts.held_back and mean is None:
            return plenum
        given = self.scene.operation.discharge.temperature is not None
        back, out = float(streams[2, 0]), -float(streams[3, 0])
        all_own = back <= max(out, 0.0) or self.parts.held_back
        own = 1.0 if all_own else out / back  # share of what flows back that had flowed out before
        if not given:
            plenum[0] = mean[0] if mean is not None else 0.0
            if mean is None or own < 1.0:
                plenum[0] = own * plenum[0] + (1.0 - own) * self._h_isentropic()
        if len(plenum) >= 3:
            assert self.parts.oil is not None  # carried
            present = mean is not None and mean[2] > 0.0
            dry = 1e-9, self.parts.oil.temperature + self._pressed(self.lines.p_d)
            plenum[1:3] = (max(own * mean[1], 1e-9), mean[2]) if mean and present else dry
            plenum[3:] = residues.discharge_held(streams)
        return plenum

    def _set_line(self, plenum: closing.Array) -> None:
        """Give the discharge line its enthalpy and oil.

        An enthalpy on the way that no state of the gas has, extrapolated or of an outflow of nothing, leaves the place.
        """
        R = self.machinery.R
        try:
            place = self.parts.gas.place_of_enthalpy(self.lines.p_d, float(plenum[0]))
            if self.suction.returned > 0.0:
                R[R_SUCTION : R_SUCTION + OIL_RATIO] = self.suction.place(float(plenum[0]))
        except UsageError:
            place = None
        if place is not None:
            R[R_DISCHARGE : R_DISCHARGE + len(place)] = place
        if len(plenum) >= 3:
            R[R_DISCHARGE + OIL_RATIO], R[R_DISCHARGE + OIL_TEMPERATURE] = plenum[1:3]
            R[R_DISCHARGE + DISSOLVED : R_DISCHARGE + DISSOLVED + len(plenum) - 3] = plenum[3:]
            if place is not None:
                R[R_DISCHARGE + DENSITY] *= self._share(place[DENSITY], float(plenum[1])) ** 2
