"""Faults of a fit and of its data: each one line with file, line, column, path and remedy."""

import re
from pathlib import Path

import pytest
from fit_fakes import FIT, POINTS, SCENE, write_fit
from ruamel.yaml import YAML

import screwsim
from screwsim.inputs.faults import SceneError
from screwsim.outputs import PERFORMANCE
from screwsim.study.asked.figure_units import UNITS
from screwsim.study.calibration import read_fit
from screwsim.study.calibration.read import fit_schema


def faults(folder, fit=FIT, points=POINTS):
    """Return the lines of what is wrong, without the folder."""
    path = write_fit(folder, fit, points)
    with pytest.raises(SceneError) as caught:
        read_fit(path)
    return [line.replace(f"{folder}/", "") for line in caught.value.lines]


def test_a_fit_is_read_in_SI(tmp_path):
    fit = read_fit(write_fit(tmp_path))
    gap, capacity = fit.parameters
    assert (gap.low, gap.high, gap.start) == (1e-5, 1e-4, None)
    assert capacity.start == 1500.0
    assert [point.name for point in fit.points] == ["a", "b", "c", "d"]
    assert [point.fitted for point in fit.points] == [True, True, True, False]
    assert fit.points[0].measured["shaft_power"] == (3100.0, 100.0)
    assert fit.scene.numerics.accuracy == 1e-4  # tighter than the scene's own


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("tip_leakage.gap", "tip_leakage.gp", "small.fit.yaml:5:3: parameters.effects.tip_leakage.gp: is not known; "),
        ("from: 10 um", "from: 10", "small.fit.yaml:5:35: parameters.effects.tip_leakage.gap.from: 10 has no unit"),
        ("from: 10 um", "from: 200 um", "small.fit.yaml:5:28: parameters.effects.tip_leakage.gap: from is not below"),
        ("start: 1.5", "start: 4", "small.fit.yaml:6:66: parameters.oil.heat_capacity.start: lies outside 1 kJ/(kg K)"),
        ("from: 10 um", "from: 10 um, 5 um", "small.fit.yaml:5:42: parameters.effects.tip_leakage.gap.5 um: is no"),
        ("starts: 3", "starts: no", "small.fit.yaml:7:9: starts: 'no' is not a whole number"),
        ("starts: 3", "begins: 3", "small.fit.yaml:7:1: begins: is not known"),
        ("data: points.csv", "data: there.csv", "small.fit.yaml:3:7: data: 'there.csv' is not a file"),
        ("scene: machine.yaml", "", "small.fit.yaml:1:1: scene: is missing"),
        ("oil.heat_capacity", "oil.transport", "small.fit.yaml:6:3: parameters.oil.transport: is a choice"),
        (
            "to: 100 um}",
            "to: 100 um, also: {oil.density: {}}}",
            "small.fit.yaml:5:61: parameters.effects.tip_leakage.gap.also.oil.density: is of another kind",
        ),
        (
            "to: 100 um}",
            "to: 100 um, prior: {mean: 50 um}}",
            "small.fit.yaml:5:54: parameters.effects.tip_leakage.gap.prior.deviation: is missing",
        ),
        (
            "to: 100 um}",
            "to: 100 um, prior: {mean: 50 um, deviation: 2 bar}}",
            "small.fit.yaml:5:86: parameters.effects.tip_leakage.gap.prior.deviation: '2 bar' is not a length",
        ),
        (
            "to: 100 um}",
            "to: 100 um, prior: {mean: 50 um, deviation: -2 um}}",
            "small.fit.yaml:5:86: parameters.effects.tip_leakage.gap.prior.deviation: '-2 um' is out of range",
        ),
        (
            "to: 100 um}",
            "to: 100 um, prior: {mean: 120 um, deviation: 2 um}}",
            "small.fit.yaml:5:68: parameters.effects.tip_leakage.gap.prior.mean: lies outside 0.01 mm … 0.1 mm",
        ),
        (
            "to: 100 um}",
            "to: 100 um, also: {effects.tip_leakage.gap: {factor: 2}}}",
            "small.fit.yaml:5:61: parameters.effects.tip_leakage.gap.also.effects.tip_leakage.gap: is the parameter",
        ),
        (
            "to: 100 um}",
            "to: 100 um, also: {machine.rotor_length: {factor: -2}}}",
            "small.fit.yaml:5:61: parameters.effects.tip_leakage.gap.also.machine.rotor_length: is -0.02 mm where that",
        ),
    ],
)
def test_a_fault_of_the_fit_is_located(old, new, line, tmp_path):
    found = faults(tmp_path, FIT.replace(old, new))
    assert len(found) == 1
    assert found[0].startswith(line)


