"""Valves of new cylinders: velocity of the gas (S36), reeds that follow it (S37), and what they cost."""

import math
from dataclasses import replace

import numpy as np
import pytest
from folders import ROOT

import screwsim
from screwsim.effects.reed_valves import Parameters
from screwsim.effects.reed_valves import opened as opening
from screwsim.inputs.faults import UsageError
from screwsim.study.validation import sibling
from screwsim.template import new_scene, request_of, valves

new_valves = sibling(ROOT / "docs" / "tools" / "new_valves.py")
PISTON, SPEED = 2e-3, 150.0  # [m²], [rad/s]
GAS = {"pressure": 3e5, "k": 1.2, "sound": 200.0}
GASES = [
    {"fluid": "R404A", "condition": "-10/40 degC, 28.3 K", "speed": "2950 rpm"},
    {"fluid": "Ammonia", "condition": "-10/35 degC, 10 K"},
    {"fluid": "CO2", "condition": "-10/35 degC, 10 K"},
    {"displacement": "60 m^3/h"},
    {"speed": "725 rpm"},
]


@pytest.mark.parametrize(("molar_mass", "velocity"), [(20.0, 18.2), (7.0, 35.6)])
def test_the_velocities_of_the_source_are_a_twentieth_of_the_speed_of_sound(molar_mass, velocity):
    """At 300 K and κ = 1.3, for the source does not give the states: 0.045 and 0.052."""
    sound = math.sqrt(1.3 * 8314.46 / molar_mass * 300.0)
    assert velocity / sound == pytest.approx(valves.MACH, rel=0.1)


@pytest.mark.parametrize("piston_speed", [0.5, 1.0, 1.7])
def test_where_the_head_has_room_the_swept_flow_passes_at_a_twentieth_of_the_speed_of_sound(piston_speed):
    found = valves.valve(PISTON, piston_speed, SPEED, **GAS)
    assert found.area < valves.ROOM * PISTON
    assert piston_speed * PISTON / found.area == pytest.approx(valves.MACH * GAS["sound"]) == found.velocity


def test_two_reeds_side_by_side_are_no_wider_than_the_bore():
    found = valves.valve(PISTON, 4.0, SPEED, **GAS)
    bore = math.sqrt(4.0 * PISTON / math.pi)
    reed = math.sqrt(4.0 * found.area / math.pi) * valves.WIDTH / valves.PORT  # of one port
    assert 2.0 * reed == pytest.approx(bore)
    assert found.mach > valves.MACH
    assert found.mach == pytest.approx(4.0 / valves.ROOM / GAS["sound"])


@pytest.mark.parametrize("piston_speed", [0.5, 4.0])
def test_at_its_stop_the_spring_is_as_strong_as_the_gas_at_its_mean_velocity(piston_speed):
    """Bernoulli over the open area of the effect's own kernel, for an ideal gas: ρ = κ p/a²."""
    found = valves.valve(PISTON, piston_speed, SPEED, **GAS)
    open_share = opening(1.0, found.perimeter * found.stop / found.area)
    coefficient = next(
        each.default for name, each in Parameters.__dataclass_fields__.items() if name == "flow_coefficient"
    )
    jet = found.velocity / (open_share * coefficient)
    density = GAS["k"] * GAS["pressure"] / GAS["sound"] ** 2
    assert found.stiffness * found.stop / found.area == pytest.approx(0.5 * density * jet**2)


def test_a_reed_swings_ten_times_a_turn_and_is_a_scaled_cantilever():
    """k ∝ E b h³/l³ and m ∝ ρ b h l: two ways to the thickness over the known reed's agree."""
    found = valves.valve(PISTON, 4.0, SPEED, **GAS)
    frequency = math.sqrt(found.stiffness / found.mass) / (2.0 * math.pi)
    assert frequency == pytest.approx(10.0 * SPEED / (2.0 * math.pi)) == found.frequency
    scale, ports = found.bore / valves.PORT, found.area / (0.25 * math.pi * found.bore**2)
    bending = valves.YOUNG * valves.WIDTH * valves.THICKNESS**3 / 12.0
    known = 6.0 * bending / (valves.ARM**2 * (3.0 * valves.LENGTH - valves.ARM))
    mass = valves.DENSITY * valves.WIDTH * valves.LENGTH * valves.THICKNESS / 3.0
    by_spring = (found.stiffness / ports / known) / scale  # (h/d over the known)³
    by_mass = (found.mass / ports / mass) / scale**3  # h/d over the known
    assert ports > 1.0
    assert by_mass**3 == pytest.approx(by_spring)


