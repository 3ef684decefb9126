"""Nozzle flow: the textbook's formula, its limits, its smoothness, and its derivatives."""

import math

import numpy as np
import pytest

from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.nozzle import SMALL, choking, expansion, flow, flow_slopes

GAS = IdealGas(R=81.49, k=1.12)  # about R134a
AREA = 1e-4
WIDTH = 10.0  # Pa
HIGH = (12e5, 360.0)  # pressure [Pa], temperature [K]
ROUNDING = 1e-12


def place(p, T, gas=GAS):
    """Return (p, ρ, 1/k, drop and ψ² of choking), the arguments that a place gives to `flow`."""
    pressure, rho, _h, *rest = gas.place(p, T)
    return pressure, rho, *rest


def textbook(p_u, T_u, p_d, gas=GAS):
    """Return S p_u √(2k/(k−1)/(R T_u) [r^(2/k) − r^((k+1)/k)]), r no smaller than (2/(k+1))^(k/(k−1)) (M12, M13)."""
    k = gas.k
    r = max(p_d / p_u, (2 / (k + 1)) ** (k / (k - 1)))
    return AREA * p_u * math.sqrt(2 * k / (k - 1) / (gas.R * T_u) * (r ** (2 / k) - r ** ((k + 1) / k)))


def regularised(dp, width=WIDTH):
    """Return the factor that the regularisation puts on the flow."""
    return (1 + (width / dp) ** 2) ** -0.25


def into_first(p_1, T_1, p_2, T_2, width=WIDTH, gas=GAS):
    return flow(AREA, *place(p_1, T_1, gas), *place(p_2, T_2, gas), width)


UNCHOKED = (0.999, 0.985, 0.95, 0.8, 0.6)
CHOKED = (0.5, 0.1, 1e-3)


@pytest.mark.parametrize("k", [1.05, 1.12, 1.4, 1.667])
@pytest.mark.parametrize("r", [*UNCHOKED, *CHOKED])
def test_inflow_is_the_textbooks(r, k):
    gas = IdealGas(R=81.49, k=k)
    p, T = HIGH
    expected = textbook(p, T, r * p, gas) * regularised(p * (1 - r))
    assert into_first(r * p, 300.0, p, T, gas=gas) == pytest.approx(expected, rel=ROUNDING)


@pytest.mark.parametrize("r", [*UNCHOKED, *CHOKED])
def test_outflow_is_the_textbooks_and_negative(r):
    p, T = HIGH
    expected = -textbook(p, T, r * p) * regularised(p * (1 - r))
    assert into_first(p, T, r * p, 300.0) == pytest.approx(expected, rel=ROUNDING)


def test_nothing_flows_at_equal_pressures():
    assert into_first(2e5, 300.0, 2e5, 350.0) == 0.0


@pytest.mark.parametrize("p_2", [1.0e5, 1.99999e5, 2.00001e5, 2.1e5, 9e5])
def test_swapping_the_places_turns_the_sign(p_2):
    assert into_first(2e5, 300.0, p_2, 350.0) == -into_first(p_2, 350.0, 2e5, 300.0)  # exactly: mass is conserved by it


def test_flow_is_proportional_to_the_area():
    args = (*place(2e5, 300.0), *place(3e5, 320.0), WIDTH)
    assert flow(3.0, *args) == pytest.approx(3.0 * flow(1.0, *args), rel=1e-15)


@pytest.mark.parametrize("x", [0.1, 1.0, 10.0, 100.0])
def test_the_regularisation_errs_by_what_it_states(x):
    """1 − (1 + (ε/Δp)²)^(−1/4): 16 % at Δp = ε."""
    exact, found = textbook(2e5 + x * WIDTH, 300.0, 2e5), into_first(2e5, 300.0, 2e5 + x * WIDTH, 300.0)
    assert 1 - found / exact == pytest.approx(1 - (1 + x**-2) ** -0.25, abs=1e-10)  # 1 − r cancels ten digits at 1 Pa


def test_the_stated_error_at_the_width_is_sixteen_percent():
    assert 1 - regularised(WIDTH) == pytest.approx(0.16, abs=0.005)


