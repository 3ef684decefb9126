"""Maps: as fine as is asked for, their errors those of points they were not made from, open cycles flagged."""

import math
import pickle
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI

from screwsim import simulate as simulate_scene
from screwsim.export.inputs import read_inputs, read_outputs
from screwsim.export.source import map_of
from screwsim.export.table import TEMPERATURE_SCALE, scales, table_of, tabulated_map
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figure, Figures, Result
from screwsim.results import open_results
from screwsim.scene import load, with_values
from screwsim.scene.write import scene_text
from screwsim.study.maps import short_names
from screwsim.study.sweep import run_sweep

pytestmark = pytest.mark.around

ROOT = Path(__file__).parents[2]
POINT = load(ROOT / "configs" / "paper" / "point.yaml")
OF_CONDENSER = ("gas_mass_flow", "separator_temperature", "heating_capacity")
SPEED, PRESSURE = "operation.speed=2000 rpm..4000 rpm", "operation.discharge.pressure=4 bar..16 bar"


def curve(scene) -> Result:
    """Return figures with a curvature in the pressure alone; fail at the highest pressures of high speed."""
    n, p = scene.operation.speed / 300.0, scene.operation.discharge.pressure / 1e6
    if n > 1.2 and p > 1.2:
        return Result("failed", "it is too much")
    figures = Figures(gas_mass_flow=n * (1.0 - 0.1 * p), shaft_power=1e4 * n * math.exp(p), discharge_temperature=350.0)
    return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))


def made(wanted: float, most: int = 5000, simulate=curve):
    inputs = read_inputs(POINT, [SPEED, PRESSURE])
    return tabulated_map(POINT, inputs, read_outputs(POINT), wanted, most=most, jobs=1, simulate=simulate)


def points(table, count=200):
    random = np.random.default_rng(5)
    low, high = ([getattr(one, end) for one in table.inputs] for end in ("low", "high"))
    return random.uniform(low, high, (count, len(table.inputs)))


def test_the_error_asked_for_is_kept_at_other_points():
    table = made(1e-3)
    x = points(table)
    found, inside = table(x)
    results = [curve(with_values(POINT, dict(zip((one.path for one in table.inputs), at, strict=True)))) for at in x]
    true = np.array([[r.performance.get(each.name, np.nan) for each in table.outputs] for r in results])
    errors = np.abs(found - true) / scales(table.outputs, true)
    assert table.met and table.error <= 1e-3
    assert inside.sum() > 150 and np.max(errors[inside]) <= 1e-3


def test_the_heat_of_a_condenser_follows_from_the_usual_outputs():
    """A plant's model has what flows to its condenser, how warm it is behind the separator, and the heat itself."""
    scene = load(ROOT / "configs" / "r134a" / "separator.yaml")
    result = simulate_scene(scene).performance
    m, T, heat = (getattr(result, each.name) for each in read_outputs(scene) if each.name in OF_CONDENSER)
    T_c = scene.operation.condensing_temperature
    p_c, liquid = (PropsSI(each, "T", T_c, "Q", 0, "R134a") for each in "PH")
    assert m * (PropsSI("H", "T", T, "P", p_c, "R134a") - liquid) == pytest.approx(heat, rel=1e-4)


def test_a_power_that_is_given_off_is_said_to_be(tmp_path):
    def expands(scene) -> Result:
        figures = dict(curve(with_values(scene, {"operation.discharge.pressure": 5e5})).performance)
        return Result("ok", performance=Figures(figures | {"shaft_power": -figures["shaft_power"]}))

    meanings = [{one.name: one.long_name for one in made(0.5, simulate=each).outputs} for each in (curve, expands)]
    assert [each["shaft_power"] for each in meanings] == ["shaft power", "shaft power; below zero: given off"]
    speeds = POINT.with_({"sweep.operation.speed": ["2000 rpm", "3000 rpm", "4000 rpm"]})
    run_sweep(speeds, tmp_path / "x.h5", jobs=1, simulate=expands)
    (power,) = [one for one in table_of(open_results(tmp_path / "x.h5")).outputs if one.name == "shaft_power"]
    assert power.long_name.endswith("; below zero: given off")


def test_only_what_curves_is_refined():
    table = made(1e-4)
    speeds, pressures = (len(x) for x in table.grid.nodes)
    assert pressures > 5 == speeds
    assert table.cases == speeds * pressures + 32


def test_points_without_a_closed_cycle_are_outside():
    table = made(1e-3)
    _, inside = table([[400.0, 15e5], [250.0, 15e5], [400.0, 5e5], [450.0, 5e5], [250.0, 3e5]])
    assert inside.tolist() == [False, True, True, False, False]
    assert table.not_ok > 0


