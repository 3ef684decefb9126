"""Figures in axes of one's own: what is drawn is what was computed, and what cannot be drawn says why."""

import math
import re
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure
from report_fakes import PUMP, ok
from result_fakes import SCENE

import screwsim
from screwsim import load, plot, simulate
from screwsim.build import build_parts
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.report import cycle
from screwsim.report import plot as draw_figures
from screwsim.report.overlay import draw_overlay
from screwsim.report.trace import chosen_trace, trace_of
from screwsim.results import save
from screwsim.scene import loads
from screwsim.study.sweep import run_sweep


@pytest.fixture
def axes():
    return Figure().subplots()


@pytest.fixture(scope="module")
def closed() -> Result:
    return ok(loads(SCENE), keep=True)


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    path = tmp_path_factory.mktemp("swept") / "x.h5"
    run_sweep(loads(PUMP), path, jobs=1, simulate=ok)
    return path


def legend(axes):
    return axes.get_legend().get_texts(), axes.get_legend().get_lines()


def test_the_loop_is_that_of_the_cycle(closed, axes):
    assert screwsim.plot.pv is plot.pressure_volume
    assert plot.pv(closed, ax=axes) is axes
    drawn = axes.get_lines()[0]
    np.testing.assert_allclose(drawn.get_ydata(), closed.cycle["pressure"] * 1e-5)
    np.testing.assert_allclose(drawn.get_xdata(), closed.cycle["volume"] * 1e6)
    assert axes.get_xlabel() and axes.get_ylabel()


@pytest.mark.parametrize(("draw", "over"), [(plot.pv, "volume"), (plot.pressure, "angle")])
def test_measured_pressures_lie_where_the_cycle_has_their_angle(closed, axes, tmp_path, draw, over):
    (tmp_path / "p.csv").write_text("angle_deg,pressure_bar\n400,1.5\n600,6\n", encoding="utf-8")
    draw(closed, ax=axes, measured=tmp_path / "p.csv")
    (points,) = (line for line in axes.get_lines() if line.get_label() == "measured")
    factor = 1e6 if over == "volume" else 1.0
    there = np.interp([400.0, 600.0], closed.cycle["angle"], closed.cycle[over]) * factor
    np.testing.assert_allclose(points.get_xdata(), there)
    np.testing.assert_allclose(points.get_ydata(), [1.5, 6.0])
    assert [text.get_text() for text in legend(axes)[0]] == ["measured"]


def test_measured_pressures_that_cannot_be_read_leave_the_axes_empty(closed, axes, tmp_path):
    (tmp_path / "p.csv").write_text("angle,pressure\n400,1.5\n", encoding="utf-8")
    with pytest.raises(UsageError, match="needs angle_deg or one volume"):
        plot.pv(closed, ax=axes, measured=tmp_path / "p.csv")
    assert not axes.get_lines()


def test_two_loops_in_the_same_axes_are_told_apart(closed, axes):
    first, second = ({"label": "A"}, {"label": "B", "color": "red", "linestyle": "--"})
    for draw in (plot.pv, plot.pressure):
        axes.clear()
        draw(closed, ax=axes, **first)
        draw(closed, ax=axes, **second)
        named = {line.get_label(): line for line in axes.get_lines()}
        assert (named["B"].get_color(), named["B"].get_linestyle()) == ("red", "--") != (named["A"].get_color(), "-")
        np.testing.assert_allclose(named["B"].get_ydata(), closed.cycle["pressure"] * 1e-5)
        assert [text.get_text() for text in legend(axes)[0]] == ["A", "B"]


def test_two_loops_of_which_one_has_no_label_are_both_named(closed, axes):
    plot.pv(closed, ax=axes)
    assert axes.get_legend() is None
    plot.pv(closed, ax=axes, label="B")
    assert [text.get_text() for text in legend(axes)[0]] == ["cycle 1", "B"]


def test_loops_of_files_have_their_names(closed, axes, tmp_path):
    for name in ("one", "other"):
        save(tmp_path / f"{name}.h5", load("configs/paper/point.yaml"), closed)
        plot.pv(tmp_path / f"{name}.h5", ax=axes)
    assert [text.get_text() for text in legend(axes)[0]] == ["one", "other"]


def test_lines_that_two_loops_share_are_named_once(axes):
    result = simulate(load("configs/paper/point.yaml", ["numerics.accuracy=1e-2", "numerics.error=none"]), trace=True)
    plot.pv(result, ax=axes, label="A")
    plot.pv(result, ax=axes, label="B")
    assert sorted(text.get_text() for text in axes.texts if text.get_text().startswith("$p_")) == ["$p_d$", "$p_s$"]


def test_a_property_that_lines_do_not_have_is_refused_before_anything_is_drawn(closed, axes):
    with pytest.raises(AttributeError, match="colour"):
        plot.pv(closed, ax=axes, colour="red")
    assert not axes.get_lines()


