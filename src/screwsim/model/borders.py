"""Borders at which a step ends: of a phase; where a one-way path opens, flattens or shuts; where a port closes.

And where gas begins to flash out of oil that flows in, or ceases to: the rates have a corner there.

The equations change at the first two. A wide port holds p to its plenum's, and releases it only in the last degrees
before it closes. A step over all of that, made with the Jacobian of its start, sees a wide port at its early stages and
no flow at its end: neither its result nor its error estimate covers what was shut in. Such a step is halved until the
port is no longer stiff over the rest. `network.steps` applies this to each port and each state.

Source: docs/reference/slider-crank.md S22, S25–S27 (`FlowPath.opening`); docs/explanation/integrator.md.
"""

from screwsim.model.slots import S_RHO, S_T, gas_phase, gas_state
from screwsim.numerics.kernel import kernel
from screwsim.numerics.rodas import dense_coefficients, dense_value

CLOSED = 0.3  # ratio of an opening's area at the end of a step to that at its start, below which it counts as closing
STIFF = 10.0  # step times the largest rate of decay, above which a step is too long along a closing port
BEYOND = 0.3  # share of the tolerance by which a step passes the border of a phase
SWITCHED = 1e-4  # share of the regularisation's width by which a step passes the switch of a valve
CORNER_NEAR = 0.01  # share of a step: a corner of the rates this near to one of its ends counts as at that end
FLATTER = 1.5  # largest ratio, over a step, of the slope of a valve's flow over Δp at its start to that at its end


@kernel
def pressure_within(share, y, y1, u, P, TAB):
    """Return the pressure [Pa] of a chamber at a share of a step."""
    T3, T4 = dense_coefficients(u, 0)
    rho3, rho4 = dense_coefficients(u, 1)
    T = dense_value(share, y[S_T], y1[S_T], T3, T4)
    rho = dense_value(share, y[S_RHO], y1[S_RHO], rho3, rho4)
    p, _h, _c, _t, _a, _x, _f = gas_state(T, rho, P, TAB)
    return p


@kernel
def share_before_switch(one_way, line, width, held, most, y, y1, u, P, TAB):
    """Return the share of a step, at most `most`, after which a one-way path to a line opens or shuts.

    `held` is 1 if it is open. The switch is passed by at most SWITCHED of the width of the regularisation.
    """
    against = -one_way if held == 1.0 else one_way  # the direction in which it switches
    p1, _h, _c, _t, _a, _x, _f = gas_state(y1[S_T], y1[S_RHO], P, TAB)
    if not (against * (line - p1) > SWITCHED * width):
        return most
    low = 0.0
    high = most
    while high - low > 1e-12:
        middle = 0.5 * (low + high)
        p = pressure_within(middle, y, y1, u, P, TAB)
        if against * (line - p) > 0.5 * SWITCHED * width:
            high = middle
        else:
            low = middle
    return high


@kernel
def share_while_steep(line, width, held, most, y, y1, u, P, TAB):
    """Return the share of a step, at most `most`, along which the flow of an open one-way path flattens by FLATTER.

    Its slope over Δp goes as (Δp² + ε²)^(−1/4) and is steepest where the path opens. A stiff step with the Jacobian
    from there overestimates how firmly the line holds the chamber, and damps its own error estimate.
    """
    if held != 1.0:
        return most
    p0, _h, _c, _t, _a, _x, _f = gas_state(y[S_T], y[S_RHO], P, TAB)
    limit = FLATTER**4 * ((line - p0) ** 2 + width**2) - width**2
    p1, _h, _c, _t, _a, _x, _f = gas_state(y1[S_T], y1[S_RHO], P, TAB)
    if (line - p1) ** 2 <= limit:
        return most
    low = 0.0
    high = most
    while high - low > 1e-3 * high:
        middle = 0.5 * (low + high)
        p = pressure_within(middle, y, y1, u, P, TAB)
        if (line - p) ** 2 > limit:
            high = middle
        else:
            low = middle
    return high


@kernel
def share_before_border(held, y0, y1, u, at, tpt_over_p, rtol, P, TAB):
    """Return the share of a step after which a chamber leaves the held phase; 1 where it does not, or hardly.

    Derivatives of the state jump there, so a step must end there. Beyond it, within the tolerance, the phase's own
    equation is continued smoothly.
    """
    if gas_phase(y1[at], y1[at + S_RHO], P, TAB) == int(held):
        return 1.0
    T3, T4 = dense_coefficients(u, at)
    rho3, rho4 = dense_coefficients(u, at + 1)
    low = 0.0
    high = 1.0
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        T = dense_value(middle, y0[at], y1[at], T3, T4)
        rho = dense_value(middle, y0[at + S_RHO], y1[at + S_RHO], rho3, rho4)
        if gas_phase(T, rho, P, TAB) == int(held):
            low = middle
        else:
            high = middle
    T = dense_value(high, y0[at], y1[at], T3, T4)
    rho = dense_value(high, y0[at + S_RHO], y1[at + S_RHO], rho3, rho4)
    beyond = max(abs(y1[at] - T) / T * max(1.0, tpt_over_p), abs(y1[at + S_RHO] - rho) / rho)
    return 1.0 if beyond <= rtol else high + (1.0 - high) * BEYOND * rtol / beyond


@kernel
def share_before_flash(begins, y, y1, u, P, TAB):
    """Return the share of a step after which a chamber passes the pressure `begins` [Pa]; 1 where it does not.

    Below it gas flashes out of the oil that flows in, above it none does (M196). No error of the states tells what a
    step across that corner makes of the gas, and the next finer one may lie as well.
    """
    p0, _h, _c, _t, _a, _x, _f = gas_state(y[S_T], y[S_RHO], P, TAB)
    p1, _h, _c, _t, _a, _x, _f = gas_state(y1[S_T], y1[S_RHO], P, TAB)
    if not (p0 - begins) * (p1 - begins) < 0.0:
        return 1.0
    low = 0.0
    high = 1.0
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        p = pressure_within(middle, y, y1, u, P, TAB)
        if (p0 - begins) * (p - begins) > 0.0:
            low = middle
        else:
            high = middle
    return high if CORNER_NEAR < high < 1.0 - CORNER_NEAR else 1.0


@kernel
def closes(area, at_end):
    """Return whether an opening closes along a step."""
    return at_end < CLOSED * area


@kernel
def stiff(h, slope):
    """Return whether a step is too long for the decay of a state, given the derivative of its rate by itself."""
    return -h * slope > STIFF
