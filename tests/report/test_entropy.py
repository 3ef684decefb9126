"""The T–s figure: entropies are those of the gas, a tight chamber without heat keeps its own, and lines have names."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import screwsim
from screwsim.build import build_parts
from screwsim.inputs.faults import UsageError
from screwsim.outputs.derivatives import Derivatives
from screwsim.report import plot as draw_figures
from screwsim.report.entropy import entropies, scene_of_case
from screwsim.report.trace import chosen_trace, trace_of
from screwsim.results import open_results, save

ROOT = Path(__file__).parents[2]
PORTS = {"suction_port", "discharge_port"}
ONE = ["numerics.accuracy=1e-4", "numerics.error=none"]


def run(name: str, *changes: str):
    scene = screwsim.load(ROOT / name, [*changes, *ONE])
    result = screwsim.simulate(scene)
    return scene, result, trace_of(result)


@pytest.mark.parametrize("name", ["configs/paper/point.yaml", "tests/plain/r134a.yaml"])
def test_a_tight_chamber_without_oil_keeps_its_entropy_between_the_ports(name):
    others = sorted(set(screwsim.load(ROOT / name).effects) - PORTS)
    scene = screwsim.load(ROOT / name, ["oil_supply=null", "oil=null", *ONE], others)
    result = screwsim.simulate(scene)
    trace = trace_of(result)
    assert result.status == "ok"
    flows = [trace.values[f"mass_flow_{port}_port"] for port in ("suction", "discharge")]
    closed = (flows[0] == 0.0) & (flows[1] == 0.0) & (trace.angle > 370.0) & (trace.angle < 600.0)
    s = entropies(trace, scene).loop
    assert np.count_nonzero(closed) > 100
    gas = build_parts(scene).gas
    assert np.ptp(s[closed]) < 1e-4 * gas.R  # the accuracy asked for
    assert np.ptp(trace.values["gas_temperature"][closed]) > 10.0


def test_loop_and_isobars_are_of_the_gas_at_pressure_and_temperature():
    scene, _, trace = run("tests/plain/r134a.yaml")
    gas, found = build_parts(scene).gas, entropies(trace, scene)
    p, T = trace.values["pressure"], trace.values["gas_temperature"]
    at = [100, 300, 500, 640]
    wanted = np.array([gas.entropy(float(p[i]), float(T[i])) for i in at])
    np.testing.assert_allclose(found.loop[at] - found.loop[at[0]], wanted - wanted[0], atol=1e-5 * gas.c_p)
    assert found.loop[int(np.argmax(trace.values["volume"]))] == 0.0
    for symbol, (s, T_line) in found.isobars.items():
        h = np.array([gas.enthalpy(trace.pressures[symbol], float(each)) for each in T_line])
        mean = 0.5 * (T_line[1:] + T_line[:-1])
        np.testing.assert_allclose(np.diff(h), mean * np.diff(s), rtol=1e-4)  # dh = T ds at constant pressure
    assert found.dew is not None
    s, T_dew = found.dew
    assert np.all(np.diff(T_dew) > 0.0) and np.all(s < np.nanmax(found.loop))


def test_gas_in_a_chamber_whose_oil_takes_room_has_the_density_of_its_own_room():
    oiled = "effects.oil_volume={}"
    scene, _, trace = run("configs/paper/point.yaml", oiled, "oil.transport=carried")
    gas, s = build_parts(scene).gas, entropies(trace, scene).loop
    p, T = trace.values["pressure"], trace.values["gas_temperature"]
    wanted = gas.entropy(float(p[600]), float(T[600])) - gas.entropy(float(p[400]), float(T[400]))
    assert s[600] - s[400] == pytest.approx(wanted, abs=1e-4 * gas.R)


@pytest.mark.around
def test_the_command_and_python_draw_it(tmp_path):
    scene, result, _ = run("tests/plain/r134a.yaml")
    save(tmp_path / "x.h5", scene, result)
    assert any(Path(file).name == "temperature_entropy.png" for file in draw_figures(tmp_path / "x.h5", tmp_path / "f"))
    of_file, of_result = (Figure().subplots() for _ in range(2))
    assert screwsim.plot.temperature_entropy(tmp_path / "x.h5", ax=of_file) is of_file
    screwsim.plot.temperature_entropy(result, ax=of_result, scene=scene, color="red", label="mine")
    for one, other in zip(of_file.get_lines()[0].get_data(), of_result.get_lines()[0].get_data(), strict=True):
        np.testing.assert_array_equal(one, other)
    assert of_result.get_lines()[0].get_color() == "red" and of_result.get_legend() is not None
    names = {text.get_text() for text in of_file.texts}
    assert {"$p_s$", "$p_d$"} <= names and any(name.startswith("port opens") for name in names)
    assert chosen_trace(open_results(tmp_path / "x.h5")) is not None
    assert scene_of_case(open_results(tmp_path / "x.h5")).gas.fluid == "R134a"


def test_a_result_in_memory_has_its_scene_and_one_that_is_bare_needs_it():
    scene, result, _ = run("tests/plain/r134a.yaml")
    drawn = [Figure().subplots() for _ in range(2)]
    screwsim.plot.temperature_entropy(result, ax=drawn[0])
    screwsim.plot.temperature_entropy(result, ax=drawn[1], scene=scene)
    one, other = (axes.get_lines()[0].get_data() for axes in drawn)
    np.testing.assert_array_equal(one, other)
    bare = replace(result, derivatives=Derivatives())
    with pytest.raises(UsageError, match=r"does not know its scene.*\(pass what was simulated: scene=…\)"):
        screwsim.plot.temperature_entropy(bare)