def test_the_port_of_rotors_is_marked_where_it_opens(tmp_path):
    """Between the samples of a trace, which are a degree apart: the mark tells tenths of it."""
    scene = load("configs/rotors/b.yaml", ["numerics.accuracy=1e-2", "numerics.error=none"])
    save(tmp_path / "x.h5", scene, simulate(scene, trace=True))
    trace = chosen_trace(screwsim.open_results(tmp_path / "x.h5"))
    opens = build_parts(scene).geometry.discharge_opens
    assert trace is not None and opens is not None
    assert trace.marks["port opens"] == pytest.approx(math.degrees(opens), abs=0.05)


@pytest.mark.parametrize("draw", [plot.pressure, plot.temperatures, plot.mass_flows])
def test_curves_over_the_angle_span_it(draw, closed, axes):
    draw(closed, ax=axes)
    assert axes.get_xlim() == (0.0, 720.0) and axes.get_xlabel()


def test_both_sides_of_a_gap_are_told_apart(closed, axes):
    plot.mass_flows(closed, ax=axes)
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == ["suction port", "discharge port", "tip leakage, leading", "tip leakage, trailing"]


def test_a_path_without_flow_is_left_out_and_named(closed, axes):
    still = {f"mass_flow_slide_valve_{side}": np.zeros_like(closed.cycle["angle"]) for side in ("leading", "trailing")}
    result = replace(closed, cycle={**closed.cycle, **still})
    plot.mass_flows(result, ax=axes)
    assert not [text for text in legend(axes)[0] if "slide valve" in text.get_text()]
    figure = cycle._flows(trace_of(result))
    assert "no flow: slide valve" in figure.get_suptitle()
    assert [each.get_title(loc="left") for each in figure.axes] == ["suction port", "discharge port", "tip leakage"]


def test_a_leak_is_seen_beside_a_port_of_much_larger_flow(closed, axes):
    plot.mass_flows(closed, ax=axes)
    (leak,) = (line for line in axes.get_lines() if line.get_label() == "tip leakage, leading")
    top = axes.transAxes.inverted().transform(axes.transData.transform(leak.get_xydata()))[:, 1]
    assert np.ptp(top) > 0.1, "of the axes' height; the leak is a hundredth of the port's flow"


def test_a_sweep_is_a_curve_a_speed(swept, axes):
    plot.curves(swept, "shaft power", ax=axes)
    told = {text.get_text(): line.get_color() for text, line in zip(*legend(axes), strict=True)}
    assert len(told) == len(set(told.values())) == 5
    drawn = [line for line in axes.get_lines() if len(line.get_ydata())]
    lowest = min(drawn, key=lambda line: float(np.max(line.get_ydata())))
    np.testing.assert_allclose(lowest.get_ydata(), 10.0 * 250.0 * np.pi / 30.0 * 1e-3)  # kW at 250 rpm


def test_contours_have_a_scale(swept, axes):
    plot.contours(swept, ax=axes)
    assert len(axes.figure.axes) == 2


def test_contours_of_a_figure_that_no_case_has_are_refused(swept):
    with pytest.raises(screwsim.UsageError, match="has no values of cooling_capacity"):
        plot.contours(swept, "cooling_capacity")


def test_settings_of_the_caller_stay(closed, axes):
    before = dict(matplotlib.rcParams)
    plot.pv(closed, ax=axes)
    assert dict(matplotlib.rcParams) == before


@pytest.mark.parametrize(
    ("draw", "given", "says"),
    [
        (plot.pv, 3, "int cannot be drawn (pass a Result"),
        (plot.pv, Result("ok"), "the result has no cycle to draw (use simulate(scene, trace=True))"),
        (plot.pv, Result("failed", "gone"), "the result has no cycle to draw (the case failed: gone)"),
    ],
)
def test_what_cannot_be_drawn_says_why(draw, given, says):
    with pytest.raises(screwsim.UsageError) as error:
        draw(given)
    assert str(error.value).startswith(says)


def test_axes_must_be_axes(closed):
    with pytest.raises(screwsim.UsageError, match="ax is str"):
        plot.pv(closed, ax="left")


def test_an_unknown_figure_is_told_with_those_there(swept, axes):
    with pytest.raises(screwsim.UsageError, match="--figure powr"):
        plot.curves(swept, "powr", ax=axes)


