"""Offset slider-crank: derivatives, dead centres, strokes, volume; limits and closed forms."""

from math import asin, cos, pi, sin, sqrt

import numpy as np
import pytest
from each_row import each_row
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from screwsim.codegen.modules import load
from screwsim.machine.slider_crank import kinematics as law
from screwsim.machine.slider_crank.cylinder import Cylinder, SliderCrank, check_slider_crank
from screwsim.numerics.kernel import HEADER, flatten

R, L, E = 4.4 / 48, 4.5 * 4.4 / 48, 0.015  # the example of the tolerance study
SIZES = [(R, L, E), (R, L, -E), (R, L, 0.0), (0.02, 0.035, 0.01)]
ANGLES = np.linspace(0.0, 2 * pi, 37)


def machine(**changes):
    values = {"bore": 0.1, "crank_radius": R, "rod_length": L, "offset": E, "clearance": 2e-5} | changes
    return SliderCrank(**values)


@pytest.mark.parametrize("sizes", SIZES)
def test_rod_has_its_length_at_every_angle(sizes):
    r, rod, e = sizes
    for alpha in ANGLES:
        along = law.position(alpha, *sizes) - r * cos(alpha)
        assert sqrt(along**2 + (r * sin(alpha) - e) ** 2) == pytest.approx(rod, rel=1e-14)


@pytest.mark.parametrize("sizes", SIZES)
def test_slope_is_that_of_the_source_with_its_angle_beta(sizes):
    r, rod, e = sizes
    for alpha in ANGLES:
        beta = asin((r * sin(alpha) - e) / rod)
        source = -r * sin(alpha) - r * cos(alpha) * sin(beta) / cos(beta)
        assert law.slope(alpha, *sizes) == pytest.approx(source, abs=1e-15)


@each_row("sizes", SIZES)
@each_row(("function", "derivative"), [("position", "slope"), ("slope", "second_slope")])
def test_derivatives_are_those_of_finite_differences(sizes, function, derivative):
    h = 1e-5  # error h²/6 of the third derivative (below 1 m): 2e-11, and rounding 1e-16/h = 1e-11
    for alpha in ANGLES:
        values = [getattr(law, function)(alpha + s * h, *sizes) for s in (1, -1)]
        assert getattr(law, derivative)(alpha, *sizes) == pytest.approx((values[0] - values[1]) / (2 * h), abs=1e-10)


def test_acceleration_is_the_second_derivative_in_time_of_a_speeding_crank():
    omega, domega, t, h = 75.4, 40.0, 0.013, 1e-5

    def x(time):
        return law.position(omega * time + 0.5 * domega * time**2, R, L, E)

    found = law.acceleration(omega * t + 0.5 * domega * t**2, omega + domega * t, domega, R, L, E)
    assert found == pytest.approx((x(t + h) - 2 * x(t) + x(t - h)) / h**2, abs=1e-4)  # rounding 1e-16·x/h²: 1e-5


def test_acceleration_of_a_very_long_rod_is_harmonic():
    """x'' → −r cos α, with an error r²/l."""
    found = [law.second_slope(a, R, 1e4, 0.0) for a in ANGLES]
    np.testing.assert_allclose(found, -R * np.cos(ANGLES), atol=1.01 * R**2 / 1e4)


@pytest.mark.parametrize("sizes", SIZES)
def test_dead_centres_are_where_the_piston_stands(sizes):
    top, bottom = law.top_angle(*sizes), law.bottom_angle(*sizes)
    assert law.slope(top, *sizes) == pytest.approx(0.0, abs=1e-16)
    assert law.slope(bottom, *sizes) == pytest.approx(0.0, abs=1e-16)
    highest = minimize_scalar(lambda a: -law.position(a, *sizes), bounds=(top - 1, top + 1), method="bounded")
    lowest = minimize_scalar(lambda a: law.position(a, *sizes), bounds=(bottom - 1, bottom + 1), method="bounded")
    assert law.stroke(*sizes) == pytest.approx(-highest.fun - lowest.fun, rel=1e-9)


