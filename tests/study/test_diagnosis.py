"""Which parameter has changed: the probabilities are those of Bayes' rule, known changes of a machine are found."""

import json
from dataclasses import replace

import numpy as np
import pytest
from fit_fakes import CAPACITY, GAP, HEAD, ONE_START, SCENE, coordinates, plane, product, torn, write_fit
from folders import CONFIGS

import screwsim
from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.printing.diagnosis import diagnosis_document, print_diagnosis
from screwsim.scene import load, with_values
from screwsim.simulate import simulate
from screwsim.study.calibration import read_fit
from screwsim.study.calibration.diagnosis import MOST_PAIRS, diagnose
from screwsim.study.calibration.fit import Parameter, Prior
from screwsim.study.calibration.hypotheses import NO_CHANGE
from screwsim.study.calibration.machine import unchanged_fit
from screwsim.study.calibration.pair_likelihood import normal_about
from screwsim.study.calibration.profile import LinearLikelihood, linear_likelihood, whitener
from screwsim.study.pool.progress import CountingProgress
from screwsim.study.uncertainty.slopes import Sensitivities

pytestmark = pytest.mark.around

UNCHANGED = {GAP: "50 um", CAPACITY: "2 kJ/(kg K)"}  # 5 kW and 2 kW per 1000 rpm


def points(of=lambda n: 5.0 + 2.0 * n, seed=1, noise=0.05, count=6):
    generator, rows = np.random.default_rng(seed), []
    for number, n in enumerate(np.linspace(1.0, 4.0, count)):
        rows.append(f"p{number},fit,{1e3 * n},{of(n) + noise * generator.standard_normal():.6f},{noise}")
    return HEAD + "\n".join(rows) + "\n"


def measured_of(text):
    """Return the speeds [1000 rpm] and powers [kW] of points."""
    rows = [line.split(",") for line in text.splitlines()[1:]]
    return np.array([[float(row[2]) / 1e3, float(row[3])] for row in rows]).T


def written(folder, text):
    return write_fit(folder, ONE_START, text, screwsim.loads(SCENE).with_(UNCHANGED).text)


def asked(folder, text, simulator=plane, **how):
    return diagnose(read_fit(written(folder, text), fixed=False), simulate=simulator, jobs=1, **how)


def by_path(found):
    return {each.path: each for each in found.hypotheses}


def test_of_a_parameter_that_does_nothing_the_points_tell_nothing(tmp_path, capsys):
    """Its probability is that beforehand, and its interval that of its bounds; of another they tell. It has no best."""
    idle = ONE_START.replace(
        "oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K)}", "operation.ambient_temperature: IDLE"
    )
    fit = write_fit(
        tmp_path,
        idle.replace("IDLE", "{from: 280 K, to: 300 K}"),
        points(),
        screwsim.loads(SCENE).with_(UNCHANGED).text,
    )
    found = diagnose(read_fit(fit, fixed=False), simulate=plane, jobs=1)
    assert found.untold == ("operation.ambient_temperature",)
    print_diagnosis(found)
    (row,) = [line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("ambient_temperature")]
    assert "any" in row and not any(f"{found.unchanged['operation.ambient_temperature']:.4g}" == cell for cell in row)


def test_the_evidence_is_the_mean_likelihood_between_the_bounds():
    generator = np.random.default_rng(2)
    for place, size in ((0.3, 8.0), (0.02, 3.0), (0.9, 40.0), (0.5, 0.0)):
        residuals, slopes = generator.standard_normal(5), size * generator.standard_normal(5)
        found = linear_likelihood(place, residuals, slopes)
        u = np.linspace(0.0, 1.0, 200_001)
        chi_squared = np.sum((residuals + np.outer(u - place, slopes)) ** 2, axis=1)
        mean = np.trapezoid(np.exp(-0.5 * chi_squared), u)
        assert found.log_evidence == pytest.approx(np.log(mean), abs=1e-6)
        assert found.misfit == pytest.approx(chi_squared.min(), abs=1e-6)
        below = np.trapezoid(np.where(u < found.interval[0], np.exp(-0.5 * chi_squared), 0.0), u)
        assert below / mean == pytest.approx(0.05, abs=1e-3)