def test_flow_has_one_slope_on_both_sides_of_equal_pressures():
    one = place(2e5, 300.0)
    left, right = (flow_slopes(AREA, *one, *place(2e5 + dp, 300.0), WIDTH)[3] for dp in (-1e-6, 1e-6))
    assert left == pytest.approx(right, rel=1e-6)  # Δp/ε = 1e-7 away from the middle, and ρ differs by as little


def test_flow_is_smooth_through_the_series_for_small_drops():
    a, choke, choked = 1 / GAS.k, *choking(GAS.k)
    below, above = expansion(SMALL * (1 - 1e-14), a, choke, choked), expansion(SMALL, a, choke, choked)
    assert below == pytest.approx(above, rel=1e-13)  # the closed form cancels two digits at a drop of 2 %


def test_flow_is_continuous_at_choking():
    a, choke, choked = 1 / GAS.k, *choking(GAS.k)
    assert expansion(choke * (1 - 1e-13), a, choke, choked) == pytest.approx(
        expansion(choke, a, choke, choked), rel=1e-12
    )


def test_the_slope_by_the_pressure_below_vanishes_at_choking():
    p, T = HIGH
    choke, _ = choking(GAS.k)
    slope = flow_slopes(AREA, *place(p * (1 - choke * (1 - 1e-9)), 300.0), *place(p, T), 0.0)[1]
    assert abs(slope) * p < 1e-7 * textbook(p, T, 0.0)  # ψ has its maximum there: C1 across choking


def test_no_pressure_below_gives_more_than_the_choked_flow():
    p, T = HIGH
    most = textbook(p, T, 0.0)
    assert max(into_first(r * p, 300.0, p, T) for r in np.linspace(1e-3, 1.0, 400)) <= most * (1 + ROUNDING)


def test_the_choked_flow_depends_only_on_the_state_above():
    p, T = HIGH
    flows = {into_first(r * p, T_1, p, T, width=0.0) for r in (0.01, 0.3, 0.5) for T_1 in (250.0, 400.0)}
    assert max(flows) / min(flows) - 1 < ROUNDING


def test_choking_sets_in_where_the_textbook_says():
    k = 1.4
    drop, psi2 = choking(k)
    assert 1 - drop == pytest.approx(0.5282817877, rel=1e-9)  # of air, in every table
    assert psi2 == pytest.approx(k * (2 / (k + 1)) ** ((k + 1) / (k - 1)), rel=ROUNDING)


PAIRS = [(2e5, 2.5e5), (2e5, 2.01e5), (2e5, 9e5), (2.5e5, 2e5), (9e5, 2e5), (2.0e5, 2.00003e5), (2.00003e5, 2e5)]


@pytest.mark.parametrize(("p_1", "p_2"), PAIRS)
@pytest.mark.parametrize("which", range(4))
def test_slopes_are_the_derivatives_of_the_flow(p_1, p_2, which):
    """∂ṁ/∂p_1, ∂ρ_1, ∂p_2, ∂ρ_2 against central differences, unchoked and choked, both directions, near Δp = 0."""
    values = np.array([p_1, place(p_1, 300.0)[1], p_2, place(p_2, 350.0)[1]])
    rest = (1 / GAS.k, *choking(GAS.k))

    def at(v):
        return flow(AREA, v[0], v[1], *rest, v[2], v[3], *rest, WIDTH)

    step = 1e-6 * values[which] if which % 2 else 0.01 * min(abs(p_2 - p_1), WIDTH)
    shift = np.eye(4)[which] * step
    difference = (at(values + shift) - at(values - shift)) / (2 * step)
    slopes = flow_slopes(AREA, values[0], values[1], *rest, values[2], values[3], *rest, WIDTH)
    scale = abs(slopes[0]) / values[which] * 1e-6
    # 1e-4: second order of the difference, (0.01)²; its cancellation falls below `scale`
    assert slopes[1 + which] == pytest.approx(difference, rel=1e-4, abs=scale)


def test_slopes_come_with_the_flow_itself():
    args = (AREA, *place(2e5, 300.0), *place(3e5, 320.0), WIDTH)
    assert flow_slopes(*args)[0] == pytest.approx(flow(*args), rel=1e-15)
