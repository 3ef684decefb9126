"""Rodas4: order, stability, invariants, breakpoints, failures, on the flattened module that the models contain."""

import math

import numpy as np
import pytest
from each_row import each_row
from flat import Problem, integrate
from scipy.integrate import solve_ivp

from screwsim.numerics import rodas

KAPS_EPSILON = 0.05  # stiff against the time scale 1 of the solution, not so stiff that orders change


def kaps() -> Problem:
    """Kaps' problem: y_0 = exp(−2φ), y_1 = exp(−φ) for every ε; the quadrature is ∫ y_0 y_1 = (1 − exp(−3φ))/3."""
    e = KAPS_EPSILON

    def rates(phi, y):
        return (-(1 / e + 2) * y[0] + y[1] ** 2 / e, y[0] - y[1] - y[1] ** 2), (y[0] * y[1],)

    def slopes(phi, y):
        return ((-(1 / e + 2), 2 * y[1] / e), (1.0, -1.0 - 2 * y[1])), ((y[1], y[0]),)

    return Problem(rates, slopes)


def driven() -> Problem:
    """A nonlinear problem driven by the angle: y = 2 + cos φ, quadrature of y cos φ."""

    def rates(phi, y):
        return (-5.0 * (y[0] ** 2 - (2 + math.cos(phi)) ** 2) - math.sin(phi),), (y[0] * math.cos(phi),)

    def slopes(phi, y):
        return ((-10.0 * y[0],),), ((math.cos(phi),),)

    return Problem(rates, slopes)


def order(errors, counts) -> float:
    """Return the observed order: the slope of log error over log step number, least squares."""
    return -np.polyfit(np.log(counts), np.log(errors), 1)[0]


@pytest.fixture(scope="module")
def kaps_errors():
    """Return (numbers of steps, errors of the state, of the quadrature, of the dense output)."""
    counts = (16, 32, 64)
    errors = []
    for n in counts:
        path = integrate(kaps(), np.linspace(0.0, 1.0, n + 1), (1.0, 1.0))
        dense = max(
            abs(rodas.dense_value(0.4, *step[:, 1]) - math.exp(-(a + 0.4 / n)))
            for a, step in zip(path.times[:-1], path.dense, strict=True)
        )
        errors.append((abs(path.y[1] - math.exp(-1)), abs(path.q[0] - (1 - math.exp(-3)) / 3), dense))
    return counts, *np.array(errors).T


def test_states_converge_with_order_four(kaps_errors):
    counts, errors, _, _ = kaps_errors
    assert order(errors, counts) > 3.9  # 4 in theory; 0.1 for the terms of higher order at 16 steps


def test_quadratures_converge_with_order_four(kaps_errors):
    counts, _, errors, _ = kaps_errors
    assert order(errors, counts) > 3.9  # as the states: the quadrature is the method applied to the larger system


def test_dense_output_converges_with_order_three_or_more(kaps_errors):
    counts, _, _, errors = kaps_errors
    assert order(errors, counts) > 2.9  # 3 in theory


@pytest.mark.parametrize("what", ["state", "quadrature"])
def test_a_problem_driven_by_the_angle_converges_with_order_four(what):
    counts, errors = (8, 16, 32), []  # errors stay above 1e-9, that of the differences for ∂f/∂φ
    for n in counts:
        path = integrate(driven(), np.linspace(0.0, 1.0, n + 1), (3.0,))
        exact = 2 * math.sin(1) + 0.5 + 0.25 * math.sin(2)
        errors.append(abs(path.y[0] - 2 - math.cos(1)) if what == "state" else abs(path.q[0] - exact))
    assert order(errors, counts) > 3.9  # 4 in theory


def test_the_estimated_error_bounds_the_true_one():
    path = integrate(kaps(), (0.0, 1.0), (1.0, 1.0), rtol=1e-7, h=1e-3)
    assert abs(path.y[1] / math.exp(-1) - 1) < 1e-6  # the solution damps errors: a few times rtol, ten at most


def test_a_linear_invariant_is_kept_to_rounding():
    """Two states exchange, one flows out into the quadrature: their sum and the quadrature stay what they were."""

    def rates(phi, y):
        there, back, out = 300.0 * y[0] ** 2, 50.0 * y[1] * (2 + math.sin(phi)), 3.0 * y[1] ** 2
        return (back - there, there - back - out), (out,)

    def slopes(phi, y):
        there, back, out = 600.0 * y[0], 50.0 * (2 + math.sin(phi)), 6.0 * y[1]
        return ((-there, back), (there, -back - out)), ((0.0, out),)

    path = integrate(Problem(rates, slopes), (0.0, 2.0), (1.0, 2.0), rtol=1e-2, h=0.1)
    # 1e-12: rounding of about 30 steps whose terms are a hundred times the sum; rtol is ten orders larger
    assert abs(path.y.sum() + path.q[0] - 3.0) < 3e-12


def test_a_decay_far_faster_than_the_step_is_gone_after_one_step():
    path = integrate(
        Problem(lambda phi, y: ((-1e6 * y[0],), (0.0,)), lambda phi, y: (((-1e6,),), ((0.0,),))), (0.0, 1.0), (1.0,)
    )
    assert abs(path.y[0]) < 1e-5  # L-stable: R(z) → 0, of the order of 1/z = 1e-6


def test_growth_of_a_decaying_mode_never_exceeds_one():
    ratios = []
    for z in np.logspace(-2, 8, 41):
        decay = Problem(lambda phi, y, z=z: ((-z * y[0],), (0.0,)), lambda phi, y, z=z: (((-z,),), ((0.0,),)))
        ratios.append(abs(integrate(decay, (0.0, 1.0), (1.0,)).y[0]))
    assert max(ratios) <= 1.0


