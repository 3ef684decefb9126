"""Measure what else could integrate a chamber's life: methods of other orders and kinds, another Jacobian.

Run: .venv/bin/python scripts/solver_choices.py [SCENE.yaml]. The scene is closed as usual; then one life among its
closed neighbours, a system of ordinary equations with given surroundings, is integrated again by each method. Counts
are the same everywhere. docs/explanation/numerics.md says what follows.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from screwsim.model import close as closing
from screwsim.model.slots import P_INJECTION
from screwsim.numerics import rodas
from screwsim.numerics.scipy_integrators import integrate
from screwsim.scene import Scene, load, with_values
from screwsim.solution import Solution

ROOT = Path(__file__).resolve().parent.parent
POINT = ROOT / "configs" / "paper" / "point.yaml"
Array = np.ndarray
RTOLS = 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6
ACCURACIES = 3e-4, 1e-6, 1e-8
TARGETS = 1e-3, 1e-4, 1e-5  # errors at which methods are compared
SCIPYS = "scipy-bdf", "scipy-lsoda", "scipy-radau"
KAPPA = 0.03  # of the tolerance: change of a stage at which Newton's iteration ends
MOST_NEWTON = 8
DIFFERENCE = 1e-7  # relative step of differences of the rates
LEAST_VOLUME = 0.01  # of the largest: below it the chamber holds hardly any gas


class Cost(NamedTuple):
    """What a life took: accepted and rejected steps, calls of the rates, Jacobians; its states at knots, its work."""

    steps: int
    rejected: int
    rates: int
    jacobians: int
    y: Array
    work: float

    def evaluations(self) -> int:
        """Return evaluations, a Jacobian counted as one a state as in `numerics.rhs_evaluations`."""
        return self.rates + self.jacobians * self.y.shape[1]


class Life:
    """One closed life as a system of equations: rates, Jacobian and derivative by the angle, from Python."""

    def __init__(self, scene: Scene) -> None:
        self.solution = solution = Solution(scene)
        machinery = self.machinery = solution.machinery
        machinery.warm_up(solution.rehearse)
        self.closed = closed = solution.close()
        times, dense, quads, steps = machinery.last()
        new = machinery.histories[1]  # neighbours behind are read from the turn being integrated: the same one
        new[0][: steps + 1], new[1][:steps], new[2][:steps] = times[: steps + 1], dense[:steps], quads[:steps]
        machinery.kept[0] = steps
        c = machinery.composition
        self.knots, self.y0 = c.knots, closing.chambers_at_pitches(machinery)[: machinery.n]
        self.context, self.module = machinery.context, machinery.module
        self.n, self.nq = machinery.n, machinery.nq
        self.E, self.E_next = np.empty(c.n_E), np.empty(c.n_E)
        self.scale = np.full(self.nq, np.abs(closed.q).max())
        volumes = np.array([self.module.volume_at(phi, c.P, c.TAB) for phi in self.knots[1:]])
        self.told = volumes >= LEAST_VOLUME * volumes.max()

    def at_knot(self, phi: float, y: Array) -> Array:
        """Return the state after what happens at a knot."""
        after = np.ascontiguousarray(y[: self.n])
        P, TAB, R = self.context[:3]
        if abs(phi - P[P_INJECTION]) < 1e-9:
            self.module.chamber_steps__inject(after, 0, P, TAB, R)
        return np.concatenate([after, y[self.n :]])

    def rates(self, phi: float, middle: float, y: Array) -> Array:
        """Return the slopes of states and quadratures."""
        f, g = np.empty(self.n), np.empty(self.nq)
        self.module.chamber__surroundings(phi, middle, self.context, self.E)
        self.module.chamber__rates(np.ascontiguousarray(y), self.E, self.context, f, g)
        return np.concatenate([f, g])

    def derivatives(self, phi: float, middle: float, y: Array) -> tuple[Array, Array, Array]:
        """Return rates, their derivatives by the states (rows of all, columns of states), and those by the angle."""
        n, nq, delta = self.n, self.nq, rodas.ANGLE_STEP
        f, g, f_phi, g_phi = np.empty(n), np.empty(nq), np.empty(n), np.empty(nq)
        J, Jq = np.empty((n, n)), np.empty((nq, n))
        self.module.chamber__surroundings(phi, middle, self.context, self.E)
        self.module.chamber__surroundings(phi + delta, middle, self.context, self.E_next)
        z = np.ascontiguousarray(y)
        self.module.chamber_jacobian__jacobian(z, self.E, self.E_next, delta, self.context, f, g, J, Jq, f_phi, g_phi)
        return np.concatenate([f, g]), np.vstack([J, Jq]), np.concatenate([f_phi, g_phi])

    def differenced(self, phi: float, middle: float, y: Array) -> tuple[Array, Array, Array]:
        """Return what `derivatives` does, by differences of the rates alone."""
        base, n = self.rates(phi, middle, y), self.n
        columns = []
        for i in range(n):
            moved = y.copy()
            moved[i] += DIFFERENCE * abs(y[i])
            columns.append((self.rates(phi, middle, moved) - base) / (moved[i] - y[i]))
        return base, np.array(columns).T, (self.rates(phi + rodas.ANGLE_STEP, middle, y) - base) / rodas.ANGLE_STEP

    def error(self, found: Cost, exact: Cost) -> float:
        """Return the largest error of work, and of the gas at knots where the chamber is not all but closed."""
        states = np.abs(found.y[self.told, :2] / exact.y[self.told, :2] - 1.0).max()
        return max(abs(found.work / exact.work - 1.0), float(states))


class Rosenbrock(NamedTuple):
    """Coefficients in the form of `numerics.rodas`; `fresh` tells which stages need rates of their own."""

    name: str
    gamma: float
    A: Array
    C: Array
    nodes: Array
    D: Array
    weights: Array
    error: Array
    fresh: Sequence[bool]
    order: int  # of the error estimate, plus one


RODAS4 = Rosenbrock(
    "Rodas4 (kept)",
    rodas.GAMMA,
    np.hstack([rodas.A, np.zeros((6, 1))]),
    np.hstack([rodas.C, np.zeros((6, 1))]),
    rodas.NODES,
    rodas.D,
    np.append(rodas.A[5], 1.0),
    np.array((0.0, 0.0, 0.0, 0.0, 0.0, 1.0)),
    (False, True, True, True, True, True),
    4,
)
# E. Hairer, G. Wanner, Solving ODEs II, and A. Sandu et al., Atmos. Environ. 31 (1997) 3459: order 3(2), four stages
RODAS3 = Rosenbrock(
    "Rodas3",
    0.5,
    np.array(((0.0, 0, 0, 0), (0, 0, 0, 0), (2, 0, 0, 0), (2, 0, 1, 0))),
    np.array(((0.0, 0, 0, 0), (4, 0, 0, 0), (1, -1, 0, 0), (1, -1, -8 / 3, 0))),
    np.array((0.0, 0.0, 1.0, 1.0)),
    np.array((0.5, 1.5, 0.0, 0.0)),
    np.array((2.0, 0.0, 1.0, 1.0)),
    np.array((0.0, 0.0, 0.0, 1.0)),
    (False, False, True, True),
    3,
)
# C. A. Kennedy, M. H. Carpenter, Appl. Numer. Math. 44 (2003) 139, the implicit part of ARK4(3)6L[2]SA
ESDIRK = np.array(
    (
        (0.0, 0, 0, 0, 0, 0),
        (1 / 4, 1 / 4, 0, 0, 0, 0),
        (8611 / 62500, -1743 / 31250, 1 / 4, 0, 0, 0),
        (5012029 / 34652500, -654441 / 2922500, 174375 / 388108, 1 / 4, 0, 0),
        (15267082809 / 155376265600, -71443401 / 120774400, 730878875 / 902184768, 2285395 / 8070912, 1 / 4, 0),
        (82889 / 524892, 0, 15625 / 83664, 69875 / 102672, -2260 / 8211, 1 / 4),
    )
)
EMBEDDED = np.array(
    (4586570599 / 29645900160, 0, 178811875 / 945068544, 814220225 / 1159782912, -3700637 / 11593932, 61727 / 225920)
)

Step = Callable[[Life, float, float, float, Array, tuple], tuple[Array, Array, int]]


def rosenbrock(method: Rosenbrock) -> Step:
    """Return one step of a Rosenbrock method: (end, error, calls of the rates)."""

    def step(life: Life, phi: float, h: float, middle: float, z: Array, known: tuple) -> tuple[Array, Array, int]:
        (f, J, f_phi), n, calls = known, life.n, 0
        shift = 1.0 / (method.gamma * h)
        matrix = shift * np.eye(n) - J[:n]
        u = np.zeros((len(method.nodes), len(z)))
        slopes = f
        for i in range(len(u)):
            if method.fresh[i]:
                slopes, calls = life.rates(phi + method.nodes[i] * h, middle, (z + method.A[i] @ u)[:n]), calls + 1
            right = slopes + method.C[i] @ u / h + h * method.D[i] * f_phi
            u[i, :n] = np.linalg.solve(matrix, right[:n])
            u[i, n:] = (right[n:] + J[n:] @ u[i, :n]) / shift
        return z + method.weights @ u, method.error @ u, calls

    return step


def esdirk(rtol: float) -> Step:
    """Return one step of the ESDIRK method, its stages by Newton's iteration with one matrix."""

    def step(life: Life, phi: float, h: float, middle: float, z: Array, known: tuple) -> tuple[Array, Array, int]:
        (f, J, _), n, calls = known, life.n, 0
        matrix = np.eye(n) - 0.25 * h * J[:n]
        k = np.zeros((6, len(z)))
        k[0] = f
        for i in range(1, 6):
            base, nodes = z[:n] + h * ESDIRK[i, :i] @ k[:i, :n], ESDIRK[i].sum()
            y = base + 0.25 * h * k[i - 1, :n]
            for _ in range(MOST_NEWTON):
                k[i], calls = life.rates(phi + nodes * h, middle, y), calls + 1
                change = np.linalg.solve(matrix, base + 0.25 * h * k[i, :n] - y)
                y = y + change
                if not np.all(np.isfinite(y)) or np.any(y <= 0.0):
                    return z, np.full(len(z), np.inf), calls
                if np.max(np.abs(change / y)) <= KAPPA * rtol:
                    break
            else:
                return z, np.full(len(z), np.inf), calls
            k[i, :n] = (y - base) / (0.25 * h)
        return z + h * ESDIRK[5] @ k, h * (ESDIRK[5] - EMBEDDED) @ k, calls

    return step


