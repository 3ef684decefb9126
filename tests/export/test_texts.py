"""Texts for other tools say what the map says: read back and evaluated, they give its figures."""

import csv
import io
import json
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from screwsim.export import energyplus, modelica
from screwsim.export.en12900 import (
    BTU,
    ECONOMIZER,
    FIGURES,
    HEAD_LINE,
    NOTES,
    OPTIONAL_FIGURES,
    POUND,
    en12900_csv,
    en12900_document,
    other_condensing,
)
from screwsim.export.polynomials import polynomials, rated_temperatures, swept_results
from screwsim.export.table import csv_table, table_of
from screwsim.export.tespy import tespy_document
from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError
from screwsim.results import open_results
from screwsim.results.protection import protect_other_document
from screwsim.scene import loads
from screwsim.scene.operation import QUALITY, SUPERHEAT
from screwsim.study.maps.performance_map import COEFFICIENT_NAMES, polynomial
from screwsim.study.sweep import run_sweep

pytestmark = pytest.mark.around
S, D = 2.0, 44.0  # [°C] inside


@pytest.fixture(scope="module")
def found(swept_map):
    return polynomials(swept_map, FIGURES)


def objects(text: str) -> dict[str, dict[str, list[str]]]:
    """Return the objects of an IDF text: {class: {name: values}}."""
    bare = "\n".join(line.partition("!")[0] for line in text.splitlines())
    kinds: dict[str, dict[str, list[str]]] = {}
    for kind, name, *values in ([part.strip() for part in one.split(",")] for one in bare.split(";") if one.strip()):
        kinds.setdefault(kind, {})[name] = values
    return kinds


def bicubic(c, x, y):
    """Return what EnergyPlus makes of the coefficients of a Curve:Bicubic."""
    terms = (1, x, x**2, y, y**2, x * y, x**3, y**3, x**2 * y, x * y**2)
    return sum(float(a) * b for a, b in zip(c, terms, strict=False))


@pytest.mark.parametrize(("word", "figure"), [("power", "shaft_power"), ("capacity", "cooling_capacity")])
def test_curves_of_energyplus_give_the_figures(found, word, figure):
    made = energyplus.energyplus_objects(found, "screw")
    read = objects(energyplus.idf(made, energyplus.notes(found)))
    curve = read["Curve:Bicubic"][f"screw {word}"]
    wanted = float(found.maps[0].evaluate(figure, S, D))
    assert bicubic(curve[:10], S, D) == pytest.approx(wanted, rel=1e-8)
    assert [float(v) for v in curve[10:14]] == [-10.0, 5.0, 35.0, 50.0]
    document = energyplus.epjson(made)["Curve:Bicubic"][f"screw {word}"]
    assert [document[key] for key in list(document)[:10]] == pytest.approx([float(c) for c in curve[:10]])
    compressor = read["Refrigeration:Compressor"]["screw"]
    assert compressor == ["screw power", "screw capacity", "10", "", "", "0"]


def test_normalised_curves_are_one_at_the_rated_point(found):
    one = found.maps[0]
    at = rated_temperatures(one)
    curves = energyplus.energyplus_objects(found, "screw")["Curve:Biquadratic"]
    cap, eir = (list(curves[f"screw {word}"].values())[:6] for word in ("CAPFT", "EIRFT"))
    assert bicubic([*cap, 0, 0, 0, 0], *at) == pytest.approx(1.0, abs=0.01)  # quadratics over 15 K each way
    assert bicubic([*eir, 0, 0, 0, 0], *at) == pytest.approx(1.0, abs=0.01)
    ratio = one.evaluate("shaft_power", S, D) / one.evaluate("cooling_capacity", S, D)
    over = one.evaluate("shaft_power", *at) / one.evaluate("cooling_capacity", *at)
    assert bicubic([*eir, 0, 0, 0, 0], S, D) == pytest.approx(float(ratio / over), abs=0.02)


@pytest.mark.parametrize("economized", [False, True])
def test_the_file_for_energyplus_says_that_an_economizer_cools_the_liquid_further(found, economized):
    told = " ".join(energyplus.notes(replace(found, economized=economized)))
    assert ("rated_subcooling is that behind the condenser" in told) == economized
    text = energyplus.idf(energyplus.energyplus_objects(found, "x"), energyplus.notes(replace(found, economized=True)))
    assert objects(text).keys() == {"Version", *energyplus.CLASSES}


