"""Lives and pitches integrated by scipy's methods on our right-hand side and Jacobian: an independent check.

Source: docs/explanation/numerics.md, "Independent check".
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.model.impact_events import ImpactEvents
from screwsim.model.slots import FREE, OPENING, P_INJECTION, PORT_STATE, Q_WALLS
from screwsim.numerics.integrators import Check
from screwsim.numerics.scipy_integrators import Slopes, integrate

if TYPE_CHECKING:
    from screwsim.model.run import Machinery

Array = np.ndarray
WATCHED = 16  # evaluations from one look at what may end the work to the next; the clock takes as long as one


def life(machinery: Machinery, check: Check, y: Array, rtol: float, h: float) -> tuple[int, float, float, Array]:
    """Do what `Machinery.turn` does with a check; a loose own turn gives the quadratures' scale."""
    _, _, _, q_scale = machinery.turn(y.copy(), 1e-3, h)
    c, module, context, own = machinery.composition, machinery.module, machinery.context, machinery.spaces[1]
    held = slice(OPENING + len(c.plenum_paths), OPENING + 2 * len(c.plenum_paths))
    impacts = None
    if c.stops:
        impacts = ImpactEvents(module, machinery.n, c.stops, own, held.stop, (machinery.R, c.P, c.TAB))
        impacts.begin(y, rtol)
    kernels = module.chamber__surroundings, module.chamber__rates, module.chamber__jacobian
    slopes = _slopes(
        machinery, kernels, context, (own[PORT_STATE : PORT_STATE + 1], own[held]), len(y), c.n_E, machinery.nq
    )
    end, q, path = integrate(*slopes, c.breakpoints, y, _scales(machinery, q_scale), rtol, check, impacts)
    y[:] = end
    steps = len(path.dense)
    machinery.counts += np.array([steps, 0, path.calls, path.jacobians])
    machinery.histories[1] = machinery.new_history(max(steps, machinery.max_steps), machinery.columns, machinery.nq)
    times, dense, quads = machinery.histories[1]
    times[: steps + 1], dense[:steps, :, : machinery.n] = path.times, path.dense
    machinery.kept[0] = steps
    at = int(np.searchsorted(times[: steps + 1], c.P[P_INJECTION] - 1e-9))
    if at < steps:  # nothing jumps there: what is noted is the trapped mass
        module.chamber__inject(dense[at, 0, : machinery.n].copy(), 0, c.P, c.TAB, machinery.R)
    module.port_states__port_states_along(dense, steps, context)
    module.trace__work_along(times, dense, quads, steps, context)
    return int(path.message != ""), path.times[-1], h, q


def pitch(machinery: Machinery, check: Check, y: Array, rtol: float, h: float) -> tuple[int, float, float, Array]:
    """Do what `Machinery.pitch` does with a check; a loose own one gives the quadratures' scale."""
    _, _, _, q_scale = machinery.own_pitch(y.copy(), 1e-3, h)
    space, c, module = machinery.coupled_space(), machinery.composition, machinery.together
    machinery.inject(y)
    kernels = module.chambers__surroundings, module.chambers__rates, module.chambers__jacobian
    held, context = space["spaces"][0][-c.chambers :], machinery.coupled_context
    slopes = _slopes(machinery, kernels, context, (held,), len(y), c.n_E_all, machinery.nq + 1)
    end, q, path = integrate(*slopes, machinery.pitch_breakpoints(), y, _scales(machinery, q_scale), rtol, check)
    y[:] = end
    steps = len(path.dense)
    machinery.counts += np.array([steps, 0, path.calls * c.chambers, path.jacobians * c.chambers])
    if steps > len(space["history"][1]):
        space["history"] = machinery.new_history(steps, len(y), machinery.nq + 1)
    space["history"][0][: steps + 1], space["history"][1][:steps] = path.times, path.dense
    space["kept"][0] = steps
    return int(path.message != ""), path.times[-1], h, q


def _slopes(
    machinery: Machinery, kernels: Sequence[Any], context: Any, held: Sequence[Array], n: int, n_E: int, nq: int
) -> tuple[Slopes, Slopes]:
    """Return rates and Jacobian of n states, and of the quadratures behind them; `held` is what no step holds here."""
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
    """Return the scale of each quadrature: the largest of its kind, so that an idle path demands no accuracy."""
    met, first = machinery.composition.first_met, machinery.composition.first_stream
    streams = np.abs(q[first:]).reshape(-1, machinery.composition.width)
    heads = np.full(first, np.max(np.abs(q[:Q_WALLS])))
    heads[Q_WALLS + 1 : met : 2] = np.abs(q[Q_WALLS + 1 : met : 2])
    heads[met : met + 2 * len(machinery.composition.offsets)] = streams[:, 0].max()
    return np.concatenate([heads, np.tile(streams.max(axis=0), len(streams))])