def integrated(life: Life, step: Step, order: int, rtol: float, exact: bool = True) -> Cost:
    """Return a life by one method, with the step control of `numerics.rodas`; `exact` is its Jacobian."""
    derivatives = life.derivatives if exact else life.differenced
    n, z = life.n, np.concatenate([life.y0, np.zeros(life.nq)])
    steps = rejected = calls = jacobians = 0
    h, seen = 1e-3, []
    for start, end in pairwise(life.knots):
        phi, middle, known = start, 0.5 * (start + end), None
        z = life.at_knot(start, z)
        while phi < end:
            if known is None:
                known, jacobians = derivatives(phi, middle, z[:n]), jacobians + 1
            left = end - phi
            trial = left if h >= left * (1.0 - 1e-10) else (0.5 * left if h > 0.5 * left else h)
            after, off, more = step(life, phi, trial, middle, z, known)
            calls += more
            size = np.max(np.abs(off[:n]) / np.maximum(np.abs(z[:n]), np.abs(after[:n]))) / rtol
            if np.any(after[:n] <= 0.0) or not size <= 1.0:
                rejected += 1
                h = trial * (max(0.15, 0.85 * size ** (-1.0 / order)) if size < 1e12 else 0.15)
                continue
            grown = min(rodas.GROWTH, 0.85 * max(size, 1e-8) ** (-1.0 / order))
            h = min(rodas.LONGEST, max(h, trial * grown) if grown >= rodas.GROWTH else trial * grown)
            phi, z, known, steps = (end if trial == left else phi + trial), after, None, steps + 1
        seen.append(z[:n])
    return Cost(steps, rejected, calls, jacobians, np.array(seen), z[n])