def test_an_estimate_far_beyond_a_bound_is_the_bound():
    far = LinearLikelihood(9.0, 1.0, 1e4)
    assert far.estimate == 1.0 and far.misfit == pytest.approx(1.0 + 1e4 * 64.0)
    assert np.isfinite(far.log_evidence) and 0.99 < far.interval[0] < 1.0


def test_inputs_that_are_not_known_widen_the_measurement():
    inputs = np.array([[1.0, 0.5], [0.0, 2.0], [1.0, 0.0]])
    white = whitener(inputs)
    assert np.allclose(white.T @ white, np.linalg.inv(np.eye(3) + inputs @ inputs.T))


def test_probabilities_are_those_of_bayes_rule(tmp_path):
    text = points(lambda n: 5.06 + 2.0 * n)
    found = by_path(asked(tmp_path, text, unchanged=0.4, pairs=0.0))
    n, measured = measured_of(text)

    def likelihood(gap, capacity):
        return np.exp(-0.5 * np.sum(((gap + capacity * n - measured) / 0.05) ** 2))

    none = 0.4 * likelihood(5.0, 2.0)
    grown = 0.3 * np.mean([likelihood(gap, 2.0) for gap in np.linspace(1.0, 10.0, 20_001)])
    other = 0.3 * np.mean([likelihood(5.0, capacity) for capacity in np.linspace(1.0, 3.0, 20_001)])
    total = none + grown + other
    for path, weight in ((NO_CHANGE, none), (GAP, grown), (CAPACITY, other)):
        assert found[path].probability == pytest.approx(weight / total, rel=1e-3)
        assert 0.01 < found[path].probability < 0.99  # of three that are all possible


def test_a_change_that_slopes_dismiss_is_solved_where_nothing_else_fits(tmp_path, monkeypatch):
    """The power rises with the square of the gap's change, so that its slope is nothing; the capacity does not fit."""

    def bowl(scene):
        gap, capacity, n = coordinates(scene)
        power = 5.0 + capacity * n + 0.3 * (gap - 5.0) ** 2 / n
        return Result("ok", performance=Figures(shaft_power=1e3 * power))

    monkeypatch.setattr("screwsim.study.calibration.diagnosis.LEAST_SINGLES", 1)
    found = asked(tmp_path, points(lambda n: 5.0 + 2.0 * n + 0.3 * 3.0**2 / n), bowl, pairs=0.0)
    assert found.hypotheses[0].path == GAP and found.hypotheses[0].linear == ""
    assert found.hypotheses[0].probability > 0.9 and found.chance > 0.01


def test_a_machine_that_has_not_changed_is_found_unchanged(tmp_path):
    first = []
    for seed in range(12):
        folder = tmp_path / str(seed)
        folder.mkdir()
        first.append(asked(folder, points(seed=seed)).hypotheses[0].path)
    assert first.count(NO_CHANGE) >= 11


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
    assert wide.hypotheses[0].path == NO_CHANGE and wide.inputs == (GAP,)


def test_two_parameters_that_enter_as_their_product_are_said_not_to_be_told_apart(tmp_path):
    found = asked(tmp_path, points(lambda n: 13.0 * n), product)
    assert {found.alike[0].first, found.alike[0].second} == {GAP, CAPACITY}
    assert found.alike[0].off < 0.5
    both = by_path(found)
    pair = both[f"{GAP} + {CAPACITY}"].probability  # leaves nothing more over: as probable as it was beforehand
    assert both[GAP].probability + both[CAPACITY].probability > 0.99 - pair and pair < 0.1
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
    n, measured = measured_of(text)
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


