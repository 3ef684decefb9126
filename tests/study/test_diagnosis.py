"""Which parameter has changed: the probabilities are those of Bayes' rule, known changes of a machine are found."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fit_fakes import SCENE, coordinates, plane, product, torn, write_fit

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.scene import load, with_values
from screwsim.simulate import simulate
from screwsim.study.calibration import read_fit
from screwsim.study.calibration.diagnosis import NONE, diagnose
from screwsim.study.calibration.fit import Prior
from screwsim.study.calibration.single import Along, along, whitener

ROOT = Path(__file__).parents[2]
GAP, CAPACITY = "effects.tip_leakage.gap", "oil.heat_capacity"
UNCHANGED = {GAP: "50 um", CAPACITY: "2 kJ/(kg K)"}  # 5 kW and 2 kW per 1000 rpm
FIT = """\
scene: machine.yaml
data: points.csv
parameters:
  effects.tip_leakage.gap: {from: 10 um, to: 100 um}
  oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K)}
"""
HEAD = "name,use,operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]\n"


def points(of=lambda n: 5.0 + 2.0 * n, seed=1, noise=0.05, count=6):
    generator, rows = np.random.default_rng(seed), []
    for number, n in enumerate(np.linspace(1.0, 4.0, count)):
        rows.append(f"p{number},fit,{1e3 * n},{of(n) + noise * generator.standard_normal():.6f},{noise}")
    return HEAD + "\n".join(rows) + "\n"


def written(folder, text):
    return write_fit(folder, FIT, text, screwsim.loads(SCENE).with_(UNCHANGED).text)


def asked(folder, text, simulator=plane, **how):
    return diagnose(read_fit(written(folder, text), fixed=False), simulate=simulator, jobs=1, **how)


def by_path(found):
    return {each.path: each for each in found.hypotheses}


def test_the_evidence_is_the_mean_likelihood_between_the_bounds():
    generator = np.random.default_rng(2)
    for place, size in ((0.3, 8.0), (0.02, 3.0), (0.9, 40.0), (0.5, 0.0)):
        residuals, slopes = generator.standard_normal(5), size * generator.standard_normal(5)
        found = along(place, residuals, slopes)
        u = np.linspace(0.0, 1.0, 200_001)
        chi_squared = np.sum((residuals + np.outer(u - place, slopes)) ** 2, axis=1)
        mean = np.trapezoid(np.exp(-0.5 * chi_squared), u)
        assert found.log_evidence == pytest.approx(np.log(mean), abs=1e-6)
        assert found.misfit == pytest.approx(chi_squared.min(), abs=1e-6)
        below = np.trapezoid(np.where(u < found.interval(0.9)[0], np.exp(-0.5 * chi_squared), 0.0), u)
        assert below / mean == pytest.approx(0.05, abs=1e-3)


def test_an_estimate_far_beyond_a_bound_is_the_bound():
    far = Along(9.0, 1.0, 1e4)
    assert far.estimate == 1.0 and far.misfit == pytest.approx(1.0 + 1e4 * 64.0)
    assert np.isfinite(far.log_evidence) and 0.99 < far.interval(0.9)[0] < 1.0


def test_inputs_that_are_not_known_widen_the_measurement():
    inputs = np.array([[1.0, 0.5], [0.0, 2.0], [1.0, 0.0]])
    white = whitener(inputs)
    assert np.allclose(white.T @ white, np.linalg.inv(np.eye(3) + inputs @ inputs.T))


def test_probabilities_are_those_of_bayes_rule(tmp_path):
    text = points(lambda n: 5.06 + 2.0 * n)
    found = by_path(asked(tmp_path, text, unchanged=0.4))
    rows = [line.split(",") for line in text.splitlines()[1:]]
    n, measured = np.array([[float(row[2]) / 1e3, float(row[3])] for row in rows]).T

    def likelihood(gap, capacity):
        return np.exp(-0.5 * np.sum(((gap + capacity * n - measured) / 0.05) ** 2))

    none = 0.4 * likelihood(5.0, 2.0)
    grown = 0.3 * np.mean([likelihood(gap, 2.0) for gap in np.linspace(1.0, 10.0, 20_001)])
    other = 0.3 * np.mean([likelihood(5.0, capacity) for capacity in np.linspace(1.0, 3.0, 20_001)])
    total = none + grown + other
    for path, weight in ((NONE, none), (GAP, grown), (CAPACITY, other)):
        assert found[path].probability == pytest.approx(weight / total, rel=1e-3)
        assert 0.01 < found[path].probability < 0.99  # of three that are all possible


def test_a_machine_that_has_not_changed_is_found_unchanged(tmp_path):
    first = []
    for seed in range(12):
        folder = tmp_path / str(seed)
        folder.mkdir()
        first.append(asked(folder, points(seed=seed)).hypotheses[0].path)
    assert first.count(NONE) >= 11


def test_what_a_prior_leaves_open_is_no_change(tmp_path):
    fit = read_fit(written(tmp_path, points(lambda n: 6.0 + 2.0 * n)), fixed=False)
    gap = fit.parameters[0]
    sharp, wide = (
        diagnose(
            replace(fit, parameters=(replace(gap, prior=Prior(50e-6, deviation)), *fit.parameters[1:])),
            simulate=plane,
            jobs=1,
        )
        for deviation in (1e-7, 1e-5)
    )
    assert by_path(sharp)[GAP].probability > 0.99 and by_path(sharp)[GAP].change == pytest.approx(1e-5, rel=0.1)
    assert wide.hypotheses[0].path == NONE and wide.inputs == (GAP,)


def test_two_parameters_that_enter_as_their_product_are_said_not_to_be_told_apart(tmp_path):
    found = asked(tmp_path, points(lambda n: 13.0 * n), product)
    assert {found.alike[0].first, found.alike[0].second} == {GAP, CAPACITY}
    assert found.alike[0].off < 0.5
    both = by_path(found)
    assert both[GAP].probability + both[CAPACITY].probability > 0.99
    assert both[GAP].probability == pytest.approx(0.5, abs=0.4)


def bent(scene):
    """Return a power that falls and rises with the gap: at 50 um it is 0.2 kW above its least."""
    gap, capacity, speed = coordinates(scene)
    return Result("ok", performance=Figures(shaft_power=1e3 * (5.0 + 0.2 * (gap - 4.0) ** 2 + capacity * speed)))


def test_a_second_value_that_fits_as_well_is_told(tmp_path):
    gap = by_path(asked(tmp_path, points(lambda n: 5.0 + 0.2 * 2.0**2 + 2.0 * n), bent))[GAP]
    assert gap.probability > 0.9 and gap.linear == ""
    assert sorted((gap.value, *gap.also)) == pytest.approx([2e-5, 6e-5], rel=0.1)


def test_the_likelihood_between_solutions_is_that_of_the_model(tmp_path):
    # near the least power, where slopes say nothing: the likelihood is flat and falls off on both sides, no normal one
    text = points(lambda n: 5.0 + 0.2 * 0.5**2 + 2.0 * n)
    found = by_path(asked(tmp_path, text, bent))
    rows = [line.split(",") for line in text.splitlines()[1:]]
    n, measured = np.array([[float(row[2]) / 1e3, float(row[3])] for row in rows]).T
    gaps = np.linspace(1.0, 10.0, 20_001)
    off = 5.0 + 0.2 * (gaps[:, None] - 4.0) ** 2 + 2.0 * n - measured
    likelihood = np.exp(-0.5 * np.sum((off / 0.05) ** 2, axis=1))
    # interpolated between a dozen solutions
    assert found[GAP].log_evidence == pytest.approx(np.log(likelihood.mean()), abs=0.05)
    below = np.cumsum(likelihood) / likelihood.sum()
    for end, share in ((found[GAP].low, 0.05), (found[GAP].high, 0.95)):
        assert np.interp(5.0 + 1e5 * end, gaps, below) == pytest.approx(share, abs=0.01)


def test_a_likely_change_is_solved_again_at_its_estimate(tmp_path):
    gap = by_path(asked(tmp_path, points(lambda n: 2.0 + 2.0 * n), squared))[GAP]
    assert gap.linear == "" and gap.value == pytest.approx(1e-5 * np.sqrt(10.0), rel=0.05) and gap.misfit < 20.0
    assert gap.also == ()


def squared(scene):
    """Return a power with the square of the gap: at 50 um it is 5 kW."""
    gap, capacity, speed = coordinates(scene)
    return Result("ok", performance=Figures(shaft_power=1e3 * (0.2 * gap**2 + capacity * speed)))


def test_several_changes_at_once_are_said_to_fit_none(tmp_path):
    found = asked(tmp_path, points(lambda n: 7.0 + 1.5 * n))
    assert found.chance < 0.01


def test_points_without_a_solution_are_told_and_left_out(tmp_path):
    found = asked(tmp_path, points(), torn)
    assert found.status == "failed" and "have no solution" in found.message
    assert "p5" in found.reasons and found.hypotheses


def test_an_unchanged_machine_outside_the_bounds_is_refused(tmp_path):
    fit = read_fit(written(tmp_path, points()), fixed=False)
    low = replace(fit.parameters[0], low=60e-6)
    with pytest.raises(UsageError, match="outside its bounds"):
        diagnose(replace(fit, parameters=(low, *fit.parameters[1:])), simulate=plane)


MACHINE = """\
scene: {scene}
data: points.csv
parameters:
  effects.tip_leakage.gap: {{from: 15 um, to: 60 um}}
  effects.interlobe_leakage.gap: {{from: 15 um, to: 60 um}}
  oil_supply.ratio: {{from: 0.5, to: 3.5}}