def test_the_known_reed_is_a_third_as_strong_as_its_gas_at_the_mean_velocity():
    """R410A of 33.1 kg/m³, bore and stroke of 20 mm, 60 Hz; 310 N/m, 0.0515 g and 390 Hz, as the page says."""
    k, frequency = valves._stiffness(), valves.known_frequency()
    assert (round(k), round(frequency)) == (310, 390)
    assert k / (2.0 * math.pi * frequency) ** 2 == pytest.approx(0.0515e-3, rel=1e-3)
    velocity = 2.0 * 0.02 * 60.0 * (0.02 / valves.PORT) ** 2
    gas = 0.5 * 33.1 * (velocity / (valves.FLOW_COEFFICIENT * valves.FULLY_OPEN)) ** 2
    assert valves._spring() / gas == pytest.approx(1.0 / 3.0, rel=0.03)
    assert frequency / 60.0 == pytest.approx(6.5, rel=0.01)


@pytest.mark.parametrize("stated", GASES, ids=lambda stated: "-".join(stated.values()).replace(" ", ""))
@pytest.mark.parametrize("side", ["suction", "discharge"])
def test_a_reed_of_the_thickness_told_has_the_spring_of_its_scene(stated, side):
    """k of all ports' reeds: each a cantilever of that thickness, in proportion to the known one."""
    scene = new_valves.scene_of(stated)
    own = scene.effects["reed_valves"].parameters
    area, stop, stiffness = (getattr(own, f"{side}_{name}") for name in ("port_area", "stop", "stiffness"))
    scale, h = 4.0 * stop / valves.PORT, 1e-3 * new_valves.thickness(scene, side)
    width, length, arm = (scale * each for each in (valves.WIDTH, valves.LENGTH, valves.ARM))
    one = 6.0 * valves.YOUNG * width * h**3 / 12.0 / (arm**2 * (3.0 * length - arm))
    assert one * area / (math.pi * (2.0 * stop) ** 2) == pytest.approx(stiffness, rel=0.02)  # texts have three digits


@pytest.mark.parametrize("side", ["suction", "discharge"])
def test_the_moving_mass_over_the_port_gives_the_thickness_of_a_reed_whatever_its_free_length(side):
    """m/A = φ ρ h, φ a third of the reed's area over that of its port: 1.54 of the known one."""
    share = valves.LENGTH * valves.WIDTH / 3.0 / (0.25 * math.pi * valves.PORT**2)
    assert share == pytest.approx(1.54, abs=0.005)
    scene = new_valves.scene_of({})
    own = scene.effects["reed_valves"].parameters
    area, mass = (getattr(own, f"{side}_{name}") for name in ("port_area", "mass"))
    h = 1e-3 * new_valves.thickness(scene, side)
    assert mass / area == pytest.approx(share * valves.DENSITY * h, rel=0.02)  # texts have three digits


def test_a_small_valve_of_dense_gas_has_one_port_and_a_faster_reed():
    found = valves.valve(7e-4, 1.2, SPEED, pressure=90e5, k=1.25, sound=290.0)
    assert found.area == pytest.approx(0.25 * math.pi * found.bore**2)
    assert found.frequency > 10.0 * SPEED / (2.0 * math.pi)


@pytest.mark.parametrize("stated", GASES, ids=lambda stated: "-".join(stated.values()).replace(" ", ""))
def test_reeds_open_once_and_shut_before_much_flows_back(stated):
    """Over gases, sizes and speeds: no flutter, backflow below 2 %, shut 35° after the dead centre at the latest."""
    result = screwsim.simulate(new_valves.scene_of(stated))
    assert (result.status, result.warnings) == ("ok", ())
    for side in ("suction", "discharge"):
        lift = np.asarray(result.cycle[f"{side}_valve_lift"])
        assert np.count_nonzero((lift[1:] > 1e-4) & (lift[:-1] <= 1e-4)) == 1
        back, late = new_valves.backflow(result, side)
        assert 0.0 <= back < 0.02 and late < 35.0
        assert lift.max() > 0.9


