"""Port states along a life: what a history holds of a chamber beyond its states, and how neighbours read it.

A port state is the row of numbers that `slots.PRESSURE` … name; the columns of a history beyond the states hold them.
Neighbours ahead are read from the last turn, those behind from the turn being integrated where it has passed their
angle already. What surrounds a chamber is written by `network.surroundings`.

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

SHARP = 0.01  # of its scale: an effect's own state below it errs as if it were that large; valves amplify errors
SOME_GAS = 1e-3  # gas per oil below which its error counts as that of so much
SOME_OIL = 1e-6  # oil per gas below which its error counts as that of so much: dry gas that meets oil takes it at once
HELD = 3.0  # widths of the regularisation from a line: between ends so near it a pressure does not overshoot them
IMPOSSIBLE = 1e30  # error of a step to a state that cannot be
NO_OIL = 1e-13  # oil per gas, of either sign, that is rounding; `balance.oil_temperature_slope` has a floor above it


@kernel
def held_to_a_line(before, after, P, R):
    """Tell whether a wide port holds the pressure at both ends of a step to its line, within `HELD` widths."""
    low = R[R_SUCTION + PRESSURE]
    high = R[R_DISCHARGE + PRESSURE]
    from_low = max(abs(before - low), abs(after - low))
    from_high = max(abs(before - high), abs(after - high))
    return from_low < HELD * P[P_PORT_WIDTH] or from_high < HELD * P[P_DISCHARGE_WIDTH]


@kernel
def jumps(step, dense):
    """Tell whether the gas jumps between a step and the one before: else the first values are the last before it."""
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
    """Return where the value at k thirds of a step stands until the cubic is made: ends first."""
    return 0 if k == 0 else (2 if k == 1 else (3 if k == 2 else 1))


@kernel
def hold_to_line(step, dense, column, P, R):
    """Hold a step's pressures within those at its ends, where a wide port holds these to its line."""
    before = dense[step, 0, column]
    after = dense[step, 1, column]
    if held_to_a_line(before, after, P, R):
        dense[step, 2, column] = min(max(dense[step, 2, column], min(before, after)), max(before, after))
        dense[step, 3, column] = min(max(dense[step, 3, column], min(before, after)), max(before, after))


@kernel
def make_cubic(step, dense, column):
    """Make the dense output of a column out of its values at the thirds of a step."""
    v0, v1, v2, v3 = dense[step, 0, column], dense[step, 2, column], dense[step, 3, column], dense[step, 1, column]
    dense[step, 2, column], dense[step, 3, column] = cubic(v0, v1, v2, v3)


@kernel
def port_states_along(dense, steps, context):
    """Fill the columns beyond the states of a whole history."""
    for step in range(steps):
        keep_port_states(step, dense, context)


@kernel
def relative(error, before, after, least):
    """Return an error relative to the larger of the values at both ends of a step, or to the least that counts."""
    return abs(error) / max(abs(before), abs(after), least)


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
