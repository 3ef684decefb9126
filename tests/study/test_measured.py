"""Measured figures beside a scene's own: what is read, what sigma is, and that the number that is off is found."""

import importlib
import json
import math
from dataclasses import replace

import pytest
from each_row import each_row

from screwsim.figures.errors import error_in_unit
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.printing.measured import print_measured
from screwsim.scene import cross_check, leaf_of, load, with_values
from screwsim.simulate import simulate
from screwsim.study.uncertainty import measured
from screwsim.study.uncertainty.measured import LARGEST_CHANGE_KELVIN, compare_measured, read_measured
from screwsim.study.uncertainty.point import with_uncertainty

UNCERTAIN = "configs/paper/uncertain.yaml"


@pytest.fixture(autouse=True)
def at_root(monkeypatch, pytestconfig):
    monkeypatch.chdir(pytestconfig.rootpath)


@pytest.fixture(scope="module")
def scene(pytestconfig):
    return load(pytestconfig.rootpath / UNCERTAIN)


@pytest.fixture(scope="module")
def result(scene):
    return with_uncertainty(scene, simulate(scene, trace=False))


def test_a_tolerance_in_a_unit_with_a_zero_has_one_message_in_a_scene_and_of_a_measured_figure(scene):
    told = "the tolerance '2 degF' is a temperature, not a difference (write K or delta_degF, e.g. '10 K')"
    with pytest.raises(SceneError) as in_scene:
        load("configs/paper/point.yaml", ["operation.suction.temperature=68 degF ± 2 degF"])
    with pytest.raises(UsageError) as of_figure:
        read_measured(scene, ["discharge_temperature=176 degF ± 2 degF"])
    assert str(in_scene.value).endswith(told) and str(of_figure.value).endswith(told)


@each_row(
    ("text", "value", "standard"),
    [
        ("shaft_power=13.2 kW", 13200.0, None),
        ("shaft_power = 13.2 kW ± 0.2 kW", 13200.0, 100.0),
        ("shaft_power=13.2 ± 0.2 kW", 13200.0, 100.0),
        ("shaft_power=13.2 kW +/- 0.2", 13200.0, 100.0),
        ("shaft_power=13.2 kW +- 2 %", 13200.0, 132.0),
        ("Pshaft=13200 W", 13200.0, None),
        ("discharge_temperature=15 degC ± 1 K", 288.15, 0.5),
        ("discharge_temperature=15 degC ± 1", 288.15, 0.5),
        ("discharge_temperature=59 degF ± 1 K", 288.15, 0.5),
        ("volumetric_efficiency=90 % ± 1 %", 0.9, 0.005),  # points
        ("volumetric_efficiency=0.9 ± 1 %", 0.9, 0.005),  # points as well, as a column of a fit reads it
        ("oil_ratio=3 ± 10 %", 3.0, 0.15),  # a share
        ("pressure_ratio=4 ± 2 %", 4.0, 0.04),
        ("shaft_power=13.2 kW ± 0.2 kW (k=2)", 13200.0, 100.0),
        ("shaft_power=13.2 kW ± 0.1 kW (k=1)", 13200.0, 100.0),
        ("shaft_power=13.2 kW ± 0.1(k = 1)", 13200.0, 100.0),
        ("shaft_power=13.2 ± 0.3 kW (k=3)", 13200.0, 100.0),
        ("discharge_temperature=15 degC ± 1 K (k=1)", 288.15, 1.0),
        ("oil_ratio=3 ± 10 % (k=1)", 3.0, 0.3),
    ],
)
def test_a_measurement_is_read_with_half_of_its_95_percent_interval(scene, text, value, standard):
    (found,) = read_measured(scene, [text])
    assert found.value == pytest.approx(value, rel=1e-12)
    assert found.standard == (None if standard is None else pytest.approx(standard, rel=1e-12))


def test_a_gauge_reads_over_the_scenes_ambient_pressure(scene):
    high = with_values(scene, {"operation.ambient_pressure": 0.9e5})
    for text in ("peak_pressure=7 bar(g) ± 0.1 bar", "peak_pressure=7 barg ± 0.1", "peak_pressure=700 kPa(g) ± 10 kPa"):
        (found,) = read_measured(high, [text])
        assert (found.value, found.standard) == (pytest.approx(7.9e5, rel=1e-12), pytest.approx(5e3, rel=1e-12))


