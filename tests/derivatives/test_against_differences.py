"""Derivatives against differences of tightly closed cycles: ideal and real gas, either closing, each kind of way."""

from pathlib import Path

import numpy as np
import pytest
from closed_points import closed_scene
from known import known
from near_arrays import assert_near
from tight import Tight, closed_tightly

import screwsim
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import problem_of
from screwsim.derivatives import collocation, solving
from screwsim.derivatives.around import implied_changes
from screwsim.derivatives.collocation import FINE
from screwsim.derivatives.directions import Directions
from screwsim.derivatives.response import unshifted_evaluation
from screwsim.derivatives.solving import SceneDerivatives, figures_of
from screwsim.model.slots import Q_WORK
from screwsim.scene import scene_text, with_values
from screwsim.scene.fields import value_at
from screwsim.study.uncertainty.point import sensitivities

CONFIGS = Path(__file__).parents[2] / "configs"
PLAIN = Path(__file__).parents[1] / "plain"
PAPER = CONFIGS / "paper" / "point.yaml"
STEP = 1e-4  # of a number
STEPS = 1e-7  # tolerance of the cycles' steps: differences are those of 1e-8 within a hundredth of OFF
IDEAL = (
    "effects.tip_leakage.gap",
    "operation.discharge.pressure",
    "machine.discharge_port.opens",  # a breakpoint that moves
    "oil_supply.ratio",  # through the injection alone
    "effects.mechanical.fraction",  # through the figures alone
)
REAL = ("operation.condensing_temperature", "effects.interlobe_leakage.gap")
FIGURES = ("isentropic_efficiency", "gas_mass_flow", "shaft_power", "discharge_temperature")
LEAST = 1e-2  # percent per percent: what counts for less errs as that
CORNERED = 1e-4  # slices of the default accuracy; without an end on the corner 5e-4 and more
EITHER_WAY = 3e-3  # the same; with all differences to one side 1.7e-2
TURNED = 5e-3  # the same; without short slices there 4e-2
PEAKED = 2e-3  # the same
PULSATING = 2e-3  # the same; with short slices at the pressure of the line itself five times the slope
DISSOLVED = 5e-4  # the same; without an end of a slice where the rate has its corner 3e-3
OTHER_SLICES = 1e-2  # of a change of 5e-6: slices of the same error end elsewhere
CLOSED_ALIKE = 1e-7  # of the unknowns: both cycles are closed to this
STOOD_IN = 5e-3  # of cycles at 1e-6; over half a percent of an angle, three degrees, 5e-2
WARMED = 2e-3  # the same; with the states left out of what the shaft takes 5e-2
SENT_BACK = 1e-2  # of it, by the regularisation of the default accuracy; with differences across a turning 5e-1
SWINGS = 2e-3  # of it, at the default accuracy: extremes are read from a cubic
ANEW = 5e-5  # of a slope: differences found again, whose cycles may take other steps
OFF = 5e-4  # of the largest of a number's: by the slices at the default accuracy of 3e-4; median 1e-6


@pytest.mark.parametrize(
    ("file", "way", "paths"),
    [
        (CONFIGS / "paper" / "point.yaml", "histories", IDEAL),
        (CONFIGS / "paper" / "point.yaml", "coupled", IDEAL[:1]),
        (PLAIN / "r134a.yaml", "auto", REAL),
    ],
)
def test_derivatives_are_those_of_closed_cycles(file, way, paths):
    scene = screwsim.load(file, [f"numerics.closing={way}"])
    paths = [path for path in paths if value_at(scene, path) is not None]
    found = sensitivities(scene, paths)
    for path in paths:
        slopes = all_differenced(scene, path, FIGURES, STEP, STEPS)
        close = OFF * max(LEAST, *map(abs, slopes.values()))
        assert found.method[path] == "exact"
        assert {name: found.relative(name, path) for name in FIGURES} == pytest.approx(slopes, abs=close), path


