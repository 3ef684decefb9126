"""The package as a program uses it: what is taken as a scene, values changed, how figures show themselves."""

import copy
import json
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import screwsim
from screwsim.derivatives.solving import SceneDerivatives
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.results import open_results
from screwsim.results.write import save
from screwsim.scene import with_values
from screwsim.scene.write import yaml_text
from screwsim.study.pool.progress import OverwrittenLine, Progress, for_program
from screwsim.study.sweep import run_sweep

POINT = Path(__file__).parents[1] / "configs" / "paper" / "point.yaml"
MACHINE = {
    "rotor_diameter": "160 mm",
    "rotor_length": "176 mm",
    "volume": {"max": "600 cm^3", "phi_A": "60 deg"},
    "suction_port": {"area": "40 cm^2", "phi_B": "60 deg"},
    "discharge_port": {"area": "12 cm^2", "opens": "600 deg", "phi_C": "640 deg"},
}
GIVEN = {
    "title": "small: one",
    "machine": MACHINE,
    "gas": {"fluid": "R134a", "isentropic_exponent": 1.12},
    "operation": {
        "speed": "3000 rpm",
        "suction": {"pressure": "1.5 bar", "temperature": "283 K"},
        "discharge": {"pressure": "12 bar"},
    },
    "effects": {"suction_port": {}, "discharge_port": {}, "tip_leakage": {"gap": "50 um"}},
}


@pytest.fixture(scope="module")
def result() -> Result:
    return screwsim.simulate(GIVEN)


def made(case) -> Result:
    """Return figures that follow from the speed alone."""
    speed = case.operation.speed
    figures = Figures(shaft_power=10.0 * speed, isothermal_efficiency=0.5 + 1e-4 * speed, gas_mass_flow=1e-3 * speed)
    return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))


def test_path_text_dict_and_scene_are_one_scene(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text(yaml_text(GIVEN))
    scene = screwsim.load(path)
    for given in (path, str(path), yaml_text(GIVEN), json.dumps(GIVEN), GIVEN, scene):
        assert screwsim.scene.scene_of(given).text == scene.text
    assert screwsim.load(GIVEN, ["operation.speed=1000 rpm"]).text == scene.with_(operation__speed="1000 rpm").text


def test_numbers_of_numpy_are_numbers():
    given = {**GIVEN, "numerics": {"accuracy": np.float64(1e-3)}}
    assert screwsim.scene.scene_of(given).numerics.accuracy == 1e-3


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (3.0, "float is not a scene (pass a path, a dict"),
        ({**GIVEN, "numerics": {"accuracy": object()}}, "numerics.accuracy: <object object"),
        ({**GIVEN, "numerics": {"accuracy": float("nan")}}, "numerics.accuracy: nan (float) cannot be written"),
    ],
)
def test_what_is_no_scene_says_what_to_pass(given, says):
    with pytest.raises(screwsim.UsageError) as error:
        screwsim.simulate(given)
    assert str(error.value).startswith(says)


def test_a_fault_in_a_dict_has_its_path():
    with pytest.raises(screwsim.SceneError) as error:
        screwsim.simulate({**GIVEN, "gas": {"fluid": "R134b"}})
    assert error.value.lines[0].startswith("<dict>:") and "gas.fluid: 'R134b'" in error.value.lines[0]


