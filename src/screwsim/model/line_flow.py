"""The flow of all chambers into both lines over one pitch, read from a closed cycle (docs/model.md M184).

Angles at which a chamber is open to neither line are passed over.
"""

import numpy as np

from screwsim.model.slots import (
    CHAMBERS,
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
    path_flows,
    volume_at,
)
from screwsim.numerics.history import locate, read
from screwsim.numerics.kernel import kernel


@kernel
def into_lines(times, dense, steps, context, n_e, into, volume):
    """Add to into[line, k] the flow [kg/s] around even angles of a pitch, to volume[line] the mean volume [m³] open.

    Lines are 0 suction, 1 discharge; both arrays are zero before. A flow is the mean over what lies nearer to its angle
    than to others, by the change of the chamber's gas, so that a flow that jumps between two angles is missed by
    neither. The first angle of a pitch has half of that at the pitch's start, half at its end: what a chamber changes
    between the two (oil that is injected; all chambers together, while a state has not met a line yet) is no flow.
    """
    P, TAB, own = context.P, context.TAB, context.own
    E = np.empty(n_e)
    y = np.empty(N)
    flows = np.empty(N_FLOWS)
    points = into.shape[1]
    width = P[P_PITCH] / points
    i = 0
    for a in range(CHAMBERS * (points + 1)):
        k = a % (points + 1)
        start = (a // (points + 1)) * P[P_PITCH]
        began = start + max(k - 0.5, 0.0) * width
        ended = start + min(k + 0.5, float(points)) * width
        phi = 0.5 * (began + ended)
        if not faces_line(phi, P, TAB):
            continue
        i = locate(began, phi, times, steps, i)
        read(began, times, dense, i, y)
        gas = gas_in(volume_at(began, P, TAB), y, 0, P)
        i = locate(ended, phi, times, steps, i)
        read(ended, times, dense, i, y)
        gained = gas_in(volume_at(ended, P, TAB), y, 0, P) - gas
        i = locate(phi, phi, times, steps, i)
        read(phi, times, dense, i, y)
        around_chamber(phi, phi, context, E)
        path_flows(y, E, context, flows)
        balanced_alone(flows, P[P_OMEGA] * gained / (ended - began) - given_off(y, phi, E, own, P, TAB))
        share = (ended - began) / width
        add_to_lines(flows, phi, E[E_VOLUME], share, k % points, points, P, into, volume)
