"""Neighbours of a chamber, whose port states are read from histories.

Source: docs/model.md M24. Those ahead are read from the last turn, those behind from the turn being integrated where it
has passed their angle already. What surrounds a chamber is written by `network.surroundings`.
"""

from screwsim.model.slots import neighbour
from screwsim.numerics.history import locate, read
from screwsim.numerics.kernel import kernel


@kernel
def read_neighbour(phi, middle, times, dense, steps, hints, hint, context, E, at):
    """Fill a neighbour's port state at E[at] from a history; the search in it begins where the last one ended."""
    columns = context.state
    i = locate(phi, middle, times, steps, hints[hint])
    hints[hint] = i
    read(phi, times, dense, i, columns)
    neighbour(columns, context.P, context.R, E, at)


@kernel
def read_ahead(phi, middle, shift, hint, context, E, at):
    """Fill the port state of the chamber `shift` [rad] ahead."""
    t_old, d_old, steps = context.t_old, context.d_old, context.kept[1]
    read_neighbour(phi + shift, middle + shift, t_old, d_old, steps, context.hints, hint, context, E, at)


@kernel
def read_behind(phi, middle, shift, hint, context, E, at):
    """Fill the port state of the chamber `shift` [rad] behind."""
    there, kept, hints = phi - shift, context.kept, context.hints
    t_new, d_new, t_old, d_old = context.t_new, context.d_new, context.t_old, context.d_old
    if kept[0] > 0 and t_new[kept[0]] >= there:
        read_neighbour(there, middle - shift, t_new, d_new, kept[0], hints, hint, context, E, at)
    else:
        read_neighbour(there, middle - shift, t_old, d_old, kept[1], hints, hint, context, E, at)