def test_values_are_changed_in_a_new_scene():
    scene = screwsim.scene.scene_of(GIVEN)
    other = scene.with_({"operation.discharge.pressure": "8 bar"}, operation__speed="1000 rpm")
    assert other.operation.discharge.pressure == 8e5
    assert other.operation.speed == pytest.approx(104.7, abs=0.1)
    assert scene.operation.discharge.pressure == 12e5 and "1000 rpm" in other.text
    assert list(scene.without("tip_leakage").effects) == ["suction_port", "discharge_port"]
    assert list(scene.with_({"effects.tip_leakage": "off"}).effects) == ["suction_port", "discharge_port"]
    assert scene.with_({"sweep.operation.speed": ["1000 rpm", "2000 rpm"]}).sweep


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        ("operation.speed", 3000, "with_: operation.speed=3000: operation.speed: 3000 has no unit"),
        ("operation.sped", "3 rpm", "with_: operation.sped=3 rpm: operation.sped: is not known; did you mean 'speed'?"),
    ],
)
def test_changed_values_are_checked_like_set(path, value, says):
    with pytest.raises(screwsim.SceneError) as error:
        screwsim.scene.scene_of(GIVEN).with_({path: value})
    assert error.value.lines[0].startswith(says)


def test_values_put_into_a_scene_unchecked_have_the_faults_of_a_file():
    """110 °C is above the critical temperature of R134a."""
    scene = screwsim.load(POINT.parents[1] / "r134a" / "point.yaml")
    path = "operation.condensing_temperature"
    with pytest.raises(screwsim.SceneError) as checked:
        scene.with_({path: "110 degC"})
    with pytest.raises(screwsim.SceneError) as simulated:
        screwsim.simulate(with_values(scene, {path: 383.15}))
    (line,) = simulated.value.lines
    assert line.startswith(f"{path}: 110 degC is not below the critical temperature of R134a, 101.062 degC (lower it")
    assert checked.value.lines == [f"with_: {path}=110 degC: {line}"]


def test_figures_show_their_units_and_meanings(result):
    shown = repr(result.performance)
    line = next(line for line in shown.splitlines() if line.startswith("gas_mass_flow "))
    assert line.endswith("net gas mass flow from the suction line") and " kg/s " in line
    assert float(line.split()[1]) == pytest.approx(result.performance.gas_mass_flow, rel=1e-5)
    assert "gas_mass_flow" in dir(result.performance)
    assert repr(result).startswith("Result: ok\n")


def test_a_notebook_shows_a_table_with_customary_units(result):
    page = result._repr_html_()
    efficiency = result.performance.volumetric_efficiency
    assert page.count("<tr>") == len(result.performance) + 1
    assert f"{100 * efficiency:.5g} %" in page and "°C" in page
    hostile = Result("failed", message="<b>no</b>")._repr_html_()
    assert "<b>no</b>" not in hostile and "&lt;b&gt;no" in hostile


def test_a_result_is_a_table_of_pandas_and_of_xarray(result):
    frame, data = result.to_pandas(), result.to_xarray()
    assert frame.index.name == "angle" and list(frame.pressure) == list(result.cycle["pressure"])
    assert frame.attrs["shaft_power"] == result.performance.shaft_power
    assert set(frame.columns) <= set(frame.attrs["units"]) and frame.attrs["units"]["pressure"] == "Pa"
    assert float(data.shaft_power) == result.performance.shaft_power and data.shaft_power.units == "W"
    assert data.pressure.dims == ("angle",)


def test_the_ledger_is_a_row_an_effect_whose_losses_add_up(result):
    frame, ledger = result.ledger.to_pandas(), result.ledger
    assert frame.exergy_destroyed.is_monotonic_decreasing
    assert frame.exergy_destroyed.sum() == pytest.approx(ledger.exergy_destroyed, rel=1e-12)
    assert frame.loc["suction_port", "gas_moved"] == ledger.gas_moved_suction_port
    assert frame.attrs["shaft_power"] == ledger.shaft_power
    assert set(frame.columns) == set(frame.attrs["units"]) and frame.attrs["units"]["entropy_generated"] == "W K-1"
    assert Result("failed").ledger.to_pandas().empty


