"""Rules of designs: paths that vary together, samples that a seed gives again, values out of CSV files."""

import math

import pytest

from screwsim.inputs.faults import SceneError
from screwsim.scene import case_count, case_values, dimensions, loads, with_sweep_over
from screwsim.scene.sweep import draw

SAMPLE = (
    "{sample: {kind: KIND, count: 16, seed: 7, over: {operation.speed: {from: 500 rpm, to: 5000 rpm, spacing: log}, "
    "oil_supply.ratio: {from: 1, to: 3}, machine.male_lobes: {from: 3, to: 5}, oil.transport: [paper, carried]}}}"
)


def swept(example, sweep, folder="."):
    return loads(f"sweep: {sweep}\n{example}", "x.yaml", folder=str(folder))


def faults_of(example, sweep, folder="."):
    with pytest.raises(SceneError) as error:
        swept(example, sweep, folder)
    return error.value.lines


def cases_of(scene):
    return [tuple(case_values(scene, index).values()) for index in range(case_count(scene))]


def test_zipped_paths_are_one_dimension_beside_the_others(example):
    scene = swept(example, "{zip: [{oil_supply.ratio: [1, 2, 2], machine.male_lobes: [3, 4, 5]}], oil.density: "
                           "[900 kg/m^3, 950 kg/m^3]}")  # fmt: skip
    assert [(each.name, each.size) for each in dimensions(scene)] == [("case", 3), ("oil.density", 2)]
    assert cases_of(scene) == [(1, 3, 900), (1, 3, 950), (2, 4, 900), (2, 4, 950), (2, 5, 900), (2, 5, 950)]


def test_two_groups_of_zipped_paths_make_two_dimensions(example):
    scene = swept(example, "{zip: [{oil_supply.ratio: [1, 2]}, {machine.male_lobes: [3, 4, 5]}]}")
    assert [(each.name, each.size) for each in dimensions(scene)] == [("case", 2), ("case_2", 3)]


@pytest.mark.parametrize("kind", ["sobol", "latin_hypercube"])
def test_a_sample_fills_its_ranges_and_is_the_same_again(kind, example):
    scene = swept(example, SAMPLE.replace("KIND", kind))
    assert [(each.name, each.size) for each in dimensions(scene)] == [("sample", 16)]
    speed, ratio, lobes, transport = zip(*cases_of(scene), strict=True)
    places = [int(16 * math.log(value * 30 / math.pi / 500) / math.log(10)) for value in speed]
    assert sorted(places) == list(range(16))  # one point in each sixteenth: what both kinds promise
    assert sorted(int(8 * (value - 1)) for value in ratio) == list(range(16))
    assert set(lobes) == {3, 4, 5}
    assert transport.count("paper") == 8
    assert cases_of(swept(example, SAMPLE.replace("KIND", kind))) == cases_of(scene)


def test_another_seed_gives_another_sample(example):
    scene = swept(example, SAMPLE.replace("KIND", "sobol"))
    other = swept(example, SAMPLE.replace("KIND", "sobol").replace("seed: 7", "seed: 8"))
    assert cases_of(scene) != cases_of(other)
    assert other.joints[0].sample is not None
    assert draw(other.joints[0].sample)["oil_supply.ratio"] == other.sweep["oil_supply.ratio"]


@pytest.mark.parametrize(
    "sweep",
    [
        "{zip: [{oil_supply.ratio: [1, 1], machine.male_lobes: [3, 4]}, {oil.density: [1 g/cm^3]}], "
        "operation.speed: [1000 rpm]}",
        SAMPLE.replace("KIND", "sobol"),
        SAMPLE.replace("KIND", "latin_hypercube"),
    ],
)
def test_the_text_of_a_design_reads_back_to_the_same_cases(sweep, example):
    scene = swept(example, sweep)
    again = loads(scene.text)
    assert (again.text, again.sweep, again.joints) == (scene.text, scene.sweep, scene.joints)


def test_an_axis_is_read_from_a_column_of_a_csv_file(example, tmp_path):
    (tmp_path / "map.csv").write_text("# measured\nspeed,p_d\n1000 rpm,8\n1500 rpm,9.5\n")
    columns = "operation.speed: {file: map.csv, column: speed}, "
    columns += "operation.discharge.pressure: {file: map.csv, column: p_d, unit: bar}"
    side_by_side = swept(example, f"{{zip: [{{{columns}}}]}}", tmp_path)
    assert case_count(side_by_side) == 2
    assert case_values(side_by_side, 1)["operation.discharge.pressure"] == pytest.approx(9.5e5, rel=1e-15)
    assert case_count(swept(example, f"{{{columns}}}", tmp_path)) == 4
    assert loads(side_by_side.text).sweep == side_by_side.sweep  # the text needs the file no more


def test_a_column_of_shares_may_be_in_percent(tmp_path, pytestconfig):
    (tmp_path / "weather.csv").write_text("T,RH\n10,80\n35,60.5\n")
    moist = (pytestconfig.rootpath / "configs" / "air" / "moist.yaml").read_text(encoding="utf-8")
    column = "{{gas.relative_humidity: {{file: weather.csv, column: RH{}}}}}"
    scene = swept(moist, column.format(', unit: "%"'), tmp_path)
    assert scene.sweep["gas.relative_humidity"] == pytest.approx((0.8, 0.605), rel=1e-15)
    with pytest.raises(SceneError, match=r"80 % is 0\.8\) or name the unit of the column, e\.g\. unit: '%'"):
        swept(moist, column.format(""), tmp_path)


