"""Flexible connecting rod: fundamental systems and their limit, end conditions, equilibrium, stability, safety."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row
from scipy.integrate import solve_bvp

from screwsim.machine.slider_crank import rod as law

DATA = Path(__file__).parents[3] / "validation" / "slider_crank" / "rod.csv"
DESIGN = {
    row["name"]: float(row["value"])
    for row in csv.DictReader(line for line in DATA.read_text().splitlines() if line[0] != "#")
}
ROD = law.FlexibleRod(
    **{name: DESIGN[name] for name in ("width", "thickness", "flexible", "length", "crank_radius")}, modulus=206e9
)
LOAD = law.SchmidtLoad(**{name: DESIGN[name] for name in ("bore", "p_min", "delta", "theta")})
ALPHA = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
LOADS = (-250.0, -165.0, -1.0, 0.0, 1.0, 128.0, 2000.0)


def bend_at(load, alpha=1.1, rod=ROD, points=201):
    return law.bend(rod, np.array([alpha]), np.array([load]), points)


@pytest.mark.parametrize("z", [0.0, 0.004, 0.023])
def test_fundamental_functions_are_the_three_printed_systems(z):
    K = 104.0
    press, pull, none = (law.fundamental(q, z) for q in (K * K, -K * K, 0.0))
    Kz = K * z
    assert (press.V3[0], press.V4[0]) == pytest.approx(((1 - math.cos(Kz)) / K**2, (Kz - math.sin(Kz)) / K**3))
    assert (pull.V3[0], pull.V4[0]) == pytest.approx(((math.cosh(Kz) - 1) / K**2, (math.sinh(Kz) - Kz) / K**3))
    assert (none.V3[0], none.V4[0]) == pytest.approx((z**2 / 2, z**3 / 6))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_both_branches_meet_the_third_at_no_load(sign):
    near, none = law.fundamental(sign * 1e-6, 0.023), law.fundamental(0.0, 0.023)
    for one, two in zip(near.V3 + near.V4, none.V3 + none.V4, strict=True):
        assert one == pytest.approx(two, abs=3e-8)  # q z² = 5e-10, and q z of V3'''


@pytest.mark.parametrize("x", [law._SMALL, -law._SMALL])
def test_series_and_closed_form_agree_where_they_meet(x):
    inside, outside = law.family(x * (1 - 1e-9)), law.family(x * (1 + 1e-9))
    np.testing.assert_allclose(inside, outside, rtol=1e-9)


@each_row("x", [-30.0, -0.04, 0.0, 0.01, 3.0, 9.0])
def test_family_is_its_sum(x):
    sums = [sum((-x) ** j / math.factorial(2 * j + n) for j in range(40)) for n in range(4)]
    np.testing.assert_allclose(law.family(x), sums, rtol=1e-11)


@each_row("load", LOADS)
def test_beam_keeps_its_end_conditions(load):
    b = bend_at(load)
    f, EI = ROD.head, ROD.stiffness
    assert b.deflection[0, 0] == b.slope[0, 0] == 0.0
    pin = b.deflection[0, -1] + f * b.slope[0, -1]
    assert pin == pytest.approx(ROD.crank_radius * math.sin(1.1), rel=1e-10)
    assert b.moment[0, -1] + f * b.shear[0, -1] == pytest.approx(0.0, abs=1e-12 * EI / f)


@each_row("load", LOADS)
def test_beam_is_that_of_a_boundary_value_solver(load):
    """E I V'''' = P V'' with the conditions at both ends, by collocation."""
    L, f, q = ROD.flexible, ROD.head, -load / ROD.stiffness * ROD.flexible**2
    z = np.linspace(0.0, 1.0, 21)

    def ends(a, b):
        pin = ROD.crank_radius * math.sin(1.1) / L
        return np.array([a[0], a[1], b[0] + f / L * b[1] - pin, b[2] + f / L * b[3]])

    found = solve_bvp(lambda _, y: np.array([y[1], y[2], y[3], -q * y[2]]), ends, z, np.zeros((4, 21)), tol=1e-9)
    b = bend_at(load, points=11)
    np.testing.assert_allclose(b.deflection[0], L * found.sol(np.linspace(0, 1, 11))[0], atol=1e-6 * L)
    np.testing.assert_allclose(
        b.moment[0], -ROD.stiffness / L * found.sol(np.linspace(0, 1, 11))[2], atol=1e-6 * np.abs(b.moment).max()
    )


@each_row("load", LOADS)
def test_moment_about_the_pin_balances_that_at_the_clamp(load):
    """Over the whole rod: clamp moment = side force times length, less the axial load at the pin's deflection."""
    b = bend_at(load)
    pin = ROD.crank_radius * math.sin(1.1)
    assert b.clamp_moment[0] == pytest.approx(b.side_force[0] * ROD.length - load * pin, rel=1e-9)


def test_moment_and_shear_are_derivatives_of_the_deflection():
    b = bend_at(-165.0, points=2001)
    h = b.z[1]
    second = np.diff(b.deflection[0], 2) / h**2
    np.testing.assert_allclose(-ROD.stiffness * second, b.moment[0, 1:-1], atol=1e-4 * np.abs(b.moment).max())
    middle = 0.5 * (b.shear[0, 1:] + b.shear[0, :-1])
    np.testing.assert_allclose(np.diff(b.moment[0]) / h, middle, atol=1e-5 * np.abs(b.shear).max())


def test_without_axial_load_it_is_the_cantilever_of_the_textbook():
    """A force at the pin: V = H z²(3 L − z)/(6 E I) and no other moment than H (L − z)."""
    b = bend_at(0.0)
    H = b.side_force[0]
    np.testing.assert_allclose(b.deflection[0], H * b.z**2 * (3 * ROD.length - b.z) / (6 * ROD.stiffness), rtol=1e-9)
    np.testing.assert_allclose(b.moment[0], -H * (ROD.length - b.z), rtol=1e-9)


def test_stress_of_bending_alone_is_far_below_that_of_a_clamped_head():
    """114 MPa at 200 GPa; clamped at both ends the beam would bend by 6 E I r/l²."""
    rod = law.FlexibleRod(**{**vars(ROD), "modulus": 200e9})
    found = np.abs(law.bend(rod, np.array([math.pi / 2]), np.array([0.0])).stress).max()
    clamped = 6.0 * rod.stiffness * rod.crank_radius / rod.flexible**2 * rod.thickness / 2 / rod.inertia
    assert found == pytest.approx(113.7e6, rel=1e-3)
    assert clamped == pytest.approx(783e6, rel=1e-3)


def test_stability_boundary_is_that_of_the_source():
    assert law.critical_gamma(0.505) == pytest.approx(6.51, abs=0.01)
    assert law.critical_gamma(1.0) == pytest.approx(4.493409457909064, rel=1e-13)  # tan γ = γ: clamped and pinned


def test_a_short_beam_under_a_long_head_buckles_at_pi_over_beta():
    """β → 0: the head turns freely about the pin, the beam's own β γ → π."""
    assert law.critical_gamma(1e-4) * 1e-4 == pytest.approx(math.pi, rel=1e-3)


@pytest.mark.parametrize("beta", [0.2, 0.5055, 0.9, 1.0])
def test_determinant_is_that_of_the_end_conditions(beta):
    for gamma in (0.5, 2.0, 5.0, 9.0):
        f, q = 1.0 - beta, gamma**2
        end = law.fundamental(q, beta)
        a3, a4 = end.V3[0] + f * end.V3[1], end.V4[0] + f * end.V4[1]
        m3, m4 = end.V3[2] + f * end.V3[3], end.V4[2] + f * end.V4[3]
        assert gamma**3 * (a3 * m4 - a4 * m3) == pytest.approx(law.determinant(beta, gamma), abs=1e-11)


def test_deflection_grows_without_bound_towards_the_buckling_load():
    critical = law.buckling_load(ROD)
    moments = [np.abs(bend_at(-share * critical).moment).max() for share in (0.9, 0.99, 0.999)]
    assert moments[1] / moments[0] == pytest.approx(10.0, rel=0.1)
    assert moments[2] / moments[1] == pytest.approx(10.0, rel=0.01)


@each_row("load", [-250.0, -165.0, -100.0, -60.0, -10.0, 0.0, 100.0])
def test_largest_moment_is_where_the_formula_says(load):
    b = bend_at(load, points=4001)
    at = b.z[np.argmax(np.abs(b.moment[0]))]
    assert at == pytest.approx(law.largest_moment_place(ROD, load), abs=2.0 * b.z[1])


def test_printed_place_of_the_largest_moment_leaves_the_rod_at_small_loads():
    """The finding behind the limit to z ≥ 0."""
    gamma = ROD.gamma(-10.0)
    assert 1.0 - math.atan(1.0 / (gamma * (1.0 - ROD.beta))) / (ROD.beta * gamma) < 0.0
    assert law.largest_moment_place(ROD, -10.0) == 0.0


def test_load_is_165_newtons_and_as_printed_8261():
    assert -LOAD.load(ALPHA).min() == pytest.approx(165.2, rel=1e-3)
    assert LOAD.printed_force(ALPHA).max() == pytest.approx(8261.0, rel=1e-3)
    np.testing.assert_allclose(-LOAD.load(ALPHA), LOAD.printed_force(ALPHA) * DESIGN["bore"], atol=1e-10)


def test_mean_of_the_pressure_is_the_second_term_of_the_force():
    assert np.mean(LOAD.pressure(ALPHA)) == pytest.approx(LOAD.mean_pressure, rel=1e-13)
    assert np.mean(LOAD.load(ALPHA)) == pytest.approx(0.0, abs=1e-10)
    assert LOAD.pressure(np.array(-1.16)) == pytest.approx(1.4e6)


def test_a_given_pressure_trace_loads_the_rod_as_the_formula_does():
    trace = law.pressure_load(LOAD.pressure(ALPHA), LOAD.mean_pressure, DESIGN["bore"])
    np.testing.assert_array_equal(trace, LOAD.load(ALPHA))


def test_printed_safety_is_within_reach_of_spring_steels():
    bending = law.bend(ROD, ALPHA, LOAD.load(ALPHA))
    low, high = (
        law.safety(bending, law.Fatigue(limit=limit, concentration=factor)).factor
        for limit, factor in ((400e6, 2.0), (700e6, 1.0))
    )
    assert low < DESIGN["safety_factor"] < high


def test_safety_is_limit_over_amplitude_where_nothing_else_counts():
    bending = law.bend(ROD, ALPHA, np.zeros_like(ALPHA))
    found = law.safety(bending, law.Fatigue(limit=500e6, concentration=1.0))
    assert (found.mean, found.z) == (pytest.approx(0.0, abs=1.0), 0.0)
    assert found.factor == pytest.approx(500e6 / bending.stress.max(), rel=1e-12)


def test_safety_does_not_know_which_dead_centre_is_zero():
    turned = law.bend(ROD, ALPHA, LOAD.load(ALPHA + math.pi))
    other = law.bend(ROD, ALPHA + math.pi, LOAD.load(ALPHA + math.pi))
    here = law.bend(ROD, ALPHA, LOAD.load(ALPHA))
    material = law.Fatigue()
    assert law.safety(other, material).factor == pytest.approx(law.safety(here, material).factor, rel=1e-12)
    assert law.safety(turned, material).factor == pytest.approx(law.safety(here, material).factor, rel=1e-9)


def test_contact_force_is_the_integral_of_its_linear_distribution():
    a, s = 0.027, np.linspace(-0.0135, 0.0135, 200001)
    for H, M in ((5.0, 0.01), (5.0, 0.0225), (5.0, 0.06), (0.0, 0.06), (-4.0, 0.03)):
        exact = np.trapezoid(np.abs(H / a + 12.0 * M * s / a**3), s)
        assert law.contact_force(np.array(H), np.array(M), a) == pytest.approx(exact, rel=1e-6)


def test_printed_friction_is_not_that_of_side_forces():
    """3 W would need a coefficient of friction above 2."""
    bending = law.bend(ROD, ALPHA, LOAD.load(ALPHA))
    unit = law.friction_power(bending, DESIGN["guide"], ROD.crank_radius, 100.0 * math.pi, 1.0)
    assert DESIGN["friction_power"] / unit > 2.0


def test_sound_rod_has_no_fault():
    assert law.check_rod(ROD, 165.2) == []


@pytest.mark.parametrize(
    ("changes", "compression", "words"),
    [
        ({"flexible": 0.05}, 0.0, "choose at most rod.length"),
        ({"crank_radius": 0.008}, 0.0, "choose a longer rod"),
        ({"thickness": 0.3e-3}, 165.0, "choose a thicker or a shorter rod"),
    ],
)
def test_bad_rod_says_what_to_do(changes, compression, words):
    (fault,) = law.check_rod(law.FlexibleRod(**{**vars(ROD), **changes}), compression)
    assert words in fault.what
