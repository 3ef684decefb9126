"""The points of a data sheet as a table: a row a point, in customary units, with what is beyond a limit or failed."""

import csv

import pytest

from screwsim.inputs.faults import UsageError
from screwsim.report.datasheet import check_sheet, write_sheet
from screwsim.study.datasheet.sheet import Sheet

GOOD = {"status": "ok", "message": "", "warnings": ["warm", "dry"], "beyond": ["shaft_power"]}
BAD = {"status": "failed", "message": "the pressure left the range", "warnings": [], "beyond": []}
POINTS = [
    {"evaporating_temperature": 263.15, **GOOD, "shaft_power": 51234.5, "volumetric_efficiency": 0.9, "cop": 3.25},
    {"evaporating_temperature": 258.15, **BAD},
]
HEADS = "evaporating_temperature [degC],beyond_limits,shaft_power [kW],volumetric_efficiency [%],cop,status,warnings"


def sheet(points):
    return Sheet("", "", [], [], None, [], document={"points": points})


def test_a_point_is_a_row_in_customary_units(tmp_path):
    write_sheet(sheet(POINTS), tmp_path / "s.csv")
    head, first, second = (tmp_path / "s.csv").read_text(encoding="utf-8").splitlines()
    assert head == HEADS
    assert next(csv.reader([first])) == ["-10", "shaft_power", "51.2345", "90", "3.25", "ok", "warm; dry"]
    assert next(csv.reader([second])) == ["-15", "", "", "", "", "failed: the pressure left the range", ""]


def test_speeds_are_in_revolutions_and_volumes_in_plain_letters(tmp_path):
    point = {"speed": 314.1592653589793, **BAD, "free_air_delivered": 0.25}
    write_sheet(sheet([point]), tmp_path / "s.csv")
    head, row = (tmp_path / "s.csv").read_text(encoding="utf-8").splitlines()
    assert head.startswith("speed [rpm],") and "free_air_delivered [m^3/min]" in head
    assert row.startswith("3000,") and ",15," in row


def test_pressures_of_a_gas_cooler_are_in_bar(tmp_path):
    """An axis that is an input of the scene and no figure."""
    write_sheet(sheet([{"gas_cooler_pressure": 9e6, **BAD}]), tmp_path / "s.csv")
    head, row = (tmp_path / "s.csv").read_text(encoding="utf-8").splitlines()
    assert head.startswith("gas_cooler_pressure [bar],") and row.startswith("90,")


def test_such_a_table_alone_is_replaced(tmp_path):
    ours, other = tmp_path / "s.csv", tmp_path / "measured.csv"
    write_sheet(sheet(POINTS), ours)
    check_sheet(ours)
    other.write_text("name,shaft_power [kW]\n1,50\n", encoding="utf-8")
    with pytest.raises(UsageError, match="is not a file of this kind"):
        check_sheet(other)
    check_sheet(tmp_path / "new.csv")
