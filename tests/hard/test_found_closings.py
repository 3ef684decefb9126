"""Closings that once failed on random scenes: each is held against what made it fail."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from effects_space import scene_of
from fuzz_space import changes, drawn
from known_figures import ANEW, known_finer
from scenes import closed, make
from true_error import warns

from screwsim.cycle.coordinates import logarithms
from screwsim.cycle.feedback import image, set_unknowns
from screwsim.cycle.guess import install_first_guess, lease_for
from screwsim.cycle.mixing import MixingRule
from screwsim.cycle.problem import ClosingTask, problem_of
from screwsim.cycle.search import FALLBACK_NAME, LARGEST_RTOL, newton_search, search_after_pitches
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.figures.errors import relative_errors, worst
from screwsim.model import leases
from screwsim.model.all_chambers import install_pitch, moved_on
from screwsim.numerics.integrators import check_of
from screwsim.outputs import Figures, Result
from screwsim.scene import loads, with_values
from screwsim.simulate import simulate
from screwsim.solve.accurately import solve
from screwsim.solve.stability import UNSTABLE_GROWTH
from screwsim.template import new_scene, request_of

SEED = 1
PITCHES, TURNED = 23, 10
LEFT_BY_PITCHES, AHEAD_OF_ITS_LINE, LITTLE_OIL = 2275, 14324, 16300  # indices of scenes of that seed
DELIVERS_LITTLE = 13950
CIRCUIT = "oil circuit", 310, 8
FLASHES = "oil circuit, solubility", 704, 2
BARELY_DELIVERS = "plenums, carried", 401, 14


def scene(index):
    return make(changes(*drawn(SEED, index)))


class Compared(NamedTuple):
    """A result, and the estimated and true errors of its figures, in accuracies that its scene asks for."""

    found: Result
    told: Figures
    off: Figures


def finer_figures(asked, finer, closing="coupled", within=ANEW, only=()):
    """Return the figures of a scene closed `finer` times as accurately, known within so many of its accuracies."""
    accuracy = asked.numerics.accuracy
    numerics = replace(asked.numerics, accuracy=accuracy / finer, error="none", closing=closing)
    return known_finer(replace(asked, numerics=numerics), within * accuracy, only)


def compared(asked, finer):
    """Return the result of a scene beside one that is closed `finer` times as accurately."""
    accuracy, found, true = asked.numerics.accuracy, simulate(asked, trace=False), finer_figures(asked, finer)

    def in_accuracies(errors):
        return Figures({name: None if error is None else error / accuracy for name, error in errors.items()})

    return Compared(found, in_accuracies(found.error), in_accuracies(relative_errors(found.performance, true)))


def test_entropy_closes_where_a_cycle_closes_before_its_line_stands():
    """Hardly anything flows back: what the line is taken for does not change mass and energy, but entropy."""
    result = simulate(scene(AHEAD_OF_ITS_LINE))
    assert result.status == "ok", result.message
    assert result.balance["entropy"] <= result.balance["bound"]


def test_little_oil_may_meet_much_at_once():
    """Chambers that hold 1e-9 of oil lie beside one that is drenched: the first steps are below the smallest of old."""
    result = simulate(scene(LITTLE_OIL))
    assert result.status == "ok", result.message
    assert max(size for size in result.error.values() if size is not None) <= 3e-4


def test_what_is_delivered_errs_by_no_less_than_the_gas_trapped_over_the_efficiency():
    """2.4 % of the displacement: a finer closing had the same flow by chance, and another that was 4e-4 off it."""
    off = compared(scene(DELIVERS_LITTLE), 20).off
    assert worst(off)[1] <= 1.0


def test_what_slow_pitches_leave_of_the_first_guess_is_told():
    """Speeds 1e-12 apart made a quarter of what is delivered: 25 accuracies, of which 0.1 were told, and 60 of 0.6."""
    asked = scene_of(*BARELY_DELIVERS)
    accuracy = asked.numerics.accuracy

    @cache  # solved only where a result warns of nothing
    def true():
        closing, within = asked.numerics.closing, 3e-3 / accuracy
        return finer_figures(asked, 20.0, closing, within, ("gas_mass_flow",)).gas_mass_flow

    for aside in (-1e-12, 0.0, 1e-12):
        found = simulate(with_values(asked, {"operation.speed": asked.operation.speed * (1.0 + aside)}), trace=False)
        flow = found.performance.gas_mass_flow
        assert warns(found, accuracy) or flow == pytest.approx(true(), rel=5e-3)


def test_what_steps_miss_of_the_end_of_a_neighbours_life_is_told():
    """A finer life stepped over it as well: 0.08 accuracies of the motor's loss were told of 0.30."""
    asked = scene_of("what flows back", 702, 1)
    found, true = simulate(asked, trace=False), finer_figures(asked, 20.0, asked.numerics.closing)
    off = relative_errors(found.performance, true)
    for name in ("motor_loss", "indicated_power"):
        assert off[name] <= 1.1 * found.error[name]


