"""Data sheets in US units: each cell is the figure of the document in its unit, and the document is the same."""

import re
from dataclasses import replace

import pytest
from folders import CONFIGS

import screwsim
from screwsim.cli import exit_code
from screwsim.figures import known
from screwsim.study.datasheet import (
    SheetOptions,
    air_rating,
    air_sheet,
    gas_sheet,
    rated,
    refrigeration_sheet,
    sheet_of,
)
from screwsim.study.datasheet.air_year import Demand
from screwsim.study.datasheet.bounds import limit_text, limits_of
from screwsim.study.datasheet.units import METRIC, US
from screwsim.study.stages import read_stages
from screwsim.template import new_scene, request_of

pytestmark = pytest.mark.around
HP, PSI, CFM = 745.6998715822702, 6894.757293168, 0.3048**3 / 60.0  # W, Pa, m³/s: 550 ft lbf/s, lbf/in², ft³/min
TON, LB_H = 3516.8528420667, 0.45359237 / 3600.0  # W: 12000 Btu/h of the International Table; kg/s
METRIC_UNIT = re.compile(r"\b(m?bar|kW|kg/h|K)\b|°C|m³|L/min")


def fahrenheit(T):
    return 32.0 + 1.8 * (T - 273.15)


def near(cell, value, step):
    """Tell whether a cell, of numbers in steps of `step`, shows a value."""
    return abs(float(cell.rstrip("*†‡\u00a0")) - value) <= 0.51 * step


def table(sheet, title):
    (found,) = (each for each in sheet.tables if each.title == title)
    return found


def test_a_package_has_acfm_of_free_air_at_inlet_conditions_kw_of_input_and_psi_over_the_inlet():
    scene = screwsim.load(CONFIGS / "air" / "fixed_speed_7.yaml")
    of = air_rating.rating(scene)
    metric, us = (air_sheet.air_sheet(scene, replace(of, units=units), [Demand(0.1, 100.0)]) for units in (METRIC, US))
    assert us.document == metric.document
    found, cells = of.full.result.performance, dict(zip(us.tables[0].heads, us.tables[0].rows[0], strict=True))
    power, flow = found.package_input_power, found.free_air_delivered / CFM
    assert near(cells["acfm"], flow, 0.1)
    assert near(cells["kW"], 1e-3 * power, 0.1) and near(cells["kW/ 100 acfm"], 1e-3 * power / flow * 100.0, 0.1)
    assert dict(us.lines)["zero flow"] == dict(metric.lines)["zero flow"]  # as electricity is bought
    assert not any("hp" in head for head in us.tables[0].heads)
    lines = dict(us.lines)
    assert lines["inlet"].startswith("14.5 psia, 68.0 °F")
    assert lines["discharge"] == f"{8.5e5 / PSI:.4g} psia, {7.5e5 / PSI:.1f} psi over the inlet"
    assert lines["outlet"] == "air at 86.0 °F"
    year, row = us.tables[1], us.tables[1].rows[0]
    assert year.heads[0] == "acfm" and near(row[0], 0.1 / CFM, 0.1)
    assert year.heads[-1] == "kWh/ 1000 ft³"
    assert float(row[-1]) == pytest.approx(float(metric.tables[1].rows[0][-1]) * 1e3 * 0.3048**3, rel=2e-3)
    words = " ".join([*lines.values(), *us.tables[0].heads])
    assert not any(unit in words for unit in ("bar", "°C", "m³", "kW at"))


def test_a_refrigeration_machine_has_tons_hp_and_fahrenheit_at_every_point_and_limit():
    scene = screwsim.load(CONFIGS / "control" / "point.yaml")
    bounds = limits_of(scene, ["discharge_temperature<63.2 degC"])
    asked = refrigeration_sheet.rating_request(scene, "0 degC..5 degC", "40 degC..45 degC", bounds)
    of = rated.rating(replace(asked, controls=asked.controls[:1]), jobs=1)
    metric, us = (
        refrigeration_sheet.refrigeration_sheet(replace(of, asked=replace(of.asked, units=units)), heating=True)
        for units in (METRIC, US)
    )
    assert us.document == metric.document
    for title, value, step in (
        ("Cooling capacity [tons]", lambda one: one.cooling_capacity / TON, 0.1),
        ("Electrical power [hp]", lambda one: one.electrical_power / HP, 0.1),
        ("Mass flow [lb/h]", lambda one: one.gas_mass_flow / LB_H, 1.0),
        (
            "Discharge temperature, gas and oil mixed [°F]",
            lambda one: fahrenheit(one.mixture_discharge_temperature),
            0.1,
        ),
    ):
        cells = table(us, title)
        assert list(cells.heads) == ["condensing", "32\u00a0°F", "41\u00a0°F"]
        assert [row[0] for row in cells.rows] == ["104 °F", "113 °F"]
        for (i, j), one in of.points.items():
            assert near(cells.rows[j][1 + i], value(one.performance), step), (title, i, j)
    envelope = table(us, "Envelope: condensing temperature within all limits")
    assert any("°F" in cell for row in envelope.rows for cell in row[3:])
    words = " ".join([text for _, text in us.lines] + [each.title for each in (*us.tables, *us.drawings)])
    assert not any(unit in words for unit in ("bar", "°C", "kW", "kg/h", "m³"))
    assert "discharge temperature < 145.8 °F" in dict(us.lines)["limits"]


