"""Public functions hold their arguments to their kinds: what is none ends in one line, before anything is simulated."""

import inspect
import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from each_row import each_row

import screwsim
from screwsim.inputs.arguments import FLAG, JOBS, NUMBER, TEXTS, checked_arguments, one_of
from screwsim.study import seek

CONFIGS = Path(__file__).parents[1] / "configs"
POINT = str(CONFIGS / "paper" / "point.yaml")
FIT = str(CONFIGS / "calibration" / "leakage.fit.yaml")
UNCERTAIN = str(CONFIGS / "paper" / "uncertain.yaml")
VARY, GOALS = {"oil_supply.ratio": (1.0, 3.0)}, {"discharge_temperature": 340.0}
CALLS = {
    "simulate": {"scene": POINT},
    "sweep": {"scene": POINT},
    "run_sweep": {"scene": POINT, "output": "out.h5"},
    "optimum": {"scene": POINT},
    "datasheet": {"scene": POINT},
    "performance_map": {"results": "map.h5"},
    "compare": {"a": "map.h5", "b": "map.h5"},
    "evaluate_map": {"results": "map.h5", "evaporating_temperature": 275.0, "condensing_temperature": 315.0},
    "calibrate": {"fit": FIT},
    "posterior": {"fit": FIT},
    "diagnose": {"fit": FIT},
    "plan": {"fit": FIT, "ranges": {"operation.speed": ("1000 rpm", "4000 rpm")}},
    "find": {"scene": POINT, "vary": VARY, "goals": GOALS},
    "optimize": {"scene": POINT, "vary": VARY},
    "load": {"path": POINT},
    "loads": {"text": "title: x\n"},
    "open_results": {"path": "map.h5"},
    "sensitivities": {"scene": POINT},
    "sobol_indices": {"scene": POINT, "ranges": ["oil_supply.ratio=0.5..2"]},
    "tabulate": {"source": POINT, "over": {"operation.speed": (200.0, 300.0)}},
    "uncertainty": {"scene": UNCERTAIN},
}
STRANGE = [object(), math.nan, -1, {"x": 1}, b"x", [3]]  # of no argument all of them make sense
# what a function cannot know to be none before it reads it
READ = {("sweep", "options"), ("evaluate_map", "others")}
ARGUMENTS = [
    (name, each)
    for name in CALLS
    for each in inspect.signature(getattr(screwsim, name)).parameters
    if (name, each) not in READ
]


def test_every_public_function_is_called():
    functions = {name for name in screwsim.__all__ if inspect.isfunction(getattr(screwsim, name))}
    assert functions - {"schema"} == set(CALLS)


def test_a_dict_of_overrides_is_told_who_takes_one():
    with pytest.raises(
        screwsim.UsageError, match=r"overrides: .* is neither a text nor a list of .* \.with_ takes a dict"
    ):
        screwsim.load(POINT, overrides={"operation.speed": "3000 rpm"})
    screwsim.load(POINT).with_({"operation.speed": "3000 rpm"})


@pytest.mark.parametrize(("name", "argument"), ARGUMENTS)
def test_a_strange_argument_is_told_in_one_line(name, argument, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for strange in STRANGE:
        meant = {"unchanged", "pairs", "case_limit", "low", "high", "evaporating_temperature", "condensing_temperature"}
        mapping = {"ranges", "vary", "over", "goals", "scene", "source", "without", "figures", "paths"}
        mapping |= {"limits", "maximize", "minimize", "subject_to"}
        mapping |= {"path"} if name == "load" else set()
        if (strange == -1 and argument in meant) or (isinstance(strange, dict) and argument in mapping):
            continue  # of the right kind: what is wrong with it is told by what reads it
        if strange == [3] and argument == "catalogue":
            continue
        with pytest.raises((screwsim.UsageError, screwsim.SceneError)) as told:
            getattr(screwsim, name)(**{**CALLS[name], argument: strange})
        assert "\n" not in str(told.value)
    assert not list(tmp_path.iterdir())


@each_row(
    ("name", "given", "told"),
    [
        ("simulate", {"trace": "all"}, "trace: 'all' is none of True, False, 'ledger'"),
        ("simulate", {"trace": 1}, "trace: 1 is none of True, False, 'ledger'"),
        (
            "run_sweep",
            {"jobs": "two"},
            r"jobs: 'two' is not a number of workers \(pass 1 or more, or None",
        ),
        ("sweep", {"jobs": True}, "jobs: True is not a number of workers"),
        ("optimum", {"minimum": "no"}, "minimum: 'no' is neither True nor False"),
        ("datasheet", {"output": "sheet.txt"}, "a data sheet is an HTML page, a PDF or a table"),
        ("plan", {"ranges": {"operation.speed": 3}}, r"ranges\['operation.speed'\]: 3 is not a pair"),
        ("find", {"vary": {"oil_supply.ratio": (3, 1)}}, r"oil_supply.ratio: \(3, 1\) is not a range"),
        ("find", {"goals": {"discharge_temperature": None}}, "goal discharge_temperature: None is neither a number"),
        ("find", {"goals": {"discharge_temperature": "hot"}}, "goal discharge_temperature"),
        ("optimize", {"vary": {"oil_supply.ratio": 3}}, "oil_supply.ratio: 3 is not a range"),
        ("tabulate", {"most_cases": 1}, r"most_cases: 1 is too few grid points \(pass 2 or more\)"),
        ("tabulate", {"over": {"operation.speed": 3}}, r"operation.speed: 3 is not a range"),
        ("tabulate", {"error": 1e-9}, "^error 1e-09: is not between the scene's numerics.accuracy"),
        ("tabulate", {"figures": "shaft_power, gas_mass_flow"}, r"names 2 figures \(give each one by itself"),
        ("optimize", {"evaluations": 3.5}, "evaluations: 3.5 is no number of evaluations"),
        ("load", {"path": ""}, "path: '' is neither the path of a file nor a dict"),
    ],
)
def test_what_is_wrong_and_what_to_pass_is_told(name, given, told):
    with pytest.raises(screwsim.UsageError, match=told):
        getattr(screwsim, name)(**{**CALLS[name], **given})


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda scene, results: scene.with_(3), "values: 3 is no dict"),
        (
            lambda scene, results: results.to_xarray("figures"),
            "group: 'figures' is none of None, 'inputs', 'performance'",
        ),
        (lambda scene, results: results.to_pandas(None), "group: None is none of 'inputs', 'performance'"),
        (lambda scene, results: screwsim.plot.curves(results, 3), "figure: 3 is no text"),
        (lambda scene, results: screwsim.plot.contours(results, ["x"]), r"figure: \['x'\] is no text"),
    ],
)
def test_methods_and_drawings_tell_it_too(call, told, tmp_path):
    scene = screwsim.load(POINT, ["numerics.error=none", "numerics.accuracy=1e-2"])
    results = results_in(scene, tmp_path / "out.h5")
    with pytest.raises(screwsim.UsageError, match=told):
        call(scene, results)


