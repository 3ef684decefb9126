"""Laws of the ways to one point: alone or in a row, in lanes, in threads, closed otherwise, at another accuracy.

`relations.py` asks them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
from relating import Case, Pair, believed_twin, law, twin

from screwsim.batch import simulate_courses
from screwsim.outputs import Result
from screwsim.scene import Scene, with_values
from screwsim.simulate import simulate, simulate_many

SOME = 2  # other ways, other accuracies
ACCURACIES = 1e-3, 3e-4, 1e-4, 1e-5
FAR_AWAY = {"operation.speed": (0.3, 3.0), "oil_supply.ratio": (0.1, 10.0)}


def different(one: Result, other: Result) -> float:
    """Return infinity where a figure of two results differs in any bit, otherwise 0."""
    return 0.0 if dict(one.performance) == dict(other.performance) else math.inf


@law
def another_way(case: Case) -> Iterator[Pair]:
    """A point alone, in a row behind a far one, in lanes, closed otherwise: the same figures."""
    here, scene = case.result, case.scene
    far, near = _far(case), with_values(scene, {"operation.speed": 1.02 * scene.operation.speed})
    how = "coupled" if scene.numerics.closing != "coupled" else "auto"
    closed = replace(scene, numerics=replace(scene.numerics, closing=how))
    ways: dict[str, Callable[[], Result]] = {
        "behind a far point": lambda: _last([far, scene]),
        "behind a near point": lambda: _last([near, scene]),
        "in lanes": lambda: simulate_courses([[scene], [near], [far]])[0][0],
        f"closed {how}": lambda: simulate(closed, trace=False),
    }
    for way in map(str, case.random.permutation(list(ways))[:SOME]):
        yield Pair(way, here, believed_twin(ways[way](), scene))


def _last(row: list[Scene]) -> Result:
    return list(simulate_many(row, trace=False))[-1]


def _far(case: Case) -> Scene:
    values = {}
    for path, ends in FAR_AWAY.items():
        value = case.value(path)
        if isinstance(value, float) and value:
            values[path] = value * math.exp(case.random.uniform(*np.log(ends)))
    return with_values(case.scene, values)


@law
def in_threads(case: Case) -> Iterator[Pair]:
    """Threads beside each other, and a run after others, give the same bits."""
    case.believe()
    alone = twin(case.scene)
    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(lambda scene: simulate(scene, trace=False), [case.scene, _far(case)]))
    for each in (found[0], twin(case.scene)):
        yield Pair("bits in threads and after others", alone, each, broken=different(alone, each))


@law
def another_accuracy(case: Case) -> Iterator[Pair]:
    """Each accuracy gives the figures of the others, within the errors that both tell."""
    here, wanted = case.result, case.scene.numerics.accuracy
    for accuracy in map(float, case.random.permutation(ACCURACIES)[:SOME]):
        if accuracy != wanted:
            scene = replace(case.scene, numerics=replace(case.scene.numerics, accuracy=accuracy))
            yield Pair(f"accuracy {accuracy}, not {wanted}", here, believed_twin(simulate(scene, trace=False), scene))
