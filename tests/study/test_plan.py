"""Which points to measure next: the best of all subsets, what they bring is what a fit then has, mistakes are told."""

import itertools
import json
from dataclasses import replace

import numpy as np
import pytest
from fit_fakes import CAPACITY, GAP, HEAD, ONE_START, SCENE, coordinates, plane, torn, write_fit
from folders import CONFIGS

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Figures, Result
from screwsim.printing.plan import plan_document, print_plan
from screwsim.scene import loads
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.fit import Measurement, Point, Prior
from screwsim.study.calibration.machine import PointShifts, inputs_of, known_everywhere, point_shifts
from screwsim.study.calibration.plan import (
    candidates_of,
    covariance,
    greedy_choice,
    log_determinant,
    optimal_choice,
    plan,
    point_name,
    typical_uncertainties,
)
from screwsim.study.calibration.profile import whitener
from screwsim.study.uncertainty import slopes
from screwsim.study.uncertainty.slopes import Sensitivities
from screwsim.study.uncertainty.spreads import groups_of

POINTS = HEAD + "a,fit,2000,9,0.09\nb,fit,2100,9.2,0.092\nc,check,3000,11,0.1\n"
SPEEDS = "operation.speed=1000 rpm..5000 rpm"


def written(folder, text=POINTS):
    """Write a fit whose machine lies within the bounds: 50 um, 2 kJ/(kg K)."""
    scene = screwsim.loads(SCENE).with_({GAP: "50 um", CAPACITY: "2 kJ/(kg K)"}).text
    return write_fit(folder, ONE_START, text, scene)


def fit_of(folder, text=POINTS):
    return read_fit(written(folder, text), fixed=False)


def volume(known, pieces, numbers, asked):
    return log_determinant(known + sum(pieces[i] for i in numbers), asked)


def test_the_points_are_the_best_of_all_subsets():
    hits = 0
    for seed in range(20):
        generator = np.random.default_rng(seed)
        rows = generator.standard_normal((8, 2, 4)) * generator.uniform(0.2, 3.0, (8, 1, 1))
        pieces, known = [row.T @ row for row in rows], np.diag([0.1, 0.1, 0.1, 1.0])
        found = optimal_choice(known, pieces, 3, 3)
        every = [volume(known, pieces, each, 3) for each in itertools.combinations(range(8), 3)]
        ours = volume(known, pieces, found, 3)
        assert ours <= volume(known, pieces, greedy_choice(known, pieces, 3, range(8), 3), 3) + 1e-12
        hits += ours == pytest.approx(min(every), abs=1e-9)
    assert hits >= 19  # an exchange of one point may end beside the best of all


def test_all_pieces_at_once_spread_as_each_alone():
    rows = np.random.default_rng(4).normal(size=(50, 2, 4))
    pieces, known = np.einsum("nij,nik->njk", rows, rows), 0.1 * np.eye(4)
    alone = [log_determinant(known + piece, 3) for piece in pieces]
    assert log_determinant(known + pieces, 3) == pytest.approx(alone, abs=1e-12)


def test_the_first_point_is_the_one_that_tells_most():
    pieces = [np.diag([1.0, 0.0]), np.diag([9.0, 9.0]), np.diag([0.0, 4.0])]
    assert optimal_choice(np.eye(2), pieces, 2, 3) == [1, 2, 0]


def test_what_nobody_asks_for_widens_what_a_point_tells():
    generator = np.random.default_rng(4)
    slopes, inputs = generator.standard_normal((5, 3)), generator.standard_normal((5, 2))
    rows, known = np.hstack([slopes, inputs]), np.diag([2.0, 3.0, 4.0, 1.0, 1.0])
    white = whitener(inputs) @ slopes
    assert np.allclose(covariance(known + rows.T @ rows, 3), np.linalg.inv(known[:3, :3] + white.T @ white))


def test_the_ends_tell_most_of_a_line(tmp_path):
    fit = fit_of(tmp_path, HEAD + "a,fit,3000,11,0.1\n")
    named = "operation.speed [rpm],shaft_power_uncertainty [kW]\n" + "".join(
        f"{n},0.1\n" for n in range(1000, 6000, 500)
    )
    (tmp_path / "grid.csv").write_text(named, encoding="utf-8")
    found = plan(fit, candidates_of(fit, tmp_path / "grid.csv"), count=2, jobs=1, simulate=plane)
    speeds = sorted(round(each.point.values["operation.speed"] * 30.0 / np.pi) for each in found.steps)
    assert speeds == [1000, 5500]
    assert found.even == (GAP, CAPACITY)