@pytest.mark.parametrize("economized", [False, True])
def test_coefficients_say_that_an_economizer_adds_to_the_capacity(found, economized):
    of_machine = replace(found, economized=economized)
    assert (f"# {ECONOMIZER}" in en12900_csv(of_machine).splitlines()) == economized
    assert (en12900_document(of_machine).get("capacity_contains") == ECONOMIZER) == economized


@pytest.mark.parametrize(("more", "economized"), [([], False), (["economizer_mass_flow"], True)])
def test_a_map_is_known_to_be_that_of_a_machine_with_an_economizer(swept_map, more, economized, monkeypatch):
    figures = [*swept_map.figures, *more]
    monkeypatch.setattr(type(swept_map), "figures", property(lambda results: figures))
    assert polynomials(swept_map, FIGURES).economized == economized


def test_what_normalised_curves_are_off_by_is_told(found):
    one = found.maps[0]
    at = rated_temperatures(one)
    S, D = (x.ravel() for x in np.meshgrid(np.linspace(-10.0, 5.0, 11), np.linspace(35.0, 50.0, 11)))
    of = {name: np.asarray(one.evaluate(name, S, D)) for name in ("cooling_capacity", "shaft_power")}
    over = {name: float(one.evaluate(name, *at)) for name in of}
    true = {
        "CAPFT": of["cooling_capacity"] / over["cooling_capacity"],
        "EIRFT": of["shaft_power"] / of["cooling_capacity"] * over["cooling_capacity"] / over["shaft_power"],
    }
    said = energyplus.notes(found)[-1]
    for word, (coefficients, error) in energyplus.normalised(one, at).items():
        off = np.abs(bicubic([*coefficients, 0, 0, 0, 0], S, D) / true[word] - 1.0)
        assert error == pytest.approx(off.max(), rel=1e-6) and f"{100 * error:.2g} %" in said
    assert max(fit.largest for fit in one.fits.values()) < error  # a quadratic is no cubic


def test_a_map_has_the_superheat_that_its_own_axis_gives_it(found):
    maps = tuple(replace(found.maps[0], values={SUPERHEAT: value}) for value in (5.0, 15.0))
    swept = replace(found, maps=maps, conditions={}, axes={SUPERHEAT: "K"})
    compressors = energyplus.energyplus_objects(swept, "screw")["Refrigeration:Compressor"]
    assert [each["rated_superheat"] for each in compressors.values()] == [5.0, 15.0]
    assert [swept.superheat(one) for one in maps] == [5.0, 15.0]
    within = replace(swept, maps=found.maps, follows=({"path": SUPERHEAT},))
    with pytest.raises(UsageError, match=r"\.superheat varies together with a temp.*own, or use export en12900\)"):
        energyplus.energyplus_objects(within, "screw")
    with pytest.raises(UsageError, match=r"is for wet gas.*\(use export en12900\)"):
        energyplus.energyplus_objects(replace(found, conditions={QUALITY: 0.95}), "screw")


def test_a_title_of_many_lines_stays_in_its_comment(swept_map):
    titled = replace(swept_map, attributes={**swept_map.attributes, "title": "one, two\nCurve:Bicubic;\n"})
    assert csv_table(table_of(titled)).splitlines()[1].startswith("evaporating_temperature [K]")
    for text in (en12900_csv(polynomials(titled, FIGURES)), "\n".join(energyplus.notes(polynomials(titled, FIGURES)))):
        assert all(line[:1] in "#!" or "," in line for line in text.splitlines()[:3])
        assert "one, two Curve:Bicubic;" in text.splitlines()[0]


@pytest.mark.parametrize(("ip", "unit", "at"), [(False, "degC", lambda T: T), (True, "degF", lambda T: 1.8 * T + 32.0)])
def test_coefficients_state_where_they_are_valid(swept_map, ip, unit, at):
    found = polynomials(swept_map, FIGURES)
    (one,) = found.maps
    corners = ", ".join(f"({at(S):.6g}, {at(D):.6g})" for S, D in one.envelope)
    line = f"# {found.titled(one, 'the map')}: valid between the corners (S, D) {corners} {unit}"
    assert len(one.envelope) >= 3 and line in en12900_csv(found, ip).splitlines()


