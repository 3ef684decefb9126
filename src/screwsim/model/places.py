"""Places: the state of the gas (and oil) in a chamber, a plenum or a neighbour, as streams and balances need it.

Source: docs/model.md M5, M6, M10; errors: docs/explanation/numerics.md. A place is the row of numbers that
`slots.PRESSURE` … name. Neighbours are read from histories, whose columns beyond the states hold their places.
"""

from __future__ import annotations

from screwsim.model.slots import (
    E_ANGLE,
    E_AREAS,
    E_OILED,
    E_SLOPE,
    E_VOLUME,
    N_PLENUM,
    P_DISCHARGE_WIDTH,
    P_INJECTION,
    P_PORT_WIDTH,
    PRESSURE,
    R_DISCHARGE,
    R_SUCTION,
    STORED,
    N,
    neighbour,
    plenum_area,
    stored,
    volume_at,
    volume_slope_at,
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
def angle_terms(phi, middle, P, TAB, E, at):
    """Fill what depends on the chamber's own angle: volume, slope, oil present, plenum areas."""
    E[at + E_VOLUME] = volume_at(phi, P, TAB)
    E[at + E_SLOPE] = volume_slope_at(phi, P, TAB)
    E[at + E_OILED] = 1.0 if middle > P[P_INJECTION] else 0.0
    E[at + E_ANGLE] = phi
    for i in range(N_PLENUM):
        E[at + E_AREAS + i] = plenum_area(i, phi, P, TAB)


@kernel
def read_neighbour(phi, middle, times, dense, steps, hints, side, P, R, columns, E, at):
    """Fill a neighbour's place from a history; `columns` is room for what it stores."""
    i = locate(phi, middle, times, steps, hints[side])
    hints[side] = i
    read(phi, times, dense, i, columns)
    neighbour(columns, P, R, E, at)


@kernel
def held_to_a_line(before, after, P, R):
    """Tell whether a wide port holds the pressure at both ends of a step to its line, within `HELD` widths."""
    low = R[R_SUCTION + PRESSURE]
    high = R[R_DISCHARGE + PRESSURE]
    from_low = max(abs(before - low), abs(after - low))
    from_high = max(abs(before - high), abs(after - high))
    return from_low < HELD * P[P_PORT_WIDTH] or from_high < HELD * P[P_DISCHARGE_WIDTH]


@kernel
def places_of_step(step, dense, P, TAB, R, own):
    """Do it for one step; unless the gas jumps between steps, the first value is the last of the step before."""
    jumps = step == 0 or dense[step, 0, 0] != dense[step - 1, 1, 0] or dense[step, 0, 1] != dense[step - 1, 1, 1]
    for k in range(0 if jumps else 1, 4):
        T = dense_value(k / 3.0, dense[step, 0, 0], dense[step, 1, 0], dense[step, 2, 0], dense[step, 3, 0])
        rho = dense_value(k / 3.0, dense[step, 0, 1], dense[step, 1, 1], dense[step, 2, 1], dense[step, 3, 1])
        stored(T, rho, P, TAB, own)
        row = 0 if k == 0 else (2 if k == 1 else (3 if k == 2 else 1))
        for i in range(STORED):
            dense[step, row, N + i] = own[i]
    for i in range(STORED):
        if not jumps:
            dense[step, 0, N + i] = dense[step - 1, 1, N + i]
        v0 = dense[step, 0, N + i]
        v3 = dense[step, 1, N + i]
        v1 = dense[step, 2, N + i]
        v2 = dense[step, 3, N + i]
        if i == PRESSURE and held_to_a_line(v0, v3, P, R):
            v1 = min(max(v1, min(v0, v3)), max(v0, v3))
            v2 = min(max(v2, min(v0, v3)), max(v0, v3))
        dense[step, 2, N + i], dense[step, 3, N + i] = cubic(v0, v1, v2, v3)


@kernel
def keep_places(step, dense, context):
    """Fill the columns beyond the states of an accepted step: pressure and enthalpy, and what else varies of a place.

    Cubics through the values at 0, 1/3, 2/3 and 1 of the step: neighbours read them instead of asking the equation of
    state again and again.
    """
    P, TAB, R, own = context.P, context.TAB, context.R, context.own
    places_of_step(step, dense, P, TAB, R, own)


@kernel
def places_along(dense, steps, context):
    """Fill the columns beyond the states of a whole history."""
    for step in range(steps):
        keep_places(step, dense, context)


@kernel
def relative(error, before, after, least):
    """Return an error relative to the larger of the values at both ends of a step, or to the least that counts."""
    return abs(error) / max(abs(before), abs(after), least)
