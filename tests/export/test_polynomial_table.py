"""A unit of AHRI polynomials: a cubic is itself, the C is the polynomial, its stated error holds at other points."""

import json
import re
import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from screwsim.cli import exit_code
from screwsim.export.fmu import write_fmu
from screwsim.export.hermite import grid_of
from screwsim.export.inputs import Input
from screwsim.export.polynomial_table import polynomial_table
from screwsim.export.source import map_of
from screwsim.export.table import scales
from screwsim.inputs.faults import UsageError
from screwsim.scene import load, with_values
from screwsim.simulate import simulate_many
from screwsim.study.maps.performance_map import TERMS, performance_maps, polynomial

pytestmark = pytest.mark.around

R134A = str(Path(__file__).parents[2] / "configs" / "r134a" / "point.yaml")
TEMPERATURES = (
    "operation.evaporating_temperature=-10 degC..5 degC",
    "operation.condensing_temperature=35 degC..50 degC",
)


@pytest.fixture(scope="module")
def polynomials():
    """Return a table of the R134a machine over both temperatures, and its polynomials."""
    table = map_of(R134A, TEMPERATURES, wanted=0.01, without=("motor",), jobs=1)
    return table, polynomial_table(table)


def with_grid(table, nodes, values, sound=None):
    sound = np.ones(values.shape[:-1], bool) if sound is None else sound
    return replace(table, grid=grid_of(nodes, values, sound), outputs=table.outputs[:1], errors=(1e-3,))


def cubic(S, D):
    x, y = (S - 273.0) / 20.0, (D - 313.0) / 20.0
    return sum((1.0 + number) * x**p * y**q for number, (p, q) in enumerate(TERMS))


def inside(table, count, seed=3):
    low, high = (np.array([getattr(one, end) for one in table.inputs]) for end in ("low", "high"))
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


def test_polynomials_of_a_fine_table_of_a_cubic_are_that_cubic(polynomials):
    table = polynomials[0]
    nodes = [np.linspace(one.low, one.high, 31) for one in table.inputs]
    mesh = dict(zip([one.name for one in table.inputs], np.meshgrid(*nodes, indexing="ij"), strict=True))
    values = cubic(mesh["evaporating_temperature"], mesh["condensing_temperature"])
    found = polynomial_table(with_grid(table, nodes, values[..., None]))
    assert [len(x) for x in found.grid.nodes] == [2, 2]
    x = inside(table, 40)
    at = dict(zip(mesh, x.T, strict=True))
    true = cubic(at["evaporating_temperature"], at["condensing_temperature"])
    assert found(x)[0][:, 0] == pytest.approx(true, rel=1e-6)
    assert 1e-3 <= found.errors[0] < 1.01e-3  # the table's own


def test_a_third_input_keeps_its_nodes_and_its_spline(polynomials):
    table = polynomials[0]
    speed = Input("operation.speed", "speed", "rad/s", "speed", 100.0, 400.0, 300.0, False)
    three = replace(table, inputs=(*table.inputs, speed))
    nodes = [np.linspace(one.low, one.high, 9) for one in three.inputs]
    S, D, w = np.meshgrid(*nodes, indexing="ij")
    found = polynomial_table(with_grid(three, nodes, ((S - 250.0) * (w / 100.0) ** 2 + D)[..., None]))
    assert [len(x) for x in found.grid.nodes] == [2, 2, 9]
    x = inside(three, 40)
    assert found(x)[0][:, 0] == pytest.approx((x[:, 0] - 250.0) * (x[:, 2] / 100.0) ** 2 + x[:, 1], rel=1e-5)


def test_it_is_near_the_polynomials_that_are_fitted_to_the_points(polynomials, swept_map):
    table = polynomials[1]
    fit = performance_maps(swept_map, ["shaft_power"])[0].fits["shaft_power"]
    place = [each.name for each in table.outputs].index("shaft_power")
    x = inside(table, 40)
    at = dict(zip([one.name for one in table.inputs], x.T - 273.15, strict=True))
    theirs = polynomial(fit.coefficients, at["evaporating_temperature"], at["condensing_temperature"])
    assert table(x)[0][:, place] == pytest.approx(theirs, rel=2.0 * (table.errors[place] + fit.largest))