@pytest.mark.parametrize(
    ("condition", "side", "mass", "told"),
    [
        (("-30 degC", "40 degC"), "discharge", 3.0, True),  # it shuts after the dead centre
        (("-20 degC", "30 degC"), "discharge", 1.0, False),
        (("-30 degC", "40 degC"), "discharge", 1.0, False),
        (("-10 degC", "40 degC"), "suction", 60.0, True),
    ],
)
def test_a_reed_through_which_much_flows_back_is_told_with_how_much(condition, side, mass, told):
    scene = new_valves.scene_of({"fluid": "R404A", "condition": "-10/40 degC, 20 K"})
    own = getattr(scene.effects["reed_valves"].parameters, f"{side}_mass")
    temperatures = (f"operation.{name}_temperature" for name in ("evaporating", "condensing"))
    changes = dict(zip(temperatures, condition, strict=True))
    result = screwsim.simulate(scene.with_({**changes, f"effects.reed_valves.{side}_mass": f"{1e3 * mass * own} g"}))
    back, _ = new_valves.backflow(result, side)
    said = [each for each in result.warnings if f"flowed back through the {side} valve" in each]
    assert result.status == "ok" and bool(said) is told is (back > 0.05)
    if told:
        assert 1e-2 * float(said[0].partition("%")[0]) == pytest.approx(back, abs=0.01)  # in whole percent


@pytest.mark.parametrize("stated", [GASES[1], GASES[3], {}], ids=["ammonia", "60 m^3/h", "R134a"])
def test_the_gas_that_a_reed_displaces_damps_it_less_than_is_written(stated):
    """S38 by a small step of the flow itself: port and curtain in series, the reed sweeping its port's area between."""
    scene = new_valves.scene_of(stated)
    own, rest = scene.effects["reed_valves"].parameters, scene.machine.swept_volume * scene.operation.speed / math.pi
    for side in ("suction", "discharge"):
        area, stop, stiffness, mass = (
            getattr(own, f"{side}_{name}") for name in ("port_area", "stop", "stiffness", "mass")
        )
        drop = stiffness * stop / area  # over port and curtain, of which the curtain's presses on the reed
        swept, one = 1e-6 * rest, 0.5 * drop / rest**2  # of the flow; of each, over its flow squared
        # port + curtain: q² + (q - swept)² = 2 rest²
        port = 0.5 * (swept + math.sqrt(4.0 * rest**2 - swept**2))
        force = area * one * (rest**2 - (port - swept) ** 2)
        expected = force / (swept / area) / (2.0 * math.sqrt(stiffness * mass))
        found = new_valves.gas_damping(scene, side)
        assert found == pytest.approx(expected, rel=1e-4)
        assert 0.01 < found < own.damping_ratio == valves.DAMPING_RATIO


def test_valves_cost_little_where_the_head_has_room_and_more_where_it_has_none():
    """Loss goes as the velocity squared: ammonia at 1450 rpm has room, R404A at 2950 rpm has none."""
    small, large = (
        screwsim.simulate(new_valves.scene_of(stated), trace=False).performance for stated in (GASES[1], GASES[0])
    )
    shares = [(each.suction_valve_power + each.discharge_valve_power) / each.indicated_power for each in (small, large)]
    assert 0.01 < shares[0] < 0.025 < shares[1] < 0.1


@pytest.mark.parametrize("stated", [{"fluid": "R134a"}, {"fluid": "R404A", "condition": "-10/40 degC, 28.3 K"}])
def test_a_cylinder_whose_valves_would_cost_more_than_a_tenth_is_refused_and_a_lower_speed_is_the_remedy(stated):
    """At 60 m³/h and 2950 rpm they took 16 and 17 % of the indicated power, as the room in the head decides."""
    with pytest.raises(UsageError, match=r"leaves no room for valves at 5\.47 m/s of its piston \(a lower --speed\)$"):
        new_valves.scene_of({**stated, "displacement": "60 m^3/h", "speed": "2950 rpm"})
    found = screwsim.simulate(
        new_valves.scene_of({**stated, "displacement": "60 m^3/h", "speed": "1200 rpm"}), trace=False
    ).performance
    assert 0.03 < (found.suction_valve_power + found.discharge_valve_power) / found.indicated_power < 0.1


def test_the_machine_that_is_compared_with_ratings_is_the_one_that_is_written_with_the_motor_of_a_whole_machine():
    asked = request_of(fluid="R404A", speed="1750 rpm", condition="-10/40 degC, 28.3 K")
    written = screwsim.loads(new_scene("reciprocating", asked))
    compared = screwsim.load(ROOT / "validation" / "energyplus" / "machine.yaml")
    assert (compared.machine, compared.operation, compared.gas) == (written.machine, written.operation, written.gas)
    (own, motor), (other, whole) = (
        ({name: each.parameters for name, each in scene.effects.items() if name != "motor"}, scene.effects["motor"])
        for scene in (written, compared)
    )
    assert own == other
    assert whole.parameters == replace(motor.parameters, efficiency=0.90, efficiency_class="stated")
