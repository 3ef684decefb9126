"""All chambers alive at once, over one lobe pitch: their surroundings.

Source: docs/model.md M24. Chamber j stands at s + j pitch. Their rates are written by `network.chambers`; a context is
a `contexts.CoupledContext`.
"""

from __future__ import annotations

from screwsim.model.places import angle_terms
from screwsim.model.slots import CHAMBERS, E_AREAS, N_GAPS, N_PLENUM, P_PITCH, all_lines_at, gap_area
from screwsim.numerics.kernel import kernel


@kernel
def all_surroundings(s, middle, context, E):
    """Fill E for all chambers, the first at angle s: angle terms and, for the trailing side, areas of the gaps."""
    P, TAB, R = context.P, context.TAB, context.R
    size = E_AREAS + N_PLENUM + N_GAPS
    for j in range(CHAMBERS):
        phi = s + j * P[P_PITCH]
        angle_terms(phi, middle + j * P[P_PITCH], P, TAB, E, j * size)
        for i in range(N_GAPS):
            E[j * size + E_AREAS + N_PLENUM + i] = gap_area(i, phi, P, TAB)
    all_lines_at(s, P, R, E)
