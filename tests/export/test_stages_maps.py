"""Maps of two stages in series: polynomials and tables are those of single runs, under the names of both stages."""

import csv
import json
from dataclasses import replace
from types import SimpleNamespace
from zipfile import ZipFile

import numpy as np
import pytest
from scenes import scene_dict

from screwsim.cli import exit_code
from screwsim.export.en12900 import FIGURES, en12900_document
from screwsim.export.energyplus import energyplus_objects
from screwsim.export.inputs import read_inputs, read_outputs
from screwsim.export.polynomials import polynomials
from screwsim.export.source import map_of
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.results import open_results
from screwsim.study.maps.map_points import evaluate_map, points_at
from screwsim.study.maps.performance_map import PerformanceMap, PolynomialFit, performance_maps
from screwsim.study.stages import read_stages
from screwsim.study.stages.result import ChainResult, figures_of_both
from screwsim.study.sweep import stages as points

pytestmark = pytest.mark.around

EVAPORATING, CONDENSING = "first.operation.evaporating_temperature", "second.operation.condensing_temperature"
SPEED = "second.operation.speed"
AXES = {
    EVAPORATING: ["-30 degC", "-25 degC", "-20 degC", "-15 degC"],
    CONDENSING: ["30 degC", "35 degC", "40 degC", "45 degC"],
}
FRESH = {EVAPORATING: 273.15 - 23.4, CONDENSING: 273.15 + 41.7}


def operation(evaporating: str, condensing: str, speed: str, **more: str) -> dict:
    both = {"evaporating_temperature": evaporating, "condensing_temperature": condensing}
    return scene_dict({"operation": {"speed": speed, **both, **more}, "gas.model": "ideal"})


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    """Return a function that writes a two-stage file, R134a as an ideal gas, and returns its path."""
    folder = tmp_path_factory.mktemp("plant")
    low = operation("-25 degC", "5 degC", "3000 rpm", superheat="8 K")
    high = operation("0 degC", "40 degC", "1300 rpm", superheat="5 K", subcooling="3 K")
    (folder / "low.yaml").write_text(json.dumps(low))
    (folder / "high.yaml").write_text(json.dumps(high))

    def write(**content) -> str:
        path = folder / "plant.stages.yaml"
        path.write_text(json.dumps({"title": "plant", "stages": ["low.yaml", "high.yaml"], **content}))
        return str(path)

    return write


@pytest.fixture(scope="module")
def swept(plant, tmp_path_factory):
    """Return the results of a sweep over both temperatures."""
    out = tmp_path_factory.mktemp("swept") / "map.h5"
    assert exit_code(["sweep", plant(sweep=AXES), "-o", str(out), "--jobs", "1"]) == 0
    return open_results(out)


@pytest.fixture(scope="module")
def fresh(plant):
    """Return the figures of a run at a point that no map was made from."""
    return read_stages(plant()).with_values(FRESH).solved().performance


def test_the_map_is_a_run_at_a_fresh_point_within_its_error(swept, fresh):
    (one,) = performance_maps(swept)
    assert list(one.fits) == ["shaft_power", "gas_mass_flow", "cooling_capacity"]
    found = evaluate_map(swept, *FRESH.values())
    for name, value in found.items():
        assert 0.0 < one.fits[name].left_out < 0.01
        assert value == pytest.approx(fresh[name], rel=one.fits[name].left_out)


def test_coefficients_of_the_standards_are_those_of_runs_with_the_conditions_of_each_stage(swept, fresh):
    found = polynomials(swept, FIGURES)
    document = en12900_document(found)
    told = {EVAPORATING.replace("evaporating_temperature", "superheat"): 8.0}
    told |= {CONDENSING.replace("condensing_temperature", "subcooling"): 3.0}
    assert told.items() <= document["conditions"].items() and document["fluid"] == "R134a"
    S, D = (T - 273.15 for T in FRESH.values())
    for name, figure in document["maps"][0]["figures"].items():
        c = list(figure["coefficients"].values())
        value = np.dot(c, [1, S, D, S * S, S * D, D * D, S**3, D * S * S, S * D * D, D**3])
        assert value == pytest.approx(fresh[name], rel=figure["left_out_error"])


def test_curves_for_energyplus_rate_superheat_of_the_first_and_subcooling_of_the_second_stage(swept):
    objects = energyplus_objects(polynomials(swept, ["shaft_power", "cooling_capacity"]), "plant")
    (compressor,) = objects["Refrigeration:Compressor"].values()
    assert (compressor["rated_superheat"], compressor["rated_subcooling"]) == (8.0, 3.0)
    assert list(objects["Curve:Bicubic"]) == ["plant power", "plant capacity"]


