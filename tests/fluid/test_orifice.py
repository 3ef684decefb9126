"""The injection orifice: Lichtarowicz's coefficient and the flow it gives."""

import math

import pytest

from screwsim.fluid.orifice import discharge_coefficient, orifice_flow, smooth_orifice_flow

OIL = {"density": 1000.0, "viscosity": 0.02, "diameter": 3e-3, "length": 6e-3, "number": 1.0}


@pytest.mark.parametrize(("reynolds", "slenderness", "expected"), [(2e4, 2.0, 0.80882), (100.0, 2.0, 0.42842)])
def test_coefficient_computed_by_hand(reynolds, slenderness, expected):
    assert discharge_coefficient(reynolds, slenderness) == pytest.approx(expected, abs=5e-6)  # five digits by hand


@pytest.mark.parametrize("slenderness", [2.0, 5.0, 10.0])
def test_coefficient_tends_to_the_ultimate_one(slenderness):
    ultimate = 0.827 - 0.0085 * slenderness
    # the last term dies only with the square of lg Re: 0.05/(7.5 · 26²) = 1e-5 at Re = 1e30
    assert discharge_coefficient(1e30, slenderness) == pytest.approx(ultimate, rel=1e-5)


def test_coefficient_of_creeping_flow_is_proportional_to_reynolds():
    slenderness, reynolds = 2.0, 1e-6
    expected = reynolds / (20.0 * (1.0 + 2.25 * slenderness))
    assert discharge_coefficient(reynolds, slenderness) == pytest.approx(expected, rel=1e-6)  # next term: Re/100


def test_coefficient_rises_with_reynolds():
    values = [discharge_coefficient(10.0**e, 2.0) for e in range(1, 6)]
    assert values == sorted(values)


def test_flow_is_coefficient_times_area_times_root():
    dp = 10e5
    velocity = math.sqrt(2 * dp / OIL["density"])
    C = discharge_coefficient(OIL["density"] * velocity * OIL["diameter"] / OIL["viscosity"], 2.0)
    expected = C * math.pi / 4 * OIL["diameter"] ** 2 * math.sqrt(2 * OIL["density"] * dp)
    assert orifice_flow(dp, *OIL.values()) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("dp", [0.0, -1e5])
def test_no_oil_flows_backwards(dp):
    assert orifice_flow(dp, *OIL.values()) == 0.0


def test_two_bores_give_twice_the_flow():
    assert orifice_flow(1e5, *{**OIL, "number": 2.0}.values()) == pytest.approx(2 * orifice_flow(1e5, *OIL.values()))


def test_flow_vanishes_with_the_pressure_difference():
    assert orifice_flow(1e-9, *OIL.values()) < 1e-9 * orifice_flow(1e5, *OIL.values())


def test_the_smoothed_flow_differs_by_a_quarter_of_the_squared_width():
    full, smoothed = orifice_flow(1e5, *OIL.values()), smooth_orifice_flow(1e5, 1e4, *OIL.values())
    # to first order; C_d falls with Re by some percent of that
    assert 1.0 - smoothed / full == pytest.approx(0.25 * 0.1**2, rel=0.1)


def test_the_smoothed_flow_begins_with_no_slope():
    assert smooth_orifice_flow(0.0, 100.0, *OIL.values()) == smooth_orifice_flow(-1e5, 100.0, *OIL.values()) == 0.0
    slopes = [smooth_orifice_flow(dp, 100.0, *OIL.values()) / dp for dp in (1.0, 1e-2, 1e-4)]
    assert slopes[2] < 1e-2 * slopes[0]
