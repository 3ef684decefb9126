"""The page in a real browser: it follows the hand, says what fails, complains of nothing, and fits a phone."""

import re
import time
from contextlib import contextmanager

import pytest
from explore_line import PAPER, served

from screwsim.scene import load, loads
from screwsim.simulate import simulate

pytestmark = [pytest.mark.browser, pytest.mark.around]

SIZES = {"desktop": (1280, 900), "phone": (390, 844)}
SPEED = "input[type=range][data-path='operation.speed']"


@pytest.fixture(scope="module")
def server():
    with served(workers=2) as found:
        yield found


class Seen:
    """A page that is open, what it complained of, and what it asked for."""

    def __init__(self, page):
        self.page, self.complaints, self.asked = page, [], []
        page.on("console", lambda message: self.complaints.append(message.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.asked.append(request.url))
        page.on("websocket", lambda line: self.asked.append(line.url))

    def value(self, script):
        return self.page.evaluate(script)

    def until(self, script, seconds=60.0):
        """Wait until a script gives what is true: the page's policy lets no text become a function in it."""
        end = time.monotonic() + seconds
        while not (found := self.value(script)):
            assert time.monotonic() < end, script
            time.sleep(0.05)
        return found

    def settled(self):
        """Wait until all that was asked is answered and drawn, and the hand has rested."""
        self.until("shown !== null && sent.size === 0 && !moved && !typing && log.answered === number")
        return self


@contextmanager
def opened(browser, server, size="desktop", hash="", **more):
    width, height = SIZES[size]
    more = {"reduced_motion": "reduce", **more}
    with browser.new_context(viewport={"width": width, "height": height}, **more) as context:
        seen = Seen(context.new_page())
        seen.page.goto(server.url + hash)
        yield seen.settled()
        assert seen.complaints == []


@pytest.fixture(scope="module")
def window(browser, server):
    """Return the page that most tests use, one after the other."""
    with opened(browser, server) as seen:
        yield seen


@pytest.fixture
def seen(window):
    """Return that page as the scene says, nothing pinned, at rest; it must have complained of nothing at the end."""
    window.value("scrub(403), document.getElementById('coloured').value = ''")  # colours: half a second of a core
    if window.value("asHash()") or window.value("pins.length") or window.value("past.length > 1"):
        window.value("put({ set: {}, effects: {} }); past = []; pins = []; fillPins(); fillControls(); changed()")
    yield window.settled()
    assert window.complaints == []


def figures(*overrides):
    return dict(simulate(load(PAPER, overrides), trace=False).performance)


def test_sixty_changes_of_a_slider_are_each_answered_in_order(seen):
    seen.page.focus(SPEED)
    before = seen.value("log.sent")
    for _ in range(60):
        seen.page.keyboard.press("ArrowRight")
    seen.settled()
    log = seen.value("log")
    assert log["sent"] - before == 60 and log["answered"] == log["sent"] and log["order"]
    speed = seen.value("settings.set['operation.speed']")
    assert seen.value("shown.performance") == figures(f"operation.speed={speed}")
    assert seen.value("shown.settings.set['operation.speed']") == speed
    assert seen.page.get_attribute(SPEED, "aria-valuetext").split()[0] == speed.split()[0]


@pytest.mark.parametrize("value", [1234.5678901234567, 1.2345678901234567e-05, -0.012345678901234567, 123456789.125])
def test_a_long_number_is_shown_with_the_digits_that_fit_and_whole_in_its_title(seen, value):
    seen.value(f"setTo(controlOf('operation.speed'), {value!r}), 0")
    field = "byPath.get('operation.speed').field"
    shown = seen.value(f"[{field}.value, {field}.title, {field}.scrollWidth <= {field}.clientWidth]")
    assert float(shown[0]) == pytest.approx(value, rel=1e-3)
    assert float(shown[1]) == value and shown[2]
    assert float(seen.value("settings.set['operation.speed']").split()[0]) == value


def test_the_drawn_loop_is_that_of_the_answer(seen):
    peak = seen.value("Math.max(...charts.loop.content.curves.at(-1).y)")
    assert peak == pytest.approx(simulate(load(PAPER)).cycle["pressure"].max() * 1e-5, rel=1e-6)  # float32
    width, height = seen.value("[charts.loop.below.width, charts.loop.below.height]")
    painted = "charts.loop.below.getContext('2d').getImageData(0, 0, %d, %d).data.some((each) => each > 0)"
    assert seen.value(painted % (width, height))


def test_three_pages_at_once_do_not_mix(browser, server):
    speeds = (800, 1200, 1600)
    with browser.new_context() as context:
        pages = [Seen(context.new_page()) for _ in speeds]
        for seen, speed in zip(pages, speeds, strict=True):
            seen.page.goto(f"{server.url}#operation.speed={speed}%20rpm")
        for seen, speed in zip(pages, speeds, strict=True):
            seen.settled()
            assert seen.value("shown.performance") == figures(f"operation.speed={speed} rpm")
            assert seen.complaints == []


def test_an_effect_is_switched_and_the_ledger_follows(seen):
    before = seen.value("shown.performance.volumetric_efficiency")
    seen.page.get_by_role("switch", name="blow hole").click()
    seen.settled()
    assert seen.value("shown.performance") == figures("effects.blow_hole=off")
    assert "blow hole" not in seen.value("shown.ledger.entries.map((each) => each.words)")
    assert not seen.page.locator("#of-effects-blow_hole-area").is_visible()
    assert seen.value("ghost.performance.volumetric_efficiency") == before
    assert "--set effects.blow_hole=off" in seen.page.locator("#shell").inner_text()


def test_an_effect_that_needs_a_number_says_which(seen):
    seen.page.get_by_role("switch", name="wall heat").click()
    seen.until("document.getElementById('status').textContent === 'refused'")
    field = seen.page.locator("#of-effects-wall_heat-rotor_area")
    assert field.is_visible() and field.get_attribute("aria-invalid") == "true"
    assert "effects.wall_heat.rotor_area" in seen.page.locator("#fault").inner_text()
    assert seen.value("document.body.classList.contains('old')")
    assert seen.value("shown.status") == "ok"  # the old answer stays
    seen.page.get_by_role("switch", name="wall heat").click()
    seen.until("document.getElementById('status').textContent === 'ok'")


def test_a_scene_that_fails_shows_its_reason_and_recovers(seen):
    field = seen.page.locator("#of-operation-discharge-pressure")
    field.fill("1")
    seen.until("!document.getElementById('fault').hidden")
    assert "operation.discharge.pressure" in seen.page.locator("#fault").inner_text()
    field.fill("10")
    seen.until("document.getElementById('fault').hidden")
    seen.settled()
    assert seen.value("shown.performance") == figures("operation.discharge.pressure=10 bar")


def test_a_link_restores_the_settings(browser, server):
    with opened(browser, server) as seen:
        seen.page.locator("#of-oil_supply-ratio").fill("1.5")
        seen.page.get_by_role("switch", name="tip leakage").click()
        seen.settled()
        link = seen.page.url
        wanted = seen.value("shown.performance")
    with opened(browser, server, hash=link.removeprefix(server.url)) as seen:
        assert seen.value("shown.performance") == wanted == figures("oil_supply.ratio=1.5", "effects.tip_leakage=off")
        assert seen.page.locator("#of-oil_supply-ratio").input_value() == "1.5"
        assert not seen.page.get_by_role("switch", name="tip leakage").is_checked()


def test_what_is_saved_is_a_scene_that_gives_the_same(browser, server):
    with opened(browser, server, hash="#operation.speed=1300%20rpm&effects.blow_hole=off") as seen:
        with seen.page.expect_download() as saved:
            seen.page.click("#save")
        scene = loads(saved.value.path().read_text(encoding="utf-8"))
        assert dict(simulate(scene, trace=False).performance) == seen.value("shown.performance")


def test_the_report_of_the_settings_opens(browser, server):
    with opened(browser, server, hash="#operation.speed=1300%20rpm") as seen:
        with seen.page.context.expect_page() as other:
            seen.page.get_by_role("button", name="Open in report").click()
        other.value.wait_for_selector("#scene pre")
        assert "1300 rpm" in other.value.locator("#scene pre").inner_text()


def test_cases_are_pinned_compared_and_shown_again(seen):
    seen.page.click("#pin")
    seen.page.locator("#of-operation-speed").fill("2000")
    seen.settled()
    seen.page.click("#pin")
    rows = seen.page.locator("#pins tbody tr")
    assert [rows.nth(i).locator("td").nth(1).inner_text() for i in range(2)] == [
        "as in the scene",
        "speed 2000 rpm",
    ]
    seen.page.select_option("#compared", "1")
    assert seen.value("charts.loop.content.curves.filter((each) => each.pale).length") == 1
    seen.page.get_by_role("button", name="Show pinned case 1").click()
    seen.settled()
    assert seen.value("shown.performance") == figures()


def test_undo_goes_back_one_change(seen):
    for value in ("2", "1"):
        seen.page.locator("#of-oil_supply-ratio").fill(value)
        seen.settled()
    seen.page.click("#undo")
    seen.settled()
    assert seen.page.locator("#of-oil_supply-ratio").input_value() == "2"
    assert seen.value("shown.performance") == figures("oil_supply.ratio=2")


def test_the_angle_moves_rotors_and_cursor_together(seen):
    pixels = "document.getElementById('section').toDataURL()"
    before = seen.value(pixels)
    seen.page.focus("#angle")
    for _ in range(5):
        seen.page.keyboard.press("ArrowRight")
    assert seen.value("angleNow") == 408
    assert seen.value(pixels) != before
    x, y = seen.value("charts.loop.moving.points.at(-1)")[:2]
    result = simulate(load(PAPER))
    assert x == pytest.approx(1e6 * result.cycle["volume"][408], rel=1e-6)  # float32
    assert y == pytest.approx(1e-5 * result.cycle["pressure"][408], rel=1e-6)


def test_a_drag_on_the_loop_sets_the_angle(seen):
    x, y = seen.value("[charts.loop.X(shown.traces.volume[600]), charts.loop.Y(shown.traces.pressure[600])]")
    box = seen.page.locator("#loop").bounding_box()
    seen.page.mouse.click(box["x"] + x, box["y"] + y)
    assert seen.value("angleNow") == pytest.approx(600, abs=2)


def test_it_plays_unless_less_motion_is_wanted(browser, server):
    with opened(browser, server) as seen:
        assert not seen.value("playing")
        seen.page.click("#play")
        now = seen.value("angleNow")
        seen.until(f"angleNow !== {now}")
    with opened(browser, server, reduced_motion="no-preference") as seen:
        assert seen.value("playing")


@pytest.mark.parametrize(("scheme", "size"), [("light", "phone"), ("dark", "desktop")])
def test_it_fits_and_has_the_theme_of_its_reader(browser, server, scheme, size):
    with opened(browser, server, size, color_scheme=scheme) as seen:
        assert seen.value("document.documentElement.scrollWidth <= window.innerWidth")
        assert seen.page.locator("#settings").get_attribute("open") == (None if size == "phone" else "")
        red, green, blue = map(int, re.findall(r"\d+", seen.value("getComputedStyle(document.body).backgroundColor")))
        assert (min(red, green, blue) > 200) == (scheme == "light")
        assert seen.value("palette.text === colour('text')")


def test_nothing_is_asked_of_any_other_address(seen, server):
    own = (server.url, server.url.replace("http", "ws"), "data:", "blob:")
    assert [url for url in seen.asked if not url.startswith(own)] == []


def test_every_control_and_drawing_has_a_name(seen):
    nameless = """Array.from(document.querySelectorAll('input, select, button, canvas:not([aria-hidden])')).filter(
      (e) => !(e.labels && e.labels.length) && !e.getAttribute('aria-label') && e.type !== 'hidden'
        && !(e.tagName === 'BUTTON' && e.textContent.trim())).map((e) => e.outerHTML.slice(0, 80))"""
    assert seen.value(nameless) == []


def test_what_is_reached_with_the_keyboard_is_seen(browser, server):
    with opened(browser, server) as seen:
        seen.page.keyboard.press("Tab")
        assert seen.value("document.activeElement.className") == "skip"
        for _ in range(6):
            seen.page.keyboard.press("Tab")
            assert seen.value("getComputedStyle(document.activeElement).outlineStyle") != "none"


def test_a_rest_of_the_hand_is_spoken_once(seen):
    seen.page.locator("#of-operation-speed").fill("1500")
    seen.settled()
    spoken = seen.page.locator("#spoken").inner_text()
    assert spoken.startswith("ok: isothermal efficiency ") and "shaft power" in spoken
    label = seen.page.locator("#loop canvas").first.get_attribute("aria-label")
    peak = simulate(load(PAPER, ["operation.speed=1500 rpm"])).cycle["pressure"].max()
    assert label.endswith(f" to {1e-5 * peak:.4g}")


def test_sliders_have_the_colour_of_what_they_do(seen):
    """However long after the small sweep they are asked for; a busy machine's pace is set aside."""
    seen.until("sweep.pace !== undefined")
    seen.value("sweep.pace = Math.min(sweep.pace, SLOW), sweep.begun -= 1e6")
    seen.page.select_option("#coloured", "isothermal_efficiency")
    slope = "byPath.get('effects.tip_leakage.gap').slopes?.isothermal_efficiency"
    seen.until(f"around.left === 0 && {slope} !== undefined")
    slope = seen.value(slope)
    low, high = (figures(f"effects.tip_leakage.gap={gap} um")["isothermal_efficiency"] for gap in (26.0, 29.0))
    assert slope == pytest.approx((high - low) / 3e-6, rel=0.05)  # curvature over ±5 %, figures within 3e-5
    slider = "document.querySelector(\"input[type=range][data-path='effects.tip_leakage.gap']\")"
    # asked for anew where the small sweep is: bare in between
    assert "lowers isothermal efficiency" in seen.until(f"{slider}.getAttribute('aria-description')")
    assert "linear-gradient" in seen.until(f"{slider}.style.getPropertyValue('--track')")


def test_derivatives_that_come_after_a_change_are_not_shown_as_those_of_the_new_settings(seen):
    """They take their time: ± by inputs of the settings before stood beside the figures of the new ones."""
    late = "receiveSlopes({ id: 99, slopes: {}, halves: { shaft_power: 1e3 }, lost: [] })"
    assert seen.value(f"around = {{ id: 99, entries: [], values: [], left: 1 }}, {late}, halves !== null")
    seen.value("around.id = 99, setTo(controlOf('operation.speed'), 1100)")
    seen.until("sent.size === 0 && log.answered === number")
    assert seen.value(f"{late}, halves") is None


def test_a_change_has_the_sign_of_the_difference_also_of_a_negative_figure(seen):
    """As `compare` has it, and as a slider says what it raises: an expander's power of -50 kW that becomes -40 kW."""
    for before, now, said in ((-50e3, -40e3, "+20 %"), (-1e3, 1e3, "+200 %"), (50e3, 40e3, "−20 %")):
        seen.value(f"ghost = shown, shown = {{ performance: {{ shaft_power: {now} }} }}, null")
        told = seen.value(f"changeOf('shaft_power', {{ performance: {{ shaft_power: {before} }} }})")
        seen.value("shown = ghost, null")
        assert told == said


def test_a_line_that_is_cut_is_opened_again(browser):
    with served() as first:
        page = browser.new_page()
        seen = Seen(page)
        page.goto(first.url)
        seen.settled()
        seen.value("socket.close()")
        seen.until("log.sent === 1 && log.answered === 1 && !socket.gone && socket.readyState === 1 && sent.size === 0")
        seen.until("document.getElementById('fault').hidden")
        page.close()


def test_the_small_sweep_comes_however_late_the_line_opens(browser, server):
    late = """
        const Line = WebSocket;
        window.WebSocket = class extends Line {
            addEventListener(name, act) {
                const open = (event) => setTimeout(() => { this.opened = true; act(event); }, 1500);
                super.addEventListener(name, name === "open" ? open : act);
            }
            get readyState() { return this.opened ? super.readyState : Line.CONNECTING; }
        };
    """
    with browser.new_context(reduced_motion="reduce") as context:
        context.add_init_script(late)
        seen = Seen(context.new_page())
        seen.page.goto(server.url)
        seen.until("sweep.pace > 0")
        assert seen.complaints == []


def test_the_small_sweep_is_drawn_through_the_point(seen):
    seen.page.select_option("#over", "operation.suction.temperature")
    seen.until("sweep.all.every((each) => 'isothermal_efficiency' in each)")
    seen.until("charts.sweep.content.curves.at(-1).y.every(Number.isFinite)")
    x, y = seen.value("[Array.from(charts.sweep.content.curves.at(-1).x), charts.sweep.content.curves.at(-1).y]")
    result = figures(f"operation.suction.temperature={x[4]!r} degC")
    assert y[4] == pytest.approx(100.0 * result["isothermal_efficiency"], rel=1e-12)
    at, value = seen.value("charts.sweep.moving.points[0]")[:2]
    assert at == 5.85 and value == pytest.approx(100.0 * figures()["isothermal_efficiency"], rel=1e-12)


def test_a_number_is_asked_when_it_is_typed_whole(seen):
    before = seen.value("log.sent")
    field = seen.page.locator("#of-operation-speed")
    field.press("Control+a")
    field.press_sequentially("1500")
    seen.settled()
    assert seen.value("log.sent") <= before + 2  # one, or two where the keys came slowly
    assert seen.value("shown.performance") == figures("operation.speed=1500 rpm")


CUT = """[...document.querySelectorAll('#headline dt, .row label')].filter((each) => each.offsetParent !== null)
  .filter((each) => each.scrollWidth > each.clientWidth + 1).map((each) => each.textContent)"""
BROKEN = """[...document.querySelectorAll('.row label')].filter((each) => each.offsetParent !== null).filter((each) => {
  const range = document.createRange();
  const word = each.firstChild;
  if (word === null || word.nodeType !== 3 || /\\s/.test(word.data.trim()) || !word.data.trim()) return false;
  range.selectNodeContents(word);
  return new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1;
}).map((each) => each.firstChild.data)"""


@pytest.mark.parametrize("size", SIZES)
def test_names_of_figures_and_controls_are_read_whole(browser, server, size):
    with opened(browser, server, size) as seen:
        assert seen.value("document.querySelectorAll('#headline dt').length") > 3
        assert seen.value(CUT) == [] and seen.value(BROKEN) == []