def curved(scene):
    """Return figures that depend on both unknowns differently at each speed."""
    gap, capacity, speed = coordinates(scene)
    figures = Figures(shaft_power=1e3 * (gap / speed + capacity * speed**1.5), gas_mass_flow=speed - 0.02 * gap)
    return Result("ok", performance=figures)


def test_of_a_machine_they_are_the_best_of_all_subsets(tmp_path):
    fit = fit_of(tmp_path)
    every = candidates_of(fit, paths=[SPEEDS], levels=6)
    found = plan(fit, every, count=3, jobs=1, simulate=curved)
    gains = {
        frozenset(each.name for each in some): sum(
            step.gain for step in plan(fit, some, count=3, jobs=1, simulate=curved).steps
        )
        for some in itertools.combinations(every, 3)
    }
    assert frozenset(step.point.name for step in found.steps) == max(gains, key=lambda names: gains[names])
    assert sum(step.gain for step in found.steps) == pytest.approx(max(gains.values()))


def test_deviations_are_the_standard_errors_of_the_fit_with_the_points_measured(tmp_path):
    fit = fit_of(tmp_path)
    prior = (Prior(50e-6, 1e-5), Prior(2000.0, 300.0))
    parameters = tuple(replace(one, prior=each) for one, each in zip(fit.parameters, prior, strict=True))
    fit = replace(fit, parameters=parameters)
    found = plan(fit, candidates_of(fit, paths=[SPEEDS]), count=2, jobs=1, simulate=plane)
    for points, deviations in (((), found.before), (found.steps, found.steps[-1].deviations)):
        with_them = replace(fit, points=(*fit.points, *(step.point for step in points)))
        errors = calibrate(with_them, jobs=1, simulate=plane).certainty.errors
        assert deviations == pytest.approx(errors, rel=1e-3)
    assert found.even == () and found.steps[0].gain > found.steps[1].gain > 0.0


def test_what_follows_a_parameter_has_no_tolerance_of_its_own(tmp_path, monkeypatch):
    """Of three gaps with tolerances one is sought, one follows it, and one remains an input that nobody knows well."""
    lengths = {"tip": "", "interlobe": ", length: 130 mm", "end_face": ", length: 100 mm"}
    effects = "\n".join(f"  {name}_leakage: {{gap: 50 um ± 10 um{length}}}" for name, length in lengths.items())
    scene = SCENE.replace("  tip_leakage: {gap: 50 um}", effects)
    follower = "also: {effects.interlobe_leakage.gap: {factor: 1}}"
    text = ONE_START.replace("to: 100 um}", f"to: 100 um, {follower}}}")
    asked = []

    def shifts(of, point, groups, result):
        asked.append(groups)
        return PointShifts({path: np.zeros(len(point.measured)) for group in groups for path in group}, {})

    monkeypatch.setattr("screwsim.study.calibration.plan.point_shifts", shifts)
    fit = read_fit(write_fit(tmp_path, text, POINTS, scene), fixed=False)
    found = plan(fit, candidates_of(fit, paths=[SPEEDS]), count=1, jobs=1, simulate=plane)
    assert found.inputs == ("effects.end_face_leakage.gap",)
    assert set(asked) == {(("effects.end_face_leakage.gap",),)}
    prior = Prior(50e-6, 5e-6)
    held = replace(fit, parameters=(replace(fit.parameters[0], prior=prior), fit.parameters[1]))
    assert inputs_of(held, held.scene)[0] == (("effects.end_face_leakage.gap",),)


def test_an_input_without_a_derivative_at_one_point_is_left_out_at_all_and_named(tmp_path, monkeypatch):
    scene = loads(SCENE.replace("gap: 50 um", "gap: 50 um ± 10 um") + "\n")
    path, point = "effects.tip_leakage.gap", Point("first", {}, {"shaft_power": Measurement(1e3, 10.0)})
    known = Sensitivities(Result("ok"), left_out={path: "failed: too hot"})
    monkeypatch.setattr("screwsim.study.uncertainty.point.sensitivities", lambda *asked, **more: known)
    lost = point_shifts(scene, point, [(path,)])
    assert lost.left_out == {path: "at first: failed: too hot"}
    there = PointShifts({path: np.ones(1), "oil.heat_capacity": np.ones(1)}, {})
    groups, left_out = known_everywhere([(path, "oil.heat_capacity"), (path,)], [there, lost])
    assert (groups, left_out) == ((("oil.heat_capacity",),), lost.left_out)


