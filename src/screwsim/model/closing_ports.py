"""Where a port closes: whether one step may take all that is left of it.

Source: docs/explanation/numerics.md. A wide port holds p to its plenum's, and lets go only in the last degrees before
it closes. A step over all of that, made with the Jacobian of its start, sees the wide port at its early stages and no
flow at its end: neither its result nor its error estimate knows what was shut in. Such a step is halved until the port
is no longer stiff for what is left. `network.steps` asks this of each port and each state.
"""

from screwsim.numerics.kernel import kernel

CLOSED = 0.3  # of an opening's area at the end of a step, over that at its start, below which it counts as closing
STIFF = 10.0  # step times the largest rate of decay, above which it is too long to close along


@kernel
def closes(area, at_end):
    """Tell whether an opening closes along a step."""
    return at_end < CLOSED * area


@kernel
def stiff(h, slope):
    """Tell whether a step is too long for the decay of a state, whose rate has this derivative by itself."""
    return -h * slope > STIFF
