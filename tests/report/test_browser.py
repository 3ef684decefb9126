"""The page in a real browser: no errors, nothing asked of a network, a click shows its case, nothing overflows."""

import shutil
from dataclasses import replace

import pytest
from report_fakes import CYCLE, PUMP, RATIOS, SCENE, SPEED, design, file, some_fail, with_ledger

from screwsim.outputs import Figures
from screwsim.report.families import family, layout_of, optimum
from screwsim.report.page import data, report, tables
from screwsim.results import open_results

pytestmark = pytest.mark.browser


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
}


@pytest.fixture(scope="module")
def browser():
    """Return Debian's Chromium; what playwright would download is not wanted."""
    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium") or shutil.which("chromium-browser")
    assert path, "no chromium on PATH (apt-get install chromium, or leave these tests out with -m 'not browser')"
    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Return {kind: (results file, page)}."""
    folder = tmp_path_factory.mktemp("browser")
    made = {}
    for number, (kind, (text, simulate)) in enumerate(FILES.items()):
        path = file(folder / f"{number}.h5", text, simulate)
        made[kind] = path, report(path, folder / f"{number}.html")
    return made


class Seen:
    """A page that is open, what it complained of, and what it asked for."""

    def __init__(self, browser, path, scheme="light", size="desktop"):
        width, height = SIZES[size]
        self.context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
        self.page = self.context.new_page()
        self.complaints, self.asked = [], []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(f"file://{path}")
        self.page.wait_for_selector("html[data-ready=yes]")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.context.close()

    def drawn(self, chart):
        """Return the number of points of the first curve of a drawing that have a value."""
        return self.page.evaluate(f"document.getElementById('{chart}').data[0].y.filter((y) => y !== null).length")


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("kind", FILES)
def test_a_page_draws_without_complaint_and_fits(browser, pages, kind, scheme, size):
    path, html = pages[kind]
    with Seen(browser, html, scheme, size) as seen:
        assert seen.complaints == []
        assert [url for url in seen.asked if not url.startswith(("file:", "data:", "blob:"))] == []
        assert seen.page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        if open_results(path).axis_list:
            assert seen.page.locator("#overview .scatterlayer .point").count() > 10
        if "angle" in open_results(path).cycle:
            assert seen.drawn("loop") > 20 and seen.drawn("temperatures") > 20
            assert seen.page.locator("#loop .scatterlayer path.js-line").count() >= 1


def test_the_theme_is_the_reader_s(browser, pages):
    light, dark = (
        Seen(browser, pages["run"][1], scheme).page.evaluate(
            "[getComputedStyle(document.body).backgroundColor, document.getElementById('loop').layout.font.color]"
        )
        for scheme in ("light", "dark")
    )
    assert light[0] != dark[0] and light[1] != dark[1]


def test_a_click_on_a_point_shows_its_case(browser, pages):
    path, html = pages["sweep with cycles"]
    results = open_results(path)
    with Seen(browser, html) as seen:
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
        assert figures_shown(seen) == [tuple(row) for row in tables.figures(results, data.selection(results), case)]


def figures_shown(seen) -> list[tuple[str, ...]]:
    """Return the rows of the table of figures."""
    script = (
        "Array.from(document.querySelectorAll('#figures tbody tr'), (r) => Array.from(r.cells, (c) => c.textContent))"
    )
    return [tuple(row) for row in seen.page.evaluate(script)]


def test_the_script_writes_numbers_as_the_tables_do(browser, pages):
    values = [0.0, 1.0, -2.5, 123456.0, 99999.6, 0.00012345678, 0.00009999951, 1234.5, 1e-7, 12.0, 0.1, -31415.9265]
    with Seen(browser, pages["run"][1]) as seen:
        assert [seen.page.evaluate("(v) => general(v, 5)", value) for value in values] == [f"{v:.5g}" for v in values]
        assert [seen.page.evaluate("(v) => small(v)", value) for value in values] == [f"{v:.1e}" for v in values]


def test_the_optima_are_those_of_the_printed_figure(browser, pages):
    path, html = pages["sweep with cycles"]
    results = open_results(path)
    layout = layout_of(results)
    assert layout is not None
    curves = family(results, layout, {}, None, "isothermal_efficiency")
    wanted = [optimum(curve.x, curve.y) for curve in curves]
    with Seen(browser, html) as seen:
        script = "document.getElementById('overview').data.find((t) => t.name === 'optimum')"
        x, y = (seen.page.evaluate(f"Array.from({script}.{axis})") for axis in "xy")
    # the page has float32: relative 6e-8 of η, which moves a flat top by the root of that
    assert x == pytest.approx([best[0] for best in wanted], rel=1e-3)
    assert y == pytest.approx([best[1] for best in wanted], rel=1e-6)


def test_every_choice_of_figure_and_view_draws(browser, pages):
    with Seen(browser, pages["sweep without"][1]) as seen:
        for name in seen.page.evaluate("data.figures.map((figure) => figure.name)"):
            seen.page.select_option("#figure", name)
        seen.page.select_option("#over", "shaft_power")
        seen.page.select_option("#curves", "")
        assert seen.drawn("overview") > 10
        seen.page.select_option("#view", "map")
        assert seen.page.locator("#overview .contourlayer .contour").count() == 1
        assert seen.complaints == []


def test_a_design_is_drawn_as_points_and_picked_by_number(browser, tmp_path):
    from screwsim.report.page import page_of

    results = design(file(tmp_path / "x.h5", RATIO + CYCLE, with_ledger))
    (tmp_path / "x.html").write_text(page_of(results), encoding="utf-8")
    with Seen(browser, tmp_path / "x.html") as seen:
        assert seen.complaints == []
        assert seen.page.locator("#overview .scatterlayer .point").count() == 20 + 1  # and the picked one
        seen.page.fill("#picker input", "3")
        seen.page.keyboard.press("Enter")
        seen.page.wait_for_function("() => picked === 3")
        assert "male-rotor speed" in seen.page.locator("#case-words").inner_text()
        seen.page.select_option("#over", "shaft_power")
        seen.page.select_option("#curves", "")
        assert seen.complaints == [] and seen.drawn("overview") == 20


def test_a_case_is_picked_from_the_keyboard(browser, pages):
    with Seen(browser, pages["sweep with cycles"][1]) as seen:
        first = seen.page.locator("#picker select").first
        first.focus()
        before = seen.page.evaluate("picked")
        seen.page.keyboard.press("ArrowDown")
        assert seen.page.evaluate("picked") != before
        assert first.evaluate("(select) => getComputedStyle(select).outlineStyle") != "none"


def test_a_failed_case_says_why(browser, pages):
    with Seen(browser, pages["sweep without"][1]) as seen:
        seen.page.evaluate("pick(0)")
        assert seen.page.locator("#case-message").inner_text() == "the integration stopped"
        assert "failed" in seen.page.locator("#case-words").inner_text()


def test_every_drawing_and_control_has_a_name(browser, pages):
    with Seen(browser, pages["sweep with cycles"][1]) as seen:
        script = "Array.from(document.querySelectorAll('{}'), (e) => {})"
        selects = seen.page.evaluate(script.format("select", "e.labels.length"))
        assert selects and all(selects)
        charts = seen.page.evaluate(script.format(".chart", "e.getAttribute('aria-label')"))
        assert charts and all(charts)