def test_progress_counts_points_and_then_hypotheses_that_are_solved(tmp_path):
    shown = CountingProgress()
    begun, shown.start = [], lambda cases, reused: begun.append(cases)
    asked(tmp_path, points(lambda n: 8.0 + 2.0 * n), pairs=0.0, progress=shown)
    assert begun == [6, 2]


def squared(scene):
    """Return a power with the square of the gap: at 50 um it is 5 kW."""
    gap, capacity, speed = coordinates(scene)
    return Result("ok", performance=Figures(shaft_power=1e3 * (0.2 * gap**2 + capacity * speed)))


def test_several_changes_at_once_are_said_to_fit_none_of_single_ones(tmp_path):
    found = asked(tmp_path, points(lambda n: 7.0 + 1.5 * n), pairs=0.0)
    assert found.chance < 0.01 and all(len(each.changes) < 2 for each in found.hypotheses)


def test_two_changes_at_once_are_found_and_one_is_not_taken_for_two(tmp_path):
    two, one = [], []
    for seed in range(10):
        folder = tmp_path / str(seed)
        folder.mkdir()
        two.append(asked(folder, points(lambda n: 7.0 + 1.5 * n, seed)))
        one.append(asked(folder, points(lambda n: 7.0 + 2.0 * n, seed)))
    for found in two:
        best = found.hypotheses[0]
        assert best.paths == (GAP, CAPACITY) and best.probability > 0.99 and best.linear == ""
        assert [each.change for each in best.changes] == pytest.approx([2e-5, -500.0], rel=0.15)
        assert found.chance > 1e-4 and min(found.changed.values()) > 0.99
    held = [
        each.low <= true <= each.high
        for found in two
        for each, true in zip(found.hypotheses[0].changes, (2e-5, -500.0), strict=True)
    ]
    assert sum(held) >= 15  # of 20 intervals of 90 %
    assert sum(found.hypotheses[0].paths == (GAP,) for found in one) >= 9
    assert np.mean([found.changed[CAPACITY] for found in one]) < 0.1


def test_the_evidence_of_two_changes_is_the_mean_likelihood_between_the_bounds_of_both():
    generator = np.random.default_rng(3)
    cases = [((0.3, 0.6), 8.0, 0.0), ((0.05, 0.9), 20.0, 0.9), ((0.5, 0.5), 1.0, 0.5), ((0.9, 0.1), 15.0, -1.0)]
    for places, size, alike in cases:
        residuals, slopes = generator.standard_normal(7), size * generator.standard_normal((7, 2))
        slopes[:, 1] = alike * slopes[:, 0] + (1.0 - abs(alike)) * slopes[:, 1]
        found = normal_about(np.array(places), residuals, slopes)
        u, v = np.meshgrid(np.linspace(0.0, 1.0, 2001), np.linspace(0.0, 1.0, 2001), indexing="ij")
        moved = (
            residuals[:, None, None]
            + slopes[:, 0, None, None] * (u - places[0])
            + slopes[:, 1, None, None] * (v - places[1])
        )
        likelihood = np.exp(-0.5 * np.sum(moved**2, axis=0))
        over_first = np.trapezoid(likelihood, v[0], axis=1)
        mean = np.trapezoid(over_first, u[:, 0])
        assert found.log_evidence == pytest.approx(np.log(mean), abs=2e-4)
        for axis, (low, high) in enumerate(found.intervals):
            along = over_first if axis == 0 else np.trapezoid(likelihood, u[:, 0], axis=0)
            below = np.concatenate([[0.0], np.cumsum(along[1:] + along[:-1])]) / np.sum(along[1:] + along[:-1])
            assert np.interp([low, high], u[:, 0], below) == pytest.approx([0.05, 0.95], abs=2e-3)


