"""The paper's laws and the same laws as tables: every figure is the same, whatever zeros stand beside an opening."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from folders import CONFIGS, ROOT

from screwsim.figures.errors import relative_errors, worst
from screwsim.machine import paper_law
from screwsim.machine.geometry import Geometry
from screwsim.machine.laws import area_breakpoints
from screwsim.scene import load, value_at
from screwsim.simulate import simulate

SCENES = {
    "paper": CONFIGS / "paper" / "point.yaml",
    "r134a": ROOT / "tests" / "plain" / "r134a.yaml",
    "expander": CONFIGS / "expander" / "point.yaml",
}
ROWS = np.arange(0.0, 720.01, 0.25)  # deg, the whole life
BOTH = 2.0  # results that are compared, each within the wanted accuracy
ALIKE = 1e-4  # of the area between the rows of 0.25 deg and the law itself, and what that does to the figures


def table(folder, name, column, function):
    """Write a law as a table over the whole life; return its path."""
    rows = "".join(f"{angle:.10g},{function(math.radians(angle)):.12g}\n" for angle in ROWS)
    path = folder / f"{name}.csv"
    path.write_text(f"angle_deg,{column}\n{rows}", encoding="utf-8")
    return str(path)


def tabled(scene, folder):
    """Return the changes that give the laws of a scene as tables."""
    numbers = ("volume.max", "volume.phi_A", "suction_port.area", "suction_port.phi_B")
    V, phi_A, S_s, phi_B = (value_at(scene, f"machine.{name}") for name in numbers)
    S_d, opens, phi_C = (value_at(scene, f"machine.discharge_port.{name}") for name in ("area", "opens", "phi_C"))
    laws = {
        "volume": ("volume_m3", lambda phi: paper_law.volume(phi, V, 0.0, phi_A)),
        "suction_port": ("area_m2", lambda phi: paper_law.suction_area(phi, S_s, phi_B)),
        "discharge_port": ("area_m2", lambda phi: paper_law.discharge_area(phi, S_d, opens, phi_C)),
    }
    swept = {"volume": f", max: {V!r} m^3", "suction_port": "", "discharge_port": ""}
    return [
        f"machine.{name}={{law: table, file: {table(folder, name, *law)}{swept[name]}}}" for name, law in laws.items()
    ]


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Return a function from the name of a scene to its result by the paper's laws and that by the tables."""

    @cache
    def made(name):
        path = str(SCENES[name])
        scene = load(path)
        of_tables = load(path, tabled(scene, tmp_path_factory.mktemp(name)))
        return simulate(scene), simulate(of_tables)

    return made


@pytest.mark.parametrize("name", SCENES)
def test_every_figure_is_the_same(both, name):
    of_law, of_table = both(name)
    errors = relative_errors(of_table.performance, of_law.performance)
    assert worst(errors)[1] < BOTH * 3e-4 + ALIKE, worst(errors)
    nulls = [{key for key, value in result.performance.items() if value is None} for result in both(name)]
    assert nulls[0] == nulls[1]


@pytest.mark.parametrize("name", SCENES)
def test_every_warning_is_the_same(both, name):
    of_law, of_table = both(name)
    assert of_table.status == of_law.status == "ok"
    assert of_table.warnings == of_law.warnings == ()


@pytest.mark.parametrize("name", SCENES)
def test_a_port_opens_and_is_widest_where_its_area_says_so(tmp_path, name):
    path = str(SCENES[name])
    scene = load(path)
    of_law, of_table = Geometry(scene.machine), Geometry(load(path, tabled(scene, tmp_path)).machine)
    step = math.radians(0.25)
    assert of_table.discharge_opens == pytest.approx(of_law.discharge_opens, abs=1e-9)
    assert of_table.widest_discharge() == pytest.approx(of_law.widest_discharge(), abs=step)
    assert (of_table.inlet_closes is None) == (of_law.inlet_closes is None)


def test_steps_end_where_a_table_opens_and_shuts_not_at_its_zeros():
    rows = np.radians(np.arange(0.0, 8.0) * 9.0)
    areas = np.array([0, 0, 1, 2, 3, 1, 0, 0.0])  # broad enough for steps not to leap over it
    assert area_breakpoints(rows, areas) == pytest.approx(np.radians([9.0, 54.0]))


def test_steps_end_on_narrow_tops_and_bottoms_of_a_table():
    rows = np.radians(np.arange(0.0, 60.0, 2.0))
    areas = np.full(len(rows), 10.0) + np.linspace(0.0, 0.1, len(rows))
    areas[[10, 13]] = 14.0, 5.0  # at 20 and 26 deg, on a base that is not smooth to the last digit
    assert area_breakpoints(rows, areas) == pytest.approx(np.radians([0.0, 20.0, 26.0, 58.0]))


def test_a_port_that_is_never_shut_before_it_is_widest_has_no_opening(tmp_path):
    path = tmp_path / "open.csv"
    path.write_text("angle_deg,area_m2\n0,1e-4\n660,1e-3\n720,0\n", encoding="utf-8")
    scene = load(str(CONFIGS / "paper" / "point.yaml"), [f"machine.discharge_port={{law: table, file: {path}}}"])
    assert Geometry(scene.machine).discharge_opens is None


def test_a_scene_whose_table_has_changed_is_simulated_by_what_stands_there_now(tmp_path):
    """The scene is loaded once, and its file written again between two solutions of it."""
    file = tmp_path / "v.csv"
    stated = f"machine.volume={{law: table, max: 600 cm^3, phi_A: null, file: {file}}}"

    def write(power):
        rows = (f"{2 * i},{6e-4 * math.sin(math.pi * i / 360) ** power:.9e}\n" for i in range(361))
        file.write_text("angle_deg,volume_m3\n" + "".join(rows), encoding="utf-8")

    write(2)
    scene = load(SCENES["paper"], [stated])
    before = simulate(scene, trace=False)
    write(3)
    after, anew = simulate(scene, trace=False), simulate(load(SCENES["paper"], [stated]), trace=False)
    assert after.performance == anew.performance != before.performance


@pytest.mark.parametrize(("speed", "gap"), [("235 rpm", "15 um"), ("1000 rpm", "145 um")])
def test_work_follows_a_rough_volume_while_a_port_holds_the_pressure(speed, gap):
    """No error of the states sees there what steps leap over; where they end at the rows balances close at once."""
    rough = ROOT / "tests" / "hard" / "rough_volume.csv"
    law = f"machine.volume={{law: table, max: 528 cm^3, phi_A: null, min: 0.5 cm^3, file: {rough}}}"
    others = f"operation.speed={speed}", f"effects.interlobe_leakage.gap={gap}", "operation.discharge.pressure=2 bar"
    ours = simulate(load(SCENES["paper"], [law, *others]), trace=False)
    finer = "numerics.accuracy=1e-6", "numerics.error=none", "numerics.closing=coupled"
    better = simulate(load(SCENES["paper"], [law, *others, *finer]), trace=False)
    assert relative_errors(ours.performance, better.performance)["work_per_cycle"] <= ours.error["work_per_cycle"]
    assert ours.numerics.rhs_evaluations <= 15_000  # 120 000 and more where the rows are no breakpoints
