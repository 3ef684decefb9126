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
    given_off,
    mass_rate,
    path_flows,
)
from screwsim.numerics.history import locate, read
from screwsim.numerics.kernel import kernel

ASIDE = 1e-6  # rad: beyond an angle, on the side on which a jump is read


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
    flows = np.empty(N_FLOWS)
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
        balanced_alone(flows, slope - given_off(y, phi, E, own, P, TAB))
        add_to_lines(flows, phi, E[E_VOLUME], a % points, points, P, into, volume)
