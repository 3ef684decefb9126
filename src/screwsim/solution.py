"""One scene being solved: its machinery, the states of the lines, and the reading of a closed cycle."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from screwsim import expander, performance
from screwsim.build import build_site
from screwsim.effects.base import Drawn, OilSolution, Plenum, Reading, Site, Turn
from screwsim.figures import Performance, borrowed, called_for
from screwsim.ledger.book import Cycle
from screwsim.ledger.total import Ledger, ledger
from screwsim.machine.built_in import built_in_volume_ratio
from screwsim.making import Making
from screwsim.model import close as closing
from screwsim.model import residues, speed
from screwsim.model.continuation import Guess
from screwsim.model.guess import first_guess
from screwsim.model.pitch import Pitch, pitch_of
from screwsim.model.places import SOME_OIL
from screwsim.model.slots import (
    DENSITY,
    DISSOLVED,
    ENTHALPY,
    FIRST_OWN,
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
from screwsim.outputs import Figure, Figures
from screwsim.scene.lines import refrigerating_effect
from screwsim.traces import traces

NO_REASON = "this cycle has none"


class Solution(Making):
    """One scene being solved: the machinery, the lines, and what is asked of the closing."""

    def start(self) -> closing.Array:
        """Set the plenums and a first guess; return the state at 0°."""
        machinery, lines = self.machinery, self.lines
        machinery.reset()
        place = self.suction.place(self._h_isentropic()) if self.suction.changed else self.suction.line
        T_s = self.suction.temperature(place, lines.T_s)
        y = first_guess(self.parts, machinery.composition, machinery, place[PRESSURE], T_s, lines.p_d)
        self._set_lines(float(y[0]), float(y[3]) if machinery.composition.carried else 0.0)
        machinery.composition.P[list(machinery.composition.made)] = list(self.parts.made.values())
        return y

    def _set_lines(self, T_d: float, d: float) -> None:
        """Set the lines to begin with; T_d [K] and the oil ratio d of the discharge line are guesses."""
        T_oil = self.parts.oil.temperature if self.parts.oil else self.lines.T_s
        R, p_d, gas = self.machinery.R, self.lines.p_d, self.parts.gas
        discharge = gas.place(p_d, self.scene.operation.discharge.temperature or gas.nearest_vapour(p_d, T_d))
        R[R_SUCTION : R_SUCTION + 8] = *self.suction.place(discharge[ENTHALPY]), 0.0, T_oil
        R[R_DISCHARGE : R_DISCHARGE + 8] = *discharge, d, T_oil + self._pressed(self.lines.p_d)
        R[R_DISCHARGE + DENSITY] *= self._share(float(R[R_DISCHARGE + DENSITY]), d) ** 2
        content = self.parts.oil_content
        if isinstance(content, OilSolution):
            R[R_DISCHARGE + DISSOLVED] = content.supply
        for i, state in enumerate(self.parts.plenums.values(), FIRST_OWN):
            R[i * PLACE : i * PLACE + 8] = *state.place, 0.0, T_oil
            R[i * PLACE + PLENUM_ENTROPY] = state.s

    def _continued(self) -> Guess | None:
        """Set the plenums and a guess from the course of the cycles before; return it, None where there is none."""
        machinery = self.machinery
        machinery.reset()
        guess = self.course.guess(machinery, self.parameters)
        if guess is not None:
            self._set_lines(float(guess.y[0]), 0.0)
            self.set_made(guess.made[: len(self.entries)])
            speed.put_back(machinery.composition, guess.made[len(self.entries) :])
        return guess

    def note(self, closed: closing.Closed) -> None:
        """Leave the closed cycle to the scenes that follow on this course.

        What the cycle makes goes as the last turn made it: one that closes at once would hand on what it was given, and
        errors of guesses would add up along the course.
        """
        made = self.entries.possible(self.image(closed.q))
        self.course.add(self.machinery, self.parameters, closed, np.concatenate([made, self._speed()]), self.wanted)

    def _speed(self) -> closing.Array:
        """Return the curve of the speed that the drive made last, or that the chambers feel; none where it is held."""
        return speed.curve_at(self.machinery.composition) if self.moved is None else self.moved

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

    def residue(self, q: closing.Array) -> float:
        """Return the largest of the relative residues of mass, energy and oil, little oil as a share of the gas."""
        mass, energy, _, oil_share = self._residues(q)
        return max(mass, energy, oil_share)

    def _residues(self, q: closing.Array) -> tuple[float, float, float, float]:
        """Return the relative residues of mass, energy and oil mass, the last twice (model.residues.Balances)."""
        trapped = float(self.machinery.R[R_TRAPPED])
        return self.once("residues", q, lambda: self.balances.residues(q, trapped, self.inlet.enthalpy, self.pv))

    def least(self, q: closing.Array) -> tuple[float, float]:
        """Return the power [W] and the work of a cycle [J] below which they are rounding."""
        work = residues.LEAST_WORK * max(float(self.machinery.R[R_TRAPPED]), 0.0) * self.pv
        return work * self.lives_per_second, work

    # ---- taking the figures ----------------------------------------------------------------------------------

    def _known(self, q: closing.Array) -> performance.CycleFigures:
        """Return what a power loss or a reading can ask of the cycle."""
        return self.once("known", q, lambda: self._newly_known(q))

    def _newly_known(self, q: closing.Array) -> performance.CycleFigures:
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
            pitch=lambda: self.pitch_of(q),
            turn=self._imaged(q) if parts.all(Reading) else None,
        )

    def _pitch(self, q: closing.Array) -> Pitch:
        geometry = self.parts.geometry
        suction = float(self.machinery.R[R_SUCTION + PRESSURE])
        low, high = min(suction, self.lines.p_d), max(suction, self.lines.p_d)
        return pitch_of(self.machinery, geometry, low, float(q[0]) / geometry.pitch, high)

    @cached_property
    def _site(self) -> Site:
        return build_site(self.scene, self.parts.gas)

    @cached_property
    def _effect(self) -> float | None:
        return refrigerating_effect(self.scene)

    @cached_property
    def called(self) -> dict[str, Figure]:
        """The figures that the scene calls for."""
        return called_for(self.scene, self.parts)

    def figures(self, q: closing.Array) -> tuple[Performance, dict[str, str]]:
        """Return performance figures of the last history, whose quadratures are q, and why some are None."""
        found, notes = self.once("figures", q, lambda: self._called_figures(q))
        return found.copy(), dict(notes)

    def _called_figures(self, q: closing.Array) -> tuple[Performance, dict[str, str]]:
        """Return those of the figures that the scene calls for."""
        found, notes = self._new_figures(q)
        values = {name: found.get(name) for name in self.called}
        reasons = {name: notes.get(name, NO_REASON) for name, value in values.items() if value is None}
        return Performance(values, self.called), reasons

    def _new_figures(self, q: closing.Array) -> tuple[dict[str, Any], dict[str, str]]:
        m, geometry = self.machinery, self.parts.geometry
        R = m.R
        limit = geometry.life if geometry.expands else geometry.widest_discharge()
        times, dense, _, steps = m.last()
        known = self._known(q)
        found, notes = performance.figures(
            self.parts,
            self.lines,
            self.inlet,
            self.balances.streams(q),
            known,
            delivered=0.0 if self._shut(known.turn) else 1.0 - self.suction.returned,
            work=float(q[0]),
            trapped=float(R[R_TRAPPED]),
            d=self._oil_ratio(),
            peak=float(m.module.trace__peak_pressure(times, dense, steps, limit, m.context)),
        )
        found["built_in_volume_ratio"] = self._built_in_volume_ratio
        notes["built_in_volume_ratio"] = "the machine has no discharge port whose opening ends it"
        if self.parts.dissolves:
            found["discharge_dissolved_gas_ratio"] = residues.discharge_held(self.balances.streams(q))
        own, reasons = self._own_figures(q)
        found |= own
        notes |= reasons
        gain = sum(own.get(part.gain) or 0.0 for _, part in self.parts.all(Plenum))
        effect = None if self._effect is None else self._effect * (1.0 + gain)
        cooling, reasons = performance.refrigeration(found, self.inlet.density, effect)
        found |= cooling
        notes |= reasons
        if "intake_pressure" in self.called:
            place = self.suction.place(float(R[R_DISCHARGE + ENTHALPY]))
            found["intake_pressure"] = place[PRESSURE]
            found["intake_temperature"] = self.suction.temperature(place, self.lines.T_s)
        if geometry.expands:
            changed, reasons = expander.figures(found, self._h_isentropic() - self.inlet.enthalpy, self._filled())
            found |= changed
            notes = {name: why for name, why in notes.items() if name not in changed} | reasons
        if m.composition.walls:
            found["wall_heat"] = (
                float(q[Q_WALLS : Q_WALLS + 2 * len(m.composition.walls) : 2].sum()) * self.lives_per_second
            )
        read, reasons = performance.readings(self.parts, known, found)
        return found | read, notes | reasons

    def open_question(self, q: closing.Array, closed: bool) -> str:
        """Return what the scene leaves open of a cycle, and what to do; empty where nothing is open."""
        asked = (part.open_question for part in self.parts.pulsations if part.open_question is not None)
        return next(filter(None, (ask(self.turn(q), closed) for ask in asked)), "")

    def judged(self, q: closing.Array) -> tuple[str, tuple[str, ...]]:
        """Return what effects say forbids the closed cycle, or an empty text, and their warnings."""
        return performance.judged(self.parts, self._known(q), self.figures(q)[0])

    def _shut(self, turn: Turn | None) -> bool:
        """Tell whether a check valve lets nothing in from the suction line for good, but for rounding.

        A shut discharge line does so where what comes in can go nowhere else.
        """
        lines = [part for part in self.parts.pulsations if part.to == "suction" or not self.parts.plenums]
        return turn is not None and any(part.shut is not None and part.shut(turn) for part in lines)

    def complete(self, q: closing.Array) -> performance.CycleFigures:
        """Return what a shaft asks of the cycle: what is known of it, and the shaft power."""
        return replace(self._known(q), shaft_power=self.figures(q)[0].shaft_power)

    def pitch_of(self, q: closing.Array) -> Pitch:
        """Return the pitch of the last history, whose quadratures are q."""
        return self.once("pitch", q, lambda: self._pitch(q))

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

    @cached_property
    def _built_in_volume_ratio(self) -> float | None:
        volume_at, c = self.machinery.module.volume_at, self.machinery.composition
        return built_in_volume_ratio(self.parts.geometry, lambda angle: float(volume_at(angle, c.P, c.TAB)))

    def _oil_ratio(self) -> float:
        """Return oil per gas at the injection angle, or where the injection through a port ends."""
        port = self.parts.oil_port
        if port is None:
            return float(self.machinery.R[R_RATIO])
        return float(self.machinery.states_at(np.array([port.closes]))[0, 3])

    def _own_figures(self, q: closing.Array) -> tuple[dict[str, Any], dict[str, str]]:
        """Return what the effects say of the cycle by their own plenums, and why they do not say some."""
        found, notes = {}, {}
        streams, rate = self.balances.streams(q)[:, 0], self.lives_per_second
        suction = float(streams[0] + streams[1]) * rate * (1.0 - self.suction.returned)  # from the line alone
        why = "" if suction > 0.0 else performance.NONE_DELIVERED
        for name, plenum in self.parts.all(Plenum):
            if plenum.figures is None:
                continue
            i, state = 2 * self.parts.number(plenum.name), self.parts.plenums[plenum.name]
            drawn = Drawn(float(streams[i] + streams[i + 1]) * rate, suction, state, self._site)
            given, reasons = performance.valued(plenum.figures(drawn), name, why)
            self.called.update(borrowed(name, self.scene.effects[name].effect, given))
            found |= given
            notes |= reasons
        return found, notes

    def ledger(self, q: closing.Array, shaft_power: float) -> Ledger:
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
        mean = residues.discharge_enthalpy(self.balances.streams(q))
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
        c = self.machinery.composition
        mass, energy, oil_mass, _ = self._residues(q)
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
        for name, values in performance.pitch_traces(self.parts, known).items():
            grid = np.linspace(0.0, pitch, len(values) + 1)
            found[name] = np.interp(degrees, grid, np.append(values, values[0]), period=pitch)
        return found


def _delivers(streams: closing.Array) -> bool:
    """Tell whether the net flow goes to the discharge line."""
    return bool(streams[2, 0] + streams[3, 0] < 0.0)