def test_points_with_semicolons_and_decimal_commas_are_those_with_commas_and_points(tmp_path):
    head, rows = POINTS.split("a,fit", 1)
    of_excel = head.replace(",", ";") + f"a,fit{rows}".replace(",", ";").replace(".", ",")
    assert "a;fit;1000;3,1;0,1\n" in of_excel
    assert read_fit(write_fit(tmp_path, points=of_excel)).points == read_fit(write_fit(tmp_path)).points
    told = faults(tmp_path, points=of_excel.replace("1000;3,1", "1000;x"))
    assert told[0].startswith("points.csv:3:12: shaft_power: 'x' is not a number")


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("3.1,0.1", "x,0.1", "points.csv:3:12: shaft_power: 'x' is not a number"),
        ("3.1,0.1", '"3,1",0.1', "points.csv:3:12: shaft_power: '3,1' has a decimal comma (write a point, e.g. 3.1)"),
        (
            "3.1,0.1",
            '"3,100",0.1',
            "points.csv:3:12: shaft_power: '3,100' has a comma that may separate thousands or dec",
        ),
        (
            "operation.speed [rpm]",
            "operation.speed (rpm)",
            "points.csv:2:10: operation.speed (rpm): is not known (a unit stands in square brackets: operation.speed [",
        ),
        (
            "speed [rpm]",
            "speed [1/min]",
            "points.csv:2:10: operation.speed: unit '1/min' is ambiguous: turns or radians",
        ),
        (
            "speed [rpm]",
            "speed [rmp]",
            "points.csv:2:10: operation.speed: unit 'rmp' is not a speed (write e.g. '3000 rpm')",
        ),
        (
            "operation.speed [rpm]",
            "n",
            "points.csv:2:10: n: is not known (write operation.speed [rpm], if that is what it is)",
        ),
        ("name,use", "Punkt,use", "points.csv:2:1: Punkt: is not known (use name, use, a scene path or a figure)"),
        (
            ",",
            "\t",
            "points.csv:2:1: data: is separated by tabs (save it with commas between cells and decimal points)",
        ),
        ("1000,3.1", '"1,000",3.1', "points.csv:3:7: operation.speed: '1,000' has a comma that may separate"),
        ("3.1,0.1", "3.1,0", "points.csv:3:16: shaft_power: 0 is out of range"),
        ("3.1,0.1", "3.1,1e-300", "points.csv:3:1: shaft_power: its uncertainty is 3e-301 of the value, smaller than"),
        (
            "3.1,0.1",
            "3.1,1e300",
            "points.csv:3:1: shaft_power: its uncertainty is 3e+299 of the value, too large to be",
        ),
        ("3.1,0.1", "3.1,", "points.csv:3:1: shaft_power: needs both a value and an uncertainty, or neither"),
        ("3.1,0.1", "3.1", "points.csv:3:1: data: has 4 cells, but the first line has 5"),
        ("b,fit", "a,fit", "points.csv:4:1: name: 'a' appears twice"),
        ("a,fit", "a,no", "points.csv:3:3: use: 'no' is not known"),
        ("shaft_power [kW],", "shaft_power [kN],", "points.csv:2:32: shaft_power: unit 'kN' is not one of its units"),
        (
            "shaft_power [kW],",
            "shaft_pwer [kW],",
            "points.csv:2:32: shaft_pwer: is not known; did you mean 'shaft_power'?",
        ),
        ("[rpm]", "", "points.csv:3:7: operation.speed: '1000' has no unit"),
        (",shaft_power_uncertainty [kW]", ",oil_ratio", "points.csv:2:32: shaft_power: needs a column shaft_power_unc"),
        (
            "shaft_power [kW],",
            "shaft_power [kW] (k=2),",
            "points.csv:2:32: shaft_power: has a coverage factor, which only",
        ),
        (
            "shaft_power_uncertainty [kW]",
            "shaft_power_uncertainty [kW] (k=0)",
            "points.csv:2:49: shaft_power_uncertainty: k=0 is not a coverage factor (write k=1",
        ),
        ("operation.speed [rpm]", "oil.heat_capacity", "points.csv:2:10: oil.heat_capacity: is a parameter of the fit"),
    ],
)
def test_a_fault_of_the_data_is_located(old, new, line, tmp_path):
    found = faults(tmp_path, points=POINTS.replace(old, new))
    assert found[0].startswith(line), found