def test_units_stand_in_parentheses_behind_what_they_are_of():
    """As in most drawings of the package: no label has its unit in square brackets, which mean 'the unit of'."""
    import ast
    from pathlib import Path

    import screwsim.report as package

    bracketed = []
    for path in sorted(Path(package.__file__).parent.glob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        documents = {id(each.value) for each in ast.walk(tree) if isinstance(each, ast.Expr)}
        texts = [each for each in ast.walk(tree) if isinstance(each, ast.Constant) and id(each) not in documents]
        shown = [each.value for each in texts if isinstance(each.value, str)]
        bracketed += [f"{path.name}: {text}" for text in shown if re.search(r"[\w$}±] \[[^\]\[]+\]", text)]
    assert not bracketed


def test_a_sweep_of_which_one_point_of_an_axis_closed_has_no_curve_and_says_so(tmp_path):
    def slow_only(scene):
        return ok(scene) if scene.operation.speed < 150.0 else Result("failed", message="too fast (choose a lower one)")

    path = tmp_path / "x.h5"
    swept = "sweep: {operation.speed: [1000 rpm, 3000 rpm], numerics.accuracy: [1e-3, 1e-4]}\n"
    run_sweep(loads(SCENE + swept), path, jobs=1, simulate=slow_only)
    one = screwsim.open_results(path)
    assert draw_overlay(one, one, tmp_path) == []
    with pytest.raises(screwsim.UsageError, match="no two points along an axis closed, 2 of 4 cases did not"):
        draw_figures(path, tmp_path)


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """Return a file of three speeds with their cycles."""
    path = tmp_path_factory.mktemp("kept") / "kept.h5"
    scene = loads(SCENE).with_({"sweep.operation.speed": ["1000 rpm", "2000 rpm", "3000 rpm"], "output.keep": "cycle"})
    run_sweep(scene, path, jobs=1)
    return screwsim.open_results(path)


@pytest.mark.parametrize("number", range(3))
def test_the_cycle_of_the_case_that_is_asked_for_is_drawn(kept, number):
    axes = Figure().subplots()
    plot.pv(kept.showing({"operation.speed": f"{number + 1}000 rpm"}), ax=axes)
    np.testing.assert_allclose(axes.get_lines()[0].get_ydata(), kept.cycle["pressure"][number] * 1e-5)


def test_marks_of_a_second_loop_do_not_lie_on_those_of_the_first(kept, axes):
    plot.pv(kept.showing({"operation.speed": "1000 rpm"}), ax=axes, label="slow")
    told = [text.get_text() for text in axes.texts]
    plot.pv(kept.showing({"operation.speed": "3000 rpm"}), ax=axes, label="fast")
    marks = [text for text in (text.get_text() for text in axes.texts) if "°" in text]
    assert marks == [text for text in told if "°" in text] != []


def test_one_case_is_not_called_the_best(kept):
    assert chosen_trace(kept).title.startswith("best case: ")
    assert not chosen_trace(kept.showing({"operation.speed": "1000 rpm"})).title.startswith("best case")


def test_a_case_whose_cycle_is_not_there_is_told(tmp_path):
    def slow_only(scene):
        fast = scene.operation.speed > 150.0
        return Result("failed", message="too fast (choose a lower one)") if fast else screwsim.simulate(scene)

    scene, path = loads(SCENE).with_({"sweep.operation.speed": ["1000 rpm", "3000 rpm"]}), tmp_path / "x.h5"
    run_sweep(scene.with_({"output.keep": "cycle"}), path, jobs=1, simulate=slow_only)
    with pytest.raises(screwsim.UsageError, match=r"holds no cycle of this case, which failed \(choose another\)"):
        draw_figures(path, tmp_path, at={"operation.speed": "3000 rpm"})
    run_sweep(scene, tmp_path / "y.h5", jobs=1, simulate=ok)
    with pytest.raises(screwsim.UsageError, match=r"holds no cycle of a case to draw \(write output.keep: cycle"):
        draw_figures(tmp_path / "y.h5", tmp_path, at={"operation.speed": "3000 rpm"})


@pytest.fixture(scope="module")
def two_files(tmp_path_factory):
    """Return two files of one figure over the speed, the second of other speeds and gaps."""
    folder = tmp_path_factory.mktemp("two")
    for name, speeds in (("narrow", ["1000 rpm", "2000 rpm"]), ("wide", ["1500 rpm", "4000 rpm"])):
        run_sweep(loads(SCENE).with_({"sweep.operation.speed": speeds}), folder / f"{name}.h5", jobs=1, simulate=ok)
    return folder / "narrow.h5", folder / "wide.h5"


def test_curves_of_two_files_in_the_same_axes_are_told_apart_and_fit_into_them(two_files, axes):
    for path in two_files:
        plot.curves(path, "shaft_power", ax=axes)
    texts, lines = legend(axes)
    assert [text.get_text() for text in texts] == ["narrow", "wide"]
    assert len({line.get_color() for line in lines}) == 2
    assert axes.get_xlim() == pytest.approx((1000.0, 4000.0))


def test_a_curve_has_the_properties_that_are_given(two_files, axes):
    plot.curves(two_files[0], "shaft_power", ax=axes, c="red", lw=3.0, label="narrow gaps")
    line = axes.get_lines()[0]
    assert (line.get_color(), line.get_linewidth()) == ("red", 3.0)
    assert [text.get_text() for text in legend(axes)[0]] == ["narrow gaps"]
    with pytest.raises(AttributeError):
        plot.curves(two_files[0], "shaft_power", ax=axes, colour="red")


def test_properties_of_one_line_are_refused_for_several_curves(swept, axes):
    with pytest.raises(screwsim.UsageError, match=r"^color: there are \d+ curves \(leave it out, or sweep one path\)$"):
        plot.curves(swept, ax=axes, color="red")