def test_a_map_is_read_at_points_by_short_names(swept, capsys):
    at = "evaporating_temperature=-23.4 degC, condensing_temperature=41.7 degC"
    assert exit_code(["map", str(swept.path), "--at", at, "--json"]) == 0
    (point,) = json.loads(capsys.readouterr().out)["points"]
    assert point["figures"] == pytest.approx(evaluate_map(swept, *FRESH.values()), rel=1e-9)


def test_a_table_made_for_two_stages_keeps_its_error_at_a_fresh_point(plant):
    figures = ["intermediate_pressure", "cooling_capacity"]
    table = map_of(plant(), [f"{SPEED}=1200 rpm..1500 rpm"], figures, 0.01, jobs=1)
    assert table.met and table.checked == 32
    speed = 1391.0 * np.pi / 30.0
    run = read_stages(plant()).with_values({SPEED: speed}).solved().performance
    for name, error in zip(figures, table.errors, strict=True):
        assert float(table.evaluate(second_speed=speed)[name]) == pytest.approx(run[name], rel=0.01)
        assert error < 0.01
    whole, *stages = table.scene_yaml.split("---\n")
    assert "stages: [first.yaml, second.yaml]" in whole
    assert [text.splitlines()[0] for text in stages] == ["# first.yaml", "# second.yaml"]


def test_inputs_are_named_by_their_stage_only_where_both_have_them(plant):
    over = {EVAPORATING: (243.0, 253.0), "first.operation.speed": (200.0, 300.0), SPEED: (100.0, 150.0)}
    found = read_inputs(read_stages(plant()), over)
    assert [one.name for one in found] == ["evaporating_temperature", "first_speed", "second_speed"]
    assert [one.long_name.rpartition(", ")[2] for one in found] == ["first stage", "first stage", "second stage"]


def test_usual_outputs_are_those_that_the_plant_has(plant):
    names = [each.name for each in read_outputs(read_stages(plant()))]
    assert names == ["gas_mass_flow", "shaft_power", "discharge_temperature", "cooling_capacity", "heating_capacity"]
    needed = "a motor in both scenes and air for its gas"
    with pytest.raises(UsageError, match=f"package_input_power: .* these two stages: it needs {needed} "):
        read_outputs(read_stages(plant()), ["package_input_power"])


def test_a_sweep_of_two_stages_is_a_table(swept, tmp_path):
    out = tmp_path / "nodes.csv"
    assert exit_code(["export", "csv", str(swept.path), "-o", str(out)]) == 0
    rows = list(csv.reader(out.read_text().splitlines()[1:]))
    assert rows[0][:2] == ["evaporating_temperature [K]", "condensing_temperature [K]"]
    powers = [float(row[rows[0].index("shaft_power [W]")]) for row in rows[1:]]
    assert powers == pytest.approx(swept.performance["shaft_power"].ravel().tolist(), rel=1e-10)


@pytest.fixture
def summed(monkeypatch):
    """Replace the solution of a point by one that is immediate: a power of the first speed and ten times the second."""

    def answer(chain, values, warm):
        stage = Result("ok", performance=Figures(shaft_power=1.0))
        power = chain.with_values(values)
        whole = figures_of_both({"shaft_power": power.first.operation.speed + 10.0 * power.second.operation.speed})
        return ChainResult("ok", stages=(stage, stage), scenes=(chain.first, chain.second), performance=whole)

    monkeypatch.setattr(points, "solved_with", answer)


FIRST_SPEED = "first.operation.speed"
FALLING = {FIRST_SPEED: ["3000 rpm", "2000 rpm", "1000 rpm"], SPEED: ["1300 rpm", "1200 rpm", "700 rpm"]}
TURNING = {FIRST_SPEED: ["3000 rpm", "1000 rpm", "2000 rpm"], SPEED: ["1300 rpm", "1200 rpm", "700 rpm"]}


@pytest.mark.parametrize("stored", [False, True])
def test_what_a_sweep_varies_together_is_one_input(plant, summed, tmp_path, stored):
    """At 1500 rpm the second stage turns half-way between 700 and 1200 rpm, from the file and from its results."""
    source, out = plant(sweep={"zip": [FALLING]}), tmp_path / "speeds.h5"
    if stored:
        assert exit_code(["sweep", source, "-o", str(out), "--jobs", "1"]) == 0
    table = map_of(str(out) if stored else source, figures=["shaft_power"], jobs=1)
    (speed,) = table.inputs
    assert speed.name == "first_speed" and speed.long_name.endswith(f"first stage, with {SPEED} as in the sweep")
    rpm = np.pi / 30.0
    nodes = speed.at(table.grid.nodes[0])
    powers = nodes + 10.0 * np.interp(
        nodes, [1000.0 * rpm, 2000.0 * rpm, 3000.0 * rpm], [700 * rpm, 1200 * rpm, 1300 * rpm]
    )
    assert table.evaluate(first_speed=nodes)["shaft_power"].tolist() == pytest.approx(powers.tolist(), rel=1e-12)
    if not stored:
        assert table.met and float(table.evaluate(first_speed=1500.0 * rpm)["shaft_power"]) == pytest.approx(
            (1500.0 + 9500.0) * rpm, rel=table.wanted
        )