@pytest.mark.parametrize("accuracy", ["3e-4", "1e-5"])
def test_a_saturation_temperature_changes_what_flows_back_as_two_runs_say(accuracy):
    """It moves the line's pressure ten times as far as itself, by which no node may change side of a turning flow."""
    evaporating, figure = "operation.evaporating_temperature", "returned_gas_flow"
    scene = screwsim.load(CONFIGS / "ammonia" / "flooded.yaml", ["numerics.accuracy=1e-6"])
    T = value_at(scene, evaporating)
    low, high = (screwsim.simulate(with_values(scene, {evaporating: T + by})).performance[figure] for by in (-0.3, 0.3))
    asked = with_values(scene, {"numerics.accuracy": float(accuracy)})
    found = sensitivities(asked, [evaporating], [figure]).derivatives[figure][evaporating]
    assert found == pytest.approx((high - low) / 0.6, rel=SENT_BACK)


def test_what_oil_holds_responds_to_a_separator_as_warm_as_the_supply():
    """As the supply passes the separator's temperature its table of flashes goes on smoothly; it had a row more, and
    the efficiency a slope of +1.2 points per kelvin in place of -0.06."""
    condensing, figure = "operation.condensing_temperature", "isentropic_efficiency"
    scene = screwsim.load(CONFIGS / "r134a" / "separator.yaml", ["effects.separator.cooler=null"])
    found, T = sensitivities(scene, [condensing], [figure]), value_at(scene, condensing)
    tight = with_values(scene, {"numerics.accuracy": 1e-6})
    low, high = (screwsim.simulate(with_values(tight, {condensing: T + by})).performance[figure] for by in (-0.2, 0.2))
    assert found.method[condensing] == "exact"
    assert found.derivatives[figure][condensing] == pytest.approx((high - low) / 0.4, rel=WARMED)


@pytest.mark.parametrize(
    ("file", "path"),
    [("paper/point.yaml", "effects.tip_leakage.gap"), ("air/fixed_speed_7.yaml", "machine.profile.wrap_angle")],
)
def test_the_swing_of_the_gas_torque_has_the_derivatives_of_two_runs(file, path):
    """Its extremes lie between the ends of steps; off by 0.03 degrees they made it 5 % off."""
    figure, scene = "gas_torque_peak_to_peak", screwsim.load(CONFIGS / file, ["effects.gas_torque={}"])
    found, tight = sensitivities(scene, [path], [figure]), with_values(scene, {"numerics.accuracy": 1e-6})
    value = value_at(scene, path)
    sides = (with_values(tight, {path: value * (1.0 + by)}) for by in (-1e-3, 1e-3))
    low, high = (screwsim.simulate(each).performance[figure] for each in sides)
    assert found.method[path] == "exact"
    assert found.derivatives[figure][path] == pytest.approx((high - low) / (2e-3 * value), rel=SWINGS)


def test_the_zero_of_enthalpies_that_moves_with_the_suction_gas_is_no_response_of_the_cycle():
    """Decane's is high. Where each shifted scene kept a zero of its own, slopes were 18 to 56 % off."""
    changes = [
        *("gas.fluid=n-Decane", "gas.two_phase=equilibrium", "effects.separator=off"),
        "oil_supply.temperature=145 degC",
        *("operation.evaporating_temperature=90 degC", "operation.condensing_temperature=140 degC"),
        *("operation.superheat=10 K", "operation.subcooling=0 K", "numerics.accuracy=1e-6"),
    ]
    scene, path, names = screwsim.load(CONFIGS / "r134a" / "point.yaml", changes), "operation.superheat", FIGURES[2:]
    assert problem_of(scene).enthalpy_shift > 0.0
    found = sensitivities(scene, [path])
    assert found.method == {path: "exact"}
    sides = (screwsim.simulate(with_values(scene, {path: 10.0 + by})) for by in (-0.2, 0.2))
    below, above = (np.array([side.performance[name] for name in names]) for side in sides)
    assert [found.derivatives[name][path] for name in names] == pytest.approx((above - below) / 0.4, rel=WARMED)


def test_a_stated_temperature_of_what_flows_back_moves_the_cycle_by_itself():
    scene = screwsim.load(CONFIGS / "paper" / "point.yaml", ["operation.discharge.temperature=330 K"])
    path = "operation.discharge.temperature"
    found = sensitivities(scene, [path])
    value, problem = value_at(scene, path), problem_of(scene)
    machinery = lease_for(problem)
    sides = [
        figures_of(closed_tightly(problem_of(with_values(scene, {path: value * (1.0 + by)})), machinery))
        for by in (STEP, -STEP)
    ]
    slope = (sides[0]["shaft_power"] - sides[1]["shaft_power"]) / (2.0 * STEP * value)
    assert found.derivatives["shaft_power"][path] == pytest.approx(slope, rel=OFF)