def test_a_map_is_evaluated_by_the_names_of_its_inputs():
    table = made(1e-3)
    n, p = np.array([[220.0], [300.0]]), np.array([5e5, 8e5, 20e5])
    found = table.evaluate(speed=n, discharge_pressure=p)
    rows, inside = table(np.column_stack([x.ravel() for x in np.broadcast_arrays(*reversed((p, n)))]))
    assert list(found) == [each.name for each in table.outputs]
    assert found["shaft_power"].shape == (2, 3) and found["shaft_power"].mask.tolist() == [[False, False, True]] * 2
    assert found["shaft_power"].data.ravel().tolist() == rows[:, 1].tolist() and inside.sum() == 4
    assert np.ma.getmaskarray(table.evaluate(speed=300.0, discharge_pressure=math.nan)["shaft_power"]).all()
    assert pickle.loads(pickle.dumps(table)).evaluate(speed=300.0, discharge_pressure=5e5)["gas_mass_flow"] > 0.0


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"sped": 300.0}, r"sped is not known; did you mean 'speed'\?"),
        ({"speed": 300.0}, r"lacks discharge_pressure between 400000 … 1.6e\+06 Pa \(pass it by its name\)"),
        ({"speed": "300 rpm", "discharge_pressure": 5e5}, r"speed: '300 rpm' is neither a number nor an array"),
        ({"speed": [1, 2], "discharge_pressure": [1, 2, 3]}, r"speed \(2,\), discharge_pressure \(3,\) \(pass arrays"),
    ],
)
def test_an_input_that_is_none_is_told(given, told):
    with pytest.raises(UsageError, match=told):
        made(0.1).evaluate(**given)


def test_where_and_why_nodes_did_not_close_is_told():
    table = made(1e-3)
    nodes = table.nodes
    open_ = [x[index] for x, index in zip(nodes, np.nonzero(~table.grid.sound), strict=True)]
    speeds, pressures = (f"{x.min():.6g} … {x.max():.6g}" for x in open_)
    assert table.where_open() == f"speed {speeds} rad/s, discharge_pressure {pressures} Pa"
    assert table.why == "it is too much"
    whole = made(0.5, simulate=lambda scene: curve(with_values(scene, {"operation.discharge.pressure": 5e5})))
    assert (whole.where_open(), whole.why) == ("", "")


def test_warnings_of_the_cases_are_told_with_their_number(tmp_path):
    def warned(scene) -> Result:
        found = curve(scene)
        at = scene.operation.discharge.pressure
        return replace(found, warnings=(f"{at / 1e5:.3g} bar are many",) if at > 10e5 else ())

    table = made(0.5, simulate=warned)
    ((count, text),) = table.warnings
    assert 0 < count < table.cases and text.endswith(" bar are many")
    assert table.warnings_told() == [f"warning in {count} cases of the map: {text}"]
    assert made(0.5).warnings == () and table.warnings_told()[0] in str(table)
    axes = {
        "sweep.operation.speed": ["2000 rpm", "3000 rpm"],
        "sweep.operation.discharge.pressure": ["5 bar", "11 bar"],
    }
    run_sweep(POINT.with_(axes), tmp_path / "x.h5", jobs=1, simulate=warned)
    assert table_of(open_results(tmp_path / "x.h5")).warnings == ((2, "11 bar are many"),)


def test_points_that_do_not_close_among_nodes_that_do_are_told():
    def holed(scene) -> Result:
        p = scene.operation.discharge.pressure
        return Result("failed", "a hole") if 6e5 < p < 7.5e5 else curve(scene)

    table = made(0.5, simulate=holed)
    assert table.not_ok == made(0.5).not_ok  # those of the corner: the hole lies between the nodes
    told = re.search(
        r"\(at (\d+) more no cycle closed, although it did at all surrounding nodes\)", table.error_in_words
    )
    assert told is not None
    assert int(told[1]) + table.checked <= 32
    assert "no cycle closed" not in made(0.5).error_in_words


def test_variables_of_a_map_have_names_of_their_own(tmp_path):
    inputs = read_inputs(POINT, [PRESSURE])
    with pytest.raises(UsageError, match=r"figure discharge_pressure is the name of an input.*\(name other figures"):
        tabulated_map(POINT, inputs, read_outputs(POINT, ["discharge_pressure"]), 0.01, jobs=1, simulate=curve)
    twice = [*inputs, replace(inputs[0], path="operation.other")]
    with pytest.raises(UsageError, match=r"would both be called discharge_pressure in the export \(vary one of them\)"):
        tabulated_map(POINT, twice, read_outputs(POINT), 0.01, jobs=1, simulate=curve)


def test_a_sweep_of_one_value_is_no_map(tmp_path):
    scene = POINT.with_({"sweep.operation.speed": ["2000 rpm"]})
    run_sweep(scene, tmp_path / "x.h5", jobs=1, simulate=curve)
    with pytest.raises(UsageError, match=r"varies nothing, as each axis has one value \(export a sweep over more\)"):
        table_of(open_results(tmp_path / "x.h5"))


def test_what_is_not_met_within_the_cases_is_said():
    table = made(1e-7, most=30)
    assert not table.met and table.error > 1e-7 and math.prod(map(len, table.grid.nodes)) <= 30


def test_nothing_closed_is_no_map():
    with pytest.raises(UsageError, match=r"no map: none of 25 points closed \(always\)"):
        made(1e-3, simulate=lambda scene: Result("failed", "always"))


