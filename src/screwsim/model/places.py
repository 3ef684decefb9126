"""Places: the state of the gas (and oil) in a chamber, a plenum or a neighbour, as streams and balances need it.

Source: docs/model.md M5, M6, M10; errors: docs/explanation/numerics.md. A place is the row of numbers that
`slots.PRESSURE` … name. Neighbours are read from histories, whose columns beyond the states hold their places.
"""

from __future__ import annotations

from screwsim.model.room import with_room
from screwsim.model.slots import (
    C_V,
    CARRIED,
    CHOKE,
    CHOKED,
    DENSITY,
    DISSOLVED,
    DISSOLVES,
    E_ANGLE,
    E_AREAS,
    E_OILED,
    E_SLOPE,
    E_VOLUME,
    ENTHALPY,
    EXPONENT,
    FREE,
    HEATED,
    HELD,
    N_PLENUM,
    OIL_RATIO,
    OIL_TEMPERATURE,
    OWN_STATES,
    P_INJECTION,
    PHASES,
    PLACE,
    POSITIVE,
    PRESSURE,
    R_SUCTION,
    S_RHO,
    S_T_OIL,
    S_X_OIL,
    TPT,
    VARIES,
    VOLUMED,
    N,
    gas_phase,
    gas_state,
    phased_state,
    plenum_area,
    volume_at,
    volume_slope_at,
)
from screwsim.numerics.history import cubic, locate, read
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import dense_coefficients, dense_value

SHARP = 0.01  # of its scale: an effect's own state below it errs as if it were that large; valves amplify errors
SOME_GAS = 1e-3  # gas per oil below which its error counts as that of so much
SOME_OIL = 1e-6  # oil per gas below which its error counts as that of so much: dry gas that meets oil takes it at once
BEYOND = 0.3  # share of the tolerance by which a step is to pass the border of a phase
IMPOSSIBLE = 1e30  # error of a step to a state that cannot be
NO_OIL = 1e-13  # oil per gas, of either sign, that is rounding; `balance.oil_temperature_slope` has a floor above it
LEAST = 1e-6  # exponent and choking of a neighbour: a cubic across a border of the phases may dip below none


@kernel
def fill_place(held, y, at, P, TAB, place, row):
    """Fill row `row` of `place` for a chamber whose state begins at y[at]; in the phase that is held, or its own."""
    T = y[at]
    rho = y[at + S_RHO]
    phase = 0
    if PHASES == 1:
        phase = gas_phase(T, rho) if held == FREE else int(held)
    p, h, c_v, tpt, exponent, choke, choked = phased_state(phase, T, rho, P, TAB)
    place[row + PRESSURE] = p
    place[row + DENSITY] = rho
    place[row + ENTHALPY] = h
    place[row + EXPONENT] = exponent
    place[row + CHOKE] = choke
    place[row + CHOKED] = choked
    place[row + C_V] = c_v
    place[row + TPT] = tpt
    if HEATED == 1:
        place[row + OIL_TEMPERATURE] = y[at + S_T_OIL]
    if CARRIED == 1:
        place[row + OIL_RATIO] = y[at + S_X_OIL]
    if DISSOLVES == 1:
        place[row + DISSOLVED] = y[at + HELD]
    if VOLUMED == 1:
        with_room(place, row, P)


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
def neighbour(phi, middle, times, dense, steps, hints, side, R, columns, E, at):
    """Fill a neighbour's place from a history; `columns` is room for what it stores."""
    i = locate(phi, middle, times, steps, hints[side])
    hints[side] = i
    read(phi, times, dense, i, columns)
    E[at + PRESSURE] = columns[N]
    E[at + DENSITY] = columns[S_RHO]
    E[at + ENTHALPY] = columns[N + S_RHO]
    for k in range(3):  # exponent, choking: constants of an ideal gas, the same everywhere
        E[at + EXPONENT + k] = max(LEAST, columns[N + 2 + k]) if VARIES == 1 else R[R_SUCTION + EXPONENT + k]
    if HEATED == 1:
        E[at + OIL_TEMPERATURE] = columns[S_T_OIL]
    if CARRIED == 1:
        E[at + OIL_RATIO] = max(0.0, columns[S_X_OIL])  # a cubic between two steps may dip below none by its error
    if DISSOLVES == 1:
        E[at + DISSOLVED] = columns[HELD]
    E[at + PLACE] = 0.0