def by_scipy(life: Life, method: str, rtol: float) -> Cost:
    """Return a life by one of scipy's methods."""
    y, q, counts, seen = life.y0.copy(), np.zeros(life.nq), np.zeros(3, int), []
    for segment in pairwise(life.knots):
        y, more, path = integrate(
            life.rates,
            lambda *at: life.derivatives(*at)[1],
            np.array(segment),
            life.at_knot(segment[0], y),
            life.scale,
            rtol,
            method,
        )
        q, counts = q + more, counts + np.array([len(path.dense), path.calls, path.jacobians])
        seen.append(y)
    return Cost(int(counts[0]), 0, int(counts[1]), int(counts[2]), np.array(seen), q[0])


def methods_table(scene: Scene) -> None:
    """Print what methods take to an error, one life among closed neighbours."""
    life = Life(scene)
    exact = by_scipy(life, "scipy-radau", 1e-10)
    print("\nEvaluations of the right-hand side in one life, at an error of work and gas (Jacobian: one a state)")
    print(f"{'method':>20} {'steps at 1e-4':>14} {'rejected':>9} " + " ".join(f"{each:>8.0e}" for each in TARGETS))
    for name in (RODAS4.name, RODAS3.name, "ESDIRK 4(3)6L[2]SA", *SCIPYS):
        found = []
        for rtol in RTOLS:
            if name in SCIPYS:
                cost = by_scipy(life, name, rtol)
            elif name.startswith("ESDIRK"):
                cost = integrated(life, esdirk(rtol), 4, rtol)
            else:
                method = RODAS3 if name == RODAS3.name else RODAS4
                cost = integrated(life, rosenbrock(method), method.order, rtol)
            found.append((cost, life.error(cost, exact)))
        at = found[RTOLS.index(1e-4)][0]
        cells = " ".join(f"{least(found, target):>8}" for target in TARGETS)
        print(f"{name:>20} {at.steps:>14} {at.rejected:>9} {cells}")


