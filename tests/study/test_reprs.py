"""What is large says in a few lines what it is, and shows a table in notebooks, of its own values."""

from dataclasses import replace
from html.parser import HTMLParser

import pytest
from fit_fakes import POINTS, plane, write_fit
from result_fakes import GRID, SCENE, fake_simulate
from seek_fakes import figures_of
from study_fakes import parabola

import screwsim
from screwsim.outputs import Figures, Result
from screwsim.outputs.display import MOST_COLUMNS, MOST_HTML_ROWS, MOST_ROWS, About, Brief
from screwsim.results import open_results, save
from screwsim.scene import loads
from screwsim.study.calibration import calibrate, read_fit
from screwsim.study.calibration.diagnosis import diagnose
from screwsim.study.calibration.plan import candidates_of, plan
from screwsim.study.optimize import optimize
from screwsim.study.seek import find, find_each, question
from screwsim.study.sweep import run_sweep
from screwsim.study.uncertainty.slopes import Sensitivities
from screwsim.study.uncertainty.spreads import FigureUncertainty, Uncertainty

RATIO = "oil_supply.ratio"
RESULT = Result("ok", performance=Figures(shaft_power=50e3, gas_mass_flow=0.5))
SLOPES = Sensitivities(
    RESULT,
    {"operation.speed": 100.0, RATIO: 2.0},
    derivatives={"shaft_power": {"operation.speed": 400.0, RATIO: 12500.0}, "gas_mass_flow": {"operation.speed": 5e-3}},
)


