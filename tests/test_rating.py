"""The formulas by which air packages are rated: ISO 1217's isentropic power, 10 CFR 431.345."""

from math import log

import pytest
from each_row import each_row
from scipy.integrate import quad

from screwsim.effects.parts.rating import (
    CFM,
    HORSEPOWER,
    PSI,
    STANDARDS,
    WEIGHTS,
    isentropic_power,
    outside_scope,
    part_load_efficiency,
)

FIXED, VARIABLE = (-0.00928, 0.13911, 0.27110), (-0.01549, 0.21573, 0.00905)  # as the regulation prints them
PRINTED = {
    ("fixed", "air"): (FIXED, -15.0, 0.0),
    ("variable", "air"): (VARIABLE, -10.0, 0.0),
    ("fixed", "liquid"): (FIXED, -15.0, 0.02349),
    ("variable", "liquid"): (VARIABLE, -15.0, 0.02349),
}


@pytest.mark.parametrize("kind", PRINTED)
def test_least_efficiency_is_the_regulations(kind):
    (a, b, c), d, more = PRINTED[kind]
    L = log(0.4719 * 735.2)
    curve = a * L * L + b * L + c
    # 0.4719 is 0.47195 rounded: 1e-4 of the flow, by the slope of the curves 1e-5 of the efficiency
    least = STANDARDS[kind].least(735.2 * CFM)
    assert least == pytest.approx(more + curve + (1.0 - curve) * d / 100.0, rel=1e-5)


@pytest.mark.parametrize("kind", PRINTED)
def test_without_a_loss_reduction_the_reference_curve_is_what_is_asked(kind):
    _, d, more = PRINTED[kind]
    flow = 735.2 * CFM
    curve, least = STANDARDS[kind].reference(flow), STANDARDS[kind].least(flow)
    assert 1.0 - (least - more) == pytest.approx((1.0 - curve) * (1.0 - d / 100.0), rel=1e-12)


def test_isentropic_power_is_the_integral_of_volume_over_pressure():
    p_1, p_2, flow = 1e5, 9.62e5, 0.3
    work, error = quad(lambda p: flow * (p_1 / p) ** (1.0 / 1.4), p_1, p_2)
    assert isentropic_power(flow, p_1, p_2) == pytest.approx(work, abs=10.0 * error)


def test_part_load_is_a_mean_that_an_even_efficiency_leaves():
    assert part_load_efficiency(dict.fromkeys(WEIGHTS, 0.7)) == pytest.approx(0.7, rel=1e-15)
    assert part_load_efficiency({0.4: 0.6, 0.7: 0.7, 1.0: 0.8}) == pytest.approx(0.25 * 0.6 + 0.5 * 0.7 + 0.25 * 0.8)


@each_row(
    ("flow", "gauge", "motor", "words"),
    [
        (500, 100, 125, ""), (35, 75, 9, ""), (34, 100, 9, "below 35 cfm"), (34, 100, 10.01, ""),
        (1251, 100, 201, "above 1250 cfm"), (1251, 100, 199, ""), (1249, 100, 300, ""),
        (500, 74, 125, "psi"), (500, 201, 125, "psi"),
    ],
)  # fmt: skip
def test_the_regulation_covers_what_it_says(flow, gauge, motor, words):
    """Full-load flow [cfm], gauge pressure [psi] and rated power [hp] of 10 CFR 431.344 (a)."""
    found = outside_scope(flow * CFM * (1.0 + 1e-9), gauge * PSI, motor * HORSEPOWER)
    assert words in found
    assert bool(found) == bool(words)