@pytest.mark.parametrize(
    ("reading", "line"),
    [
        (
            "[K]",
            "points.csv:2:1: discharge_temperature: 64.2 K is -208.95 degC, and R134a freezes at -103.3 degC (write",
        ),
        ("[degC]", ""),
    ],
)
def test_a_temperature_in_celsius_under_kelvin_is_told(reading, line, tmp_path):
    head = "operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW],discharge_temperature {},{}"
    both = head.format(reading, "discharge_temperature_uncertainty [K]")
    path = write_fit(tmp_path, points=f"{both}\n1000,3.1,0.1,64.2,0.5\n2000,5.2,0.1,,\n3000,6.8,0.2,66,0.5\n")
    if not line:
        assert read_fit(path).points[0].measured["discharge_temperature"].value == pytest.approx(337.35)
        return
    with pytest.raises(SceneError) as caught:
        read_fit(path)
    told = [each.replace(f"{tmp_path}/", "") for each in caught.value.lines]
    assert told[0].startswith(line) and told[1].startswith("points.csv:4:1: discharge_temperature: 66 K"), told


def test_efficiencies_in_percent_without_their_unit_are_refused_as_in_options(tmp_path):
    head = "operation.speed [rpm],volumetric_efficiency{0},volumetric_efficiency_uncertainty{0}\n"
    rows = "1000,92,0.5\n2000,90,0.5\n3000,89,0.5\n"
    first, *_ = faults(tmp_path, points=head.format("") + rows)
    remedy = "(write the unit behind the column's name: volumetric_efficiency [%])"
    assert first == f"points.csv:2:6: volumetric_efficiency: 92 is 9200 % {remedy}"
    fit = read_fit(write_fit(tmp_path, points=head.format(" [%]") + rows))
    assert fit.points[0].measured["volumetric_efficiency"] == pytest.approx((0.92, 0.005))


def test_an_uncertainty_without_unit_beside_percent_is_refused(tmp_path):
    """1 would be a hundred points; [1] states a share."""
    head = "operation.speed [rpm],volumetric_efficiency [%],volumetric_efficiency_uncertainty{}\n"
    own, rows = "volumetric_efficiency_uncertainty", "1000,92,0.01\n2000,90,0.01\n3000,89,0.01\n"
    told = f"has no unit beside volumetric_efficiency [%] (write {own} [%], or [1] for a share)"
    assert faults(tmp_path, points=head.format("") + rows) == [f"points.csv:1:49: {own}: {told}"]
    for unit, size in ((" [%]", 1e-4), (" [1]", 1e-2)):
        fit = read_fit(write_fit(tmp_path, points=head.format(unit) + rows))
        assert fit.points[0].measured["volumetric_efficiency"] == pytest.approx((0.92, size))


