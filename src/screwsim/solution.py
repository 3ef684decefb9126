"""One scene being solved: its machinery, the states of the lines, and the reading of a closed cycle."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property, lru_cache

import numpy as np

from screwsim import performance
from screwsim.build import build_parts, wanted_of
from screwsim.faults import UsageError
from screwsim.ledger import Cycle, ledger
from screwsim.model import close as closing
from screwsim.model.compose import Parts, compose
from screwsim.model.continuation import Course, Guess
from screwsim.model.guess import first_guess
from screwsim.model.places import SOME_OIL
from screwsim.model.run import Machinery
from screwsim.model.slots import (
    DENSITY,
    ENTHALPY,
    OIL_RATIO,
    OIL_TEMPERATURE,
    P_GAP_WIDTH,
    P_PORT_WIDTH,
    R_DISCHARGE,
    R_INJECTED,
    R_PRESSURE,
    R_RATIO,
    R_SUCTION,
    R_TRAPPED,
)
from screwsim.outputs import Figures
from screwsim.scene.lines import lines, refrigerating_effect, suction_enthalpy
from screwsim.scene.types import Scene

TRACE_STEP = 1.0  # degree


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

    def __init__(self, scene: Scene, course: Course | None = None) -> None:
        self.scene = scene
        self.course = course or Course()
        self.parts = build_parts(scene)
        self.wanted = wanted_of(scene)
        self.lines = lines(scene)
        self.machinery = machinery_for(self.parts)
        self.suction = self._suction_place()
        self.inlet = performance.Inlet(self.suction[DENSITY], self.suction[ENTHALPY])
        self.pv = self.lines.p_s / self.inlet.density
        # what tells one scene from the next on a course; tightening changes the composition's own copy
        self.parameters = np.array(
            [*self.machinery.composition.P, *self.suction, self.lines.p_d, *self.parts.geometry.outcomes]
        )
        c_oil = self.parts.oil.heat_capacity if self.parts.oil else 0.0
        self.balances = closing.Balances(self.machinery, c_oil, self._oil_in)

    def _suction_place(self) -> tuple[float, ...]:
        """Return the place of the suction line; wet where the scene gives a quality."""
        gas, at = self.parts.gas, self.lines
        if at.quality is None:
            return gas.place(at.p_s, at.T_s)
        return gas.place_of_enthalpy(at.p_s, suction_enthalpy(self.scene))

    def _oil_in(self) -> tuple[float, float]:
        T_oil = self.parts.oil.temperature if self.parts.oil else 0.0
        return float(self.machinery.R[R_INJECTED]), T_oil

    def start(self) -> closing.Array:
        """Set the plenums and a first guess; return the state at 0°."""
        machinery, lines = self.machinery, self.lines
        machinery.reset()
        y = first_guess(self.parts, machinery.composition, machinery, lines.p_s, lines.T_s, lines.p_d)
        T_d = self.scene.operation.discharge.temperature or float(y[0])
        self._set_lines(T_d, float(y[3]) if machinery.composition.carried else 0.0)
        return y

    def _set_lines(self, T_d: float, d: float) -> None:
        T_oil = self.parts.oil.temperature if self.parts.oil else self.lines.T_s
        R = self.machinery.R
        R[R_SUCTION : R_SUCTION + 8] = *self.suction, 0.0, T_oil
        R[R_DISCHARGE : R_DISCHARGE + 8] = *self.parts.gas.place(self.lines.p_d, T_d), d, T_oil

    def _continued(self) -> Guess | None:
        """Set the plenums and a guess from the course of the cycles before; return it, None where there is none."""
        machinery = self.machinery
        machinery.reset()
        guess = self.course.guess(machinery, self.parameters)
        if guess is not None:
            self._set_lines(self.scene.operation.discharge.temperature or float(guess.y[0]), 0.0)
            self.set_plenum(guess.plenum)
        return guess

    def note(self, closed: closing.Closed) -> None:
        """Leave the closed cycle to the scenes that follow on this course."""
        self.course.add(self.machinery, self.parameters, closed, self.plenum())

    def rehearse(self) -> closing.Array:
        """Do what `start` does, and set the discharge plenum once, so that all it needs is compiled."""
        y = self.start()
        self.set_plenum(self.plenum())
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
        self.machinery.composition.P[P_PORT_WIDTH : P_GAP_WIDTH + 1] *= factor

    def plenum(self) -> closing.Array:
        """Return the discharge plenum's enthalpy [J/kg], and with carried oil its ratio and temperature [K]."""
        place = self.machinery.R[R_DISCHARGE:]
        cells = (ENTHALPY, OIL_RATIO, OIL_TEMPERATURE) if self.machinery.composition.carried else (ENTHALPY,)
        return np.array([max(float(place[cell]), 1e-9) for cell in cells])

    def outflow(self, q: closing.Array) -> closing.Array:
        """Return the plenum that a cycle's outflow makes (M27): its flow-weighted mean, or the given temperature.

        What flows back beyond the outflow comes from the line and brings no oil. So the plenum is a continuous function
        of the flows: a state that jumped where the net flow passes zero would leave such a machine without a cycle.
        """
        streams = self.balances.streams(q)
        mean = closing.discharge_enthalpy(streams)
        plenum = self.plenum()
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
            plenum[1:] = (max(own * mean[1], 1e-9), mean[2]) if mean and present else (1e-9, self.parts.oil.temperature)
        return plenum

    def _h_isentropic(self) -> float:
        lines = self.lines
        if lines.quality is not None:
            return self.inlet.enthalpy + self.parts.gas.isentropic_work_of_enthalpy(
                lines.p_s, lines.p_d, self.inlet.enthalpy
            )
        return self.inlet.enthalpy + self.parts.gas.isentropic_work(lines.p_s, lines.p_d, lines.T_s)

    def set_plenum(self, plenum: closing.Array) -> None:
        """Give the discharge plenum its enthalpy and oil.

        An enthalpy on the way that no state of the gas has, extrapolated or of an outflow of nothing, leaves the place.
        """
        R = self.machinery.R
        try:
            place = self.parts.gas.place_of_enthalpy(self.lines.p_d, float(plenum[0]))
        except UsageError:
            place = tuple(R[R_DISCHARGE : R_DISCHARGE + OIL_RATIO])
        R[R_DISCHARGE : R_DISCHARGE + len(place)] = place
        if len(plenum) == 3:
            R[R_DISCHARGE + OIL_RATIO], R[R_DISCHARGE + OIL_TEMPERATURE] = plenum[1:]

    def residue(self, q: closing.Array) -> float:
        """Return the larger of the relative residues of mass and energy."""
        return max(self.balances.residues(q, float(self.machinery.R[R_TRAPPED]), self.inlet.enthalpy, self.pv)[:2])

    def least(self, q: closing.Array) -> tuple[float, float]:
        """Return the power [W] and the work of a cycle [J] below which they are rounding."""
        work = closing.LEAST_WORK * max(float(self.machinery.R[R_TRAPPED]), 0.0) * self.pv
        return work * self.parts.omega / self.parts.geometry.pitch, work

    # ---- taking the figures ----------------------------------------------------------------------------------

    def _known(self, q: closing.Array) -> performance.CycleFigures:
        """Return what a power loss can ask of the cycle."""
        R, supply, oil = self.machinery.R, self.scene.oil_supply, self.scene.oil
        source = self.lines.p_s if supply is not None and supply.source == "suction" else self.lines.p_d
        viscosity = oil.viscosity if oil is not None else None
        return performance.cycle_figures(
            self.parts, float(q[0]), float(R[R_INJECTED]), float(R[R_PRESSURE]), viscosity, source
        )

    @cached_property
    def _effect(self) -> float | None:
        return refrigerating_effect(self.scene)

    def figures(self, q: closing.Array) -> tuple[Figures, dict[str, str]]:
        """Return performance figures of the last history, whose quadratures are q, and why some are None."""
        R, m = self.machinery.R, self.machinery
        limit = self.parts.geometry.widest_discharge()
        times, dense, _, steps = m.last()
        found, notes = performance.figures(
            self.parts,
            self.lines,
            self.inlet,
            self.balances.streams(q),
            self._known(q),
            work=float(q[0]),
            trapped=float(R[R_TRAPPED]),
            d=float(R[R_RATIO]),
            peak=float(m.module.trace__peak_pressure(times, dense, steps, limit, m.context)),
            oil_mean_temperature=self._oil_discharge_temperature(q),
        )
        cooling, reasons = performance.refrigeration(found, self.inlet.density, self._effect)
        return Figures(found | cooling), notes | reasons

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
        return mean[2] if mean is not None and mean[2] > 0.0 and mean[1] >= SOME_OIL else None

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
        rate = self.parts.omega / self.parts.geometry.pitch
        carried = float(self.machinery.R[R_INJECTED]) * oil.heat_capacity * (T_out - oil.temperature)
        return float(-q[1] - carried) * rate

    def cycle(self) -> dict[str, np.ndarray]:
        """Return the traces over the angle (contract: cycle)."""
        m, c, geometry = self.machinery, self.machinery.composition, self.parts.geometry
        degrees = trace_angles(geometry.life)
        out = np.empty((len(degrees), 4 + len(c.states)))
        flows = np.empty((len(degrees), len(c.plenum_paths) + 2 * len(c.gap_paths)))
        angles = np.minimum(np.radians(degrees), geometry.life)
        m.module.trace__sample(angles, *m.last(), m.context, c.n_E, out, flows)
        traces = {"angle": degrees, "volume": out[:, 0], "pressure": out[:, 1], "work": out[:, 2]}
        traces |= {"gas_temperature": out[:, 4], "gas_mass": out[:, 5] * out[:, 0]}
        if "T_oil" in c.states:
            present = c.carried | (degrees >= math.degrees(geometry.injection_angle))
            traces["oil_temperature"] = np.where(present, out[:, 6], np.nan)
            ratio = out[:, 7] if c.carried else np.where(present, float(m.R[R_RATIO]), 0.0)
            traces["oil_mass"] = ratio * traces["gas_mass"]
        _smooth_plenum_flows(flows, len(c.plenum_paths), self.parts.omega * out[:, 3])
        for i, name in enumerate(c.plenum_paths):
            traces[f"mass_flow_{name}"] = traces.get(f"mass_flow_{name}", 0.0) + flows[:, i]
        for i, (name, _) in enumerate(c.gap_paths):
            for side, word in enumerate(("leading", "trailing")):
                key, column = f"mass_flow_{name}_{word}", len(c.plenum_paths) + 2 * i + side
                traces[key] = traces.get(key, 0.0) + flows[:, column]
        return traces


def trace_angles(life: float) -> np.ndarray:
    """Return the angles of a trace [degree]: every degree of a life [rad], and its end."""
    end = math.degrees(life)
    degrees = np.arange(0.0, end + 1e-6, TRACE_STEP)
    return degrees if end - degrees[-1] < 1e-6 else np.append(degrees, end)


def _delivers(streams: closing.Array) -> bool:
    """Tell whether the net flow goes to the discharge line."""
    return bool(streams[2, 0] + streams[3, 0] < 0.0)


def _smooth_plenum_flows(flows: np.ndarray, paths: int, mass_rate: np.ndarray) -> None:
    """Where one port alone is open, take its flow from the mass balance, in place.

    Between steps a wide port's tiny Δp carries the whole error of the interpolated pressure; dm/dφ does not.
    """
    open_ports = np.abs(flows[:, :paths]) > 0.0
    alone = np.count_nonzero(open_ports, axis=1) == 1
    leaks = flows[:, paths:].sum(axis=1)
    for i in range(paths):
        mine = alone & open_ports[:, i]
        flows[mine, i] = mass_rate[mine] - leaks[mine]
