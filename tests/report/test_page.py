"""The page of a results file: whole, offline, small, and with what the file has."""

import base64
import gzip
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from report_fakes import (
    PUMP,
    SPEED,
    WARNING,
    file,
    ok,
    some_fail,
    some_warn,
    with_cycle,
    with_ledger,
    without_warnings,
)
from result_fakes import CYCLE, SCENE

from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.report import page
from screwsim.report.page import data, pack, pages, tables
from screwsim.results import open_results
from screwsim.study.claims import claims_of

pytestmark = pytest.mark.around
PAPER = "Chernov et al. 2015, Fig. 1"


def text_of(path, tmp_path, claims=()) -> str:
    """Return the page of a results file."""
    return Path(pages(path, tmp_path / "x.html", claims)[0]).read_text(encoding="utf-8")


def unpacked(text: str, name: str) -> str:
    """Return what a page carries packed."""
    found = re.search(rf'id="{name}">([A-Za-z0-9+/=]+)<', text)
    assert found is not None
    return gzip.decompress(base64.b64decode(found[1])).decode()


@pytest.fixture(scope="module")
def pump(tmp_path_factory):
    """Return a sweep with cycles and ledgers."""
    return file(tmp_path_factory.mktemp("page") / "x.h5", PUMP + CYCLE, with_ledger)


@pytest.fixture(scope="module")
def text(pump, tmp_path_factory):
    """Return its page."""
    return text_of(pump, tmp_path_factory.mktemp("html"))


def test_the_page_asks_nothing_of_a_network(text):
    assert "default-src 'none'" in text  # the browser itself refuses what the page would ask for
    assert not re.search(r"""(src|href|action)\s*=\s*["']?\s*(https?:)?//""", text)
    assert not re.search(r"@import|url\(|https?://", text)


def test_the_page_of_a_sweep_is_small(text):
    assert len(text.encode()) < 6_000_000


def test_the_library_is_there_once_and_whole(text):
    from plotly.offline import get_plotlyjs

    assert unpacked(text, "data-library") == get_plotlyjs()
    assert text.count('id="data-library"') == 1


def test_scene_digest_and_history_are_told(text, pump):
    results = open_results(pump)
    for name in ("scene_sha256", "history", "screwsim_fingerprint", "source"):
        assert str(results.attributes[name]) in text
    assert "rotor_diameter: 128 mm" in text


def test_figures_are_written_as_the_table_of_run_writes_them(tmp_path):
    rows = tables.figures(open_results(path := file(tmp_path / "x.h5", SCENE)), ())
    found = {name: (number, unit) for name, number, unit, *_ in rows}
    performance = open_results(path).performance
    assert found["shaft power"] == (f"{performance['shaft_power'] / 1e3:.5g}", "kW")
    assert found["isothermal efficiency"][1] == "%"


SLOW = SCENE.replace("speed: 3000 rpm", "speed: 900 rpm").replace("ratio: 3", "ratio: 4")


def test_a_run_that_warns_is_not_plainly_ok(tmp_path):
    page = text_of(file(tmp_path / "x.h5", SLOW, some_warn), tmp_path)
    assert '<span class="status ok-with-warnings">ok with warnings</span>' in page
    assert 'class="status ok"' not in page
    banner = page.partition('id="warnings"')[2].partition("</div>")[0]
    assert "<strong>2 warnings</strong>" in banner and f"<li>{WARNING}</li>" in banner
    assert page.index('id="warnings"') < page.index('id="figures"')