def test_a_bond_that_loosens_within_a_step_is_followed_once_landing_is_refused():
    """y is held to cos φ ever more loosely until 1, where nothing holds it: what it keeps is set just before."""

    def stiffness(phi):
        return 1e6 * (1.0 - phi) ** 2

    def rates(phi, y):
        return (-stiffness(phi) * (y[0] - math.cos(phi)),), (0.0,)

    def error(lands):
        problem = Problem(rates, lambda phi, y: (((-stiffness(phi),),), ((0.0,),)), lands=lands)
        return abs(integrate(problem, (0.0, 1.0), (1.0,), rtol=1e-6, h=1.0).y[0] - exact)

    exact = solve_ivp(lambda phi, y: rates(phi, y)[0], (0, 1), [1.0], method="Radau", rtol=1e-11, atol=1e-13).y[0, -1]
    blind, seeing = error(lambda h, J: True), error(lambda h, J: -h * J[0, 0] <= 10.0)
    assert seeing < 1e-5 < 0.1 * blind


def test_steps_land_on_every_breakpoint_exactly():
    breakpoints = (0.0, 0.1, 0.1 + 1e-6, 1 / 3, math.pi / 5, 1.0)
    path = integrate(kaps(), breakpoints, (1.0, 1.0), rtol=1e-3, h=0.07)
    assert set(breakpoints) <= set(path.times)  # bit for bit: laws change their branch there


def test_jumps_happen_once_at_each_breakpoint_but_the_last():
    seen = []
    problem = kaps()._replace(jump=lambda phi, y: seen.append(phi))
    integrate(problem, (0.0, 0.25, 0.5, 1.0), (1.0, 1.0), rtol=1e-3, h=0.07)
    assert seen == [0.0, 0.25, 0.5]


def test_the_step_size_survives_a_breakpoint_that_cuts_it_short():
    path = integrate(kaps(), (0.0, 0.5, 0.5 + 1e-6, 1.0), (1.0, 1.0), rtol=1e-3, h=0.02)
    after = path.times[path.times > 0.5 + 5e-7]
    assert after[1] - after[0] > 0.01  # the step before the breakpoints was larger than that


def test_rates_that_turn_nan_end_with_a_status_where_they_do():
    def rates(phi, y):
        return (-y[0] if phi < 0.6 else math.nan,), (0.0,)

    path = integrate(Problem(rates, lambda phi, y: (((-1.0,),), ((0.0,),))), (0.0, 1.0), (1.0,), rtol=1e-4, h=0.1)
    assert path.status == rodas.STEP_TOO_SMALL
    assert path.end == pytest.approx(0.6, abs=1e-6)  # steps shrink towards it until they are 1e-13
    assert np.all(np.isfinite(path.y))


def test_a_full_store_ends_with_a_status():
    assert integrate(kaps(), (0.0, 1.0), (1.0, 1.0), rtol=1e-9, h=1e-3, room=5).status == rodas.TOO_MANY_STEPS


# ---- the tableau, brought to the form of Hairer & Wanner (7.15)–(7.16): Γ = (1/γ − C)^(−1), α = A Γ, b = m Γ ----

GAMMA_MATRIX = np.linalg.inv(np.eye(6) / rodas.GAMMA - np.column_stack([rodas.C, np.zeros(6)]))
ALPHA = np.column_stack([rodas.A, np.zeros(6)]) @ GAMMA_MATRIX
B = np.append(rodas.A[5], 1.0) @ GAMMA_MATRIX
B_HAT = np.append(rodas.A[5], 0.0) @ GAMMA_MATRIX  # the embedded solution leaves the last stage out
BETA = ALPHA + GAMMA_MATRIX
ONE = np.ones(6)
CONDITIONS = {
    "1": (ONE, 1),
    "β": (BETA @ ONE, 1 / 2),
    "α²": ((ALPHA @ ONE) ** 2, 1 / 3),
    "ββ": (BETA @ BETA @ ONE, 1 / 6),
    "α³": ((ALPHA @ ONE) ** 3, 1 / 4),
    "α αβ": ((ALPHA @ ONE) * (ALPHA @ BETA @ ONE), 1 / 8),
    "β α²": (BETA @ (ALPHA @ ONE) ** 2, 1 / 12),
    "βββ": (BETA @ BETA @ BETA @ ONE, 1 / 24),
}
ROUNDING = 1e-12  # the coefficients have 16 digits and reach 34


@each_row("name", CONDITIONS)
def test_order_condition_up_to_order_four(name):
    vector, value = CONDITIONS[name]
    assert B @ vector == pytest.approx(value, abs=ROUNDING)


@pytest.mark.parametrize("name", ["1", "β", "α²", "ββ"])
def test_embedded_order_condition_up_to_order_three(name):
    vector, value = CONDITIONS[name]
    assert B_HAT @ vector == pytest.approx(value, abs=ROUNDING)


def test_nodes_are_row_sums_of_alpha():
    np.testing.assert_allclose(ALPHA @ ONE, rodas.NODES, atol=ROUNDING)


def test_d_are_row_sums_of_gamma():
    np.testing.assert_allclose(GAMMA_MATRIX @ ONE, rodas.D, atol=ROUNDING)


def test_quadrature_weights_are_those_of_the_method():
    np.testing.assert_allclose(rodas.BETA, B, atol=ROUNDING)
