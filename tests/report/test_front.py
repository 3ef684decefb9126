"""Figures of an optimisation: what is drawn is what the file says is best."""

import re
from pathlib import Path

import numpy as np
import pytest
from result_fakes import SCENE
from seek_fakes import RPM, chiller, choosing

import screwsim
from screwsim.report import front, plot, samples
from screwsim.report.page import page_of
from screwsim.report.page.tables import best_table
from screwsim.results import open_results
from screwsim.scene import loads
from screwsim.study.optimize import optimize

pytestmark = pytest.mark.around
RANGES = ("oil_supply.ratio=1..3", "operation.speed=1000 rpm..5000 rpm")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Return files of optimisations of one aim and of two, with a bound."""
    folder, found = tmp_path_factory.mktemp("optimised"), {}
    for name, aims in {"one": ["gas_mass_flow"], "two": ["gas_mass_flow", "shaft_power"]}.items():
        found[name] = folder / f"{name}.h5"
        how = {"subject_to": ["shaft_power<1.8 W"], "evaluations": 120, "output": found[name]}
        optimize(loads(SCENE), RANGES, aims[:1], aims[1:], simulate=choosing, jobs=1, **how)
    return found


def test_the_line_of_a_front_goes_through_its_evaluations(files):
    results = open_results(files["two"])
    ((name, draw), _) = front.plans(results)
    axes = draw().axes[0]
    line = axes.lines[-1]
    best = results.optimum["front"] == 1
    x, y = results.optimum["aim_gas_mass_flow"][best], results.optimum["aim_shaft_power"][best]
    assert name == "front" and best.sum() > 5
    assert np.array_equal(line.get_xdata(), np.sort(x))
    assert sorted(line.get_ydata()) == pytest.approx(sorted(y))  # below a kilowatt it is shown in watts


def test_each_aim_is_drawn_over_each_path(files):
    results = open_results(files["one"])
    ((name, draw),) = front.plans(results)
    panels = draw().axes
    assert name == "evaluations" and len(panels) == 2
    (best,) = np.flatnonzero(results.optimum["front"])
    ratio, speed = (panel.lines[2].get_xdata() for panel in panels)
    assert ratio == pytest.approx([results.along("oil_supply.ratio")[best]])
    assert speed == pytest.approx([results.along("operation.speed")[best] / RPM])


def test_files_of_optimisations_have_these_figures_and_no_scatter_of_a_sample(sketched, files, tmp_path):
    written = {Path(path).name for path in plot(files["two"], tmp_path)}
    assert written == {"front.png", "front.pdf", "evaluations.png", "evaluations.pdf"}
    assert not list(samples.plans(open_results(files["two"])))


def read(text):
    """Return what a person reads of a page without its script: a line each of its head and its first table."""
    body = re.sub(r"<(script|style)\b.*?</\1>", "", text, flags=re.DOTALL)
    return " ".join(re.sub(r"<[^>]*>", " ", body).split())


def test_the_page_says_what_was_sought_and_shows_the_best(files):
    results = open_results(files["one"])
    words = read(page_of(results))
    (row,) = np.flatnonzero(results.optimum["front"])
    assert "Search for the highest gas mass flow, 120 evaluations" in words and "Sweep of" not in words
    assert "Best gas mass flow error oil-to-gas mass ratio male-rotor speed evaluation" in words
    speed = results.along("operation.speed")[row] * 30.0 / np.pi
    assert (
        f" {speed:.0f} rpm {row} The table" in words
        and "error: estimated numerical error of an aim, relative." in words
    )
    assert "screwsim run BEST.yaml --set output.keep=cycle" in words


def test_the_page_of_several_aims_shows_a_front_in_order(files):
    results = open_results(files["two"])
    words = read(page_of(results))
    assert "Search for the highest gas mass flow and lowest shaft power, 120 evaluations" in words
    found = best_table(results)
    numbers = [int(line[-1]) for line in found.rows]
    aim = results.optimum["aim_gas_mass_flow"][numbers]
    assert len(numbers) == 12 and np.all(results.optimum["front"][numbers] == 1) and np.all(np.diff(aim) >= 0.0)
    assert f"12 of the {int(results.optimum['front'].sum())} evaluations that no other beats in all aims" in words


def test_no_evaluation_within_the_bounds_is_told(tmp_path):
    how = {"subject_to": ["shaft_power<0.001 W"], "evaluations": 40, "output": tmp_path / "none.h5"}
    optimize(loads(SCENE), RANGES, ["gas_mass_flow"], [], simulate=choosing, jobs=1, **how)
    assert "No evaluation is within the bounds" in read(page_of(open_results(tmp_path / "none.h5")))


def test_a_scene_rated_over_points_has_nothing_to_draw(tmp_path):
    scene = screwsim.load(Path(__file__).parents[2] / "configs" / "r134a" / "point.yaml")
    optimize(scene, maximize="cop", over="IPLV", simulate=chiller, jobs=1, output=tmp_path / "x.h5")
    with pytest.raises(screwsim.UsageError, match=r"has nothing to draw: nothing was varied \(screwsim report makes"):
        plot(tmp_path / "x.h5")
