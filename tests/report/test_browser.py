"""The page in a real browser: no errors, nothing asked of a network, a click shows its case, nothing overflows."""

import itertools
from dataclasses import replace
from pathlib import Path

import pytest
from report_fakes import PUMP, RATIOS, SPEED, design, expanding, file, ok, some_fail, some_warn, with_ledger
from result_fakes import CYCLE, SCENE
from scipy.interpolate import CubicSpline

from screwsim.outputs import Figures
from screwsim.report import families, rotors_page
from screwsim.report.page import data, tables
from screwsim.report.page import pages as pages_of
from screwsim.report.page.uncertain import inputs_lines
from screwsim.report.rotors_scene import curves_of
from screwsim.results import open_results
from screwsim.scene import load

pytestmark = [pytest.mark.browser, pytest.mark.around]


def apart(case):
    """Return a case with cycle and ledger; the curves of the speeds lie apart, so that a click tells them."""
    result = with_ledger(case)
    lower = result.performance.isothermal_efficiency - 10.0 / case.operation.speed
    return replace(result, performance=Figures(result.performance, isothermal_efficiency=lower))


RATIO = SCENE + "sweep:\n" + RATIOS
SIZES = {"desktop": (1280, 900), "phone": (390, 844)}
FILES = {
    "sweep with cycles": (PUMP + CYCLE, apart),
    "sweep without": (PUMP, some_fail),
    "speed": (SPEED, with_ledger),
    "run": (SCENE, with_ledger),
    "expander": (SCENE, expanding),
    "warned": (PUMP, some_warn),
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Return {kind: (results file, page)}."""
    folder = tmp_path_factory.mktemp("browser")
    made = {}
    for number, (kind, (text, simulate)) in enumerate(FILES.items()):
        path = file(folder / f"{number}.h5", text, simulate)
        made[kind] = path, pages_of(path, folder / f"{number}.html")[0]
    return made


@pytest.fixture(scope="module")
def window(browser):
    """Return the one window in which pages are opened after each other: its process keeps the library compiled."""
    context = browser.new_context()
    yield context.new_page()
    context.close()


IN_ITS_COLOURS = (
    "Array.from(document.querySelectorAll('.chart'))"
    ".every((chart) => !chart.layout || chart.layout.font.color === colour('text'))"
)


class Seen:
    """A page that is open, what it complained of, and what it asked for."""

    def __init__(self, window, path, scheme="light", size="desktop"):
        width, height = SIZES[size]
        self.page = window
        self.complaints, self.asked = [], []
        self.heard = {
            "console": lambda message: self.complaints.append(message.text),
            "pageerror": lambda error: self.complaints.append(str(error)),
            "request": lambda request: self.asked.append(request.url),
        }
        for event, hear in self.heard.items():
            window.on(event, hear)
        window.set_viewport_size({"width": width, "height": height})
        window.emulate_media(color_scheme=scheme)
        window.goto(f"file://{path}")
        window.wait_for_selector("html[data-ready=yes]")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for event, hear in self.heard.items():
            self.page.remove_listener(event, hear)

    def turn(self, scheme):
        """Change the reader's theme, and wait until every drawing has the colour of its text."""
        self.page.emulate_media(color_scheme=scheme)
        self.page.wait_for_function(f"() => isDark() === {'true' if scheme == 'dark' else 'false'} && {IN_ITS_COLOURS}")

    def drawn(self, chart):
        """Return the number of points of the first curve of a drawing that have a value."""
        return self.page.evaluate(f"document.getElementById('{chart}').data[0].y.filter((y) => y !== null).length")


@pytest.mark.parametrize(("scheme", "size"), [("light", "desktop"), ("dark", "phone")])
@pytest.mark.parametrize("kind", FILES)
def test_a_page_draws_without_complaint_and_fits(window, pages, kind, scheme, size):
    """As it is opened, and drawn anew when its reader turns to the other theme: both themes at both sizes."""
    path, html = pages[kind]
    results = open_results(path)
    with Seen(window, html, scheme, size) as seen:
        draws_and_fits(seen, results)
        seen.turn("light" if scheme == "dark" else "dark")
        draws_and_fits(seen, results)


def draws_and_fits(seen, results):
    """Require drawings without a complaint, no request to a network, and a page no wider than its window."""
    assert seen.complaints == []
    assert [url for url in seen.asked if not url.startswith(("file:", "data:", "blob:"))] == []
    assert seen.page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    if results.axis_list:
        assert seen.page.locator("#overview .scatterlayer .point").count() > 10
    if "angle" in results.cycle:
        assert seen.drawn("loop") > 20 and seen.drawn("temperatures") > 20
        assert seen.page.locator("#loop .scatterlayer path.js-line").count() >= 1


def test_the_theme_is_the_reader_s(window, pages):
    script = "[getComputedStyle(document.body).backgroundColor, document.getElementById('loop').layout.font.color]"
    found = []
    for scheme in ("light", "dark"):
        with Seen(window, pages["run"][1], scheme) as seen:
            found.append(seen.page.evaluate(script))
    light, dark = found
    assert light[0] != dark[0] and light[1] != dark[1]


def test_a_click_on_a_point_shows_its_case(window, pages):
    path, html = pages["sweep with cycles"]
    results = open_results(path)
    with Seen(window, html) as seen:
        before = seen.page.locator("#case-words").inner_text()
        box = seen.page.locator("#overview .scatterlayer .trace").nth(2).locator(".point").nth(4).bounding_box()
        seen.page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
        seen.page.wait_for_function(
            "(before) => document.getElementById('case-words').innerText !== before", arg=before
        )
        case = 2 * len(results.axes["oil_supply.ratio"]) + 4
        assert seen.page.evaluate("picked") == case
        assert "1000 rpm" in seen.page.locator("#case-words").inner_text()
        assert seen.drawn("loop") > 20 and seen.drawn("temperatures") > 20
        peak = seen.page.evaluate("Math.max(...document.getElementById('loop').data[0].y)")
        assert peak == pytest.approx(results.cycle["pressure"][2, 4].max() * 1e-5, rel=1e-4)
        assert figures_shown(seen) == [row[:4] for row in tables.figures(results, data.selection(results).place(case))]


def figures_shown(seen) -> list[tuple[str, ...]]:
    """Return the rows of the table of figures."""
    script = (
        "Array.from(document.querySelectorAll('#figures tbody tr'), (r) => Array.from(r.cells, (c) => c.textContent))"
    )
    return [tuple(row) for row in seen.page.evaluate(script)]


def tolerant(case):
    """Return a case with the parts of two inputs in its uncertainties; above a ratio of 1 one of them is unknown."""
    known = case.oil_supply.ratio < 1.0
    parts = [{"paths": ["gap"], "share": 0.8 if known else 1.0, "change": 40.0}]
    parts += [{"paths": ["speed"], "share": 0.2, "change": 20.0}] if known else []
    told = {"coverage_factor": 2.0, "groups": [["gap"], ["speed"]], "left_out": {} if known else {"speed": "none"}}
    return replace(ok(case), uncertainty=told | {"figures": {"shaft_power": {"contributors": parts}}})


def test_a_case_whose_intervals_leave_out_an_input_says_so(window, tmp_path):
    path = file(tmp_path / "x.h5", RATIO, tolerant)
    results = open_results(path)
    cases = results.axes["oil_supply.ratio"].size
    with Seen(window, pages_of(path, tmp_path / "x.html")[0]) as seen:
        for case in (cases - 1, 0):
            seen.page.evaluate(f"pick({case})")
            lines = seen.page.locator("#contributors li").all_inner_texts()
            assert lines == inputs_lines(results, (case,))
            assert any("without speed" in line for line in lines) == (case > 0)
        assert seen.complaints == []


def test_the_script_writes_numbers_as_the_tables_do(window, pages):
    values = [0.0, 1.0, -2.5, 123456.0, 99999.6, 0.00012345678, 0.00009999951, 1234.5, 1e-7, 12.0, 0.1, -31415.9265]
    with Seen(window, pages["run"][1]) as seen:
        assert [seen.page.evaluate("(v) => general(v, 5)", value) for value in values] == [f"{v:.5g}" for v in values]
        assert [seen.page.evaluate("(v) => small(v)", value) for value in values] == [f"{v:.1e}" for v in values]


def test_the_optima_are_those_of_the_printed_figure(window, pages):
    path, html = pages["sweep with cycles"]
    results = open_results(path)
    family = families.family_of(results)
    assert family is not None
    curves = families.curves_of(family, "isothermal_efficiency")
    wanted = [families.optimum(curve.x, curve.y) for curve in curves]
    with Seen(window, html) as seen:
        script = "document.getElementById('overview').data.find((t) => t.name === 'optimum')"
        x, y = (seen.page.evaluate(f"Array.from({script}.{axis})") for axis in "xy")
    # the page has float32: relative 6e-8 of η, which moves a flat top by the root of that
    assert x == pytest.approx([best[0] for best in wanted], rel=1e-3)
    assert y == pytest.approx([best[1] for best in wanted], rel=1e-6)


def test_every_choice_of_figure_and_view_draws(window, pages):
    with Seen(window, pages["sweep without"][1]) as seen:
        for name in seen.page.evaluate("data.figures.map((figure) => figure.name)"):
            seen.page.select_option("#figure", name)
        seen.page.select_option("#over", "shaft_power")
        seen.page.select_option("#curves", "")
        assert seen.drawn("overview") > 10
        seen.page.select_option("#view", "map")
        assert seen.page.locator("#overview .contourlayer .contour").count() == 1
        assert seen.complaints == []


def test_a_design_is_drawn_as_points_and_picked_by_number(window, tmp_path):
    from screwsim.report.page import page_of

    results = design(file(tmp_path / "x.h5", RATIO + CYCLE, with_ledger))
    (tmp_path / "x.html").write_text(page_of(results), encoding="utf-8")
    with Seen(window, tmp_path / "x.html") as seen:
        assert seen.complaints == []
        assert seen.page.locator("#overview .scatterlayer .point").count() == 20 + 1  # and the picked one
        seen.page.fill("#picker input", "3")
        seen.page.keyboard.press("Enter")
        seen.page.wait_for_function("() => picked === 3")
        assert "male-rotor speed" in seen.page.locator("#case-words").inner_text()
        seen.page.select_option("#over", "shaft_power")
        seen.page.select_option("#curves", "")
        assert seen.complaints == [] and seen.drawn("overview") == 20


def test_a_case_is_picked_from_the_keyboard(window, pages):
    with Seen(window, pages["sweep with cycles"][1]) as seen:
        first = seen.page.locator("#picker select").first
        first.focus()
        before = seen.page.evaluate("picked")
        seen.page.keyboard.press("ArrowDown")
        assert seen.page.evaluate("picked") != before
        assert first.evaluate("(select) => getComputedStyle(select).outlineStyle") != "none"


def test_a_failed_case_says_why(window, pages):
    with Seen(window, pages["sweep without"][1]) as seen:
        seen.page.evaluate("pick(0)")
        assert seen.page.locator("#case-message").inner_text() == "the integration stopped"
        assert "failed" in seen.page.locator("#case-words").inner_text()


def test_every_drawing_and_control_has_a_name(window, pages):
    with Seen(window, pages["sweep with cycles"][1]) as seen:
        script = "Array.from(document.querySelectorAll('{}'), (e) => {})"
        selects = seen.page.evaluate(script.format("select", "e.labels.length"))
        assert selects and all(selects)
        charts = seen.page.evaluate(script.format(".chart", "e.getAttribute('aria-label')"))
        assert charts and all(charts)


COVERED = """() => {
  const target = document.getElementById("loop");
  const frame = target.querySelector(".nsewdrag").getBoundingClientRect();
  const { xaxis, yaxis } = target._fullLayout;
  const { x, y } = target.data[0];
  const path = dense(Array.from(x, (each, i) => [frame.left + xaxis.l2p(each), frame.top + yaxis.l2p(y[i])]));
  const over = (box) => ([u, v]) => u > box.left && u < box.right && v > box.top && v < box.bottom;
  return Array.from(target.querySelectorAll(".annotation-text-g"))
    .map((each) => [each.textContent, each.getBoundingClientRect()])
    .filter(([, box]) => box.right < frame.right && path.some(over(box))).map(([text]) => text);
}"""


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", ["run", "sweep with cycles"])
def test_no_label_covers_the_loop(window, pages, kind, size):
    with Seen(window, pages[kind][1], size=size) as seen:
        seen.page.wait_for_function("() => document.querySelectorAll('#loop .annotation-text-g').length === 2")
        assert seen.page.evaluate(COVERED) == []


def test_an_expander_has_its_ledger(window, pages):
    with Seen(window, pages["expander"][1]) as seen:
        assert seen.complaints == []
        rows = seen.page.locator("#ledger tbody tr").all_inner_texts()
        assert rows[0].split("\t")[:3] == ["total given by the gas", "3.141", "100.00"]
        assert rows[1].split("\t")[:3] == ["power at the shaft", "2.2", "70.04"]
        words = seen.page.evaluate("document.getElementById('waterfall').data[0].y")
        assert (words[0], words[-1]) == ("exergy given by the gas", "power at the shaft")


def test_a_case_that_warns_says_of_what(window, pages):
    with Seen(window, pages["warned"][1]) as seen:
        seen.page.evaluate("pick(99)")
        assert seen.page.locator("#case-words").inner_text().endswith("ok, with warnings")
        assert len(seen.page.locator("#case-warnings").inner_text().splitlines()) == 2
        assert "△ with warnings (60)" in seen.page.locator("#overview-note").inner_text()
        seen.page.evaluate("pick(0)")
        assert not seen.page.locator("#case-warnings").is_visible()
        colours = [
            seen.page.locator(f".status.{kind}").evaluate("(e) => getComputedStyle(e).backgroundColor")
            for kind in ("ok", "ok-with-warnings")
        ]
        assert colours[0] != colours[1]


def test_a_column_is_as_wide_as_its_table(window, pages):
    """The longest name beside the longest unit fits at a desk, and the curves beside the table keep their place."""
    longest = ("evaporating bubble temperature of a blend", "0.0043812", "K (-10.73 °C)", "4.3e-06")
    fill = "([i, text]) => { document.querySelector('#figures tbody tr').cells[i].textContent = text; }"
    box = "document.querySelector('#figures').parentElement"
    with Seen(window, pages["sweep with cycles"][1]) as seen:
        for cell in enumerate(longest):
            seen.page.evaluate(fill, cell)
        assert seen.page.evaluate(f"{box}.scrollWidth <= {box}.clientWidth + 1")
        assert seen.page.evaluate("document.getElementById('flows').clientWidth") > 400


def test_a_table_that_is_cut_says_so(window, pages):
    cut = "e.scrollWidth > e.clientWidth + 1, e.nextElementSibling.checkVisibility()"
    script = f"Array.from(document.querySelectorAll('.scroll'), (e) => [{cut}])"
    with Seen(window, pages["sweep with cycles"][1], size="phone") as seen:
        seen.page.set_viewport_size({"width": 240, "height": 700})
        seen.page.wait_for_function(f"() => {script}.some(([cut, told]) => cut && told)")  # drawn anew, and told then
        assert all(cut == told for cut, told in seen.page.evaluate(script))
    with Seen(window, pages["sweep with cycles"][1]) as seen:
        assert not any(told for _, told in seen.page.evaluate(script))


def test_a_map_of_few_values_is_drawn_on_more(window, pages):
    """The splines go through the values; the points that can be picked stay the computed ones."""
    with Seen(window, pages["warned"][1]) as seen:
        seen.page.select_option("#view", "map")
        contours, points = seen.page.evaluate(
            "(({x, y, z}, d) => [[x.length, y.length, z.flat().every(Number.isFinite)], d.x.length])"
            "(...document.getElementById('overview').data)"
        )
        assert contours == [41, 41, True] and points == 100
        found = seen.page.evaluate("splined([0, 1, 3, 4], [1, 2, 0, 5], [0, 0.5, 1, 2, 3, 4])")
        assert [found[i] for i in (0, 2, 4, 5)] == pytest.approx([1.0, 2.0, 0.0, 5.0], abs=1e-12)
        spline = CubicSpline([0.0, 1.0, 3.0, 4.0], [1.0, 2.0, 0.0, 5.0], bc_type="natural")
        assert found == pytest.approx(spline([0.0, 0.5, 1.0, 2.0, 3.0, 4.0]).tolist(), abs=1e-12)


@pytest.mark.parametrize("size", SIZES)
def test_the_page_of_rotors_has_the_theme_of_the_reader(window, tmp_path, size):
    laid = curves_of(load(Path(__file__).parents[2] / "configs" / "rotors" / "c.yaml"))
    (tmp_path / "rotors.html").write_text(rotors_page.page(laid, "rotors"), encoding="utf-8")
    width, height = SIZES[size]
    seen = []
    for scheme in ("light", "dark"):
        window.set_viewport_size({"width": width, "height": height})
        window.emulate_media(color_scheme=scheme)
        window.goto(f"file://{tmp_path / 'rotors.html'}")
        style = "getComputedStyle(document.body)"
        seen.append(window.evaluate(f"[{style}.backgroundColor, {style}.color, getComputedStyle(male).fill]"))
        script = (
            "Array.from(graph.querySelectorAll('text'), (e) => [e.textContent, e.getBoundingClientRect().toJSON()])"
        )
        boxes = window.evaluate(script)
        assert window.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        for (one, a), (other, b) in itertools.combinations(boxes, 2):
            beside = a["right"] <= b["left"] or b["right"] <= a["left"]
            assert beside or a["bottom"] <= b["top"] or b["bottom"] <= a["top"], (one, other)
    assert all(light != dark for light, dark in zip(*seen, strict=True))
