"""Figures of stored results: what is drawn, that all text is legible, the same bytes again, faults in one line."""

import itertools
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from each_row import each_row
from report_fakes import (
    BEST_RATIO,
    LEDGER,
    PUMP,
    RATIOS,
    SPEED,
    SPEEDS,
    WARNING,
    cooling,
    cycle,
    design,
    expanding,
    file,
    ok,
    some_fail,
    some_warn,
    with_cycle,
    with_ledger,
    without_warnings,
)
from result_fakes import CYCLE, SCENE

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.report import cycle as cycle_figures
from screwsim.report import ledger, maps, plot, samples, sweeps
from screwsim.report.annotate import spread
from screwsim.report.families import optimum, optimum_arc, outcome_family
from screwsim.report.quantities import SPEED as SPEED_SHOWN
from screwsim.report.quantities import shown_axis
from screwsim.report.style import COLOURS, DOUBLE, MM, SINGLE, journal, line_style
from screwsim.report.trace import chosen_trace
from screwsim.results import Results, open_results, warning_kinds
from screwsim.scene import load, loads
from screwsim.study.sweep import run_sweep

pytestmark = pytest.mark.around

PACKAGE = Path(__file__).parents[2] / "configs" / "air" / "variable_speed_7.yaml"
THREE = SCENE + "sweep:\n" + SPEEDS + RATIOS + "  operation.discharge.pressure: [10 bar, 14 bar]\n"
MANY = (
    SCENE
    + "sweep:\n  operation.speed: {from: 500 rpm, to: 5000 rpm, count: 40, spacing: linear}\n"
    + RATIOS.replace("20", "7")
)
GAP = SCENE + "sweep:\n  effects.tip_leakage.gap: [10 um, 20 um, 50 um]\n  operation.suction.pressure: [1 bar, 2 bar]\n"
ORIFICES = SPEED + "  oil_supply.orifice_diameter: [2 mm, 3 mm]\n"
SLOW = SCENE.replace("speed: 3000 rpm", "speed: 900 rpm").replace("ratio: 3", "ratio: 4")
FIVE = SCENE + "sweep:\n" + SPEEDS + RATIOS.replace("20", "5")
LINEAR = SCENE + "sweep:\n  oil_supply.ratio: {from: 0.5, to: 3, count: 6, spacing: linear}\n"


def spike(case):
    """Return a cycle whose last degree reaches 150 bar."""
    return Result("ok", performance=ok(case).performance, cycle=cycle(150e5))


FILES = {
    "pump": (PUMP, ok, ["efficiency", "performance", "map"]),
    "some cases fail": (PUMP, some_fail, ["efficiency", "performance", "map"]),
    "speed": (SPEED, ok, ["efficiency_ratio"]),
    "speed and orifice": (ORIFICES, ok, ["efficiency_ratio"]),
    "three axes": (THREE, ok, ["efficiency_1", "performance_1", "efficiency_2", "performance_2", "map_1", "map_2"]),
    "forty curves": (MANY, ok, ["efficiency", "performance", "map"]),
    "gap and pressure": (GAP, ok, ["efficiency", "performance"]),
    "one axis": (LINEAR, ok, ["efficiency", "performance"]),
    "one run": (SCENE, with_cycle, ["pressure_volume", "states", "mass_flows"]),
    "a ledger": (SCENE, with_ledger, ["pressure_volume", "states", "mass_flows", "shaft_power"]),
    "an expander": (SCENE, expanding, ["pressure_volume", "states", "mass_flows", "shaft_power"]),
    "a run that warns": (SLOW, some_warn, ["pressure_volume", "states", "mass_flows", "shaft_power"]),
    "a sweep that warns": (
        FIVE + CYCLE,
        some_warn,
        ["efficiency", "performance", "map", "pressure_volume", "states", "mass_flows", "shaft_power"],
    ),
    "refrigeration": (FIVE, cooling, ["efficiency", "performance", "map", "map_cooling_capacity", "map_cop"]),
    "a spike": (SCENE, spike, ["pressure_volume", "states", "mass_flows"]),
    "sweep with cycles": (
        LINEAR + CYCLE,
        with_cycle,
        ["efficiency", "performance", "pressure_volume", "states", "mass_flows"],
    ),
}


