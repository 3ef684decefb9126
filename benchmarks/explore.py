"""The live page: how soon it follows the hand, and what it answers under load, with what memory.

    python benchmarks/explore.py [SCENE] [--clients 20] [--seconds 60]

First a page in Chromium: 60 changes of the speed's slider, from the change to the drawn p–V; then many lines to one
server on the loopback address, each asking random settings, every answer held against `simulate` of the same.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import shutil
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from screwsim.explore.answer import unpack_message
from screwsim.scene import load
from screwsim.simulate import simulate

SCENE = Path(__file__).parents[1] / "configs" / "paper" / "point.yaml"
CHANGES, BETWEEN = 60, 0.1  # changes of the slider, and seconds between two: about as fast as a hand presses
PATIENCE = 120.0  # [s] for all answers: a server that has ended gives none
SPEEDS, RATIOS = range(800, 1600, 50), (0.5, 1.0, 2.0, 3.0)
SWITCHED = "blow_hole"


@contextmanager
def served(scene: str) -> Iterator[tuple[str, int]]:
    """Give address and process of a command that serves a scene."""
    command = [sys.executable, "-m", "screwsim", "explore", scene, "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        match = re.match(r"http://(\S+)/ ", process.stdout.readline())
        assert match, "the command printed no address"
        try:
            yield match[1], process.pid
        finally:
            process.terminate()


def wait_until(page: Any, holds: str) -> None:
    """Wait until an expression of the page is true."""
    end = time.monotonic() + PATIENCE
    while not page.evaluate(holds):
        if time.monotonic() > end:
            raise SystemExit(f"the page waits in vain: {holds}")
        time.sleep(0.1)


def follow(host: str) -> str:
    """Return in words how quickly a page follows its slider."""
    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        return "no chromium on PATH: the page is left out"
    with sync_playwright() as playwright:
        page = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"]).new_page(reduced_motion="reduce")
        page.goto(f"http://{host}/")
        wait_until(page, "shown !== null && around.left === 0")
        page.focus("input[type=range][data-path='operation.speed']")
        page.evaluate("log.ms = []")
        before = page.evaluate("log")
        for _ in range(CHANGES):
            page.keyboard.press("ArrowRight")
            time.sleep(BETWEEN)
        wait_until(page, "sent.size === 0")
        after, ms = page.evaluate("log"), page.evaluate("log.ms")
    answered, overtaken = (after[name] - before[name] for name in ("answered", "overtaken"))
    order = "in order" if after["order"] else "OUT OF ORDER"
    counts = f"{CHANGES} changes, {answered} answered {order}, {overtaken} of them by a newer one"
    return f"{counts}; from change to drawn p–V: median {statistics.median(ms):.0f} ms, longest {max(ms):.0f} ms"


def ask_for(host: str, seed: int, seconds: float, answers: list[Any]) -> None:
    """Request random settings, one after another, and keep the answers."""
    from websockets.sync.client import connect

    chance, number, end = random.Random(seed), 0, time.monotonic() + seconds
    with connect(f"ws://{host}/line") as line:
        while time.monotonic() < end:
            number += 1
            values = {"operation.speed": f"{chance.choice(SPEEDS)} rpm", "oil_supply.ratio": chance.choice(RATIOS)}
            effects = {SWITCHED: False} if chance.random() < 0.5 else {}
            message = {"kind": "point", "number": number, "changes": {"set": values, "effects": effects}}
            began = time.monotonic()
            line.send(json.dumps(message))
            while (head := unpack_message(line.recv(120.0))[0]).get("number") != number:
                pass
            answers.append((json.dumps([values, effects]), head["performance"], time.monotonic() - began))


def memory(pid: int) -> list[int]:
    """Return the resident memory [MB] of a process and of each of its descendants."""
    table = subprocess.run(["ps", "-eo", "pid=,ppid=,rss="], capture_output=True, text=True, check=True).stdout
    rows = [tuple(map(int, row.split())) for row in table.splitlines()]
    family, found = {pid}, []
    for _ in rows:
        family |= {child for child, parent, _ in rows if parent in family}
    for child, _, size in rows:
        if child in family:
            found.append(size // 1024)
    return sorted(found, reverse=True)


def burden(host: str, pid: int, scene: str, clients: int, seconds: float) -> str:
    """Return in words the answers to many simultaneous connections."""
    answers: list[Any] = []
    threads = [threading.Thread(target=ask_for, args=(host, seed, seconds, answers)) for seed in range(clients)]
    for thread in threads:
        thread.start()
    time.sleep(min(5.0, seconds))
    early = memory(pid)
    for thread in threads:
        thread.join()
    late, wrong, known = memory(pid), 0, {}
    for key, found, _ in answers:
        if key not in known:
            values, effects = json.loads(key)
            overrides = [f"{path}={value}" for path, value in values.items()]
            overrides += [f"effects.{name}=off" for name in effects]
            known[key] = dict(simulate(load(scene, [*overrides, "sweep=null"]), trace=False).performance)
        wrong += found != known[key]
    waits = statistics.median(wait for _, _, wait in answers)
    counts = f"{clients} lines for {seconds:.0f} s: {len(answers)} answers to {len(known)} settings, {wrong} wrong"
    sizes = f"resident after 5 s {sum(early)} MB ({early}), at the end {sum(late)} MB ({late})"
    return f"{counts}; median wait {1e3 * waits:.0f} ms; {sizes}"


def main() -> None:
    """Measure, and print both lines."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", default=str(SCENE))
    parser.add_argument("--clients", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=60.0)
    chosen = parser.parse_args()
    with served(chosen.scene) as (host, pid):
        print(follow(host), flush=True)
        print(burden(host, pid, chosen.scene, chosen.clients, chosen.seconds), flush=True)


if __name__ == "__main__":
    main()
