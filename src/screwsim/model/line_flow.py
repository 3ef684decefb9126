"""The flow of all chambers into both lines over one pitch, read from a closed cycle (docs/model.md M184).

Angles at which a chamber is open to neither line are passed over.
"""

from __future__ import annotations

import numpy as np

from screwsim.model.slots import (
    CHAMBERS,
    E_VOLUME,
    FIRST_OWN,
    GAP_OFFSET,
    N_GAPS,
    N_PLENUM,
    OFFSETS,
    P_LIFE,
    P_OMEGA,
    P_PITCH,
    PLENUM,
    N,
    given_off,
    mass_rate,
    path_flows,
    plenum_area,
)
from screwsim.model.surroundings import around_chamber
from screwsim.numerics.history import locate, read
from screwsim.numerics.kernel import kernel

ASIDE = 1e-6  # rad: beyond an angle, on the side on which a jump is read


@kernel
def faces_line(phi, P, TAB):
    """Tell whether a chamber at phi [rad] is open to a line, by a port or by a gap beyond the last chamber."""
    for i in range(N_PLENUM):
        if PLENUM[i] < FIRST_OWN and plenum_area(i, phi, P, TAB) > 0.0:
            return True
    found = False
    for i in range(N_GAPS):
        found = found or phi + OFFSETS[GAP_OFFSET[i]] * P[P_PITCH] > P[P_LIFE]
    return found


@kernel
def from_balance(flows, rate):
    """Where one port to a line alone is open, take its flow [kg/s] from the mass balance.

    Between steps a wide port's tiny Δp carries the whole error of the interpolated pressure; dm/dφ does not.
    """
    opened = 0
    port = 0
    others = 0.0
    for i in range(N_PLENUM + 2 * N_GAPS):
        if i < N_PLENUM and PLENUM[i] < FIRST_OWN:
            if flows[i] != 0.0:
                opened += 1
                port = i
        else:
            others += flows[i]
    if opened == 1:
        flows[port] = rate - others


@kernel
def into_lines(times, dense, steps, context, n_e, into, volume):
    """Add to into[line, k] the flow [kg/s] at even angles of a pitch, to volume[line] the mean volume [m³] open to it.

    Lines are 0 suction, 1 discharge; both arrays are zero before. At the start of a pitch they are those of its end, of
    the chamber behind: where all chambers are closed together, a state that a line has not met yet gives it a kick
    there, shorter than the angles are apart.
    """
    P, TAB, own = context.P, context.TAB, context.own
    E = np.empty(n_e)
    y = np.empty(N)
    flows = np.empty(N_PLENUM + 2 * N_GAPS)
    points = into.shape[1]
    i = 0
    for a in range(CHAMBERS * points):
        phi = a * (P[P_PITCH] / points)
        if not faces_line(phi, P, TAB):
            continue
        inward = phi + ASIDE if a == 0 or a % points != 0 else phi - ASIDE
        i = locate(phi, inward, times, steps, i)
        read(phi, times, dense, i, y)
        around_chamber(phi, inward, context, E)
        path_flows(y, E, context, flows)
        theta = (phi - times[i]) / (times[i + 1] - times[i])
        slope = P[P_OMEGA] * mass_rate(theta, i, times, dense, E, y, P)
        from_balance(flows, slope - given_off(y, phi, E, own, P, TAB))
        add_lines(flows, phi, E[E_VOLUME], a % points, points, P, into, volume)


@kernel
def add_lines(flows, phi, V, k, points, P, into, volume):
    """Add the flows of a chamber of volume V [m³] at phi [rad] to both lines."""
    for line in range(2):
        faces = False
        for i in range(N_PLENUM):
            if PLENUM[i] == line:
                into[line, k] -= flows[i]
                if flows[i] != 0.0:
                    faces = True
        if faces:
            volume[line] += V / points
    for i in range(N_GAPS):  # what lies ahead of the last chamber is the discharge line
        if phi + OFFSETS[GAP_OFFSET[i]] * P[P_PITCH] > P[P_LIFE]:
            into[1, k] -= flows[N_PLENUM + 2 * i]
