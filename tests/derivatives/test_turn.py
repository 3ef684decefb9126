"""Derivatives of a machine of one chamber: its valves meet seat and stop at angles that follow from the cycle."""

from pathlib import Path

import numpy as np
import pytest
from closed_points import closed_scene
from each_row import each_row
from tight import Tight

import screwsim
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import Series, problem_of
from screwsim.derivatives import collocation
from screwsim.derivatives.collocation import FINE, FINE_TURN, QUICK
from screwsim.derivatives.events import course_of
from screwsim.derivatives.solving import figures_of, scene_derivatives
from screwsim.model.impacts import LEAVES, SEATED, STOPPED
from screwsim.scene import value_at, with_values
from screwsim.solve.circuit import solve_with_surroundings, steady_state
from screwsim.study.uncertainty.point import sensitivities

CYLINDERS = Path(__file__).parents[2] / "configs" / "slider_crank"
AIR, R134A, ROD = CYLINDERS / "air.yaml", CYLINDERS / "r134a.yaml", CYLINDERS / "flexible_rod.yaml"
REEDS = "effects.reed_valves"
FIGURES = ("gas_mass_flow", "shaft_power", "discharge_temperature", "suction_valve_power", "peak_pressure")
PRESSURES = "operation.suction.pressure", "operation.discharge.pressure"
BOTH = "suction", "discharge"
STEP = 3e-4  # of a number
STEPS = 1e-9, 1e-11  # tolerances of the steps and of the change of cycles that are differenced
LEAST = 1e-2  # percent per percent: what counts for less errs as that
CLOSE = 1e-4  # of a slope: the references are good to 2e-5, the derivatives to 1e-5
ROUGH = 5e-3  # of a slope by few slices: worst of this machine 3e-4
PLACED = 1e-5  # rad: steps of 1e-6 place events as well
SUMS = 1e-5  # of slopes, whose laws hold exactly
ROUNDING = 1e-12  # of a lift
RATES = 1e-5  # of derivatives of the rates: differences of them


@each_row(
    ("file", "paths"),
    [
        (AIR, (f"{REEDS}.suction_mass", f"{REEDS}.seat_restitution", "machine.offset", "operation.speed")),
        (ROD, ("operation.speed", "effects.check_valves.discharge_area", "operation.discharge.pressure")),
    ],
)
def test_derivatives_are_those_of_tightly_closed_turns(file, paths):
    scene = screwsim.load(file)
    found = sensitivities(scene, paths)
    assert set(found.method.values()) == {"exact"}
    tight = tightly_closed(scene)
    at = figures_of(tight.base)
    for path in paths:
        above, below = (
            figures_of(tight.of(with_values(scene, {path: value_at(scene, path) * (1.0 + by)}))) for by in (STEP, -STEP)
        )
        slopes = {name: (above[name] - below[name]) / (2.0 * STEP * at[name]) for name in FIGURES}
        own = {name: found.derivatives[name][path] * value_at(scene, path) / at[name] for name in FIGURES}
        assert own == pytest.approx(slopes, abs=CLOSE * max(LEAST, *map(abs, slopes.values()))), path


def tightly_closed(scene):
    """Return tight cycles around a scene, with the regularisation of its solution."""
    series = Series()
    problem, search = steady_state(problem_of(scene, series), series)
    widths = solve_with_surroundings(problem, lease_for(problem), None, search).criteria.widths
    return Tight(problem, lease_for(problem), widths, *STEPS)


@pytest.fixture(scope="module")
def adiabatic():
    """Return the derivatives of a machine whose equations scale: without the wall, whose heat has its own law."""
    return sensitivities(screwsim.load(AIR, without=["cylinder_heat"]))


@each_row(("figure", "power"), [("gas_mass_flow", 1), ("shaft_power", 1), ("isentropic_efficiency", 0)])
def test_all_pressures_masses_and_springs_times_a_factor_make_as_much_more_of_the_same_cycle(adiabatic, figure, power):
    reeds = [f"{REEDS}.{side}_{what}" for side in BOTH for what in ("mass", "stiffness")]
    assert sum(adiabatic.relative(figure, path) for path in (*PRESSURES, *reeds)) == pytest.approx(power, abs=SUMS)


@each_row(("figure", "power"), [("gas_mass_flow", 1), ("shaft_power", 1), ("suction_valve_power", 1)])
def test_a_crank_as_much_faster_as_all_flows_with_reeds_as_much_quicker_makes_the_same_cycle(adiabatic, figure, power):
    flows = ["operation.speed", f"{REEDS}.flow_coefficient", "effects.ring_leakage.flow_coefficient"]
    masses = sum(adiabatic.relative(figure, f"{REEDS}.{side}_mass") for side in BOTH)
    together = sum(adiabatic.relative(figure, path) for path in flows) - 2.0 * masses
    assert together == pytest.approx(power, abs=SUMS)


def test_quick_derivatives_of_a_cylinder_are_nearly_the_fine_ones():
    paths = [f"{REEDS}.suction_mass", f"{REEDS}.stop_restitution", "operation.speed"]
    fine, quick = (sensitivities(screwsim.load(R134A), paths, FIGURES, fine=how) for how in (True, False))
    assert set(quick.method.values()) == {"quick"}
    for path in paths:
        slopes = {name: fine.relative(name, path) for name in FIGURES}
        close = ROUGH * max(LEAST, *map(abs, slopes.values()))
        assert {name: quick.relative(name, path) for name in FIGURES} == pytest.approx(slopes, abs=close), path


@pytest.fixture(scope="module")
def turn():
    """Return the collocated turn of the air compressor, its numbers and states installed."""
    found = closed_scene(screwsim.load(AIR), FINE)
    found.pitch.put(found.at)
    found.pitch.install(found.start, found.nodes)
    return found