@each_row(
    ("texts", "words"),
    [
        (["shaft_power"], "is not FIGURE=VALUE ± UNCERTAINTY"),
        (["shaft_power="], "is not FIGURE=VALUE ± UNCERTAINTY"),
        (["shaft_power=1 kW ±"], "is not FIGURE=VALUE ± UNCERTAINTY"),
        (["shaft_pwer=12 kW"], "did you mean 'shaft_power'?"),
        (["cop=3"], "is not a figure of this scene"),
        (["shaft_power=12"], "has no unit (write one of W, kW, MW)"),
        (["shaft_power=12 bar ± 1 bar"], "has no unit 'bar'"),
        (["shaft_power=12 kW ± 1 bar"], "has no unit 'bar'"),
        (
            ["discharge_temperature=194 degF ± 2"],
            "is a temperature, not a difference (write K or delta_degF, e.g. '10 K')",
        ),
        (
            ["discharge_temperature=90 degC ± 2 degF"],
            "is a temperature, not a difference (write K or delta_degF, e.g. '10 K')",
        ),
        (["shaft_power=12 kW ± 0 kW"], "an uncertainty must be above 0"),
        (["shaft_power=12 kW ± -1 %"], "an uncertainty must be above 0"),
        (["discharge_temperature=15 degC ± 1 degC"], "(write K or delta_degF, e.g. '10 K')"),
        (["discharge_temperature=59 degF ± 1"], "(write K or delta_degF, e.g. '10 K')"),
        (["discharge_temperature=15 degC ± 1 %"], "a percentage of a temperature depends on its zero (write kelvin"),
        (["peak_pressure=7 barg ± 1 %"], "a percentage of a gauge pressure depends on its zero (write e.g. ± 0.1 bar)"),
        (["shaft_power=12 kW", "shaft_power=13 kW"], "is given twice"),
        (["shaft_power=12 kW ± 1 kW (k=0)"], "k=0 is not a coverage factor (write k=1"),
        (["volumetric_efficiency=0.92 ± 1"], "volumetric_efficiency 1 is 100 % (write 1 %, or 0.01)"),
        (["shaft_power=12 kW ± (k=1)"], "is not FIGURE=VALUE ± UNCERTAINTY"),
    ],
)
def test_a_slip_is_one_line(scene, texts, words):
    with pytest.raises(UsageError) as slip:
        read_measured(scene, texts)
    assert words in str(slip.value) and "\n" not in str(slip.value)


def test_sigma_counts_measurement_inputs_and_numerics_in_squares(scene, result):
    found = compare_measured(scene, result, read_measured(scene, ["shaft_power=13.2 kW ± 0.2 kW"]))
    (row,) = found.rows
    told = result.uncertainty["figures"]["shaft_power"]
    numerical = 0.5 * result.error.shaft_power * result.performance.shaft_power
    whole = math.sqrt(100.0**2 + told["standard"] ** 2 + numerical**2)
    assert row.sigma == pytest.approx((result.performance.shaft_power - 13200.0) / whole, rel=1e-12)
    assert told["standard"] > 10.0 * numerical  # the inputs count


def test_what_agrees_asks_for_no_explanation(scene, result):
    near = f"shaft_power={1e-3 * result.performance.shaft_power:.4f} kW ± 0.2 kW"
    found = compare_measured(scene, result, read_measured(scene, [near]))
    assert found.why == "nothing to explain" and found.explanations == ()


