"""The ten-coefficient map: exact where the points are a cubic, refused where they do not tell its coefficients."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from screwsim.cli import exit_code
from screwsim.export.en12900 import en12900_csv
from screwsim.export.polynomials import polynomials
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.results import open_results
from screwsim.scene import load, loads
from screwsim.study.maps.map_points import evaluate_map, place_in_words
from screwsim.study.maps.performance_map import PerformanceMap, performance_maps, polynomial, usual_figures
from screwsim.study.sweep import run_sweep

CONFIGS = Path(__file__).parents[2] / "configs" / "r134a"
POWER = (8.1e3, -42.0, 151.0, -3.1, 2.2, 0.9, -0.011, 0.021, -0.017, 0.0042)
FLOW = (0.31, 0.011, -7e-4, 1.3e-4, -1e-5, -4e-6, 5e-7, -3e-7, 1e-7, -2e-8)
SHARE = load(CONFIGS / "point.yaml").operation.speed / 300.0
NO_CAPACITY = ("shaft_power", "gas_mass_flow")
AXES = "[-15 degC, -5 degC, 0 degC, 10 degC]", "[30 degC, 38 degC, 45 degC, 50 degC]"


def cubic(scene) -> Result:
    """Return exact cubics, the flow in proportion to the speed; fail at 10/50 °C."""
    S, D = scene.operation.evaporating_temperature - 273.15, scene.operation.condensing_temperature - 273.15
    if S > 9.9 and D > 49.9:
        return Result("failed", message="pressure left the range")
    share = scene.operation.speed / 300.0
    performance = Figures(shaft_power=float(polynomial(POWER, S, D)), gas_mass_flow=share * polynomial(FLOW, S, D))
    return Result("ok", performance=performance)


def nearly(scene) -> Result:
    """Return a quartic in S."""
    S, D = scene.operation.evaporating_temperature - 273.15, scene.operation.condensing_temperature - 273.15
    return Result("ok", performance=Figures(shaft_power=1e4 + D + 1e-3 * S**4, gas_mass_flow=1.0 + S + 100.0))


def swept(folder: Path, evaporating: str, condensing: str, more: str = "", simulate=cubic):
    text = f"base: point.yaml\nsweep:\n  operation.evaporating_temperature: {evaporating}\n"
    scene = loads(text + f"  operation.condensing_temperature: {condensing}\n" + more, folder=str(CONFIGS))
    run_sweep(scene, folder / "map.h5", jobs=1, simulate=simulate)
    return open_results(folder / "map.h5")


@pytest.mark.parametrize(("fluid", "told"), [("R407C", True), ("R407C.mix", False), ("R134a", False)])
def test_a_map_says_that_its_condensing_temperatures_are_not_dew_points(tmp_path, capsys, fluid, told):
    """R407C at 40 °C of its bubble point: dew point by CoolProp, 4.9 K above."""
    file = str(swept(tmp_path, *AXES, f"gas: {{fluid: {fluid}}}\n").path)
    words = "dew point in the condenser, of R407C 4.9 K above the bubble point that D is here"
    exit_code(["map", file, "--figure", "shaft_power"])
    assert (words in " ".join(capsys.readouterr().out.split())) == told
    exit_code(["map", file, "--figure", "shaft_power", "--json"])
    assert (words in json.loads(capsys.readouterr().out).get("convention", "")) == told


def test_an_exact_cubic_is_recovered(tmp_path):
    (found,) = performance_maps(swept(tmp_path, *AXES), NO_CAPACITY)
    assert (found.points, found.not_ok) == (15, 1)
    for figure, wanted in (("shaft_power", POWER), ("gas_mass_flow", FLOW)):
        fit = found.fits[figure]
        share = load(CONFIGS / "point.yaml").operation.speed / 300.0 if figure == "gas_mass_flow" else 1.0
        np.testing.assert_allclose(fit.coefficients, np.multiply(share, wanted), rtol=1e-9)
        assert fit.largest < 1e-12 and fit.rms <= fit.largest


def test_a_map_tells_which_points_it_does_without_and_why(tmp_path, capsys):
    """10/50 °C failed; -5/38 °C is ok but lacks a figure."""

    def without_a_flow(scene):
        found, at = cubic(scene), scene.operation
        if abs(at.evaporating_temperature - 268.15) + abs(at.condensing_temperature - 311.15) < 1e-6:
            return Result("ok", performance=Figures(shaft_power=found.performance.shaft_power, gas_mass_flow=None))
        return found

    results = swept(tmp_path, *AXES, simulate=without_a_flow)
    (found,) = performance_maps(results, NO_CAPACITY)
    left_out = [(-5.0, 38.0, "has no gas_mass_flow"), (10.0, 50.0, "pressure left the range")]
    assert [(each.S, each.D, each.why) for each in found.missing] == left_out and found.not_ok == 1
    told = "2 points of the sweep are left out, (S, D) (-5, 38), (10, 50) °C; the first: has no gas_mass_flow"
    asked = ["map", str(results.path), "--figure", "shaft_power", "--figure", "gas_mass_flow"]
    for more in ([], ["--at", "evaporating_temperature=0 degC, condensing_temperature=40 degC"]):
        exit_code([*asked, *more])
        assert told in " ".join(capsys.readouterr().out.split())
    assert polynomials(results, NO_CAPACITY).missing == (told,)


def test_each_speed_has_its_map(tmp_path):
    maps = performance_maps(swept(tmp_path, *AXES, "  operation.speed: [1000 rpm, 2000 rpm]\n"), NO_CAPACITY)
    assert [each.values["operation.speed"] for each in maps] == pytest.approx(
        [1000 * math.pi / 30, 2000 * math.pi / 30]
    )
    one, two = (each.fits["gas_mass_flow"].coefficients for each in maps)
    np.testing.assert_allclose(two, 2.0 * np.array(one), rtol=1e-9)


def test_the_map_answers_inside_its_envelope_only(tmp_path):
    (found,) = performance_maps(swept(tmp_path, *AXES), NO_CAPACITY)
    # 10/50 °C failed: its corner is cut off
    assert set(found.envelope) == {(-15.0, 30.0), (10.0, 30.0), (10.0, 45.0), (0.0, 50.0), (-15.0, 50.0)}
    value = found.evaluate("shaft_power", [-15.0, 5.0, 5.0, 10.0, -16.0], [30.0, 47.5, 47.6, 50.0, 40.0])
    assert value.mask.tolist() == [False, False, True, True, True]
    assert value[1] == pytest.approx(polynomial(POWER, np.array(5.0), np.array(47.5)), rel=1e-9)


def test_errors_are_those_of_the_points(tmp_path):
    results = swept(tmp_path, "[-15 degC, -10 degC, 0 degC, 5 degC, 10 degC]", AXES[1], simulate=nearly)
    (found,) = performance_maps(results, NO_CAPACITY)
    S, D = np.meshgrid([-15.0, -10.0, 0.0, 5.0, 10.0], [30.0, 38.0, 45.0, 50.0], indexing="ij")
    values = 1e4 + D + 1e-3 * S**4
    errors = np.abs(found.evaluate("shaft_power", S, D) / values - 1.0)
    fit = found.fits["shaft_power"]
    assert fit.largest == pytest.approx(errors.max(), rel=1e-6)
    assert fit.rms == pytest.approx(math.sqrt((errors**2).mean()), rel=1e-6)
    assert fit.left_out > fit.largest > 1e-6


def test_a_left_out_point_is_predicted_by_the_others(tmp_path):
    few = "[-15 degC, -10 degC, 0 degC, 5 degC, 10 degC]", "[30 degC, 38 degC, 45 degC, 50 degC]"
    results = swept(tmp_path, *few, simulate=nearly)
    (found,) = performance_maps(results, NO_CAPACITY)
    S, D = (grid.ravel() for grid in np.meshgrid([-15.0, -10.0, 0.0, 5.0, 10.0], [30.0, 38.0, 45.0, 50.0]))
    values, errors = 1e4 + D + 1e-3 * S**4, []
    for i in range(len(S)):
        keep = np.arange(len(S)) != i
        design = np.column_stack([(S / 10) ** a * ((D - 40) / 10) ** b for a in range(4) for b in range(4 - a)])
        answer, *_ = np.linalg.lstsq(design[keep], values[keep])
        errors.append(abs(design[i] @ answer / values[i] - 1.0))
    assert found.fits["shaft_power"].left_out == pytest.approx(max(errors), rel=1e-6)


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        (("[0 degC, 5 degC]", AXES[1]), "8 of 8 points are ok and have all figures; ten coefficients need 10 or more"),
        (("[-5 degC, 0 degC, 5 degC]", AXES[1]), "has 3 evaporating temperatures that are ok; a cubic needs 4"),
        ((AXES[0], "[30 degC, 40 degC, 45 degC]"), "has 3 condensing temperatures that are ok; a cubic needs 4"),
        (("[270 K, 270.0001 K, 270.0002 K, 280 K]", AXES[1]), "points do not determine the ten coefficients"),
    ],
)
def test_points_that_do_not_suffice_are_refused(axes, message, tmp_path):
    results = swept(tmp_path, *axes)
    with pytest.raises(UsageError) as refusal:
        performance_maps(results, NO_CAPACITY)
    assert message in str(refusal.value) and "\n" not in str(refusal.value)


def test_a_file_without_the_axes_is_refused_with_the_remedy(tmp_path):
    scene = loads("base: point.yaml\nsweep: {operation.speed: [1000 rpm, 2000 rpm]}\n", folder=str(CONFIGS))
    run_sweep(scene, tmp_path / "map.h5", jobs=1, simulate=cubic)
    with pytest.raises(UsageError, match=r"has no axis operation\.evaporating_temperature and .*screwsim sweep"):
        performance_maps(open_results(tmp_path / "map.h5"))


def test_a_figure_that_is_not_there_leaves_no_points(tmp_path):
    with pytest.raises(UsageError, match=r"0 of 16 points are ok and have all figures"):
        performance_maps(swept(tmp_path, *AXES))  # the fake has no cooling capacity


@pytest.mark.parametrize(("there", "power"), [((), "shaft_power"), (("electrical_power",), "electrical_power")])
def test_the_power_that_is_mapped_is_what_a_motor_draws_where_there_is_one(there, power):
    """EN 12900 and AHRI 540 rate the power input, of open compressors that of the shaft."""
    results = SimpleNamespace(performance=dict.fromkeys(("shaft_power", *there)))
    assert usual_figures(results) == (power, "gas_mass_flow", "cooling_capacity")


def with_tolerance(scene) -> Result:
    """Return the cubics with half of an interval by one input: 3 % of the power, 4 % below 0 °C; none of the flow."""
    result = cubic(scene)
    if result.status != "ok":
        return result
    power, cold = result.performance["shaft_power"], scene.operation.evaporating_temperature < 273.0
    path = "effects.tip_leakage.gap"
    change = {"paths": [path], "share": 1.0, "change": (0.04 if cold else 0.03) * power}
    figures = {"shaft_power": {"expanded": abs(change["change"]), "contributors": [change]}}
    told = {"figures": figures, "groups": [[path]], "left_out": {}, "coverage_factor": 2.0}
    return replace(result, uncertainty=told)


def test_a_map_says_how_far_the_tolerances_of_the_inputs_move_its_points(tmp_path, capsys):
    with_them = str(swept(tmp_path, *AXES, simulate=with_tolerance).path)
    (found,) = performance_maps(open_results(with_them), NO_CAPACITY)
    # eight points below 0 °C, seven that closed above
    assert found.fits["shaft_power"].by_inputs == pytest.approx((8 * 0.04 + 7 * 0.03) / 15, rel=1e-12)
    assert found.fits["gas_mass_flow"].by_inputs in (None, 0.0)
    out = tmp_path / "map.csv"
    figures = [f"--figure={name}" for name in NO_CAPACITY]
    assert exit_code(["map", with_them, *figures, "-o", str(out)]) == 4  # 10/50 °C fails
    assert re.search(r"^by tolerances +3\.5 %", text := capsys.readouterr().out, re.MULTILINE)
    assert "95 % interval by the inputs' tolerances" in " ".join(text.split())
    assert out.read_text().partition("\n")[0].endswith(",by_inputs")


def test_a_point_of_a_map_has_the_tolerances_of_its_figures(tmp_path, capsys):
    with_them = str(swept(tmp_path, *AXES, simulate=with_tolerance).path)
    at = ["--at", "evaporating_temperature=1 degC, condensing_temperature=41 degC", "--figure", "shaft_power"]
    assert exit_code(["map", with_them, *at]) == 0
    text = capsys.readouterr().out
    assert re.search(r"^shaft power .* kW  ± 3\.5 %$", text, re.MULTILINE)
    assert "±: half of the 95 % interval by the inputs' tolerances, mean over the points" in " ".join(text.split())
    assert exit_code(["map", with_them, *at, "--json"]) == 0
    (point,) = json.loads(capsys.readouterr().out)["points"]
    share = (8 * 0.04 + 7 * 0.03) / 15
    assert point["by_inputs"]["shaft_power"] == pytest.approx(share * point["figures"]["shaft_power"], rel=1e-12)


def test_a_map_names_an_input_that_has_no_derivative_at_some_point(tmp_path, capsys):
    def lost_in_the_cold(scene):
        result = with_tolerance(scene)
        lost = {"oil.heat_capacity": "failed"} if scene.operation.evaporating_temperature < 273.0 else {}
        groups = [["effects.tip_leakage.gap"], ["oil.heat_capacity"]]
        told = {**result.uncertainty, "groups": groups, "left_out": lost}
        return replace(result, uncertainty=told) if result.status == "ok" else result

    exit_code(["map", str(swept(tmp_path, *AXES, simulate=lost_in_the_cold).path), "--figure", "shaft_power"])
    told = " ".join(capsys.readouterr().out.split())
    assert "without oil.heat_capacity, whose part is unknown at some points, so too small there" in told


def test_a_point_of_a_map_without_tolerances_has_none(known, capsys):
    at = ["--at", "evaporating_temperature=1 degC, condensing_temperature=41 degC", "--figure", "shaft_power"]
    assert exit_code(["map", known, *at]) == 0
    assert "±" not in capsys.readouterr().out


def test_a_map_without_tolerances_has_no_line_of_them(known, capsys):
    assert exit_code(["map", known, *(f"--figure={name}" for name in NO_CAPACITY)]) == 4
    assert "tolerances" not in capsys.readouterr().out


def test_an_empty_map_covers_nothing():
    assert not PerformanceMap({}).inside(0.0, 40.0)


@pytest.mark.slow
@pytest.mark.around
def test_the_shipped_map_is_a_good_fit(tmp_path):
    run_sweep(load(CONFIGS / "map.yaml"), tmp_path / "map.h5")
    (found,) = performance_maps(open_results(tmp_path / "map.h5"), ("shaft_power", "gas_mass_flow"))
    assert (found.points, found.not_ok) == (30, 0)
    # the flow is nearly a cubic; the power is not where discharge opens before or after the pressures are equal
    for figure, largest, left_out in (("shaft_power", 5e-3, 2e-2), ("gas_mass_flow", 5e-4, 1e-3)):
        fit = found.fits[figure]
        assert fit.largest < largest and fit.left_out is not None and fit.left_out < left_out


# ---- the map at points ----


@pytest.fixture(scope="module")
def known(tmp_path_factory) -> str:
    return str(swept(tmp_path_factory.mktemp("known"), *AXES).path)


def test_a_point_of_the_map_is_the_polynomial_there(tmp_path, capsys):
    results = swept(tmp_path, *AXES)
    found = evaluate_map(results.path, 273.15, 311.15, figures=("mdot",))
    assert found == pytest.approx({"gas_mass_flow": SHARE * polynomial(FLOW, np.array(0.0), np.array(38.0))}, rel=1e-9)
    at = "evaporating_temperature=-5 degC, operation.condensing_temperature=311.15 K"
    arguments = ["map", str(results.path), "--at", at, "--figure", "shaft_power"]
    assert exit_code([*arguments, "--json"]) == 0  # though one case of the sweep failed: the point is inside
    (point,) = json.loads(capsys.readouterr().out)["points"]
    assert point["figures"]["shaft_power"] == pytest.approx(float(polynomial(POWER, np.array(-5.0), np.array(38.0))))
    assert exit_code(arguments) == 0
    assert "evaporating / condensing temperature -5 / 38 °C" in capsys.readouterr().out


def test_another_axis_chooses_the_map(tmp_path):
    results = swept(tmp_path, *AXES, "  operation.speed: [1000 rpm, 2000 rpm]\n")
    one, two = (evaluate_map(results, 273.15, 313.15, NO_CAPACITY, speed=rpm * math.pi / 30) for rpm in (1000, 2000))
    assert two["gas_mass_flow"] == pytest.approx(2.0 * one["gas_mass_flow"], rel=1e-9)
    assert evaluate_map(results, 273.15, 313.15, NO_CAPACITY, speed="2000 rpm") == two
    told = (
        "there are 2 maps of it (state speed as well, e.g. speed=1000 rpm; there are maps at operation.speed = 1000 rpm"
    )
    with pytest.raises(UsageError, match=re.escape(told)):
        evaluate_map(results, 273.15, 313.15, NO_CAPACITY)
    with pytest.raises(UsageError, match=r"there is no map for it \(there are maps at"):
        evaluate_map(results, 273.15, 313.15, NO_CAPACITY, speed=100.0)


@pytest.mark.parametrize(
    ("path", "value", "shown"),
    [
        ("machine.bore", 0.06, "machine.bore = 60 mm"),  # of a slider-crank
        ("machine.rotor_diameter", 0.16, "machine.rotor_diameter = 160 mm"),
        ("effects.my.spring.stiffness", 3.0, "effects.my.spring.stiffness = 3"),  # of a module of one's own
    ],
)
def test_axes_of_any_machine_are_told_with_their_units(path, value, shown):
    assert place_in_words({path: value}) == shown


def test_what_varies_with_a_temperature_is_told_and_cannot_be_chosen(tmp_path, capsys):
    zipped = f"operation.evaporating_temperature: {AXES[0]}, operation.superheat: [8 K, 9 K, 10 K, 11 K]"
    warm = f"  zip: [{{{zipped}}}]\n"
    text = f"base: point.yaml\nsweep:\n  operation.condensing_temperature: {AXES[1]}\n{warm}"
    run_sweep(loads(text, folder=str(CONFIGS)), tmp_path / "map.h5", jobs=1, simulate=nearly)
    results = open_results(tmp_path / "map.h5")
    assert exit_code(["map", str(results.path), "--figure", "shaft_power", "--json"]) == 0
    (told,) = json.loads(capsys.readouterr().out)["follows"]
    assert (told["path"], told["of"]) == ("operation.superheat", "operation.evaporating_temperature")
    assert told["values"] == [8.0, 9.0, 10.0, 11.0] and told["at"] == pytest.approx([258.15, 268.15, 273.15, 283.15])
    line = "# operation.superheat = 8 K, 9 K, 10 K, 11 K where operation.evaporating_temperature = -15 degC, -5 degC, "
    assert line in en12900_csv(polynomials(results, NO_CAPACITY))
    assert evaluate_map(results, 273.15, 313.15, NO_CAPACITY)
    with pytest.raises(UsageError, match=r"superheat varies together with a temperature in this .* \(leave it"):
        evaluate_map(results, 273.15, 313.15, NO_CAPACITY, superheat=20.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("evaporating_temperature=10 degC, condensing_temperature=50 degC", "lies outside the envelope"),
        ("evaporating_temperature=2 degC", "does not state condensing_temperature"),
        ("evaporating_temperature=2", "'2' has no unit (write e.g. '285 K')"),
        ("cold", "is not NAME=VALUE, NAME=VALUE (write e.g. --at"),
        ("evaporating_temperature=2 degC, evaporating_temperature=3 degC", "is given twice (remove one)"),
        ("evaporating_temprature=2 degC", "is not known; did you mean 'evaporating_temperature'?"),
    ],
)
def test_a_point_that_the_map_does_not_know_is_refused_in_one_line(known, capsys, text, words):
    assert exit_code(["map", known, "--figure", "shaft_power", "--at", text]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.startswith(f"--at {text}: ") and words in err and len(err.splitlines()) == 1
