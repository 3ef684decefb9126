"""What the tolerances make of every case of a sweep: computed, stored, read, drawn; none of it without tolerances."""

from dataclasses import replace

import numpy as np
import pytest

import screwsim
from screwsim.outputs import Result
from screwsim.printing.sweep import print_sweep, sweep_document
from screwsim.printing.uncertain import print_uncertainty, ranges_text, uncertainty_ranges
from screwsim.report.page import page_of
from screwsim.report.page.uncertain import inputs_lines
from screwsim.results import open_results, save
from screwsim.results.left_out import left_out_words, parts_left_out
from screwsim.results.table import join, table_of
from screwsim.scene import case
from screwsim.study.datasheet import Sheet, SheetOptions, sheet_of
from screwsim.study.sweep import run_sweep
from screwsim.study.sweep.part_files import is_whole, read_part, write_part
from screwsim.study.uncertainty.point import uncertainty, with_uncertainty

GAP, OTHER, RATIO = "effects.tip_leakage.gap", "effects.interlobe_leakage.gap", "oil_supply.ratio"
TOLERANT = (
    f"{GAP}=27.5 um ± 5 um",
    f"{OTHER}=29.5 um ± 5 um",
    f"{RATIO}=3 ± 10 %",
    f"uncertainty={{correlated: [[{GAP}, {OTHER}]], model: bitzer}}",
)
SWEEP = ("numerics.error=none", f"sweep.{RATIO}=[0.5, 1, 2]")
SAME = 1e-5  # of a spread: that of a case started from its neighbour, both closed at the scene's accuracy


@pytest.fixture(scope="module")
def swept(tmp_path_factory, paper_point):
    """Return the scene of a small sweep, how it ended, and its results."""
    scene = screwsim.load(paper_point, [*TOLERANT, *SWEEP])
    summary = run_sweep(scene, tmp_path_factory.mktemp("sweep") / "x.h5", jobs=1)
    return scene, summary, open_results(summary.path)


@pytest.fixture(scope="module")
def paper_point(request):
    return request.config.rootpath / "configs" / "paper" / "point.yaml"


def test_each_case_has_the_uncertainty_of_its_own_point(swept):
    scene, _, results = swept
    for number in (0, 2):
        spreads = uncertainty(case(scene, number)).spreads
        for name in ("shaft_power", "gas_mass_flow", "oil_ratio"):
            assert results.uncertainty[name][number] == pytest.approx(spreads[name].standard, rel=SAME)
    assert results.uncertainty["oil_ratio"] == pytest.approx(0.05 * np.array([0.5, 1.0, 2.0]), rel=1e-6)  # a share


def test_what_inputs_change_is_signed_and_adds_in_squares(swept):
    _, _, results = swept
    assert results.contributions["contributor"].tolist() == [RATIO, f"{GAP} + {OTHER}"]
    by_ratio, by_gaps = results.contributions["gas_mass_flow"].T
    assert np.all(by_gaps < 0.0)  # wider gaps leak more
    assert np.hypot(by_ratio, by_gaps) == pytest.approx(results.uncertainty["gas_mass_flow"], rel=1e-12)


def test_tables_have_a_column_of_the_standard_uncertainty(swept):
    _, _, results = swept
    power = results.uncertainty["shaft_power"]
    assert results.to_pandas().shaft_power_u.tolist() == power.tolist()
    for group in ("performance", None):
        found = results.to_xarray(group)
        assert found.shaft_power_u.attrs["units"] == "W"
        assert found.shaft_power_u.values.tolist() == power.tolist()
    assert results.to_xarray("contributions").shaft_power.dims == ("oil_supply_ratio", "contributor")


def test_a_sweep_says_how_sure_it_is_before_it_counts_its_cases(swept, capsys):
    scene, summary, results = swept
    print_sweep(sweep_document(scene, summary), scene)
    words = " ".join(capsys.readouterr().out.split())
    largest = 200.0 * results.uncertainty["isothermal_efficiency"].max()
    assert f"{largest:.2g} points" in words
    assert "all in the file) 3 cases: 3 ok" in words


def test_a_band_lies_around_the_curve_and_is_said_to_be_one(swept):
    _, summary, results = swept
    axes = screwsim.plot.curves(summary.path, "shaft_power")
    (band,) = axes.collections
    low, high = band.get_datalim(axes.transData).intervaly
    power, half = 1e-3 * results.performance["shaft_power"], 2e-3 * results.uncertainty["shaft_power"]
    assert (low, high) == pytest.approx(((power - half).min(), (power + half).max()))
    assert axes.get_title() == "band: 95 % interval by the tolerances of 3 inputs alone"


def test_the_page_says_each_part_by_itself(swept):
    text = page_of(swept[2])
    assert "by inputs: half of the 95 % interval" in text
    assert "isentropic efficiency -2.7 … +2.9 points" in text
    assert '<ul class="hint" id="contributors"><li>isothermal efficiency: tip_leakage.gap' in text


def test_a_sweep_without_tolerances_has_no_such_groups(tmp_path, paper_point):
    scene = screwsim.load(paper_point, ["numerics.error=none", f"sweep.{RATIO}=[1, 2]"])
    results = open_results(run_sweep(scene, tmp_path / "x.h5", jobs=1).path)
    assert len(results.uncertainty) == len(results.contributions) == 0
    assert not [name for name in results.to_pandas() if name.endswith("_u")]
    assert "by inputs" not in page_of(results)


