"""A built-in volume ratio moves the port of a table: where it opens follows from the volume, where it shuts stays."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row

import screwsim
from screwsim.explain import explain
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.machine import paper_law
from screwsim.machine.kinds import kind_of
from screwsim.machine.moved_port import moved_area
from screwsim.numerics.spline import negligible_areas

CONFIGS = Path(__file__).parents[2] / "configs"
POINT = CONFIGS / "paper" / "point.yaml"
ROWS = np.arange(0.0, 720.01, 1.0)  # deg


def write(path, column, rows):
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["angle_deg", column])
        writer.writerows((f"{angle:.10g}", f"{value:.12g}") for angle, value in rows)
    return path


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """Return a folder with the volume and the discharge port of the paper's machine as tables of 1 deg."""
    folder, machine = tmp_path_factory.mktemp("tables"), screwsim.load(POINT).machine
    volume, port = machine.volume, machine.discharge_port
    rows = [(angle, paper_law.volume(math.radians(angle), volume.max, 0.0, volume.phi_A)) for angle in ROWS]
    write(folder / "volume.csv", "volume_m3", rows)
    laws = port.area, port.opens, port.phi_C
    rows = [(angle, paper_law.discharge_area(math.radians(angle), *laws)) for angle in ROWS]
    write(folder / "port.csv", "area_m2", rows)
    return folder


def tabled(tables, *overrides, volume=True):
    of_volume = f"machine.volume={{law: table, file: {tables / 'volume.csv'}, max: 0.0005 m^3}}"
    of_port = f"machine.discharge_port={{law: table, file: {tables / 'port.csv'}}}"
    return screwsim.load(POINT, [*([of_volume] if volume else []), of_port, *overrides])


def geometry(scene):
    return kind_of(scene.machine).geometry(scene.machine)


def ratio_of(found):
    """Return the ratio of the volumes at the angles of closing and opening, not what the scene states."""
    volumes = found.volume_law().along(np.array([found.injection_angle, found.discharge_opens]))[0]
    return volumes[0] / volumes[1]


def closes(found):
    """Return the angle from which on the discharge port is shut behind its widest."""
    angles, areas = found.discharge_law().rows
    widest = int(np.argmax(areas))
    return angles[widest + np.flatnonzero(negligible_areas(areas)[widest:])[0]]


@pytest.mark.parametrize("by_table", [True, False])
@pytest.mark.parametrize("ratio", [1.5, 2.6, 4.0, 8.0])
def test_a_moved_table_opens_where_the_volume_has_the_ratio_and_shuts_where_it_did(tables, ratio, by_table):
    before = geometry(tabled(tables, volume=by_table))
    after = geometry(tabled(tables, f"machine.built_in_volume_ratio={ratio}", volume=by_table))
    assert ratio_of(after) == pytest.approx(ratio, rel=1e-9)
    assert closes(after) == pytest.approx(closes(before), abs=1e-12)


def test_a_later_opening_leaves_a_smaller_port_and_an_earlier_one_none_that_is_larger_than_the_table(tables):
    largest = {
        ratio: max(geometry(tabled(tables, f"machine.built_in_volume_ratio={ratio}")).discharge_law().rows[1])
        for ratio in (1.5, 2.6, 12.0, 30.0)
    }
    table = max(geometry(tabled(tables)).discharge_law().rows[1])
    assert largest[1.5] == largest[2.6] == table
    assert table > largest[12.0] > largest[30.0] > 0.0


def test_a_table_moved_to_its_own_ratio_gives_its_own_figures(tables):
    own = screwsim.simulate(tabled(tables), trace=False).performance
    stated = [f"machine.built_in_volume_ratio={float(own.built_in_volume_ratio)!r}"]
    again = screwsim.simulate(tabled(tables, *stated), trace=False).performance
    assert again.built_in_volume_ratio == pytest.approx(own.built_in_volume_ratio, rel=1e-9)
    for name in ("isothermal_efficiency", "volumetric_efficiency", "shaft_power"):
        assert again[name] == pytest.approx(own[name], rel=3e-4)  # the wanted accuracy of both


def test_a_moved_table_compresses_as_the_law_that_it_was_made_of(tables):
    """Both open at the same angle; the law's port is also stretched over the rest: 2 points between 2.6 and 8."""
    for ratio in (2.6, 4.0, 8.0):
        stated = f"machine.built_in_volume_ratio={ratio}"
        free = [f"machine.discharge_port.{name}=null" for name in ("opens", "phi_C")]
        by_law = screwsim.simulate(screwsim.load(POINT, [*free, stated]), trace=False)
        by_table = screwsim.simulate(tabled(tables, stated), trace=False)
        assert by_table.status == by_law.status == "ok"
        assert by_table.performance.built_in_volume_ratio == pytest.approx(ratio, rel=1e-6)
        assert by_table.performance.isentropic_efficiency == pytest.approx(
            by_law.performance.isentropic_efficiency, abs=0.02
        )


