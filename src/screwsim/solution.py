"""One scene being solved: its machinery, the states of the lines, and the reading of a closed cycle."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, cached_property, lru_cache

import numpy as np

from screwsim import expander, performance
from screwsim.build import build_parts, build_site, wanted_of
from screwsim.effects.base import Drawn, LineFlow, Made, Plenum, Turn
from screwsim.effects.gap import ClearanceParameters
from screwsim.faults import UsageError
from screwsim.intake import suction_of
from screwsim.ledger import Cycle, ledger
from screwsim.model import close as closing
from screwsim.model.compose import compose
from screwsim.model.continuation import Course, Guess
from screwsim.model.guess import first_guess
from screwsim.model.parts import Parts
from screwsim.model.pitch import Pitch, pitch_of
from screwsim.model.places import SOME_OIL
from screwsim.model.run import Machinery
from screwsim.model.slots import (
    DENSITY,
    ENTHALPY,
    FIRST_OWN,
    OIL_RATIO,
    OIL_TEMPERATURE,
    PLACE,
    PLENUM_ENTROPY,
    PORT_OIL,
    PRESSURE,
    Q_WALLS,
    R_DISCHARGE,
    R_INJECTED,
    R_PRESSURE,
    R_RATIO,
    R_SUCTION,
    R_TRAPPED,
)
from screwsim.numerics.made import Entries
from screwsim.outputs import PERFORMANCE, Figures
from screwsim.scene.lines import lines, refrigerating_effect, suction_enthalpy
from screwsim.scene.types import Scene
from screwsim.traces import line_flows, traces

LINE_POINTS = 64  # of a pitch, at which the flow to a pulsating line is taken
NO_LIQUID = "known only where net gas is delivered in a scene that states evaporating and condensing temperature"


@lru_cache(maxsize=8)
def _shelf(text: str) -> dict[str, Machinery]:
    return {}


def machinery_for(parts: Parts) -> Machinery:
    """Return working arrays for the parts; those of the last scene of the same structure are used again."""
    composition = compose(parts)
    shelf = _shelf(composition.text)
    if "it" in shelf:
        shelf["it"].composition = composition
    else:
        shelf["it"] = Machinery(composition)
    return shelf["it"]


class Solution:
    """One scene being solved: the machinery, the lines, and what is asked of the closing."""

    def __init__(self, scene: Scene, course: Course | None = None, set_speed: float | None = None) -> None:
        """Prepare a scene; `set_speed` [rad/s]: what was stated, where the scene's speed was found from it."""
        self.scene = scene
        self.course = course or Course()
        self.parts = replace(build_parts(scene), set_speed=set_speed)
        self.wanted = wanted_of(scene)
        self.lines = lines(scene)
        self.machinery = machinery_for(self.parts)
        line = self._suction_place()
        self.inlet = performance.Inlet(line[DENSITY], line[ENTHALPY])
        self.suction = suction_of(self.parts.gas, line, self.parts.effects.values())
        begins = self.suction.place(self._h_isentropic()) if self.suction.changed else line
        self.pv = self.lines.p_s / self.inlet.density
        # what tells one scene from the next on a course; tightening changes the composition's own copy
        self.parameters = np.array(
            [*self.machinery.composition.P, *begins, self.lines.p_d, *self.parts.geometry.outcomes]
        )
        c_oil = self.parts.oil.heat_capacity if self.parts.oil else 0.0
        self.balances = closing.Balances(self.machinery, c_oil, self._oil_in)
        line_entries = closing.discharge_line(self.machinery.composition.carried)
        self.entries = Entries([*line_entries, *(part.entry for _, part in self.parts.all(Made))])

    def _suction_place(self) -> tuple[float, ...]:
        """Return the place of the suction line; wet where the scene gives a quality."""
        gas, at = self.parts.gas, self.lines
        if at.quality is None:
            return gas.place(at.p_s, at.T_s)
        return gas.place_of_enthalpy(at.p_s, suction_enthalpy(self.scene))

    def _oil_in(self) -> tuple[float, float]:
        """Return the oil [kg] injected at one angle, and its enthalpy over its heat capacity [K]."""
        R, oil = self.machinery.R, self.parts.oil
        if oil is None:
            return 0.0, 0.0
        return float(R[R_INJECTED]), oil.temperature + self._pressed(max(oil.source_pressure, float(R[R_PRESSURE])))

    def _pressed(self, p: float) -> float:
        """Return p/(ρ_oil c_oil) [K], by which a place's oil temperature is higher where the oil takes room (M108)."""
        oil = self.parts.oil
        return p / (oil.density * oil.heat_capacity) if oil is not None and self.parts.oil_room else 0.0

    def _share(self, rho: float, ratio: float) -> float:
        """Return the gas's share of a volume, 1 where the oil takes no room (M106)."""
        return 1.0 / (1.0 + ratio * rho / self.parts.oil.density) if self.parts.oil and self.parts.oil_room else 1.0

    def start(self) -> closing.Array:
        """Set the plenums and a first guess; return the state at 0°."""
        machinery, lines = self.machinery, self.lines
        machinery.reset()
        place = self.suction.place(self._h_isentropic()) if self.suction.changed else self.suction.line
        T_s = self.suction.temperature(place, lines.T_s)
        y = first_guess(self.parts, machinery.composition, machinery, place[PRESSURE], T_s, lines.p_d)
        T_d = self.scene.operation.discharge.temperature or float(y[0])
        self._set_lines(T_d, float(y[3]) if machinery.composition.carried else 0.0)
        machinery.composition.P[list(machinery.composition.made)] = list(self.parts.made.values())
        return y

    def _set_lines(self, T_d: float, d: float) -> None:
        T_oil = self.parts.oil.temperature if self.parts.oil else self.lines.T_s
        R = self.machinery.R
        discharge = self.parts.gas.place(self.lines.p_d, T_d)
        R[R_SUCTION : R_SUCTION + 8] = *self.suction.place(discharge[ENTHALPY]), 0.0, T_oil
        R[R_DISCHARGE : R_DISCHARGE + 8] = *discharge, d, T_oil + self._pressed(self.lines.p_d)
        R[R_DISCHARGE + DENSITY] *= self._share(float(R[R_DISCHARGE + DENSITY]), d) ** 2
        for i, state in enumerate(self.parts.plenums.values(), FIRST_OWN):
            R[i * PLACE : i * PLACE + 8] = *state.place, 0.0, T_oil
            R[i * PLACE + PLENUM_ENTROPY] = state.s

    def _continued(self) -> Guess | None:
        """Set the plenums and a guess from the course of the cycles before; return it, None where there is none."""
        machinery = self.machinery
        machinery.reset()
        guess = self.course.guess(machinery, self.parameters)
        if guess is not None:
            self._set_lines(self.scene.operation.discharge.temperature or float(guess.y[0]), 0.0)
            self.set_made(guess.made)
        return guess

    def note(self, closed: closing.Closed) -> None:
        """Leave the closed cycle to the scenes that follow on this course."""
        self.course.add(self.machinery, self.parameters, closed, self.made())

    def rehearse(self) -> closing.Array:
        """Do what `start` does, and set what the cycle makes once, so that all it needs is compiled."""
        y = self.start()
        self.set_made(self.made())
        return y

    def close(self) -> closing.Closed:
        """Close the cycle: continued from the course's last ones where that closes it, else from the first guess."""
        integrator, guess = self.scene.numerics.integrator, self._continued()
        if guess is not None:
            closed = closing.close(self, guess.y, integrator, guess.hope)
            if closed.status == "ok":
                return closed
        return closing.close(self, self.start(), integrator)

    def outside(self, closed: closing.Closed) -> bool:
        """Tell whether the state where closing stopped, or the cycle that it left, is outside the gas's equation."""
        gas = self.parts.gas
        if closed.status == "failed":
            return gas.why_outside(float(closed.y[0]), float(closed.y[1])) is not None
        _, dense, _, steps = self.machinery.last()
        T, rho = (np.ascontiguousarray(dense[:steps, 1, column]) for column in (0, 1))
        return gas.first_outside(T, rho) is not None

    def tighten(self, factor: float) -> None:
        """Multiply the tolerances and the widths of the regularisation."""
        self.wanted = replace(self.wanted, rtol=factor * self.wanted.rtol, tolerance=factor * self.wanted.tolerance)
        self.machinery.composition.P[self.machinery.composition.widths] *= factor

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
        made: dict[str, float] = {}
        turn = self._turn(q, made)
        for _, part in self.parts.all(Made):
            made[part.entry.name] = max(float(part.image(turn)), part.least)
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
        )

    def _line_flows(self, q: closing.Array) -> Callable[[str], LineFlow]:
        """Return a function that tells of the flow to a line; all is read once, when it is first asked."""
        taken = cache(lambda: line_flows(self.parts, self.machinery, LINE_POINTS))
        return cache(lambda to: self._line_flow(q, to, *taken()[to]))

    def _line_flow(self, q: closing.Array, to: str, flow: closing.Array, volume: float) -> LineFlow:
        """Return the flow of the chambers into a line over one pitch; its mean is that of the quadratures."""
        R, number = self.machinery.R, self.parts.number(to)
        streams = self.balances.streams(q)[2 * number : 2 * number + 2, 0]
        mean = -float(streams.sum()) * self.parts.omega / self.parts.geometry.pitch
        place = R[number * PLACE : (number + 1) * PLACE]
        p, rho, _h, exponent, *_ = self.parts.gas.place_of_enthalpy(float(place[PRESSURE]), float(place[ENTHALPY]))
        return LineFlow(flow + (mean - flow.mean()), volume, p, rho, 1.0 / exponent)

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
        """Return the discharge line's enthalpy [J/kg], and with carried oil its ratio and temperature [K]."""
        place = self.machinery.R[R_DISCHARGE:]
        cells = (ENTHALPY, OIL_RATIO, OIL_TEMPERATURE) if self.machinery.composition.carried else (ENTHALPY,)
        return np.array([max(float(place[cell]), 1e-9) for cell in cells])

    def _outflow(self, q: closing.Array) -> closing.Array:
        """Return the discharge line that an outflow makes (M27): its flow-weighted mean, or the given temperature.

        What flows back beyond the outflow comes from the line and brings no oil. So the plenum is a continuous function
        of the flows: a state that jumped where the net flow passes zero would leave such a machine without a cycle.
        """
        streams = self.balances.streams(q)
        mean = closing.discharge_enthalpy(streams)
        plenum = self._line()
        given = self.scene.operation.discharge.temperature is not None
        back, out = float(streams[2, 0]), -float(streams[3, 0])
        own = 1.0 if back <= out else out / back  # share of what flows back that had flowed out before
        if not given:
            plenum[0] = mean[0] if mean is not None else 0.0
            if mean is None or own < 1.0:
                plenum[0] = own * plenum[0] + (1.0 - own) * self._h_isentropic()
        if len(plenum) == 3:
            assert self.parts.oil is not None  # carried
            present = mean is not None and mean[2] > 0.0
            dry = 1e-9, self.parts.oil.temperature + self._pressed(self.lines.p_d)
            plenum[1:] = (max(own * mean[1], 1e-9), mean[2]) if mean and present else dry
        return plenum

    def _h_isentropic(self) -> float:
        lines = self.lines
        if lines.quality is not None:
            return self.inlet.enthalpy + self.parts.gas.isentropic_work_of_enthalpy(
                lines.p_s, lines.p_d, self.inlet.enthalpy
            )
        return self.inlet.enthalpy + self.parts.gas.isentropic_work(lines.p_s, lines.p_d, lines.T_s)

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
        if len(plenum) == 3:
            R[R_DISCHARGE + OIL_RATIO], R[R_DISCHARGE + OIL_TEMPERATURE] = plenum[1:]
            if place is not None:
                R[R_DISCHARGE + DENSITY] *= self._share(place[DENSITY], float(plenum[1])) ** 2

    def residue(self, q: closing.Array) -> float:
        """Return the larger of the relative residues of mass and energy."""
        return max(self.balances.residues(q, float(self.machinery.R[R_TRAPPED]), self.inlet.enthalpy, self.pv)[:2])

    def least(self, q: closing.Array) -> tuple[float, float]:
        """Return the power [W] and the work of a cycle [J] below which they are rounding."""
        work = closing.LEAST_WORK * max(float(self.machinery.R[R_TRAPPED]), 0.0) * self.pv
        return work * self.lives_per_second, work

    @property
    def lives_per_second(self) -> float:
        """Return how many chambers are born a second [1/s]."""
        return self.parts.omega / self.parts.geometry.pitch

    # ---- taking the figures ----------------------------------------------------------------------------------

    def _known(self, q: closing.Array) -> performance.CycleFigures:
        """Return what a power loss or a reading can ask of the cycle."""
        R, oil, parts = self.machinery.R, self.scene.oil, self.parts
        T_oil = parts.oil.temperature if parts.oil is not None else None
        injected, p_injection = float(R[R_INJECTED]), float(R[R_PRESSURE])
        if self.machinery.composition.ported:
            injected = float(self.balances.streams(q)[PORT_OIL, 2])
            mass, pressure = self.machinery.port_oil()
            p_injection = pressure / mass if mass > 0.0 else p_injection
        return performance.cycle_figures(
            parts,
            float(q[0]),
            injected,
            oil_viscosity=oil.at(T_oil).viscosity if oil is not None and T_oil is not None else None,
            injection_pressure=p_injection,
            oil_source_pressure=parts.oil.source_pressure if parts.oil is not None else self.lines.p_d,
            oil_temperature=T_oil,
            oil_discharge_temperature=self._oil_discharge_temperature(q) if oil is not None else None,
            oil_viscosity_at=lambda T: oil.at(T).viscosity if oil is not None else None,
            oil_density_at=lambda T: oil.at(T).density if oil is not None else None,
            pitch=cache(lambda: self._pitch(q)),
            turn=self._imaged(q),
        )

    def _pitch(self, q: closing.Array) -> Pitch:
        geometry = self.parts.geometry
        suction = float(self.machinery.R[R_SUCTION + PRESSURE])
        low, high = min(suction, self.lines.p_d), max(suction, self.lines.p_d)
        return pitch_of(self.machinery, geometry, low, float(q[0]) / geometry.pitch, high)

    @cached_property
    def _effect(self) -> float | None:
        return refrigerating_effect(self.scene)

    def figures(self, q: closing.Array) -> tuple[Figures, dict[str, str]]:
        """Return performance figures of the last history, whose quadratures are q, and why some are None."""
        R, m = self.machinery.R, self.machinery
        geometry = self.parts.geometry
        limit = geometry.life if geometry.expands else geometry.widest_discharge()
        times, dense, _, steps = m.last()
        known = self._known(q)
        found, notes = performance.figures(
            self.parts,
            self.lines,
            self.inlet,
            self.balances.streams(q),
            known,
            delivered=1.0 - self.suction.returned,
            work=float(q[0]),
            trapped=float(R[R_TRAPPED]),
            d=self._oil_ratio(),
            peak=float(m.module.trace__peak_pressure(times, dense, steps, limit, m.context)),
        )
        own = self._own_figures(q)
        found |= own
        notes |= dict.fromkeys((name for name, value in own.items() if value is None), NO_LIQUID)
        gain = own.get("economizer_capacity_gain") or 0.0
        effect = None if self._effect is None else self._effect * (1.0 + gain)
        cooling, reasons = performance.refrigeration(found, self.inlet.density, effect)
        found, notes = found | cooling, notes | reasons
        if self.suction.changed:
            place = self.suction.place(float(R[R_DISCHARGE + ENTHALPY]))
            found["intake_pressure"] = place[PRESSURE]
            found["intake_temperature"] = self.suction.temperature(place, self.lines.T_s)
        if geometry.expands:
            changed, reasons = expander.figures(found, self._h_isentropic() - self.inlet.enthalpy, self._filled())
            found, notes = found | changed, {name: why for name, why in notes.items() if name not in changed} | reasons
        if m.composition.walls:
            found["wall_heat"] = (
                float(q[Q_WALLS : Q_WALLS + 2 * len(m.composition.walls) : 2].sum()) * self.lives_per_second
            )
        return Figures(found | performance.readings(self.parts.effects, known, found)), notes

    def complete(self, q: closing.Array) -> performance.CycleFigures:
        """Return what a shaft asks of the cycle: what is known of it, and the shaft power."""
        return replace(self._known(q), shaft_power=self.figures(q)[0].shaft_power)

    def pitch_of(self, q: closing.Array) -> Pitch:
        """Return the pitch of the last history, whose quadratures are q."""
        return self._pitch(q)

    def loss_torque(self, q: closing.Array, omega: float) -> float:
        """Return the torque of the losses and of the oil's lift at a mean speed [rad/s], from one pitch's q (M213)."""
        known, share = self._known(q), omega / self.parts.omega
        names = ("tip_speed", "indicated_power", "oil_mass_flow", "oil_volume_flow")
        known = replace(known, omega=omega, **{name: share * getattr(known, name) for name in names})
        return performance.loss_power(self.parts, self.lines, known) / omega

    def _filled(self) -> float | None:
        """Return the gas that fills an expander's chambers where its inlet closes, at the inlet's state [kg/s]."""
        geometry, c = self.parts.geometry, self.machinery.composition
        closes = geometry.inlet_closes
        if closes is None:
            return None
        volume = float(self.machinery.module.volume_at(closes, c.P, c.TAB))
        return self.inlet.density * volume * self.parts.omega / geometry.pitch

    def _oil_ratio(self) -> float:
        """Return oil per gas at the injection angle, or where the injection through a port ends."""
        port = self.parts.oil_port
        if port is None:
            return float(self.machinery.R[R_RATIO])
        return float(self.machinery.states_at(np.array([port.closes]))[0, 3])

    def _own_figures(self, q: closing.Array) -> dict[str, float | None]:
        """Return what the effects say of the cycle by their own plenums."""
        found: dict[str, float | None] = {}
        if self.parts.plenums:
            streams, rate = self.balances.streams(q)[:, 0], self.lives_per_second
            site, suction = build_site(self.scene, self.parts.gas), float(streams[0] + streams[1]) * rate
            for _, plenum in self.parts.all(Plenum):
                i = 2 * self.parts.number(plenum.name)
                drawn = Drawn(float(streams[i] + streams[i + 1]) * rate, suction, self.parts.plenums[plenum.name], site)
                found |= plenum.figures(drawn) if plenum.figures is not None else {}
        unknown = sorted(set(found) - set(PERFORMANCE))
        if unknown:
            raise TypeError(f"a plenum gives {', '.join(unknown)}, which outputs.PERFORMANCE does not list")
        return found

    def ledger(self, q: closing.Array, shaft_power: float) -> Figures:
        """Return where the shaft power [W] goes (contract: ledger)."""
        streams, operation = self.balances.streams(q), self.scene.operation
        given = operation.discharge.temperature is not None or not _delivers(streams)
        return ledger(
            Cycle(
                self.parts,
                self.lines,
                self.machinery,
                streams,
                self._known(q),
                shaft_power,
                operation.ambient_temperature,
                given,
                self.suction,
            )
        )

    def _oil_discharge_temperature(self, q: closing.Array) -> float | None:
        """Return the oil's flow-weighted mean temperature at discharge; None without an oil temperature.

        Oil of less than `SOME_OIL` of the gas has none that the solver would answer for.
        """
        c = self.machinery.composition
        if not c.carried:
            return self._paper_oil_temperature() if "T_oil" in c.states else None
        mean = closing.discharge_enthalpy(self.balances.streams(q))
        if mean is None or not mean[2] > 0.0 or mean[1] < SOME_OIL:
            return None
        return mean[2] - self._pressed(self.lines.p_d)

    def _paper_oil_temperature(self) -> float | None:
        """Return the oil temperature weighted with the gas outflow, oil leaving at constant d (transport: paper)."""
        m = self.machinery
        times, dense, _, steps = m.last()
        heat, mass = m.module.trace__oil_with_outflow(times, dense, steps, m.context, m.composition.n_E)
        return float(heat / mass) if mass != 0.0 else None

    def balance(self, q: closing.Array) -> Figures:
        """Return the balances of a closed cycle (contract: balance)."""
        m, c = self.machinery, self.machinery.composition
        mass, energy, oil_mass = self.balances.residues(q, float(m.R[R_TRAPPED]), self.inlet.enthalpy, self.pv)
        residue = None
        if "T_oil" in c.states and not c.carried:
            residue = self._oil_residue(q)
        return Figures(
            mass=mass,
            energy=energy,
            oil_mass=oil_mass if c.carried else None,
            oil_residue=residue,
            bound=self.wanted.bound,
        )

    def _oil_residue(self, q: closing.Array) -> float | None:
        """Return the heat [W] that the oil takes up beyond what the injected oil carries to discharge (M40)."""
        oil, T_out = self.parts.oil, self._paper_oil_temperature()
        if oil is None or T_out is None:
            return None
        carried = float(self.machinery.R[R_INJECTED]) * oil.heat_capacity * (T_out - oil.temperature)
        return float(-q[1] - carried) * self.lives_per_second

    def cycle(self, q: closing.Array) -> dict[str, np.ndarray]:
        """Return the traces over the angle (contract: cycle); `q` are the quadratures of the last history."""
        found = traces(self.parts, self.machinery)
        degrees, pitch = found["angle"], math.degrees(self.parts.geometry.pitch)
        known = self._known(q) if self.parts.shaft is None else self.complete(q)
        for name, values in performance.pitch_traces(self.parts.effects, known).items():
            grid = np.linspace(0.0, pitch, len(values) + 1)
            found[name] = np.interp(degrees, grid, np.append(values, values[0]), period=pitch)
        return found


def _delivers(streams: closing.Array) -> bool:
    """Tell whether the net flow goes to the discharge line."""
    return bool(streams[2, 0] + streams[3, 0] < 0.0)
