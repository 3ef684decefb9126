"""Figures of stored results: what is drawn, that all text is legible, the same bytes again, faults in one line."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from report_fakes import (
    BEST_RATIO,
    CYCLE,
    LEDGER,
    PUMP,
    RATIOS,
    SCENE,
    SPEED,
    SPEEDS,
    cycle,
    design,
    file,
    ok,
    some_fail,
    with_cycle,
    with_ledger,
)

from screwsim.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.report import cycle as cycle_figures
from screwsim.report import ledger, maps, outcome, plot, samples, sweeps
from screwsim.report.annotate import spread
from screwsim.report.families import optimum
from screwsim.report.quantities import shown_axis
from screwsim.report.style import DOUBLE, MM, SINGLE, journal
from screwsim.report.trace import chosen_trace
from screwsim.results import Results, open_results

THREE = SCENE + "sweep:\n" + SPEEDS + RATIOS + "  operation.discharge.pressure: [10 bar, 14 bar]\n"
MANY = (
    SCENE
    + "sweep:\n  operation.speed: {from: 500 rpm, to: 5000 rpm, count: 40, spacing: linear}\n"
    + RATIOS.replace("20", "7")
)
GAP = SCENE + "sweep:\n  effects.tip_leakage.gap: [10 um, 20 um, 50 um]\n  operation.suction.pressure: [1 bar, 2 bar]\n"
ORIFICES = SPEED + "  oil_supply.orifice_diameter: [2 mm, 3 mm]\n"
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
    "a spike": (SCENE, spike, ["pressure_volume", "states", "mass_flows"]),
    "sweep with cycles": (
        LINEAR + CYCLE,
        with_cycle,
        ["efficiency", "performance", "pressure_volume", "states", "mass_flows"],
    ),
}


def drawn(path: Path, results: Results | None = None) -> dict:
    """Return the figures of a file, drawn."""
    results = results or open_results(path)
    figures = {}
    with journal():
        for name, draw in (
            *sweeps.plans(results),
            *maps.plans(results),
            *outcome.plans(results),
            *samples.plans(results),
            *cycle_figures.plans(results),
            *ledger.plans(results),
        ):
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


@pytest.fixture(scope="module", params=FILES)
def figures(request, tmp_path_factory):
    """Return the names that are expected and the figures of one kind of file."""
    text, simulate, names = FILES[request.param]
    return names, drawn(file(tmp_path_factory.mktemp("report") / "x.h5", text, simulate))


def test_a_file_gives_the_figures_it_has_data_for(figures):
    names, found = figures
    assert list(found) == names


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


def test_the_same_data_give_the_same_bytes(tmp_path):
    path = file(tmp_path / "x.h5", SCENE, with_cycle)
    first, second = plot(path, tmp_path / "a"), plot(path, tmp_path / "b")
    assert [Path(name).name for name in first] == [Path(name).name for name in second]
    for one, other in zip(first, second, strict=True):
        assert Path(one).read_bytes() == Path(other).read_bytes(), one


def test_figures_lie_beside_the_file_in_a_folder_of_its_name(tmp_path):
    path = file(tmp_path / "x.h5", SPEED)
    written = [Path(name) for name in plot(path)]
    assert sorted(tmp_path.joinpath("x").iterdir()) == sorted(written)
    assert written[0].read_bytes()[:4] == b"\x89PNG" and written[1].read_bytes()[:4] == b"%PDF"


def test_settings_of_the_caller_stay(tmp_path):
    import matplotlib

    path = file(tmp_path / "x.h5", SPEED)
    with matplotlib.rc_context({"font.size": 31.0}):
        first = plot(path, tmp_path / "a")
        assert matplotlib.rcParams["font.size"] == 31.0
    assert Path(first[0]).read_bytes() == Path(plot(path, tmp_path / "b")[0]).read_bytes()


def test_the_optimum_of_a_parabola_in_ln_d_is_exact():
    x = np.geomspace(0.1, 10.0, 7)
    found = optimum(x, 0.6 - 0.03 * np.log(x / BEST_RATIO) ** 2)
    assert found == pytest.approx((BEST_RATIO, 0.6), rel=1e-12)  # the interpolation is of that very form


@pytest.mark.parametrize("y", [[1.0, 2.0, 3.0], [3.0, 2.0, 1.0], [1.0, 2.0]])
def test_an_optimum_at_an_end_is_none(y):
    assert optimum(np.arange(1.0, 1.0 + len(y)), np.array(y)) is None


def test_labels_spread_keep_their_order_and_distance():
    wanted = np.array([0.5, 0.1, 0.52, 0.49, 0.99, 1.0])
    places = spread(wanted, 0.1, 0.0, 1.0)
    assert np.array_equal(np.argsort(places), np.argsort(wanted))
    assert np.diff(np.sort(places)).min() >= 0.1 - 1e-12 and places.min() >= 0.0 and places.max() <= 1.0


def test_the_waterfall_goes_from_the_shaft_power_to_the_gas():
    bars = ledger.steps(LEDGER)
    assert [bar.words for bar in bars] == [
        "shaft power",
        "tip leakage",
        "discharge port",
        "oil supply",
        "exergy rise of the oil",
        "exergy rise of the gas",
    ]
    spent = sum(bar.power for bar in bars if not bar.total)
    small = 1.0 + 1.9 + 0.1  # entries below a thousandth, and the residue
    assert bars[0].power - spent - bars[-1].power == pytest.approx(small, rel=1e-9)


def note_of(path: Path, name: str) -> str:
    """Return the note above a figure, in one line."""
    return " ".join(drawn(path)[name].get_suptitle().split())


def test_cases_left_out_are_counted(tmp_path):
    path = file(tmp_path / "x.h5", PUMP, some_fail)
    note = note_of(path, "efficiency")
    assert "10 of 100 cases without a result left out" in note and "not closed (5)" in note


def test_a_spike_beyond_the_axis_is_told(tmp_path):
    path = file(tmp_path / "x.h5", SCENE, spike)
    assert "peak of 150 bar at 720° not shown" in note_of(path, "pressure_volume")


def test_the_isentropic_efficiency_stands_in_for_the_isothermal(tmp_path):
    def real_gas(case):
        figures = Figures(ok(case).performance, isothermal_efficiency=None)
        return Result("ok", performance=figures)

    axes = drawn(file(tmp_path / "x.h5", PUMP, real_gas))["efficiency"].axes[0]
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
