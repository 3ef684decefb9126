"""Oil that the housing drags through gaps: how much, which way, whose work it is, and what it generates."""

import math

import numpy as np
import pytest
from each_row import each_row
from known_figures import known_solution
from scenes import FILM, FILMS, OIL_VOLUME, PUMPED_PORT, RADAU, SOLUBLE_RATE, change, closed, make, refusal, run

from screwsim.explain import explain
from screwsim.machine.geometry import wall_speeds
from screwsim.machine.protocol import END_GAP, TIP_GAP
from screwsim.model.slots import OIL_TEMPERATURE, PORT_STATE, PRESSURE
from screwsim.scene import load

ACCURACY = 3e-4  # numerics.accuracy
BALANCES = ("mass", "energy", "entropy", "oil_mass")
GAP, PASSAGE, LENGTH = 50e-6, 2e-3, 9.83 * 0.16
DENSITY, HEAT, TIP_SPEED = 1000.0, 2000.0, 0.08 * 100.0 * math.pi
PITCH, LIFE = 0.5 * math.pi, 4.0 * math.pi
ROOM = {**FILMS, **OIL_VOLUME}
SWINGING = {
    "operation.speed": "700 rpm",
    "effects.drive": {
        "motor_inertia": "0.8 kg m^2",
        "rotor_inertia": "0.12 kg m^2",
        "coupling": {"linear": {"spring": "5000 N m/rad"}, "damping": "6 N m s/rad"},
        "motor": {"law": "line", "slope": "30 N m s/rad", "torque_limit": "800 N m"},
    },
}
CASES = {
    "films": FILMS,
    "room": ROOM,
    "pumped, room": {**PUMPED_PORT, **ROOM},
    "flash over time, room": {**SOLUBLE_RATE, **ROOM},
    "swinging, room": {**ROOM, **SWINGING},
}
# one full gap whose oil hardly creeps: what passes is dragged; a dead volume that keeps its oil to the end
THICK = {
    "oil.transport": "carried",
    "oil.viscosity": "20e9 mPa s",
    "machine.volume.min": "20 cm^3",
    "effects.tip_leakage": {"gap": "50 um", "reading": "interface", **FILM, "filled_from": 1e-5, "wall_speed": 0.4},
}


# ---- plane flow between a wall at rest and one that moves ------------------------------------------------------------


@each_row("drop", [-5e5, -1e5, 0.0, 1e5, 5e5])
def test_a_wall_moves_half_its_speed_and_works_on_pressure_and_shear_alone(drop):
    """The profile of the velocity, summed: M256, M257; only the pressure's own flow heats, beside the shear."""
    mu, u, y = 20e-3, 10.0, (np.arange(20000) + 0.5) / 20000 * GAP
    velocity = u * y / GAP + drop / (2.0 * mu * PASSAGE) * y * (GAP - y)
    slope = u / GAP + drop / (2.0 * mu * PASSAGE) * (GAP - 2.0 * y)
    creeping = GAP**3 * drop / (12.0 * mu * PASSAGE)
    assert velocity.mean() * GAP == pytest.approx(0.5 * u * GAP + creeping, rel=1e-6)
    heat = mu * PASSAGE * GAP * (slope**2).mean()
    assert heat == pytest.approx(creeping * drop + mu * u**2 * PASSAGE / GAP, rel=1e-6)
    at_wall = mu * PASSAGE * u * (u / GAP - drop * GAP / (2.0 * mu * PASSAGE))  # power of the wall on the oil
    assert at_wall == pytest.approx(mu * u**2 * PASSAGE / GAP - 0.5 * u * GAP * drop, rel=1e-9, abs=1e-9)
    assert heat == pytest.approx(at_wall + velocity.mean() * GAP * drop, rel=1e-6)  # first law of the gap


