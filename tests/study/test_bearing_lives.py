"""Lives of bearings on data sheets: those of the own point, and the shortest within all limits."""

from dataclasses import replace

import pytest
from folders import CONFIGS

import screwsim
from screwsim.outputs import Figures, Result
from screwsim.study.datasheet import SheetOptions, sheet_of
from screwsim.study.datasheet.bearing_lives import LIFE_FIGURES, TITLE, lives, lives_document, lives_table
from screwsim.study.stages import read_stages
from screwsim.template import new_scene, request_of

pytestmark = pytest.mark.around
HOUR = 3600.0
BEARINGS = "{suction: {distance: 35 mm, rating: 200 kN}, discharge: {distance: 40 mm}, axial: {rating: 110 kN}}"


def result(life, load=1e3, status="ok"):
    found = {"male_axial_bearing_equivalent_load": load, "male_axial_bearing_life": life}
    return Result(status, performance=Figures(found) if status == "ok" else Figures({}))


def test_the_shortest_life_is_that_of_the_points_that_closed_and_have_one():
    points = [("own", result(9e6)), ("a", result(4e6)), ("b", result(None)), ("c", result(1e6, status="failed"))]
    (found,) = lives(points)
    assert found == ("male axial bearing", 1e3, 9e6, 4e6, "a")
    (table,) = lives_table(points)
    assert table.rows == [["male axial bearing", "1.00", "2500", "1110", "a"]]
    assert table.note.startswith("load: equivalent, life: at own; basic rating lives by ISO 281")
    (alone,) = lives_table(points[:1])
    assert alone.rows == [["male axial bearing", "1.00", "2500"]]


def test_there_is_no_table_without_bearings_without_ratings_or_without_an_own_point():
    for points in (
        [("own", Result("ok", performance=Figures({"shaft_power": 1.0})))],
        [("own", result(None))],
        [("own", result(1e6, status="failed")), ("a", result(1e6))],
    ):
        assert list(lives_table(points)) == []
    assert lives_document([("own", Result("ok", performance=Figures({})))]) == {}


def test_a_package_shows_the_lives_that_a_run_has_and_the_shortest_of_all_speeds():
    base = screwsim.load(CONFIGS / "air" / "bearing_life.yaml", ["sweep.operation.speed=[2950 rpm, 2000 rpm]"])
    sheet = screwsim.datasheet(base)
    (table,) = (each for each in sheet.tables if each.title == TITLE)
    fast = sheet.document["points"][0]
    run = screwsim.simulate(screwsim.load(CONFIGS / "air" / "bearing_life.yaml"), trace=False).performance
    for row, each in zip(table.rows, sheet.document["bearings"], strict=True):
        assert row[0] == each["bearing"]
        name = "bearing_set_life" if row[0] == "all together" else f"{row[0].replace(' ', '_')}_life"
        every = [point[name] for point in (*sheet.document["points"], sheet.document["unloaded"])]
        assert each["life"] == fast[name] == pytest.approx(run[name], rel=1e-9)
        assert each["shortest_life"] == min(every)
        assert float(row[2]) == pytest.approx(fast[name] / HOUR, rel=5e-3)
    assert {name for name in LIFE_FIGURES if name in fast} == set(LIFE_FIGURES)


def test_points_beyond_a_limit_shorten_no_life_of_a_gas_sheet():
    text = new_scene("booster", request_of())
    scene = screwsim.loads(text, overrides=[f"effects.bearings.male={BEARINGS}"])
    ranges = {"suction": "4.9 bar..5.1 bar", "discharge": "15 bar..25 bar"}
    wide = screwsim.datasheet(scene, **ranges)
    narrow = screwsim.datasheet(scene, **ranges, limits=["discharge_pressure<23 bar"])
    suction, discharge, axial = wide.document["bearings"]
    assert discharge["life"] is None and discharge["equivalent_load"] > 0.0  # it has no rating
    assert axial["shortest_at"] == "5.1/25 bar" and axial["shortest_life"] < axial["life"]
    lives_of = [point["male_axial_bearing_life"] for point in narrow.document["points"] if not point["beyond"]]
    lives_of += [step["male_axial_bearing_life"] for each in narrow.document["part_load"] for step in each["loads"]]
    *_, within = narrow.document["bearings"]
    assert within["shortest_at"] == "5.1/22.5 bar"
    assert within["life"] == axial["life"] > within["shortest_life"] == min(lives_of) > axial["shortest_life"]
    assert suction["life"] > suction["shortest_life"]
    beyond = screwsim.datasheet(scene, **ranges, limits=["discharge_pressure<17 bar"])  # 20 bar at its own point
    *_, axial = beyond.document["bearings"]
    assert axial["shortest_at"] in ("4.9/15 bar", "5/15 bar", "5.1/15 bar") and axial["shortest_life"] > axial["life"]


def test_each_stage_of_two_has_its_bearings():
    file, bearings = CONFIGS / "two_stage" / "air.stages.yaml", f"second.effects.bearings.male={BEARINGS}"
    sheet = sheet_of(replace(read_stages(file, [bearings]), sweep={}, joints=()), SheetOptions())
    (table,) = (each for each in sheet.tables if each.title.startswith(TITLE))
    assert table.title == f"{TITLE} of the second stage"
    ((_, second),) = sheet.document["stages"]
    assert float(table.rows[-1][2]) == pytest.approx(second["male_axial_bearing_life"] / HOUR, rel=5e-3)
