"""The unit is what it says: valid by FMPy, as exact as its map, flag and slopes true, and C that others can compile."""

import ctypes
import json
import math
import zipfile

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from screwsim.export.fmu import SOURCES, compile_shared, data_header, source_files, write_fmu
from screwsim.export.inputs import exponents, plain
from screwsim.export.table import scales
from screwsim.inputs.faults import UsageError
from screwsim.scene import load, with_values
from screwsim.simulate import simulate_many

pytestmark = pytest.mark.around
OPEN = """\
#include "map.h"
#include <time.h>
#define EXPORT __attribute__((visibility("default")))
EXPORT int evaluate(const double *x, double *y, double *g) { return map_evaluate(x, y, g); }
EXPORT double seconds(const double *points, int count, int calls)
{
    double y[MAP_OUTPUTS], g[MAP_OUTPUTS * MAP_INPUTS];
    volatile double kept = 0.0;
    clock_t began = clock();
    int i;
    for (i = 0; i < calls; i++) {
        map_evaluate(points + (i % count) * MAP_INPUTS, y, g);
        kept += y[0];
    }
    return (double)(clock() - began) / CLOCKS_PER_SEC / calls;
}
"""


@pytest.fixture(scope="module", params=["2", "3"])
def unit(request, table, tmp_path_factory):
    """Return the path of a unit of one version of FMI."""
    path = tmp_path_factory.mktemp("unit") / f"screw{request.param}.fmu"
    write_fmu(table, path, request.param)
    return str(path)


@pytest.fixture(scope="module")
def library(table, tmp_path_factory):
    """Return the compiled map alone."""
    sources = source_files(table, "2")
    path = tmp_path_factory.mktemp("library") / "map.so"
    sources["open.c"] = OPEN
    path.write_bytes(compile_shared(sources, ("map.c", "open.c"), "so"))
    return ctypes.CDLL(str(path))


def called(library, table, x):
    """Return outputs, gradient and flag of the compiled map at one point."""
    count, outputs = len(table.inputs), len(table.outputs)
    y, g = (ctypes.c_double * outputs)(), (ctypes.c_double * (outputs * count))()
    inside = library.evaluate((ctypes.c_double * count)(*x), y, g)
    return np.array(y), np.array(g).reshape(outputs, count), bool(inside)


def drawn(table, count, seed=11, beyond=0.0):
    low, high = (np.array([getattr(one, end) for one in table.inputs]) for end in ("low", "high"))
    margin = beyond * (high - low)
    return np.random.default_rng(seed).uniform(low - margin, high + margin, (count, len(low)))


def test_it_is_valid_and_runs(unit, table):
    assert validate_fmu(unit) == []
    start = {one.name: one.low for one in table.inputs}
    found = fmpy.simulate_fmu(unit, stop_time=2.0, output_interval=1.0, start_values=start)
    wanted, inside = table([list(start.values())])
    assert found["time"][-1] == 2.0 and inside[0] and bool(found["valid"][-1])
    assert [float(found[each.name][-1]) for each in table.outputs] == pytest.approx(wanted[0].tolist(), rel=1e-12)
    assert found["error_estimate"][-1] == table.error


def test_it_follows_its_inputs_and_flags_what_is_outside(unit, table):
    speeds = [table.inputs[0].low, 0.5 * table.inputs[0].low, table.inputs[0].high]
    signal = np.array([(float(t), x) for t, x in enumerate(speeds)], dtype=[("time", float), ("speed", float)])
    found = fmpy.simulate_fmu(unit, stop_time=2.0, output_interval=1.0, input=signal)
    assert [bool(flag) for flag in found["valid"]] == [True, True, False]  # FMPy sets inputs before a step
    assert found["error_estimate"][2] == 1.0
    assert found["gas_mass_flow"][1] == found["gas_mass_flow"][2]  # held at the border


def test_its_slopes_are_those_of_the_map(unit, table, tmp_path):
    description = fmpy.read_model_description(unit)
    folder = fmpy.extract(unit, str(tmp_path))
    one = fmpy.instantiate_fmu(folder, description, "CoSimulation")
    version3 = description.fmiVersion.startswith("3")
    values = [0.5 * (each.low + each.high) for each in table.inputs]
    (one.setFloat64 if version3 else one.setReal)(list(range(len(values))), values)
    step = 1e-4
    ahead, behind = (table([[values[0] * (1 + s), *values[1:]]])[0][0] for s in (step, -step))
    wanted = (ahead - behind) / (2 * step * values[0])
    unknowns = list(range(len(values), len(values) + len(table.outputs)))
    found = one.getDirectionalDerivative(unknowns, [0], [1.0])
    assert found == pytest.approx(wanted.tolist(), rel=1e-5)
    state = one.getFMUState() if version3 else one.getFMUstate()
    read = one.getFloat64 if version3 else one.getReal
    before = read(unknowns)
    one.reset()
    assert read(unknowns) != before
    (one.setFMUState if version3 else one.setFMUstate)(state)
    assert read(unknowns) == before
    one.freeInstance()