def drawn(path: Path, results: Results | None = None, only: str | None = None) -> dict:
    """Return the figures of a file, or only one of them, drawn."""
    results = results or open_results(path)
    figures = {}
    with journal():
        for name, draw in (
            *sweeps.plans(results),
            *maps.plans(results),
            *samples.plans(results),
            *cycle_figures.plans(results),
            *ledger.plans(results),
        ):
            if only not in (None, name):
                continue
            figures[name] = draw()
            figures[name].draw_without_rendering()
    return figures


def texts(figure) -> list:
    """Return the (text, box [pixel]) of every visible text of a figure; boxes without leaders."""
    from matplotlib.text import Text

    found = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text()]
    ticks = {id(label) for axes in figure.axes for label in (*axes.get_xticklabels(), *axes.get_yticklabels())}
    inside = {id(label) for axes in figure.axes for label in _shown_ticks(axes)}
    return [(t.get_text(), Text.get_window_extent(t)) for t in found if id(t) not in ticks or id(t) in inside]


def _shown_ticks(axes) -> list:
    """Return the labels of the ticks within the limits; matplotlib keeps, and hides, those beyond."""
    shown = []
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        low, high = min(limits), max(limits)
        slack = 1e-9 * (high - low)
        shown += [tick.label1 for tick in axis.get_major_ticks() if low - slack <= tick.get_loc() <= high + slack]
    return shown


@pytest.fixture(scope="module")
def of_kind(tmp_path_factory):
    """Return a function that gives the figures of one kind of file, drawn once for all tests."""

    @cache
    def draw(kind: str) -> dict:
        text, simulate, _ = FILES[kind]
        return drawn(file(tmp_path_factory.mktemp("report") / "x.h5", text, simulate))

    return draw


@pytest.fixture(scope="module", params=FILES)
def figures(request, of_kind):
    """Return the names that are expected and the figures of one kind of file."""
    return FILES[request.param][2], of_kind(request.param)


@pytest.fixture(scope="module")
def plotted(tmp_path_factory) -> tuple[Path, list[Path]]:
    """Return a file and the figures that were written of it, no folder being named."""
    path = file(tmp_path_factory.mktemp("plotted") / "x.h5", SCENE, with_cycle)
    return path, [Path(name) for name in plot(path)]


def test_a_file_gives_the_figures_it_has_data_for(figures):
    names, found = figures
    assert list(found) == names


def test_an_oil_ratio_is_an_outcome_where_it_follows_the_speed_and_not_where_it_is_stated(tmp_path):
    of = outcome_family(open_results(file(tmp_path / "displaced.h5", SPEED)))
    assert of is not None and of.x_axis.path == "operation.speed"
    stated = SCENE + "sweep:\n" + SPEEDS
    assert outcome_family(open_results(file(tmp_path / "pumped.h5", stated))) is None


def test_a_package_is_drawn_over_its_speed_although_its_oil_ratio_follows(tmp_path):
    def packaged(case):
        own = {"package_input_power": 1e5, "package_specific_power": 4e5, "free_air_delivered": 1e-3}
        return Result("ok", performance=Figures({**ok(case).performance, **own}))

    run_sweep(load(PACKAGE), tmp_path / "x.h5", jobs=1, simulate=packaged)
    figures = drawn(tmp_path / "x.h5")
    assert list(figures) == ["efficiency", "performance"]
    labels = [axes.get_xlabel() for figure in figures.values() for axes in figure.axes]
    assert set(labels) == {SPEED_SHOWN.label}
    named = {axes.get_ylabel() for axes in figures["performance"].axes}
    assert any("free air delivered" in each for each in named)
    assert "package specific power\n(kW/(m³/min))" in named  # the machine's own specific power is another figure
    figure = figures["performance"]
    for axes in figure.axes:  # as long as the axis at most
        label, panel = axes.yaxis.label.get_window_extent(), axes.get_window_extent()
        assert label.height < 1.02 * panel.height, axes.get_ylabel()


