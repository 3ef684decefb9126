"""Stored oils: what data sheets print, and ASTM D341 between."""

import math

import pytest
from each_row import each_row

from screwsim.fluid.oils import OILS, Grade

GRADES = {name: oil for name, oil in OILS.items() if isinstance(oil, Grade)}


@each_row("name", GRADES)
def test_a_grade_has_its_number_at_40_degC_and_its_data_sheet_at_100(name):
    oil = GRADES[name]
    assert oil.kinematic_at(313.15) == pytest.approx(float(name.rpartition("_")[2]) * 1e-6, rel=1e-12)
    assert oil.kinematic_at(373.15) == pytest.approx(oil.at_100 * 1e-6, rel=1e-12)


def test_viscosity_between_is_a_straight_line_of_astm_d341():
    oil = GRADES["mineral_46"]
    line = [math.log10(math.log10(1e6 * oil.kinematic_at(T) + 0.7)) for T in (313.15, 343.15, 373.15)]
    share = math.log10(343.15 / 313.15) / math.log10(373.15 / 313.15)
    assert line[1] == pytest.approx(line[0] + share * (line[2] - line[0]), rel=1e-12)


@pytest.mark.parametrize("family", ["mineral", "POE", "PAO", "PAG"])
def test_grades_thicken_with_their_number_at_every_temperature(family):
    oils = [oil for name, oil in GRADES.items() if name.startswith(f"{family}_")]
    assert len(oils) == 6
    for T in (273.15, 313.15, 353.15, 393.15):
        viscosities = [oil.viscosity_at(T) for oil in oils]
        assert viscosities == sorted(viscosities)


def test_viscosity_indices_stand_in_the_order_of_the_families():
    """PAG falls least between 40 and 100 °C, then PAO, then ester and mineral oil."""
    falls = {family: GRADES[f"{family}_68"].at_100 for family in ("PAG", "PAO", "POE", "mineral")}
    assert list(falls.values()) == sorted(falls.values(), reverse=True)


@each_row("name", GRADES)
def test_density_and_heat_capacity_are_those_of_lubricating_oils(name):
    oil = GRADES[name]
    assert 780.0 < oil.density_at(353.15) < oil.density_at(313.15) < 1000.0
    assert 1850.0 < oil.heat_capacity_at(313.15) < oil.heat_capacity_at(373.15) < 2300.0
