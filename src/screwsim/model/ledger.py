"""Sums over one life of what every stream and heat of a closed cycle moves and generates, as input of the ledger.

Source: docs/model.md M50–M57. The terms of a moment are written by `network.moments`. Each step is integrated by
Gauss–Legendre quadrature of the dense output; the sums do not depend on the ambient temperature or on the mean states
of the lines, which `evaluate.ledger` brings in.
"""

import math

import numpy as np

from screwsim.model.slots import N_FLOWS, P_OMEGA, N, add_moment, solution_entropy
from screwsim.model.within import NODES, POINTS, WEIGHTS, flows_within
from screwsim.numerics.kernel import kernel

# of a path: |flow| [kg], the enthalpy it carries [J] and the entropy generated where it arrives in a chamber [J/K];
# of its outflow to a line: mass, enthalpy, entropy, oil [kg], oil × T_oil, oil × ln T_oil
MOVED, CARRIES, GENERATED, OUT_MASS, OUT_ENTHALPY, OUT_ENTROPY, OUT_OIL, OUT_OIL_T, OUT_OIL_LOG = range(9)
# and of the gas dissolved in that oil: gas [kg], entropy [J/K]
OUT_HELD, OUT_HELD_ENTROPY = range(9, 11)
PATH_SUMS = 11
# of a heat rate: heat into the gas [J], entropy generated [J/K]; after the heat rates, the same of walls
HEAT, HEAT_GENERATED = range(2)
HEAT_SUMS = 2
# of oil that is not conserved: oil created [kg], × T_oil, × ln T_oil; heat lost beyond the gas's gain, and over T_oil
MADE, MADE_T, MADE_LOG, LOST, LOST_OVER_T = range(5)
# of oil through ports: mass [kg], × chamber pressure [kg Pa], entropy generated in the chamber [J/K]
PORT_MASS, PORT_PRESSURE, PORT_GENERATED = range(5, 8)
# of gas that flashes out of it: mass [kg], entropy generated where it arrives [J/K], including the oil's
FLASH_MASS, FLASH_GENERATED = range(8, 10)
RELEASED = 10  # of gas released by oil over time: energy that the oil loses [J]
OIL_SUMS = 11
SUMS = (  # names in the text of a moment
    *("MOVED", "CARRIES", "GENERATED", "OUT_MASS", "OUT_ENTHALPY", "OUT_ENTROPY", "OUT_OIL", "OUT_OIL_T"),
    *("OUT_OIL_LOG", "OUT_HELD", "OUT_HELD_ENTROPY", "HEAT", "HEAT_GENERATED", "MADE", "MADE_T", "MADE_LOG"),
    *("LOST", "LOST_OVER_T", "PORT_MASS", "PORT_PRESSURE", "PORT_GENERATED", "FLASH_MASS", "FLASH_GENERATED"),
    "RELEASED",
)


@kernel
def arriving(m, h_i, s_i, h, s, T):
    """Return the entropy generated [W/K] where a stream m [kg/s] of state i mixes with a chamber's gas (M50)."""
    return m * ((h_i - h) / T - (s_i - s))


@kernel
def oil_arriving(m, T_i, T):
    """Return the entropy generated over c_oil [kg/s] where oil of temperature T_i mixes with oil of T (M51).

    Between steps the cubic of the temperature of next to no oil may pass below zero, where m is practically 0.
    """
    if not (T_i > 0.0 and T > 0.0):
        return 0.0
    return m * ((T_i - T) / T - math.log(T_i / T))


@kernel
def pressed_oil_arriving(m, felt_i, p_i, felt, p, T):
    """Return the same as `oil_arriving` for oil that takes room, whose enthalpy depends on pressure (M109).

    `felt…` [K] are enthalpies over heat capacity of the incoming oil and of the chamber's, whose temperature is T.
    """
    T_i = felt_i - p_i * ((felt - T) / p)
    if not (T_i > 0.0 and T > 0.0):
        return 0.0
    return m * ((felt_i - felt) / T - math.log(T_i / T))


@kernel
def held_arriving(m, w_i, w, s, total, P, TAB):
    """Return the entropy generated [W/K] where oil m [kg/s] that holds w_i mixes with oil that holds w (M233).

    `s` is the entropy per kilogram of gas dissolved in the latter, `total` that per kilogram of its oil.
    """
    _s, total_i = solution_entropy(w_i, P, TAB)
    return m * (total + s * (w_i - w) - total_i)


@kernel
def account(times, dense, steps, context, n_e, s_suction, s_discharge, paths, heats, oil):
    """Add the moments of a closed cycle over one life to `paths`, `heats` and `oil` (zero before).

    The history must be that of the context's last turn; `s_…` are the specific entropies of the lines' gas.
    """
    P = context.P
    E = np.empty(n_e)
    y = np.empty(N)
    flows = np.empty(N_FLOWS)
    for i in range(n_e):
        E[i] = 0.0
    for step in range(steps):
        h = times[step + 1] - times[step]
        if not (h > 0.0):  # a step of scipy's may vanish by rounding when pitches are joined to a life
            continue
        for k in range(POINTS):
            phi = times[step] + NODES[k] * h
            mass_rate = flows_within(NODES[k], step, times, dense, context, E, y, flows)
            dt = WEIGHTS[k] * h / P[P_OMEGA]
            add_moment(phi, y, mass_rate, E, context, flows, s_suction, s_discharge, dt, paths, heats, oil)