def test_gas_that_seems_to_pass_to_and_fro_through_a_suction_port_is_told():
    """Turning slowly, with leaks beyond all that is sucked: 0.76 accuracies of the returned oil were told of 1.12."""
    asked = scene_of("what flows back", 703, 3)
    asked = with_values(asked, {"operation.speed": 0.1 * asked.operation.speed})
    found = simulate(asked, trace=False)
    off = relative_errors(found.performance, finer_figures(asked, 50.0))
    for name in ("returned_gas_flow", "returned_oil_flow"):
        assert off[name] <= found.error[name] <= asked.numerics.accuracy


@pytest.mark.parametrize(
    "structure, seed, number, changed",
    [
        ("walls", 713, 9, {}),
        ("part load", 711, 17, {"numerics.accuracy": 1e-3}),
        ("expander", 708, 20, {}),
    ],
    ids=["with the line, all chambers together", "with the line", "missed by a port"],
)
def test_what_chambers_misread_of_the_gas_that_they_take_in_is_told(structure, seed, number, changed):
    """They were off by 1.37, 1.20 and 0.86 accuracies with 0.41, 0.74 and 0.56 told."""
    _, told, off = compared(with_values(scene_of(structure, seed, number), changed), 50)
    assert worst(off)[1] <= worst(told)[1] <= 1.0
    assert off["gas_mass_flow"] <= told["gas_mass_flow"]


def test_what_later_turns_warm_is_told_of_a_cycle_whose_turns_showed_no_pace():
    """83 % of what flows out flows back: the last cycle of the oil's circuit told 0.09 accuracies of 0.18."""
    _, told, off = compared(scene_of("oil circuit", 713, 5), 50)
    for name in ("discharge_temperature", "oil_discharge_temperature"):
        assert 0.05 < off[name] <= told[name], name


def test_a_suction_line_from_which_nothing_is_sucked_has_one_temperature():
    """Its leaks feed it alone: waveform relaxation left it at 318 K and pitches at 279 K, by what they began with."""
    asked = scene_of("what flows back, gas dissolved", 714, 8)
    asked = with_values(asked, {"operation.speed": 0.1 * asked.operation.speed})
    _, told, off = compared(asked, 50)
    assert off["intake_temperature"] <= told["intake_temperature"] + 0.01


def test_what_slow_pitches_leave_of_a_cycle_is_told_where_little_is_delivered():
    """7 % is delivered: a closing that began with the cycle told 0.01 of 0.11 accuracies of the oil ratio."""
    _, told, off = compared(scene_of("displaced through a port, oil takes room", 601, 12), 50)
    for name in ("oil_ratio", "gas_mass_flow", "discharge_line_least_flow"):
        assert off[name] <= told[name] + 0.01, name