def test_the_housing_slides_over_the_tips_of_a_profile_as_over_their_axial_length():
    """Both tips' helices as the rotors' geometry has them: across them goes the speed times the axial length."""
    machine = load("configs/rotors/a.yaml").machine
    profile = machine.profile
    lead, ratio = machine.rotor_length / profile.wrap_angle, machine.male_lobes / machine.female_lobes
    male, female = 0.5 * machine.rotor_diameter, 0.5 * profile.female_diameter
    slopes = math.hypot(male, lead), math.hypot(ratio * female, lead)
    across = lead * (male + ratio * female)
    found = wall_speeds(machine)
    assert found[TIP_GAP] * male * sum(slopes) == pytest.approx(across, rel=1e-12)
    # a lobe of the disc takes ω (r² − r_i²)/2 along between its root and its tip
    roots = profile.centre_distance - female, profile.centre_distance - male
    swept = 0.5 * (male**2 - roots[0] ** 2) + 0.5 * ratio * (female**2 - roots[1] ** 2)
    assert found[END_GAP] * male * (male - roots[0] + female - roots[1]) == pytest.approx(swept, rel=1e-12)


# ---- in the cycle ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", ["3000 rpm", "1500 rpm"])
def test_the_oil_that_is_dragged_is_that_of_a_sliding_wall(speed):
    cycle = run({**THICK, "operation.speed": speed}).cycle
    phi = np.arange(400.0, 590.0)
    behind = phi - 90.0
    area = 0.7 * GAP * LENGTH * np.where(behind <= 360.0, behind / 360.0, 2.0 - behind / 360.0)  # M19
    wall = 0.4 * TIP_SPEED * float(speed.removesuffix(" rpm")) / 3000.0
    found = -np.interp(phi, cycle["angle"], cycle["oil_flow_tip_leakage_trailing"])
    assert found == pytest.approx(0.5 * DENSITY * wall * area, rel=1e-3)


def test_the_drag_follows_a_speed_that_swings():
    """Behind a soft drive: the speed of each angle, which swings by some per cent, in place of the mean."""
    cycle = run({**THICK, **SWINGING}).cycle
    phi = np.arange(400.0, 590.0)
    behind, speed = phi - 90.0, np.interp(phi, cycle["angle"], cycle["speed"])
    area = 0.7 * GAP * LENGTH * np.where(behind <= 360.0, behind / 360.0, 2.0 - behind / 360.0)
    found = -np.interp(phi, cycle["angle"], cycle["oil_flow_tip_leakage_trailing"])
    assert speed.max() > 1.03 * speed.min()
    assert found == pytest.approx(0.5 * DENSITY * 0.4 * 0.08 * speed * area, rel=2e-3)


@pytest.mark.parametrize("case", CASES)
def test_mass_energy_entropy_and_oil_close(case):
    result = run(CASES[case])
    assert result.status == "ok"
    assert max(result.balance[name] for name in BALANCES) <= result.balance.bound


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_coupled_chambers_agree_with_histories(case):
    assert (
        change(run({**CASES[case], "numerics": {"closing": "coupled", "error": "none"}}), run(CASES[case])) < ACCURACY
    )


def test_radau_finds_the_same():
    assert change(run(ROOM), known_solution(make({**ROOM, "numerics": RADAU}))) < ACCURACY


def sides(scene):
    """Return what is dragged out of each leading port state [kg/s], and (T_o, p) there and behind, over angles [rad].

    The first rows are between chambers, by the angle of the leading one, the second of the last one and the line.
    """
    _, _, cycle = closed(make(scene))
    assert cycle.status == "ok"
    m, phi = cycle.trajectory, np.linspace(PITCH, LIFE, 63001)
    own, behind = (m.sample(angles)[0] for angles in (phi, phi - PITCH))
    between = phi, -m.oil_films(phi)[:, 1], own[:, [6, 1]].T, behind[:, [6, 1]].T
    beyond = np.linspace(LIFE - PITCH, LIFE, 9001)
    last, line = m.sample(beyond)[0], m.R[PORT_STATE:]
    p = line[PRESSURE]
    T = line[OIL_TEMPERATURE] - (p / (DENSITY * HEAT) if "effects.oil_volume" in scene else 0.0)
    there = np.full((2, len(beyond)), [[T], [p]])
    return between, (beyond, m.oil_films(beyond)[:, 0], there, last[:, [6, 1]].T)