def test_probabilities_of_pairs_are_those_of_bayes_rule(tmp_path):
    text = points(lambda n: 5.4 + 1.9 * n)
    found = by_path(asked(tmp_path, text, unchanged=0.4, pairs=0.25))
    n, measured = measured_of(text)
    gaps, capacities = np.linspace(1.0, 10.0, 3001), np.linspace(1.0, 3.0, 3001)

    def likelihood(gap, capacity):
        off = np.asarray(gap)[..., None] + np.asarray(capacity)[..., None] * n - measured
        return np.exp(-0.5 * np.sum((off / 0.05) ** 2, axis=-1))

    both = np.mean([np.mean(likelihood(gaps, capacity)) for capacity in capacities])
    share = 0.6 / 1.25
    weights = {
        NO_CHANGE: 0.4 * likelihood(5.0, 2.0),
        GAP: 0.5 * share * np.mean(likelihood(gaps, np.full_like(gaps, 2.0))),
        CAPACITY: 0.5 * share * np.mean(likelihood(np.full_like(gaps, 5.0), capacities)),
        f"{GAP} + {CAPACITY}": 0.25 * share * both,
    }
    total = sum(weights.values())
    assert set(found) == set(weights) and sum(each.probability for each in found.values()) == pytest.approx(1.0)
    for path, weight in weights.items():
        assert found[path].probability == pytest.approx(weight / total, rel=5e-3, abs=1e-9)


MANY = {  # parameter: bounds, unchanged, its power per place in kW, its power per 1000 rpm in kW
    "effects.tip_leakage.gap": ("10 um", "100 um"),
    "oil.heat_capacity": ("1 kJ/(kg K)", "3 kJ/(kg K)"),
    "oil.density": ("600 kg/m^3", "1200 kg/m^3"),
    "effects.tip_leakage.flow_coefficient": (0.4, 1),
    "oil_supply.ratio": (1, 5),
    "operation.suction.temperature": ("270 K", "290 K"),
}


def bilinear(scene):
    """Return power and flow of six unknowns over two conditions; the first two also as their product."""
    tip = scene.effects["tip_leakage"].parameters
    u = np.array([1e5 * tip.gap - 5.0, scene.oil.heat_capacity / 1e3 - 2.0, scene.oil.density / 1e3 - 0.9])
    w = np.array(
        [
            4.0 * (tip.flow_coefficient - 0.7),
            scene.oil_supply.ratio - 3.0,
            0.2 * (scene.operation.suction.temperature - 280.0),
        ]
    )
    n = scene.operation.speed * 30.0 / np.pi / 1e3
    p = scene.operation.discharge.pressure / 1e6
    power = 20.0 + u @ [1.0, n, n * p] + w @ [n**2 / 4.0, p, p**2] + 0.4 * u[0] * u[1]
    flow = 3.0 + u @ [0.3 * n, 0.1 * p, 0.2] + w @ [0.2 * p, 0.3, 0.1 * n * p]
    return Result("ok", performance=Figures(shaft_power=1e3 * power, gas_mass_flow=flow))