@pytest.mark.parametrize("number, seed", [(4, 306), (32, 304)])
def test_a_leaky_expander_is_not_further_off_than_told(number, seed):
    """More flows past its chambers than fills them: one finer life told 0.42 and 0.52 of 1.03 and 0.85 accuracies."""
    found, told, off = compared(scene_of("expander", seed, number), 300)
    assert found.performance.filling_factor > 1.3
    assert worst(off)[1] <= worst(told)[1] <= 1.0


def test_heat_that_the_sums_of_outflowing_oil_misread_is_told():
    """Most of what flowed out flowed back: the oil's temperature was 3.6 accuracies off, with 0.66 told."""
    _, told, off = compared(scene_of("gaps with friction", 306, 13), 20)
    figure = "oil_discharge_temperature"
    assert worst(off)[1] <= 1.0
    assert off[figure] <= told[figure] <= 1.0


@pytest.mark.parametrize(
    "structure, seed, number",
    [("drive", 303, 14), ("own effect", 302, 18), ("own effect", 501, 7), ("own effect", 502, 21)],
    ids=["what corrections closed errs by more than a life shows", "trapped gas over a small flow", "scatter", "again"],
)
def test_errors_that_come_back_through_the_leaks_are_told(structure, seed, number):
    """They were off by 1.16, 1.31, 1.10 and 0.61 accuracies with 0.75, 0.71, 0.65 and 0.35 told.

    At an efficiency of 0.77 one life was enough before; of the others 27, 9 and 4 % is delivered.
    """
    _, told, off = compared(scene_of(structure, seed, number), 100)
    assert worst(off)[1] <= worst(told)[1] <= 1.0


@pytest.mark.slow
def test_gas_that_flows_to_and_fro_behind_a_shut_valve_misreads_its_temperature():
    """Stages of steps made a fifth more pass both ways than does: off by 1.5 accuracies with 0.64 told."""
    _, told, off = compared(scene_of("plenums, valves", 305, 3), 50)
    assert off["discharge_temperature"] <= told["discharge_temperature"]


@pytest.mark.parametrize("structure, seed, number", [("plenums, carried", 306, 21), ("plenums, valves", 401, 10)])
def test_the_least_flow_into_a_line_is_as_accurate_as_the_net_flow(structure, seed, number):
    """It was 1.2 accuracies off with 0.01 told; of the second, 1.05 between twins with 0.2 told."""
    off = compared(scene_of(structure, seed, number), 20).off
    assert off["discharge_line_least_flow"] <= 0.2


def test_a_circuit_errs_by_what_its_cycle_leaves_open_of_energy():
    """The duty was 1.5 accuracies off with 0.2 told: finer lives leave as much of their energy open."""
    asked = scene_of(*CIRCUIT)
    found = simulate(asked, trace=False)
    true = finer_figures(asked, asked.numerics.accuracy / 1e-5, asked.numerics.closing)
    off = relative_errors(found.performance, true)["oil_cooler_duty"]
    assert off <= min(asked.numerics.accuracy, max(found.error["oil_cooler_duty"], 0.1 * asked.numerics.accuracy))


@pytest.mark.parametrize(
    "structure, seed, number",
    [("economizer and liquid", 105, 26), ("solubility over time", 107, 21)],
    ids=["what gaps err by a plenum's port makes good", "what flashes errs by the dissolved gas that is left open"],
)
def test_what_is_left_open_counts_with_the_figures_that_err_by_it(structure, seed, number):
    """Finer lives repeated what the port took for the gaps, and what flashed of gas that no balance had closed."""
    _, told, off = compared(scene_of(structure, seed, number), 15)
    assert worst(off)[1] <= 1.0
    assert worst(told)[1] <= 1.0