def test_a_map_tells_what_follows_its_inputs(plant, summed, tmp_path, capsys):
    rpm = np.pi / 30.0
    source, out, unit = plant(sweep={"zip": [FALLING]}), tmp_path / "speeds.csv", tmp_path / "speeds.fmu"
    asked = ["--figure", "shaft_power", "--jobs", "1"]
    assert exit_code(["export", "csv", source, "-o", str(out), *asked]) == 0
    assert f"first_speed 1000 rpm … 3000 rpm with {SPEED} 700 rpm … 1300 rpm" in capsys.readouterr().err
    head = out.read_text().splitlines()[0]
    assert head.endswith(f"; with first_speed 104.72, 209.44, 314.159: {SPEED} 73.3038, 125.664, 136.136")
    assert exit_code(["export", "csv", source, "-o", str(out), *asked]) == 0  # what an export wrote it may replace
    assert exit_code(["export", "fmu", source, "-o", str(unit), "--sources-only", *asked]) == 0
    with ZipFile(unit) as held:
        (speed,) = json.loads(held.read("resources/map.json"))["inputs"]
    (follower,) = speed["follows"]
    assert follower["path"] == SPEED
    assert follower["at"] == pytest.approx([1000.0 * rpm, 2000.0 * rpm, 3000.0 * rpm])
    assert follower["values"] == pytest.approx([700.0 * rpm, 1200.0 * rpm, 1300.0 * rpm])


@pytest.mark.parametrize("stored", [False, True])
def test_what_turns_back_while_it_varies_together_is_no_input(plant, summed, tmp_path, stored):
    source, out = plant(sweep={"zip": [TURNING]}), tmp_path / "speeds.h5"
    if stored:
        assert exit_code(["sweep", source, "-o", str(out), "--jobs", "1"]) == 0
    with pytest.raises(UsageError, match=f"{FIRST_SPEED} varies together with {SPEED}, but"):
        map_of(str(out) if stored else source, figures=["shaft_power"], jobs=1)


def test_what_varies_with_a_word_says_that_it_is_none(plant, summed, tmp_path):
    """The speed rises; the kind beside it has no values between."""
    kinds = {FIRST_SPEED: ["1000 rpm", "2000 rpm"], "second.oil_supply.kind": ["pump", "pump"]}
    source = plant(sweep={"zip": [kinds]})
    with pytest.raises(UsageError, match=r"second\.oil_supply\.kind has values that are no numbers \(name ranges"):
        map_of(source, figures=["shaft_power"], jobs=1)
    out = tmp_path / "kinds.h5"
    assert exit_code(["sweep", source, "-o", str(out), "--jobs", "1"]) == 0
    with pytest.raises(UsageError, match=r"kinds\.h5: second\.oil_supply\.kind has values that are no numbers"):
        map_of(str(out), figures=["shaft_power"], jobs=1)


WARMER = ["-15 degC", "-30 degC", "-25 degC", "-20 degC"]  # polynomials ask for no order
SUPERHEATS = ["4 K", "10 K", "8 K", "6 K"]


def test_polynomials_hold_what_varies_together_with_a_temperature(plant, tmp_path, capsys):
    """Each superheat belongs to one evaporating temperature, so that the polynomial of both is that of runs."""
    joint = {EVAPORATING: WARMER, "first.operation.superheat": SUPERHEATS}
    source = plant(sweep={"zip": [joint], CONDENSING: AXES[CONDENSING]})
    out = tmp_path / "plant.json"
    assert exit_code(["export", "en12900", source, "-o", str(out), "--jobs", "1"]) == 0
    (one,) = json.loads(out.read_text())["maps"]
    S, D, values = -20.0, 35.0, {EVAPORATING: 253.15, CONDENSING: 308.15, "first.operation.superheat": 6.0}
    run = read_stages(plant()).with_values(values).solved().performance
    figures = one["figures"]
    for name in ("shaft_power", "cooling_capacity"):
        c = list(figures[name]["coefficients"].values())
        value = np.dot(c, [1, S, D, S * S, S * D, D * D, S**3, D * S * S, S * D * D, D**3])
        assert value == pytest.approx(run[name], rel=1.01 * figures[name]["largest_error"] + 1e-4)
    assert "superheat 4 K … 10 K" in capsys.readouterr().err


