"""A machine on carbon dioxide with oil beyond its critical temperature, which holds gas all the same (M196, M198)."""

import math

import numpy as np
import pytest
from each_row import each_row
from scenes import SOLUBLE, SOLUBLE_RATE, make, run

from screwsim.build import build_parts
from screwsim.effects.refrigerant_solubility import heat_of_flash
from screwsim.fluid.solubility_laws import COLUMNS, law_of_points, read_points

SOLUBILITY = "effects.refrigerant_solubility"
LINES = {
    "operation.suction": {"pressure": "30 bar", "temperature": "285 K"},
    "operation.discharge": {"pressure": "60 bar"},
}
POINTS = [  # [degC, bar, % of the solution]: rounded, of an ester
    *((10, 3, 1.5), (10, 14, 7.3), (10, 26, 16), (10, 39, 30)),
    *((30, 6, 2.2), (30, 17, 6.2), (30, 34, 13), (30, 58, 27)),
    *((50, 7, 1.9), (50, 19, 5.2), (50, 39, 11), (50, 73, 23)),
    *((70, 8, 1.6), (70, 21, 4.5), (70, 43, 9.9), (70, 85, 21)),
]


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    path = tmp_path_factory.mktemp("oil") / "oil.csv"
    rows = [",".join(map(str, each)) for each in POINTS]
    path.write_text("\n".join([",".join(COLUMNS), *rows]) + "\n", encoding="utf-8")
    return str(path)


def on_carbon_dioxide(scene, points):
    known = {f"{SOLUBILITY}.points_file": points, f"{SOLUBILITY}.separator_temperature": "340 K"}
    return {**scene, **LINES, "gas": {"fluid": "CO2", "model": "real", "two_phase": "equilibrium"}, **known}


@each_row("scene", [SOLUBLE, SOLUBLE_RATE])
def test_a_machine_closes_with_oil_beyond_the_critical_temperature(scene, points):
    result = run(on_carbon_dioxide(scene, points))
    assert result.status == "ok"
    assert max(result.balance.mass, result.balance.energy, result.balance.entropy) < 3e-4
    assert result.performance.dissolved_gas_ratio > 0.1


def test_flashing_gas_takes_the_heat_of_solution_of_van_t_hoff(points):
    """h of the vapour less d(g/T)/d(1/T) at one content, by differences of CoolProp's g."""
    from CoolProp.CoolProp import PropsSI

    scene = make(on_carbon_dioxide(SOLUBLE, points))
    gas, law = build_parts(scene).gas, law_of_points("CO2", read_points(points))
    T_separator, T, p_d = 340.0, 325.0, 6e6
    held = law.content(p_d, T_separator)

    def vapour(what, at):
        return PropsSI(what, "T", at, "P", law.equilibrium_pressure(held, at), "CO2")

    def potential(at):
        return vapour("HMASS", at) / at - vapour("SMASS", at)

    dissolved = (potential(T_separator) - potential(T)) / (1.0 / T_separator - 1.0 / T)
    found = heat_of_flash(law, gas, T_separator, T, p_d)
    assert found == pytest.approx(vapour("HMASS", T) - dissolved, rel=2e-3)
    assert 1e5 < found < 4e5


def test_the_heat_of_flash_goes_through_the_critical_temperature_without_a_jump(points):
    scene = make(on_carbon_dioxide(SOLUBLE, points))
    gas, law = build_parts(scene).gas, law_of_points("CO2", read_points(points))
    heats = [heat_of_flash(law, gas, 330.0, T, 5e6) for T in np.arange(300.0, 308.0, 0.5)]
    assert np.abs(np.diff(np.log(heats))).max() < 0.03
    assert all(math.isfinite(each) for each in heats)