def test_a_plan_goes_on_without_an_input_that_has_no_derivative_and_says_so(tmp_path, monkeypatch, capsys):
    """It refused the whole question."""
    scene = SCENE.replace("gap: 50 um}", "gap: 50 um}\n  interlobe_leakage: {gap: 50 um ± 10 um, length: 130 mm}")
    fit, path = read_fit(write_fit(tmp_path, ONE_START, POINTS, scene), fixed=False), "effects.interlobe_leakage.gap"
    monkeypatch.setattr(
        "screwsim.study.uncertainty.point.sensitivities",
        lambda *asked, **more: Sensitivities(Result("ok"), left_out={path: "failed: too hot"}),
    )
    found = plan(fit, candidates_of(fit, paths=[SPEEDS]), count=2, jobs=1, simulate=plane)
    alone = read_fit(write_fit(tmp_path, ONE_START, POINTS, scene.replace(" ± 10 um", "")), fixed=False)
    certain = plan(alone, candidates_of(alone, paths=[SPEEDS]), count=2, jobs=1, simulate=plane)
    assert (found.inputs, [step.deviations for step in found.steps]) == ((), [s.deviations for s in certain.steps])
    print_plan(found)
    told = f"warning: the tolerance of {path} is not included in the uncertainties: at"
    assert told in " ".join(capsys.readouterr().out.split())
    assert plan_document(found)["left_out"] == {path: "at a: failed: too hot"}


def test_only_a_candidate_at_which_an_input_has_no_derivative_is_left_out_and_named(tmp_path, monkeypatch, capsys):
    """Elsewhere the input counts as uncertain; at such a candidate it would count as exact, and the point tell most."""
    scene = SCENE.replace("gap: 50 um}", "gap: 50 um}\n  interlobe_leakage: {gap: 50 um ± 10 um, length: 130 mm}")
    fit, path = read_fit(write_fit(tmp_path, ONE_START, POINTS, scene), fixed=False), "effects.interlobe_leakage.gap"
    speed = 2.0 * np.pi * 1000.0 / 60.0

    def lost_at_1000_rpm(of, *asked, **more):
        if abs(of.operation.speed - speed) < 1e-6 * speed:
            return Sensitivities(Result("ok"), left_out={path: "failed: too hot"})
        return Sensitivities(Result("ok"), values={path: 50e-6}, derivatives={"shaft_power": {path: 1e8}})

    monkeypatch.setattr("screwsim.study.uncertainty.point.sensitivities", lost_at_1000_rpm)
    every = candidates_of(fit, paths=[SPEEDS], levels=5)
    found = plan(fit, every, count=2, jobs=1, simulate=plane)
    assert found.inputs == (path,) and not found.left_out
    assert found.unsure == {"1000 rpm": f"{path}: at 1000 rpm: failed: too hot"}
    without = plan(fit, every[1:], count=2, jobs=1, simulate=plane)
    assert [step.deviations for step in found.steps] == [step.deviations for step in without.steps]
    print_plan(found)
    assert f"no derivative there: {path}: at 1000 rpm" in " ".join(capsys.readouterr().out.split())
    assert plan_document(found)["without_derivative"] == found.unsure
    none = plan(fit, every[:1], count=1, jobs=1, simulate=plane)
    assert (none.inputs, list(none.left_out), len(none.steps)) == ((), [path], 1)


def test_an_input_without_a_derivative_at_any_candidate_takes_no_other_input_with_it(tmp_path, monkeypatch):
    """The length, unknown at 3000 rpm alone, was left out at all points beside a gap that is unknown at each."""
    given = "\n  interlobe_leakage: {gap: 50 um ± 10 um, length: 130 mm ± 5 mm}"
    fit = read_fit(
        write_fit(tmp_path, ONE_START, POINTS, SCENE.replace("gap: 50 um}", f"gap: 50 um}}{given}")), fixed=False
    )
    gap, length = "effects.interlobe_leakage.gap", "effects.interlobe_leakage.length"

    def lost(of, *asked, **more):
        rpm = 30.0 / np.pi * of.operation.speed
        left_out = {path: "failed" for path, most in ((gap, 5100.0), (length, 3100.0)) if 2900.0 < rpm < most}
        found = {gap: 1e8, length: 1e5}
        return Sensitivities(
            Result("ok"),
            values={path: 0.1 for path in found if path not in left_out},
            derivatives={"shaft_power": {path: each for path, each in found.items() if path not in left_out}},
            left_out=left_out,
        )

    monkeypatch.setattr("screwsim.study.uncertainty.point.sensitivities", lost)
    every = candidates_of(fit, paths=["operation.speed=3000 rpm..5000 rpm"], levels=3)
    found = plan(fit, every, count=2, jobs=1, simulate=plane)
    assert (found.inputs, list(found.left_out), list(found.unsure)) == ((length,), [gap], ["3000 rpm"])