@pytest.mark.parametrize("path", ["first.operation.superheat", "second.operation.subcooling"])
def test_a_compressor_of_one_superheat_is_refused_a_second_one_before_it_is_simulated(plant, tmp_path, capsys, path):
    """EnergyPlus states one superheat and one subcooling of a compressor; the coefficients of EN 12900 none."""
    temperature = CONDENSING if "second" in path else EVAPORATING
    other = EVAPORATING if "second" in path else CONDENSING
    joint = {temperature: AXES[temperature], path: SUPERHEATS[: len(AXES[temperature])]}
    source = plant(sweep={"zip": [joint], other: AXES[other]})
    assert exit_code(["export", "energyplus", source, "-o", str(tmp_path / "plant.idf"), "--jobs", "1"]) == 2
    told = f"{path} varies together with a temperature, but the export takes one value of it (vary it on an axis"
    assert " ".join(capsys.readouterr().err.split()).startswith(told)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["export", "tespy", "FILE", "-o", "a.json"], "holds two stages, and TESPy's compressor is one machine"),
        (["export", "tespy", "PLANT", "-o", "a.json"], "describes two stages, and TESPy's compressor is one machine"),
        (["export", "loads", "PLANT", "-o", "a"], "describes two stages, and loads are those of one machine (screwsim"),
        (
            ["export", "loads", "FILE", "-o", "a"],
            "and loads are those of one machine (for one point screwsim run -o OUT.h5, then screwsim scene OUT.h5",
        ),
        (["export", "csv", "PLANT", "-o", "a.csv"], "there is nothing to map over"),
        (["export", "csv", "PLANT", "-o", "a.csv", "--without", "oil_heat"], "stages have no --without"),
        (["export", "energyplus", "PLANT", "-o", "a.idf"], f"is swept over no {EVAPORATING} and no {CONDENSING}"),
        (["export", "csv", "PLANT", "-o", "a.csv", "--over", f"{SPEED}=1 rpm..2 rpm", "--error", "1e-5"], "accuracy"),
        (["map", "FILE", "--at", "condensing_temperature=40 degC"], "does not state evaporating_temperature"),
    ],
)
def test_what_a_map_of_two_stages_has_not_is_one_line(plant, swept, tmp_path, monkeypatch, capsys, words, told):
    monkeypatch.chdir(tmp_path)
    names = {"FILE": str(swept.path), "PLANT": plant()}
    assert exit_code([names.get(word, word) for word in words]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1


def test_a_speed_is_named_with_its_stage():
    axes = {"first.operation.speed": (0, np.array([300.0])), SPEED: (1, np.array([130.0]))}
    results = SimpleNamespace(varied=axes, stages={"first": None, "second": None})
    with pytest.raises(UsageError, match=f"speed is short for first.operation.speed and for {SPEED}"):
        points_at(results, [], ["speed=1300 rpm"])


def test_an_axis_is_named_as_its_exports_name_it():
    """One map at each speed of the second stage, whose figure is that speed."""
    speeds = np.array([130.0, 150.0])
    fit = PolynomialFit((0.0,) * 10, 0.0, 0.0, 0.0)
    corners = ((-30.0, 30.0), (-20.0, 30.0), (-20.0, 40.0), (-30.0, 40.0))
    maps = [
        PerformanceMap(
            {FIRST_SPEED: 300.0, SPEED: x}, "", 16, 0, 1.0, corners, {"cop": replace(fit, coefficients=(x, *[0.0] * 9))}
        )
        for x in speeds
    ]
    axes = {EVAPORATING: (0, speeds), CONDENSING: (1, speeds), FIRST_SPEED: (2, speeds[:1]), SPEED: (3, speeds)}
    results = SimpleNamespace(varied=axes, stages={"first": None, "second": None})
    at = "evaporating_temperature=-25 degC, condensing_temperature=35 degC"
    (point,) = points_at(results, maps, [f"{at}, second_speed={150.0 * 30.0 / np.pi} rpm"])
    assert point.figures == {"cop": 150.0}
    told = r"state first_speed and second_speed as well, e\.g\. first_speed=2864\.788976 rpm"
    with pytest.raises(UsageError, match=told):
        points_at(results, maps, [at])
    with pytest.raises(UsageError, match="did you mean 'second_speed'"):
        points_at(results, maps, [f"{at}, second_sped=1 rpm"])


def test_a_sweep_without_both_temperatures_says_where_to_write_them(plant, tmp_path):
    few = {EVAPORATING: AXES[EVAPORATING][:1], SPEED: ["1300 rpm"]}
    out = tmp_path / "one.h5"
    assert exit_code(["sweep", plant(sweep=few), "-o", str(out), "--jobs", "1"]) == 0
    with pytest.raises(UsageError, match=f"has no axis {CONDENSING}.* under sweep: in the two-stage file"):
        performance_maps(open_results(out))
