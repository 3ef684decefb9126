"""Ask commands about random machines, and check each answer in a second way.

Run: fuzz_commands.py [LAW …] [--seed 1] [--count 40] [--from 0] [--told]. A scene is one that `screwsim new` writes for
a random request (`fuzz_new.drawn`), or a shipped one. Laws (`command_laws.py`, `file_laws.py`) ask commands about it.
Prints a line per contradiction, with `--told` also each refusal with its command, for a reader to judge; then how often
each law was asked. A case is found again by its seed and number (`--from`).
"""

from __future__ import annotations

import argparse
import os
import tempfile
import traceback
from collections import Counter
from pathlib import Path

import file_laws  # noqa: F401 - adds its laws
import map_laws  # noqa: F401 - adds its laws
import new_laws  # noqa: F401 - adds its laws
import numpy as np
from asking import OK, Case, Contradiction, NotAsked, command
from command_laws import CONFIGS, LAWS, PLANT
from fuzz_new import drawn

NOT_SCENES = ("calibration", PLANT)
SHIPPED = 0.3  # share of cases that begin with a shipped scene


def made(random: np.random.Generator, told: list[str]) -> Case | None:
    """Return a case with its scene in the present folder; None where the random request is refused."""
    if random.random() < SHIPPED:
        files = [str(path) for path in CONFIGS.rglob("*.yaml") if not any(name in str(path) for name in NOT_SCENES)]
        text = f"base: {random.choice(sorted(files))}\nsweep: null\n"
    else:
        kind, request = drawn(random)
        options = [part for name, value in request.items() for part in (f"--{name}", value) if value is not False]
        code, text, said = command("new", kind, *(str(each) for each in options if each is not True))
        if code != OK:
            told.append(f"{code}: new {kind} {request}: {said}")
            return None
    Path("scene.yaml").write_text(text)
    return Case("scene.yaml", random, told)


def judged(name: str, case: Case, asked: Counter[str]) -> list[str]:
    """Return the contradictions of a law, and count it as asked, or as saying nothing about the scene."""
    wrong: list[str] = []
    try:
        wrong += LAWS[name](case)
        asked[name] += 1
    except NotAsked:
        asked["nothing to compare"] += 1
    except Contradiction as each:
        wrong.append(str(each))
    except Exception:  # noqa: BLE001 - whatever a command raises is told with its case
        wrong.append(traceback.format_exc())
    asked["contradictions"] += bool(wrong)
    return wrong


def main() -> None:
    """Print the contradictions, and how often each law was asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    laws = f"of {', '.join(LAWS)}; default: two drawn for each scene"
    parser.add_argument("laws", nargs="*", metavar="LAW", help=laws)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=40, help="scenes")
    parser.add_argument("--from", type=int, default=0, dest="first", help="number of the first scene")
    parser.add_argument("--told", action="store_true", help="print refusals")
    given = parser.parse_args()
    if unknown := set(given.laws) - LAWS.keys():
        parser.error(f"{', '.join(sorted(unknown))}: is no law ({laws})")
    asked: Counter[str] = Counter()
    for number in range(given.first, given.first + given.count):
        random, told = np.random.default_rng((given.seed, number)), []
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                case = made(random, told)
            except Contradiction as each:
                case = None
                asked["contradictions"] += 1
                print(f"{given.seed}/{number} new: {each}", flush=True)
            names = (given.laws or random.choice(list(LAWS), 2, replace=False)) if case else ()
            head = f"({Path('scene.yaml').read_text().splitlines()[0][:90]})" if case else ""
            for name in names:
                case.random = np.random.default_rng((given.seed, number, list(LAWS).index(name)))
                for each in judged(name, case, asked):
                    print(f"{given.seed}/{number} {name} {head}: {each}", flush=True)
            for each in told if given.told else ():
                print(f"{given.seed}/{number} told {head}: {each}", flush=True)
            os.chdir(CONFIGS)
    print(", ".join(f"{count} {what}" for what, count in asked.most_common()))


if __name__ == "__main__":
    main()
