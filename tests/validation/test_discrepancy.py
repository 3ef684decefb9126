"""The error of the model: E = S - D with its interval, points that were fitted apart, and where it holds."""

import json
import math
from dataclasses import replace

import pytest
from folders import ROOT

import screwsim
from screwsim.outputs import Figures, Result
from screwsim.scene.model_errors import range_text, stored_model_errors
from screwsim.study.uncertainty.model_error import model_error
from screwsim.study.uncertainty.point import with_uncertainty
from screwsim.study.validation import ValidationPoint, compared, model_errors
from screwsim.study.validation.discrepancy import interval
from screwsim.study.validation.record import errors_report

ROWS = json.loads((ROOT / "validation" / "results.json").read_text(encoding="utf-8"))["sources"]["bitzer"]["rows"]
AT = {"machine.kind": "twin_screw", "gas.fluid": "R134a", "operation.speed": 309.0, "pressure_ratio": 3.0}


def point(ours, theirs, figure="shaft_power", fitted=False, parts=(3.0, 4.0, 12.0), ratio=3.0):
    """Return a point with standard uncertainties of ours, its inputs and the source."""
    return ValidationPoint("m", "p", figure, ours, theirs, *parts, fitted, {**AT, "pressure_ratio": ratio})


def test_the_interval_is_e_and_twice_all_three_uncertainties_in_squares():
    assert interval(point(1100.0, 1000.0)) == pytest.approx((0.1, 0.1 - 0.026, 0.1 + 0.026))  # 3, 4, 12: 13
    efficiency = point(0.75, 0.70, "isentropic_efficiency", parts=(0.0, None, 0.01))
    assert interval(efficiency) == pytest.approx((0.05, 0.03, 0.07))  # of efficiencies in points


def test_a_solved_point_brings_its_own_numerical_error_and_what_its_tolerances_make():
    scene = screwsim.load(ROOT / "configs/paper/point.yaml", ["operation.speed=1000 rpm ± 3 %"])
    result = screwsim.simulate(scene, trace=False)
    (found,) = compared("m", "p", scene, result, {"displacement_flow": 0.03}, stated={"displacement_flow": 1e-4})
    flow = result.performance.displacement_flow
    assert found.inputs == pytest.approx(0.015 * flow, rel=1e-6)
    assert (found.stated, found.numerical) == (1e-4, pytest.approx(result.error["displacement_flow"] * flow))
    assert found.at["pressure_ratio"] == pytest.approx(result.performance.pressure_ratio)
    unknown = replace(result, error={})
    (bare,) = compared("m", "p", screwsim.load(ROOT / "configs/paper/point.yaml"), unknown, {"displacement_flow": 0.03})
    assert (bare.numerical, bare.inputs, bare.stated) == (None, None, None)


def test_points_of_the_fit_are_apart_and_what_nobody_states_is_named():
    points = [point(1100.0, 1000.0), point(950.0, 1000.0, parts=(0.0, None, None), ratio=5.0)]
    found = model_errors([*points, point(1300.0, 1000.0, fitted=True, ratio=9.0)], "s", "c")["m"]
    told = found["figures"]["shaft_power"]
    assert told["held_out"] == pytest.approx({"points": 2, "mean": 0.025, "low": -0.05, "high": 0.126})
    assert told["fitted"]["points"] == 1
    assert told["not_stated"] == ["u_input", "u_D"]
    assert found["range"]["pressure_ratio"] == [3.0, 5.0]  # where something was predicted
    assert "1 points fitted to, no evidence" in errors_report({"m": found})


def test_what_is_shipped_is_what_the_stored_validation_has():
    for machine, name in (("bitzer", "fitted machine, "), ("bitzer_paper_laws", "by the paper's laws, ")):
        for figure, word in (("volumetric_efficiency", ": volumetric"), ("isentropic_efficiency", ": isentropic")):
            for kind, part in (("published", "held_out"), ("calibrated", "fitted")):
                rows = [row for row in ROWS if row["quantity"].startswith(name) and row["quantity"].endswith(word)]
                errors = [0.01 * (row["ours"] - row["theirs"]) for row in rows if row["kind"] == kind]
                told = stored_model_errors()[machine]["figures"][figure][part]
                assert told["points"] == len(errors)
                assert told["mean"] == pytest.approx(math.fsum(errors) / len(errors), abs=2e-4)
                assert (told["low"], told["high"]) == pytest.approx((min(errors), max(errors)), abs=5e-4)


def test_rated_compressors_of_which_nothing_is_fitted_say_by_how_much_a_written_machine_is_off():
    told = stored_model_errors()["reciprocating_r404a"]["figures"]["electrical_isentropic_efficiency"]
    every = json.loads((ROOT / "validation" / "results.json").read_text(encoding="utf-8"))["sources"]["energyplus"]
    rows = [row for row in every["rows"] if row["quantity"].startswith("R404A, ")]
    off = [0.01 * (row["ours"] - row["theirs"]) for row in rows]
    assert told["fitted"] is None and told["held_out"]["points"] == 6 * len(off)  # each beside six machines
    assert told["held_out"]["mean"] == pytest.approx(math.fsum(off) / len(off), abs=1e-6)
    assert told["held_out"]["low"] < min(off) and max(off) < told["held_out"]["high"]
    scene = ROOT / "validation" / "energyplus" / "machine.yaml"
    figures = {"pressure_ratio": 4.25, "electrical_isentropic_efficiency": 0.68}
    inside, fast = (
        model_error(screwsim.load(scene, ["uncertainty.model=reciprocating_r404a", *more]), figures)
        for more in ((), ("operation.speed=2950 rpm",))
    )
    assert inside["outside"] == [] and [text.partition(" ")[0] for text in fast["outside"]] == ["speed"]