def test_the_papers_port_opens_by_a_tabulated_volume_as_by_its_formula(tables):
    stated = [
        "machine.built_in_volume_ratio=3",
        *(f"machine.discharge_port.{name}=null" for name in ("opens", "phi_C")),
    ]
    volume = f"machine.volume={{law: table, file: {tables / 'volume.csv'}, max: 0.0005 m^3}}"
    by_formula = geometry(screwsim.load(POINT, stated))
    by_table = geometry(screwsim.load(POINT, [volume, *stated]))
    assert by_table.discharge_opens == pytest.approx(by_formula.discharge_opens, abs=math.radians(0.05))
    assert ratio_of(by_table) == pytest.approx(3.0, rel=1e-9)


def test_a_table_beside_rotors_follows_their_ratio(tmp_path):
    base = CONFIGS / "rotors" / "b.yaml"
    angles, areas = geometry(screwsim.load(base)).discharge_law().rows
    port = write(tmp_path / "port.csv", "area_m2", zip(np.degrees(angles), areas, strict=True))
    for ratio in (2.2, 3.4):
        found = geometry(
            screwsim.load(
                base,
                [f"machine.discharge_port={{law: table, file: {port}}}", f"machine.built_in_volume_ratio={ratio}"],
            )
        )
        assert ratio_of(found) == pytest.approx(ratio, rel=1e-9)


@pytest.fixture
def drawn(tmp_path):
    """Return the scene of rotors (b) with a discharge port as drawn, which no volume ratio moves, and its opening."""
    base = CONFIGS / "rotors" / "b.yaml"
    rows = [(660.0 + i, 9e-4 * math.sin(math.pi * i / 176) ** 2) for i in range(177)]
    port = write(tmp_path / "drawn.csv", "area_m2", rows)
    stated = f"machine.discharge_port={{law: table, file: {port}}}"
    return screwsim.load(base, [stated, "machine.built_in_volume_ratio=null"]), rows


def test_a_port_as_drawn_beside_rotors_stays_where_it_is_without_a_ratio(drawn):
    scene, rows = drawn
    found = geometry(scene)
    angles, areas = found.discharge_law().rows
    assert (np.degrees(angles), areas) == (
        pytest.approx([row[0] for row in rows]),
        pytest.approx([row[1] for row in rows]),
    )
    assert math.degrees(found.discharge_opens) == pytest.approx(660.0)
    assert math.degrees(found.profile.opens) == pytest.approx(660.0, abs=1e-6)  # where steps of the gaps end, too
    result = screwsim.simulate(scene, trace=False)
    assert result.status == "ok"
    assert result.performance.built_in_volume_ratio == pytest.approx(ratio_of(found), rel=1e-9)
    told = " ".join(str(explain(scene)).split())
    assert f"built-in volume ratio {found.profile.swept / volume(found, 660.0):.4g}, where the table" in told


def volume(found, angle):
    """Return the volume of rotors [m³], without the dead volume, at an angle [deg]."""
    return float(
        found.profile.rotors.volume(np.array(math.radians(angle) - found.profile.born) + found.profile.rotors.start)
    )


def test_a_port_as_drawn_is_that_of_its_own_ratio(drawn):
    scene, _ = drawn
    own = screwsim.simulate(scene, trace=False).performance
    ratio = geometry(scene).built_in_volume_ratio(
        lambda angle: geometry(scene).volume_law().along(np.array([angle]))[0][0]
    )
    stated = screwsim.simulate(scene.with_({"machine.built_in_volume_ratio": float(ratio)}), trace=False).performance
    for name in ("isentropic_efficiency", "volumetric_efficiency", "shaft_power"):
        assert stated[name] == pytest.approx(own[name], rel=3e-4)  # the wanted accuracy of both


def test_a_port_beside_rotors_that_opens_before_suction_closes_needs_no_ratio_either(tmp_path):
    port = write(tmp_path / "early.csv", "area_m2", [(440, 0), (500, 1e-4), (740, 9e-4), (836, 0)])
    stated = f"machine.discharge_port={{law: table, file: {port}}}"
    scene = screwsim.load(CONFIGS / "rotors" / "b.yaml", [stated, "machine.built_in_volume_ratio=null"])
    found = geometry(scene)
    assert found.profile.opens == pytest.approx(found.profile.injection, abs=1e-6)
    assert math.degrees(found.discharge_opens) == pytest.approx(440.0)