@pytest.mark.parametrize(
    "structure, seed, number",
    [("gaps with friction", 309, 14), ("gaps full of oil", 306, 16)],
    ids=["chambers closed together go on until they stand", "little oil errs by what is left open of it"],
)
def test_oil_flows_are_not_further_off_than_told(structure, seed, number):
    """They were off by 1.3 and 1.4 accuracies with 0.49 and 0.12 told.

    Slow modes passed the tolerance in the first pitches; the balance of a trace of oil is bounded by the gas alone.
    """
    found, told, off = compared(scene_of(structure, seed, number), 20)
    assert found.status == "ok"
    assert worst(off)[1] <= 1.0
    assert off["oil_mass_flow"] <= max(told["oil_mass_flow"], 0.1)


@pytest.mark.parametrize("seed", [304, 310])
def test_steps_end_where_gas_begins_to_flash(seed):
    """Steps across that corner, the finer ones too, had what flashes off by 1.03 and 1.45, with 0.01 and 0.33 told."""
    off = compared(scene_of("solubility", seed, 17), 20).off
    assert off["flash_mass_flow"] <= 0.3
    assert worst(off)[1] <= 1.0


@pytest.mark.parametrize("seed, number", [(303, 12), (310, 5)])
def test_steps_end_where_the_mesh_lets_a_port_on_the_end_face_open(seed, number):
    """A step across that corner had the torque's swing off by 1.32 and 1.26 accuracies with 0.45 and 0.74 told."""
    _, told, off = compared(scene_of("rotor profile", seed, number), 20)
    figure = "gas_torque_peak_to_peak"
    assert off[figure] <= told[figure] <= 1.0
    assert worst(off)[1] <= 0.5


def test_a_sampled_hole_is_entered_and_left_where_it_opens_and_shuts():
    """A step that began at the sample before misread what flows through; the port made it good, and no error saw it."""
    off = compared(scene_of("own effect", 303, 12), 20).off
    assert worst(off)[1] <= 0.4  # specific power by 1.24 with 0.35 told


def test_net_flow_is_right_where_an_area_changes_within_a_step_at_discharge():
    """Both readings of a gap differed by a thousandth, of which 13 % is delivered: off by 1.36 with 0.80 told."""
    off = compared(scene_of("rotor profile", 502, 19), 50).off
    assert worst(off)[1] <= 0.5


def test_a_finer_life_takes_what_the_last_turn_made_of_the_lines():
    """A cycle closed before its line was there: a life beside the same line told 0.03 of 0.24 accuracies."""
    asked = scene_of("rotor profile", 502, 24)
    true = finer_figures(asked, 50.0)
    of_closed = replace(asked, numerics=replace(asked.numerics, rtol=0.3 * asked.numerics.accuracy))  # not again
    found = simulate(of_closed, trace=False)
    off = relative_errors(found.performance, true)
    for name in ("discharge_temperature", "oil_discharge_temperature", "heating_capacity"):
        assert 0.2 * asked.numerics.accuracy < off[name] < found.error[name], name


@pytest.mark.parametrize(
    "structure, seed, number, most",
    [("displaced through a port", 111, 26, 0.4), ("rotor profile", 601, 4, 0.15)],
)
def test_a_swing_is_read_from_pressures_that_balance_the_flows(structure, seed, number, most):
    """Within a step that finer lives took as well: off by 1.08 and 0.42 accuracies, with 0.79 and 0.15 told."""
    _, told, off = compared(scene_of(structure, seed, number), 50)
    figure = "gas_torque_peak_to_peak"
    assert off[figure] <= min(told[figure], most)


@pytest.mark.parametrize("seed, number", [(701, 7), (702, 10), (601, 11)])
def test_little_work_is_not_misread_in_steps_that_a_valve_holds(seed, number):
    """Off by 1.80, 0.95 and 0.73 accuracies, with 0.99, 0.10 and 0.43 told: a hundredth to a sixteenth of p V."""
    off = compared(scene_of("check valves", seed, number), 50).off
    assert off["indicated_power"] <= 0.35


