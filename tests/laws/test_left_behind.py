"""Gas that the discharge port does not let out before its chamber vanishes is recompressed and flows back: told."""

import pytest
from folders import CONFIGS
from scenes import make

from screwsim.scene import load
from screwsim.simulate import simulate

LEAKS = "interlobe_leakage", "blow_hole", "end_face_leakage"
TIGHT, WIDE = ({"effects.tip_leakage.gap": gap} for gap in ("1 um", "50 um"))


def told(result):
    return [warning for warning in result.warnings if "of the charge is not let out" in warning]


def test_gas_that_is_left_is_told_with_its_share_and_its_pressure():
    """As the trace has them at the end of the life, with which the next one begins."""
    result = simulate(make(TIGHT))
    mass, pressure = result.cycle["gas_mass"], result.cycle["pressure"][-1]
    (warning,) = told(result)
    assert warning.startswith(f"{mass[-1] / result.performance.trapped_mass:.1%} of the charge is not let out")
    assert pressure > 30.0 * result.performance.discharge_pressure
    assert float(warning.partition("it reaches ")[2].partition(" bar")[0]) == pytest.approx(1e-5 * pressure, rel=1e-5)
    assert mass[0] == pytest.approx(mass[-1], rel=1e-3)


def test_gaps_that_let_it_out_keep_nothing_behind():
    """Tighter tips deliver less here: what they hold back comes round again."""
    wide = simulate(make(WIDE))
    assert not told(wide)
    assert wide.cycle["gas_mass"][-1] < 2e-3 * wide.performance.trapped_mass
    assert wide.performance.volumetric_efficiency > simulate(make(TIGHT)).performance.volumetric_efficiency


def test_a_machine_without_gaps_is_not_told_what_gaps_would_let_out():
    none = dict.fromkeys((f"effects.{gap}" for gap in ("tip_leakage", *LEAKS)), False)
    assert not told(simulate(make(none)))


@pytest.mark.parametrize(("area", "warns"), [("0.05 mm^2", True), ("4 mm^2", False)])
def test_a_clearance_always_keeps_gas_and_only_its_pressure_is_told(area, warns):
    """A cylinder has valves, no port, and does not vanish."""
    scene = load(CONFIGS / "slider_crank" / "flexible_rod.yaml", [f"effects.check_valves.discharge_area={area}"])
    result = simulate(scene)
    assert not told(result)
    found = [each for each in result.warnings if "stays in the clearance" in each]
    assert bool(found) == warns
    pressure, p_d = result.cycle["pressure"][-1], result.performance.discharge_pressure
    assert (pressure > 2.0 * p_d) == warns
    assert all(f"{pressure / p_d:.3g} times the discharge pressure" in each for each in found)