def test_stroke_without_offset_is_twice_the_crank_and_grows_with_the_offset():
    assert law.stroke(R, L, 0.0) == pytest.approx(2 * R, rel=1e-14)
    assert law.stroke(R, L, -E) == law.stroke(R, L, E) > 2 * R


def test_mean_speed_without_offset_is_the_formula_of_the_source():
    """v = 4 r n: 4.4 m/s at 12 turns a second; with its offset of 15 mm the piston is 0.07 % faster."""
    assert machine(offset=0.0).surface_speed(2 * pi * 12.0) == pytest.approx(4.4, rel=1e-14)
    assert machine().surface_speed(2 * pi * 12.0) == pytest.approx(4.4 * 1.00070, rel=1e-5)


@pytest.mark.parametrize("sizes", SIZES)
def test_volume_is_clearance_at_the_top_and_all_at_the_bottom(sizes):
    r, rod, e = sizes
    cylinder = machine(crank_radius=r, rod_length=rod, offset=e)
    numbers = tuple(cylinder.numbers().values())
    (bottom,) = Cylinder(cylinder).volume_law().breakpoints
    assert law.volume(0.0, *numbers) == pytest.approx(2e-5, rel=1e-12)
    assert law.volume(2 * pi, *numbers) == pytest.approx(2e-5, rel=1e-11)
    assert law.volume(bottom, *numbers) == pytest.approx(2e-5 + cylinder.swept_volume, rel=1e-13)
    assert cylinder.clearance_ratio == pytest.approx(2e-5 / (pi / 4 * 0.01 * cylinder.stroke))


@pytest.mark.parametrize("sizes", SIZES)
def test_volume_is_the_integral_of_its_slope(sizes):
    r, rod, e = sizes
    numbers = machine(crank_radius=r, rod_length=rod, offset=e).numbers()
    numbers, rest = tuple(numbers.values()), tuple(v for name, v in numbers.items() if name != "V_c")
    for phi in (0.3, 2.0, 4.5):
        part = quad(lambda angle: law.volume_slope(angle, *rest), 0.0, phi, epsrel=1e-12)[0]
        assert law.volume(phi, *numbers) == pytest.approx(2e-5 + part, rel=1e-12)


def test_offset_makes_suction_and_compression_unequally_long():
    assert Cylinder(machine(offset=0.0)).injection_angle == pytest.approx(pi, abs=1e-15)
    assert Cylinder(machine()).injection_angle - pi == pytest.approx(asin(E / (L - R)) - asin(E / (L + R)), rel=1e-13)


def test_numbers_of_the_machine_are_the_arguments_of_the_law():
    names = tuple(machine().numbers())
    assert law.volume.arguments == ("phi", *names)
    assert set(law.volume_slope.arguments) <= {"phi", *names}


def test_kernels_compile_to_the_same_numbers():
    module = load("\n\n".join([HEADER, *flatten((law.volume, law.volume_slope)).values()]), "slider_crank")
    numbers = tuple(machine().numbers().values())
    assert getattr(module, law.volume.flat_name)(1.2, *numbers) == pytest.approx(law.volume(1.2, *numbers), rel=1e-14)


def test_a_machine_that_can_turn_has_no_fault():
    assert check_slider_crank(machine()) == []


@pytest.mark.parametrize(
    ("changes", "path", "remedy"),
    [
        ({"rod_length": R}, "machine.rod_length", "choose a longer rod"),
        ({"offset": L - R}, "machine.offset", "choose an offset below 320.833 mm"),
        ({"offset": -0.4}, "machine.offset", "or a longer rod"),
    ],
)
def test_a_machine_that_cannot_turn_says_where_and_what_to_do(changes, path, remedy):
    (fault,) = check_slider_crank(machine(**changes))
    assert fault.path == path
    assert remedy in fault.what
    assert "\n" not in fault.what