def test_conditions_of_coefficients_have_units_and_name_the_subcooling(swept_map):
    found = polynomials(swept_map, FIGURES)
    stated = {"operation.superheat": 10.0, "oil_supply.temperature": 313.15, "oil_supply.ratio": 1.5}
    of_scene = replace(found, conditions=stated)
    lines = en12900_csv(of_scene).splitlines()
    for line in (
        "# operation.superheat = 10 K",
        "# oil_supply.temperature = 40 degC",
        "# oil_supply.ratio = 1.5 kg/kg",
        "# operation.subcooling = 0 K, as the scene states none",
    ):
        assert line in lines
    lines = en12900_csv(replace(found, conditions={**stated, "operation.subcooling": 5.0}), ip=True).splitlines()
    assert {"# operation.superheat = 18 degF", "# oil_supply.temperature = 104 degF"} <= set(lines)
    assert "# operation.subcooling = 9 degF" in lines
    swept = en12900_csv(replace(found, conditions=stated, axes={"operation.subcooling": "K"}))
    assert "operation.subcooling =" not in swept


def test_the_power_is_that_of_the_motor_where_there_is_one():
    assert energyplus.power_of(["shaft_power", "electrical_power"]) == "electrical_power"
    assert energyplus.power_of(["shaft_power"]) == "shaft_power"


def rows_of(text: str) -> list[dict[str, str]]:
    found, heads = [], []
    for cells in csv.reader(io.StringIO("\n".join(line for line in text.splitlines() if not line.startswith("#")))):
        if cells and cells[0] == "table":
            heads = cells
        elif cells:
            found.append(dict(zip(heads, cells, strict=True)))
    return found


@pytest.mark.parametrize(("ip", "factors"), [(False, (1.0, 1.0, 1.0)), (True, (3600.0 / BTU, 1.0, 3600.0 / POUND))])
def test_coefficients_and_rating_are_those_of_the_map(found, ip, factors):
    rows = rows_of(en12900_csv(found, ip))
    at = [1.8 * T + 32.0 if ip else T for T in (S, D)]
    document = en12900_document(found, ip)["maps"][0]["figures"]
    for figure, factor in zip(FIGURES, factors, strict=True):
        wanted = factor * float(found.maps[0].evaluate(figure, S, D))
        (row,) = (row for row in rows if row["table"] == "coefficients" and row["figure"] == figure)
        assert polynomial([float(row[name]) for name in COEFFICIENT_NAMES], *map(np.array, at)) == pytest.approx(
            wanted, rel=1e-8
        )
        assert list(document[figure]["coefficients"].values()) == pytest.approx(
            [float(row[name]) for name in COEFFICIENT_NAMES]
        )
    degree = "degF" if ip else "degC"
    rating = [row for row in rows if row["table"] == "rating"]
    assert len(rating) == 36
    first = rating[0]
    unit, factor = ("Btu/h", 3600.0 / BTU) if ip else ("W", 1.0)
    assert float(first[f"evaporating_{degree}"]) == pytest.approx(14.0 if ip else -10.0)
    wanted = factor * float(found.maps[0].evaluate("cooling_capacity", -10.0, 35.0))
    assert float(first[f"cooling_capacity [{unit}]"]) == pytest.approx(wanted, rel=1e-5)


def test_heating_has_coefficients_beside_those_of_the_standard(swept_map):
    """Heat of the condenser: both capacities differ by what the shaft brings, less what the oil keeps."""
    assert "heating_capacity" in OPTIONAL_FIGURES and "heating_capacity" in swept_map.figures
    both = polynomials(swept_map, ("cooling_capacity", "heating_capacity"))
    rows = rows_of(en12900_csv(both, ip=True))
    capacity = {row["figure"]: row for row in rows if row["table"] == "coefficients"}
    assert capacity["heating_capacity"]["unit"] == "Btu/h"
    S_F, D_F = (np.array(1.8 * T + 32.0) for T in (S, D))
    one = polynomial([float(capacity["heating_capacity"][name]) for name in COEFFICIENT_NAMES], S_F, D_F)
    assert one == pytest.approx(3600.0 / BTU * float(both.maps[0].evaluate("heating_capacity", S, D)), rel=1e-8)
    assert one > float(polynomial([float(capacity["cooling_capacity"][name]) for name in COEFFICIENT_NAMES], S_F, D_F))


