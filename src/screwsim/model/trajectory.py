"""One life of a chamber as it was integrated, from which everything about a cycle is read; the arguments of kernels.

It combines the dense output of its steps with the numbers used in integrating it, so that it stays readable whatever
its workspace does next.
"""

from __future__ import annotations

from threading import Lock
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from screwsim.codegen.calls import Context, copied
from screwsim.model import compiled, ledger
from screwsim.model.composition import Composition
from screwsim.model.slots import FIRST_OWN, S_RHO
from screwsim.model.trace import SAMPLED
from screwsim.numerics.frozen import with_changes
from screwsim.numerics.identity_cache import keep

Array = np.ndarray
KNOWN_LIVES = 4  # lives of a workspace whose flows into lines are kept: a turn, the closed cycle, and a finer one


class ChamberContext(NamedTuple):
    """For one chamber among neighbours with known histories.

    `own` is the chamber's port state, then the phase in which its gas is held during a step (`slots.FREE`: none)
    and the memory of its openings; `kept` are the numbers of steps of both histories, the new one first.
    """

    P: Array  # parameters
    TAB: Array  # tables
    R: Array  # run-time cells
    t_old: Array  # times of the last turn's steps, and their dense output
    d_old: Array
    t_new: Array  # the same of the turn being integrated
    d_new: Array
    kept: Array
    hints: Array  # where the last search in each history ended
    state: Array  # scratch
    own: Array


class CoupledContext(NamedTuple):
    """For all chambers together.

    `port_states` has one for each chamber and a spare one, then the phase in which each chamber's gas is held
    during a step. `work` holds flows between chambers, and derivatives (`network.chambers`).
    """

    P: Array
    TAB: Array
    R: Array
    port_states: Array
    work: Array