def test_a_part_of_a_sweep_keeps_what_varies_together(example):
    scene = swept(example, "{zip: [{oil_supply.ratio: [1, 2], machine.male_lobes: [3, 4]}], operation.speed: [1 rpm]}")
    one = with_sweep_over(scene, ["machine.male_lobes", "operation.speed"])
    assert [each.name for each in dimensions(one)] == ["case", "operation.speed"]
    assert [each.name for each in dimensions(with_sweep_over(scene, ["operation.speed"]))] == ["operation.speed"]


def test_settings_of_a_sample_are_changed_from_outside(example):
    text = f"sweep: {SAMPLE.replace('KIND', 'sobol')}\n{example}"
    changes = ["sweep.sample.count=4", "sweep.sample.over.oil_supply.ratio={from: 5, to: 6}"]
    scene = loads(text, overrides=changes)
    assert case_count(scene) == 4
    assert all(5 <= ratio <= 6 for ratio in scene.sweep["oil_supply.ratio"])
    assert loads(text, overrides=["sweep.sample=null"]).sweep == {}


@pytest.mark.parametrize(
    ("sweep", "told"),
    [
        ("{zip: {oil_supply.ratio: [1]}}", "1:14: sweep.zip: is not a list of mappings (write [{"),
        ("{zip: [{}]}", "1:15: sweep.zip: has a group without an axis (write [{"),
        (
            "{zip: [{oil_supply.ratio: [1, 2], machine.male_lobes: [3]}]}",
            "1:15: sweep.zip: has axes of different lengths: oil_supply.ratio 2, machine.male_lobes 1 (make them",
        ),
        (
            "{zip: [{oil_supply.ratio: [1, null], machine.male_lobes: [3, 4]}]}",
            "1:38: sweep.zip.oil_supply.ratio: null is not a number",
        ),
        (
            "{zip: [{oil_supply.ratio: [1, 2]}], oil_supply.ratio: [1]}",
            "1:44: sweep.oil_supply.ratio: is varied twice (remove one)",
        ),
        ("{zip: [{oil_supply.ration: [1]}]}", "sweep.zip.oil_supply.ration: is not known; did you mean 'oil_supply"),
        ("{sample: 3}", "1:17: sweep.sample: 3 is not a mapping (write {kind: sobol, count: 64, seed: 1, over:"),
        ("{sample: {kind: sobol, count: 4}}", "sweep.sample.over: must name the paths that vary (write {kind:"),
        (
            "{sample: {kind: sobol, count: 60, over: {oil_supply.ratio: {from: 1, to: 2}}}}",
            "sweep.sample.count: 60 is not a power of two, which a Sobol sample needs (write e.g. 64, or kind: latin",
        ),
        (
            "{sample: {kind: halton, count: 4, over: {oil_supply.ratio: {from: 1, to: 2}}}}",
            "sweep.sample.kind: 'halton' is not an option (choose from: sobol, latin_hypercube)",
        ),
        (
            "{sample: {kind: sobol, count: 4, over: {oil_supply.ratio: {from: 2, to: 1}}}}",
            "sweep.sample.over.oil_supply.ratio: from is not below to (swap them)",
        ),
        (
            "{sample: {kind: sobol, count: 4, over: {oil_supply.ratio: {from: 0, to: 1, spacing: log}}}}",
            "sweep.sample.over.oil_supply.ratio: log spacing needs ends above zero (choose another from)",
        ),
        (
            "{sample: {kind: sobol, count: 4, over: {oil.transport: {from: a, to: b}}}}",
            "sweep.sample.over.oil.transport: is a choice: write a list of its options",
        ),
        (
            "{sample: {kind: sobol, count: 4, over: {oil_supply.ratio: 3}}}",
            "sweep.sample.over.oil_supply.ratio: is neither {from, to} nor a list (write e.g. [1, 2])",
        ),
        (
            "{operation.speed: {file: none.csv, column: n}}",
            "sweep.operation.speed: 'none.csv' cannot be read: No such file or directory (name a CSV file",
        ),
        (
            "{operation.speed: {file: map.csv, column: sped}}",
            "sweep.operation.speed: 'map.csv': column 'sped' is not known; did you mean 'speed'?",
        ),
        (
            "{operation.speed: {file: tabs.csv, column: speed}}",
            "sweep.operation.speed: tabs.csv line 1: is separated by tabs (save it with commas between",
        ),
        (
            "{operation.discharge.pressure: {file: map.csv, column: p_d}}",
            "map.csv line 2: '8' has no unit (write e.g. '2 bar') or name the unit of the column",
        ),
        (
            "{oil_supply.ratio: {file: map.csv, column: p_d, unit: bar}}",
            "sweep.oil_supply.ratio: has no unit, but unit: 'bar' is given (remove unit)",
        ),
        (
            "{oil_supply.ratio: {file: map.csv, column: speed}}",
            "sweep.oil_supply.ratio: map.csv line 2: '1000 rpm' is not a plain number",
        ),
        (
            "{operation.speed: {file: empty.csv, column: speed}}",
            "sweep.operation.speed: 'empty.csv' has 0 rows of values (1 to 100000 are allowed)",
        ),
        ("{operation.speed: {file: map.csv}}", "sweep.operation.speed.column: is missing (write {file: x.csv, column"),
    ],
)
def test_a_fault_of_a_design_is_one_line_with_its_place_and_remedy(sweep, told, example, tmp_path):
    (tmp_path / "map.csv").write_text("speed,p_d\n1000 rpm,8\n")
    (tmp_path / "empty.csv").write_text("speed\n")
    (tmp_path / "tabs.csv").write_text("speed\tp_d\n1000 rpm\t8,5\n")
    [line] = faults_of(example, sweep, tmp_path)
    assert line.startswith("x.yaml:1:")
    assert told in line
