"""Nozzle flow: the textbook's formula, its limits, its smoothness, and its derivatives."""

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from each_row import each_row
from scipy.optimize import minimize_scalar

from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.nozzle import (
    FITTED,
    NEAR_ONE,
    SMALL,
    choking,
    expansion,
    flow,
)
from screwsim.fluid.real_gas import RealGas
from screwsim.numerics.derivative import tangent

flow_slopes = tangent(flow, ("p_1", "rho_1", "p_2", "rho_2"))  # with the flow itself, as the models have them
expansion_with_slope = tangent(expansion, ("x",))
GAS = IdealGas(R=81.49, k=1.12)  # about R134a
AREA = 1e-4
WIDTH = 10.0  # Pa
HIGH = (12e5, 360.0)  # pressure [Pa], temperature [K]
ROUNDING = 1e-12


def port_state(p, T, gas=GAS):
    """Return (p, ρ, 1/k, drop and ψ² of choking), the arguments that a port state gives to `flow`."""
    pressure, rho, _h, *rest = gas.port_state(p, T)
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
    return flow(AREA, *port_state(p_1, T_1, gas), *port_state(p_2, T_2, gas), width)


UNCHOKED = (0.999, 0.985, 0.95, 0.8, 0.6)
CHOKED = (0.5, 0.1, 1e-3)


@each_row("k", [1.05, 1.12, 1.4, 1.667])
@each_row("r", [*UNCHOKED, *CHOKED])
def test_inflow_is_the_textbooks(r, k):
    gas = IdealGas(R=81.49, k=k)
    p, T = HIGH
    expected = textbook(p, T, r * p, gas) * regularised(p * (1 - r))
    assert into_first(r * p, 300.0, p, T, gas=gas) == pytest.approx(expected, rel=ROUNDING)


@each_row("r", [*UNCHOKED, *CHOKED])
def test_outflow_is_the_textbooks_and_negative(r):
    p, T = HIGH
    expected = -textbook(p, T, r * p) * regularised(p * (1 - r))
    assert into_first(p, T, r * p, 300.0) == pytest.approx(expected, rel=ROUNDING)


def test_nothing_flows_at_equal_pressures():
    assert into_first(2e5, 300.0, 2e5, 350.0) == 0.0


@each_row("p_2", [1.0e5, 1.99999e5, 2.00001e5, 2.1e5, 9e5])
def test_swapping_the_port_states_turns_the_sign(p_2):
    assert into_first(2e5, 300.0, p_2, 350.0) == -into_first(p_2, 350.0, 2e5, 300.0)  # exactly: mass is conserved by it


def test_flow_is_proportional_to_the_area():
    args = (*port_state(2e5, 300.0), *port_state(3e5, 320.0), WIDTH)
    assert flow(3.0, *args) == pytest.approx(3.0 * flow(1.0, *args), rel=1e-15)


@pytest.mark.parametrize("x", [0.1, 1.0, 10.0, 100.0])
def test_the_regularisation_errs_by_what_it_states(x):
    """1 − (1 + (ε/Δp)²)^(−1/4): 16 % at Δp = ε."""
    exact, found = textbook(2e5 + x * WIDTH, 300.0, 2e5), into_first(2e5, 300.0, 2e5 + x * WIDTH, 300.0)
    assert 1 - found / exact == pytest.approx(1 - (1 + x**-2) ** -0.25, abs=1e-10)  # 1 − r cancels ten digits at 1 Pa


def test_the_stated_error_at_the_width_is_sixteen_percent():
    assert 1 - regularised(WIDTH) == pytest.approx(0.16, abs=0.005)


def test_flow_has_one_slope_on_both_sides_of_equal_pressures():
    one = port_state(2e5, 300.0)
    left, right = (flow_slopes(AREA, *one, *port_state(2e5 + dp, 300.0), WIDTH)[3] for dp in (-1e-6, 1e-6))
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
    slope = flow_slopes(AREA, *port_state(p * (1 - choke * (1 - 1e-9)), 300.0), *port_state(p, T), 0.0)[1]
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


@each_row(("p_1", "p_2"), PAIRS)
@each_row("which", range(4))
def test_slopes_are_the_derivatives_of_the_flow(p_1, p_2, which):
    """∂ṁ/∂p_1, ∂ρ_1, ∂p_2, ∂ρ_2 against central differences, unchoked and choked, both directions, near Δp = 0."""
    values = np.array([p_1, port_state(p_1, 300.0)[1], p_2, port_state(p_2, 350.0)[1]])
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
    args = (AREA, *port_state(2e5, 300.0), *port_state(3e5, 320.0), WIDTH)
    assert flow_slopes(*args)[0] == pytest.approx(flow(*args), rel=1e-15)