@pytest.mark.parametrize("room", [{}, OIL_VOLUME], ids=["no room", "room"])
def test_dragged_oil_generates_by_its_temperature_alone(room):
    """M258 over a fine grid of angles, up and down the pressure; nothing is dissipated on the way."""
    scene = {**THICK, **room}
    result, expected, uphill = run(scene), 0.0, False
    for phi, q, (T_u, p_u), (T, p) in sides(scene):
        generated = HEAT * q * ((T_u - T) / T - np.log(T_u / T))
        assert q.min() >= -1e-9 * q.max()  # towards the chamber behind at all times
        assert generated.min() >= -1e-9 * generated.max()
        uphill = uphill or bool((p_u[q > 0.0] < p[q > 0.0] - 1e4).any())
        expected += np.trapezoid(generated, phi) / PITCH
    assert uphill  # the last chamber is above the line before it is empty
    assert result.ledger.entropy_generated_tip_leakage == pytest.approx(expected, rel=2e-3)
    assert abs(result.ledger.residue) < ACCURACY * result.performance.shaft_power


def test_the_walls_get_what_dragged_oil_loses_in_pressure():
    """M257: the lift power of oil that takes room is V̇ (p behind − p ahead), summed."""
    scene = {**THICK, **OIL_VOLUME}
    expected = sum(np.trapezoid(q * (p - p_u), phi) / PITCH for phi, q, (_, p_u), (_, p) in sides(scene)) / DENSITY
    found = run(scene).performance
    assert found.oil_lift_power == pytest.approx(expected, rel=1e-3)
    assert found.oil_lift_power < -3.0 * ACCURACY * found.shaft_power
    without = run({**scene, "effects.tip_leakage.wall_speed": 0}).performance
    assert without.oil_lift_power == 0.0


def test_dragged_oil_costs_flow():
    """What the housing drags back takes no room of its own unless oil has some; then the machine delivers less."""
    resting = run({**THICK, **OIL_VOLUME, "effects.tip_leakage.wall_speed": 0}).performance
    assert run({**THICK, **OIL_VOLUME}).performance.gas_mass_flow < (1.0 - 3.0 * ACCURACY) * resting.gas_mass_flow


# ---- limits ----------------------------------------------------------------------------------------------------------


def test_a_wall_that_hardly_moves_drags_nothing():
    slow, resting = (run({**FILMS, **at(speed)}) for speed in (1e-6, 0))
    assert change(slow, resting) < ACCURACY


def at(speed):
    """Return the walls' speeds of both gaps that have one."""
    return {f"effects.{gap}.wall_speed": speed for gap in ("tip_leakage", "end_face_leakage")}


def test_without_oil_nothing_is_dragged():
    dry = {"oil_supply.ratio": 0, "oil.transport": "carried"}
    assert change(run({**FILMS, **dry}), run(dry)) < ACCURACY


def test_next_to_no_oil_is_dragged_next_to_nowhere():
    """x² of it: a chamber gives what it has, and no more."""
    result = run({**FILMS, "oil_supply.ratio": 1e-6})
    assert result.status == "ok"
    assert result.cycle["oil_mass"].min() >= 0.0


# ---- what is said ----------------------------------------------------------------------------------------------------


def test_explain_names_the_speed_of_the_wall():
    text = " ".join(str(explain(make(FILMS))).split())
    assert "viscous film (M250-M252), dragged at 0.374 of the tip speed (M256)" in text
    assert "dragged" not in str(explain(make({**FILMS, **at(0)})))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"effects.interlobe_leakage.wall_speed": 0.5}, "wall_speed: has no meaning here: no housing wall"),
        ({"effects.tip_leakage": {"gap": "50 um", "wall_speed": 0.5}}, "wall_speed: has no meaning with model: nozzle"),
        ({"effects.tip_leakage.wall_speed": -1}, "effects.tip_leakage.wall_speed"),
    ],
)
def test_speeds_without_a_meaning_are_said(changes, words):
    assert words in refusal({**FILMS, **changes})
