"""Flows between the ends of steps of a closed cycle, for integrals over its life.

Source: ours; Gauss–Legendre quadrature of the dense output on each step.
"""

from screwsim.model.slots import P_OMEGA, around_chamber, balanced, given_off, mass_rate, path_flows
from screwsim.numerics.history import read
from screwsim.numerics.kernel import kernel
from screwsim.numerics.quadrature import gauss

POINTS = 2  # nodes in each step
NODES, WEIGHTS = gauss(POINTS)


@kernel
def flows_within(theta, step, times, dense, context, E, y, flows):
    """Fill state, surroundings and the flow of each path [kg/s] at a share of a step; return dm/dt of the gas."""
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
    h = times[step + 1] - times[step]
    phi = times[step] + theta * h
    read(phi, times, dense, step, y)
    around_chamber(phi, times[step] + 0.5 * h, context, E)
    path_flows(y, E, context, flows)
    dm = P[P_OMEGA] * mass_rate(theta, step, times, dense, E, y, P)
    balanced(flows, dm - given_off(y, phi, E, own, P, TAB), E, own, R, P)
    return dm