def test_pressures_over_a_wide_range_lie_over_their_logarithm():
    speed, pressure = read_inputs(POINT, [SPEED, PRESSURE])
    assert (speed.log, pressure.log) == (False, True)
    assert (speed.name, pressure.name, pressure.units) == ("speed", "discharge_pressure", "Pa")


def test_an_input_is_explained_to_those_who_see_no_scene():
    ranges = ["operation.evaporating_temperature=0 degC..5 degC", "operation.condensing_temperature=40 degC..50 degC"]
    plain = load(Path(__file__).parents[1] / "plain" / "r134a.yaml")
    meanings = [each.long_name for each in read_inputs(plain, ranges)]
    assert meanings[0] == "evaporating temperature: dew point at p_s"
    assert meanings[1].startswith("condensing temperature: ") and "instead" not in meanings[1]


def test_temperatures_err_over_100_kelvin():
    found = scales((Figure("T", "K", ""), Figure("P", "W", "")), np.array([[300.0, 5.0], [400.0, 1000.0]]))
    assert found.tolist() == [[TEMPERATURE_SCALE, 100.0], [TEMPERATURE_SCALE, 1000.0]]


def test_a_file_of_a_sweep_is_a_map(tmp_path):
    axes = {"sweep.operation.speed": ["4000 rpm", "2000 rpm", "3000 rpm"]}
    axes["sweep.operation.discharge.pressure"] = [f"{p} bar" for p in (4, 5, 6, 8, 10, 13)]
    run_sweep(POINT.with_(axes), tmp_path / "x.h5", jobs=1, simulate=curve)
    table = table_of(open_results(tmp_path / "x.h5"))
    at = [[230.0, 5e5], [314.159, 10e5]]
    found, inside = table(at)
    assert inside.all() and table.wanted is None and "is left out" in table.how
    for row, (n, p) in zip(found, at, strict=True):
        assert row[0] == pytest.approx(n / 300.0 * (1.0 - 0.1 * p / 1e6), rel=1e-6)
    assert 0.0 < table.error < 0.05


def test_an_input_of_a_file_is_explained_as_one_of_a_scene(tmp_path):
    axes = {"sweep.operation.evaporating_temperature": [f"{t} degC" for t in range(5)]}
    scene = load(Path(__file__).parents[1] / "plain" / "r134a.yaml").with_(axes)
    figures = Figures(gas_mass_flow=1.0, shaft_power=1e4)
    done = Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))
    run_sweep(scene, tmp_path / "x.h5", jobs=1, simulate=lambda scene: done)
    (one,) = table_of(open_results(tmp_path / "x.h5")).inputs
    assert one.long_name == "evaporating temperature: dew point at p_s"


@pytest.mark.parametrize(
    ("over", "says"),
    [
        ("operation.speed", "is not PATH=LOW..HIGH"),
        ("operation.speed=3000 rpm..2000 rpm", "the range 3000 rpm … 2000 rpm is empty"),
        ("oil_supply.ratio=0...5", "is not PATH=LOW..HIGH"),  # 0 to 5, or to 0.5
        ("gas.fluid=a..b", "gas.fluid: is a fluid, not a continuous quantity|gas.fluid: 'a'"),
        ("machine.male_lobes=3..5", "machine.male_lobes: is a whole number, not a continuous quantity"),
        ("operation.sped=1 rpm..2 rpm", "did you mean"),
        ("operation.speed=1..2", "has no unit|rpm"),
    ],
)
def test_ranges_that_make_no_sense_are_refused(over, says):
    with pytest.raises(UsageError, match=says):
        read_inputs(POINT, [over])


def test_a_bare_low_end_has_the_unit_of_the_high_one():
    (short,), (whole,) = (read_inputs(POINT, [f"operation.speed={ends}"]) for ends in ("2..3 rpm", "2 rpm..3 rpm"))
    assert (short.low, short.high) == (whole.low, whole.high)


def test_a_map_cannot_be_better_than_its_cycles(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text(scene_text(POINT))
    with pytest.raises(UsageError, match="a map cannot be more accurate"):
        map_of(str(path), [SPEED], wanted=1e-5)


def test_results_cannot_be_changed(tmp_path):
    run_sweep(
        POINT.with_({"sweep.operation.speed": ["2000 rpm", "3000 rpm"]}), tmp_path / "x.h5", jobs=1, simulate=curve
    )
    with pytest.raises(UsageError, match="which --set cannot change"):
        map_of(str(tmp_path / "x.h5"), overrides=["operation.speed=1 rpm"])
    assert map_of(str(tmp_path / "x.h5"), figures=["shaft power"]).outputs[0].name == "shaft_power"


def test_two_inputs_of_one_external_name_are_refused(monkeypatch):
    """An exported map would hold two variables of that name, as of two effects of one's own."""
    for path in ("operation.speed", "operation.discharge.pressure"):
        monkeypatch.setitem(short_names.NAMES, path, "drive")
    with pytest.raises(
        UsageError, match=r"operation\.speed and operation\.discharge\.pressure would both be called drive"
    ):
        read_inputs(POINT, [SPEED, PRESSURE])