def test_a_case_without_a_result_has_no_uncertainty_among_others(tmp_path):
    told = {
        "coverage_factor": 2.0,
        "groups": [["a"], ["b"]],
        "left_out": {"b": "no derivative"},
        "figures": {"gas_mass_flow": {"contributors": [{"paths": ["a"], "share": 1.0, "change": -0.5}]}},
    }
    good = Result("ok", performance=screwsim.outputs.Figures(gas_mass_flow=2.0), uncertainty=told)
    table = join([table_of([Result("failed", "why")], keep_cycle=False), table_of([good], keep_cycle=False)])
    write_part(path := tmp_path / "part.npz", table)
    assert is_whole(path, 2)
    again = read_part(path)
    assert again.inputs == ("a", "b")
    assert again.changes["gas_mass_flow"] == pytest.approx(np.array([[np.nan] * 2, [-0.25, np.nan]]), nan_ok=True)


def partly_known(ratio: float) -> Result:
    """Return a power with the part of one of two inputs; that of the other is known at the first ratio alone."""
    known = ratio < 1.0
    parts = [{"paths": [GAP], "share": 0.8 if known else 1.0, "change": 40.0}]
    parts += [{"paths": [RATIO], "share": 0.2, "change": 20.0}] if known else []
    told = {
        "coverage_factor": 2.0,
        "groups": [[GAP], [RATIO]],
        "left_out": {} if known else {RATIO: "no derivative"},
        "figures": {"shaft_power": {"expanded": 40.0, "contributors": parts}},
    }
    return Result("ok", performance=screwsim.outputs.Figures(shaft_power=12e3), uncertainty=told)


def test_a_sum_that_leaves_out_an_input_says_so_in_table_document_curve_and_page(tmp_path, paper_point, capsys):
    scene = screwsim.load(paper_point, [*TOLERANT[:3], *SWEEP])
    save(tmp_path / "x.h5", scene, [partly_known(0.5), partly_known(1.0), partly_known(2.0)], "sweep")
    results = open_results(tmp_path / "x.h5")
    assert parts_left_out(results).tolist() == [[False, False], [False, True], [False, True]]
    document = uncertainty_ranges(results)
    assert document["left_out"] == {RATIO: 2}
    words = "without oil_supply.ratio, whose part is unknown"
    assert ranges_text(document).endswith(f"; {words} in up to 2 cases, so too small there")
    assert "without" not in ranges_text({**document, "left_out": {}})
    assert words in screwsim.plot.curves(tmp_path / "x.h5", "shaft_power").get_title()
    lost = f"All {words}: the intervals are too small."
    assert lost in inputs_lines(results, (2,)) and lost not in inputs_lines(results, (0,))
    print_uncertainty(partly_known(2.0))
    assert f"the sums of inputs are {words}, so they are too small" in " ".join(capsys.readouterr().out.split())
    print_uncertainty(partly_known(0.5))
    assert "too small" not in capsys.readouterr().out


def test_many_inputs_left_out_are_counted():
    assert left_out_words([]) == ""
    assert left_out_words(["effects.a.gap", "b"]) == "without a.gap, b, whose part is unknown"
    assert left_out_words(list("abcd")) == "without 4 inputs, whose part is unknown"


def test_an_input_without_a_derivative_is_told_and_in_no_figure(paper_point, monkeypatch):
    scene = screwsim.load(paper_point, ["numerics.error=none", f"{GAP}=27.5 um ± 5 um"])
    result = screwsim.simulate(scene, trace=False)
    lost = uncertainty(scene, result=result)
    lost = replace(lost, spreads={}, left_out={GAP: "not closed"})
    monkeypatch.setattr("screwsim.study.uncertainty.point.uncertainty", lambda *given, **more: lost)
    found = with_uncertainty(scene, result)
    assert found.warnings[-1] == f"the tolerance of {GAP} is not included in the uncertainties: not closed"
    assert found.uncertainty["figures"] == {}


def test_a_data_sheet_says_how_sure_its_own_point_is(paper_point, monkeypatch):
    scene = screwsim.load(paper_point, ["operation.speed=1000 rpm ± 3 %", "uncertainty.model=bitzer"])
    empty = Sheet("heading", "title", [], [], None, [])
    monkeypatch.setattr("screwsim.study.datasheet._sheet_of_scene", lambda *given: empty)
    sheet = sheet_of(scene, SheetOptions())
    told = dict(sheet.lines)
    half = sheet.document["uncertainty"]["figures"]["shaft_power"]["expanded"]
    power = screwsim.simulate(scene, trace=False).performance.shaft_power
    assert f"shaft power ± {100.0 * half / power:.2g} %" in told["uncertain"]
    assert "isentropic efficiency -2.7 … +2.9 points" in told["model"]
    assert told["model"].endswith("this scene lies outside: speed 1000 rpm (2950 rpm)")
    assert sheet.document["uncertainty"]["figures"]["displacement_flow"]["contributors"][0]["share"] == 1.0
    assert sheet_of(screwsim.load(paper_point), SheetOptions()) == empty