@pytest.mark.parametrize("machine", ["screw_r134a", "hsk"])
def test_ratings_over_speed_bound_the_error_of_written_and_of_fitted_screws(machine):
    """The interval of all points that nothing was fitted to contains the largest differences of the comparison."""
    every = json.loads((ROOT / "validation" / "results.json").read_text(encoding="utf-8"))["sources"]["hsk"]["rows"]
    head = "new, " if machine == "screw_r134a" else "fitted machine, predicted"
    figures = {"λ": "volumetric_efficiency", "electrical η_s": "electrical_isentropic_efficiency"}
    told = stored_model_errors()[machine]["figures"]
    for word, figure in figures.items():
        mark = f": {word}, largest difference"
        off = [0.01 * row["ours"] for row in every if row["quantity"].startswith(head) and mark in row["quantity"]]
        assert len(off) == (4 if machine == "screw_r134a" else 3)
        assert told[figure]["held_out"]["low"] < min(off) and max(off) < told[figure]["held_out"]["high"]
        assert ("u_D" in told[figure]["not_stated"]) is (word != "λ")


def test_a_scene_is_told_the_error_of_the_validation_that_it_names_and_where_it_is_another():
    scene = screwsim.load(ROOT / "validation" / "bitzer" / "fitted" / "scene.yaml", ["uncertainty.model=bitzer"])
    figures = {"pressure_ratio": 4.0, "isentropic_efficiency": 0.7}
    found = model_error(scene, figures)
    assert found["outside"] == []
    told = stored_model_errors()["bitzer"]["figures"]["isentropic_efficiency"]["held_out"]
    assert found["figures"]["isentropic_efficiency"]["low"] == told["low"]
    far = model_error(
        screwsim.load(ROOT / "configs/paper/point.yaml", ["uncertainty.model=cagi"]), {"pressure_ratio": 3.0}
    )
    assert [text.partition(" ")[0] for text in far["outside"]] == ["fluid", "speed", "pressure"]


def test_a_scene_outside_the_validated_range_warns_as_of_anything_else():
    result = Result("ok", performance=Figures(pressure_ratio=3.0), warnings=("another",))
    scene = screwsim.load(ROOT / "configs/paper/point.yaml", ["uncertainty.model=cagi"])
    another, told = with_uncertainty(scene, result).warnings
    assert another == "another" and told.startswith("outside the validated range of cagi, so")
    assert all(word in told for word in ("fluid", "speed", "pressure ratio"))
    inside = screwsim.load(ROOT / "validation" / "bitzer" / "fitted" / "scene.yaml", ["uncertainty.model=bitzer"])
    assert with_uncertainty(inside, result).warnings == ("another",)


@pytest.mark.parametrize(
    ("figure", "inside", "outside", "told"),
    [
        ("displacement", (4.83e-4, 3.07e-3), (4.5e-4, 3.3e-3), "displacement per revolution"),
        ("evaporating_temperature", (258.0, 283.5), (250.0, 285.0), "evaporating temperature"),
        ("condensing_temperature", (303.0, 328.5), (300.0, 333.0), "condensing temperature"),
    ],
)
def test_a_size_or_a_temperature_outside_of_the_ratings_is_told(figure, inside, outside, told):
    scene = screwsim.load(ROOT / "validation" / "hsk" / "machine.yaml", ["uncertainty.model=screw_r134a"])
    for value in (*inside, *outside):
        found = model_error(scene, {"pressure_ratio": 3.0, figure: value})["outside"]
        assert [text.startswith(told) for text in found] == ([True] if value in outside else [])


def test_every_model_error_states_the_size_that_it_holds_for_and_of_a_machine_with_saturation_the_temperatures():
    for name, stated in stored_model_errors().items():
        assert "displacement" in stated["range"]
        there = {"evaporating_temperature", "condensing_temperature"} <= set(stated["range"])
        assert there is (name != "cagi")  # air


def test_a_package_of_another_size_than_the_one_compared_with_a_data_sheet_is_told():
    scene = screwsim.load(ROOT / "validation" / "cagi" / "machine.yaml", ["uncertainty.model=cagi"])
    own = screwsim.simulate(scene).performance
    assert model_error(scene, {**own, "pressure_ratio": 9.62})["outside"] == []
    small = model_error(scene, {**own, "pressure_ratio": 9.62, "displacement": 2.112e-3})["outside"]
    assert small == ["displacement per revolution 2112 cm³ (7122 cm³)"]


def test_a_scene_that_names_none_is_told_nothing():
    assert model_error(screwsim.load(ROOT / "configs/paper/point.yaml"), {"pressure_ratio": 3.0}) == {}


def test_the_range_is_in_words():
    known = {
        "machine.kind": ["twin_screw"],
        "operation.speed": [104.7197551, 314.1592654],
        "pressure_ratio": [2.0, 2.0],
    }
    cold = {"evaporating_temperature": [273.1499999999, 278.15], "displacement": [4.8276e-4, 3.0747e-3]}
    more = "evaporating temperature 0 °C to 5 °C, displacement per revolution 482.8 cm³ to 3075 cm³"
    assert range_text(cold) == more
    assert range_text(known) == "machine twin_screw, speed 1000 rpm to 3000 rpm, pressure ratio 2"
