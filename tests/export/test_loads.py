"""Loads: what presses on the rotors' surfaces does the work of the cycle, and stands in the files that are written."""

import csv
import json
import math

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI
from folders import CONFIGS
from rotor_mesh import ALONG, areas, centres, positions

from screwsim.export import loads as exported
from screwsim.export.loads import flows_of, harmonics
from screwsim.export.rotor_loads import Pressures, Supports, loads_of, pressures_of
from screwsim.export.rotor_supports import assumed_of
from screwsim.export.source import run_of, spans_of
from screwsim.inputs.faults import UsageError
from screwsim.machine.profile_law import laid_curves
from screwsim.machine.rotors.pair import outlines
from screwsim.machine.rotors.sections import polygon_area
from screwsim.machine.rotors.surface import chamber_angles, surfaces
from screwsim.results import save
from screwsim.scene import load

pytestmark = pytest.mark.around

COMPACT = str(CONFIGS / "r134a" / "compact.yaml")


@pytest.fixture(scope="module")
def run():
    """Return the scene of a machine with rotors, and its result."""
    return run_of(COMPACT)


@pytest.fixture(scope="module")
def pressures(run) -> Pressures:
    scene, result = run
    return pressures_of(scene.machine, result)


@pytest.fixture(scope="module")
def found(pressures):
    return loads_of(pressures, Supports(((0.04, 0.06), (0.04, 0.06))))[1]


def test_surfaces_are_closed_and_hold_the_rotors(pressures):
    rotors = pressures.laid.rotors
    z = np.linspace(0.0, rotors.length, ALONG + 1)
    for surface, outline in zip(surfaces(rotors), outlines(rotors.pair, rotors.chain), strict=True):
        x, y = positions(surface, rotors, 0.7, z)
        ax, ay, _ = areas(surface, x, y, z)
        whole = np.abs(ax).sum()
        assert abs(ax.sum()) < 1e-3 * whole and abs(ay.sum()) < 1e-3 * whole
        held = 0.5 * float(((centres(x) - surface.centre) * ax + centres(y) * ay).sum())
        assert held == pytest.approx(polygon_area(*outline) * rotors.length, rel=0.005)  # of flat pieces


def test_both_flanks_of_a_groove_bound_one_chamber(pressures):
    rotors = pressures.laid.rotors
    z = np.linspace(0.0, rotors.length, 41)
    for surface in surfaces(rotors):
        found = chamber_angles(surface, rotors, 0.7, 0.5 * (z[1:] + z[:-1]))
        root, ahead = found[1:, 0], found[:-1, -1]  # a lobe's leading root, and the trailing root of that ahead of it
        same = pressures.at(root) - pressures.at(ahead)
        assert np.mean(np.abs(same) < 1.0) > 0.9  # but where one of the two is just in contact


def test_the_surfaces_do_the_work_of_the_cycle(found):
    male, female = found["male_torque"], found["female_torque"]
    own, other = (found[f"{name}_torque_by_virtual_work"] for name in ("male", "female"))
    assert np.max(np.abs(male - own)) < 0.01 * own.mean()  # tips and blow-hole: the convention of the sections
    assert abs(female.mean() - other.mean()) < 0.025 * own.mean()


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_the_surfaces_of_each_profile_do_the_work_of_a_compression(name):
    laid = laid_curves(load(CONFIGS / "rotors" / f"{name}.yaml").machine)
    angle = np.radians(np.arange(0.0, math.degrees(laid.life)))
    volume = laid.rotors.volume(np.clip(angle - laid.born, 0.0, laid.curves.life) + laid.rotors.start)
    closed = angle > laid.injection
    pressure = np.where(closed, 3e5 * (volume.max() / np.maximum(volume, 0.2 * volume.max())) ** 1.1, 3e5)
    found = loads_of(Pressures(laid, laid.on_rotors(angle, False), pressure, 3e5))[1]
    own, other = (found[f"{rotor}_torque_by_virtual_work"] for rotor in ("male", "female"))
    assert np.max(np.abs(found["male_torque"] - own)) < 0.015 * own.mean()
    assert abs(found["female_torque"].mean() - other.mean()) < 0.025 * own.mean()


def test_virtual_work_is_the_indicated_power(found, run):
    scene, result = run
    k = scene.machine.male_lobes / scene.machine.female_lobes
    own, other = (found[f"{name}_torque_by_virtual_work"].mean() for name in ("male", "female"))
    power = scene.operation.speed * (own + k * other)
    assert power == pytest.approx(result.performance.indicated_power, rel=0.003)  # 48 points; charge at birth left out


