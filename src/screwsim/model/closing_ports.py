"""Where a port closes: whether one step may take all that is left of it.

Source: docs/explanation/numerics.md. A wide port holds p to its plenum's, and lets go only in the last degrees before
it closes. A step over all of that, made with the Jacobian of its start, sees the wide port at its early stages and no
flow at its end: neither its result nor its error estimate knows what was shut in. Such a step is halved until the port
is no longer stiff for what is left.
"""

from __future__ import annotations

from screwsim.model.slots import CHAMBERS, E_AREAS, N_GAPS, N_PLENUM, N
from screwsim.numerics.kernel import kernel

CLOSED = 0.3  # of an opening's area at the end of a step, over that at its start, below which it counts as closing
STIFF = 10.0  # step times the largest rate of decay, above which it is too long to close along


@kernel
def closes(E, E_end, at):
    """Tell whether an opening to a plenum closes."""
    closing = False
    for i in range(N_PLENUM):
        if E_end[at + i] < CLOSED * E[at + i]:
            closing = True
    return closing


@kernel
def lands(h, J, E, E_end, context):
    """Tell whether a step may end where the segment does."""
    if closes(E, E_end, E_AREAS):
        for i in range(N):
            if -h * J[i, i] > STIFF:
                return False
    return True


@kernel
def all_lands(h, J, E, E_end, context):
    """Tell the same of all chambers."""
    size = E_AREAS + N_PLENUM + N_GAPS
    for j in range(CHAMBERS):
        if closes(E, E_end, j * size + E_AREAS):
            for i in range(j * N, (j + 1) * N):
                if -h * J[i, i] > STIFF:
                    return False
    return True