# ---- every exponent k > 0 ----------------------------------------------------------------------------------------

EXPONENTS = [
    0.3,
    0.5,
    0.8,
    0.95,
    0.99,
    1 - 1e-4,
    1 - 1e-8,
    1 - 1e-12,
    1.0,
    1 + 1e-12,
    1 + 1e-7,
    1.001,
    1.06,
    1.12,
    1.4,
    3.0,
    5.0,
]
DROPS = [1e-9, 1e-4, 0.01, 0.0199, 0.0201, 0.05, 0.1, 0.15]


def digits(k, x):
    """Return ψ²/x and the choking drop and ψ² in fifty digits; k = 1 by its limits."""
    with localcontext() as context:
        context.prec = 60
        k, r = Decimal(k), 1 - Decimal(x)
        if k == 1:
            return -2 * r * r * r.ln() / (1 - r), 1 - Decimal("-0.5").exp(), Decimal("-1").exp()
        psi2 = 2 * k / (k - 1) * ((r.ln() * 2 / k).exp() - (r.ln() * (k + 1) / k).exp())
        limit = ((2 / (k + 1)).ln() * k / (k - 1)).exp()
        most = 2 * k / (k - 1) * ((limit.ln() * 2 / k).exp() - (limit.ln() * (k + 1) / k).exp())
        return psi2 / (1 - r), 1 - limit, most


@each_row("k", EXPONENTS)
def test_choking_is_right_for_every_exponent(k):
    _, drop, most = digits(k, 0.1)
    assert choking(k) == pytest.approx((float(drop), float(most)), rel=1e-14)  # the polynomial's error, doubled by ψ²


@each_row("x", DROPS)
@each_row("k", EXPONENTS)
def test_expansion_is_right_for_every_exponent(k, x):
    found = expansion(x, 1.0 / k, *choking(k))
    # 1e-12 at the drop of 0.02 where the closed form begins and cancels two digits; 1/k itself is rounded
    assert found == pytest.approx(float(digits(k, x)[0]), rel=1e-12)


@each_row("x", [1e-4, 0.01, 0.05, 0.1, 0.15])
@each_row("k", EXPONENTS)
def test_the_slope_of_expansion_is_right_for_every_exponent(k, x):
    a, step = 1.0 / k, 1e-20
    exact = (digits(k, Decimal(x) + Decimal(step))[0] - digits(k, Decimal(x) - Decimal(step))[0]) / (2 * Decimal(step))
    value, found = expansion_with_slope(x, a, *choking(k))
    assert value == pytest.approx(expansion(x, a, *choking(k)), rel=1e-14)
    # below the drop of 0.02 the slope is a forward difference over 1e-4 by choice: second derivatives are of size 10
    assert found == pytest.approx(float(exact), rel=1e-3 if x < SMALL else 1e-11)


@pytest.mark.parametrize("x", [0.05, 0.3])
@pytest.mark.parametrize("k", [1.0 / (1.0 - NEAR_ONE), 1.0 / (1.0 + NEAR_ONE)])
def test_expansion_is_smooth_where_the_form_changes(k, x):
    values = [expansion(x, 1.0 / (k * (1 + e)), *choking(k)) for e in (-1e-14, 1e-14)]
    assert values[0] == pytest.approx(values[1], rel=1e-12)


@pytest.mark.parametrize("y", [FITTED, -FITTED])
def test_choking_is_smooth_where_its_polynomial_ends(y):
    values = [choking((1 + y * e) / (1 - y * e)) for e in (1 - 1e-13, 1 + 1e-13)]
    assert values[0] == pytest.approx(values[1], rel=1e-12)


@each_row("k", [0.5, 0.97, 1.0, 1.3])
@each_row("which", range(4))
def test_slopes_are_the_derivatives_of_the_flow_for_every_exponent(k, which):
    rest = (1.0 / k, *choking(k))
    values = np.array([2e5, 4.0, 2.5e5, 5.0])

    def at(v):
        return flow(AREA, v[0], v[1], *rest, v[2], v[3], *rest, WIDTH)

    shift = np.eye(4)[which] * 1e-5 * values[which]
    difference = (at(values + shift) - at(values - shift)) / (2e-5 * values[which])
    slopes = flow_slopes(AREA, values[0], values[1], *rest, values[2], values[3], *rest, WIDTH)
    assert slopes[1 + which] == pytest.approx(difference, rel=1e-8, abs=1e-14)  # (1e-5)² of a central difference


