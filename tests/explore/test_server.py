"""A page is answered as `simulate` would; settings that fail, hang or kill do not take the server down."""

import json
import random
import threading
import time

import pytest
from explore_line import PAPER, Line, served
from websockets.exceptions import ConnectionClosed

from screwsim.derivatives.solving import scene_derivatives
from screwsim.explore.worker_pool import Timeouts
from screwsim.scene import load
from screwsim.simulate import simulate

pytestmark = pytest.mark.around

MOODS = '''"""An effect that does what its mood says: nothing, raise, sleep, or end the process."""

import os
import time
from dataclasses import dataclass

from screwsim.inputs.declare import number
from screwsim.effects.base import Effect


@dataclass(frozen=True)
class Parameters:
    """The mood."""

    mood: float = number("what to do", 0.0)


def build(parameters, machine):
    if parameters.mood == 1.0:
        raise RuntimeError("in a bad mood")
    if parameters.mood == 2.0:
        time.sleep(600.0)
    if parameters.mood == 3.0:
        os._exit(7)
    if parameters.mood == 4.0:
        bytearray(1 << 36)
    return ()


EFFECT = Effect("moody", "an effect with moods", ("M12",), "a test", Parameters, build)
'''
MOOD = "effects.explore_moods.moody.mood"
SHORT = Timeouts(alone=2.0, behind=0.3)


@pytest.fixture(scope="module")
def server():
    with served(workers=2) as found:
        yield found