@pytest.mark.parametrize("version", ["2", "3"])
def test_fmpy_finds_it_valid_and_runs_it(polynomials, tmp_path, version):
    table = polynomials[1]
    path = str(tmp_path / f"x{version}.fmu")
    write_fmu(table, tmp_path / f"x{version}.fmu", version)
    assert validate_fmu(path) == []
    middle = {one.name: 0.5 * (one.low + one.high) for one in table.inputs}
    found = fmpy.simulate_fmu(path, stop_time=1.0, start_values=middle)
    wanted, _ = table([list(middle.values())])
    assert [float(found[each.name][-1]) for each in table.outputs] == pytest.approx(wanted[0].tolist(), rel=1e-12)
    assert bool(found["valid"][-1]) and found["error_estimate"][-1] == table.error
    outside = middle | {"condensing_temperature": table.inputs[1].high + 1.0}
    found = fmpy.simulate_fmu(path, stop_time=1.0, start_values=outside)
    assert not bool(found["valid"][-1]) and found["error_estimate"][-1] == 1.0


def test_its_error_holds_against_the_simulator(polynomials):
    table = polynomials[1]
    x = inside(table, 12)
    scene = load(R134A, without=("motor",))
    paths = [one.path for one in table.inputs]
    results = [*simulate_many((with_values(scene, dict(zip(paths, at, strict=True))) for at in x.tolist()), False)]
    true = np.array([[result.performance.get(each.name, np.nan) for each in table.outputs] for result in results])
    own = np.array([[result.error[each.name] for each in table.outputs] for result in results])  # of these points
    off = np.abs(table(x)[0] - true) / scales(table.outputs, true) - own
    assert np.isfinite(true).all() and np.all(off.max(axis=0) <= np.array(table.errors))


def test_open_nodes_stay_flagged(polynomials):
    table = polynomials[0]
    nodes = [np.linspace(one.low, one.high, 9) for one in table.inputs]
    sound = np.ones((9, 9), bool)
    sound[0, 0] = False
    S, D = np.meshgrid(*nodes, indexing="ij")
    found = polynomial_table(with_grid(table, nodes, cubic(S, D)[..., None], sound))
    corner = [[one.low + 0.01 for one in table.inputs], [one.high - 0.01 for one in table.inputs]]
    assert found(corner)[1].tolist() == [False, True]


def test_without_both_temperatures_it_says_what_is_missing(table, tmp_path, capsys):
    said = r"need operation\.evaporating_temperature and operation\.condensing"
    with pytest.raises(UsageError, match=said):
        polynomial_table(table)
    scene = str(Path(R134A).parents[1] / "paper" / "point.yaml")
    over = ["--over", "operation.speed=2000 rpm..3000 rpm"]
    assert exit_code(["export", "fmu", scene, "-o", str(tmp_path / "x.fmu"), *over, "--map", "polynomial"]) == 2
    told = capsys.readouterr().err
    assert re.search(said, told) and "simulating" not in told


def test_the_command_writes_it_and_holds_the_error_asked_for(tmp_path, capsys):
    ranges = [word for each in TEMPERATURES for word in ("--over", each)]
    command = ["export", "fmu", R134A, "-o", str(tmp_path / "x.fmu"), *ranges, "--without", "motor", "--jobs", "1"]
    assert exit_code([*command, "--map", "polynomial", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["error_is"].startswith("largest difference from a table") and 0.0 < told["error"] < 0.02
    assert [len(each) for each in told["nodes"]] == [2, 2]
    with zipfile.ZipFile(tmp_path / "x.fmu") as archive:
        assert json.loads(archive.read("resources/map.json"))["error_is"] == told["error_is"]
    assert exit_code([*command, "--map", "polynomial", "--error", "0.0012"]) == 4