def test_modelica_has_the_nodes_and_the_polynomials(swept_map):
    table = table_of(swept_map)
    text = modelica.package(table, "Screw")
    assert "error unknown, as no axis has five values" in text and "nan" not in text
    assert text.count("(") == text.count(")") and text.count("[") == text.count("]")
    opened = re.findall(r"^ *(?:package|model|function) (\w+)", text, re.M)
    assert sorted(opened) == sorted(re.findall(r"^ *end (\w+);", text, re.M))
    block = re.search(r"CombiTable2Ds shaft_power_table\(.*?table=\[(.*?)\]\);", text, re.S)
    rows = [[float(cell) for cell in row.split(",")] for row in block[1].split(";")]
    power = [each.name for each in table.outputs].index("shaft_power")
    for row in rows[1:]:
        for T_c, value in zip(rows[0][1:], row[1:], strict=True):
            assert value == pytest.approx(table([[row[0], T_c]])[0][0][power], rel=1e-9)
    function = re.search(r"function shaft_power .*?Real u = (.*?);.*?Real v = (.*?);.*?y := (.*?);", text, re.S)
    names = {"evaporating_temperature": S + 273.15, "condensing_temperature": D + 273.15}
    names |= {"u": eval(function[1], {}, names), "v": eval(function[2], {}, names)}
    own = eval(function[3].replace("^", "**").replace("\n", " "), {}, names)
    error = modelica.cubic(table, power)[2]
    assert own == pytest.approx(table([[S + 273.15, D + 273.15]])[0][0][power], rel=error) and error < 0.01


def test_modelicas_own_interpolation_is_in_the_error_of_its_tables(table):
    """Akima's slopes at five nodes are another law than a spline's: what lies between both is told on top."""
    more = modelica.akima_differences(table)
    assert np.all(more > 0.0) and np.all(more < 0.01)
    said = float(re.search(r"error ([0-9.e-]+), of the map \(", modelica.package(table, "Screw"))[1])
    assert said == pytest.approx(max(np.array(table.errors) + more), rel=0.05) and said > table.error


def test_modelica_takes_two_inputs(table):
    assert modelica.identifier("2-stage") == "Map_2_stage" and modelica.identifier("screw") == "Screw"
    assert modelica.identifier("modelica") == "Map_modelica"  # the library's own name
    assert modelica.identifier("Real") == "Map_Real"  # a type that is there from the start
    with pytest.raises(UsageError, match=r"has 1 input \(speed\), and"):
        modelica.package(replace(table, inputs=table.inputs[:1]), "Screw")


def test_a_table_has_a_row_a_node(swept_map):
    text = csv_table(table_of(swept_map))
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    assert len(rows) == 16 and {row["closed"] for row in rows} == {"1"}
    assert text.startswith("# R134a, compressor map; SI units; error between the nodes unknown, as no axis has five")
    power = swept_map.performance["shaft_power"]
    assert [float(row["shaft_power [W]"]) for row in rows] == pytest.approx(power.ravel().tolist())


def test_a_table_tells_how_far_linear_interpolation_is_from_its_cubic(table):
    """Of the largest it must be at least what it is at the middle of any cell, by the mean of the four corners."""
    said = float(re.search(r"differs from the cubic by up to ([0-9.e-]+)", csv_table(table))[1])
    x, y = table.nodes
    values = table.grid.data[0, 0]
    means = 0.25 * (values[1:, 1:] + values[:-1, 1:] + values[1:, :-1] + values[:-1, :-1])
    middle = np.array([(0.5 * (a + b), 0.5 * (c + d)) for a, b in pairwise(x) for c, d in pairwise(y)])
    off = np.abs(table(middle)[0] / means.reshape(len(middle), -1) - 1.0)
    flow = [each.name for each in table.outputs].index("gas_mass_flow")
    assert said > 0.95 * off[:, flow].max() > 0.0 and said < 0.05


