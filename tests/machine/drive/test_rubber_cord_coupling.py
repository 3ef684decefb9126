"""Rubber-cord coupling: printed numbers, energy and torque, symmetry, slack cords, limits, strength."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row

from screwsim.codegen.modules import load
from screwsim.inputs.faults import UsageError
from screwsim.machine.drive import rubber_cord_coupling as law
from screwsim.machine.drive.rubber_cord_coupling import RubberCordCoupling
from screwsim.numerics.kernel import HEADER, flatten

DATA = Path(__file__).parents[3] / "validation" / "rubber_cord_coupling" / "printed.csv"
PRINTED = {
    row["name"]: float(row["value"])
    for row in csv.DictReader(line for line in DATA.read_text().splitlines() if line[0] != "#")
}
DEG = math.pi / 180.0
COUPLING = RubberCordCoupling()
UNEQUAL = replace(COUPLING, lean_plus=27.9 * DEG, lean_minus=33.8 * DEG)
FEW = (36.0 * DEG, 60, 0.200, 0.280)  # figure 3 of the source
TWISTS = (-3.0 * DEG, -0.4 * DEG, 0.2 * DEG, 1.4 * DEG, 5.0 * DEG)


def test_reach_of_a_cord_is_that_printed():
    found = law.crossings(*FEW)
    assert found.reach / DEG == pytest.approx(PRINTED["psi_max"], abs=0.005)
    assert found.ratio == pytest.approx(PRINTED["psi_max_over_pitch"], abs=0.0005)
    assert (found.least, found.most) == (3, 4)


def test_counted_crossings_are_those_printed():
    assert law.counted_crossings(*FEW, 0.0) == PRINTED["crossings_without_shift"]
    assert law.counted_crossings(*FEW, 3.0 * DEG) == PRINTED["crossings_with_half_a_pitch"]


@pytest.mark.parametrize("lean", [20.0, 30.8, 36.0, 50.0])
def test_counted_crossings_lie_between_least_and_most(lean):
    sizes = (lean * DEG, 120, 0.2, 0.28)
    found, pitch = law.crossings(*sizes), 2.0 * math.pi / 120
    counts = {law.counted_crossings(*sizes, share * pitch) for share in np.linspace(0.0, 0.999, 40)}
    assert counts == {found.least, found.most}


def test_counted_crossings_are_those_of_the_drawn_cords():
    """Segments in the plane, cut with each other; those that share their beginning are left out."""
    lean, cords, r_A, r_B = FEW
    shift, pitch = 2.0 * DEG, 2.0 * math.pi / cords
    span = law.central_angle(lean, r_A, r_B)

    def ends(start, way):
        return np.array([r_A * math.cos(start), r_A * math.sin(start)]), np.array(
            [r_B * math.cos(start + way), r_B * math.sin(start + way)]
        )

    a, b = ends(0.0, span)
    count = 0
    for j in range(-cords // 2, cords // 2):
        c, d = ends(shift + j * pitch, -span)
        s, t = np.linalg.solve(np.column_stack([b - a, c - d]), c - a)
        count += 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0
    assert count == law.counted_crossings(*FEW, shift)


def test_crossing_angle_falls_from_twice_the_lean_at_r_A():
    angles = [law.crossing_angle(r, 36.0 * DEG, 0.2) for r in np.linspace(0.2, 0.28, 9)]
    assert angles[0] == pytest.approx(72.0 * DEG)
    assert np.all(np.diff(angles) < 0.0)
    assert law.crossings(*FEW).reach == pytest.approx(72.0 * DEG - angles[-1])


def test_pitch_of_the_cords_is_that_printed():
    assert COUPLING.pitch / DEG == pytest.approx(PRINTED["pitch"], abs=0.0005)


def test_two_discs_carry_the_nominal_torque_below_the_measured_twist():
    twist = COUPLING.twist(PRINTED["nominal_torque"]) / DEG
    assert twist < PRINTED["twist_below"]
    assert twist == pytest.approx(1.41, abs=0.005)


def test_measured_twist_needs_more_than_the_lean_of_the_first_direction():
    """27.9° gives 1.56°: the measured bound speaks for the mean lean, or more."""
    soft = replace(COUPLING, lean_plus=27.9 * DEG, lean_minus=27.9 * DEG)
    assert soft.twist(PRINTED["nominal_torque"]) / DEG > PRINTED["twist_below"]


@pytest.mark.parametrize("lean", [-0.6, 0.3, 0.9])
def test_cord_leans_by_beta_at_its_inner_end(lean):
    phi = law.central_angle(lean, 0.2, 0.28)
    x, y = 0.28 * math.cos(phi) - 0.2, 0.28 * math.sin(phi)
    assert math.atan2(y, x) == pytest.approx(lean, abs=1e-14)
    assert law.cord_length(phi, 0.2, 0.28) == pytest.approx(math.hypot(x, y), rel=1e-14)


def test_lever_is_the_same_from_both_ends():
    """r_A sin α_A = r_B sin α_B, with α_B = α_A − Φ."""
    phi = law.central_angle(0.6, 0.2, 0.28) + 0.02
    alpha = math.atan2(0.28 * math.sin(phi), 0.28 * math.cos(phi) - 0.2)
    assert law.lever(phi, 0.2, 0.28) == pytest.approx(0.2 * math.sin(alpha), rel=1e-13)
    assert law.lever(phi, 0.2, 0.28) == pytest.approx(0.28 * math.sin(alpha - phi), rel=1e-12)


@each_row("theta", TWISTS)
@each_row(("whole", "slope"), [("energy", "torque"), ("torque", "stiffness")])
def test_torque_is_the_slope_of_the_energy_and_stiffness_that_of_the_torque(theta, whole, slope):
    h = 1e-5
    values = [getattr(UNEQUAL, whole)(theta + s * h) for s in (1, -1)]
    assert getattr(UNEQUAL, slope)(theta) == pytest.approx((values[0] - values[1]) / (2 * h), rel=1e-6)


def test_torque_is_zero_without_twist_and_turns_its_sign():
    assert COUPLING.torque(0.0) == 0.0
    for theta in (0.01, 0.05):
        assert COUPLING.torque(-theta) == pytest.approx(-COUPLING.torque(theta), rel=1e-12)


def test_slack_cords_carry_nothing():
    plus, minus = (law.central_angle(s * 0.5, 0.2, 0.28) for s in (1, -1))
    assert law.pull(law.strain(minus + 0.02, minus, 0.2, 0.28), 303.6, 6.684) == 0.0
    assert law.pull(law.strain(plus + 0.02, plus, 0.2, 0.28), 303.6, 6.684) > 0.0
    assert law.family_stiffness(0.02, 1.0, 0.2, 0.28, -0.5, 303.6, 6.684) == 0.0


def test_unequal_leans_make_the_directions_unequally_stiff():
    assert UNEQUAL.twist(1e4) > -UNEQUAL.twist(-1e4)


def test_torque_goes_with_discs_layers_and_cords():
    for name in ("discs", "layers", "cords"):
        twice = replace(COUPLING, **{name: 2 * getattr(COUPLING, name)})
        assert twice.torque(0.02) == pytest.approx(2.0 * COUPLING.torque(0.02), rel=1e-13)


def test_small_twists_see_a_linear_spring():
    """M = k N E (r_A sin α)²/l · Θ as Θ → 0, with an error of the order of b ε."""
    cords, r_A, r_B, lean, _, E, _ = COUPLING.numbers()
    length = law.cord_length(law.central_angle(lean, r_A, r_B), r_A, r_B)
    linear = cords * E * (r_A * math.sin(lean)) ** 2 / length
    assert COUPLING.stiffness(0.0) == pytest.approx(linear, rel=1e-12)
    assert COUPLING.torque(1e-7) == pytest.approx(1e-7 * linear, rel=1e-5)


@pytest.mark.parametrize("moment", [1.0, 11768.0, -11768.0, 35304.0])
def test_twist_carries_its_torque(moment):
    assert UNEQUAL.torque(UNEQUAL.twist(moment)) == pytest.approx(moment, rel=1e-9)


@pytest.mark.parametrize("direction", [1, -1])
def test_twist_at_a_strain_has_that_strain(direction):
    theta = UNEQUAL.twist_at_strain(0.1, direction)
    assert theta * direction > 0.0
    assert UNEQUAL.largest_strain(theta) == pytest.approx(0.1, rel=1e-12)


def test_state_says_when_cords_break_and_what_to_do():
    weak = replace(COUPLING, breaking_strain=0.05)
    limit = weak.strength_twist()
    assert weak.state(0.999 * limit) == "sound"
    assert "choose more discs" in weak.state(1.001 * limit)
    with pytest.raises(UsageError, match="choose more discs"):
        weak.twist(1.01 * weak.torque(limit))


def test_scatter_is_bounded_by_its_ends():
    """The torque grows with the lean over the measured range."""
    found = law.torque_band(COUPLING, 0.02, 21.8 * DEG, 41.9 * DEG)
    ends = [replace(COUPLING, lean_plus=x * DEG, lean_minus=x * DEG).torque(0.02) for x in (21.8, 41.9)]
    assert (found.least, found.largest) == pytest.approx(tuple(ends), rel=1e-12)
    assert found.least < found.mean < found.largest


def test_kernels_compile_to_the_same_numbers():
    kernels = (law.torque, law.stiffness, law.energy)
    module = load("\n\n".join([HEADER, *flatten(kernels).values()]), "coupling")
    for kernel in kernels:
        value = getattr(module, kernel.flat_name)(0.02, *COUPLING.numbers())
        assert value == pytest.approx(kernel(0.02, *COUPLING.numbers()), rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [({"outer_radius": 0.2}, "choose a larger one"), ({"lean_minus": math.pi / 2}, "choose a smaller angle")],
)
def test_bad_coupling_says_what_to_do(changes, words):
    (fault,) = law.check_coupling(replace(COUPLING, **changes))
    assert words in fault.what


def test_sound_coupling_has_no_fault():
    assert law.check_coupling(COUPLING) == []