def test_the_temperature_that_an_oil_cooler_keeps_moves_the_oil_that_comes():
    cooler = "effects.separator={cooler: {outlet_temperature: 310 K}}"
    scene = screwsim.load(PAPER, ["oil_supply.temperature=null", cooler])
    stated = screwsim.load(PAPER, ["oil_supply.temperature=310 K", "effects.separator={}"])
    found = sensitivities(scene, ["effects.separator.cooler.outlet_temperature"])
    by_oil = sensitivities(stated, ["oil_supply.temperature"])
    for figure in FIGURES:
        slope = by_oil.relative(figure, "oil_supply.temperature")
        assert abs(slope) > LEAST
        (path,) = found.values
        assert found.relative(figure, path) == pytest.approx(slope, rel=1e-4), figure


def test_derivatives_stand_where_the_oils_circuit_closes():
    """A solution leaves as much of it open as its accuracy allows: derivatives there are those of another oil."""
    found = closed_scene(
        screwsim.load(PAPER, ["oil_supply.temperature=null", "effects.separator={cooler: {duty: 2 kW}}"]), FINE
    )
    life, left = found.pitch.machinery.trajectory.copy(), asked_of_surroundings(found)
    assert left > solving.LARGEST_RESIDUAL
    assert asked_of_surroundings(solving.with_settled_surroundings(found, life)) <= solving.LARGEST_RESIDUAL


def test_the_cycle_of_settled_surroundings_begins_from_slices_and_states_of_the_one_before(monkeypatch):
    """It is that which is found anew, without placing slices anew."""
    found = closed_scene(
        screwsim.load(PAPER, ["oil_supply.temperature=null", "effects.separator={cooler: {duty: 2 kW}}"]), FINE
    )
    machinery, life = found.pitch.machinery, found.pitch.machinery.trajectory.copy()
    with monkeypatch.context() as refusing:
        refusing.setattr(collocation, "approach", None)  # places slices
        settled = solving.with_settled_surroundings(found, life)
    assert settled.pitch.problem is not found.pitch.problem
    machinery.put(life)
    settled.pitch.put(settled.at)
    anew = collocation.collocated(settled.pitch.problem, machinery, machinery.trajectory.copy())
    before, after, beside = (cycle.sums[Q_WORK] for cycle in (found, settled, anew))
    assert after - before == pytest.approx(beside - before, rel=OTHER_SLICES)
    assert_near(settled.unknowns_in, anew.unknowns_in, rel=CLOSED_ALIKE)


def asked_of_surroundings(cycle):
    return np.abs(implied_changes(unshifted_evaluation(Directions(cycle)))).max()


def test_differences_that_stand_in_go_over_no_more_of_an_angle_than_where_figures_are_straight(monkeypatch):
    scene, paths = screwsim.load(PAPER), ["machine.discharge_port.opens", "machine.discharge_port.phi_C"]
    figures = ["isothermal_efficiency", "shaft_power", "peak_pressure"]
    exact = sensitivities(scene, paths, figures)
    monkeypatch.setattr(
        "screwsim.study.uncertainty.slopes.scene_derivatives", lambda *_: SceneDerivatives({}, {}, "it is asked for")
    )
    found = sensitivities(scene, paths, figures, result=exact.result, progress=False)
    assert set(found.method.values()) == {"differences"}
    for path in paths:
        for figure in figures:
            assert found.relative(figure, path) == pytest.approx(exact.relative(figure, path), rel=STOOD_IN), path


def all_differenced(scene, path, figures, step, rtol):
    """Return the derivatives of figures in percent per percent, by tightly closed cycles (`known`: stored, or anew)."""

    def find():
        value, problem = value_at(scene, path), problem_of(scene)
        tight = Tight(problem, lease_for(problem), rtol=rtol)
        above, below = (figures_of(tight.of(with_values(scene, {path: value * (1.0 + by)}))) for by in (step, -step))
        at = figures_of(tight.base)
        return {figure: (above[figure] - below[figure]) / (2.0 * step * at[figure]) for figure in figures}

    what = f"{', '.join(figures)} by {path}, steps of {step:g}, {rtol:g}"
    return known("differences", what, scene_text(scene), find, ANEW)