def test_a_document_says_that_its_conditions_are_in_si(found):
    """In inch-pound units too: its superheat of 10 is 10 K."""
    for ip in (False, True):
        said = en12900_document(found, ip)
        assert said["in_si"] == ["conditions", "follows", "at"]
        assert said["conditions"]["operation.superheat"] == 10.0


def test_the_condensing_temperature_is_called_by_the_point_that_it_is_of(found, swept_blend, swept_map):
    # M42: of a pure fluid the bubble point; M316: of a blend the dew point, R454B's 1.4 K above it at 45 degC
    blend = polynomials(swept_blend, ("cooling_capacity", "shaft_power", "gas_mass_flow"))
    T_c = max(swept_blend.along("operation.condensing_temperature").ravel())
    p_d = max(swept_blend.performance["discharge_pressure"].ravel())
    assert p_d == pytest.approx(constants.dew_pressure("R454B", T_c), rel=1e-9)
    assert p_d < 0.98 * constants.bubble_pressure("R454B", T_c)
    for each, point, other in ((found, "bubble", "dew"), (blend, "dew", "bubble")):
        assert f"condensing ({point}) temperature" in en12900_csv(each)
        assert f"({point} point)" in en12900_document(each)["D"] and f"({other} " not in en12900_document(each)["D"]
        assert f"saturated discharge temperature ({point})" in energyplus.notes(each)[1]


def test_tespys_bubble_points_are_not_given_a_blends_dew_points(swept_blend):
    with pytest.raises(UsageError, match=r"blend R454B, whose condensing temperature is that of its dew point"):
        tespy_document(swept_blend)


def test_polynomials_of_fluids_side_by_side_are_refused_in_a_line(swept_blend, tmp_path):
    scene = swept_blend.scene_yaml
    fluids = {"sweep.gas.fluid": ["R454B", "R134a"]}
    run_sweep(loads(scene, "blend.yaml").with_(fluids), tmp_path / "fluids.h5", jobs=1)
    with pytest.raises(UsageError, match=r"fluids.h5: gas.fluid has values that are no numbers \(export a"):
        polynomials(open_results(tmp_path / "fluids.h5"), ("shaft_power",))


@pytest.mark.parametrize(
    ("file", "told"),
    [
        ("r134a/point.yaml", r"is swept over no operation\.evaporating_temperature and no"),
        ("paper/point.yaml", r"states no operation\.evaporating_temperature, over which these polynomials are"),
    ],
)
def test_polynomials_need_both_temperatures(file, told):
    source = str(Path(__file__).parents[2] / "configs" / file)
    with pytest.raises(UsageError, match=told), swept_results(source, ["operation.speed=1000 rpm..2000 rpm"]):
        pass


@pytest.mark.parametrize(("fluid", "told"), [("R407C", "4.8 K above the bubble point that D is here"), ("R134a", "")])
def test_a_fluid_with_glide_says_that_the_standards_mean_its_dew_point(found, fluid, told):
    """R407C at 42.5 °C of its bubble point: dew point by CoolProp."""
    other = other_condensing(replace(found, fluid=fluid))
    assert told in other and bool(other) == bool(told)
    assert not told or "write gas.fluid: R407C.mix" in other
    assert (f"# {other}" in en12900_csv(replace(found, fluid=fluid)).splitlines()) == bool(told)
    assert not other_condensing(replace(found, fluid=fluid, condensing="dew"))


def test_an_own_document_with_notes_or_without_is_replaced(found, tmp_path):
    """That of R407C has a note of the convention; that of an earlier version has none of units."""
    file, document = tmp_path / "x.json", en12900_document(found)
    keys = [key for key in document if key not in NOTES]
    for notes in ((), ("in_si",), NOTES):
        file.write_text(json.dumps(dict.fromkeys([*keys, *notes])), encoding="utf-8")
        protect_other_document(file, HEAD_LINE, *keys, notes=NOTES)
    file.write_text(json.dumps(dict.fromkeys([*keys, "tespy"])), encoding="utf-8")
    with pytest.raises(UsageError, match="is not a file of this kind"):
        protect_other_document(file, HEAD_LINE, *keys, notes=NOTES)
