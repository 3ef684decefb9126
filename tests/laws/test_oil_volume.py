"""Oil that takes room: its limit, its lock, and that the indicated work lifts it."""

from pathlib import Path

import numpy as np
import pytest
from scenes import OIL_VOLUME, TOGETHER, run

from screwsim.scene import load
from screwsim.simulate import simulate

PAPER = Path(__file__).parents[2] / "configs" / "paper" / "point.yaml"
R134A = Path(__file__).parents[2] / "configs" / "r134a" / "point.yaml"
ACCURACY = 3e-4
HEAVY = {"oil.density": "1e8 kg/m^3", "effects.oil_heat.droplet_radius": "1 nm"}  # 1e5 times as dense; α/(r ρ) kept


def test_oil_of_no_volume_changes_nothing():
    heavy, without = run({**OIL_VOLUME, **HEAVY}).performance, run({"oil.transport": "carried"}).performance
    for name in ("gas_mass_flow", "indicated_power", "discharge_temperature", "trapped_mass", "peak_pressure"):
        assert heavy[name] == pytest.approx(without[name], rel=ACCURACY), name


def test_the_indicated_work_lifts_the_oil():
    full, without = run(OIL_VOLUME).performance, run({"oil.transport": "carried"}).performance
    assert full.oil_lift_power == 0.0
    assert 0.3 < (full.indicated_power - without.indicated_power) / without.oil_lift_power < 1.0


@pytest.mark.parametrize("d", [0, 1, 3, 8])
def test_ratios_up_to_eight_close(d):
    result = run({**OIL_VOLUME, "oil_supply.ratio": d})
    assert result.status == "ok"
    assert result.performance.oil_ratio == pytest.approx(d, abs=1e-6)


def test_gas_has_the_room_that_the_oil_leaves():
    result = run({**OIL_VOLUME, "oil_supply.ratio": 8})
    cycle = result.cycle
    after = (cycle["angle"] > 361.0) & (cycle["angle"] < 715.0)
    room = cycle["volume"][after] - cycle["oil_mass"][after] / 1000.0
    R = 8.314462618 / 0.102032
    p = cycle["gas_mass"][after] / room * R * cycle["gas_temperature"][after]
    np.testing.assert_allclose(p, cycle["pressure"][after], rtol=1e-5)  # molar mass printed to six digits


def test_injected_oil_compresses_the_gas_that_it_displaces():
    """An isentrope of the ideal gas from the room before to the room after; k = 1.11 of R134a at 283 K."""
    result = run({**OIL_VOLUME, "oil_supply.ratio": 8})
    cycle = result.cycle
    volume = cycle["volume"][cycle["angle"] == 360.0][0]
    oil = 8 * result.performance.trapped_mass / 1000.0
    before, after = (cycle["pressure"][cycle["angle"] == angle][0] for angle in (359.0, 361.0))
    assert after / before == pytest.approx(
        (volume / (volume - oil)) ** 1.115, rel=0.02
    )  # two degrees of everything else


@pytest.mark.parametrize(("d", "off", "told"), [(8, 0.06, False), (12, 0.08, True)])
def test_a_neglected_room_that_matters_is_warned_of(d, off, told):
    """What a third of the chamber and more does to the power of a real gas, if nobody counts it."""
    scene = load(R134A).with_({"oil_supply.ratio": d})
    without, full = simulate(scene, trace=False), simulate(scene.with_({"effects.oil_volume": {}}), trace=False)
    more = full.performance.shaft_power / without.performance.shaft_power - 1.0
    assert (more > off) is told
    assert any("name effects.oil_volume" in warning for warning in without.warnings) is told
    assert not any("takes up no volume" in warning for warning in full.warnings)


def test_the_remedy_of_a_neglected_room_is_one_step_where_the_oil_is_not_carried():
    scene = load(PAPER).with_({"oil_supply.ratio": 20})
    (warning,) = (each for each in simulate(scene, trace=False).warnings if "takes up no volume" in each)
    assert "(name effects.oil_volume with oil.transport: carried, use less oil" in warning
    full = simulate(scene.with_({"effects.oil_volume": {}, "oil.transport": "carried"}), trace=False)
    assert full.status == "ok" and not full.warnings


@pytest.mark.parametrize("d", [50, 300])
def test_a_chamber_full_of_oil_is_locked(d):
    result = run({**OIL_VOLUME, "oil_supply.ratio": d})
    assert result.status == "failed"
    assert "hydraulic lock at" in result.message
    assert "use less oil" in result.message


def test_more_oil_than_the_chamber_holds_locks_at_the_injection():
    result = run({**OIL_VOLUME, "oil_supply.ratio": 1000, "numerics": {"closing": "histories"}})
    assert result.status == "failed"
    assert "hydraulic lock at 360.00 deg" in result.message


@pytest.mark.slow
def test_a_wide_bore_locks_too():
    result = run({**TOGETHER, "oil_supply.orifice_diameter": "40 mm"})
    assert result.status == "failed"
    assert "hydraulic lock at" in result.message