def test_candidates_are_measured_as_the_points_are(tmp_path):
    fit = fit_of(tmp_path)
    share = typical_uncertainties(fit)["shaft_power"]
    assert share.share and share.size == pytest.approx(0.01)
    found = plan(fit, candidates_of(fit, paths=[SPEEDS]), count=1, jobs=1, simulate=plane)
    assert found.steps[0].point.measured["shaft_power"] == Measurement(*(1e3 * np.array([15.0, 0.15])).tolist())


def test_what_has_no_solution_is_told_and_not_chosen(tmp_path):
    fit = fit_of(tmp_path)
    found = plan(fit, candidates_of(fit, paths=[SPEEDS], levels=5), count=3, jobs=1, simulate=torn)
    assert found.status == "failed" and set(found.reasons) == {"3000 rpm", "4000 rpm", "5000 rpm"}
    assert {step.point.name for step in found.steps} == {"1000 rpm", "2000 rpm"}


def test_points_at_which_nothing_is_delivered_are_told_and_not_weighed(tmp_path, capsys):
    """What a machine takes that delivers nothing tells of its leaks, and tells most at the lowest speed."""

    def delivers_from_2000_rpm(scene):
        result = plane(scene)
        flow = scene.operation.speed - 200.0
        return replace(result, performance=Figures({**result.performance, "gas_mass_flow": flow}))

    fit = fit_of(tmp_path)
    every = candidates_of(fit, paths=[SPEEDS], levels=5)
    found = plan(fit, every, count=3, jobs=1, simulate=delivers_from_2000_rpm)
    assert found.status == "ok" and found.idle == ("1000 rpm",)
    assert "1000 rpm" not in {step.point.name for step in found.steps}
    print_plan(found)
    assert "not considered because nothing is delivered there: 1000 rpm" in capsys.readouterr().out
    none = plan(fit, every[:1], count=1, jobs=1, simulate=delivers_from_2000_rpm)
    assert none.status == "failed" and none.message.startswith("no candidate delivers anything")


@pytest.mark.parametrize(
    ("own", "told"), [("1e300", "too large to be of use"), ("1e-300", "smaller than any measurement achieves")]
)
def test_a_candidate_whose_uncertainty_is_none_is_told(own, told, tmp_path):
    fit = fit_of(tmp_path)
    (tmp_path / "grid.csv").write_text(f"operation.speed [rpm],shaft_power_uncertainty [kW]\n3000,{own}\n", "utf-8")
    with pytest.raises(UsageError, match=f"shaft_power: its uncertainty is .* of the value, {told}"):
        plan(fit, candidates_of(fit, tmp_path / "grid.csv"), count=1, jobs=1, simulate=plane)


def test_a_machine_is_told_apart_at_high_and_at_low_speed(tmp_path):
    fit = read_fit(CONFIGS / "calibration" / "leakage.fit.yaml")
    fit = replace(fit, points=fit.points[2:3])  # at 2000 rpm
    every = candidates_of(fit, paths=["operation.speed=600 rpm..4000 rpm"], levels=3)
    found = plan(fit, every, count=2, jobs=1)
    assert found.steps[0].point.name in ("600 rpm", "4000 rpm")
    assert {step.point.name for step in found.steps} == {"600 rpm", "4000 rpm"}
    assert all(after < before for before, after in zip(found.before, found.steps[-1].deviations, strict=True))


def test_all_inputs_of_a_point_are_derived_at_once_and_it_is_solved_once(monkeypatch):
    """Each group alone gives the same, at a solution of its own."""
    scene = screwsim.load(CONFIGS / "paper" / "uncertain.yaml")
    point = Point("here", {}, {"shaft_power": Measurement(12e3, 60.0), "gas_mass_flow": Measurement(0.17, 1e-3)})
    result, groups, calls = screwsim.simulate(scene), groups_of(scene), []
    alone = [point_shifts(scene, point, [group]).of([group])[0] for group in groups]
    for name in ("scene_derivatives", "simulate"):
        own = getattr(slopes, name)
        monkeypatch.setattr(
            slopes, name, lambda *of, _own=own, _name=name, **more: calls.append(_name) or _own(*of, **more)
        )
    together = point_shifts(scene, point, groups, result).of(groups)
    assert calls == ["scene_derivatives"]
    assert len(groups) > 2 and np.array_equal(np.array(together), np.array(alone))
    assert point_shifts(scene, point, ()).of(()) == []


