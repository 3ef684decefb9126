"""Lives and pitches integrated by scipy's methods on our right-hand side and Jacobian: an independent check.

Source: docs/explanation/numerics.md, "Independent check".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from screwsim.model.meetings import Meetings
from screwsim.model.slots import FREE, OPENING, P_INJECTION, PLACE, Q_WALLS
from screwsim.numerics.integrators import Check
from screwsim.numerics.scipy_integrators import integrate

if TYPE_CHECKING:
    from screwsim.model.run import Machinery

Array = np.ndarray


def life(machinery: Machinery, check: Check, y: Array, rtol: float, h: float) -> tuple[int, float, float, Array]:
    """Do what `Machinery.turn` does with a check; a loose own turn gives the quadratures' scale."""
    _, _, _, q_scale = machinery.turn(y.copy(), 1e-3, h)
    c, module, context, own = machinery.composition, machinery.module, machinery.context, machinery.spaces[1]
    held = slice(OPENING + len(c.plenum_paths), OPENING + 2 * len(c.plenum_paths))
    meetings = None
    if c.stops:
        meetings = Meetings(module, machinery.n, c.stops, own, held.stop, (machinery.R, c.P, c.TAB))
        meetings.begin(y, rtol)
    E, E_next, f, g = np.empty(c.n_E), np.empty(c.n_E), np.empty(machinery.n), np.empty(machinery.nq)
    J, Jq = np.empty((machinery.n, machinery.n)), np.empty((machinery.nq, machinery.n))
    f_phi, g_phi = np.empty(machinery.n), np.empty(machinery.nq)

    def rates(phi: float, middle: float, state: Array) -> Array:
        machinery.watch()
        module.chamber__surroundings(phi, middle, context, E)
        own[PLACE] = FREE
        own[held] = FREE
        module.chamber__rates(np.ascontiguousarray(state), E, context, f, g)
        return np.concatenate([f, g])

    def jacobian(phi: float, middle: float, state: Array) -> Array:
        module.chamber__surroundings(phi, middle, context, E)
        module.chamber__surroundings(phi + 1e-6, middle, context, E_next)
        z = np.ascontiguousarray(state)
        module.chamber__jacobian(z, E, E_next, 1e-6, context, f, g, J, Jq, f_phi, g_phi)
        return np.vstack([J, Jq])

    scales = _scales(machinery, q_scale)
    end, q, path = integrate(rates, jacobian, c.knots, y, scales, rtol, check, meetings)
    y[:] = end
    steps = len(path.dense)
    machinery.counts += np.array([steps, 0, path.calls, path.jacobians])
    machinery.histories[1] = machinery.new_history(max(steps, machinery.max_steps), machinery.columns, machinery.nq)
    times, dense, quads = machinery.histories[1]
    times[: steps + 1], dense[:steps, :, : machinery.n] = path.times, path.dense
    machinery.kept[0] = steps
    at = int(np.searchsorted(times[: steps + 1], c.P[P_INJECTION] - 1e-9))
    if at < steps:  # nothing jumps there: what is noted is the trapped mass
        module.chamber_steps__inject(dense[at, 0, : machinery.n].copy(), 0, c.P, c.TAB, machinery.R)
    module.places__places_along(dense, steps, context)
    module.trace__work_along(times, dense, quads, steps, context)
    return int(path.message != ""), path.times[-1], h, q


def pitch(machinery: Machinery, check: Check, y: Array, rtol: float, h: float) -> tuple[int, float, float, Array]:
    """Do what `Machinery.pitch` does with a check; a loose own one gives the quadratures' scale."""
    _, _, _, q_scale = machinery.own_pitch(y.copy(), 1e-3, h)
    space, c = machinery.coupled_space(), machinery.composition
    machinery.inject(y)
    E, f, g = np.empty(c.n_E_all), np.empty(len(y)), np.empty(machinery.nq + 1)
    J, Jq, E_next = np.empty((len(y), len(y))), np.empty((machinery.nq + 1, len(y))), np.empty(c.n_E_all)
    f_phi, g_phi = np.empty(len(y)), np.empty(machinery.nq + 1)
    module, context = machinery.together, machinery.coupled_context
    held = space["spaces"][0][-c.chambers :]

    def rates(s: float, middle: float, state: Array) -> Array:
        machinery.watch()
        module.coupled__all_surroundings(s, middle, context, E)
        held[:] = FREE
        module.chambers__rates(np.ascontiguousarray(state), E, context, f, g)
        return np.concatenate([f, g[:-1]])

    def jacobian(s: float, middle: float, state: Array) -> Array:
        module.coupled__all_surroundings(s, middle, context, E)
        module.coupled__all_surroundings(s + 1e-6, middle, context, E_next)
        z = np.ascontiguousarray(state)
        module.chambers__jacobian(z, E, E_next, 1e-6, context, f, g, J, Jq, f_phi, g_phi)
        return np.vstack([J, Jq[:-1]])

    scales = _scales(machinery, q_scale)
    end, q, path = integrate(rates, jacobian, machinery.pitch_knots(), y, scales, rtol, check)
    y[:] = end
    steps = len(path.dense)
    machinery.counts += np.array([steps, 0, path.calls * c.chambers, path.jacobians * c.chambers])
    if steps > len(space["history"][1]):
        space["history"] = machinery.new_history(steps, len(y), machinery.nq + 1)
    space["history"][0][: steps + 1], space["history"][1][:steps] = path.times, path.dense
    space["kept"][0] = steps
    return int(path.message != ""), path.times[-1], h, q


def _scales(machinery: Machinery, q: Array) -> Array:
    """Return the scale of each quadrature: the largest of its kind, so that an idle path demands no accuracy."""
    first = machinery.composition.first_stream
    streams = np.abs(q[first:]).reshape(-1, machinery.composition.width)
    heads = np.full(first, np.max(np.abs(q[:Q_WALLS])))
    heads[Q_WALLS + 1 :: 2] = np.abs(q[Q_WALLS + 1 : first : 2])
    return np.concatenate([heads, np.tile(streams.max(axis=0), len(streams))])