@pytest.mark.parametrize(
    ("path", "factor"), [("effects.tip_leakage.gap", 1.1), ("oil_supply.ratio", 0.93), ("operation.speed", 1.04)]
)
def test_the_number_that_is_off_is_found_from_what_it_does(scene, result, path, factor):
    """Figures of the same machine with one number changed: that number leaves least, and is found within its curve."""
    from screwsim.scene import value_at

    wanted = factor * value_at(scene, path)
    other = simulate(with_values(scene, {path: wanted}), trace=False).performance
    names = {"shaft_power": 1e-3, "gas_mass_flow": 1e-3, "discharge_temperature": 3e-5, "oil_mass_flow": 1e-3}
    units = {"shaft_power": "W", "gas_mass_flow": "kg/s", "discharge_temperature": "K", "oil_mass_flow": "kg/s"}
    texts = [
        f"{name}={other[name]!r} {units[name]} ± {share * other[name]!r} {units[name]}" for name, share in names.items()
    ]
    plain = simulate(scene, trace=False)  # without tolerances in the weights
    found = compare_measured(scene, plain, read_measured(scene, texts))
    best = min(found.explanations, key=lambda each: each.left)
    assert best.left < 0.02
    (own,) = (each for each in found.explanations if each.path == path)
    assert own.left < best.left + 0.02 and own.solved < 0.02
    assert own.wanted == pytest.approx(wanted, rel=0.1 * abs(factor - 1.0))
    tolerance = scene.uncertain.get(path)
    assert (own.tolerances is None) == (tolerance is None)
    if tolerance is not None:
        there = (own.wanted - own.value) / (2.0 * tolerance.standard_at(own.value))
        assert own.tolerances == pytest.approx(there)


def test_a_number_beyond_which_a_figure_turns_explains_nothing(monkeypatch, capsys):
    """The efficiency is highest at an oil ratio of about 1: less oil does not raise it as far as slopes promise."""
    ratio = "oil_supply.ratio"
    scene = load("configs/paper/point.yaml", [f"{ratio}=1.3", "numerics.error=none"])
    result = simulate(scene, trace=False)
    of_all = measured.sensitivities

    def by_ratio(scene, paths, *given, **more):
        return of_all(scene, [ratio], *given, **more)

    monkeypatch.setattr(measured, "sensitivities", by_ratio)
    for share, holds in ((0.999, True), (1.003, False)):
        wanted = 100.0 * share * result.performance.isothermal_efficiency
        found = compare_measured(scene, result, read_measured(scene, [f"isothermal_efficiency={wanted!r} % ± 0.01 %"]))
        assert [each.path for each in found.explanations] == [ratio] * holds
        assert list(found.dismissed) == [ratio] * (not holds)
        if holds:
            (own,) = found.explanations
            there = simulate(with_values(scene, {ratio: own.wanted}), trace=False).performance.isothermal_efficiency
            off = (there - 0.01 * wanted) / (result.performance.isothermal_efficiency - 0.01 * wanted)
            assert own.left < 1e-12 < own.solved == pytest.approx(off**2, rel=0.05)
        else:
            assert "% when solved, 0 % by derivatives" in found.dismissed[ratio]
            print_measured(scene, result, found)
            assert f"no explanation: {ratio} leaves" in capsys.readouterr().out
            other = measured.Explanation("oil_supply.temperature", 330.0, 325.0, 0.01, None)  # beyond those solved
            print_measured(scene, result, replace(found, explanations=(other,)))
            assert "1 would explain it alone by derivatives, not solved (--json)" in capsys.readouterr().out


def test_no_number_is_offered_that_no_scene_could_have(scene, result):
    """Half the power: no change that a derivative can tell of, or that lies within limits, would explain it."""
    found = compare_measured(scene, result, read_measured(scene, ["shaft_power=6 kW ± 0.1 kW"]))
    assert all(0.5 <= each.wanted / each.value <= 1.5 for each in found.explanations)


def test_no_temperature_is_offered_that_is_far_or_does_not_fit_to_the_others(pytestconfig):
    """Condensing stays above evaporating, and a wall near room temperature is not told to be of liquid nitrogen."""
    scene = load(pytestconfig.rootpath / "configs" / "r134a" / "point.yaml")
    result = simulate(scene, trace=False)
    for stated in ("shaft_power=1 kW ± 1 kW", "shaft_power=30 kW ± 1 kW", "cooling_capacity=230 kW ± 1 kW"):
        found = compare_measured(scene, result, read_measured(scene, [stated]))
        for each in found.explanations:
            assert not cross_check(with_values(scene, {each.path: each.wanted}))
            if leaf_of(scene, each.path).kind == "temperature":
                assert abs(each.wanted - each.value) <= LARGEST_CHANGE_KELVIN
        assert stated.startswith("shaft_power=1 ") or found.explanations


