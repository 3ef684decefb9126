"""Sizes that a maker has: read, and the next one up that meets a goal."""

import re
from collections.abc import Iterable, Sequence

from screwsim.inputs.faults import UsageError
from screwsim.scene import Scene
from screwsim.scene.units import NUMBER
from screwsim.study.inputs import read_text
from screwsim.study.seek.found import Size
from screwsim.study.seek.trials import Trial, Trials

SAME = 1e-9  # relative: a size is the value itself


def read_catalogue(scene: Scene, path: str, text: str) -> tuple[float, ...]:
    """Return the sizes [SI] of '140, 163, 204 mm', ascending; a unit holds for all before it without one."""
    parts = [part.strip() for part in text.split(",")]
    last = re.fullmatch(rf"{NUMBER}\s*(.*)", parts[-1])
    unit = last[1].strip() if last else ""
    whole = [f"{part} {unit}" if re.fullmatch(NUMBER, part) and unit else part for part in parts]
    try:
        sizes = [read_text(scene, path, part) for part in whole if part]
    except UsageError as error:
        raise UsageError(f"--catalogue {text}: {error}") from None
    if len(set(sizes)) < 2:
        raise UsageError(f"--catalogue {text}: names {len(set(sizes))} size (write e.g. 140,163,204,255,321 mm)")
    return tuple(sorted(set(sizes)))


def next_size(trials: Trials, met: Trial | None, sizes: Iterable[float]) -> Size | None:
    """Return the smallest size from the value found on that is at the goal or beyond it; None where none is.

    Beyond is the side to which the figure goes as the size grows. Where no value meets the goal, because every size is
    beyond it, that is the smallest size.
    """
    sizes = list(sizes)
    span, direction = trials.spans[0], _direction(trials)
    least = sizes[0] if met is None else span.value(met.places[0])
    for size in (each for each in sizes if each >= least * (1.0 - SAME)):
        trial = trials.at(span.place(size))
        if trial.off is not None and trial.result is not None and _beyond(trials, trial, direction):
            return Size(size, trial.off[0] + trials.goals[0].value, trial.result)
    return None


def _direction(trials: Trials) -> float:
    row = sorted(trials.closed, key=lambda trial: trial.places)
    ends: Sequence[float] = [(trial.off or (0.0,))[0] for trial in row]
    return 1.0 if len(ends) < 2 or ends[-1] >= ends[0] else -1.0


def _beyond(trials: Trials, trial: Trial, direction: float) -> bool:
    assert trial.off is not None
    return direction * trial.off[0] >= 0.0 or trials.met(trial)