def test_fifteen_pairs_of_six_parameters_cost_no_more_than_a_few(tmp_path):
    scene = screwsim.loads(SCENE).with_(
        {
            **UNCHANGED,
            "oil.density": "900 kg/m^3",
            "operation.suction.temperature": "280 K",
            "oil_supply.ratio": 3,
            "effects.tip_leakage.flow_coefficient": 0.7,
        }
    )
    truth, rows = {GAP: 7.5e-5, CAPACITY: 2600.0}, []
    generator = np.random.default_rng(4)
    for rpm in (1000.0, 2000.0, 3500.0):
        for bar in (8.0, 12.0):
            here = {**truth, "operation.speed": rpm * np.pi / 30.0, "operation.discharge.pressure": 1e5 * bar}
            figures = bilinear(with_values(scene, here)).performance
            power, flow = (
                figures[name] + size * generator.standard_normal()
                for name, size in (("shaft_power", 50.0), ("gas_mass_flow", 0.02))
            )
            rows.append(f"{rpm},{bar},{power},50,{flow},0.02")
    figures = "shaft_power [W],shaft_power_uncertainty [W],gas_mass_flow [kg/s],gas_mass_flow_uncertainty [kg/s]"
    text = "\n".join([f"{COLUMNS},{figures}", *rows]) + "\n"
    lines = "".join(f"  {path}: {{from: {low}, to: {high}}}\n" for path, (low, high) in MANY.items())
    file = write_fit(tmp_path, f"scene: machine.yaml\ndata: points.csv\nparameters:\n{lines}", text, scene.text)
    fit = read_fit(file, fixed=False)
    alone, found = (diagnose(fit, pairs=odds, simulate=bilinear, jobs=2) for odds in (0.0, 0.1))
    assert alone.chance < 0.01
    best = found.hypotheses[0]
    assert best.paths == (GAP, CAPACITY) and best.probability > 0.99 and best.linear == ""
    assert [each.change for each in best.changes] == pytest.approx([2.5e-5, 600.0], rel=0.1)
    assert sum(len(each.changes) == 2 for each in found.hypotheses) == 15
    assert sum(len(each.changes) == 2 and not each.linear for each in found.hypotheses) <= MOST_PAIRS
    # by the sum of two curves alone the product of both would be missed: solved it fits
    assert found.chance > 0.01
    assert found.solutions - alone.solutions <= 6 * 12 * MOST_PAIRS  # six points, a dozen solutions a pair


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
        ({GAP: 37.5e-6, "oil_supply.ratio": 1.5}, f"{GAP} + oil_supply.ratio", (10e-6, -1.5)),
        ({}, NO_CHANGE, None),
    ],
    ids=["gap", "oil", "gap and oil", "none"],
)
def test_known_changes_of_a_machine_are_found(tmp_path, truth, path, change):
    scene = CONFIGS / "paper" / "point.yaml"
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
    if path != NO_CHANGE:
        assert best.probability > (0.9 if len(best.changes) == 1 else 0.8)  # two gaps are much alike
        changes = np.atleast_1d(change).tolist()
        assert all(each.low < true < each.high for each, true in zip(best.changes, changes, strict=True))
        assert [each.change for each in best.changes] == pytest.approx(changes, rel=0.5)


def test_tolerances_of_the_scene_are_no_change(tmp_path):
    text = load(CONFIGS / "paper" / "point.yaml", [f"{GAP}=27.5 um ± 25 um", "oil_supply.ratio=3 ± 30 %"]).text
    (tmp_path / "machine.yaml").write_text(text, encoding="utf-8")
    grown = with_values(load(tmp_path / "machine.yaml"), {GAP: 37.5e-6})
    flow = simulate(grown, trace=False).performance["gas_mass_flow"]
    rpm = grown.operation.speed * 30.0 / np.pi
    rows = f"operation.speed [rpm],gas_mass_flow [kg/s],gas_mass_flow_uncertainty [kg/s]\n{rpm},{flow},{0.001 * flow}\n"
    (tmp_path / "points.csv").write_text(rows, encoding="utf-8")
    (tmp_path / "x.fit.yaml").write_text(
        f"scene: machine.yaml\ndata: points.csv\nparameters:\n  {GAP}: {{from: 15 um, to: 60 um}}\n", encoding="utf-8"
    )
    known = diagnose(read_fit(tmp_path / "x.fit.yaml", scene=CONFIGS / "paper" / "point.yaml"), jobs=1)
    open_ = diagnose(read_fit(tmp_path / "x.fit.yaml"), jobs=1)
    assert known.hypotheses[0].path == GAP and known.hypotheses[0].probability > 0.9
    assert open_.hypotheses[0].path == NO_CHANGE and set(open_.inputs) == {GAP, "oil_supply.ratio"}


def warmer(scene):
    """Return a shaft power [W] that rises by 1 kW/K with the surroundings."""
    _, _, n = coordinates(scene)
    return Result("ok", performance=Figures(shaft_power=1e3 * (scene.operation.ambient_temperature - 290.0 + 2.0 * n)))