def test_a_sweep_counts_its_warnings_by_kind(tmp_path):
    path = file(tmp_path / "x.h5", PUMP, some_warn)
    assert tables.counts(open_results(path)) == [("ok", 40), ("ok with warnings", 60)]
    head, lines = tables.warnings(open_results(path))
    much = int(np.count_nonzero(open_results(path).axes["oil_supply.ratio"] > 3.5))
    assert head == "60 of 100 cases warn"
    assert lines == [f"60 cases: {WARNING}", f"{3 * much} cases: the oil would fill 120% of the chamber"]
    page = text_of(path, tmp_path)
    assert "<li>60 cases: " in page and ">60 ok with warnings<" in page and ">40 ok<" in page
    document = json.loads(unpacked(page, "data-document"))
    assert len(document["warnings"]) == 60 and "39" not in document["warnings"]
    assert document["warnings"]["99"] == f"{WARNING}\nthe oil would fill 120% of the chamber"


def test_a_page_without_warnings_has_no_banner(tmp_path, text):
    assert 'id="warnings"' not in text and json.loads(unpacked(text, "data-document"))["warnings"] == {}
    old = text_of(without_warnings(file(tmp_path / "x.h5", SLOW, some_warn)), tmp_path)
    assert 'id="warnings"' not in old and '<span class="status ok">ok</span>' in old


def test_a_title_cannot_break_the_page(tmp_path):
    scene = SCENE.replace("title: fake", "title: '</title><script>alert(1)</script>'")
    made = text_of(file(tmp_path / "x.h5", scene), tmp_path)
    assert "<script>alert(1)" not in made and "&lt;script&gt;alert(1)" in made


def test_the_same_file_gives_the_same_page(pump, tmp_path):
    assert text_of(pump, tmp_path) == text_of(pump, tmp_path)


def test_a_file_without_traces_says_how_to_get_them(tmp_path):
    made = text_of(file(tmp_path / "x.h5", PUMP), tmp_path)
    assert "--set output.keep=cycle" in made and 'id="loop"' not in made


def test_a_sweep_of_which_all_cases_failed_has_a_page(tmp_path):
    def failed(case):
        return Result("failed", message="pressure left the range")

    made = text_of(file(tmp_path / "x.h5", PUMP, failed), tmp_path)
    assert "100 failed" in made and "pressure left the range" in made and "No case closed" in made
    shown = re.findall(r'<section id="(\w+)"', made)
    assert shown == ["checks", "scene", "provenance"]  # no empty figures and menus
    assert re.findall(r'<a href="#(\w+)"', made)[-3:] == shown and "output.keep" not in made


def test_cases_that_failed_are_counted(tmp_path):
    made = text_of(file(tmp_path / "x.h5", PUMP, some_fail), tmp_path)
    assert "85 ok" in made and "5 not closed" in made and "10 failed" in made


def test_packed_numbers_come_back(pump):
    results = open_results(pump)
    shown = data.selection(results)
    document = data.document(results, shown)
    json.dumps(document, allow_nan=False)
    figure = next(each for each in document["figures"] if each["name"] == "shaft_power")
    values = np.frombuffer(base64.b64decode(figure["values"]), "<f4")
    assert values == pytest.approx(results.performance["shaft_power"].ravel(), rel=2.0**-24)  # float32's rounding


def test_a_trace_comes_back_within_half_a_step_and_keeps_its_gaps():
    trace = np.array([[np.nan, 1.0, 2.0, 5.0], [3.0, 3.0, 3.0, 3.0], [np.nan] * 4])
    packed = {name: base64.b64decode(value) for name, value in pack.quantised(trace).items()}
    steps = np.frombuffer(packed["steps"], "<u2").reshape(trace.shape).astype(float)
    low, span = (np.frombuffer(packed[name], "<f4")[:, None] for name in ("low", "span"))
    back = np.where(steps > pack.QUANTISATION_STEPS, np.nan, low + span * steps / pack.QUANTISATION_STEPS)
    assert np.array_equal(np.isnan(back), np.isnan(trace))
    there = np.isfinite(trace)
    assert np.max(np.abs(back - trace)[there]) <= 0.5 * 4.0 / pack.QUANTISATION_STEPS * (1.0 + 1e-6)