def results_in(scene, path):
    swept = scene.with_({"sweep": {"oil_supply.ratio": [1.0, 2.0]}})
    screwsim.run_sweep(swept, path, jobs=1)
    return screwsim.open_results(path)


def test_numbers_of_numpy_are_numbers():
    assert JOBS.holds(np.int64(2)) and JOBS.holds(None) and NUMBER.holds(np.float64(0.5)) and FLAG.holds(np.True_)
    assert not JOBS.holds(np.float64(2.0)) and not NUMBER.holds(np.nan)


def test_choices_are_held_by_what_they_are():
    kind = one_of(True, False, None, "ledger")
    assert all(map(kind.holds, (np.True_, np.False_, True, None, np.str_("ledger"))))
    assert not any(map(kind.holds, (1, 0, 0.0, np.int64(1), np.float64(0.0), "", "Ledger", np.array([True, False]))))


def test_texts_and_numbers_may_stand_in_columns():
    """What numpy and pandas hand over is no shorter way to say "all"."""
    scene = screwsim.load(POINT)
    paths, figures = pd.Index(["oil_supply.ratio"]), pd.Series(["shaft_power"])
    assert set(screwsim.sensitivities(scene, paths, figures, fine=False).derivatives) == {"shaft_power"}
    size, ends = "machine.volume.max", np.array([400e-6, 600e-6])
    asked = seek.question(scene, {size: ends}, {"gas_mass_flow": np.float32(0.1)}, pd.Series([500e-6, 450e-6]))
    assert asked.sizes == (450e-6, 500e-6) and asked.spans[0].path == size
    assert seek.question(scene, {size: ends}, {"gas_mass_flow": 0.1}, np.array([])).sizes == ()


def test_a_pair_may_be_an_array(monkeypatch):
    monkeypatch.setattr("screwsim.api.candidates_of", lambda fit, file, texts, levels: texts)
    monkeypatch.setattr("screwsim.api._plan", lambda fit, points, **rest: points)
    ends = np.array(["1000 rpm", "4000 rpm"])
    assert screwsim.plan(FIT, ranges={"operation.speed": ends}) == ["operation.speed=1000 rpm..4000 rpm"]


@pytest.mark.parametrize("limit", [np.float32(60.0), np.int64(60), Fraction(60)])
def test_a_limit_of_any_number_ends_no_case_that_is_within(limit, tmp_path):
    swept = screwsim.load(POINT).with_({"sweep.operation.speed": ["1000 rpm", "2000 rpm"], "numerics.error": "none"})
    assert screwsim.run_sweep(swept, tmp_path / "out.h5", jobs=1, case_limit=limit).ok == 2


def test_what_can_be_read_but_once_is_left_to_the_function():
    @checked_arguments(texts=TEXTS)
    def listed(texts):
        return list(texts)

    assert listed(each for each in ("a", "b")) == ["a", "b"]


def test_a_goal_may_be_written_as_on_the_command_line():
    from screwsim.study.seek import question

    scene = screwsim.load(POINT)
    asked = [question(scene, VARY, {"discharge_temperature": value}) for value in (343.15, "70 degC")]
    assert asked[0].goals[0].value == pytest.approx(asked[1].goals[0].value, rel=1e-12)


def test_what_numpy_does_on_rounding_is_not_the_callers_choice():
    @checked_arguments()
    def smallest():
        return float(np.exp(np.array([-1e4]))[0]), np.geterr()["under"]

    with np.errstate(all="raise"):
        assert smallest() == (0.0, "ignore")
        assert np.geterr()["under"] == "raise"


@pytest.mark.around
def test_a_diagnosis_is_the_same_where_the_caller_lets_numpy_raise():
    fault = str(CONFIGS / "calibration" / "fault.fit.yaml")
    with np.errstate(all="raise"):
        found = screwsim.diagnose(fault, pairs=0.0)
    assert sum(each.probability for each in found.hypotheses) == pytest.approx(1.0, abs=1e-9)