@pytest.fixture(scope="module")
def moody(tmp_path_factory):
    """Serve a scene with an effect of the user's own that can hang and kill."""
    folder = tmp_path_factory.mktemp("moody")
    (folder / "explore_moods").mkdir()
    (folder / "explore_moods" / "moody.py").write_text(MOODS, encoding="utf-8")
    scene = folder / "scene.yaml"
    scene.write_text(f"base: {PAPER}\neffects: {{explore_moods.moody: {{}}}}\n", encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        with served(str(scene), patience=SHORT) as found:
            yield found


def same(overrides):
    return dict(simulate(load(PAPER, overrides), trace=False).performance)


def test_an_answer_is_that_of_simulate(server):
    with Line(server) as line:
        head = line.answer({"operation.speed": "1777 rpm"}, blow_hole=False)
    assert head["performance"] == same(["operation.speed=1777 rpm", "effects.blow_hole=off"])


def test_sixty_changes_in_a_row_are_each_answered_in_order(server):
    with Line(server) as line:
        for i in range(60):
            line.ask({"operation.speed": f"{1000 + 10 * i} rpm"})
        ranges = []
        while not ranges or ranges[-1][1] < 60:
            head, _ = line.next()
            ranges.append((head["first"], head["number"]))
        assert head["performance"] == same(["operation.speed=1590 rpm"])
    firsts, lasts = zip(*ranges, strict=True)
    assert firsts == (1, *(last + 1 for last in lasts[:-1]))


def test_a_small_sweep_is_that_of_simulate(server):
    with Line(server) as line:
        values = [500.0, 1000.0, 2000.0]
        points = [["operation.speed", f"{value} rpm"] for value in values]
        line.send({"kind": "curve", "id": 3, "points": points, "changes": {"set": {"oil_supply.ratio": 2.0}}})
        for index, value in enumerate(values):
            head, _ = line.next()
            assert (head["lane"], head["id"], head["index"]) == ("curve", 3, index)
            assert head["performance"] == same(["oil_supply.ratio=2", f"operation.speed={value} rpm"])


def test_a_scene_that_cannot_be_says_why_and_the_next_is_solved(server):
    with Line(server) as line:
        head = line.answer({"operation.discharge.pressure": "1 bar"})
        assert head["status"] == "refused" and "operation.discharge.pressure" in head["message"]
        assert line.answer()["status"] == "ok"


def test_a_solution_that_fails_has_its_reason(server):
    overrides = ["operation.discharge.pressure=4000 bar"]
    with Line(server) as line:
        head = line.answer({"operation.discharge.pressure": "4000 bar"})
        wanted = simulate(load(PAPER, overrides))
        assert (head["status"], head["message"]) == (wanted.status, wanted.message)
        assert line.answer()["status"] == "ok"


def test_too_much_memory_is_refused(moody):
    with Line(moody) as line:
        head = line.answer({MOOD: 4})
        assert head["status"] in ("refused", "failed") and "emory" in head["message"]
        assert line.answer()["status"] == "ok"


@pytest.mark.parametrize(
    ("mood", "told"),
    [(1, "in a bad mood"), (2, "was stopped after"), (3, "died with exit code 7")],
    ids=["raises", "hangs", "dies"],
)
def test_what_an_effect_does_is_told_and_the_next_is_answered(moody, mood, told):
    with Line(moody) as line:
        assert told in line.answer({MOOD: mood})["message"]
        assert line.answer()["status"] == "ok"


def test_a_newer_request_does_not_wait_long_behind_one_that_hangs(moody):
    """Each of both is answered, the first by its reason; a worker must be there, or both are taken as one."""
    with Line(moody) as line:
        assert line.answer()["status"] == "ok"
        line.ask({MOOD: 2})
        time.sleep(0.2)
        line.ask()
        first, second = line.next()[0], line.next()[0]
        assert "was stopped after" in first["message"] and (first["first"], first["number"]) == (2, 2)
        assert second["status"] == "ok" and (second["first"], second["number"]) == (3, 3)


def test_a_page_that_goes_away_while_it_hangs_leaves_the_worker_to_others(moody):
    with Line(moody) as line:
        line.ask({MOOD: 2})
        time.sleep(0.2)
    with Line(moody) as line:
        assert line.answer()["status"] == "ok"


CLIENTS, SECONDS = 5, 3.0


def test_under_load_no_answer_is_another_s(server):
    """Some clients for some seconds; as a benchmark 20 for a minute (benchmarks/explore.py)."""
    answers, faults = [], []

    def client(seed):
        chance = random.Random(seed)
        try:
            with Line(server) as line:
                end = time.monotonic() + SECONDS
                while time.monotonic() < end:
                    values = {
                        "operation.speed": f"{chance.choice((900, 1100, 1300, 1500))} rpm",
                        "oil_supply.ratio": chance.choice((1.0, 2.0)),
                    }
                    head = line.answer(values, blow_hole=chance.random() < 0.5)
                    answers.append((json.dumps([values, "effects.blow_hole=off" in head["texts"]["overrides"]]), head))
        except Exception as error:  # noqa: BLE001 - whatever it is, the test fails
            faults.append(error)

    threads = [threading.Thread(target=client, args=(seed,)) for seed in range(CLIENTS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults
    assert len(answers) > 3 * CLIENTS
    wanted = {}
    for key, head in answers:
        if key not in wanted:
            values, off = json.loads(key)
            off_too = ["effects.blow_hole=off"] if off else []
            wanted[key] = same([*(f"{path}={value}" for path, value in values.items()), *off_too])
        assert head["performance"] == wanted[key]


def test_slopes_are_the_exact_derivatives(server):
    scene = load(PAPER, ["operation.speed=1500 rpm"])
    wanted = scene_derivatives(scene, {"operation.speed": scene.operation.speed}).derivatives["operation.speed"]
    with Line(server) as line:
        line.send({"kind": "slopes", "id": 5, "changes": {"set": {"operation.speed": "1500 rpm"}}})
        head, _ = line.next()
    assert (head["lane"], head["id"]) == ("slopes", 5)
    values = pytest.approx(wanted, rel=3e-5)  # the cycle of a series begins elsewhere
    assert head["slopes"]["operation.speed"] == values
    assert "effects.tip_leakage.gap" in head["slopes"]


def test_no_more_pages_are_open_than_the_server_bears(server, monkeypatch):
    monkeypatch.setattr("screwsim.explore.serve.MOST_PAGES", 1)
    with Line(server) as first, Line(server) as second:
        with pytest.raises(ConnectionClosed) as closed:
            second.next(10.0)
        assert closed.value.rcvd.code == 1013
        assert first.answer()["status"] == "ok"


def test_no_answer_comes_from_a_file_that_has_changed_since_the_page_was_made(tmp_path):
    below, scene = tmp_path / "below.yaml", tmp_path / "scene.yaml"
    below.write_text(f"base: {PAPER}\noperation: {{speed: 2000 rpm}}\n", encoding="utf-8")
    scene.write_text("base: below.yaml\n", encoding="utf-8")
    text = below.read_text(encoding="utf-8")
    with served(str(scene)) as found, Line(found) as line:
        assert line.answer()["performance"] == same(["operation.speed=2000 rpm"])
        below.write_text(text.replace("2000", "1000"), encoding="utf-8")
        head = line.answer({"oil_supply.ratio": 2.0})
        assert head["kind"] == "refused"
        assert head["message"].startswith(f"{below} has changed since this page was made")
        below.write_text(text, encoding="utf-8")
        wanted = same(["operation.speed=2000 rpm", "oil_supply.ratio=2"])
        assert line.answer({"oil_supply.ratio": 2.0})["performance"] == wanted


def test_a_worker_that_has_grown_too_large_is_replaced(monkeypatch):
    monkeypatch.setattr("screwsim.explore.worker_pool.LARGEST_WORKER", 0)
    with served() as found, Line(found) as line:
        before = line.answer({"operation.speed": "1200 rpm"})
        again = line.answer({"operation.speed": "1200 rpm"})
        assert before["performance"] == again["performance"] == same(["operation.speed=1200 rpm"])
        assert before["process"] != again["process"]