@pytest.mark.parametrize("simulate", [ok, some_fail, with_cycle])
def test_a_design_is_drawn_as_points_over_each_quantity(tmp_path, simulate):
    path = file(tmp_path / "x.h5", LINEAR.replace("0.5", "0.05") + CYCLE, simulate)
    figures = drawn(path, design(path))
    kept = ["pressure_volume", "states", "mass_flows"] if simulate is with_cycle else []
    assert list(figures) == ["samples", *kept]
    labels = [axes.get_xlabel() for axes in figures["samples"].axes]
    assert [label.rpartition(" ")[2] for label in labels] == ["(kg/kg)", "(rpm)", "(°C)"]
    for figure in figures.values():
        width, height = figure.canvas.get_width_height()
        boxes = [box for _, box in texts(figure)]
        assert all(box.x0 >= 0 and box.y0 >= 0 and box.x1 <= width and box.y1 <= height for box in boxes)


def test_points_of_a_design_tell_the_fluids_apart(tmp_path):
    """Cases that vary together with the fluid, or for each fluid, have its name in the legend and its colour."""
    axes = "\nsweep:\n  zip:\n    - operation.speed: [1000 rpm, 2000 rpm]\n      oil_supply.ratio: [1, 2]\n"
    path = file(tmp_path / "x.h5", SCENE.partition("\nsweep:")[0] + axes + "  gas.fluid: [Air, Nitrogen]\n", ok)
    (figure,) = drawn(path).values()
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["Air", "Nitrogen"]
    for place in figure.axes:
        found = {line.get_label(): line for line in place.get_lines() if len(line.get_xdata())}
        assert len(found["Air"].get_xdata()) == len(found["Nitrogen"].get_xdata()) == 2
        assert found["Air"].get_color() != found["Nitrogen"].get_color()


def test_no_text_leaves_the_canvas(figures):
    for name, figure in figures[1].items():
        width, height = figure.canvas.get_width_height()
        for text, box in texts(figure):
            assert box.x0 >= 0 and box.y0 >= 0 and box.x1 <= width and box.y1 <= height, (name, text)


def test_no_text_overlaps_another(figures):
    for name, figure in figures[1].items():
        for (a, box_a), (b, box_b) in itertools.combinations(texts(figure), 2):
            overlap = (
                min(box_a.x1, box_b.x1) - max(box_a.x0, box_b.x0),
                min(box_a.y1, box_b.y1) - max(box_a.y0, box_b.y0),
            )
            # a box is as high as its tallest letter's line: 1 px of common air is no contact
            assert min(overlap) <= 1.0, (name, a, b)


def test_no_legend_covers_a_panel(figures):
    for figure in figures[1].values():
        legends = [axes.get_legend() for axes in figure.axes if axes.get_legend()] + figure.legends
        for legend, axes in itertools.product(legends, figure.axes):
            box, panel = legend.get_window_extent(), axes.get_window_extent()
            assert box.y0 >= panel.y1 - 1.0 or not box.overlaps(panel)


def test_a_figure_is_one_or_two_columns_wide(figures):
    for figure in figures[1].values():
        assert figure.get_figwidth() in (SINGLE * MM, DOUBLE * MM)


def test_every_axis_has_a_label_with_a_unit_or_shares_it(figures):
    for figure in figures[1].values():
        labels = [axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes]
        shared = figure.get_supxlabel() + figure.get_supylabel()
        assert all("(" in (label or shared) for label in labels)


