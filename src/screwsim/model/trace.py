"""Read a closed cycle: pressures, volumes and the flow of each path over the angle, from the stored steps."""

import math

import numpy as np

from screwsim.model.slots import (
    E_VOLUME,
    N_FLOWS,
    P_INJECTION,
    P_OMEGA,
    P_P_SOURCE,
    S_RHO,
    S_T,
    S_T_OIL,
    N,
    add_outflow,
    around_chamber,
    films_into,
    gas_phase,
    gas_state,
    given_off,
    heat_part,
    lets_out,
    mass_rate,
    oil_inflow,
    path_area,
    path_flows,
    volume_at,
    volume_slope_at,
)
from screwsim.model.within import NODES, POINTS, WEIGHTS, flows_within
from screwsim.numerics.history import locate, read
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import dense_value

SAMPLED = ("volume", "pressure", "work", "mass_rate")  # outputs of `sample` besides the states: m³, Pa, J, kg/rad


@kernel
def peak_pressure(times, dense, steps, limit, context):
    """Return the highest chamber pressure [Pa] from injection up to the angle `limit` [rad].

    The ends of the steps show where it is, the dense output on both sides of the highest end how high; a top within
    another step, or the pressure at either end of the range, may be higher.
    """
    P = context.P
    first = P[P_INJECTION]
    peak = 0.0
    best = 0
    for i in range(steps):
        if first < times[i + 1] <= limit + 1e-9 and dense[i, 1, N] > peak:
            peak = dense[i, 1, N]
            best = i
    for i in range(best, min(best + 2, steps)):
        for k in range(1, 50):
            phi = times[i] + (times[i + 1] - times[i]) * k / 50.0
            if first < phi <= limit + 1e-9:
                p = dense_value(k / 50.0, dense[i, 0, N], dense[i, 1, N], dense[i, 2, N], dense[i, 3, N])
                peak = max(peak, p)
    for i in range(steps):
        if first < times[i + 1] and times[i] < limit:
            start, end, c3, c4 = dense[i, 0, N], dense[i, 1, N], dense[i, 2, N], dense[i, 3, N]
            h = times[i + 1] - times[i]
            if i < best or i > best + 1:
                share = top_within(start, end, c3, c4)
                if first < times[i] + share * h <= limit:
                    peak = max(peak, dense_value(share, start, end, c3, c4))
            if times[i] <= first:
                peak = max(peak, dense_value((first - times[i]) / h, start, end, c3, c4))
            if limit < times[i + 1]:
                peak = max(peak, dense_value((limit - times[i]) / h, start, end, c3, c4))
    return peak


@kernel
def top_within(start, end, c3, c4):
    """Return the share of a step at which its dense output has a maximum; 0 if there is none.

    Its slope is that of `rodas.dense_slope`, a + b θ − 3 c4 θ², which decreases at a maximum.
    """
    a = end - start + c3
    b = 2.0 * (c4 - c3)
    root = b * b + 12.0 * a * c4
    if root <= 0.0 or (b > 0.0 and c4 == 0.0):
        return 0.0
    share = (b + math.sqrt(root)) / (6.0 * c4) if b > 0.0 else 2.0 * a / (math.sqrt(root) - b)
    return share if 0.0 < share < 1.0 else 0.0


@kernel
def areas_along(angles, i, P, TAB, out):
    """Fill out with the area [m²] of path i (ports, then gaps) at angles [rad], flow coefficient included."""
    for a in range(angles.shape[0]):
        out[a] = path_area(i, angles[a], P, TAB)


@kernel
def sample(angles, times, dense, quads, steps, context, n_e, out, flows):
    """Fill out[i] = (SAMPLED, state…) and flows[i] = flow of each path [kg/s] at the given angles [rad].

    dm/dφ is that by the paths, without gas released by oil.
    """
    P, TAB, own = context.P, context.TAB, context.own
    E = np.empty(n_e)
    y = np.empty(N)
    i = 0
    for a in range(angles.shape[0]):
        phi = angles[a]
        inward = phi - 1e-6 if a == angles.shape[0] - 1 else phi + 1e-6
        i = locate(phi, inward, times, steps, i)
        read(phi, times, dense, i, y)
        around_chamber(phi, inward, context, E)
        theta = (phi - times[i]) / (times[i + 1] - times[i])
        before = quads[i - 1, 0] if i > 0 else 0.0
        out[a, 0] = E[E_VOLUME]
        out[a, 1] = gas_state(y[S_T], y[S_RHO], P, TAB)[0]
        out[a, 2] = before + theta * (quads[i, 0] - before)
        out[a, 3] = mass_rate(theta, i, times, dense, E, y, P)
        for j in range(N):
            out[a, 4 + j] = y[j]
        path_flows(y, E, context, flows[a])
        out[a, 3] -= given_off(y, phi, E, own, P, TAB) / P[P_OMEGA]


@kernel
def heats_along(i, angles, held, ratio, P, out):
    """Fill out with the heat [W] that effect i brings from the oil to the gas at angles [rad].

    `held` has T, m, p, rho, V, T_oil and m_oil there.
    """
    for a in range(angles.shape[0]):
        T, m, p, rho = held[a, 0], held[a, 1], held[a, 2], held[a, 3]
        out[a] = heat_part(i, T, m, p, rho, held[a, 4], angles[a], held[a, 5], held[a, 6], ratio, P)