@pytest.mark.parametrize("seed, number, covered", [(421, 4, True), (310, 17, False)])
def test_swings_of_a_drive_err_by_their_whole_curves(seed, number, covered):
    """Two lives agreed at the extremes: 0.03 of 0.10 accuracies told; the second's loss was off by 1.74, 0.73 told."""
    _, told, off = compared(scene_of("drive on the mains", seed, number), 20)
    assert worst(off)[1] <= 1.0
    within = [off[name] <= told[name] for name in ("coupling_torque_amplitude", "twist_amplitude")]
    assert all(within) or not covered


@pytest.mark.parametrize(
    "seed, number, most, off_by, least", [(413, 28, 250_000, 0.4, 0.5), (601, 3, 150_000, 0.2, 0.0)]
)
def test_turns_that_wander_in_the_noise_of_their_steps_refine_them(seed, number, most, off_by, least):
    """Each changed the gas by a tolerance or more, until one did not by chance: off by 1.2 and 0.73 accuracies.

    The first was still off by 1.05 with 0.69 told, in 26 221 evaluations: finer lives misread what they take in, too.
    It is off by 0.2 to 0.36 now, by the last bits.
    """
    found, told, off = compared(scene_of("plenums", seed, number), 50)
    figure, largest = worst(off)
    assert found.numerics.rhs_evaluations < most
    assert largest <= off_by
    assert told[figure] > least * largest


def test_a_cycle_closed_again_begins_with_the_steps_that_closed_it():
    """Turns refined their steps anew at every closing: 74 818 evaluations."""
    asked = scene_of("gaps with friction", 601, 6)
    assert simulate(asked, trace=False).numerics.rhs_evaluations < 50_000


@pytest.fixture(scope="module")
def left():
    """A problem, its machinery, and the cycle that a search finds for it and that pitches leave."""
    problem = problem_of(scene(LEFT_BY_PITCHES))
    machinery = lease_for(problem)
    install_first_guess(problem, machinery)
    start = chambers_at_pitches(machinery)
    yield (
        problem,
        machinery,
        search_after_pitches(ClosingTask(problem, machinery, problem.criteria), start, MixingRule(5, 0.3), 2_000_000),
    )
    leases.give_back(machinery)


def test_search_finds_the_cycle_that_pitches_leave(left):
    problem, machinery, found = left
    assert found.status == "ok"
    machinery.put(found.trajectory)
    place, c = logarithms(found.y, machinery.composition), machinery.composition
    end = found.y.copy()
    machinery.pitch(end, LARGEST_RTOL)
    assert np.abs(logarithms(moved_on(machinery, end), c) - place).max() < problem.criteria.tolerance
    again = newton_search(ClosingTask(problem, machinery, problem.criteria), found.y * np.exp(1e-2))
    assert again is not None
    assert np.abs(logarithms(again[0], c) - place).max() < 1e-3
    y = found.y * np.exp(1e-3)
    swung = close_together(ClosingTask(problem, machinery, problem.criteria), y, MixingRule(0), 400_000, 300)
    assert swung.status == "not_closed"
    assert np.abs(logarithms(swung.y, c) - place).max() > 0.1  # the machine's own course leads away


def test_pitches_make_of_a_small_change_what_is_told_of_a_cycle_that_they_leave(left):
    """It turns and grows: after every `TURNED` pitches it looks as it did, and is nearly nine times as large."""
    problem, machinery, found = left
    assert found.needed == FALLBACK_NAME
    assert found.growth > UNSTABLE_GROWTH
    machinery.put(found.trajectory)
    c = machinery.composition
    y, strayed = found.y * np.exp(1e-5), []
    at = logarithms(found.y, c)
    for _ in range(PITCHES):
        *_, q = machinery.pitch(y, LARGEST_RTOL)
        install_pitch(machinery)
        set_unknowns(problem, machinery, image(problem, machinery.trajectory, q))
        y = moved_on(machinery, y)
        strayed.append(float(np.linalg.norm(logarithms(y, c) - at)))
    assert strayed[-1] < 0.03  # still small
    assert (strayed[-1] / strayed[-1 - TURNED]) ** (1.0 / TURNED) == pytest.approx(found.growth, rel=0.01)