@pytest.mark.usefixtures("quick")
def test_the_command_prints_the_points_and_writes_them_to_be_filled_in(tmp_path, capsys):
    file, out = written(tmp_path), tmp_path / "next.csv"
    asked = ["plan", str(file), "--path", SPEEDS, "--count", "2", "--jobs", "1", "-o", str(out)]
    assert exit_code(asked) == 0
    shown = capsys.readouterr().out
    assert max(len(line) for line in shown.splitlines() if line != str(out)) <= 80
    assert "1  1000 rpm" in shown or "1  5000 rpm" in shown
    assert "constrained so far by their bounds only: gap, heat_capacity" in shown
    heads, *rows = out.read_text(encoding="utf-8").splitlines()
    assert heads == "name,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]" and len(rows) == 2
    fit = read_fit(file, fixed=False)
    assert {each.name for each in candidates_of(fit, out)} == {"1000 rpm", "5000 rpm"}
    assert exit_code([*asked, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["candidates"] == 4 and len(document["points"]) == 2
    told = [each["uncertainties"]["shaft_power"] for each in document["points"]]
    assert [1e3 * float(row.split(",")[-1]) for row in rows] == pytest.approx(told, rel=5e-3)  # three digits
    assert document["points"][-1]["deviations"][GAP] < document["deviations"][GAP]


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    ("rest", "code", "told"),
    [
        ((), 2, "candidates come from one place"),
        (("--path", SPEEDS, "--candidates", "grid.csv"), 2, "candidates come from one place"),
        (("--path", SPEEDS, "--count", "9"), 2, "--count 9: of 4 candidates 1 to 4"),
        (("--path", SPEEDS, "--levels", "1"), 2, "--levels 1: a range has at least two values, its ends"),
        (("--path", SPEEDS, "--levels", "4000"), 2, "makes 4000 candidates, more than 2000"),
        (("--levels", "3", "--candidates", "grid.csv"), 2, "--levels 3: applies to ranges only"),
        (("--path", "operation.speed=1000 rpm"), 2, "is not PATH=LOW..HIGH"),
        (("--path", f"{GAP}=10 um..20 um"), 2, "is a parameter of the fit"),
        (("--path", "operation.speed=-1 rpm..20 rpm"), 2, "operation.speed"),
        (("--path", SPEEDS, "-o", "x.h5"), 2, ".csv"),
        (("--candidates", "none.csv"), 2, "--candidates none.csv: is not a file"),
    ],
)
def test_bad_input_is_told_in_one_line(tmp_path, capsys, monkeypatch, rest, code, told):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "grid.csv").write_text("operation.speed [rpm]\n1000\n", encoding="utf-8")
    assert exit_code(["plan", str(written(tmp_path)), *rest]) == code
    err = capsys.readouterr().err
    assert told in err and len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("operation.speed [rpm]\n1000\nx\n", "grid.csv:3:1: operation.speed:"),
        ("operation.sped [rpm]\n1000\n", "grid.csv:1:1: operation.sped:"),
        (
            "operation.speed [rpm],shaft_power_uncertainty [kW]\n1000,-1\n",
            "grid.csv:2:6: shaft_power: -1 is out of range",
        ),
        (f"{GAP} [um]\n20\n", "is a parameter of the fit and cannot be a condition"),
        ("operation.speed [rpm]\n", "has no points"),
    ],
)
def test_faults_of_the_candidates_are_told_at_their_line(tmp_path, text, told):
    fit = fit_of(tmp_path)
    (tmp_path / "grid.csv").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as error:
        candidates_of(fit, tmp_path / "grid.csv")
    assert len(error.value.lines) == 1 and told in error.value.lines[0]


def test_the_package_plans_as_the_command_does(tmp_path, monkeypatch):
    file = written(tmp_path)
    monkeypatch.setattr("screwsim.api._plan", lambda fit, points, **how: (fit, points, how))
    fit, points, how = screwsim.plan(file, ranges={"operation.speed": ("1000 rpm", "5000 rpm")}, levels=2, count=1)
    assert [each.name for each in points] == ["1000 rpm", "5000 rpm"] and how["count"] == 1
    with pytest.raises(UsageError, match="pass its path"):
        screwsim.plan(fit, ranges={"operation.speed": ("1000 rpm", "5000 rpm")}, data="x.csv")


def test_temperatures_of_a_point_are_those_that_people_state():
    scene = screwsim.load(CONFIGS / "r134a" / "compact.yaml")
    values = {
        "operation.evaporating_temperature": 263.15,
        "operation.condensing_temperature": 318.4,
        "operation.speed": 100.0,
    }
    assert point_name(scene, values) == "-10 °C, 45.25 °C, 954.93 rpm"