"""
COLUMNS = "operation.speed [rpm],operation.discharge.pressure [bar]"
FIGURES = {"gas_mass_flow": "kg/s", "shaft_power": "W", "discharge_temperature": "K"}


@pytest.mark.parametrize(
    ("truth", "path", "change"),
    [
        ({GAP: 37.5e-6}, GAP, 10e-6),
        ({"oil_supply.ratio": 1.5}, "oil_supply.ratio", -1.5),
        ({}, NONE, None),
    ],
    ids=["gap", "oil", "none"],
)
def test_known_changes_of_a_machine_are_found(tmp_path, truth, path, change):
    scene = ROOT / "configs" / "paper" / "point.yaml"
    generator = np.random.default_rng(7)
    machine, rows = with_values(load(scene), truth), []
    for rpm, bar in ((1000.0, 8.0), (4000.0, 11.5)):
        point = with_values(machine, {"operation.speed": rpm * np.pi / 30.0, "operation.discharge.pressure": 1e5 * bar})
        figures = simulate(point, trace=False).performance
        cells = [f"{rpm}", f"{bar}"]
        for name, unit in FIGURES.items():
            uncertainty = 0.5 if unit == "K" else 0.004 * figures[name]
            cells += [f"{figures[name] + uncertainty * generator.standard_normal()}", f"{uncertainty}"]
        rows.append(",".join(cells))
    heads = [f"{name} [{unit}],{name}_uncertainty [{unit}]" for name, unit in FIGURES.items()]
    (tmp_path / "points.csv").write_text("\n".join([",".join([COLUMNS, *heads]), *rows]) + "\n", encoding="utf-8")
    (tmp_path / "x.fit.yaml").write_text(MACHINE.format(scene=scene), encoding="utf-8")
    found = diagnose(read_fit(tmp_path / "x.fit.yaml", fixed=False), jobs=1)
    best = found.hypotheses[0]
    assert best.path == path
    if path != NONE:
        assert best.probability > 0.9
        assert best.low < change < best.high and best.change == pytest.approx(change, rel=0.5)


def test_tolerances_of_the_scene_are_no_change(tmp_path):
    text = load(ROOT / "configs" / "paper" / "point.yaml", [f"{GAP}=27.5 um ± 25 um", "oil_supply.ratio=3 ± 30 %"]).text
    (tmp_path / "machine.yaml").write_text(text, encoding="utf-8")
    grown = with_values(load(tmp_path / "machine.yaml"), {GAP: 37.5e-6})
    flow = simulate(grown, trace=False).performance["gas_mass_flow"]
    rpm = grown.operation.speed * 30.0 / np.pi
    rows = f"operation.speed [rpm],gas_mass_flow [kg/s],gas_mass_flow_uncertainty [kg/s]\n{rpm},{flow},{0.001 * flow}\n"
    (tmp_path / "points.csv").write_text(rows, encoding="utf-8")
    (tmp_path / "x.fit.yaml").write_text(
        f"scene: machine.yaml\ndata: points.csv\nparameters:\n  {GAP}: {{from: 15 um, to: 60 um}}\n", encoding="utf-8"
    )
    known = diagnose(read_fit(tmp_path / "x.fit.yaml", scene=ROOT / "configs" / "paper" / "point.yaml"), jobs=1)
    open_ = diagnose(read_fit(tmp_path / "x.fit.yaml"), jobs=1)
    assert known.hypotheses[0].path == GAP and known.hypotheses[0].probability > 0.9
    assert open_.hypotheses[0].path == NONE and set(open_.inputs) == {GAP, "oil_supply.ratio"}


@pytest.mark.usefixtures("quick")
def test_the_command_tells_what_changed(tmp_path, capsys):
    file = written(tmp_path, points(lambda n: 6.0 + 2.0 * n))
    assert exit_code(["diagnose", str(file), "--jobs", "1"]) == 0
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80
    assert f"most probable: {GAP} has changed by +1" in out and "nothing changed" in out
    assert exit_code(["diagnose", str(file), "--jobs", "1", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["hypotheses"][0]["path"] == GAP
    assert document["hypotheses"][0]["change"] == pytest.approx(1e-5, rel=0.1)
    assert sum(each["probability"] for each in document["hypotheses"]) == pytest.approx(1.0)
    (tmp_path / "new.csv").write_text(points(), encoding="utf-8")
    assert exit_code(["diagnose", str(file), "--jobs", "1", "--data", str(tmp_path / "new.csv")]) == 0
    assert "most probable: nothing changed" in capsys.readouterr().out


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    ("rest", "text", "code", "told"),
    [
        (("--unchanged", "2"), points(), 2, "--unchanged 2: is no probability"),
        (("--data", "none.csv"), points(), 2, "--data none.csv: is not a file"),
        (("--scene", "none.yaml"), points(), 2, "--scene none.yaml: is not a file"),
        ((), HEAD + "a,fit,1000,x,0.1\n", 3, "points.csv:2:12: shaft_power: 'x' is not a number"),
        ((), HEAD + "a,check,1000,5,0.1\n", 3, "leaves no point to fit"),
    ],
)
def test_bad_input_is_told_in_one_line(tmp_path, capsys, rest, text, code, told):
    assert exit_code(["diagnose", str(written(tmp_path, text)), *rest]) == code
    err = capsys.readouterr().err
    assert told in err and len(err.splitlines()) == 1