def test_the_gas_pushes_the_rotors_apart_and_to_suction(found):
    c = found
    assert c["male_force_x"].max() < 0.0 < c["female_force_x"].min()
    assert c["male_force_y"].max() < 0.0 and c["female_force_y"].max() < 0.0  # away from the high-pressure cusp
    assert c["male_axial_force"].max() < 0.0


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_areas_that_give_the_forces_of_the_surfaces_are_those_of_model_md(name):
    """M146: the mean force of all loads on a rotor over the sum of the chambers' pressures above suction, over D²."""
    unit = "effects.gas_torque={radial_area: 1 cm^2, axial_area: 1 cm^2}"
    scene, result = run_of(str(CONFIGS / "rotors" / f"{name}.yaml"), [unit])
    c = loads_of(pressures_of(scene.machine, result), Supports(shafts=(0.07, 0.07)))[1]
    pressed = result.performance.radial_gas_force / 1e-4 * scene.machine.rotor_diameter**2
    for rotor, across, along in (("male", (0.06, 0.075), (0.09, 0.11)), ("female", (0.075, 0.1), (0.01, 0.035))):
        radial = math.hypot(*(float(c[f"{rotor}_force_{way}"].mean()) for way in "xy")) / pressed
        axial = -float(c[f"{rotor}_thrust_bearing"].mean()) / pressed  # towards suction
        assert across[0] < radial < across[1] and along[0] < axial < along[1]


def test_bearings_carry_forces_and_moments(found, pressures):
    c, length = found, pressures.laid.rotors.length
    for name in ("male", "female"):
        for way in "xy":
            both = c[f"{name}_suction_bearing_{way}"] + c[f"{name}_discharge_bearing_{way}"]
            np.testing.assert_allclose(both, c[f"{name}_force_{way}"])
    near = loads_of(pressures)[1]["male_discharge_bearing_x"]
    far = c["male_discharge_bearing_x"]
    wanted = (near * length + 0.04 * c["male_force_x"]) / (length + 0.10)
    np.testing.assert_allclose(far, wanted)


THROTTLED = ["gas.model=ideal", "operation.suction.pressure=3 bar", "operation.discharge.pressure=9 bar"]
STATED = ["evaporating_temperature", "condensing_temperature", "superheat", "subcooling"]


def test_a_throttled_machine_presses_on_its_rotors_as_one_of_that_suction_pressure():
    # an ideal gas keeps its temperature in a throttle, so that both have the same chambers
    lines = [*(f"operation.{name}=null" for name in STATED), "operation.suction.temperature=20 degC", *THROTTLED]
    throttled = [*lines, "effects.suction_throttle.pressure_ratio=0.4"]
    found = []
    for overrides in (throttled, [*lines, "operation.suction.pressure=1.2 bar"]):
        scene, result = run_of(str(CONFIGS / "rotors" / "b.yaml"), overrides)
        assert result.status == "ok"
        found.append(loads_of(pressures_of(scene.machine, result))[1])
    one, other = found
    size = np.max(np.abs(other["male_thrust_bearing"]))
    for name, values in other.items():
        np.testing.assert_allclose(one[name], values, atol=1e-3 * size, err_msg=name)


def test_harmonics_are_those_of_a_sum_of_cosines():
    t = np.arange(64) * 2.0 * math.pi / 64
    mean, first, second, third, *rest = harmonics(5.0 + 3.0 * np.cos(t + 0.4) + 0.5 * np.cos(3 * t - 1.0), 50.0)
    assert (mean.amplitude, first.frequency, third.frequency) == (pytest.approx(5.0), 50.0, 150.0)
    assert (first.amplitude, first.phase) == (pytest.approx(3.0), pytest.approx(0.4))
    assert (third.amplitude, third.phase) == (pytest.approx(0.5), pytest.approx(-1.0))
    assert max([second.amplitude, *(each.amplitude for each in rest)]) < 1e-12


@pytest.fixture(scope="module")
def folder(run, tmp_path_factory):
    scene, result = run
    place = tmp_path_factory.mktemp("loads")
    exported.write_loads(scene, result, exported.loads(scene, result, (0.0, 0.0)), place, steps=6)
    return place


def test_flows_through_the_ports_have_the_mean_of_the_cycle(point):
    scene, result = run_of(point)
    angle, flows = flows_of(scene, result)
    assert angle[-1] < math.pi / 2 and len(angle) == len(flows["suction_mass_flow"])
    # traces are a degree apart: what flows back when the discharge port opens takes less
    for line, within in (("suction", 0.001), ("discharge", 0.03)):
        mean = float(flows[f"{line}_mass_flow"].mean())
        assert mean == pytest.approx(result.performance.gas_mass_flow, rel=within)
    density = flows["suction_mass_flow"].mean() / flows["suction_volume_flow"].mean()
    assert density == pytest.approx(1.23e5 / (8.314462618 / 0.10203 * 279.0), rel=1e-3)  # ideal gas, R134a