# ---- the local exponent against the isentrope of the real gas ----------------------------------------------------


def exact_flux(gas, p_1, T_1, p_2):
    """Return ρ √(2 Δh) [kg/(s m²)] on the real isentrope in equilibrium, at p_2 or at its maximum."""
    s, h_1 = gas.entropy(p_1, T_1), gas.enthalpy(p_1, T_1)

    def flux(p):
        _T, rho, h = gas.isentrope(p, s)
        return rho * math.sqrt(2.0 * max(h_1 - h, 0.0))

    throat = minimize_scalar(lambda p: -flux(p), bounds=(0.3 * p_1, 0.95 * p_1), method="bounded").x
    return flux(max(p_2, throat))


def local_flux(gas, p_1, T_1, p_2):
    return flow(1.0, p_2, 1.0, 1.0, 0.5, 0.5, *(gas.port_state(p_1, T_1)[i] for i in (0, 1, 3, 4, 5)), 0.0)


# fluid, upstream pressure and superheat, and whether the expansion to the throat stays dry
UPSTREAM = [
    ("R134a", 2e5, 12.0), ("R134a", 8e5, 16.0), ("R134a", 12e5, 10.0), ("R134a", 12e5, 30.0), ("R134a", 20e5, 10.0),
    ("n-Propane", 2e5, 12.0), ("n-Propane", 12e5, 8.0), ("n-Propane", 20e5, 10.0), ("n-Propane", 20e5, 40.0),
    ("Ammonia", 12e5, 56.0), ("Ammonia", 20e5, 68.0), ("CarbonDioxide", 20e5, 36.0), ("CarbonDioxide", 35e5, 60.0),
]  # fmt: skip
WET_THROAT = [
    ("Ammonia", 2e5, 16.0),
    ("Ammonia", 12e5, 16.0),
    ("CarbonDioxide", 20e5, 11.0),
    ("CarbonDioxide", 35e5, 12.0),
]


def error(fluid, p_1, superheat, ratio):
    gas = RealGas(fluid, "equilibrium")
    T_1 = gas.saturation_temperature(p_1) + superheat
    return local_flux(gas, p_1, T_1, ratio * p_1) / exact_flux(gas, p_1, T_1, ratio * p_1) - 1.0


@pytest.mark.parametrize(("fluid", "p_1", "superheat"), UPSTREAM)
def test_the_local_exponent_errs_by_what_is_stated(fluid, p_1, superheat):
    """At most 0.02 % at a drop of 5 %, 0.1 % at 10 %, 0.4 % at 20 %, 1.5 % choked (k varies along the isentrope)."""
    for ratio, bound in ((0.95, 2e-4), (0.9, 1e-3), (0.8, 4e-3), (0.2, 1.5e-2)):
        assert abs(error(fluid, p_1, superheat, ratio)) < bound


@pytest.mark.parametrize(("fluid", "p_1", "superheat"), WET_THROAT)
def test_the_local_exponent_errs_more_where_the_throat_is_wet(fluid, p_1, superheat):
    """At most 3 % choked, against equilibrium; vapour that does not condense so fast has less error."""
    assert abs(error(fluid, p_1, superheat, 0.9)) < 1e-3
    assert abs(error(fluid, p_1, superheat, 0.2)) < 3e-2


@pytest.mark.parametrize(
    ("T_1", "part", "choked"),
    [
        (400.0, 6e-3, (0.004, 0.016)),
        (345.0, 6e-3, (0.008, 0.05)),
        (325.0, 8e-3, (0.02, 0.19)),
        (315.0, 0.025, (0.1, 0.4)),
    ],
)
def test_above_the_critical_pressure_the_local_exponent_lets_too_much_through(T_1, part, choked):
    """CO2 near its critical temperature expands into the dome, where equilibrium lets less pass."""
    gas = RealGas("CarbonDioxide", "equilibrium")
    for p_1 in (80e5, 90e5, 100e5, 120e5):
        errors = [local_flux(gas, p_1, T_1, r * p_1) / exact_flux(gas, p_1, T_1, r * p_1) - 1.0 for r in (0.8, 0.2)]
        assert 0.0 < errors[0] < part
        assert choked[0] < errors[1] < choked[1]


def test_the_error_of_the_local_exponent_vanishes_with_the_square_of_the_drop():
    errors = [abs(error("R134a", 12e5, 20.0, 1.0 - x)) for x in (0.05, 0.1, 0.2)]
    orders = np.diff(np.log(errors)) / math.log(2.0)
    assert orders == pytest.approx([2.0, 2.0], abs=0.35)  # the next order at a drop of 20 %
