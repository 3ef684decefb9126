"""Pulsating lines, read from a closed cycle: pressures, and flow of all chambers over one pitch (docs/model.md M184).

Angles at which a chamber is open to neither line are skipped.
"""

import numpy as np

from screwsim.model.slots import (
    E_VOLUME,
    N_FLOWS,
    P_OMEGA,
    P_PITCH,
    N,
    add_to_lines,
    around_chamber,
    balanced_alone,
    faces_line,
    gas_in,
    given_off,
    line_pulse,
    path_flows,
    volume_at,
)
from screwsim.numerics.history import read
from screwsim.numerics.kernel import kernel


@kernel
def into_lines(times, dense, steps, context, n_e, into, volume):
    """Add to into[line, k] the flow [kg/s] around even angles of a pitch, to volume[line] the mean open volume [m³].

    Lines are 0 suction, 1 discharge; both arrays are zero before. Each flow is the mean over the interval around
    its angle, by the change of the chamber's gas along each step. Ports open and shut where steps end, so a flow
    that jumps between two angles is not missed. A change of a chamber between two steps is not counted as flow (oil
    injection; in simultaneous closing, states that have not yet adjusted to a line).
    """
    P, TAB, own = context.P, context.TAB, context.own
    E = np.empty(n_e)
    y = np.empty(N)
    flows = np.empty(N_FLOWS)
    points = into.shape[1]
    width = P[P_PITCH] / points
    k = 0
    for i in range(steps):
        began = times[i]
        read(began, times, dense, i, y)
        gas = gas_in(volume_at(began, P, TAB), y, 0, P)
        while began < times[i + 1]:
            border = (k + 0.5) * width
            ended = min(border, times[i + 1])
            middle = 0.5 * (began + ended)
            read(ended, times, dense, i, y)
            left = gas_in(volume_at(ended, P, TAB), y, 0, P)
            if began < ended and faces_line(middle, P, TAB):
                read(middle, times, dense, i, y)
                around_chamber(middle, middle, context, E)
                path_flows(y, E, context, flows)
                rate = P[P_OMEGA] * (left - gas) / (ended - began)
                balanced_alone(flows, rate - given_off(y, middle, E, own, P, TAB))
                share = (ended - began) / width
                add_to_lines(flows, middle, E[E_VOLUME], share, k % points, points, P, into, volume)
            began, gas = ended, left
            if ended == border:
                k += 1


@kernel
def line_pulses(line, angles, P, out):
    """Fill out[i] with offset and pulse of a line's pressure, over its mean, at the given angles [rad] (M185)."""
    for a in range(angles.shape[0]):
        out[a, 0], out[a, 1] = line_pulse(line, angles[a], P)