def test_compiled_c_agrees_with_the_simulator(library, table, point):
    x = drawn(table, 200)
    scene = load(point)
    results = simulate_many(
        [with_values(scene, dict(zip((o.path for o in table.inputs), at, strict=True))) for at in x], False
    )
    true = np.array([[result.performance[each.name] for each in table.outputs] for result in results])
    found = [called(library, table, at) for at in x]
    errors = np.abs(np.array([y for y, _, _ in found]) - true) / scales(table.outputs, true)
    assert len(found) == 200 and all(inside for _, _, inside in found)
    assert errors.max() <= table.wanted


def test_points_outside_are_flagged_on_each_side(library, table):
    for axis, one in enumerate(table.inputs):
        x = drawn(table, 200, seed=5)
        x[:100, axis] = one.low - np.linspace(1e-3, 1.0, 100) * (one.high - one.low)
        x[100:, axis] = one.high + np.linspace(1e-3, 1.0, 100) * (one.high - one.low)
        assert not any(called(library, table, at)[2] for at in x)


def test_a_call_takes_less_than_ten_microseconds(library, table):
    x = drawn(table, 200).ravel()
    library.seconds.restype = ctypes.c_double
    points = (ctypes.c_double * x.size)(*x)
    assert min(library.seconds(points, 200, 10_000) for _ in range(5)) < 10e-6  # of the processor, not of the clock


def test_compiled_c_is_the_map_inside_and_outside(library, table):
    x = drawn(table, 300, beyond=0.3)
    wanted, inside = table(x)
    found = [called(library, table, at) for at in x]
    np.testing.assert_allclose([y for y, _, _ in found], wanted, rtol=1e-11)
    assert [flag for _, _, flag in found] == inside.tolist()
    assert 0 < inside.sum() < len(x)


def test_gradients_of_the_c_are_those_of_its_values(library, table):
    for at in drawn(table, 20, seed=3):
        _, gradient, _ = called(library, table, at)
        for axis in range(len(at)):
            step = np.zeros(len(at))
            step[axis] = 1e-6 * at[axis]
            ahead, behind = (called(library, table, at + s * step)[0] for s in (1.0, -1.0))
            wanted = (ahead - behind) / (2 * step[axis])
            np.testing.assert_allclose(gradient[:, axis], wanted, rtol=1e-4, atol=1e-6 * np.abs(wanted).max())


def test_a_number_that_is_none_is_outside(library, table):
    y, _, inside = called(library, table, [math.nan, table.inputs[1].low])
    assert not inside and np.isfinite(y).all()


def test_the_same_map_is_the_same_unit(table, tmp_path):
    paths = [tmp_path / name / "x.fmu" for name in ("a", "b")]
    for path in paths:
        path.parent.mkdir()
        write_fmu(table, path, compiled=False)
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_sources_alone_compile_where_they_are_imported(table, tmp_path):
    write_fmu(table, tmp_path / "x.fmu", compiled=False)
    with zipfile.ZipFile(tmp_path / "x.fmu") as archive:
        assert not [name for name in archive.namelist() if name.startswith("binaries/")]
        about = json.loads(archive.read("resources/map.json"))
    assert about["outputs"][0]["name"] == "gas_mass_flow" and "machine:" in about["scene"]
    folder = fmpy.extract(str(tmp_path / "x.fmu"), str(tmp_path / "unzipped"))
    description = fmpy.read_model_description(folder)
    files = {path.name: path.read_text() for path in (tmp_path / "unzipped" / "sources").iterdir()}
    named = tuple(description.buildConfigurations[0].sourceFileSets[0].sourceFiles)
    binary = tmp_path / "unzipped" / "binaries" / "linux64" / "x.so"
    binary.parent.mkdir(parents=True)
    binary.write_bytes(compile_shared(files, named, "so"))
    assert bool(fmpy.simulate_fmu(folder, stop_time=1.0)["valid"][-1])


def test_without_a_compiler_the_remedy_is_said(table, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(UsageError, match="--sources-only"):
        write_fmu(table, tmp_path / "x.fmu")
    assert not (tmp_path / "x.fmu").exists()


def test_what_the_compiler_says_is_told(table):
    with pytest.raises(UsageError, match=r"cannot compile the map: .*error"):
        compile_shared({"a.c": "not C"}, ("a.c",), "so")


def test_another_map_has_another_token(table):
    assert data_header(table).split('"')[1] != data_header(table, "3").split('"')[1]
    assert set(SOURCES) == {"2", "3"}


@pytest.mark.parametrize(
    ("units", "told", "powers"),
    [
        ("kg s-1", "kg/s", {"kg": 1, "s": -1}),
        ("W", "W", {"kg": 1, "m": 2, "s": -3}),
        ("1", "1", {}),
        ("J/(kg K)", "J/(kg K)", {"m": 2, "s": -2, "K": -1}),
        ("W s m-3", "W s/m3", {"kg": 1, "m": -1, "s": -2}),
        ("rad/s", "rad/s", {"rad": 1, "s": -1}),
    ],
)
def test_units_are_made_of_base_units(units, told, powers):
    assert plain(units) == told
    assert exponents(told) == powers
