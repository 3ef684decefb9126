"""Print the parts of a step of one chamber, and the time of each.

Run: python benchmarks/step_times.py [SCENE.yaml]. The scene is closed as usual; parts are timed at states of its last
life, as the minimum of several runs, on one core of this computer. docs/explanation/tried.md has the conclusions.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from screwsim.codegen.modules import for_speed
from screwsim.codegen.modules import load as compiled
from screwsim.cycle.close import close
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import ClosingTask, problem_of
from screwsim.cycle.simultaneous import chambers_at_pitches
from screwsim.fluid import nozzle
from screwsim.model.run import Machinery
from screwsim.numerics.rodas import ANGLE_STEP, JACOBIANS, REFUSED, TAKEN
from screwsim.scene import Scene, load

POINT = Path(__file__).resolve().parent.parent / "configs" / "paper" / "point.yaml"
MOMENTS = 100  # points of a life at which parts of a step are timed
REPEATS, MANY = 15, 20_000
STAGES = 5  # stages with their own rates
SOLVES = 6  # with the factors of one step
LOOPS = """
def many_surroundings(times, angles, middles, E, context):
    for i in range(times):
        j = i % len(angles)
        chamber__surroundings(angles[j], middles[j], context, E[j])


def many_rates(times, Y, E, f, g, context):
    for i in range(times):
        j = i % len(Y)
        chamber__rates(Y[j], E[j], context, f, g)


def many_jacobians(times, Y, E, E_next, step, f, g, J, Jq, f_phi, g_phi, context):
    for i in range(times):
        j = i % len(Y)
        chamber__jacobian(Y[j], E[j], E_next[j], step, context, f, g, J, Jq, f_phi, g_phi)


def many_systems(times, matrix, pivots, f, solves):
    for k in range(times):
        for i in range(len(f)):
            f[i] = 1.0
            for j in range(len(f)):
                matrix[i, j] = (2.0 if i == j else 0.0) + 0.1 * (i + j)
        linear__lu_factor(matrix, pivots, len(f))
        for k in range(solves):
            linear__lu_solve(matrix, pivots, f, len(f))


def many_flows(times, p, rho, choke, choked):
    total, a = 0.0, 1.0 / 1.1
    for i in range(times):
        j = i % (len(p) - 1)
        total += nozzle__flow(1.0, p[j], rho[j], a, choke, choked, p[j + 1], rho[j + 1], a, choke, choked, 10.0)
    return total
"""


def nanoseconds(work: Callable[[int], object], times: int) -> float:
    """Return the time [ns] of one of `times` repetitions inside `work`: the minimum of several runs."""
    work(1)
    found = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        work(times)
        found.append((time.perf_counter() - started) / times)
    return 1e9 * min(found)


def closed(scene: Scene) -> tuple[Machinery, Callable[[int], None]]:
    """Return the machinery of a closed scene, and a function that repeats turns of its life among closed neighbours."""
    problem = problem_of(scene)
    machinery = lease_for(problem)
    rtol = close(ClosingTask(problem, machinery, problem.criteria)).rtol
    times, dense, quads, steps = machinery.lives.last()
    new = machinery.lives.histories[1]  # neighbours behind are read from the turn being integrated, the same one
    new[0][: steps + 1], new[1][:steps], new[2][:steps] = times[: steps + 1], dense[:steps], quads[:steps]
    machinery.lives.kept[0] = steps
    start = chambers_at_pitches(machinery)[: machinery.n]

    def turns(times: int) -> None:
        for _ in range(times):
            machinery.turn(start.copy(), rtol)

    return machinery, turns


def timers(machinery: Machinery) -> dict[str, Callable[[int], object]]:
    """Return the timed functions: the parts of a step, as compiled for the scene."""
    module = compiled(machinery.composition.text + LOOPS, "step_times")
    n, nq, context = machinery.n, machinery.nq, machinery.context
    at, dense, _, steps = machinery.lives.last()
    chosen = np.linspace(0, steps - 1, MOMENTS).astype(int)
    angles, Y = at[chosen] + 1e-9, dense[chosen, 0, :n].copy()
    middles = 0.5 * (at[chosen] + at[chosen + 1])
    E, E_next = (np.empty((MOMENTS, machinery.composition.n_E)) for _ in range(2))
    for i in range(MOMENTS):
        module.chamber__surroundings(angles[i], middles[i], context, E[i])
        module.chamber__surroundings(angles[i] + ANGLE_STEP, middles[i], context, E_next[i])
    f, g, f_phi, g_phi = np.empty(n), np.empty(nq), np.empty(n), np.empty(nq)
    J, Jq, matrix, pivots = np.empty((n, n)), np.empty((nq, n)), np.empty((n, n)), np.zeros(n, np.int64)
    random = np.random.default_rng(1)
    p, rho = 1e5 * random.uniform(1.0, 4.0, 1025), random.uniform(5.0, 20.0, 1025)
    choke, choked = nozzle.choking(1.1)

    return {
        "surroundings": lambda times: module.many_surroundings(times, angles, middles, E, context),
        "rates": lambda times: module.many_rates(times, Y, E, f, g, context),
        "Jacobian": lambda times: module.many_jacobians(
            times, Y, E, E_next, ANGLE_STEP, f, g, J, Jq, f_phi, g_phi, context
        ),
        "systems": lambda times: module.many_systems(times, matrix, pivots, f, SOLVES),
        "nozzle flow": lambda times: module.many_flows(times, p, rho, choke, choked),
    }


@for_speed()
def main() -> None:
    """Print the parts of a step; the nozzle flow among them is contained in rates and Jacobian."""
    machinery, turns = closed(load(sys.argv[1] if len(sys.argv) > 1 else str(POINT)))
    work = timers(machinery)
    before = machinery.counts.copy()
    turns(1)
    counts = machinery.counts - before
    tries = int(counts[TAKEN] + counts[REFUSED])
    step, jacobians = nanoseconds(turns, 20) / tries, counts[JACOBIANS] / tries
    _, through = machinery.trajectory.sample(np.linspace(0.0, float(machinery.composition.breakpoints[-1]), 1025))
    paths = float(np.count_nonzero(through, axis=1).mean())
    calls = {
        "surroundings": STAGES + jacobians,
        "rates": STAGES,
        "Jacobian": jacobians,
        "systems": 1,
        "nozzle flow": SOLVES * paths,
    }
    print(f"A step that is tried takes {step:.0f} ns")
    print(f"{'part':>14} {'ns a call':>10} {'calls a step':>13} {'share':>7}")
    for name, each in work.items():
        ns = nanoseconds(each, MANY)
        print(f"{name:>14} {ns:>10.1f} {calls[name]:>13.2f} {calls[name] * ns / step:>7.0%}")


if __name__ == "__main__":
    main()