@kernel
def places_of_step(step, dense, P, TAB, own):
    """Do it for one step; the gas does not jump between steps, so the first value is the last of the step before."""
    extra = 5 if VARIES == 1 else 2
    for k in range(1 if step > 0 else 0, 4):
        T = dense_value(k / 3.0, dense[step, 0, 0], dense[step, 1, 0], dense[step, 2, 0], dense[step, 3, 0])
        rho = dense_value(k / 3.0, dense[step, 0, 1], dense[step, 1, 1], dense[step, 2, 1], dense[step, 3, 1])
        p, h, _c_v, _tpt, exponent, choke, choked = gas_state(T, rho, P, TAB)
        own[0] = p
        own[1] = h
        if VARIES == 1:
            own[2] = exponent
            own[3] = choke
            own[4] = choked
        row = 0 if k == 0 else (2 if k == 1 else (3 if k == 2 else 1))
        for i in range(extra):
            dense[step, row, N + i] = own[i]
    if VOLUMED == 1:  # oil that displaces gas makes it jump
        p, h, _c_v, _tpt, exponent, choke, choked = gas_state(dense[step, 0, 0], dense[step, 0, 1], P, TAB)
        dense[step, 0, N] = p
        dense[step, 0, N + 1] = h
        if VARIES == 1:
            dense[step, 0, N + 2] = exponent
            dense[step, 0, N + 3] = choke
            dense[step, 0, N + 4] = choked
    for i in range(extra):
        if VOLUMED == 0 and step > 0:
            dense[step, 0, N + i] = dense[step - 1, 1, N + i]
        v0 = dense[step, 0, N + i]
        v3 = dense[step, 1, N + i]
        v1 = dense[step, 2, N + i]
        v2 = dense[step, 3, N + i]
        dense[step, 2, N + i], dense[step, 3, N + i] = cubic(v0, v1, v2, v3)


@kernel
def keep_places(step, dense, context):
    """Fill the columns beyond the states of an accepted step: pressure and enthalpy, and what else varies of a place.

    Cubics through the values at 0, 1/3, 2/3 and 1 of the step: neighbours read them instead of asking the equation of
    state again and again.
    """
    P, TAB, own = context.P, context.TAB, context.own
    places_of_step(step, dense, P, TAB, own)


@kernel
def places_along(dense, steps, context):
    """Fill the columns beyond the states of a whole history."""
    for step in range(steps):
        keep_places(step, dense, context)


@kernel
def relative_error(y0, y1, error, at, place, row):
    """Return the largest relative error of one chamber's states; huge for states that cannot be.

    Relative, but for next to no oil. In the dome p follows T by 7:1 and more, and flows follow p: the error of T counts
    as that of the pressure that it makes, at fixed density, where that is larger (for an ideal gas they are equal). A
    negative T, ρ or oil ratio would pass where it is small beside the value before the step, and oil less than none is
    unstable.
    """
    worst = 0.0
    for i in range(N):
        least = SOME_OIL if i == 3 else 1e-300
        if OWN_STATES > 0 and i >= N - OWN_STATES:
            least = 1e-300 if POSITIVE[i - (N - OWN_STATES)] == 1 else SHARP
        if DISSOLVES == 1 and i == HELD:
            least = SOME_GAS
        e = abs(error[at + i]) / max(abs(y0[at + i]), abs(y1[at + i]), least)
        if i == 0:
            e *= max(1.0, place[row + TPT] / place[row + PRESSURE])
        if CARRIED == 1 and i == 2:
            e *= min(1.0, max(abs(y0[at + S_X_OIL]), abs(y1[at + S_X_OIL])) / SOME_OIL)
        if DISSOLVES == 1 and i == HELD:
            e = max(
                e * min(1.0, max(abs(y0[at + S_X_OIL]), abs(y1[at + S_X_OIL])) / SOME_OIL),
                abs(error[at + i] * y1[at + S_X_OIL]),
            )
        if not (e <= worst):
            worst = e
        if e != e:
            return IMPOSSIBLE
    if not (y1[at] > 0.0 and y1[at + S_RHO] > 0.0):
        return IMPOSSIBLE
    if HEATED == 1 and not (y1[at + S_T_OIL] > 0.0):
        return IMPOSSIBLE
    if CARRIED == 1 and not (y1[at + S_X_OIL] > -NO_OIL):
        return IMPOSSIBLE
    if OWN_STATES > 0:
        for i in range(OWN_STATES):
            if POSITIVE[i] == 1 and not (y1[at + N - OWN_STATES + i] > 0.0):
                return IMPOSSIBLE
    return worst


@kernel
def share_before_border(held, y0, y1, u, at, tpt_over_p, rtol):
    """Return the share of a step after which a chamber leaves the phase held; 1 where it does not, or hardly.

    The state's derivatives jump there, so a step must end there. Beyond it, within the tolerance, the phase's own
    equation goes on smoothly.
    """
    if PHASES == 0 or gas_phase(y1[at], y1[at + S_RHO]) == int(held):
        return 1.0
    T3, T4 = dense_coefficients(u, at)
    rho3, rho4 = dense_coefficients(u, at + 1)
    low = 0.0
    high = 1.0
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        T = dense_value(middle, y0[at], y1[at], T3, T4)
        rho = dense_value(middle, y0[at + S_RHO], y1[at + S_RHO], rho3, rho4)
        if gas_phase(T, rho) == int(held):
            low = middle
        else:
            high = middle
    T = dense_value(high, y0[at], y1[at], T3, T4)
    rho = dense_value(high, y0[at + S_RHO], y1[at + S_RHO], rho3, rho4)
    beyond = max(abs(y1[at] - T) / T * max(1.0, tpt_over_p), abs(y1[at + S_RHO] - rho) / rho)
    return 1.0 if beyond <= rtol else high + (1.0 - high) * BEYOND * rtol / beyond