def test_a_temperature_is_in_degrees_celsius_and_its_change_in_kelvins(tmp_path, capsys):
    """It was 303 K, as nowhere else."""
    path = "operation.ambient_temperature"
    fit = ONE_START.replace(
        "oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K)}", f"{path}: {{from: 10 degC, to: 50 degC}}"
    )
    scene = screwsim.loads(SCENE).with_({**UNCHANGED, path: "25 degC"}).text
    file = write_fit(tmp_path, fit, points(lambda n: 13.15 + 2.0 * n), scene)  # of 30 degC
    found = diagnose(read_fit(file, fixed=False), simulate=warmer, jobs=1)
    print_diagnosis(found)
    out = " ".join(capsys.readouterr().out.split())
    now = by_path(found)[path].value - 273.15
    assert now == pytest.approx(30.0, abs=0.1)
    assert (
        f" {now:.1f} °C ".replace(".0 ", " ") in out
        and f"most probable: {path} has changed by +{now - 25.0:.3g} K" in out
    )
    moved = replace(by_path(found)[path], also=(300.15,), probability=0.5)
    print_diagnosis(replace(found, hypotheses=(moved,)))
    assert f"{path} = 27 °C fits nearly as well" in capsys.readouterr().out


def test_a_diagnosis_goes_on_without_an_input_that_has_no_derivative_and_says_so(tmp_path, monkeypatch, capsys):
    """It refused the whole question."""
    ratio, lost = "oil_supply.ratio", Sensitivities(Result("ok"), left_out={"oil_supply.ratio": "too hot"})
    monkeypatch.setattr("screwsim.study.uncertainty.point.sensitivities", lambda *asked, **more: lost)
    certain = asked(tmp_path, points(lambda n: 6.0 + 2.0 * n))
    scene = screwsim.loads(SCENE).with_({**UNCHANGED, ratio: "3 ± 10 %"}).text
    (tmp_path / "machine.yaml").write_text(scene, encoding="utf-8")
    found = diagnose(read_fit(tmp_path / "small.fit.yaml", fixed=False), simulate=plane, jobs=1)
    assert (found.hypotheses, found.inputs) == (certain.hypotheses, ())
    assert diagnosis_document(found)["left_out"] == {ratio: "at p0: too hot"}
    print_diagnosis(found)
    told = f"warning: the tolerance of {ratio} is not included in the uncertainties: at p0: too hot"
    assert told in " ".join(capsys.readouterr().out.split())


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
    (tmp_path / "new.csv").write_text(points(lambda n: 20.0 + 2.0 * n), encoding="utf-8")  # a gap of 200 um
    assert exit_code(["diagnose", str(file), "--jobs", "1", "--data", str(tmp_path / "new.csv")]) == 0
    assert f"warning: {GAP} is at its upper bound, 0.1 mm; it may" in " ".join(capsys.readouterr().out.split())
    (tmp_path / "new.csv").write_text(points(), encoding="utf-8")
    assert exit_code(["diagnose", str(file), "--jobs", "1", "--data", str(tmp_path / "new.csv")]) == 0
    assert "most probable: nothing changed" in capsys.readouterr().out


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    ("rest", "text", "code", "told"),
    [
        (("--unchanged", "2"), points(), 2, "--unchanged 2: is not a probability"),
        (("--pairs", "-1"), points(), 2, "--pairs -1: is not the odds of two changes against one (write e.g. 0.1"),
        (("--pairs", "inf"), points(), 2, "--pairs inf: is not the odds"),
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


def test_what_is_found_with_the_cycle_states_no_unchanged_value(tmp_path):
    """It holds 0 K, where the search begins, which is no temperature that the machine had."""
    path = "effects.economizer.temperature"
    port = "{temperature: auto, area: 100 mm^2, opens: 455 deg, closes: 545 deg}"
    auto = load(CONFIGS / "r134a" / "point.yaml", [f"effects.economizer={port}"])
    sought = Parameter(path, 270.0, 300.0, None, None, False, (), False)
    fit = replace(read_fit(written(tmp_path, points())), scene=auto, parameters=(sought,))
    with pytest.raises(UsageError, match=f"{path}: is not stated in the scene"):
        unchanged_fit(fit, None)