def jacobian_table(scene: Scene) -> None:
    """Print the steps of a life with the Jacobian as it is and by differences, over the accuracy."""
    print(f"\nSteps of a life with the Jacobian as it is, and by differences of the rates ({DIFFERENCE:g} of a state)")
    print(f"{'accuracy':>9} {'as it is':>9} {'differences':>12}")
    for accuracy in ACCURACIES:
        life = Life(with_values(scene, {"numerics.accuracy": accuracy}))
        both = [integrated(life, rosenbrock(RODAS4), 4, 0.3 * accuracy, exact).steps for exact in (True, False)]
        print(f"{accuracy:>9.0e} {both[0]:>9} {both[1]:>12}")


def least(found: list[tuple[Cost, float]], target: float) -> str:
    """Return the evaluations at an error, between the tolerances tried (logarithms); a dash outside them."""
    errors = np.minimum.accumulate([max(error, 1e-16) for _, error in found])
    counts = [cost.evaluations() for cost, _ in found]
    if not errors[-1] <= target:
        return "-"
    if errors[0] <= target:
        return f"<{counts[0]}"
    i = int(np.argmax(errors <= target))
    share = math.log(errors[i - 1] / target) / math.log(errors[i - 1] / errors[i])
    return f"{counts[i - 1] * (counts[i] / counts[i - 1]) ** share:.0f}"


def main() -> None:
    """Print all tables."""
    scene = load(sys.argv[1] if len(sys.argv) > 1 else str(POINT))
    methods_table(scene)
    jacobian_table(scene)


if __name__ == "__main__":
    main()
