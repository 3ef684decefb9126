"""Rodas4: a stiffly accurate, L-stable Rosenbrock method of order 4(3) with six stages and dense output of order 3.

Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, section IV.7 (RODAS,
first set of coefficients). Form of the stages: (1/(γh) − J) u_i = f(φ + c_i h, y + Σ a_ij u_j) + Σ C_ij u_j/h
+ h d_i f_φ; the step is y + Σ_{j<5} a_5j u_j + u_5 + u_6, its error estimate u_6.

Quadratures q' = g(φ, y) do not feed back. Their stages are linear, so they reduce to one weighted sum,
q += h [Σ β_i g_i + J_q Σ β_i u_i + h f_q,φ Σ β_i d_i] with β = γ (1 − γC)^(−T) m: exactly what the method gives for
the system enlarged by q, at a fraction of the cost; linear invariants (mass) are kept to rounding.

The model is connected by ten slots:

- `surroundings`: everything that depends on φ alone;
- `rates`;
- `jacobian`: rates and their derivatives by the state and by φ, from the surroundings at φ and at φ + δ;
- `at_breakpoint`: jumps of the state;
- `lands`: whether one step may take the whole rest of a segment, from the surroundings at both ends;
- `error_size`: the size of a step's error; huge for an impossible state, so that a smaller step is tried;
- `share_in_phase`: the share of a step after which the equations change their form, 1 where they do not; the step is
  repeated with that length;
- `conserve`: closes the balances of an accepted step, in its end and its quadratures;
- `keep_port_states`: fills columns of the dense output beyond the states;
- `jump`: changes the state from which the next step begins where an event is due, and tells whether the integration may
  go on; `share_in_phase` makes a step end there.

Steps land on breakpoints and keep their size across them. STATES and QUADRATURES, their numbers, are constants of the
text, so that short loops are unrolled.
"""

import math
from typing import Any

import numpy as np

from screwsim.numerics.kernel import Slot, Structure, kernel
from screwsim.numerics.linear import lu_factor, lu_solve

surroundings = Slot("surroundings")
rates = Slot("rates")
jacobian = Slot("jacobian")
at_breakpoint = Slot("at_breakpoint")
lands = Slot("lands")
error_size = Slot("error_size")
share_in_phase = Slot("share_in_phase")
conserve = Slot("conserve")
keep_port_states = Slot("keep_port_states")
jump = Slot("jump")

STATES: Any = Structure("STATES")
QUADRATURES: Any = Structure("QUADRATURES")