def test_events_are_where_an_integrated_turn_has_them(turn):
    machinery, y = turn.pitch.machinery, np.where(np.abs(turn.start) < ROUNDING, 0.0, turn.start)  # at rest
    status, *_ = machinery.turn(y, FINE_TURN)
    machinery.lives.swap()
    integrated = course_of(machinery.trajectory)
    assert status == 0
    assert turn.pitch.events.course.events == integrated.events
    assert turn.pitch.events.course.angles == pytest.approx(integrated.angles, abs=PLACED)


def test_at_each_event_a_valve_is_at_its_end_and_turns_round_by_the_law_of_impact(turn):
    pitch, restitution = turn.pitch, 0.3
    stops, after = pitch.machinery.composition.stops, pitch.after(turn.nodes)
    kinds = {event.what for event in pitch.events.course.events}
    assert kinds == {SEATED, STOPPED, LEAVES}
    assert np.abs(pitch.open_events(turn.nodes)).max() < 1e-9
    for k, event, later in zip(pitch.passed, pitch.events.course.events, after, strict=True):
        position, speed = stops[event.pair]
        before = turn.nodes[k, -1]
        if event.what == LEAVES:
            assert np.array_equal(later, before)
            continue
        assert later[position] == (1.0 if event.what == STOPPED else 0.0)
        assert later[speed] == pytest.approx(0.0 if event.rests else -restitution * before[speed])


def test_what_rests_does_not_move_and_its_rates_depend_on_nothing(turn):
    pitch, slopes = turn.pitch, turn.slopes
    for pair, (position, speed) in enumerate(pitch.machinery.composition.stops):
        rests = pitch.events.course.modes_at(pitch.mesh.middles)[:, pair] != 0.0
        assert rests.any() and not rests.all()
        for state in (position, speed):
            assert not slopes.f[rests, :, state].any() and not slopes.by_states[rests, :, state].any()


@each_row("file", [AIR, R134A, ROD])
def test_the_rates_of_a_chamber_alone_have_exact_derivatives_by_its_states(file):
    cycle = closed_scene(screwsim.load(file), QUICK)
    pitch, Y, size = cycle.pitch, cycle.nodes, 1e-6
    for state in range(pitch.n):
        by = size * np.maximum(np.abs(Y[..., state]), 1e-3)
        above, below = Y.copy(), Y.copy()
        above[..., state] += by
        below[..., state] -= by
        slopes = (pitch.rates.at(above)[0] - pitch.rates.at(below)[0]) / (2.0 * by[..., None])
        own = cycle.slopes.by_states[..., state]
        inside = np.median(np.abs(slopes - own) / np.maximum(np.abs(own), np.abs(own).max(axis=(0, 1)) * 1e-6 + 1e-300))
        assert inside < RATES, state


def test_more_events_than_can_be_unknowns_leave_differences_with_the_reason(monkeypatch):
    monkeypatch.setattr(collocation, "MOST_EVENTS", 10)
    found = scene_derivatives(screwsim.load(AIR), {"operation.speed": 75.0})
    assert not found.derivatives
    assert "meet seat and stop, or leave them" in found.why


def test_a_reed_that_never_opens_leaves_the_rest_its_derivatives():
    """Pressed onto its seat it rests for the whole turn: gas comes past the rings alone."""
    scene = screwsim.load(AIR, [f"{REEDS}.suction_preload=2 kN"])
    found = sensitivities(scene, ["effects.ring_leakage.gap", f"{REEDS}.suction_mass"], ["gas_mass_flow"])
    assert set(found.method.values()) == {"exact"}
    of_rings, of_reed = (found.derivatives["gas_mass_flow"][path] for path in found.values)
    assert of_rings != 0.0
    assert of_reed == 0.0


def without_the_last(course):
    """Leave out when the last reed comes to rest on its stop, and all that follows."""
    last = max(k for k, event in enumerate(course.events) if event.what == STOPPED and event.rests)
    return course._replace(angles=course.angles[:last], events=course.events[:last])


def two_at_once(course):
    return course._replace(angles=np.append(course.angles[:1], course.angles[:-1]))


def never_at_rest(course):
    return course._replace(begins=(0.0, 0.0))


@each_row(
    ("other", "says"),
    [
        (without_the_last, "leaves a residual"),
        (two_at_once, "at the angle of another event"),
        (never_at_rest, "at one end of the turn"),
    ],
)
def test_events_that_are_not_those_of_the_cycle_leave_differences_with_the_reason(monkeypatch, other, says):
    monkeypatch.setattr(collocation, "course_of", lambda life: other(course_of(life)))
    found = scene_derivatives(screwsim.load(AIR), {"operation.speed": 75.0})
    assert not found.derivatives
    assert says in found.why


@each_row(("what", "says"), [(STOPPED, "meets its seat or stop"), (LEAVES, "leaves its seat or stop")])
def test_a_valve_that_passes_where_it_is_held_is_noticed(turn, what, says):
    """Its states are those of the turn, but it is held as if one event had not been."""
    pitch = turn.pitch
    course = pitch.events.course
    held, k = course.modes_at(pitch.mesh.middles), [event.what for event in course.events].index(what)
    pair = course.events[k].pair
    moved, states = held.copy(), turn.nodes.copy()
    if what == LEAVES:  # it rests on
        moved[pitch.passed[k] + 1 :, pair] = held[pitch.passed[k], pair]
    else:  # it flies on
        states[pitch.passed[k], -1, pitch.machinery.composition.stops[pair][0]] += 1e-3
    assert says in pitch.events.laws.missed(moved, states, pitch.numbers)
    assert pitch.events.missed(turn.nodes, pitch.mesh, pitch.numbers) == ""
