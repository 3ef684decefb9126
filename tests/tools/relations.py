"""Solve random scenes and others that a law ties to them, and print the pairs that break their law.

Run: relations.py [LAW …] [--seed 1] [--count 100] [--effects STRUCTURE] [--told]. Each scene is one of
`effects_space.py`, a machine of `screwsim new` (`fuzz_new.py`), or one around a shipped one (`fuzz_courses.py`); each
law of the modules `relation_*.py` is asked of it. Figures may differ by the errors that both results tell, and by
`UNTOLD` of the wanted accuracy. Estimates may be beaten now and then: pairs further apart are counted, those more than
`FAR` times as far are printed, and make the exit code 1, and so does a twin that fails. Scenes that are not ok, or that
warn of their accuracy, say nothing.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
import effects_space  # noqa: E402
import fuzz_new  # noqa: E402
import relation_figures  # noqa: E402, F401  each adds its laws
import relation_inputs  # noqa: E402, F401
import relation_laws  # noqa: E402, F401
import relation_similar  # noqa: E402, F401
import relation_slopes  # noqa: E402, F401
import relation_ways  # noqa: E402, F401
from fuzz_courses import KINDS, course  # noqa: E402
from judging import Stopped, limited  # noqa: E402
from relating import LAWS, Case, Law, Lost, NotAsked, Pair  # noqa: E402

from screwsim.figures.errors import relative_errors  # noqa: E402
from screwsim.inputs.faults import SceneError, UsageError  # noqa: E402
from screwsim.outputs import Result  # noqa: E402
from screwsim.scene import Scene, loads  # noqa: E402

UNTOLD = 0.05  # of the wanted accuracy: differences that no estimate has to tell
FAR = 3.0  # times what is told: a pair that breaks its law
SECONDS = 20.0  # for a law of a scene
OF_EFFECTS, OF_NEW = 0.6, 0.2  # shares of the scenes; the others lie around shipped ones


class Broken(NamedTuple):
    """How far a pair is from its law, over what may be, and in which figure."""

    off: float
    figure: str
    what: str


def scenes(seed: int, count: int, structure: str = "") -> Iterator[tuple[str, Scene, np.random.Generator]]:
    """Yield names of random scenes, the scenes, and the random numbers of their pairs."""
    for index in range(count):
        random = np.random.default_rng((seed, index))
        share = 0.0 if structure else random.random()
        try:
            if share < OF_EFFECTS:
                name = structure or str(random.choice(list(effects_space.STRUCTURES)))
                yield f"{index} ({name}, {seed})", effects_space.scene_of(name, seed, index), random
            elif share < OF_EFFECTS + OF_NEW:
                kind, stated = fuzz_new.drawn(random)
                yield f"{index} (new {kind} {stated})", loads(fuzz_new.written(kind, stated)), random
            else:
                name = str(random.choice(list(KINDS)))
                yield f"{index} ({name})", course(KINDS[name], seed * 1000 + index, 1)[0], random
        except (SceneError, UsageError):
            continue


def told(one: Result, other: Result, accuracy: float) -> dict[str, float]:
    """Return by how much figures of two results may differ, relative to their scales."""
    names = one.error.keys() & other.error.keys()
    errors = {name: [each.error.get(name) for each in (one, other)] for name in names}
    return {
        name: UNTOLD * accuracy + sum(accuracy if error is None else error for error in pair)
        for name, pair in errors.items()
    }


def off(pair: Pair, accuracy: float) -> list[Broken]:
    """Return how far each figure of a pair is from its law, over what both results tell."""
    if pair.broken is not None:
        return [Broken(_number(pair.broken), pair.what, pair.what)]
    one, other = pair.expected, pair.found
    allowed = told(one, other, accuracy)
    found = []
    for name, size in relative_errors(other.performance, one.performance).items():
        if size is None or name not in allowed or (pair.only and name not in pair.only) or name in pair.without:
            continue
        words = f"{pair.what}: {name} {other.performance[name]:.9g}, not {one.performance[name]:.9g}"
        beyond = _number(max(size - pair.slack, 0.0) / allowed[name])
        found.append(Broken(beyond, name, f"{words} (off by {size:.2g})"))
    return found


def _number(beyond: float) -> float:
    """Return how far a pair is from its law; infinity where that is no number, as of figures that are none."""
    return math.inf if math.isnan(beyond) else beyond


def asked(law: Law, case: Case) -> tuple[list[list[Broken]], str]:
    """Return for each pair of a law how far its figures are from it, and why a twin of a scene that is ok is not."""
    found: list[list[Broken]] = []
    try:
        with limited(SECONDS):
            for pair in law(case):
                found.append(off(pair, case.scene.numerics.accuracy))
    except Lost as why:
        return found, f"lost: {why}"
    except (SceneError, UsageError) as why:
        return found, f"refused: {why}"
    except (NotAsked, Stopped):
        pass
    except Exception as error:  # noqa: BLE001  no scene may cause any other
        found.append([Broken(math.inf, type(error).__name__, f"{type(error).__name__}: {error}")])
    return found, ""


def summary(rows: Mapping[str, list[list[Broken]]]) -> Iterator[str]:
    """Yield a line for each law: pairs (or that it has none), figures, how many are beyond what is told, the worst."""
    for law, pairs in rows.items():
        figures = [each for pair in pairs for each in pair]
        if not figures:
            yield f"{law}: no pairs"
            continue
        beyond, far = (sum(any(each.off > most for each in pair) for pair in pairs) for most in (1.0, FAR))
        worst = max(figures)
        yield (
            f"{law}: {len(pairs)} pairs, {len(figures)} figures, {beyond} pairs beyond, {far} far; "
            f"worst {worst.off:.2g} ({worst.figure})"
        )


def related(
    seed: int, count: int, laws: list[str], structure: str = "", refusals: bool = False
) -> dict[str, list[list[Broken]]]:
    """Ask laws of random scenes; print each pair that is far off as it is found, and return all."""
    rows: dict[str, list[list[Broken]]] = defaultdict(list)
    for name, scene, random in scenes(seed, count, structure):
        case = Case(scene, random)
        for law in laws:
            pairs, lost = asked(LAWS[law], case)
            rows[law] += pairs
            if lost and (refusals or not lost.startswith("refused")):
                print(f"{name}: {law}: {lost}", flush=True)
            for worst in (max(pair) for pair in pairs if pair):
                if worst.off > FAR:
                    print(f"{name}: {law}: {worst.off:.3g} times what is told: {worst.what}", flush=True)
    return rows


def main() -> int:
    """Ask the laws that are named, or all, and print what breaks them; return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("laws", nargs="*", help=f"of {', '.join(LAWS)}; all where none is named")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--effects", default="", metavar="STRUCTURE", help="scenes of this one of effects_space alone")
    parser.add_argument("--told", action="store_true", help="print refused scenes, too")
    given = parser.parse_args()
    if unknown := set(given.laws) - set(LAWS):
        parser.error(f"no such law: {', '.join(sorted(unknown))}; known: {', '.join(LAWS)}")
    rows = related(given.seed, given.count, given.laws or list(LAWS), given.effects, given.told)
    print("\n".join(summary(rows)))
    return int(any(each.off > FAR for pairs in rows.values() for pair in pairs for each in pair))


if __name__ == "__main__":
    sys.exit(main())