def test_results_are_a_row_a_case(tmp_path):
    scene = screwsim.scene.scene_of(GIVEN).with_({"sweep.operation.speed": ["1000 rpm", "2000 rpm"]})
    run_sweep(scene, tmp_path / "x.h5", jobs=1, simulate=made)
    results = open_results(tmp_path / "x.h5")
    frame = results.to_pandas()
    assert list(frame["shaft_power"]) == pytest.approx(list(10.0 * frame["operation.speed"]))
    assert list(frame["status"]) == ["ok", "ok"]
    assert frame.attrs["units"]["shaft_power"] == "W" and frame.attrs["units"]["operation.speed"] == "rad s-1"
    assert set(frame.columns) == set(frame.attrs["meanings"])
    assert "operation.speed (2); 2 ok" in repr(results)


def test_a_run_is_one_row(tmp_path, result):
    save(tmp_path / "x.h5", screwsim.scene.scene_of(GIVEN), result)
    frame = open_results(tmp_path / "x.h5").to_pandas()
    assert frame["shaft_power"].tolist() == [result.performance.shaft_power]


def test_studies_take_what_is_at_hand(monkeypatch, tmp_path):
    monkeypatch.setattr("screwsim.study.best.optimum.simulator", lambda warm=None: made)
    (best,) = screwsim.optimum(GIVEN, "operation.speed", "shaft_power", low="1000 rpm", high="2000 rpm", jobs=1)
    assert (best.status, best.place) == ("ok", "upper border")
    with pytest.raises(screwsim.UsageError, match="Dataset is not a results file"):
        screwsim.performance_map(type("Dataset", (), {})())
    with pytest.raises(screwsim.UsageError, match="int is not a fit"):
        screwsim.calibrate(3)


def test_one_text_is_taken_as_a_list_of_one():
    """Not as its letters."""
    faster = screwsim.load(POINT, "operation.speed=3000 rpm")
    assert faster.text == screwsim.load(POINT, ["operation.speed=3000 rpm"]).text
    assert "tip_leakage" not in screwsim.load(POINT, without="tip_leakage").effects
    found = screwsim.find(faster, "oil_supply.ratio=0.5..3", "discharge_temperature=20 degC")
    assert list(found.values) == ["oil_supply.ratio"]
    slopes = screwsim.sensitivities(faster, "oil_supply.ratio", "shaft_power")
    assert list(slopes.derivatives) == ["shaft_power"] and list(slopes.values) == ["oil_supply.ratio"]


def test_a_range_that_is_no_pair_is_told():
    fit = POINT.parents[1] / "calibration" / "leakage.fit.yaml"
    for ends in (("1000 rpm",), "1000 rpm"):
        with pytest.raises(
            UsageError,
            match=r"ranges\['operation.speed'\]: .* is not a pair \(pass e.g. \('1000 "
            r"rpm', ",
        ):
            screwsim.plan(fit, ranges={"operation.speed": ends})


def test_a_sweep_without_axes_says_how_to_get_them():
    with pytest.raises(screwsim.UsageError, match=r"scene\.with_\(\{'sweep"):
        screwsim.sweep(GIVEN)


def test_progress_is_silent_unless_asked_for(capsys):
    assert type(for_program("x")) is Progress
    line = OverwrittenLine("sweep", every=0.0)
    line.start(4, 1)
    line.advance(2, 1)
    line.stop()
    told = capsys.readouterr().err
    assert told.split("\r")[-1] == "sweep: 3 of 4, 1 not ok\n"


def test_importing_the_package_imports_nothing_else():
    code = "import sys, screwsim; print(sorted(name for name in sys.modules if name.startswith('screwsim')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['screwsim']"


def test_public_names_are_there_and_typed():
    assert all(getattr(screwsim, name) is not None for name in screwsim.__all__)
    assert sorted(dir(screwsim)) == sorted(screwsim.__all__)
    assert (Path(screwsim.__file__).parent / "py.typed").exists()


def test_a_figure_says_its_unit_and_meaning_and_is_a_number(result):
    power = result.performance.shaft_power
    assert " kW), shaft power" in repr(power) and " W (" in repr(power) and power.units == "W"
    plain = repr(result.performance["shaft_power"])
    assert str(power) == f"{power}" == json.dumps(power) == repr(float(power)) == plain
    again = pickle.loads(pickle.dumps(power))
    assert again == power and repr(again) == repr(power) and type(power + 1.0) is float