def test_a_gas_compressor_has_psia_and_scfm_at_60_fahrenheit():
    scene = screwsim.loads(new_scene("booster", request_of()))
    asked = gas_sheet.rating_request(scene, {"--suction": "4.8 bar..5.2 bar", "--discharge": "19 bar..21 bar"}, {})
    of = rated.rating(replace(asked, controls=()), jobs=1)
    metric, us = (gas_sheet.gas_sheet(replace(of, asked=replace(of.asked, units=units))) for units in (METRIC, US))
    assert us.document == metric.document
    normal, standard = table(metric, "Flow [Nm³/h]"), table(us, "Flow [scfm]")
    # of an ideal gas at 60 °F and 14.696 psia, instead of 0 °C and 1.01325 bar
    ratio = (273.15 + 28.0 / 1.8) / 273.15 * 101325.0 / (14.696 * PSI) / 3600.0 / CFM
    for theirs, ours in zip(normal.rows, standard.rows, strict=True):
        for a, b in zip(theirs[1:], ours[1:], strict=True):
            assert float(b) == pytest.approx(ratio * float(a), abs=1.0)
    assert standard.rows[0][0] == f"{19e5 / PSI:.4g} psia"
    assert "scfm: as an ideal gas at 60 °F and 14.696 psia" in us.notes


@pytest.mark.parametrize(("file", "some"), [("air", "acfm"), ("plant", "tons")])
def test_two_stages_are_in_us_units_throughout(file, some):
    chain = replace(read_stages(CONFIGS / "two_stage" / f"{file}.stages.yaml"), sweep={}, joints=())
    ranges = {} if file == "air" else {"--evaporating": "-31 degC..-29 degC", "--condensing": "39 degC..41 degC"}
    us = sheet_of(chain, SheetOptions(ranges, units="us", jobs=2))
    words = [text for _, text in us.lines] + [each.title for each in (*us.tables, *us.drawings)]
    words += [cell for each in us.tables for row in (each.heads, *each.rows) for cell in row]
    assert any(some in text for text in words)
    # of power, CAGI's sheets have kW/100 acfm, too
    assert not [text for text in words if METRIC_UNIT.search(text) and "acfm" not in text and text != "kW"]
    each = next(one for one in us.tables if one.title.startswith("Each stage"))
    rows, (first, second) = {row[0]: row[1:] for row in each.rows}, own_stages(us)
    for figure, row, factor, step in (
        ("shaft_power", "shaft power [hp]", 1.0 / HP, 0.01),
        ("suction_pressure", "suction pressure [psia]", 1.0 / PSI, 0.01),
        ("displacement_flow", "swept volume [cfm]", 1.0 / CFM, 0.1),
        ("oil_flow_volume", "oil [gpm]", 60.0 / (231.0 * 0.0254**3), 0.01),
        ("gas_mass_flow", "mass flow [lb/h]", 1.0 / LB_H, 1.0),
    ):
        assert near(rows[row][0], factor * first[figure], step) and near(rows[row][1], factor * second[figure], step)
    assert near(rows["discharge of the gas alone [°F]"][1], fahrenheit(second["discharge_temperature"]), 0.1)


def test_a_limit_of_any_dimension_is_in_us_units():
    of_rotors = (
        ("shaft_torque", 100.0, "73.76 lbf ft"),
        ("displacement", 1e-3, "61.02 in³"),
        ("tip_gap", 25.4e-6, "0.001 in"),
    )
    of_gas = ("trapped_mass", 1e-3, "0.002205 lb"), ("work_per_cycle", 1000.0, "737.6 ft lbf")
    of_cycles = ("volumetric_cooling_capacity", 1e6, "26.84 Btu/ft³"), ("discharge_superheat", 15.0, "27 °F")
    for figure, value, text in (*of_rotors, *of_gas, *of_cycles):
        assert limit_text(figure, value, US) == text
    metric = {about.units for about in known().values()} - {"1", "K", "kelvin"} - set(US.other)
    assert metric == {"s", "rad", "rad s-1", "Hz", "Pa s"}  # which are the same in the United States


def own_stages(sheet):
    """Return the document of both stages at the own point."""
    stages = sheet.document["stages"]
    return stages[0] if isinstance(stages[0], list) else stages


def test_other_units_are_refused_in_one_line(capsys):
    assert exit_code(["datasheet", str(CONFIGS / "air" / "fixed_speed_7.yaml"), "--units", "imperial"]) == 2
    out, err = capsys.readouterr()
    assert out == "" and "'imperial'" in err
