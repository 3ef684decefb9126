"""What an oil dissolves beyond the critical temperature by measured points (M198), without saturation to refer to."""

import math

import numpy as np
import pytest
from each_row import each_row

from screwsim.fluid import constants
from screwsim.fluid.reference_state import last_saturation, reference_pressure
from screwsim.fluid.solubility_laws import Measured, Point
from screwsim.inputs.faults import UsageError

CRITICAL = {"CO2": 304.1282, "R32": 351.255, "R125": 339.173}
PERCENT = (1.0, 3.0, 7.0, 12.0, 20.0)


class Known(Measured):
    """M198 of CO2 from 0 to 75 °C with known constants."""

    def __init__(self):
        super(Measured, self).__init__("CO2", 273.15, 348.15, 0.5)
        self.expands_to = 0.85 * CRITICAL["CO2"]
        self._constants = (0.3, 0.5, 0.2)


@pytest.fixture(scope="module")
def law():
    return Known()


def points_of(law, celsius):
    states = [(t + 273.15, each / (100.0 - each)) for t in celsius for each in PERCENT]
    return tuple(Point(i, T, law.equilibrium_pressure(w, T), w) for i, (T, w) in enumerate(states, 2))


@each_row("fluid", sorted(CRITICAL))
def test_the_reference_is_saturation_up_to_its_end_and_goes_on_without_a_jump_or_kink(fluid):
    end = last_saturation(fluid)
    assert reference_pressure(fluid, end - 20.0) == constants.dew_pressure(fluid, end - 20.0)
    p = [math.log(reference_pressure(fluid, end + step)) for step in (-1e-3, 0.0, 1e-3)]
    slopes = np.diff(p) / 1e-3
    assert slopes[1] == pytest.approx(slopes[0], rel=0.02)  # the line is one over 1/T, its slope that over one kelvin


@each_row("fluid", sorted(CRITICAL))
def test_the_continued_saturation_meets_the_critical_pressure(fluid):
    """Over the last hundredth of the temperature ln p over 1/T is all but straight."""
    assert reference_pressure(fluid, CRITICAL[fluid]) == pytest.approx(constants.limits(fluid).p_critical, rel=0.01)


@each_row("celsius", [(0, 30, 50, 75), (35, 45, 60, 75)])
def test_points_beyond_the_critical_temperature_give_their_law_back(law, celsius):
    """Below and above it, or above it alone."""
    found = Measured("CO2", points_of(law, celsius))
    assert found.misfit < 2e-3  # of the tables of fugacity, which begin and end elsewhere
    for T in (310.0, 330.0, 345.0):
        for p in (5e5, 2e6, 4e6):
            assert found.content(p, T) == pytest.approx(law.content(p, T), rel=0.01)


def test_pressure_is_the_inverse_of_the_content_beyond_the_critical_temperature(law):
    for T in (300.0, 304.13, 320.0, 348.0):
        for held in (1e-4, 0.03, 0.2):
            assert law.content(law.equilibrium_pressure(held, T), T) == pytest.approx(held, rel=1e-9)


def test_the_content_goes_through_the_critical_temperature_without_a_jump(law):
    """At 40 bar from 295 to 315 K it falls steadily: its relative slope changes by a tenth a kelvin at most."""
    T = np.arange(295.0, 315.0, 0.5)
    logs = np.log([law.content(4e6, each) for each in T])
    slopes = np.diff(logs) / 0.5
    assert (slopes < 0.0).all()
    assert np.abs(np.diff(slopes) / slopes[1:]).max() < 0.1


def test_thin_solutions_obey_henrys_law_beyond_the_critical_temperature(law):
    thin, thinner = (law.equilibrium_pressure(w, 340.0) / w for w in (1e-5, 1e-7))
    assert thin == pytest.approx(thinner, rel=1e-4)


def test_the_fugacity_beyond_the_critical_temperature_is_coolprops(law):
    from CoolProp import AbstractState, CoolProp

    state = AbstractState("HEOS", "CO2")

    def fugacity(p, T):
        state.update(CoolProp.PT_INPUTS, p, T)
        return state.fugacity(0)

    for T in (310.0, 325.0, 345.0):
        p = law.p_sat(T)
        for share in (0.05, 0.3, 0.7, 0.95):
            wanted = fugacity(share * p, T) / fugacity(p, T)
            assert law.vapour(T).ratio(share) == pytest.approx(wanted, rel=1e-3)


def test_a_pressure_beyond_the_reference_is_refused_by_its_line(law):
    points = list(points_of(law, (0, 30, 50, 75)))
    points[-1] = points[-1]._replace(p=1.01 * law.p_sat(348.15))
    with pytest.raises(UsageError) as error:
        Measured("CO2", points)
    assert str(error.value).startswith("line 21: at 75 degC the law of M198 holds below 173.88 bar")