def test_a_difference_of_temperatures_is_printed_in_K_and_keeps_its_unit():
    superheat = screwsim.simulate(POINT.parents[1] / "rotors" / "b.yaml").performance.suction_superheat
    assert repr(superheat).startswith(f"{float(superheat)!r} K, ") and superheat.units == "kelvin"


def test_balances_errors_and_ledger_say_their_units(result):
    assert "relative residual of the gas mass balance" in repr(result.balance)
    assert repr(result.error.shaft_power).endswith(", relative numerical error of shaft power")
    assert "accepted integration steps" in repr(result.numerics) and "<td" in result.ledger._repr_html_()


def test_a_slip_in_a_figures_name_is_told(result):
    with pytest.raises(AttributeError, match="did you mean 'shaft_power'"):
        _ = result.performance.shaft_pwer


def unwanted(*_, **__):
    raise AssertionError("derivatives were found that nobody asked for")


def test_derivatives_cost_nothing_before_they_are_asked_for(monkeypatch):
    monkeypatch.setattr("screwsim.study.uncertainty.point.scene_sensitivities", unwanted)
    result = screwsim.simulate(GIVEN)
    assert repr(result) and result.as_json()
    assert pickle.loads(pickle.dumps(result)).performance == result.performance
    with pytest.raises(AssertionError, match="nobody asked"):
        result.derivatives["shaft_power", "operation.speed"]


def test_a_result_without_uncertainties_says_how_to_find_them(result):
    assert not result.uncertainty
    with pytest.raises(KeyError, match=r"shaft_power: simulate finds no uncertainties .*screwsim.uncertainty\(scene\)"):
        result.uncertainty["shaft_power"]
    assert "screwsim.uncertainty(scene)" in repr(result.uncertainty)
    assert pickle.loads(pickle.dumps(result)) == result


def test_a_result_equals_its_copies_and_nothing_else(result):
    copies = pickle.loads(pickle.dumps(result)), copy.deepcopy(result)
    assert all(each == result for each in copies) and result in copies
    traces = {name: column.copy() for name, column in result.cycle.items()}
    traces["pressure"][3] += 1.0
    others = replace(result, cycle=traces), replace(result, cycle={}), replace(result, warnings=("other",)), None
    assert all(each != result for each in others)


def test_a_result_with_missing_numbers_and_words_in_its_cycle_equals_its_copy(result):
    odd = {**result.cycle, "phase": np.array(["gas", "wet"]), "gap": np.array([np.nan, 1.0])}
    odd_result = replace(
        result, cycle=odd, uncertainty={"samples": np.array([1.0, np.nan])}, ledger={"residue": np.nan}
    )
    assert pickle.loads(pickle.dumps(odd_result)) == odd_result
    assert replace(odd_result, uncertainty={"samples": np.array([2.0, np.nan])}) != odd_result


def test_derivatives_of_a_result_are_the_sensitivities_of_its_scene_with_units(result):
    found, derivatives = screwsim.sensitivities(GIVEN), result.derivatives
    for figure, slopes in found.derivatives.items():
        for path, slope in slopes.items():
            assert derivatives[figure, path] == pytest.approx(slope, rel=1e-6, abs=1e-12)
    assert derivatives["shaft_power", "tip_leakage.gap"] == derivatives["shaft_power", "effects.tip_leakage.gap"]
    assert derivatives.units("shaft_power", "tip_leakage.gap") == "W/m"
    assert derivatives.units("gas_mass_flow", "operation.discharge.pressure") == "(kg/s)/Pa"
    assert derivatives.relative("displacement_flow", "operation.speed") == pytest.approx(1.0, rel=1e-6)
    frame = derivatives.to_pandas()
    assert frame.loc["shaft_power", "operation.speed"] == derivatives["shaft_power", "operation.speed"]
    assert frame.attrs["path_units"]["operation.speed"] == "rad/s" and frame.attrs["figure_units"]["shaft_power"] == "W"
    assert f"{len(frame)} figures by {len(frame.columns)} numbers" in repr(derivatives)
    assert pickle.loads(pickle.dumps(result)).derivatives == derivatives


