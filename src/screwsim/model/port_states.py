"""Port states along a life: what a history stores of a chamber beyond its states, and how neighbours read it.

A port state is the row of numbers named in `slots` from PRESSURE on; the columns of a history beyond the states hold
them. Neighbours ahead are read from the last turn, those behind from the turn being integrated where it has already
passed their angle. The surroundings of a chamber are written by `network.surroundings`.

Source: docs/model.md M5, M6, M10, M24; errors: docs/explanation/integrator.md.
"""

from screwsim.model.slots import (
    P_DISCHARGE_WIDTH,
    P_PORT_WIDTH,
    PRESSURE,
    R_DISCHARGE,
    R_SUCTION,
    S_RHO,
    S_T,
    keep_port_states,
    neighbour,
)
from screwsim.numerics.history import cubic, locate, read
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import dense_value

SHARP = 0.01  # of its scale: an effect's own state counts as at least this large in its error; valves amplify errors
SOME_GAS = 1e-3  # gas per oil that counts at least, in the error of dissolved gas
SOME_OIL = 1e-6  # oil per gas that counts at least, in its error: dry gas that meets oil exceeds this at once
HELD = 3.0  # widths of the regularisation from a line within which a pressure must not overshoot the ends of a step
IMPOSSIBLE = 1e30  # error of a step to an impossible state
NO_OIL = 1e-13  # oil per gas, of either sign, that is rounding; `balance.oil_temperature_slope` has a floor above it


@kernel
def held_to_a_line(before, after, P, R):
    """Return whether a wide port holds the pressure at both ends of a step to its line, within `HELD` widths."""
    low = R[R_SUCTION + PRESSURE]
    high = R[R_DISCHARGE + PRESSURE]
    from_low = max(abs(before - low), abs(after - low))
    from_high = max(abs(before - high), abs(after - high))
    return from_low < HELD * P[P_PORT_WIDTH] or from_high < HELD * P[P_DISCHARGE_WIDTH]


@kernel
def jumps(step, dense):
    """Return whether the gas jumps between a step and the one before; otherwise their common end is computed once."""
    if step == 0:
        return True
    return dense[step, 0, S_T] != dense[step - 1, 1, S_T] or dense[step, 0, S_RHO] != dense[step - 1, 1, S_RHO]


@kernel
def gas_at_third(k, step, dense):
    """Return temperature and density at k thirds of a step."""
    T = dense_value(k / 3.0, dense[step, 0, S_T], dense[step, 1, S_T], dense[step, 2, S_T], dense[step, 3, S_T])
    rho = dense_value(
        k / 3.0, dense[step, 0, S_RHO], dense[step, 1, S_RHO], dense[step, 2, S_RHO], dense[step, 3, S_RHO]
    )
    return T, rho


@kernel
def row_of_third(k):
    """Return the row that holds the value at k thirds of a step until the cubic is made: ends first."""
    return 0 if k == 0 else (2 if k == 1 else (3 if k == 2 else 1))


@kernel
def hold_to_line(step, dense, column, P, R):
    """Limit a step's pressures to the range of its ends, where a wide port holds these to its line."""
    before = dense[step, 0, column]
    after = dense[step, 1, column]
    if held_to_a_line(before, after, P, R):
        dense[step, 2, column] = min(max(dense[step, 2, column], min(before, after)), max(before, after))
        dense[step, 3, column] = min(max(dense[step, 3, column], min(before, after)), max(before, after))


@kernel
def make_cubic(step, dense, column):
    """Make the dense output of a column from its values at the thirds of a step."""
    v0, v1, v2, v3 = dense[step, 0, column], dense[step, 2, column], dense[step, 3, column], dense[step, 1, column]
    dense[step, 2, column], dense[step, 3, column] = cubic(v0, v1, v2, v3)


@kernel
def port_states_along(dense, steps, context):
    """Fill the columns beyond the states of a whole history."""
    for step in range(steps):
        keep_port_states(step, dense, context)


@kernel
def relative(error, before, after, least):
    """Return an error relative to the larger value at the ends of a step, or to the least that counts."""
    return abs(error) / max(abs(before), abs(after), least)


@kernel
def read_neighbour(phi, middle, times, dense, steps, hints, hint, context, E, at):
    """Fill a neighbour's port state at E[at] from a history; the search starts where the last one ended."""
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