def test_an_expander_takes_in_where_it_would_discharge():
    """Both flows are along the machine, each at the density of its line (R134a of 20 bar, 100 °C and of 7 bar)."""
    scene, result = run_of(str(CONFIGS / "expander" / "point.yaml"))
    _, flows = flows_of(scene, result)
    p = result.performance
    for line, T in (("suction", 373.15), ("discharge", p.discharge_temperature)):
        mean = float(flows[f"{line}_mass_flow"].mean())
        assert mean == pytest.approx(p.gas_mass_flow, rel=0.01)
        density = PropsSI("D", "P", p[f"{line}_pressure"], "T", T, "R134a")
        assert mean / flows[f"{line}_volume_flow"].mean() == pytest.approx(density, rel=1e-6)


def test_a_slide_valve_s_flows_belong_to_the_lines_that_it_opens_to():
    scene, result = run_of(str(CONFIGS / "control" / "slide_valve.yaml"))
    _, flows = flows_of(scene, result)
    for line in ("suction", "discharge"):
        assert float(flows[f"{line}_mass_flow"].mean()) == pytest.approx(result.performance.gas_mass_flow, rel=0.03)


def test_a_cylinder_has_no_loads_of_ports():
    with pytest.raises(UsageError, match="loads are those of a twin_screw"):
        flows_of(*run_of(str(CONFIGS / "slider_crank" / "air.yaml")))


def test_chambers_pass_at_the_speed_that_a_motor_on_the_mains_reaches():
    scene, result = run_of(str(CONFIGS / "drive" / "induction.yaml"))
    rotors = result.performance.mean_speed
    assert rotors < 0.98 * scene.operation.speed  # the slip of the motor
    assert exported.loads(scene, result).frequency == pytest.approx(4 * rotors / (2.0 * math.pi))


def test_files_say_the_same(folder):
    document = json.loads((folder / "loads.json").read_text())
    assert document["lobe_frequency"] == pytest.approx(4 * 2950 / 60)
    rows = list(csv.DictReader((folder / "flows_spectrum.csv").read_text().splitlines()))
    spectrum = document["spectra"]["discharge_volume_flow"]
    assert float(rows[1]["frequency [Hz]"]) == pytest.approx(4 * 2950 / 60)
    assert float(rows[1]["discharge_volume_flow amplitude [m^3/s]"]) == pytest.approx(spectrum[1]["amplitude"])


def test_meshio_reads_the_surfaces(folder, pressures):
    meshio = pytest.importorskip("meshio")
    for name, surface in zip(("male", "female"), surfaces(pressures.laid.rotors, exported.PROFILE_PIECES), strict=True):
        with meshio.xdmf.TimeSeriesReader(folder / f"{name}_rotor.xdmf") as reader:
            points, cells = reader.read_points_cells()
            steps = [reader.read_data(i) for i in range(reader.num_steps)]
        assert len(steps) == 6 and cells[0].type == "quad"
        assert np.hypot(points[:, 0], points[:, 1]).max() == pytest.approx(np.hypot(surface.x, surface.y).max())
        values = np.array([data["pressure"][0] for _, _, data in steps])
        assert values.shape == (6, len(cells[0].data))
        assert 7e5 < values.max() < 12e5 and values.min() > -0.2e5  # lines: 3.1 and 11.6 bar
        turn = 2.0 * math.pi / abs(surface.turns) / (2950 * math.pi / 30)
        assert steps[3][0] == pytest.approx(turn / 2)


def test_a_file_of_a_run_is_as_good_as_its_scene(run, tmp_path):
    scene, result = run
    save(tmp_path / "x.h5", scene, result)
    _, again = run_of(str(tmp_path / "x.h5"))
    np.testing.assert_allclose(again.cycle["pressure"], result.cycle["pressure"])
    assert again.performance.gas_mass_flow == result.performance.gas_mass_flow
    with pytest.raises(UsageError, match="which --set and --without cannot change"):
        run_of(str(tmp_path / "x.h5"), ["operation.speed=1 rpm"])


@pytest.mark.parametrize(("text", "says"), [("3", "has no unit"), ("3 mm", "1 lengths"), ("-3 mm,4 mm", "outside")])
def test_bearings_need_two_lengths(text, says):
    with pytest.raises(UsageError, match=says):
        spans_of(text)
    assert spans_of("40 mm, 6 cm") == (0.04, 0.06) and spans_of(None) is None


def test_what_is_assumed_of_bearings_and_shafts_is_told():
    where, bare = "of the male and female rotor in the end planes", "no shafts, whose area the thrust then includes"
    assert assumed_of(Supports()) == (
        f"assumed: bearings {where}, and {bare} (state --bearings and --shafts, or effects.bearings)"
    )
    one = Supports(located=(True, False), sized=(True, True))
    assert "of the female rotor" in assumed_of(one) and "--shafts" not in assumed_of(one)
    assert not assumed_of(Supports(located=(True, True), sized=(True, True)))