def test_figures_lie_beside_the_file_in_a_folder_of_its_name(plotted):
    path, written = plotted
    assert sorted(path.with_suffix("").iterdir()) == sorted(written)
    assert written[0].read_bytes()[:4] == b"\x89PNG" and written[1].read_bytes()[:4] == b"%PDF"


def test_the_same_data_give_the_same_bytes_whatever_the_caller_has_set(plotted, tmp_path):
    import matplotlib

    path, written = plotted
    with matplotlib.rc_context({"font.size": 31.0}):
        again = [Path(name) for name in plot(path, tmp_path / "a")]
        assert matplotlib.rcParams["font.size"] == 31.0
    assert [other.name for other in again] == [one.name for one in written] and len(again) == 8
    for one, other in zip(written, again, strict=True):
        assert one.read_bytes() == other.read_bytes(), other.name


def test_the_optimum_of_a_parabola_in_ln_d_is_exact():
    x = np.geomspace(0.1, 10.0, 7)
    found = optimum(x, 0.6 - 0.03 * np.log(x / BEST_RATIO) ** 2)
    assert found == pytest.approx((BEST_RATIO, 0.6), rel=1e-12)  # the interpolation is of that very form


def test_the_arc_of_an_optimum_goes_through_the_three_best_points():
    x, y = np.geomspace(0.5, 8.0, 5), np.array([3.0, 4.0, 3.7, 2.0, 1.0])
    found, top = optimum_arc(x, y), optimum(x, y)
    assert found is not None and top is not None
    places, heights = found
    assert (places[0], places[-1]) == pytest.approx((x[0], x[2]), rel=1e-12)
    assert np.interp(np.log(x[:3]), np.log(places), heights) == pytest.approx(y[:3], rel=1e-12)
    assert heights.max() == pytest.approx(top[1], rel=1e-4)  # the nearest of its points
    assert optimum_arc(x, np.arange(5.0)) is None


def test_every_optimum_lies_on_a_drawn_line(tmp_path):
    """Of five points a curve: the circle is the top of a parabola, which is drawn."""
    axes = drawn(file(tmp_path / "x.h5", FIVE, ok), only="efficiency")["efficiency"].axes[0]
    circles = [line for line in axes.lines if line.get_marker() == "o"]
    curves = [axes.transData.transform(line.get_xydata()) for line in axes.lines if line.get_linestyle() != "None"]
    assert len(circles) == 5
    for circle in circles:
        (at,) = axes.transData.transform(circle.get_xydata())
        assert min(_distance(at, curve) for curve in curves if len(curve) > 1) < 0.5, "pixel"


@each_row(
    ("path", "values", "circles"),
    [
        ("oil_supply.ratio", "[1, 1.7, 3]", 1),
        ("operation.speed", "[1000 rpm, 2000 rpm, 3000 rpm]", 1),
        ("operation.discharge.pressure", "[10 bar, 12 bar, 14 bar]", 0),
        ("operation.suction.temperature", "[10 degC, 20 degC, 30 degC]", 0),
    ],
)
def test_optima_are_marked_over_what_one_chooses_never_over_operating_conditions(path, values, circles, tmp_path):
    numbers = iter([0.5, 0.6, 0.55])

    def peaked(scene):
        return Result("ok", performance=Figures(isothermal_efficiency=next(numbers)))

    swept = SCENE + f"sweep: {{{path}: {values}}}\n"
    axes = drawn(file(tmp_path / "x.h5", swept, peaked), only="efficiency")["efficiency"].axes[0]
    assert len([line for line in axes.lines if line.get_marker() == "o"]) == circles


