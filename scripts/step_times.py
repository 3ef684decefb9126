"""Measure the parts of a step of one chamber, and what unrolled systems, a faster nozzle or points in lanes would save.

Run: .venv/bin/python scripts/step_times.py [SCENE.yaml]. Times are the least of several on one core of this machine.
docs/explanation/numerics.md says what follows.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from collections.abc import Callable

import numba
import numpy as np
from solver_choices import POINT, Array, Life

from screwsim.fluid import nozzle
from screwsim.scene import Scene, load, with_values
from screwsim.solution import Solution

LANES = 8  # doubles of a 512-bit register
LONG = 1025  # points of a row
MOMENTS = 100  # of a life, at which parts of a step are timed
REPEATS, MANY = 15, 20_000
SWEEPS = (
    ("speed 2800 to 3200 rpm", "operation.speed", np.linspace(2800.0, 3200.0, LANES) * math.pi / 30.0),
    ("speed 2000 to 4000 rpm", "operation.speed", np.linspace(2000.0, 4000.0, LANES) * math.pi / 30.0),
    ("oil ratio 1 to 3", "oil_supply.ratio", np.linspace(1.0, 3.0, LANES)),
)


def nanoseconds(work: Callable[[int], object], times: int) -> float:
    """Return the time [ns] of one of `times` repetitions inside `work`: the least of several."""
    work(1)
    found = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        work(times)
        found.append((time.perf_counter() - started) / times)
    return 1e9 * min(found)


@numba.njit
def unrolled(M, b):
    """Solve a system of three in place, no pivoting, all written out."""
    f1, f2 = M[1, 0] / M[0, 0], M[2, 0] / M[0, 0]
    m11, m12 = M[1, 1] - f1 * M[0, 1], M[1, 2] - f1 * M[0, 2]
    m21, m22 = M[2, 1] - f2 * M[0, 1], M[2, 2] - f2 * M[0, 2]
    f3, b1 = m21 / m11, b[1] - f1 * b[0]
    b[2] = (b[2] - f2 * b[0] - f3 * b1) / (m22 - f3 * m12)
    b[1] = (b1 - m12 * b[2]) / m11
    b[0] = (b[0] - M[0, 1] * b[1] - M[0, 2] * b[2]) / M[0, 0]


def polynomial(k: float, degree: int = 13) -> Array:
    """Return the coefficients in x/choke of a polynomial for ψ²/x of one k, up to choking."""
    choke, choked = nozzle.choking(k)
    s = 0.5 + 0.5 * np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    values = [nozzle.expansion(min(x, choke * (1.0 - 1e-15)), 1.0 / k, choke, choked) for x in s * choke]
    return np.polynomial.Chebyshev.fit(s, values, degree, domain=(0.0, 1.0)).convert(kind=np.polynomial.Polynomial).coef


@numba.njit
def one_flow(area, p_1, rho_1, p_2, rho_2, choke, choked, width, c):
    """Return what `nozzle.flow` does for one k by the polynomial, without a branch."""
    dp = p_2 - p_1
    p_u = max(p_1, p_2)
    rho = rho_2 if dp >= 0.0 else rho_1
    x = abs(dp) / p_u
    s = min(x / choke, 1.0)
    value = c[13]
    for i in range(12, -1, -1):
        value = value * s + c[i]
    value = choked / x if x >= choke else value
    return area * dp * math.sqrt(rho * value / math.sqrt(dp * dp + width * width))


@numba.njit
def one_by_one(times, p, rho, choke, choked, c, out):
    """Call the polynomial's flow as a chamber calls its own: each for itself, none waits for another's result."""
    total = 0.0
    for i in range(times):
        j = i % (len(p) - 1)
        total += one_flow(1.0, p[j], rho[j], p[j + 1], rho[j + 1], choke, choked, 10.0, c)
    out[0] = total


@numba.njit(error_model="numpy")
def side_by_side(times, p, rho, choke, choked, c, out):
    """Call the polynomial's flow for all points of a row: the compiler takes as many at once as registers hold."""
    n = len(p) - 1
    for _ in range(max(times // n, 1)):
        for j in range(n):
            out[j] = one_flow(1.0, p[j], rho[j], p[j + 1], rho[j + 1], choke, choked, 10.0, c)


def timers(life: Life) -> dict[str, Callable[[int], object]]:
    """Return what is timed: the parts of a step, as compiled for the scene."""
    module, n, nq, context = life.module, life.n, life.nq, life.context
    around, rate, derive = module.chamber__surroundings, module.chamber__rates, module.chamber_jacobian__jacobian
    factor, solve, flow = module.linear__lu_factor, module.linear__lu_solve, module.nozzle__flow
    times, dense, _, steps = life.machinery.last()
    chosen = np.linspace(0, steps - 1, MOMENTS).astype(int)
    angles, Y = times[chosen] + 1e-9, dense[chosen, 0, :n].copy()
    middles = 0.5 * (times[chosen] + times[chosen + 1])
    E, E_next = (np.empty((MOMENTS, len(life.E))) for _ in range(2))
    for i in range(MOMENTS):
        for delta, table in ((0.0, E), (1e-6, E_next)):
            around(angles[i] + delta, middles[i], context, table[i])
    f, g, f_phi, g_phi = np.empty(n), np.empty(nq), np.empty(n), np.empty(nq)
    J, Jq, matrix, pivots = np.empty((n, n)), np.empty((nq, n)), np.empty((n, n)), np.zeros(n, np.int64)
    out = np.empty(LONG)
    random = np.random.default_rng(1)
    p, rho = 1e5 * random.uniform(1.0, 4.0, LONG), random.uniform(5.0, 20.0, LONG)
    k = 1.1
    choke, choked = nozzle.choking(k)
    c = polynomial(k)

    @numba.njit
    def surroundings(times, angles, middles, E, context):
        for i in range(times):
            j = i % len(angles)
            around(angles[j], middles[j], context, E[j])

    @numba.njit
    def rates(times, Y, E, f, g, context):
        for i in range(times):
            j = i % len(Y)
            rate(Y[j], E[j], context, f, g)

    @numba.njit
    def jacobian(times, Y, E, E_next, f, g, J, Jq, f_phi, g_phi, context):
        for i in range(times):
            j = i % len(Y)
            derive(Y[j], E[j], E_next[j], 1e-6, context, f, g, J, Jq, f_phi, g_phi)

    @numba.njit
    def systems(times, matrix, pivots, f):
        for _ in range(times):
            for i in range(len(f)):
                f[i] = 1.0
                for j in range(len(f)):
                    matrix[i, j] = (2.0 if i == j else 0.0) + 0.1 * (i + j)
            factor(matrix, pivots, len(f))
            for _ in range(6):
                solve(matrix, pivots, f, len(f))

    @numba.njit
    def written_out(times, matrix, f):
        for _ in range(times):
            for i in range(len(f)):
                f[i] = 1.0
                for j in range(len(f)):
                    matrix[i, j] = (2.0 if i == j else 0.0) + 0.1 * (i + j)
            for _ in range(6):
                unrolled(matrix, f)

    @numba.njit
    def flows(times, p, rho, out):
        total = 0.0
        for i in range(times):
            j = i % (len(p) - 1)
            total += flow(1.0, p[j], rho[j], 1 / k, choke, choked, p[j + 1], rho[j + 1], 1 / k, choke, choked, 10.0)
        out[0] = total

    def turn(times):
        for _ in range(times):
            life.machinery.turn(life.y0.copy(), life.closed.rtol, 1e-3)

    return {
        "turn": turn,
        "surroundings": lambda times: surroundings(times, angles, middles, E, context),
        "rates": lambda times: rates(times, Y, E, f, g, context),
        "Jacobian": lambda times: jacobian(times, Y, E, E_next, f, g, J, Jq, f_phi, g_phi, context),
        "systems": lambda times: systems(times, matrix, pivots, f),
        "systems, written out": lambda times: written_out(times, matrix, f),
        "nozzle flow": lambda times: flows(times, p, rho, out),
        "by a polynomial": lambda times: one_by_one(times, p, rho, choke, choked, c, out),
        "side by side": lambda times: side_by_side(times, p, rho, choke, choked, c, out),
    }


def counted(life: Life, work: Callable[[int], object]) -> list[int]:
    """Return steps, rejected ones, evaluations and Jacobians of one run of some work."""
    before = life.machinery.counts.copy()
    work(1)
    return [int(each) for each in life.machinery.counts - before]


def parts_table(scene: Scene) -> float:
    """Print what a step is made of, and what unrolled systems or a faster nozzle could save; return its share."""
    life = Life(scene)
    work = timers(life)
    counts = counted(life, work["turn"])
    tries = counts[0] + counts[1]
    step = nanoseconds(work.pop("turn"), 20) / tries
    took = {name: nanoseconds(each, MANY) for name, each in work.items()}
    _, through = life.machinery.sample(np.linspace(0.0, float(life.knots[-1]), LONG))
    paths = float(np.count_nonzero(through, axis=1).mean())
    print(f"\nA step that is tried takes {step:.0f} ns: its parts, and what stands for them")
    per_step = {
        "surroundings": (5 + counts[3] / tries, took["surroundings"]),
        "rates": (5, took["rates"]),
        "Jacobian": (counts[3] / tries, took["Jacobian"]),
        "systems": (1, took["systems"]),
        "nozzle flow": (6 * paths, took["nozzle flow"]),  # part of rates and Jacobian
    }
    print(f"{'part':>22} {'ns a call':>10} {'calls a step':>13} {'share':>7}")
    for name, (calls, ns) in per_step.items():
        print(f"{name:>22} {ns:>10.1f} {calls:>13.2f} {calls * ns / step:>7.0%}")
    for name in ("systems, written out", "by a polynomial", "side by side"):
        print(f"{name:>22} {took[name]:>10.1f}")
    saved = (took["systems"] - took["systems, written out"]) / step
    print(f"systems written out would save {saved:.1%} of a step")
    flows = 6 * paths * took["nozzle flow"] / step
    print(f"a polynomial for one k would save {flows * (1 - took['by a polynomial'] / took['nozzle flow']):.1%}")
    return flows * (1.0 - took["side by side"] / took["nozzle flow"])


def lanes_table(scene: Scene, saved: float) -> None:
    """Print what points side by side cost in steps: all take the shortest that one of them needs."""
    print(
        f"\n{LANES} points of a sweep side by side: steps over those of each alone, turns of the slowest over the mean"
    )
    print(f"{'sweep':>30} {'steps':>7} {'turns':>7} {'time of a sweep, flows side by side':>36}")
    for name, path, values in SWEEPS:
        density, turns = [], []
        grid = np.linspace(0.0, 4.0 * math.pi, 4000, endpoint=False)
        for value in values:
            solution = Solution(with_values(scene, {path: value}))
            solution.machinery.warm_up(solution.rehearse)
            turns.append(solution.close().turns)
            times, _, _, steps = solution.machinery.last()
            at = np.searchsorted(times[: steps + 1], grid, side="right") - 1
            density.append(1.0 / np.diff(times[: steps + 1])[np.clip(at, 0, steps - 1)])
        rows = np.array(density)
        steps, slowest = rows.max(axis=0).mean() / rows.mean(), max(turns) / statistics.mean(turns)
        print(f"{name:>30} {steps:>7.2f} {slowest:>7.2f} {steps * slowest * (1.0 - saved):>36.2f}")


if __name__ == "__main__":
    asked = load(sys.argv[1] if len(sys.argv) > 1 else str(POINT))
    lanes_table(asked, parts_table(asked))