class Trajectory(NamedTuple):
    """Times, dense output and quadratures of a life's steps; `composition.P` and `R` are the numbers it was made with.

    A view of a workspace's last turn is valid until that integrates again; a copy is valid for good.
    """

    composition: Composition
    module: ModuleType
    R: Array
    times: Array
    dense: Array
    quads: Array
    steps: int
    context: Context
    alone: Lock  # held while writing to the context's scratch arrays
    line_flows: dict[tuple[Any, ...], tuple[Array, Array]]  # by the life that they were read from, see `into_lines`

    def denser(self, share: float) -> Trajectory:
        """Return the same life with a density that is larger by a share of itself, for slopes of flows."""
        dense = self.dense[: self.steps].copy()
        dense[:, :, S_RHO] *= 1.0 + share
        return self._replace(dense=dense)

    def copy(self) -> Trajectory:
        """Return a copy in its own, read-only arrays."""
        c, steps = self.composition, self.steps
        own = [self.times[: steps + 1], self.dense[:steps], self.quads[:steps], c.P, self.R]
        scratch = self.context[-4:]  # kept, hints, state, own
        times, dense, quads, P, R, kept, *scratch = copied([*own, *scratch])
        kept[:] = 0, steps
        context = Context(ChamberContext(P, c.TAB, R, times, dense, times, dense, kept, *scratch))
        for array in (times, dense, quads, P, R):
            array.flags.writeable = False
        return Trajectory(
            with_changes(c, P=P), self.module, R, times, dense, quads, steps, context, Lock(), self.line_flows
        )

    @property
    def rows(self) -> tuple[Array, Array, int]:
        """Times and dense output, and the number of steps."""
        return self.times, self.dense, self.steps

    @property
    def ends(self) -> tuple[Array, Array]:
        """Temperature [K] and density [kg/m³] at the end of every step."""
        T, rho = (np.ascontiguousarray(self.dense[: self.steps, 1, column]) for column in (0, 1))
        return T, rho

    def volume(self, angle: float) -> float:
        """Return the volume [m³] of a chamber at an angle [rad]."""
        return float(self.module.volume_at(angle, self.composition.P, self.composition.TAB))

    def states_at(self, angles: Array) -> Array:
        """Return the states and, last, the pressure [Pa] at increasing angles [rad], one row for each angle."""
        out = np.empty((len(angles), len(self.composition.states) + 1))
        self.module.history__states_at(angles, *self.rows, out)
        return out

    def pressures_at(self, angles: Array) -> Array:
        """Return the pressures [Pa] computed from the states at increasing angles [rad]."""
        c, found = self.composition, np.empty(len(angles))
        self.module.trace__pressures(self.states_at(angles), c.P, c.TAB, found)
        return found

    def phases(self, states: Array) -> Array:
        """Return the phase of the gas, 0 where there is one only, at rows of states; of a gas that can have two."""
        c, found = self.composition, np.empty(len(states))
        self.module.trace__phases(states, c.P, c.TAB, found)
        return found.astype(int)

    def sum_until(self, angle: float, quadrature: int) -> float:
        """Return a quadrature up to an angle [rad], interpolated within a step."""
        times = self.times
        i = int(times[: self.steps + 1].searchsorted(angle, "right")) - 1
        if i < 0:
            return 0.0
        before = float(self.quads[i - 1, quadrature]) if i > 0 else 0.0
        if i == self.steps or times[i] == angle:
            return before
        began, ended = float(times[i]), float(times[i + 1])
        return (float(self.quads[i, quadrature]) - before) / (ended - began) * (angle - began) + before

    def volumes(self, angles: Array) -> Array:
        """Return the volume [m³] of a chamber at angles [rad]."""
        out = np.empty(len(angles))
        self.module.trace__volumes(angles, self.composition.P, self.composition.TAB, out)
        return out

    def volume_slopes(self, angles: Array) -> Array:
        """Return dV/dφ [m³/rad] of a chamber at angles [rad]: exact, as differences would drown slopes of figures."""
        out = np.empty(len(angles))
        self.module.trace__volume_slopes(angles, self.composition.P, self.composition.TAB, out)
        return out

    def sample(self, angles: Array) -> tuple[Array, Array]:
        """Return rows of (SAMPLED, state…) and of the flow of each path [kg/s] at increasing angles [rad]."""
        c = self.composition
        out = np.empty((len(angles), len(SAMPLED) + len(c.states)))
        flows = np.empty((len(angles), c.n_flows))
        rows = self.times, self.dense, self.quads, self.steps
        with self.alone:
            self.module.trace__sample(angles, *rows, self.context, c.n_E, out, flows)
        return out, flows

    def oil_films(self, angles: Array) -> Array:
        """Return rows of the oil [kg/s] that enters beside the gas at angles [rad].

        Of each gap ahead and behind, then of each port with such oil.
        """
        c = self.composition
        out = np.empty((len(angles), c.n_films))
        with self.alone:
            self.module.trace__oil_films(angles, *self.rows, self.context, c.n_E, out)
        return out

    def given_off(self, angles: Array) -> Array:
        """Return the gas [kg/s] that a chamber's oil releases at increasing angles [rad] (M231)."""
        out = np.empty(len(angles))
        with self.alone:
            self.module.trace__given_off_along(angles, *self.rows, self.context, self.composition.n_E, out)
        return out

    def peak_pressure(self, limit: float) -> float:
        """Return the highest pressure [Pa] from the injection up to an angle [rad]."""
        return float(self.module.trace__peak_pressure(*self.rows, limit, self.context))

    def line_pulses(self, line: int, angles: Array) -> Array:
        """Return rows of offset and pulse of a line's pressure, over its mean, at angles [rad]; 0 if it is steady."""
        out = np.zeros((len(angles), 2))
        if self.composition.pulsating and line < FIRST_OWN:
            self.module.line_flow__line_pulses(line, angles, self.composition.P, out)
        return out

    def into_lines(self, points: int) -> tuple[Array, Array]:
        """Return the flow [kg/s] into suction and discharge line, and the mean volume [m³] open to each.

        If they pulsate. The flow is given at `points` even angles of a pitch, starting at the youngest
        chamber's 0°. It costs as much as a turn, and a life is asked again after its workspace went on: what was read
        of the last lives is found by their content.
        """
        times, dense, steps = self.rows
        rows = times[: steps + 1], dense[:steps], self.composition.P, self.R
        life = points, *(array.tobytes() for array in rows)
        found = self.line_flows.get(life)
        if found is None:
            into, volume = np.zeros((2, points)), np.zeros(2)
            with self.alone:
                self.module.line_flow__into_lines(*self.rows, self.context, self.composition.n_E, into, volume)
            for array in (into, volume):
                array.flags.writeable = False
            found = keep(self.line_flows, life, (into, volume), KNOWN_LIVES)
        return found

    def account(self, s_suction: float, s_discharge: float) -> tuple[Array, Array, Array]:
        """Return the ledger's sums of paths, of heat rates and walls, and of oil over the life (`model.ledger`).

        `s_…` are the specific entropies [J/(kg K)] of the lines' gas. Compiled on first use.
        """
        c = self.composition
        paths = np.zeros((len(c.ports) + len(c.gaps), ledger.PATH_SUMS))
        warming = len(c.heats) + len(c.walls)
        heats, oil = np.zeros((max(warming, 1), ledger.HEAT_SUMS)), np.zeros(ledger.OIL_SUMS)
        with self.alone, compiled.announce_first(self.module, "ledger"):
            sums = paths, heats, oil
            self.module.ledger__account(*self.rows, self.context, c.n_E, s_suction, s_discharge, *sums)
        return paths, heats[:warming], oil

    def port_oil(self) -> tuple[float, float, float]:
        """Return the oil [kg] through ports over the life, and its integrals with chamber pressure and with lift."""
        c = self.composition
        return self.module.trace__port_oil(*self.rows, c.P, c.TAB)

    def oil_with_outflow(self) -> tuple[float, float]:
        """Return Σ ṁ T_oil and Σ ṁ of the outflow to the discharge line."""
        with self.alone:
            return self.module.trace__oil_with_outflow(*self.rows, self.context, self.composition.n_E)