def test_an_uncertainty_of_more_than_half_without_unit_is_meant_in_percent(tmp_path):
    """Nothing between 0 and 1 has a larger standard deviation than 0.5; [1] states a share."""
    head = "operation.speed [rpm],volumetric_efficiency,volumetric_efficiency_uncertainty{}\n"
    own, rows = "volumetric_efficiency_uncertainty", "1000,0.92,1\n2000,0.9,0.01\n3000,0.89,0.01\n"
    told = f"1 is 100 % (write the unit behind the column's name: {own} [%])"
    assert faults(tmp_path, points=head.format("") + rows) == [f"points.csv:2:11: volumetric_efficiency: {told}"]
    fit = read_fit(write_fit(tmp_path, points=head.format(" [1]") + rows))
    assert fit.points[0].measured["volumetric_efficiency"] == pytest.approx((0.92, 1.0))


def test_too_few_data_are_told(tmp_path):
    points = "\n".join(POINTS.splitlines()[:3]) + "\n"
    (line,) = faults(tmp_path, points=points)
    assert line.startswith(
        "small.fit.yaml:4:1: parameters: 1 measured figures and 0 priors cannot determine 2 parameters"
    )


def test_priors_alone_are_no_data(tmp_path):
    fit = FIT.replace("to: 100 um}", "to: 100 um, prior: {mean: 50 um, deviation: 1 um}}")
    fit = fit.replace("  oil.heat_capacity: {from: 1 kJ/(kg K), to: 3 kJ/(kg K), start: 1.5 kJ/(kg K)}\n", "")
    points = POINTS.splitlines()[1] + "\na,fit,1000,,\n"
    (line,) = faults(tmp_path, fit, points)
    assert "0 measured figures and 1 priors cannot determine 1 parameters" in line


def test_conditions_that_do_not_fit_are_located(tmp_path):
    points = POINTS.replace("operation.speed [rpm]", "operation.discharge.pressure [bar]").replace("2000", "1.2")
    found = faults(tmp_path, points=points.replace("1000", "10").replace("3000", "12").replace("4000", "14"))
    assert all(line.startswith("points.csv:4:1: ") for line in found)


def test_a_fault_of_all_points_is_told_once(tmp_path):
    points = POINTS.replace("operation.speed [rpm]", "operation.tip_speed [m/s]")
    points = re.sub(r"\b([1-4])000\b", r"\g<1>0", points)
    (line,) = faults(tmp_path, points=points)
    assert line.startswith("points.csv:3:1: operation.tip_speed: is given as well as operation.speed")
    assert line.endswith("; the same at 3 other points")


def test_a_missing_fit_is_one_line(tmp_path):
    with pytest.raises(SceneError, match=r"nowhere\.fit\.yaml:1:1: .*cannot be read"):
        read_fit(tmp_path / "nowhere.fit.yaml")


def test_the_schema_has_what_a_fit_may_have():
    found = fit_schema()
    text = yaml_of(FIT)
    assert set(text) <= set(found["properties"])
    assert set(found["required"]) <= set(text)
    paths = found["properties"]["parameters"]["properties"]
    for path, given in text["parameters"].items():
        assert set(paths[path]["required"]) <= set(given) <= set(paths[path]["properties"])
        for name in set(given) & {"from", "to", "start"}:
            assert re.search(paths[path]["properties"][name]["pattern"], given[name])
    assert "oil.transport" not in paths  # a choice


def yaml_of(text: str) -> dict:
    """Return a YAML text as plain values."""
    return YAML(typ="safe", pure=True).load(text)


