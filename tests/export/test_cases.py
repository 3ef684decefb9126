"""`export cases`: all cases of a results file as a table in SI, metric or US units."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI

from screwsim import cli
from screwsim.export.cases import CaseColumn, as_figure, case_columns, converted
from screwsim.figures import declared
from screwsim.fluid.constants import gas_constant
from screwsim.outputs import Figure
from screwsim.results import open_results
from screwsim.results.schema import Axis
from screwsim.scene import load
from screwsim.study.sweep import run_sweep

pytestmark = pytest.mark.around

POINT = Path(__file__).parents[2] / "configs" / "paper" / "point.yaml"
DUTIES = "{operation.speed: [1000 rpm, 3000 rpm, 2000 rpm], operation.discharge.pressure: [8 bar, 11.5 bar, 0.5 bar]}"
POINTS = [f"sweep={{zip: [{DUTIES}]}}"]


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """Return the file of three duty points, of which the last, below the suction pressure, fails."""
    path = tmp_path_factory.mktemp("cases") / "points.h5"
    run_sweep(load(str(POINT), overrides=POINTS), path, jobs=1)
    return path


def columns(path: Path, units: str) -> dict[str, CaseColumn]:
    return {f"{each.name} [{each.unit}]": each for each in case_columns(open_results(path), units)}


def test_a_row_stands_for_each_point_of_a_list_in_its_order(swept, tmp_path):
    out = tmp_path / "points.csv"
    assert cli.exit_code(["export", "cases", str(swept), "-o", str(out), "--units", "metric"]) == 0
    rows = list(csv.DictReader(out.read_text(encoding="utf-8").splitlines()))
    assert [row["operation.speed [rpm]"] for row in rows] == ["1000", "3000", "2000"]
    assert [row["status"] for row in rows] == ["ok", "ok", "failed"]
    assert rows[2]["shaft power [kW]"] == "" and rows[2]["message"]
    results = open_results(swept)
    assert float(rows[1]["shaft power [kW]"]) == pytest.approx(1e-3 * results.performance["shaft_power"][1], rel=1e-7)


def test_us_units_are_those_of_the_definitions(swept):
    """hp 745.69987 W, psi 6894.7573 Pa, lb 0.45359237 kg, cubic foot 0.028316847 m³ (NIST SP 811, appendix B)."""
    si, us = columns(swept, "si"), columns(swept, "us")
    for name, si_name, factor in (
        ("shaft power [hp]", "shaft_power [W]", 745.69987),
        ("peak pressure [psia]", "peak_pressure [Pa]", 6894.7573),
        ("gas mass flow [lb/h]", "gas_mass_flow [kg s-1]", 0.45359237 / 3600.0),
        ("displacement flow [cfm]", "displacement_flow [m3 s-1]", 0.028316847 / 60.0),
    ):
        assert us[name].values[:2] * factor == pytest.approx(si[si_name].values[:2], rel=1e-7)
    T, F = si["discharge_temperature [K]"].values[:2], us["discharge temperature [degF]"].values[:2]
    assert F == pytest.approx(1.8 * T - 459.67, rel=1e-12)


def test_volume_flows_are_of_the_delivered_mass(swept):
    """MMSCFD of an ideal gas at 60 degF, 14.696 psia; of the flow that is delivered."""
    si, us = columns(swept, "si"), columns(swept, "us")
    mass = si["gas_mass_flow [kg s-1]"].values[:2]
    R, T, p = gas_constant(load(str(POINT)).gas.name), 519.67 / 1.8, 14.696 * 6894.7573
    per_day = mass * R * T / p / 0.028316847 * 86400.0
    assert us["standard flow [MMSCFD]"].values[:2] == pytest.approx(1e-6 * per_day, rel=1e-6)


def test_the_flow_at_the_inlet_carries_the_delivered_mass_at_the_density_there(tmp_path):
    scene = load(str(POINT), overrides=["gas.model=real", "oil_supply.temperature=330 K"])
    run_sweep(scene, tmp_path / "real.h5", jobs=1)
    si, us = columns(tmp_path / "real.h5", "si"), columns(tmp_path / "real.h5", "us")
    line = scene.operation.suction
    density = PropsSI("D", "T", line.temperature, "P", line.pressure, scene.gas.name)
    drawn = us["inlet flow [acfm]"].values * 0.028316847 / 60.0
    assert drawn * density == pytest.approx(si["gas_mass_flow [kg s-1]"].values, rel=1e-6)


def test_swept_differences_have_no_zero_and_are_not_absolute(tmp_path):
    """A superheat of 5 K is 9 F more, and a pressure loss of 1 bar 14.5038 psi."""
    axes = "{operation.suction.superheat: [5 K, 20 K], effects.oil_pump.pressure_loss: [1 bar, 2 bar]}"
    path = tmp_path / "lines.h5"
    run_sweep(
        load(
            str(POINT),
            overrides=[
                "operation.suction.temperature=null",
                "operation.suction.superheat=5 K",
                f"sweep={{zip: [{axes}]}}",
            ],
        ),
        path,
        jobs=1,
    )
    si, metric, us = (columns(path, each) for each in ("si", "metric", "us"))
    assert si["operation.suction.superheat [K]"].values == pytest.approx([5.0, 20.0])
    assert metric["operation.suction.superheat [K]"].values == pytest.approx([5.0, 20.0])
    assert us["operation.suction.superheat [F diff]"].values == pytest.approx([9.0, 36.0])
    assert metric["effects.oil_pump.pressure_loss [bar]"].values == pytest.approx([1.0, 2.0])
    assert us["effects.oil_pump.pressure_loss [psi]"].values == pytest.approx([14.503774, 29.007548], rel=1e-7)


@pytest.mark.parametrize(
    "name", ["package_pressure_loss", "intake_pressure_loss", "oil_line_pressure_loss", "suction_pulsation_harmonic_1"]
)
def test_figures_that_are_differences_of_pressure_are_not_absolute(name):
    figure = declared(name)
    assert converted(figure, np.array([6894.7573]), "us") == ("psi", pytest.approx([1.0], rel=1e-7))
    assert converted(declared("discharge_pressure"), np.array([6894.7573]), "us")[0] == "psia"


@pytest.mark.parametrize("units", ["metric", "us"])
def test_a_quantity_has_one_unit_whatever_its_size(units):
    for unit in ("W", "J", "N", "m", "m2", "m3", "kg"):
        small, large = (converted(Figure("each", unit, ""), np.array([size]), units) for size in (1e-6, 1e6))
        assert small[0] == large[0] and large[1] == pytest.approx(1e12 * small[1])


@pytest.mark.parametrize(
    ("path", "unit", "size", "metric", "us"),
    [
        ("effects.blow_hole.area", "m^2", 6.4516e-4, ("cm2", 6.4516), ("in2", 1.0)),
        ("first.operation.superheat", "K", 5.0, ("K", 5.0), ("F diff", 9.0)),
        ("second.operation.discharge.temperature", "K", 310.927778, ("degC", 37.777778), ("degF", 100.0)),
        ("between.outlet_temperature", "K", 310.927778, ("degC", 37.777778), ("degF", 100.0)),
        ("effects.plenums.discharge_valve.pressure", "Pa", 6894.7573, ("bar", 0.068947573), ("psi", 1.0)),
        ("machine.displacement", "m^3/s", 0.028316847, ("m3/h", 101.94065), ("cfm", 60.0)),
    ],
)
def test_swept_inputs_have_the_units_of_their_kind(path, unit, size, metric, us):
    for units, (shown, number) in (("metric", metric), ("us", us)):
        found = converted(as_figure(Axis(path, np.array([size]), unit, ""), units), np.array([size]), units)
        assert found == (shown, pytest.approx([number], rel=1e-6))


def test_cooling_per_volume_is_in_btu_per_cubic_foot():
    """1 Btu = 1055.05585 J (NIST SP 811, International Table)."""
    figure = declared("volumetric_cooling_capacity")
    assert converted(figure, np.array([1055.05585 / 0.028316847]), "us") == ("Btu/ft3", pytest.approx([1.0], rel=1e-7))


def test_two_stages_draw_what_the_first_one_draws(tmp_path):
    (tmp_path / "low.yaml").write_text(json.dumps({"base": str(POINT)}))
    (tmp_path / "high.yaml").write_text(json.dumps({"base": str(POINT), "operation": {"speed": "400 rpm"}}))
    stages, path = tmp_path / "plant.stages.yaml", tmp_path / "plant.h5"
    sweep = {"first.operation.speed": ["1000 rpm", "1050 rpm"]}
    stages.write_text(json.dumps({"stages": ["low.yaml", "high.yaml"], "sweep": sweep}))
    assert cli.exit_code(["sweep", str(stages), "-o", str(path), "--jobs", "1"]) == 0
    first = open_results(path).stages["first"].performance
    drawn = first["volumetric_efficiency"] * first["displacement_flow"]
    found = columns(path, "metric")
    assert found["inlet flow [m3/h]"].values == pytest.approx(3600.0 * drawn)
    mass, gas = found["standard flow [Nm3/h]"].values / 3600.0, load(str(tmp_path / "low.yaml")).gas
    assert mass * 101325.0 / (gas_constant(gas.name) * 273.15) == pytest.approx(first["gas_mass_flow"])


@pytest.mark.parametrize(
    "heads", ["speed,pressure", "speed,status", "status,pressure [bar]", "speed,status,shaft power [kW]"]
)
def test_a_file_of_measured_points_is_not_overwritten(heads, swept, tmp_path, capsys):
    own = tmp_path / "mine.csv"
    own.write_text(f"{heads}\n1,2\n", encoding="utf-8")
    assert cli.exit_code(["export", "cases", str(swept), "-o", str(own)]) == 2
    assert "already exists" in capsys.readouterr().err and own.read_text(encoding="utf-8").startswith(heads)


def test_a_table_of_its_own_is_replaced(swept, tmp_path):
    out = tmp_path / "points.csv"
    for units in ("si", "metric", "us"):
        assert cli.exit_code(["export", "cases", str(swept), "-o", str(out), "--units", units]) == 0
    assert "discharge temperature [degF]" in out.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("units", "power", "temperature"),
    [
        ("si", ("shaft_power_uncertainty [W] (k=2)", 1.0), ("discharge_temperature_uncertainty [K] (k=2)", 1.0)),
        ("metric", ("shaft power uncertainty [kW] (k=2)", 1e3), ("discharge temperature uncertainty [K] (k=2)", 1.0)),
        (
            "us",
            ("shaft power uncertainty [hp] (k=2)", 745.69987),
            ("discharge temperature uncertainty [F diff] (k=2)", 1 / 1.8),
        ),
    ],
)
def test_uncertainties_by_the_inputs_stand_beside_their_figures(tmp_path, units, power, temperature):
    path, out = tmp_path / "points.h5", tmp_path / "points.csv"
    tolerant = ["oil_supply.ratio=3 ± 10 %", "sweep={operation.speed: [1000 rpm, 2000 rpm]}"]
    run_sweep(load(str(POINT), overrides=tolerant), path, jobs=1)
    assert cli.exit_code(["export", "cases", str(path), "-o", str(out), "--units", units]) == 0
    rows = list(csv.DictReader(out.read_text(encoding="utf-8").splitlines()))
    stored = open_results(path).uncertainty
    for (head, factor), name in ((power, "shaft_power"), (temperature, "discharge_temperature")):
        assert [factor * float(row[head]) for row in rows] == pytest.approx(2.0 * stored[name], rel=1e-6)
    assert not any("displacement" in head and "uncertainty" in head for head in rows[0])  # it has none
    assert cli.exit_code(["export", "cases", str(path), "-o", str(out), "--units", units]) == 0  # its own file