@pytest.mark.parametrize(
    ("key", "says"),
    [
        (("shaft_powr", "operation.speed"), "did you mean 'shaft_power'?"),
        (("shaft_power", "operation.sped"), "did you mean 'operation.speed'?"),
        (("shaft_power", "flow_coefficient"), "(write the whole path)"),
        (("shaft_power", "machine.male_lobes"), "a whole number"),
        ("shaft_power", "is not a figure with a path"),
    ],
)
def test_a_derivative_that_is_not_there_says_what_is(result, key, says):
    with pytest.raises(KeyError) as error:
        result.derivatives[key]
    assert says in str(error.value)


def test_a_result_that_does_not_know_its_scene_says_so():
    with pytest.raises(KeyError, match="is not linked to its scene"):
        Result("ok").derivatives["shaft_power", "operation.speed"]
    assert "none" in repr(Result("ok").derivatives)


@pytest.mark.parametrize(
    ("section", "change", "says"),
    [
        ("operation", {"speed": "3100 rpm"}, "operation.speed is 3000 rpm there, 3100 rpm here"),
        ("operation", {"ambient_temperature": "300 K"}, "ambient_temperature is 25 °C there, 26.85 °C here"),
        ("effects", {"mechanical": {"fraction": 0.1}}, "effects.mechanical is simulated here only"),
    ],
)
def test_a_result_of_another_scene_is_not_differentiated(result, section, change, says):
    """Nor is one that came through a pickle; its accuracy may be another."""
    other = {**GIVEN, section: {**GIVEN[section], **change}}
    for given in (result, pickle.loads(pickle.dumps(result))):
        with pytest.raises(UsageError, match=says):
            screwsim.sensitivities(other, result=given)
    finer = {**GIVEN, "numerics": {"accuracy": 1e-4}}
    assert screwsim.sensitivities(finer, ["operation.speed"], result=result).derivatives


def test_derivatives_by_differences_are_by_every_number_too(monkeypatch):
    def solved(scene, points, **_):
        return [Result("ok", performance=Figures(shaft_power=3.0 * sum(point.values()))) for point in points]

    monkeypatch.setattr("screwsim.study.uncertainty.slopes.results_at", solved)
    none_exact = SceneDerivatives({}, {}, "asked for")
    monkeypatch.setattr("screwsim.study.uncertainty.slopes.scene_derivatives", lambda *_: none_exact)
    scene = screwsim.load(Path(__file__).parents[1] / "configs" / "slider_crank" / "air.yaml")
    found = screwsim.sensitivities(scene, result=made(scene))
    assert set(found.method.values()) == {"differences"} and "effects.ring_leakage.gap" in found.values
    assert list(found.derivatives["shaft_power"].values()) == pytest.approx([3.0] * len(found.values))


@pytest.mark.parametrize("of", ["effects", "sweep", "uncertain"])
def test_a_loaded_scene_does_not_change_in_place(of):
    """Its text and what was built of it would say another machine than is simulated."""
    scene = screwsim.load(POINT.with_name("uncertain.yaml"))
    mapping = getattr(scene, of)
    first = next(iter(mapping))
    for change in (
        lambda: mapping.pop(first),
        lambda: mapping.update({first: None}),
        lambda: mapping.__setitem__(first, None),
        mapping.clear,
    ):
        with pytest.raises(TypeError, match="a scene cannot be changed: with_ and without return a new one"):
            change()
    again = pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)
    assert [getattr(each, of) == mapping and type(getattr(each, of)) is type(mapping) for each in again] == [True, True]
