"""Lives and pitches integrated by scipy's methods with our right-hand side and Jacobian: an independent check.

Impacts on seat and stop are terminal events of scipy; their effect is that of `model.impacts`.

Source: docs/explanation/errors.md, "An independent check"; docs/reference/slider-crank.md S32, S33.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import count
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.model.all_chambers import inject, own_pitch, pitch_breakpoints
from screwsim.model.impacts import LEAVES, MOVES, SEATED, STOPPED
from screwsim.model.lives import new_history
from screwsim.model.port_states import SHARP
from screwsim.model.slots import FREE, P_INJECTION, Q_WALLS
from screwsim.numerics.integrators import Check
from screwsim.numerics.scipy_integrators import Slopes, integrate

if TYPE_CHECKING:
    from screwsim.model.run import Machinery


class ImpactEvents:
    """Impact events of one chamber's pairs of positions and speeds during a turn."""

    def __init__(
        self,
        module: ModuleType,
        states: int,
        pairs: Sequence[tuple[int, int]],
        own: Array,
        first: int,
        around: tuple[Any, ...],
    ) -> None:
        """`own` holds the modes from index `first` on; `around` is (R, P, TAB) of the machinery."""
        self.module, self.pairs, self.own, self.first, self.around = module, pairs, own, first, around
        self.rtol = 0.0
        self.least = np.zeros(states)
        self.least[np.array(pairs).ravel()] = SHARP
        self._due: list[tuple[int, float]] = []

    def begin(self, y: Array, rtol: float) -> None:
        """Set the modes at the start of a turn, from its state (changed in place)."""
        self.rtol = rtol
        self.module.chamber__begin_modes(y, self.own, *self.around)

    def watched(self, t: float, y: Array) -> list[Callable[[float, Array], float]]:
        """Return scipy's terminal events to watch from angle t [rad] and state y on."""
        found, self._due = [], []
        for k, (position, _) in enumerate(self.pairs):
            side = float(self.own[self.first + k])
            if side != MOVES:
                found.append(self._leaving(k, side))
                self._due.append((k, LEAVES))
                continue
            for side in (SEATED, STOPPED):
                end = 0.5 * (1.0 + side)
                found.append(_meeting(position, side, end, t if y[position] == end else -np.inf))
                self._due.append((k, side))
        for event in found:
            event.terminal, event.direction = True, 1.0
        return found

    def _leaving(self, k: int, side: float) -> Any:
        """Return an event function: the push of pair k away from where it rests."""

        def off(t: float, state: Array) -> float:
            y = np.ascontiguousarray(state)
            return -side * self.module.push_on(k, y[0], y[1], y, *self.around)

        return off

    def passed(self, which: int, y: Array) -> bool:
        """Apply event `which` of the last `watched` to the state [in place]; return whether the turn may continue."""
        k, due = self._due[which]
        if due != LEAVES:
            y[self.pairs[k][0]] = 0.5 * (1.0 + due)
        self.own[self.first + len(self.pairs) + k] = due
        return bool(self.module.chamber__take_event(y, self.rtol, self.own, *self.around))


def _meeting(position: int, side: float, end: float, started: float) -> Any:
    """Return an event function: the distance of a position beyond its end.

    For a position that starts at that end, at the angle `started`, it is divided by the angle passed since.
    """

    def beyond(t: float, state: Array) -> float:
        if t == started:
            return -1.0
        far = side * float(state[position] - end)
        return far / (t - started) if np.isfinite(started) else far

    return beyond


Array = np.ndarray
WATCHED = 16  # evaluations between two calls of the machinery's `watch`, which take as long as one