def differenced(scene, path, figure, step, rtol):
    """Return the derivative of one figure so."""
    return all_differenced(scene, path, [figure], step, rtol)[figure]


def test_a_number_that_moves_the_corner_of_a_gap_has_its_derivative():
    scene = screwsim.load(PAPER)
    path, figure = "effects.blow_hole.opens", "shaft_power"
    slope = differenced(scene, path, figure, 2e-5, 1e-8)
    assert sensitivities(scene, [path]).relative(figure, path) == pytest.approx(slope, rel=CORNERED)


def test_a_number_that_moves_breakpoints_either_way_from_others_has_its_derivative():
    scene = screwsim.load(CONFIGS / "expander" / "point.yaml")
    path, figure = "machine.volume.phi_A", "isentropic_efficiency"  # moves 65 deg ahead, 655 deg back; both meet others
    slope = differenced(scene, path, figure, 2e-4, 1e-7)
    assert sensitivities(scene, [path]).relative(figure, path) == pytest.approx(slope, rel=EITHER_WAY)


def test_where_the_flow_of_a_gap_turns_round_is_resolved():
    scene = screwsim.load(CONFIGS / "rotors" / "a.yaml")
    path, figure = "operation.condensing_temperature", "isentropic_efficiency"
    slope = differenced(scene, path, figure, 2e-4, 3e-7)
    assert sensitivities(scene, [path]).relative(figure, path) == pytest.approx(slope, rel=TURNED)


def test_where_the_flow_turns_round_against_a_plenum_that_pulsates_is_resolved():
    plenums = "{discharge_volume: 3 l, suction_volume: 8 l, discharge_area: 15 cm^2, suction_area: 40 cm^2}"
    valve = "effects.plenums.discharge_valve={area: 12 cm^2, pressure: 0.1 bar}"
    scene = screwsim.load(PAPER, [f"effects.plenums={plenums}", valve, "operation.speed=3300 rpm"])
    path, figure = "machine.discharge_port.opens", "discharge_temperature"
    slope = differenced(scene, path, figure, 3e-5, 3e-9)
    assert sensitivities(scene, [path]).relative(figure, path) == pytest.approx(slope, rel=PULSATING)


def test_where_oil_begins_to_take_gas_up_at_another_rate_slices_end():
    changes = (
        "oil.transport=carried",
        "oil_supply={ratio: 1, temperature: 325 K}",
        "effects.oil_injection={opens: 365 deg, closes: 455 deg}",
        "effects.refrigerant_solubility={separator_temperature: 70 degC, flash_time: 5 ms, absorption_time: 50 ms}",
    )
    scene = screwsim.load(PAPER, changes)
    path, figure = "effects.oil_injection.closes", "flash_mass_flow"
    slope = differenced(scene, path, figure, 1e-4, 3e-8)
    assert sensitivities(scene, [path]).relative(figure, path) == pytest.approx(slope, rel=DISSOLVED)


def test_heat_of_a_motor_that_warms_the_suction_gas_follows_what_its_shaft_reads_of_the_states():
    stated = ("oil_supply.temperature=330 K", "effects.separator=off")
    at = "effects.refrigerant_solubility.separator_temperature"
    scene = screwsim.load(CONFIGS / "r134a" / "separator.yaml", [*stated, f"{at}=340 K"])
    assert scene.effects["motor"].parameters.cooling == "suction_gas"
    slope = differenced(scene, at, "intake_temperature", 1e-4, 1e-6)
    assert sensitivities(scene, [at]).relative("intake_temperature", at) == pytest.approx(slope, rel=WARMED)


def test_both_closings_agree_on_how_the_highest_pressure_follows_a_port():
    path, figure = "machine.discharge_port.opens", "peak_pressure"
    ways = [screwsim.load(PAPER, [f"numerics.closing={way}"]) for way in ("histories", "coupled")]
    found = [sensitivities(scene, [path]).relative(figure, path) for scene in ways]
    slope = differenced(ways[0], path, figure, 8e-5, 1e-8)
    assert found == pytest.approx([slope, slope], rel=PEAKED)