def test_an_uncertainty_in_percent_is_a_share_of_each_value_but_of_an_efficiency_points(tmp_path):
    head = "operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [%]{},isentropic_efficiency [%],"
    rows = "isentropic_efficiency_uncertainty [%]\n1000,4,1,70,1\n2000,8,1,70,1\n3000,12,0.5,70,1\n"
    points = read_fit(write_fit(tmp_path, points=head.format("") + rows)).points
    assert [each.measured["shaft_power"].uncertainty for each in points] == pytest.approx([40.0, 80.0, 60.0])
    assert all(each.measured["isentropic_efficiency"].uncertainty == pytest.approx(0.01) for each in points)
    points = read_fit(write_fit(tmp_path, points=head.format(" (k=2)") + rows)).points
    assert points[0].measured["shaft_power"].uncertainty == pytest.approx(20.0)
    with pytest.raises(SceneError, match="shaft_power: is 0, of which no share is an uncertainty"):
        read_fit(write_fit(tmp_path, points=head.format("") + rows.replace("1000,4,", "1000,0,")))


@pytest.mark.parametrize(
    ("unit", "value", "own", "size"),
    [
        ("", "4", "2", 0.08),  # a share of the COP, which was taken as 0.02
        ("", "4", "2 (k=2)", 0.04),
        (" [%]", "400", "2", 0.02),  # points, as the values are in %
    ],
)
def test_percent_of_a_cop_are_a_share_of_it_unless_it_is_stated_in_percent(tmp_path, unit, value, own, size):
    number, _, factor = own.partition(" ")
    head = f"operation.speed [rpm],cop{unit},cop_uncertainty [%]{factor}\n"
    rows = "".join(f"{speed},{value},{number}\n" for speed in (1000, 2000, 3000))
    points = read_fit(write_fit(tmp_path, points=head + rows)).points
    assert all(each.measured["cop"] == pytest.approx((4.0, size), rel=1e-12) for each in points)


def test_a_candidate_has_no_value_of_which_percent_could_be_a_share(tmp_path):
    fit = write_fit(tmp_path)
    (tmp_path / "next.csv").write_text("operation.speed [rpm],cop_uncertainty [%]\n1500,2\n", encoding="utf-8")
    with pytest.raises(SceneError, match=r"cop: has no value of which % are a share"):
        screwsim.plan(fit, candidates=tmp_path / "next.csv")


@pytest.mark.parametrize("figure", ["discharge_temperature [degC]", "discharge_pressure [bar(g)]"])
def test_no_share_of_a_reading_with_a_zero_of_its_own_is_an_uncertainty(tmp_path, figure):
    own = figure.partition(" ")[0] + "_uncertainty"
    head = f"operation.speed [rpm],{figure},{own} [%]\n"
    with pytest.raises(SceneError, match=rf"{own}: unit '%' is "):
        read_fit(write_fit(tmp_path, points=head + "1000,80,1\n2000,80,1\n3000,80,1\n"))


def test_an_uncertainty_is_standard_unless_its_head_states_another_coverage_factor(tmp_path):
    def uncertainty(factor):
        points = POINTS.replace("_uncertainty [kW]", f"_uncertainty [kW]{factor}")
        return read_fit(write_fit(tmp_path, points=points)).points[0].measured["shaft_power"].uncertainty

    assert uncertainty(" (k=1)") == uncertainty("") == pytest.approx(100.0)
    assert uncertainty(" (k=2)") == uncertainty("(k = 2)") == pytest.approx(50.0)


def test_an_empty_cell_is_not_measured(tmp_path):
    points = POINTS.replace("a,fit,1000,3.1,0.1", "a,fit,1000,,").replace("d,check", "d,fit")
    fit = read_fit(write_fit(tmp_path, points=points))
    assert fit.points[0].measured == {}


def test_every_figure_has_units_in_which_it_can_be_measured():
    assert {about.units for about in PERFORMANCE.values()} <= set(UNITS)
    assert UNITS["m3 s-1"]["m^3/h"] * 3600.0 == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("unit", ["kW/(m^3/min)", "kW/(m3/min)", "kW/(m³/min)"])
