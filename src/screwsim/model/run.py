"""A composition at work: buffers, one turn of a chamber, one pitch of all chambers.

`Machinery` owns the arrays that the compiled module reads and writes; nothing here knows what a solution is good for.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from types import ModuleType
from typing import Any

import numpy as np

from screwsim.codegen.calls import Context
from screwsim.model import compiled, ledger, under_scipy
from screwsim.model.compose import Composition
from screwsim.model.contexts import ChamberContext, CoupledContext
from screwsim.model.slots import FREE, OPENING, P_INJECTION, P_LIFE, P_PITCH, PLACE
from screwsim.numerics.integrators import DEFAULT, check_of

MAX_STEPS = 60000  # room only: pages never written cost nothing
MOST_CONTEXTS = 6  # remembered
KEPT_IMAGES = 7  # histories kept for acceleration, one more than Anderson's depth + 1
Array = np.ndarray


class Machinery:
    """Arrays and drivers of one composition; `R` holds the plenums and what happened at the injection angle."""

    def __init__(self, composition: Composition, max_steps: int = MAX_STEPS) -> None:
        self.composition = composition
        self.module: ModuleType = compiled.load(composition.text)
        n, n_sums = len(composition.states), composition.n_sums
        self.n = n
        self.nq = composition.n_quadratures
        self.R = np.zeros(composition.n_R)
        self.max_steps = max_steps
        self.columns = n + composition.n_place
        self.histories = [self.new_history(max_steps, self.columns, self.nq) for _ in range(2)]
        self._aside: tuple[Array, Array, Array] | None = None  # the history that nothing may be written into
        self._spare: tuple[Array, Array, Array] | None = None  # arrays that are in no use
        self.images: list[tuple[Array, Array, int]] = []
        self.kept = np.zeros(2, np.int64)
        self.hints = np.zeros(64, np.int64)
        work = np.zeros(n_sums + (n + 2) * PLACE + (n + 1) * n_sums + n + composition.first_stream)
        paths = len(composition.plenum_paths)
        stops = np.zeros(2 * len(composition.stops) + 3)
        own = np.concatenate([np.zeros(PLACE), [FREE], np.zeros(paths), np.full(paths, FREE), stops])
        self._at_first = own.copy()
        self.spaces = (np.zeros(self.columns), own, work)
        self.counts = np.zeros(4, np.int64)
        self._contexts: dict[tuple[int, ...], Context] = {}  # by the arrays that change; it holds them
        self._together: dict[str, Any] = {}
        self.compile_time = 0.0
        self.integrator = DEFAULT
        self.stamp = object()  # another one with every other last history
        self.watch: Callable[[], None] = lambda: None  # called now and then; what it raises ends the work

    def begin(self, composition: Composition) -> None:
        """Take on another composition of the same structure; of the one before nothing stays."""
        self.composition = composition
        self._contexts.clear()
        self.reset()
        self.counts[:] = 0
        self.compile_time, self.integrator = 0.0, DEFAULT
        self.watch = lambda: None

    @staticmethod
    def new_history(steps: int, n: int, nq: int) -> tuple[Array, Array, Array]:
        """Return arrays for a history: times, dense output of n columns, quadratures."""
        return np.zeros(steps + 1), np.zeros((steps, 4, n)), np.zeros((steps, nq))

    @property
    def context(self) -> Context:
        """The context of one chamber: histories[0] is the last turn's, histories[1] the one being written."""
        c, (old, new) = self.composition, self.histories
        key = id(c.P), id(c.TAB), id(old[1]), id(new[1])
        if key not in self._contexts:
            if len(self._contexts) >= MOST_CONTEXTS:
                self._contexts.clear()
            histories = old[0], old[1], new[0], new[1]
            arrays = ChamberContext(c.P, c.TAB, self.R, *histories, self.kept, self.hints, *self.spaces)
            self._contexts[key] = Context(arrays)
        return self._contexts[key]

    def reset(self) -> None:
        """Forget the last scene: run-time cells, search hints, histories."""
        self.R[:] = 0.0
        self.spaces[1][:] = self._at_first
        self.hints[:] = 0
        self.kept[:] = 0
        self.stamp = object()
        self.images.clear()

    def warm_up(self, start: Callable[[], Array]) -> None:
        """Compile (or load) the driver of one chamber, announced when it takes long; not counted as solution time."""
        if "one" not in compiled.warm(self.module):
            with self._compiling("one"):
                self.turn(start(), 1e-2, 1e-3)
                self.swap()
                self.states_at(np.array([0.1]))
                self.remember()
                self.images.append(self.images[0])
                self.mix(np.array([0.5, 0.5]))
                if self.composition.pulsating:
                    self.into_lines(1)

    @contextmanager
    def _compiling(self, driver: str) -> Iterator[None]:
        started, counts, R = time.perf_counter(), self.counts.copy(), self.R.copy()
        with compiled.alone, compiled.announced(driver):
            yield
        self.counts[:], self.R[:] = counts, R
        compiled.warm(self.module).add(driver)
        self.compile_time += time.perf_counter() - started

    def turn(self, y: Array, rtol: float, h: float) -> tuple[int, float, float, Array]:
        """Integrate one life from y (changed in place); return (status, angle reached, last step, quadratures)."""
        self.watch()
        c = self.composition
        new = self._writable(1)
        q = np.zeros(self.nq)
        status, phi, h = self.module.rodas__integrate_one(
            c.knots, len(c.knots), y, q, self.context, rtol, h, c.n_E, *new, self.kept, self.counts
        )
        return int(status), float(phi), float(h), q

    def evaluations_of(self, counts: Sequence[int] | Array) -> int:
        """Return the evaluations of the right-hand side of one chamber in counts, those for Jacobians included."""
        return int(counts[2] + counts[3] * self.n)

    @property
    def impacts(self) -> int:
        """Impacts of the last turn, where something moves between seat and stop."""
        own, stops = self.spaces[1], len(self.composition.stops)
        return int(own[OPENING + 2 * len(self.composition.plenum_paths) + 2 * stops]) if stops else 0

    def swap(self) -> None:
        """Make the turn just integrated the last one."""
        self.histories.reverse()
        self.kept[1] = self.kept[0]
        self.kept[0] = 0
        self.stamp = object()

    def _writable(self, place: int) -> tuple[Array, Array, Array]:
        """Return the arrays of a history to be written; other ones take the place of what is set aside."""
        if self.histories[place] is self._aside:
            spare = self._spare
            if spare is None or len(spare[1]) < self.max_steps:
                spare = self.new_history(self.max_steps, self.columns, self.nq)
            self.histories[place], self._spare = spare, None
        return self.histories[place]

    @contextmanager
    def set_aside(self) -> Iterator[None]:
        """Leave the machinery as it is, whatever is integrated meanwhile; of the last turn nothing is copied."""
        P, R, kept, stamp = self.composition.P.copy(), self.R.copy(), self.kept.copy(), self.stamp
        history = self._aside = self.histories[0]
        try:
            yield
        finally:
            self._aside = None
            others = [arrays for arrays in self.histories if arrays is not history]
            if len(history[1]) < self.max_steps:  # turns since then took more steps than it has room for
                room = self.new_history(self.max_steps, self.columns, self.nq)
                for larger, whole in zip(room, history, strict=True):
                    larger[: len(whole)] = whole
                history = room
                others = [arrays for arrays in others if len(arrays[1]) >= self.max_steps]
            self.histories = [history, others[0] if others else self.new_history(self.max_steps, self.columns, self.nq)]
            self._spare = others[1] if len(others) > 1 else self._spare
            self.composition.P[:], self.R[:], self.kept[:] = P, R, kept
            self.stamp = stamp

    def last(self) -> tuple[Array, Array, Array, int]:
        """Return (times, dense, quadratures, steps) of the last turn."""
        return (*self.histories[0], int(self.kept[1]))

    def remember(self) -> None:
        """Keep a copy of the last turn's history as an image of the fixed-point map."""
        times, dense, _, steps = self.last()
        self.images.append((times[: steps + 1].copy(), dense[:steps].copy(), steps))
        if len(self.images) > KEPT_IMAGES:
            self.images.pop(0)

    def mix(self, weights: Array) -> None:
        """Replace the last history by the weighted sum of the newest images."""
        self.blend(self.images[-len(weights) :], weights)

    def blend(self, histories: Sequence[tuple[Array, Array, int]], weights: Array) -> None:
        """Replace the last history by the weighted sum of whole histories, on the steps of the last of them."""
        times, dense, steps = histories[-1]
        old = self._writable(0)
        old[0][: steps + 1], target = times, old[1][:steps]
        self.kept[:] = 0, steps
        self.stamp = object()
        np.multiply(dense, weights[-1], out=target)
        for weight, (t, d, n) in zip(weights[:-1], histories[:-1], strict=True):
            self.module.history__add_history(times, steps, t, d, n, weight, target)

    def states_at(self, angles: Array) -> Array:
        """Return the states of the last history at increasing angles, one row an angle."""
        out = np.empty((len(angles), self.n))
        times, dense, _, steps = self.last()
        self.module.history__states_at(angles, times, dense, steps, out)
        return out

    def install(self, times: Array, dense: Array, quads: Array) -> None:
        """Put a history of states in place as the last turn's, and fill the places of its steps."""
        steps = len(dense)
        if steps > self.max_steps:
            self.max_steps = steps
            self.histories = [self.new_history(steps, self.columns, self.nq) for _ in range(2)]
        old = self._writable(0)
        old[0][: steps + 1], old[1][:steps, :, : self.n], old[2][:steps] = times, dense, quads
        self.kept[:] = 0, steps
        self.stamp = object()
        self.module.places__places_along(old[1], steps, self.context)

    def sample(self, angles: Array) -> tuple[Array, Array]:
        """Return rows of (V, p, work, dm/dφ, state…) and of the flow of each path [kg/s] at increasing angles [rad]."""
        c = self.composition
        out = np.empty((len(angles), 4 + self.n))
        flows = np.empty((len(angles), len(c.plenum_paths) + 2 * len(c.gap_paths)))
        self.module.trace__sample(angles, *self.last(), self.context, c.n_E, out, flows)
        return out, flows

    def oil_films(self, angles: Array) -> Array:
        """Return rows of the oil [kg/s] that flows in through gaps as films, each ahead and behind, at angles [rad]."""
        c, (times, dense, _, steps) = self.composition, self.last()
        out = np.empty((len(angles), 2 * len(c.gap_paths)))
        self.module.trace__oil_films(angles, times, dense, steps, self.context, c.n_E, out)
        return out

    def into_lines(self, points: int) -> tuple[Array, Array]:
        """Return the flow [kg/s] into suction and discharge line, and the mean volume [m³] that is open to each.

        The flow at `points` even angles of a pitch, from the youngest chamber's 0° on; only of lines that pulsate.
        """
        into, volume = np.zeros((2, points)), np.zeros(2)
        times, dense, _, steps = self.last()
        self.module.line_flow__into_lines(times, dense, steps, self.context, self.composition.n_E, into, volume)
        return into, volume

    def account(self, s_suction: float, s_discharge: float) -> tuple[Array, Array, Array]:
        """Return what the last turn's paths, heat rates and walls, and oil sum up to over one life (`model.ledger`).

        `s_…` are the specific entropies [J/(kg K)] of the lines' gas. Compiled when it is first asked for.
        """
        c, (times, dense, _, steps) = self.composition, self.last()
        paths = np.zeros((len(c.plenum_paths) + len(c.gap_paths), ledger.PATH_SUMS))
        warming = len(c.heats) + len(c.walls)
        heats, oil = np.zeros((max(warming, 1), ledger.HEAT_SUMS)), np.zeros(ledger.OIL_SUMS)
        with self._compiling("ledger") if "ledger" not in compiled.warm(self.module) else nullcontext():
            self.module.ledger__account(
                times, dense, steps, self.context, c.n_E, s_suction, s_discharge, paths, heats, oil
            )
        return paths, heats[:warming], oil

    def port_oil(self) -> tuple[float, float]:
        """Return the oil [kg] that came through ports over the last life, and that times the chamber's pressure."""
        times, dense, _, steps = self.last()
        return self.module.trace__port_oil(times, dense, steps, self.composition.P, self.composition.TAB)

    def restore(self, times: Array, dense: Array, quads: Array) -> None:
        """Put back a whole history, places included, as the last turn's."""
        old, steps = self._writable(0), len(dense)
        old[0][: steps + 1], old[1][:steps], old[2][:steps] = times, dense, quads
        self.kept[:] = 0, steps
        self.stamp = object()

    # ---- all chambers together -------------------------------------------------------------------------------

    def coupled_space(self) -> dict[str, Any]:
        """Return the arrays of the coupled chambers, made when they are first wanted."""
        if not self._together:
            c = self.composition
            places = np.append(np.zeros((c.chambers + 1) * PLACE), np.full(c.chambers, FREE))
            self._together = {
                "spaces": (places, np.zeros(self.n), np.zeros(c.n_work_all)),
                "history": self.new_history(self.max_steps, c.chambers * self.n, self.nq + 1),
                "kept": np.zeros(1, np.int64),
            }
        return self._together

    def pitch_knots(self) -> Array:
        """Return the knots of all chambers within one pitch [rad]."""
        pitch = self.composition.P[P_PITCH]
        knots = np.sort(np.mod(self.composition.knots, pitch))
        knots = np.append(knots[knots < pitch - 1e-7], pitch)
        return np.concatenate([[0.0], knots[np.diff(knots, prepend=0.0) > 1e-7]])

    @property
    def coupled_context(self) -> CoupledContext:
        """The context of all chambers."""
        c = self.composition
        return CoupledContext(c.P, c.TAB, self.R, *self.coupled_space()["spaces"])

    def pitch(self, y: Array, rtol: float, h: float, inset: float = 0.0) -> tuple[int, float, float, Array]:
        """Integrate all chambers over one pitch from y (in place), after injecting; return as `turn`.

        `inset` [rad] is left out at both ends: where the speed's course does not repeat, it jumps there.
        """
        check = check_of(self.integrator)
        if self.alone:
            return self.turn(y, rtol, h) if check is None else under_scipy.life(self, check, y, rtol, h)
        if "all" not in compiled.warm(self.module):
            with self._compiling("all"):
                self.own_pitch(y.copy(), 1e-2, h)
        self.watch()
        if check is not None:
            return under_scipy.pitch(self, check, y, rtol, h)
        return self.own_pitch(y, rtol, h, inset)

    @property
    def alone(self) -> bool:
        """Is there one chamber at a time? Its life is the pitch, and its own driver integrates it."""
        return self.composition.chambers == 1

    def own_pitch(self, y: Array, rtol: float, h: float, inset: float = 0.0) -> tuple[int, float, float, Array]:
        """Do what `pitch` does with our own method."""
        space, c = self.coupled_space(), self.composition
        self.inject(y)
        q = np.zeros(self.nq + 1)
        counts, knots = np.zeros(4, np.int64), self.pitch_knots()
        knots[[0, -1]] += inset, -inset
        status, s, h = self.module.rodas__integrate_all(
            knots,
            len(knots),
            y,
            q,
            self.coupled_context,
            rtol,
            h,
            c.n_E_all,
            *space["history"],
            space["kept"],
            counts,
        )
        self.counts += counts * (1, 1, c.chambers, c.chambers)  # evaluations are those of one chamber
        return int(status), float(s), float(h), q[:-1]

    def inject(self, y: Array) -> None:
        """Let the oil into the chamber that stands at the injection angle."""
        c = self.composition
        index = round(c.P[P_INJECTION] / c.P[P_PITCH])
        if index < c.chambers:
            self.module.chamber_steps__inject(y, index * self.n, c.P, c.TAB, self.R)

    def shift(self, y: Array) -> Array:
        """Return the states one pitch on: each chamber takes the next place, the last begins anew with what it kept."""
        return np.roll(y.reshape(self.composition.chambers, self.n), 1, axis=0).ravel()

    def install_coupled(self) -> None:
        """Turn the last pitch of all chambers into the history of one chamber's life."""
        if self.alone:
            if self.kept[0] > 0:
                self.swap()
            return
        space, c = self.coupled_space(), self.composition
        times, dense, _ = space["history"]
        steps = int(space["kept"][0])
        t = np.concatenate([times[:steps] + j * c.P[P_PITCH] for j in range(c.chambers)] + [[c.P[P_LIFE]]])
        states = dense[:steps].reshape(steps, 4, c.chambers, self.n)
        life = np.concatenate([states[:, :, j] for j in range(c.chambers)])
        self.install(t, life, np.zeros((len(life), self.nq)))
        self.module.trace__work_along(*self.last(), self.context)