GAMMA = 0.25
ORDER = 4
STAGES = 6
LAST = STAGES - 1  # the stage that is the error estimate of a step
DENSE_STAGES = 5  # number of stages that enter the dense output
A = np.array(
    (
        (0.0, 0.0, 0.0, 0.0, 0.0),
        (1.544, 0.0, 0.0, 0.0, 0.0),
        (0.9466785280815826, 0.2557011698983284, 0.0, 0.0, 0.0),
        (3.314825187068521, 2.896124015972201, 0.9986419139977817, 0.0, 0.0),
        (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 0.0),
        (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0),
    )
)
C = np.array(
    (
        (0.0, 0.0, 0.0, 0.0, 0.0),
        (-5.6688, 0.0, 0.0, 0.0, 0.0),
        (-2.430093356833875, -0.2063599157091915, 0.0, 0.0, 0.0),
        (-0.1073529058151375, -9.594562251023355, -20.47028614809616, 0.0, 0.0),
        (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160, 0.0),
        (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
    )
)
NODES = np.array((0.0, 0.386, 0.21, 0.63, 1.0, 1.0))
D = np.array((0.25, -0.1043, 0.1035, -0.03620000000000023, 0.0, 0.0))
DENSE = np.array(
    (
        (10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662, 0.0),
        (-0.6762803392801253, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872, 0.0),
    )
)


def quadrature_weights(gamma: float, a: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return β = γ (1 − γC)^(−T) m, the weights of the linear stages of a quadrature."""
    stages = len(a)
    couplings = np.zeros((stages, stages))
    couplings[:, :-1] = c
    return gamma * np.linalg.solve((np.eye(stages) - gamma * couplings).T, np.append(a[-1], 1.0))


BETA = quadrature_weights(GAMMA, A, C)
BETA_D = float(BETA @ D)
POWER = -1.0 / ORDER  # exponent of the error in the factor of the next step

TAKEN, REFUSED, EVALUATED, JACOBIANS = range(4)  # counters: steps, rejected steps, calls of `rates`, Jacobians
OK = 0
STEP_TOO_SMALL = 1
TOO_MANY_STEPS = 2
TOO_MANY_JUMPS = 3
ANGLE_STEP = 1e-6  # [rad] for finite differences over the angle
GROWTH = 2.5  # largest ratio of successive steps: faster growth jumps into regions that no error estimate has seen
LONGEST = math.pi / 3.0  # longest step: over a closing port a longer, stiff one would see neither area nor error
SMALLEST = 1e-13  # shortest step over the angle: shorter ones mean that rates are not finite or not solvable
AT_FIRST = 1e-7  # factor on that limit at angle zero, where a tiny amount of oil may change within very short steps ...
NO_MORE = 1e-6  # ... [rad] growing to 1 at this angle


@kernel
def attempt(phi, h, middle, y, context, E_next, f, g, f_phi, g_phi, J, Jq, M, pivots, u, y1, g_stage, dq):
    """Try one step from y; fill y1 (new state), dq (quadratures), u (stages; u[LAST] is the error), E_next."""
    n = STATES
    nq = QUADRATURES
    inverse = 1.0 / h
    shift = inverse / GAMMA
    for i in range(n):
        for j in range(n):
            M[i, j] = -J[i, j]
        M[i, i] += shift
        u[0, i] = f[i] + h * D[0] * f_phi[i]
    lu_factor(M, pivots, n)
    lu_solve(M, pivots, u[0], n)
    for i in range(nq):
        dq[i] = BETA[0] * g[i] + h * BETA_D * g_phi[i]
    for stage in range(1, STAGES):
        for i in range(n):
            value = y[i]
            for j in range(stage):
                value += A[stage, j] * u[j, i]
            y1[i] = value
        if stage < LAST:
            surroundings(phi + NODES[stage] * h, middle, context, E_next)
        rates(y1, E_next, context, u[stage], g_stage)
        for i in range(n):
            value = 0.0
            for j in range(stage):
                value += C[stage, j] * u[j, i]
            u[stage, i] += value * inverse + h * D[stage] * f_phi[i]
        lu_solve(M, pivots, u[stage], n)
        for i in range(nq):
            dq[i] += BETA[stage] * g_stage[i]
    for i in range(n):
        y1[i] += u[LAST, i]
    for j in range(n):
        weighted = 0.0
        for stage in range(STAGES):
            weighted += BETA[stage] * u[stage, j]
        for i in range(nq):
            dq[i] += Jq[i, j] * weighted
    for i in range(nq):
        dq[i] *= h


@kernel
def dense_coefficients(u, i):
    """Return the coefficients (c3, c4) of component i in the dense output of a step with stages u."""
    c3 = 0.0
    c4 = 0.0
    for stage in range(DENSE_STAGES):
        c3 += DENSE[0, stage] * u[stage, i]
        c4 += DENSE[1, stage] * u[stage, i]
    return c3, c4


@kernel
def keep(step, phi, h, n, nq, y, y1, q, u, times, dense, quads):
    """Store an accepted step: its end, (y0, y1, c3, c4) of the dense output, and the quadratures."""
    times[step + 1] = phi + h
    for i in range(n):
        dense[step, 0, i] = y[i]
        dense[step, 1, i] = y1[i]
        dense[step, 2, i], dense[step, 3, i] = dense_coefficients(u, i)
    for i in range(nq):
        quads[step, i] = q[i]


@kernel
def integrate(breakpoints, n_breakpoints, y, q, context, rtol, h_start, n_e, times, dense, quads, kept, counts):
    """Integrate y and the quadratures q (both in place) over the breakpoints; return (status, φ reached, next step).

    Fills times[0…steps], dense[step] and quads[step] (see `keep`, `keep_port_states`), and kept[0], the number of steps
    so far, which the slots may read while integrating; adds to counts (TAKEN …).
    """
    n = STATES
    nq = QUADRATURES
    E = np.empty(n_e)
    E_next = np.empty(n_e)
    E_end = np.empty(n_e)
    f = np.empty(n)
    f_phi = np.empty(n)
    g = np.empty(nq)
    g_phi = np.empty(nq)
    g_stage = np.empty(nq)
    dq = np.empty(nq)
    y1 = np.empty(n)
    u = np.empty((STAGES, n))
    J = np.empty((n, n))
    Jq = np.empty((nq, n))
    M = np.empty((n, n))
    pivots = np.empty(n, np.int64)
    h = h_start
    longest = math.inf  # length of a step to where the equations change; later steps go on with h
    phi = breakpoints[0]
    step = 0
    kept[0] = 0
    times[0] = breakpoints[0]
    for segment in range(n_breakpoints - 1):
        phi = breakpoints[segment]
        end = breakpoints[segment + 1]
        middle = 0.5 * (phi + end)
        at_breakpoint(phi, y, context)
        surroundings(end, middle, context, E_end)
        surroundings(phi, middle, context, E)
        fresh = True
        while phi < end:
            left = end - phi
            landing = h >= left * (1.0 - 1e-10)
            trial = left if landing else (0.5 * left if h > 0.5 * left else h)
            if longest < trial:
                landing = False
                trial = longest
            if not (trial > SMALLEST * min(1.0 + phi, AT_FIRST + phi / NO_MORE)):
                return STEP_TOO_SMALL, phi, h
            if fresh:
                delta = min(ANGLE_STEP, 0.1 * trial)
                surroundings(phi + delta, middle, context, E_next)
                jacobian(y, E, E_next, delta, context, f, g, J, Jq, f_phi, g_phi)
                counts[JACOBIANS] += 1
                fresh = False
            if landing and not lands(trial, J, E, E_end, context):
                landing = False
                trial *= 0.5
            attempt(phi, trial, middle, y, context, E_next, f, g, f_phi, g_phi, J, Jq, M, pivots, u, y1, g_stage, dq)
            counts[EVALUATED] += STAGES - 1
            error = error_size(y, y1, u[LAST], context) / rtol
            if not (error <= 1.0):
                counts[REFUSED] += 1
                h = trial * (max(0.15, 0.85 * error**POWER) if error < 1e12 else 0.15)  # NaN, too
                continue
            share = share_in_phase(y, y1, u, rtol, context)
            if share < 1.0:
                counts[REFUSED] += 1
                longest = share * trial
                continue
            longest = math.inf
            if step >= dense.shape[0]:
                return TOO_MANY_STEPS, phi, h
            conserve(y, y1, E, E_next, context, dq)
            for i in range(nq):
                q[i] += dq[i]
            keep(step, phi, trial, n, nq, y, y1, q, u, times, dense, quads)
            keep_port_states(step, dense, context)
            step += 1
            kept[0] = step
            counts[TAKEN] += 1
            factor = min(GROWTH, 0.85 * max(error, 1e-8) ** POWER)
            h = min(LONGEST, max(h, trial * factor) if factor >= GROWTH else trial * factor)
            for i in range(n):
                y[i] = y1[i]
            for i in range(n_e):
                E[i] = E_next[i]
            phi = end if landing else phi + trial
            times[step] = phi
            fresh = True
            if not jump(y, rtol, context):
                return TOO_MANY_JUMPS, phi, h
    return OK, phi, h


@kernel
def dense_value(theta, y0, y1, c3, c4):
    """Return the dense output at the fraction theta of a step."""
    return y0 * (1.0 - theta) + theta * (y1 + (1.0 - theta) * (c3 + theta * c4))


@kernel
def dense_slope(theta, y0, y1, c3, c4):
    """Return the derivative of the dense output by theta."""
    return y1 - y0 + (1.0 - 2.0 * theta) * c3 + (2.0 - 3.0 * theta) * theta * c4
