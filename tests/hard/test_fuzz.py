"""Random scenes of the whole space: none crashes, hangs or gives what is no number; most are ok."""

from collections import Counter

import numpy as np
import pytest
from fuzz_space import RANGES, STRUCTURES, changes, drawn, is_real
from scenes import balanced, make

from screwsim.inputs.faults import SceneError
from screwsim.simulate import simulate

SCENES = {  # a sample of each structure; tests/hard/fuzz_outcome.json holds what became of 20 000
    "paper": 26,
    "carried": 15,
    "ports alone": 72,
    "displacement": 8,
    "dry, some leaks": 30,
    "oil, other leaks": 20,
    "real": 20,
    "two phases": 12,
}
LEAST_OK = 0.6  # share of the scenes of an ideal gas
LEAST_OK_REAL = 0.15  # of a real one: most corners lie outside its equation
MOST = 80_000_000  # a closing takes 10 and further tries 8, what the last pitch overruns apart; three closings at most
# seeds of the draws: of each structure one whose scenes close soon, and one that was not chosen
SOON = dict.fromkeys(SCENES, 4) | {"paper": 3, "ports alone": 10, "real": 3}
ANY = dict.fromkeys(SCENES, 2)
EDGES = 0.15  # share of the numbers that are an end of their range


def corners(seed: int, number: int, index: int) -> list[float]:
    """Return the shares of one scene of a structure: anywhere in the space, some at its ends."""
    random = np.random.default_rng((seed, number, index))
    shares, at_end = random.random(len(RANGES)), random.random(len(RANGES)) < EDGES
    return np.where(at_end, random.integers(0, 2, len(RANGES)), shares).tolist()


def test_every_structure_is_drawn_and_many_scenes_together():
    assert set(SCENES) == set(STRUCTURES)
    assert sum(SCENES.values()) >= 200


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [SOON, pytest.param(ANY, marks=pytest.mark.around)], ids=["soon", "any"])
@pytest.mark.parametrize("structure", STRUCTURES)
def test_random_scenes(structure, seeds):
    seen: Counter[str] = Counter()
    for index in range(SCENES[structure]):
        try:
            scene = make(changes(structure, corners(seeds[structure], list(STRUCTURES).index(structure), index)))
        except SceneError:
            seen["refused"] += 1
            continue
        result = simulate(scene)
        seen[result.status] += 1
        tables = (result.performance, result.balance, result.error, result.ledger, result.numerics)
        values = [value for table in tables for value in table.values() if isinstance(value, float)]
        assert np.all(np.isfinite(values))
        assert all(np.all(np.isfinite(trace)) for name, trace in result.cycle.items() if name != "oil_temperature")
        if result.status == "ok":
            assert all(np.all(result.cycle[name] > 0.0) for name in ("pressure", "gas_temperature", "gas_mass"))
            assert max(result.balance.mass, result.balance.energy) <= result.balance.bound
        assert result.numerics.rhs_evaluations <= MOST

    assert seen["ok"] >= (LEAST_OK_REAL if is_real(structure) else LEAST_OK) * seen.total(), seen


def test_a_machine_that_moves_much_and_works_little_closes():
    """At 12 rpm and a pressure ratio of 1.002: half a watt at the shaft, 86 W of enthalpy to and fro."""
    result = balanced(simulate(make(changes(*drawn(1, 9554)))))
    assert result.performance.shaft_power < 1.0