@pytest.mark.parametrize("closing, lasts", [("coupled", False), ("auto", True)])
def test_a_cycle_that_a_warmer_line_leaves_is_told(closing, lasts):
    """Twenty times the delivered gas is sucked again: two cycles close, a quarter of the flow apart, and one lasts."""
    asked = scene_of("what flows back", 306, 21)
    asked = replace(asked, numerics=replace(asked.numerics, closing=closing, error="none"))
    result = simulate(asked, trace=False)
    assert result.status == "ok", result.message
    assert result.performance["gas_mass_flow"] == pytest.approx(2.52e-3 if lasts else 1.93e-3, rel=0.01)
    assert any(text.startswith("the machine does not stay on this cycle") for text in result.warnings) != lasts


def test_what_slow_pitches_leave_of_the_guess_is_told_where_a_third_is_delivered():
    """Finer pitches from the closed cycle change next to nothing: gas and oil are moved before."""
    result, told, off = compared(with_values(scene_of("part load", 756, 35), {"numerics.closing": "coupled"}), 100)
    assert result.performance["volumetric_efficiency"] < 0.3
    assert 0.1 < off["discharge_temperature"] <= told["discharge_temperature"]


def test_what_no_pitch_closes_is_searched_and_says_so():
    result = simulate(scene(LEFT_BY_PITCHES))
    assert result.status == "ok", result.message
    assert f"the cycle closed only with {FALLBACK_NAME}" in result.warnings
    assert any(text.startswith("the machine does not stay on this cycle") for text in result.warnings)
    assert max(size for size in result.error.values() if size is not None) <= 3e-4


def test_a_check_is_not_given_up_after_the_evaluations_of_our_own_method():
    """A pitch of scipy's takes some ten times as many: one of a machine that hardly does work took a million."""
    problem, machinery, _ = closed(make())
    y, found = chambers_at_pitches(machinery), {}
    for check in (None, check_of("scipy-radau")):
        wanted = replace(problem.criteria, check=check)
        found[check is not None] = close_together(ClosingTask(problem, machinery, wanted), y.copy(), most=2000).status
    assert found == {False: "not_closed", True: "ok"}


def test_gas_that_flashes_only_far_from_the_solution_is_no_error_of_the_circuit(monkeypatch):
    """Ten kelvin away nothing flashes: a slope over these gave an error of 270 accuracies, and a second solution."""
    solved = []

    def counting(*given):
        solved.append(solve(*given))
        return solved[-1]

    asked = scene_of(*FLASHES)
    monkeypatch.setattr("screwsim.solve.circuit.solve", counting)
    found = simulate(asked, trace=False)
    assert found.status == "ok" and len(solved) == 1
    monkeypatch.undo()
    both = compared(asked, 30)
    for name in ("flash_mass_flow", "dissolved_gas_ratio"):
        assert both.off[name] <= both.told[name] < 1.0  # accuracies


def test_what_a_search_left_open_is_not_closed_again_the_same_way():
    """The oil's circuit had closed it from the same start: 7.2 million evaluations instead of 3.7."""
    at = {"speed": "620 rpm", "evaporating_temperature": "-17.35 degC", "condensing_temperature": "64.48 degC"}
    template = new_scene("refrigeration", request_of(fluid="R410A", condition="-10/40 degC", economizer=True))
    asked = loads(template, overrides=[f"operation.{path}={value}" for path, value in at.items()])
    found = simulate(asked, trace=False)
    assert found.status == "failed" and "above the equation's highest temperature" in found.message
    assert found.numerics.rhs_evaluations < 4_500_000
