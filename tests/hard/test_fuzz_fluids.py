"""Random scenes of blends, of fluids at their dew line and of a gas cooler: none crashes, or is wrong and called ok."""

import json

import fluid_space
import fuzz
import numpy as np
import pytest
from hard_page import OF_FLUIDS
from scenes import make

from screwsim.inputs.faults import SceneError
from screwsim.simulate import simulate

SEED = 4  # of the draws here, the first of each structure; those of the stored outcome are of seed 1
LEAST_OK = 1.0 / 3.0


def test_what_random_fluids_make_is_finite_and_closes_where_it_is_ok():
    seen = []
    first: dict[str, list[float]] = {}
    for index in range(60):
        structure, shares = fluid_space.drawn(SEED, index)
        first.setdefault(structure, shares)
    assert set(first) == set(fluid_space.STRUCTURES)
    for structure, shares in first.items():
        try:
            result = simulate(make(fluid_space.changes(structure, shares)))
        except SceneError:
            seen.append("refused")
            continue
        seen.append(result.status)
        for table in (result.performance, result.balance, result.error, result.numerics):
            assert all(np.isfinite(value) for value in table.values() if isinstance(value, float))
        if result.status == "ok":
            assert max(result.balance.mass, result.balance.energy, result.balance.entropy) <= result.balance.bound
            assert all(np.all(result.cycle[name] > 0.0) for name in ("pressure", "gas_temperature", "gas_mass"))
        else:
            assert result.message
    assert seen.count("ok") >= LEAST_OK * len(first)


def test_every_structure_is_drawn():
    assert {fluid_space.drawn(1, index)[0] for index in range(60)} == set(fluid_space.STRUCTURES)


@pytest.mark.parametrize("status", ["crashed", "hung", "not finite"])
def test_the_stored_outcome_is_of_this_space_and_none_of_it_is_bad(status):
    made = json.loads(OF_FLUIDS.read_text(encoding="utf-8"))
    assert made["space"] == fuzz.space("fluid_space")
    assert set(made["structure"]) == set(fluid_space.STRUCTURES)
    assert made["scenes"] >= 600 and status not in made["status"]
    assert made["radau"]["compared"] >= 10 and made["radau"]["beyond_three_times_unwarned"] == []
    assert made["worst_balance_over_accuracy"]["value"] <= 1.0
    assert made["unexplained"] == []  # every scene that fails is told by a limit of its gas, and with its remedy