class Tags(HTMLParser):
    """Counts tags, and fails where one is not closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open, self.rows, self.text = [], 0, ""
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.rows += tag == "tr"

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data + "\n"


def lines_of(thing) -> list[str]:
    lines = repr(thing).splitlines()
    assert len(lines) <= MOST_ROWS + 6 and max(map(len, lines)) < 400
    page = thing._repr_html_()
    assert lines[0] in Tags(page).text and len(page) < 60_000
    return lines


def test_a_scene_tells_its_sections_and_effects():
    scene = loads(SCENE + GRID)
    first, _, *rows = lines_of(replace(scene, title="a <b> & c"))
    assert first == "Scene: a <b> & c"
    told = {row.split()[0]: row for row in rows}
    assert "speed: " in told["operation"] and all(name in told["effects"] for name in list(scene.effects)[:1])
    assert Tags(scene._repr_html_()).rows == 1 + len(told)


def test_a_file_of_results_tells_axes_outcomes_and_ranges(tmp_path):
    scene = loads(SCENE + GRID)
    run_sweep(scene, tmp_path / "x.h5", jobs=1, simulate=fake_simulate)
    results = open_results(tmp_path / "x.h5")
    first, *rows = lines_of(results)
    for axis in results.axis_list:
        assert f"{axis.path} ({len(axis.values)})" in first
    assert any(row.startswith(results.figures[0]) for row in rows)
    assert Tags(results._repr_html_()).rows == 1 + len(results.figures)


def test_a_comparison_tells_points_scenes_and_figures(tmp_path):
    for name, speed in (("a", "3000 rpm"), ("b", "3300 rpm")):
        scene = loads(SCENE, overrides=[f"operation.speed={speed}"])
        save(tmp_path / f"{name}.h5", scene, fake_simulate(scene))
    found = screwsim.compare(tmp_path / "a.h5", open_results(tmp_path / "b.h5"))
    first, points, scenes, head, *rows = lines_of(found)
    assert first == "Comparison: different within errors"
    assert points == "points: 1 in common, 1 ok in both, 0 only in A, 0 only in B"
    assert scenes == "scenes differ by operation.speed" and head.split()[-1] == "differ"
    told = {row.split()[0]: row for row in rows}
    assert all(each.figure in told for each in found.figures)
    assert told["shaft_power"].endswith("1 of 1")
    again = screwsim.compare(tmp_path / "a.h5", tmp_path / "b.h5", tolerance=0.5)
    assert again.equal and repr(again).startswith("Comparison: equal within errors")


def test_an_optimum_tells_its_aim_and_its_values():
    found = optimize(loads(SCENE), [f"{RATIO}=0.1..10"], ["isothermal_efficiency"], simulate=parabola, jobs=1)
    first, counts, head, row = lines_of(found)
    assert first == "Optimum: ok, greatest isothermal_efficiency" and f"{len(found.places)} evaluations" in counts
    assert head.split() == ["isothermal_efficiency", RATIO]
    assert float(row.split()[-1]) == pytest.approx(found.values[RATIO], rel=1e-4)


def test_what_was_found_tells_the_goal_and_the_value():
    def rising(scene):
        return figures_of(scene, gas_mass_flow=0.1 * scene.oil_supply.ratio)

    found = find(loads(SCENE), [f"{RATIO}=0.5..4"], ["gas_mass_flow=0.3 kg/s"], simulate=rising)
    first, *rows = lines_of(found)
    assert first == "Found: ok, for gas_mass_flow = 0.3 kg/s"
    assert ["value", RATIO, "3"] in [row.split() for row in rows]


def test_what_came_nearest_to_a_goal_has_its_unit_and_so_has_the_point_of_the_other_axes():
    def rising(scene):
        return figures_of(scene, gas_mass_flow=1e-3 * scene.operation.speed)

    scene = loads(SCENE).with_({"sweep.operation.suction.temperature": ["280 K"]})
    asked = question(scene, ["operation.speed=500 rpm..3000 rpm"], ["gas_mass_flow=5 kg/s"])
    (found,) = find_each(scene, asked, jobs=1, simulate=rising)
    rows = [row.split(maxsplit=2) for row in lines_of(found)]
    assert found.status == "none"
    assert ["value", "operation.speed", "3000 rpm"] in rows
    assert ["at", "operation.suction.temperature", "6.85 °C"] in rows


def test_a_calibration_tells_parameters_and_how_sure_they_are(tmp_path):
    found = calibrate(read_fit(write_fit(tmp_path)), jobs=1, simulate=plane)
    first, *rows = lines_of(found)
    assert first.startswith("Calibration: ok; chi² ") and f"{len(found.fit.points)} points" in first
    for path in found.values:
        assert any(row.startswith(path) for row in rows)


def test_a_calibration_tells_the_standard_errors_that_the_command_prints(tmp_path):
    """The points miss the plane by more than their uncertainties, so that standard errors are multiplied."""
    lines = POINTS.replace("5.2,0.1", "5.7,0.1")
    found = calibrate(read_fit(write_fit(tmp_path, points=lines)), jobs=1, simulate=plane)
    assert found.certainty is not None and found.scale > 3.0
    error, value = found.certainty.errors[0], found.values["effects.tip_leakage.gap"]
    assert error is not None
    (row,) = (row for row in lines_of(found) if row.startswith("effects.tip_leakage.gap"))
    assert f"{100.0 * error * found.scale / value:.2g} %" in row


def test_a_diagnosis_tells_its_hypotheses_the_most_probable_first_and_that_none_fits(tmp_path):
    bent = POINTS.replace("5.2,0.1", "5.7,0.01")
    found = diagnose(read_fit(write_fit(tmp_path, points=bent), fixed=False), jobs=1, simulate=plane)
    first, title, none, head, *rows = lines_of(found)
    assert first == "Diagnosis: ok; 3 points" and title == found.fit.title and none.startswith("nothing fits: ")
    assert head.split() == ["changed", "probability", "now", "chi²"]
    assert [row.split("  ")[0] for row in rows] == [each.path or "nothing" for each in found.hypotheses]
    best = found.hypotheses[0]
    assert f"{100.0 * best.probability:.3g} %" in rows[0] and rows[0].endswith(f"{best.misfit:.3g}")


def test_a_plan_tells_the_points_in_their_order(tmp_path):
    fit = read_fit(write_fit(tmp_path), fixed=False)
    found = plan(fit, candidates_of(fit, paths=["operation.speed=1000 rpm..4000 rpm"]), count=2, jobs=1, simulate=plane)
    first, _, _, *rows = lines_of(found)
    assert first == "Plan: ok; 2 of 4 candidates"
    assert [row.rsplit(maxsplit=1) for row in rows] == [[one.point.name, f"{one.gain:.3f}"] for one in found.steps]


def test_sensitivities_tell_the_largest_first_in_percent_per_percent():
    first, note, head, one, other = lines_of(SLOPES)
    assert first == "Sensitivities: 2 figures by 2 numbers of the scene" and note.startswith("percent per percent")
    assert head.split() == ["number", "shaft_power", "gas_mass_flow"]
    assert (one.split(), other.split()) == (["operation.speed", "0.8", "1"], [RATIO, "0.5", "–"])


def test_an_uncertainty_tells_figures_with_their_intervals():
    found = Uncertainty({"shaft_power": FigureUncertainty(500.0, ())}, SLOPES, ((RATIO,),))
    first, _, row = lines_of(found)
    assert first == "Uncertainty of 1 figures by 1 inputs"
    assert row.split() == ["shaft_power", "50", "kW", "2", "%"]


def test_what_is_left_out_is_counted():
    class Large(Brief):
        def _about(self):
            return About("Large", (), [f"c{i}" for i in range(30)], [["1"] * 30 for _ in range(100)])

    lines = lines_of(Large())
    assert lines[-1] == f"… {100 - MOST_ROWS} more rows and {30 - MOST_COLUMNS} more columns"
    page = Tags(Large()._repr_html_())
    assert page.rows == 1 + MOST_HTML_ROWS and f"{100 - MOST_HTML_ROWS} more rows and" in page.text