@kernel
def pressures(y, P, TAB, out):
    """Fill out[i] with the gas pressure [Pa] at states y[i]."""
    for a in range(out.shape[0]):
        out[a] = gas_state(y[a, S_T], y[a, S_RHO], P, TAB)[0]


@kernel
def phases(y, P, TAB, out):
    """Fill out[i] with the phase of the gas at states y[i]."""
    for a in range(out.shape[0]):
        out[a] = gas_phase(y[a, S_T], y[a, S_RHO], P, TAB)


@kernel
def volumes(angles, P, TAB, out):
    """Fill out[i] with the chamber's volume [m³] at the given angles [rad]."""
    for a in range(angles.shape[0]):
        out[a] = volume_at(angles[a], P, TAB)


@kernel
def volume_slopes(angles, P, TAB, out):
    """Fill out[i] with dV/dφ [m³/rad] of a chamber at the given angles [rad]."""
    for a in range(angles.shape[0]):
        out[a] = volume_slope_at(angles[a], P, TAB)


@kernel
def oil_films(angles, times, dense, steps, context, n_e, out):
    """Fill out[i] with the oil films [kg/s] into the chamber at the given angles [rad], gap by gap.

    Oil that walls drag along is included.
    """
    E = np.empty(n_e)
    y = np.empty(N)
    i = 0
    for a in range(angles.shape[0]):
        phi = angles[a]
        inward = phi - 1e-6 if a == angles.shape[0] - 1 else phi + 1e-6
        i = locate(phi, inward, times, steps, i)
        read(phi, times, dense, i, y)
        around_chamber(phi, inward, context, E)
        films_into(y, E, context, out[a])


@kernel
def given_off_along(angles, times, dense, steps, context, n_e, out):
    """Fill out with the gas [kg/s] that oil releases, minus what it absorbs, at increasing angles [rad]."""
    P, TAB, own = context.P, context.TAB, context.own
    E = np.empty(n_e)
    y = np.empty(N)
    flows = np.empty(N_FLOWS)
    i = 0
    for a in range(angles.shape[0]):
        phi = angles[a]
        i = locate(phi, phi, times, steps, i)
        read(phi, times, dense, i, y)
        around_chamber(phi, phi, context, E)
        path_flows(y, E, context, flows)  # also sets the state of the chamber's gas
        out[a] = given_off(y, phi, E, own, P, TAB)


@kernel
def work_along(times, dense, quads, steps, context):
    """Fill quads[:, 0] with the work on the gas, −∫p dV by Simpson's rule on each step (for the trace only)."""
    P, TAB = context.P, context.TAB
    total = 0.0
    for i in range(steps):
        a = times[i]
        h = times[i + 1] - a
        share = 0.0
        for k in range(3):
            p = dense_value(0.5 * k, dense[i, 0, N], dense[i, 1, N], dense[i, 2, N], dense[i, 3, N])
            share += (4.0 if k == 1 else 1.0) * p * volume_slope_at(a + 0.5 * k * h, P, TAB)
        total -= share * h / 6.0
        quads[i, 0] = total


@kernel
def oil_with_outflow(times, dense, steps, context, n_e):
    """Return (Σ ṁ T_oil, Σ ṁ) of the outflow to the discharge plenum, including gaps beyond 720°.

    Gauss points within each step are used: where a flow starts or stops, the ends of the steps show too little.
    """
    P, TAB = context.P, context.TAB
    E = np.empty(n_e)
    y = np.empty(N)
    flows = np.empty(N_FLOWS)
    heat = 0.0
    mass = 0.0
    for i in range(steps):
        h = times[i + 1] - times[i]
        if times[i] + 0.5 * h > P[P_INJECTION] and h > 0.0:
            for point in range(POINTS):
                if not lets_out(times[i] + NODES[point] * h, times[i] + 0.5 * h, P, TAB):
                    continue
                flows_within(NODES[point], i, times, dense, context, E, y, flows)
                heat, mass = add_outflow(heat, mass, flows, y[S_T_OIL], WEIGHTS[point] * h, E)
    return heat, mass


@kernel
def port_oil(times, dense, steps, P, TAB):
    """Return the oil [kg] through ports over a life, and its integral with the chamber's pressure [kg Pa].

    The third number is its integral with the excess of the chamber's pressure over the source's (M255).
    """
    mass = 0.0
    pressure = 0.0
    lift = 0.0
    for i in range(steps):
        h = times[i + 1] - times[i]
        for k in range(POINTS):
            theta = NODES[k]
            p = dense_value(theta, dense[i, 0, N], dense[i, 1, N], dense[i, 2, N], dense[i, 3, N])
            oil = WEIGHTS[k] * h / P[P_OMEGA] * oil_inflow(times[i] + theta * h, p, P, TAB)
            mass += oil
            pressure += oil * p
            lift += oil * max(0.0, p - P[P_P_SOURCE])
    return mass, pressure, lift