def _distance(point, curve) -> float:
    """Return the distance of a point from a polyline."""
    a, b = curve[:-1], curve[1:]
    along = np.clip(((point - a) * (b - a)).sum(axis=1) / ((b - a) ** 2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(*(a + along[:, None] * (b - a) - point).T).min())


def test_contours_of_few_values_keep_a_ridge_whole():
    """A ridge along the diagonal of five by five values: straight lines between them make islands of it."""
    places = np.linspace(0.0, 1.0, 5)
    ridge = lambda x, y: 80.0 - 40.0 * (x - y) ** 2  # noqa: E731 - a formula
    x, y, z = maps._refined(places, places, np.ma.array(ridge(*np.meshgrid(places, places))))
    assert np.interp(places, x, np.arange(len(x))) == pytest.approx(np.searchsorted(x, places))  # all values stay
    assert z == pytest.approx(ridge(*np.meshgrid(x, y)), abs=1e-9)  # a bicubic has it exactly


def test_contours_of_few_values_invent_no_summit():
    """Through values at 500, 1000 and 3000 rpm that rise ever slower a parabola has its summit between the last two."""
    speeds, ratios = np.array([500.0, 1000.0, 3000.0]), np.arange(1.0, 5.0)
    values = np.add.outer(np.array([53.0, 68.0, 79.0]), -0.1 * ratios)
    _, fine, z = maps._refined(ratios, speeds, np.ma.array(values))
    assert z.max() == pytest.approx(values.max()) and z.min() == pytest.approx(values.min())
    assert np.all(np.diff(z, axis=0) > 0.0)
    assert z[np.searchsorted(fine, speeds)][:, [0, -1]] == pytest.approx(values[:, [0, -1]])


def test_contours_of_few_values_invent_no_valley():
    """Between 2000 and 4000 rpm a bicubic falls far, where the values rise: within them all, and yet not computed."""
    speeds, ratios = np.array([500.0, 1000.0, 2000.0, 4000.0]), np.array([0.5, 1.0, 2.0])
    values = np.outer([54.0, 69.0, 77.0, 81.0], [0.99, 1.0, 0.98])
    _, _, z = maps._refined(ratios, speeds, np.ma.array(values))
    assert np.all(np.diff(z, axis=0) > 0.0)


def test_a_map_with_gaps_or_of_many_values_stays_as_it_is():
    places, many = np.arange(1.0, 6.0), np.arange(1.0, 101.0)
    gap = np.ma.masked_less(np.add.outer(places, places), 3.0)
    assert maps._refined(places, places, gap)[2] is gap
    assert maps._refined(many, places, np.ma.array(np.add.outer(places, many)))[0] is many


# of the colour-blind in linear RGB: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE TVCG 15 (2009) 1291
SIGHT = {
    "normal": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
}


def _lab(colour, sight) -> np.ndarray:
    """Return CIE L*a*b* of a colour as someone sees it."""
    from matplotlib.colors import to_rgb

    rgb = np.array(to_rgb(colour))
    linear = np.clip(sight @ np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4), 0.0, 1.0)
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    x, y, z = np.cbrt(np.maximum(to_xyz @ linear / np.array([0.9505, 1.0, 1.089]), 1e-6))
    return np.array([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize("count", [2, 3, 4, 5, 6])
def test_curves_are_told_apart_by_any_eye(sight, count):
    """Ten steps of a just noticeable difference and more (ΔE*ab 2.3), between all curves; dashes come on top."""
    colours = [_lab(line_style(i, count)["color"], np.array(SIGHT[sight])) for i in range(count)]
    least = min(np.hypot.reduce(a - b) for a, b in itertools.combinations(colours, 2))
    assert least > (40.0 if sight == "normal" else 13.0)
    assert all(a[0] < b[0] for a, b in itertools.pairwise(colours))  # lighter and lighter


def test_many_curves_get_lighter_and_lighter():
    lightness = [_lab(line_style(i, 12)["color"], np.eye(3))[0] for i in range(12)]
    assert np.all(np.diff(lightness) > 2.0) and len(COLOURS) < 12


def test_the_ledger_of_an_expander_leads_from_the_gas_to_the_shaft():
    bars = ledger.waterfall_bars(expanding_ledger())
    assert (bars[0].words, bars[-1].words) == ("exergy given by the gas", "power at the shaft")
    assert all(bar.total for bar in (bars[0], bars[-1])) and bars[0].power > 0.0 < bars[-1].power
    assert bars[0].power - sum(bar.power for bar in bars[1:-1]) == pytest.approx(
        bars[-1].power, abs=3.2
    )  # of small ones


def expanding_ledger():
    return Figures(LEDGER, shaft_power=-2200.0, gas_exergy_rise=-3141.0, oil_exergy_rise=-58.9)


def test_figures_tell_of_warnings(of_kind):
    for figure in of_kind("a run that warns").values():
        caption = figure.get_suptitle().replace("\n", " ")
        assert "2 warnings, the first: the estimated error of shaft_power, 0.0012" in caption
    swept = of_kind("a sweep that warns")
    marked = "△ with warnings (15)"
    for name, told in (("efficiency", marked), ("performance", marked), ("map", "15 cases with warnings")):
        assert told in swept[name].get_suptitle().replace("\n", " "), name
    triangles = [line for line in swept["efficiency"].axes[0].lines if line.get_marker() == "^"]
    assert sum(len(line.get_xdata()) for line in triangles) == 15  # three speeds of five ratios


def test_a_map_tells_how_far_numerical_errors_move_it(of_kind, tmp_path):
    def estimated(case):
        found = ok(case).performance
        return Result("ok", performance=found, error=Figures(dict.fromkeys(found, 1e-3)))

    run_sweep(loads(PUMP), tmp_path / "x.h5", jobs=1, simulate=estimated)
    results = open_results(tmp_path / "x.h5")
    most = 100.0 * 1e-3 * float(results.performance["isothermal_efficiency"].max())
    assert note_of(dict(maps.plans(results))["map"]()).endswith(f"numerical error at most {most:.1g} points")
    assert "numerical" not in note_of(of_kind("pump")["map"])  # whose errors were not estimated


def test_of_many_curves_a_few_are_drawn_with_both_ends(of_kind):
    figure = of_kind("forty curves")["efficiency"]
    assert note_of(figure).startswith("9 of 40 curves")
    labels = [text.get_text() for text in figure.axes[0].texts]
    assert len([text for text in labels if text[0].isdigit()]) == 9 and {"500", "5000"} <= set(labels)


def test_a_caption_is_cut_between_words():
    text = warning_kinds.warning_caption(["word " * 30 + "12.5"])
    assert text.endswith("word …") and len(text) < warning_kinds.LONGEST + 12
    assert warning_kinds.warning_caption([]) == "" and warning_kinds.warning_caption([WARNING]) == f"warning: {WARNING}"


def test_a_file_that_keeps_no_warnings_is_drawn_as_one_without(tmp_path):
    path = without_warnings(file(tmp_path / "x.h5", SLOW, some_warn))
    assert {figure.get_suptitle() for figure in drawn(path, only="states").values()} == {""}
    assert (
        not warning_kinds.cases_with_warnings(open_results(path)).any()
        and warning_kinds.warning_kinds(open_results(path)) == ()
    )


@pytest.mark.parametrize("y", [[1.0, 2.0, 3.0], [3.0, 2.0, 1.0], [1.0, 2.0]])
def test_an_optimum_at_an_end_is_none(y):
    assert optimum(np.arange(1.0, 1.0 + len(y)), np.array(y)) is None


def test_labels_spread_keep_their_order_and_distance():
    wanted = np.array([0.5, 0.1, 0.52, 0.49, 0.99, 1.0])
    places = spread(wanted, 0.1, 0.0, 1.0)
    assert np.array_equal(np.argsort(places), np.argsort(wanted))
    assert np.diff(np.sort(places)).min() >= 0.1 - 1e-12 and places.min() >= 0.0 and places.max() <= 1.0


def test_the_waterfall_goes_from_the_shaft_power_to_the_gas():
    bars = ledger.waterfall_bars(LEDGER)
    assert [bar.words for bar in bars] == [
        "shaft power",
        "tip leakage",
        "discharge port",
        "oil supply",
        "exergy rise of the oil",
        "exergy rise of the gas",
    ]
    spent = sum(bar.power for bar in bars if not bar.total)
    small = 1.0 + 1.9 + 0.1  # entries below a thousandth, and the residual
    assert bars[0].power - spent - bars[-1].power == pytest.approx(small, rel=1e-9)


def note_of(figure) -> str:
    """Return the note above a figure, in one line."""
    return " ".join(figure.get_suptitle().split())


@pytest.mark.parametrize(("entry", "told"), [(-500.0, True), (500.0, False)])
def test_a_bar_that_gives_back_is_explained_by_its_colour(entry, told):
    found = {**LEDGER, "exergy_destroyed_oil_supply": entry}
    assert ("green: recovers what other entries count as lost" in note_of(ledger._draw(found, "x"))) == told


def test_cases_left_out_are_counted(of_kind):
    note = note_of(of_kind("some cases fail")["efficiency"])
    assert "10 of 100 cases without a result left out" in note and "not closed (5)" in note


def test_a_spike_beyond_the_axis_is_told(of_kind):
    assert "peak of 150 bar at 720° not shown" in note_of(of_kind("a spike")["pressure_volume"])


def test_the_isentropic_efficiency_stands_in_for_the_isothermal(tmp_path):
    def real_gas(case):
        figures = Figures(ok(case).performance, isothermal_efficiency=None)
        return Result("ok", performance=figures)

    axes = drawn(file(tmp_path / "x.h5", PUMP, real_gas), only="efficiency")["efficiency"].axes[0]
    assert axes.get_ylabel().startswith("isentropic efficiency")


def failed(case):
    return Result("failed", message="pressure left the range at 123°\nand more")


@pytest.mark.parametrize(
    ("text", "simulate", "why"),
    [(SCENE, failed, "pressure left"), (SCENE, ok, "no cycle"), (PUMP, failed, "all cases failed")],
)
def test_nothing_to_draw_is_said_in_one_line(tmp_path, text, simulate, why):
    path = file(tmp_path / "x.h5", text, simulate)
    with pytest.raises(UsageError, match=why) as fault:
        plot(path)
    assert "\n" not in str(fault.value) and not (tmp_path / "x").exists()


def test_a_folder_that_cannot_be_made_is_said_in_one_line(tmp_path):
    path = file(tmp_path / "x.h5", SPEED)
    with pytest.raises(UsageError, match="cannot be written") as fault:
        plot(path, path / "figures")  # below a file
    assert "\n" not in str(fault.value)


def test_a_file_of_another_program_is_refused(tmp_path):
    (tmp_path / "x.h5").write_text("no HDF5")
    with pytest.raises(UsageError, match="not an HDF5 file"):
        plot(tmp_path / "x.h5")


def test_lines_stated_by_temperatures_are_drawn_at_their_pressures(tmp_path):
    pressures = "  suction: {pressure: 1.5 bar, temperature: 283 K}\n  discharge: {pressure: 12 bar}\n"
    states = "  evaporating_temperature: 2 degC\n  condensing_temperature: 45 degC\n  superheat: 10 K\n"
    assert pressures in SCENE

    def simulate(case):
        result = with_cycle(case)
        figures = Figures(result.performance, suction_pressure=3.1e5, discharge_pressure=11.6e5)
        return Result("ok", performance=figures, cycle=result.cycle)

    text = SCENE.replace(pressures, states) + CYCLE + "sweep: {operation.condensing_temperature: [30 degC, 45 degC]}\n"
    results = open_results(file(tmp_path / "x.h5", text, simulate))
    trace = chosen_trace(results)
    assert trace is not None
    assert trace.pressures == {"$p_s$": 3.1e5, "$p_d$": 11.6e5}
    assert shown_axis(results.axis_list[0]).label == "condensing temperature $T_c$ (°C)"