def test_the_tables_of_rotors_keep_the_ratio_that_moves_a_port_of_the_scene_s_own(drawn, tmp_path):
    from screwsim.report.rotors_scene import write as write_rotors

    for ratio in (None, 2.4):
        scene = drawn[0].with_({"machine.built_in_volume_ratio": ratio})
        write_rotors(scene, tmp_path / f"{ratio}")
        again = geometry(screwsim.load(tmp_path / f"{ratio}" / "table" / "scene.yaml"))
        assert again.discharge_opens == pytest.approx(geometry(scene).discharge_opens, abs=math.radians(0.02))


def test_run_says_how_far_a_table_is_shifted(drawn):
    from screwsim.scene.left_out import moved_port_lines

    scene, _ = drawn
    assert moved_port_lines(scene) == []
    moved = scene.with_({"machine.built_in_volume_ratio": 2.2})
    opens = math.degrees(geometry(moved).discharge_opens)
    assert moved_port_lines(moved) == [
        f"the table of machine.discharge_port opens at 660 deg, and is shifted to {opens:.4g} deg by "
        "machine.built_in_volume_ratio: 2.2 (null keeps it as it is)"
    ]


def test_explain_says_where_the_moved_port_opens(tables):
    scene = tabled(tables, "machine.built_in_volume_ratio=4")
    opens = math.degrees(geometry(scene).discharge_opens)
    told = " ".join(str(explain(scene)).split())
    assert f"volume ratio 4, to which the table of the discharge port is shifted: opens {opens:.5g} deg (M394)" in told


def test_a_sweep_over_the_ratio_moves_the_table_each_time(tables):
    scene = tabled(tables, "machine.built_in_volume_ratio=3", "sweep.machine.built_in_volume_ratio=[2.2, 3, 4.5]")
    from screwsim.scene import case

    assert [ratio_of(geometry(case(scene, number))) for number in range(3)] == pytest.approx([2.2, 3.0, 4.5], rel=1e-9)


@pytest.mark.parametrize(
    ("rows", "ratio", "told"),
    [
        (
            None,
            500,
            "machine.built_in_volume_ratio: 500 leaves the port less than 10 deg before the end of discharge (choose a "
            "smaller ratio)",
        ),
        (
            [(500, 0.001), (600, 0.004), (720, 0)],
            3,
            "machine.built_in_volume_ratio: cannot be met: the table of machine.discharge_port is open from its first "
            "row, so that it does not show where it opens (begin its file with a row of area 0, or remove this)",
        ),
    ],
)
def test_a_table_that_cannot_be_moved_is_refused_in_one_line_with_the_remedy(tables, tmp_path, rows, ratio, told):
    port = tables / "port.csv" if rows is None else write(tmp_path / "port.csv", "area_m2", rows)
    changes = [f"machine.discharge_port={{law: table, file: {port}}}", f"machine.built_in_volume_ratio={ratio}"]
    with pytest.raises(SceneError) as refused:
        screwsim.load(POINT, changes)
    (line,) = refused.value.lines
    assert line.endswith(told)


def test_a_table_whose_file_is_not_there_is_told_of_that_alone(tmp_path):
    changes = ["machine.discharge_port={law: table, file: none.csv}", "machine.built_in_volume_ratio=3"]
    with pytest.raises(SceneError) as refused:
        screwsim.load(POINT, changes)
    (line,) = refused.value.lines
    assert "machine.discharge_port.file: 'none.csv' is not a file" in line


def test_an_edge_that_meets_the_end_of_a_port_leaves_the_lesser_of_both():
    angles, areas = np.radians([400.0, 500.0, 520.0, 640.0, 720.0]), np.array([0.0, 0.0, 4.0, 4.0, 0.0])
    at, area = moved_area(angles, areas, math.radians(690.0), 3.0)
    assert np.interp(np.radians([690.0, 720.0]), at, area) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert 0.0 < area.max() < 2.0  # the shutting branch has less than half its width left at 690 deg
    with pytest.raises(UsageError, match="less than 10 deg before the end of discharge"):
        moved_area(angles, areas, math.radians(711.0), 3.0)


@each_row(
    ("rows", "says"),
    [
        ([(650, 0)], "port.csv': has 1 rows; a curve needs at least 3"),
        (
            [(800, 0), (810, 9e-4), (836, 0)],
            "opens so close to the end of discharge that nothing is left of the port",
        ),
    ],
)
def test_a_table_that_places_no_port_beside_rotors_is_told_once_at_its_file(tmp_path, rows, says):
    port = write(tmp_path / "port.csv", "area_m2", rows)
    stated = f"machine.discharge_port={{law: table, file: {port}}}"
    with pytest.raises(SceneError) as refused:
        screwsim.load(CONFIGS / "rotors" / "b.yaml", [stated, "machine.built_in_volume_ratio=null"])
    (line,) = refused.value.lines
    assert ": machine.discharge_port.file: " in line and says in line
