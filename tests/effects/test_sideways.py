"""Openings to the other side's line: coupled chambers keep the balances where gas goes to suction late."""

import pytest
from scenes import balanced, run

SLIDE = {
    "oil.transport": "carried",
    "effects.slide_valve": {"slot_area": "60 cm^2", "closes": "640 deg", "position": 0.5},
}


@pytest.mark.slow
@pytest.mark.parametrize("rpm", [3000, 1000])
def test_coupled_chambers_with_a_slot_to_suction_keep_mass_energy_and_entropy(rpm):
    balanced(run({**SLIDE, "operation.speed": f"{rpm} rpm", "numerics.closing": "coupled"}), "oil_mass")


def test_both_ways_of_closing_agree_with_a_slot_to_suction():
    ways = [run({**SLIDE, "operation.speed": "3000 rpm", "numerics.closing": way}) for way in ("coupled", "histories")]
    coupled, histories = (found.performance for found in ways)
    for name in ("gas_mass_flow", "indicated_power", "discharge_temperature"):
        assert coupled[name] == pytest.approx(histories[name], rel=1e-3), name