def life(machinery: Machinery, check: Check, y: Array, rtol: float, h: float) -> tuple[int, float, Array]:
    """Do what `Machinery.turn` does, by a check's method; a loose turn of our own scales the quadratures."""
    *_, q_scale = machinery.turn(y.copy(), 1e-3, h)
    c, module, context, own = machinery.composition, machinery.module, machinery.context, machinery.spaces[1]
    impacts = None
    if c.stops:
        impacts = ImpactEvents(module, machinery.n, c.stops, own, c.own.modes.start, (machinery.R, c.P, c.TAB))
        impacts.begin(y, rtol)
    kernels = module.chamber__surroundings, module.chamber__rates, module.chamber__jacobian
    slopes = _slopes(machinery, kernels, context, (own[c.own.phase], own[c.own.held]), len(y), c.n_E, machinery.nq)
    end, q, path = integrate(*slopes, c.breakpoints, y, _scales(machinery, q_scale), rtol, check, impacts)
    y[:] = end
    steps = len(path.dense)
    machinery.counts += np.array([steps, 0, path.calls, path.jacobians])
    times, dense, quads = machinery.lives.renewed(steps)
    times[: steps + 1], dense[:steps, :, : machinery.n] = path.times, path.dense
    machinery.lives.kept[0] = steps
    at = int(np.searchsorted(times[: steps + 1], c.P[P_INJECTION] - 1e-9))
    if at < steps:  # nothing jumps there: it stores the trapped mass
        module.chamber__inject(dense[at, 0, : machinery.n].copy(), 0, c.P, c.TAB, machinery.R)
    module.port_states__port_states_along(dense, steps, context)
    module.trace__work_along(times, dense, quads, steps, context)
    return int(path.message != ""), path.times[-1], q


def pitch(machinery: Machinery, check: Check, y: Array, rtol: float, h: float) -> tuple[int, float, Array]:
    """Do what `Machinery.pitch` does, by a check's method; a loose one of our own scales the quadratures."""
    *_, q_scale = own_pitch(machinery, y.copy(), 1e-3, h)
    coupled, c, module = machinery.coupled, machinery.composition, machinery.together
    inject(machinery, y)
    kernels = module.chambers__surroundings, module.chambers__rates, module.chambers__jacobian
    held, context = coupled.port_states[-c.chambers :], machinery.coupled_context
    slopes = _slopes(machinery, kernels, context, (held,), len(y), c.n_E_all, machinery.nq + 1)
    end, q, path = integrate(*slopes, pitch_breakpoints(machinery), y, _scales(machinery, q_scale), rtol, check)
    y[:] = end
    steps = len(path.dense)
    machinery.counts += np.array([steps, 0, path.calls * c.chambers, path.jacobians * c.chambers])
    if steps > len(coupled.history[1]):
        coupled.history = new_history(steps, len(y), machinery.nq + 1)
    coupled.history[0][: steps + 1], coupled.history[1][:steps] = path.times, path.dense
    coupled.kept[0] = steps
    return int(path.message != ""), path.times[-1], q


def _slopes(
    machinery: Machinery, kernels: Sequence[Any], context: Any, held: Sequence[Array], n: int, n_E: int, nq: int
) -> tuple[Slopes, Slopes]:
    """Return functions for rates and Jacobian of n states, followed by the quadratures.

    `held` are the cells of phases and switches, which are left free: nothing is held over a step here.
    """
    surroundings, fill_rates, fill_jacobian = kernels
    E, E_next, state, both, f_phi, g_phi = (np.empty(size) for size in (n_E, n_E, n, n + nq, n, nq))
    J, Jq, f, g = np.empty((n, n)), np.empty((nq, n)), both[:n], both[n:]
    surround, surround_next = (surroundings.bound(2, context, each) for each in (E, E_next))
    fill = fill_rates.bound(0, state, E, context, f, g)
    calls = count()

    def rates(phi: float, middle: float, at: Array) -> Array:
        if next(calls) % WATCHED == 0:
            machinery.watch()
        state[:] = at
        surround(phi, middle)
        for phase in held:
            phase[:] = FREE
        fill()
        return both[: n + machinery.nq].copy()

    def jacobian(phi: float, middle: float, at: Array) -> Array:
        state[:] = at
        surround(phi, middle)
        surround_next(phi + 1e-6, middle)
        fill_jacobian(state, E, E_next, 1e-6, context, f, g, J, Jq, f_phi, g_phi)
        return np.vstack([J, Jq[: machinery.nq]])

    return rates, jacobian


def _scales(machinery: Machinery, q: Array) -> Array:
    """Return the scale of each quadrature: the largest of its kind, so that an idle path needs no accuracy."""
    c, first = machinery.composition, machinery.composition.first_stream
    streams = np.abs(q[first:]).reshape(-1, c.width)
    heads = np.full(first, np.max(np.abs(q[:Q_WALLS])))
    conductances = slice(Q_WALLS + 1, c.all_met.start, 2)
    heads[conductances] = np.abs(q[conductances])
    heads[c.all_met] = streams[:, 0].max()
    return np.concatenate([heads, np.tile(streams.max(axis=0), len(streams))])
