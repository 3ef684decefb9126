"""Random scenes of the whole space: none crashes, hangs or gives what is no number; most are ok."""

from collections import Counter

import numpy as np
import pytest
from fuzz_space import RANGES, STRUCTURES, changes
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from scenes import make

from screwsim.simulate import simulate

SCENES = {"paper": 160, "carried": 60, "ports alone": 300}
LEAST_OK = 0.6  # share of the scenes
MOST = 80_000_000  # a closing takes 10 and further tries 8, what the last pitch overruns apart; three closings at most
SHARES = st.lists(st.floats(0.0, 1.0, allow_nan=False, width=32), min_size=len(RANGES), max_size=len(RANGES))


def test_enough_scenes():
    assert sum(SCENES.values()) >= 500


@pytest.mark.slow
@pytest.mark.parametrize("structure", STRUCTURES)
def test_random_scenes(structure):
    seen: Counter[str] = Counter()

    @settings(
        max_examples=SCENES[structure],
        derandomize=True,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(SHARES)
    def check(shares):
        result = simulate(make(changes(structure, shares)))
        seen[result.status] += 1
        tables = (result.performance, result.balance, result.error, result.ledger, result.numerics)
        values = [value for table in tables for value in table.values() if isinstance(value, float)]
        assert np.all(np.isfinite(values))
        assert all(np.all(np.isfinite(trace)) for name, trace in result.cycle.items() if name != "oil_temperature")
        if result.status == "ok":
            assert all(np.all(result.cycle[name] > 0.0) for name in ("pressure", "gas_temperature", "gas_mass"))
            assert max(result.balance.mass, result.balance.energy) <= result.balance.bound
        assert result.numerics.rhs_evaluations <= MOST

    check()
    assert seen["ok"] >= LEAST_OK * seen.total()
