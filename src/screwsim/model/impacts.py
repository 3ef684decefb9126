"""A state that moves between a seat and a stop: impacts, rest, and the angles at which steps end for them.

A position lies between 0 (seat) and 1 (stop). Where the dense output of a step meets either, the step is repeated to
end there, and the impact law v' = -e v is applied before the next step. A bounce too low to matter at the accuracy is
dropped: the state rests, with zero rates, until the push reverses; a step ends there, too.

Each kernel handles one pair of position and speed, the states `i` and `j`. A chamber's own port state holds the pair's
`mode` (`MOVES`, `SEATED`, `STOPPED`) and what is `due` at the end of the step; after those of all pairs, the number of
impacts of the turn and the angles where the attempted step begins and ends. `network.stops` writes the calls for every
pair.

Source: docs/reference/slider-crank.md S26, S32, S33; docs/explanation/integrator.md.
"""

import math

from screwsim.model.slots import S_RHO, S_T, push_on
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import dense_coefficients, dense_value

SEATED = -1.0
MOVES = 0.0
STOPPED = 1.0
LEAVES = 2.0  # due: a resting pair starts to move

NEAR = 0.001  # of the tolerance of a step: distance within which a position has met seat or stop
TURNED = 0.1  # of that tolerance: push away from rest up to which leaving is not late
LOW = 0.1  # of that tolerance: height of a bounce below which it is dropped
PLACED = 1e-11  # rad: precision with which an angle can be met
MOST_IMPACTS = 5000  # of a turn


@kernel
def begin(y, own, i, j, mode, due, R, P, TAB):
    """Set the mode at the start of a turn, whose state may be a mixture of other states."""
    own[mode] = MOVES
    own[due] = MOVES
    for side in (SEATED, STOPPED):
        end = 0.5 * (1.0 + side)
        if side * (y[i] - end) >= 0.0:
            y[i] = end
            if side * y[j] >= 0.0:
                y[j] = 0.0
                if side * push_on(y[S_T], y[S_RHO], y, R, P, TAB) > 0.0:
                    own[mode] = side


@kernel
def keep_at_rest(own, mode, i, j, f):
    """Set the rates of a resting pair to zero."""
    if own[mode] != MOVES:
        f[i] = 0.0
        f[j] = 0.0


@kernel
def keep_rows_at_rest(own, mode, i, j, J):
    """Do the same for the rows of the Jacobian."""
    if own[mode] != MOVES:
        for state in range(J.shape[1]):
            J[i, state] = 0.0
            J[j, state] = 0.0


@kernel
def turning_point(which, y0, y1, c3, c4):
    """Return the share of a step at which its cubic has its first (0) or second (1) extremum.

    1 if not within the step.
    """
    a = -3.0 * c4
    b = 2.0 * (c4 - c3)
    c = y1 - y0 + c3
    root = b * b - 4.0 * a * c
    if root <= 0.0:
        return 1.0
    q = -0.5 * (b + math.copysign(math.sqrt(root), b))
    first = q / a if abs(a) > 1e-300 else 2.0
    second = c / q if abs(q) > 1e-300 else 2.0
    found = max(first, second)
    other = min(first, second)
    if which == 0 and other > 0.0:
        found = other
    if which == 1 and not (other > 0.0):
        return 1.0
    return found if 0.0 < found < 1.0 else 1.0


@kernel
def share_before_meeting(y0, y1, c3, c4, near):
    """Return the share of a step after which its cubic is beyond 0 or 1 by half of `near`; 1 if it stays within."""
    before = 0.0
    for piece in range(3):
        after = 1.0 if piece == 2 else turning_point(piece, y0, y1, c3, c4)
        x = dense_value(after, y0, y1, c3, c4)
        if x < -near or x > 1.0 + near:
            low = before
            high = after
            for _ in range(60):
                middle = 0.5 * (low + high)
                x = dense_value(middle, y0, y1, c3, c4)
                if x < -0.5 * near or x > 1.0 + 0.5 * near:
                    high = middle
                else:
                    low = middle
            return high
        before = after
    return 1.0


@kernel
def share_before_leaving(side, y, y1, u, most, R, P, TAB):
    """Return the share of a step after which the push away from rest is half of `most`."""
    T3, T4 = dense_coefficients(u, 0)
    rho3, rho4 = dense_coefficients(u, 1)
    low = 0.0
    high = 1.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        T = dense_value(middle, y[S_T], y1[S_T], T3, T4)
        rho = dense_value(middle, y[S_RHO], y1[S_RHO], rho3, rho4)
        if -side * push_on(T, rho, y, R, P, TAB) > 0.5 * most:
            high = middle
        else:
            low = middle
    return high


@kernel
def share_before_event(y, y1, u, rtol, step, own, i, j, mode, due, R, P, TAB):
    """Return the share of a step [rad] after which a pair meets seat or stop, or leaves it; 1 if it does not.

    What is due at the end of the step is stored.
    """
    share = 1.0
    side = own[mode]
    own[due] = MOVES
    if side == MOVES:
        c3, c4 = dense_coefficients(u, i)
        slope = abs(y1[i] - y[i] - c3 - c4) / step  # of the cubic, at its end
        near = max(NEAR * rtol, PLACED * slope)
        share = share_before_meeting(y[i], y1[i], c3, c4, near)
        if y1[i] <= near and y1[j] < 0.0:
            own[due] = SEATED
        if y1[i] >= 1.0 - near and y1[j] > 0.0:
            own[due] = STOPPED
    else:
        off = -side * push_on(y1[S_T], y1[S_RHO], y1, R, P, TAB)
        was = -side * push_on(y[S_T], y[S_RHO], y, R, P, TAB)
        near = max(TURNED * rtol, PLACED * abs(off - was) / step)
        if off > near:
            share = share_before_leaving(side, y, y1, u, near, R, P, TAB)
        if off > 0.0:
            own[due] = LEAVES
    return share


@kernel
def put_within(y1, own, i, due):
    """Set a position at the end of an accepted step to the seat or stop it met, and limit it to 0 … 1."""
    y1[i] = min(1.0, max(0.0, y1[i]))
    if own[due] == SEATED:
        y1[i] = 0.0
    if own[due] == STOPPED:
        y1[i] = 1.0


@kernel
def take_event(y, rtol, own, j, mode, due, seat, stop, R, P, TAB):
    """Apply what is due between two steps: an impact, with or without a bounce, or leaving seat or stop.

    `seat` and `stop` are the ratios of speeds after and before an impact on them. Return the number of impacts.
    """
    side = own[due]
    own[due] = MOVES
    if side == LEAVES:
        own[mode] = MOVES
        return 0.0
    if side == MOVES:
        return 0.0
    bounce = (seat if side == SEATED else stop) * abs(y[j])
    push = side * push_on(y[S_T], y[S_RHO], y, R, P, TAB)
    if push > 0.0 and 0.5 * bounce * bounce <= LOW * rtol * push:
        y[j] = 0.0
        own[mode] = side
    else:
        y[j] = -side * bounce
    return 1.0