def test_a_column_may_spell_a_power_of_a_unit_as_people_do(tmp_path, unit):
    points = f"name,operation.speed [rpm],specific_power [{unit}],specific_power_uncertainty [{unit}]\n"
    points += "".join(f"{name},{1000 * (at + 1)},6.5,0.1\n" for at, name in enumerate("abc"))
    fit = read_fit(write_fit(tmp_path, FIT, points))
    assert fit.points[0].measured["specific_power"] == pytest.approx((6.5 * 60e3, 6e3), rel=1e-14)


GAUGE = """\
name,operation.discharge.pressure [barg],discharge_pressure [psig],discharge_pressure_uncertainty [psi],\
discharge_temperature [degF],discharge_temperature_uncertainty [K],oil_line_pressure_loss [bar],\
oil_line_pressure_loss_uncertainty [hPa]
a,9,130,1,176,0.5,0.3,10
b,10 ,145,1,212,0.5,0.3,10
c,11,160,1,230,0.5,0.3,10
"""


def test_pressures_of_gauges_are_over_the_ambient_one_and_units_those_of_scenes(tmp_path):
    scene = screwsim.loads(SCENE).with_({"operation.ambient_pressure": "0.9 bar"}).text
    first = read_fit(write_fit(tmp_path, FIT, GAUGE, scene)).points[0]
    assert first.values["operation.discharge.pressure"] == pytest.approx(9.9e5)
    pressure = first.measured["discharge_pressure"]
    assert pressure.value == pytest.approx(0.9e5 + 130 * 6894.757, rel=1e-6)
    assert pressure.uncertainty == pytest.approx(6894.757, rel=1e-6)
    assert first.measured["discharge_temperature"].value == pytest.approx(353.15)
    assert first.measured["oil_line_pressure_loss"] == pytest.approx((0.3e5, 1e3))


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            "_uncertainty [psi]",
            "_uncertainty [psig]",
            "points.csv:1:68: discharge_pressure_uncertainty: unit 'psig' has an offset zero",
        ),
        ("_uncertainty [K]", "_uncertainty [degF]", "unit 'degF' is a temperature, not a difference"),
        ("loss [bar]", "loss [barg]", "unit 'barg' has an offset zero, and this is a difference (write Pa)"),
        ("[psig]", "[psia]", "discharge_pressure: unit 'psia' is not known (write psi)"),
        ("[psig]", "[pond]", "discharge_pressure: unit 'pond' is not one of its units"),
        ("a,9,130", 'a,9,"130,5"', "discharge_pressure: '130,5' has a decimal comma"),
        ("145,1,", "145,-1,", "points.csv:3:11: discharge_pressure: -1 is out of range"),
    ],
)
def test_a_unit_that_cannot_be_is_told_at_its_place(tmp_path, old, new, line):
    found = faults(tmp_path, points=GAUGE.replace(old, new))
    assert len(found) == 1 and line in found[0], found


@pytest.mark.parametrize(
    ("powers", "refused"),
    [((5, 6), True), ((-5, -6), False), ((5, -6), False)],
)
def test_a_positive_power_at_all_points_of_an_expander_is_refused_with_its_sign(tmp_path, powers, refused):
    expander = Path(__file__).parents[2] / "configs" / "expander" / "point.yaml"
    head = "operation.speed [rpm],shaft_power [kW],shaft_power_uncertainty [kW]"
    (tmp_path / "points.csv").write_text(f"{head}\n2000,{powers[0]},0.1\n3000,{powers[1]},0.1\n", encoding="utf-8")
    fit = f"scene: {expander}\ndata: points.csv\nparameters: {{effects.tip_leakage.gap: {{from: 20 um, to: 80 um}}}}\n"
    (tmp_path / "own.fit.yaml").write_text(fit, encoding="utf-8")
    if not refused:
        assert len(read_fit(tmp_path / "own.fit.yaml").points) == 2
        return
    with pytest.raises(SceneError, match=r"csv:2:1: shaft_power: is positive at every point.*write output_power"):
        read_fit(tmp_path / "own.fit.yaml")