def test_one_difference_of_temperatures_has_one_numerical_error(pytestconfig):
    """Discharge superheat is the discharge temperature less a constant: both err by as many kelvin."""
    result = simulate(load(pytestconfig.rootpath / "configs" / "r134a" / "point.yaml"), trace=False)
    names = ("discharge_temperature", "discharge_superheat")
    first, second = (error_in_unit(name, result.performance, result.error) for name in names)
    assert second == pytest.approx(first, rel=1e-6) and first > 1e-4
    scene = load(pytestconfig.rootpath / "configs" / "r134a" / "point.yaml")
    found = compare_measured(scene, result, read_measured(scene, [f"{name}=300 K" for name in names]))
    assert [2.0 * row.numerical for row in found.rows] == pytest.approx([first, second])
    assert [error_in_unit(name, result.performance, result.error) for name in names] == pytest.approx([first, second])


def test_a_small_power_errs_over_the_shaft_power(pytestconfig):
    """The pump's error counts in watts as the shaft power's scale has it, not over the pump's own few watts."""
    result = simulate(load(pytestconfig.rootpath / "configs" / "r134a" / "point.yaml"), trace=False)
    told = error_in_unit("oil_pump_power", result.performance, result.error)
    assert told == pytest.approx(result.error.oil_pump_power * result.performance.shaft_power, rel=0.2)
    assert error_in_unit("oil_circuit_residual", result.performance, result.error) is None


def test_a_model_with_a_validation_tells_its_error(pytestconfig):
    scene = load(pytestconfig.rootpath / "configs" / "r134a" / "compact.yaml", ["uncertainty={model: bitzer}"])
    result = with_uncertainty(scene, simulate(scene, trace=False))
    own = result.performance.volumetric_efficiency
    found = compare_measured(scene, result, read_measured(scene, [f"volumetric_efficiency={own - 1e-4!r} ± 0.00001"]))
    (row,) = found.rows
    assert row.model is not None and row.model[0] < row.model[1]
    assert row.within_model == (row.model[0] <= row.off <= row.model[1])


def test_run_prints_it_in_80_columns_and_json_has_it(capsys, scene):
    from screwsim.cli import exit_code

    asked = ["run", UNCERTAIN, "--measured", "shaft_power=13.2 kW ± 0.2 kW", "--measured", "mdot=0.165 kg/s ± 2 %"]
    assert exit_code([*asked, "--short"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert any(line.startswith("differ by more than 2 sigma: shaft power") for line in lines)
    assert any(line.startswith("machine.volume.max") for line in lines)
    assert exit_code([*asked, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    figure = document["measured"]["figures"]["shaft_power"]
    assert figure["difference"] == pytest.approx(figure["value"] - 13200.0)
    assert figure["expanded"]["measured"] == pytest.approx(200.0) and figure["sigma"] < -2.0
    assert {"path", "value", "wanted", "left", "tolerances", "solved"} == set(document["measured"]["explanations"][0])


def test_a_figure_without_a_value_is_told_and_the_command_ends_with_4(capsys):
    """The point is ok, but what was asked of it could not be compared."""
    from screwsim.cli import exit_code

    asked = ["run", "configs/r134a/point.yaml", "--set", "numerics.error=none", "--measured"]
    assert exit_code([*asked, "isothermal_efficiency=70 % ± 1 %", "--short"]) == 4
    assert "no isothermal efficiency to compare: R134a at 12.00 °C condenses" in capsys.readouterr().out
    assert exit_code([*asked, "isothermal_efficiency=70 %", "--json"]) == 4
    document = json.loads(capsys.readouterr().out)
    assert document["status"] == "ok" and set(document["measured"]["none"]) == {"isothermal_efficiency"}


def test_a_slip_of_a_measurement_is_told_before_anything_is_simulated(capsys, monkeypatch):
    from screwsim.cli import exit_code

    monkeypatch.setattr(importlib.import_module("screwsim.simulate"), "simulate", lambda *_, **__: pytest.fail("it is"))

    assert exit_code(["run", UNCERTAIN, "--measured", "shaft_pwer=12 kW"]) == 2
    answer = capsys.readouterr()
    assert answer.out == "" and "did you mean 'shaft_power'?" in answer.err
