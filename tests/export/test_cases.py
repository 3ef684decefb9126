"""`export cases`: all cases of a results file as a table in SI, metric or US units."""

import csv
from pathlib import Path

import pytest

from screwsim import cli
from screwsim.export.cases import CaseColumn, case_columns
from screwsim.fluid.constants import gas_constant
from screwsim.results import open_results
from screwsim.scene import load
from screwsim.study.sweep import run_sweep

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
    """MMSCFD of an ideal gas at 60 degF, 14.696 psia; inlet flow: displacement times volumetric efficiency."""
    si, us = columns(swept, "si"), columns(swept, "us")
    mass = si["gas_mass_flow [kg s-1]"].values[:2]
    R, T, p = gas_constant(load(str(POINT)).gas.name), 519.67 / 1.8, 14.696 * 6894.7573
    per_day = mass * R * T / p / 0.028316847 * 86400.0
    assert us["standard flow [MMSCFD]"].values[:2] == pytest.approx(1e-6 * per_day, rel=1e-6)
    drawn = si["volumetric_efficiency []"].values[:2] * us["displacement flow [cfm]"].values[:2]
    assert us["inlet flow [acfm]"].values[:2] == pytest.approx(drawn, rel=1e-12)


def test_a_file_of_measured_points_is_not_overwritten(swept, tmp_path, capsys):
    own = tmp_path / "mine.csv"
    own.write_text("speed,pressure\n1,2\n", encoding="utf-8")
    assert cli.exit_code(["export", "cases", str(swept), "-o", str(own)]) == 2
    assert "already exists" in capsys.readouterr().err and own.read_text(encoding="utf-8").startswith("speed")