def test_thinned_traces_lie_off_by_what_is_stated():
    angle = np.arange(721.0)
    trace = np.array([np.exp(-(((angle - 600.0) / 4.0) ** 2)), np.sin(np.radians(angle))])
    trace[:, :90] = np.nan
    thinned = pack.reduce_angles(angle, {"p": trace}, 1e-3)
    lines = [np.interp(angle[90:], angle[thinned.kept], row[thinned.kept]) for row in trace]
    off = np.max(np.abs(np.array(lines) - trace[:, 90:]))
    assert off == pytest.approx(thinned.deviation["p"], rel=1e-9)
    assert off <= 1e-3 * 2.0  # of the span of the sine
    assert len(thinned.kept) < 200 and {89, 90} <= set(thinned.kept.tolist())


def test_a_large_sweep_is_thinned_and_the_page_says_so(pump, monkeypatch):
    results = open_results(pump)
    monkeypatch.setattr(data, "MOST_WITH_TRACES", 30)
    shown = data.selection(results)
    assert int(np.prod(shown.shape)) <= 30 and shown.shape[0] == 5
    assert any("all are in the file" in line for line in tables.notes(results, shown))
    assert shown.of(results.performance["oil_ratio"]).size == np.prod(shown.shape)


def test_claims_are_those_of_the_paper_s_own_sweeps(tmp_path):
    own = file(tmp_path / "a.h5", PUMP.replace("title: fake", f"title: '{PAPER}'"))
    assert [claim.name for claim in claims_of(str(own))] == ["A1", "A2", "A3", "A4", "A5"]
    with pytest.raises(UsageError, match=r"--with joins the paper's two sweeps, and these are not both"):
        claims_of(str(file(tmp_path / "b.h5", PUMP)), str(own))
    made = text_of(own, tmp_path, claims_of(str(own)))
    assert "every curve has a maximum over d" in made


def test_both_sweeps_of_the_paper_give_all_claims(tmp_path):
    title = f"title: '{PAPER}'"
    pump = file(tmp_path / "a.h5", PUMP.replace("title: fake", title))
    bores = SPEED.replace("title: fake", title) + "  oil_supply.orifice_diameter: [2 mm, 3 mm]\n"
    displaced = str(file(tmp_path / "b.h5", bores))
    assert [claim.name for claim in claims_of(displaced)] == ["A6"]
    assert [claim.name for claim in claims_of(displaced, str(pump))][-2:] == ["A6", "A7"]


def test_a_missing_extra_is_one_line_with_the_command(tmp_path, monkeypatch, capsys):
    path = file(tmp_path / "x.h5", SCENE, with_cycle)
    monkeypatch.setattr(page, "find_spec", lambda name: None)
    assert exit_code(["report", str(path), "-o", str(tmp_path / "x.html")]) == 2
    said = capsys.readouterr().err
    assert "pip install 'screwsim[report]'" in said and said.count("\n") == 1


def test_the_page_lies_beside_the_file_by_default(tmp_path, capsys):
    path = file(tmp_path / "x.h5", SCENE, ok)
    assert exit_code(["report", str(path)]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "x.html")
    assert (tmp_path / "x.html").exists()


def test_a_page_that_cannot_be_written_is_one_line(tmp_path):
    path = file(tmp_path / "x.h5", SCENE)
    with pytest.raises(UsageError, match="cannot be written") as fault:
        pages(path, path / "x.html")
    assert "\n" not in str(fault.value)


def test_a_page_tells_whether_errors_are_within_the_accuracy_of_their_own_case(tmp_path):
    """The error of the fake, 2e-4, is within the first accuracy and beyond the second one, also of joined axes."""
    zipped = "sweep:\n  zip:\n  - {numerics.accuracy: [1e-3, 1e-4], operation.speed: [1000 rpm, 2000 rpm]}\n"

    def rough(scene):
        return replace(ok(scene), error=Figures(shaft_power=2e-4))

    *_, error = tables.checks(open_results(file(tmp_path / "x.h5", SCENE + zipped, rough)))
    assert (error.bound, error.verdict) == ("1.0e-04", "exceeded")
