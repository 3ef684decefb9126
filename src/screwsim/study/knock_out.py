"""Knock-out: what each effect costs when it is left out and the scene is solved again (docs/model.md M60).

Each scene is that of `--without EFFECT`. Effects act on each other, so that the changes need not add up.
"""

from __future__ import annotations

from dataclasses import replace

from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs import Figures, Result
from screwsim.scene import loads
from screwsim.scene.types import Scene
from screwsim.study.progress import Progress, Silent

REFRIGERATION = ("cooling_capacity", "cop")


def knock_out(scene: Scene, result: Result, progress: Progress | None = None) -> Result:
    """Return the result with `knock_out`: for each of its effects the change of shaft power and of specific work.

    Where the scene calls for them, of cooling capacity and COP too.

    An effect that the scene cannot do without has the status `needed`, with the reason as its message; one without
    which the cycle does not close has the status of that solution, and no figures. What is to be doubted without an
    effect, and is not of the whole scene, stands in its message.
    """
    progress = progress or Silent()
    costs = []
    progress.start(len(scene.effects), 0)
    try:
        for name in scene.effects:
            costs.append(_without(scene, name, result))
            progress.advance(1, int(costs[-1].status not in ("ok", "needed")))
    finally:
        progress.stop()
    return replace(result, knock_out=tuple(costs))


def _without(scene: Scene, name: str, result: Result) -> Figures:
    """Return what leaving one effect out changes."""
    from screwsim.simulate import simulate

    cooled = [each for each in REFRIGERATION if each in result.performance]
    figures = (f"{word}{each}" for each in ("shaft_power", "specific_work", *cooled) for word in ("", "change_of_"))
    found = Figures(effect=name, status="needed", message="", **dict.fromkeys(figures))
    try:
        other = simulate(loads(scene.text, folder=scene.folder, without=[name]), trace=False)
    except SceneError as error:
        return Figures(found, message="; ".join(line.removeprefix("<text>:") for line in error.lines))
    except UsageError as error:
        return Figures(found, message=str(error))
    found |= {"status": other.status, "message": other.message}
    if other.status != "ok":
        return Figures(found)
    doubts = [warning for warning in other.warnings if warning not in result.warnings]
    before, after = (specific_work(each) for each in (result, other))
    power = other.performance.shaft_power
    found |= {"shaft_power": power, "change_of_shaft_power": power - result.performance.shaft_power}
    for each in cooled:
        value, full = other.performance.get(each), result.performance[each]
        found |= {each: value, f"change_of_{each}": None if value is None or full is None else value - full}
    if after is None:
        doubts.insert(0, "no net gas is delivered without it")
    elif before is not None:
        found |= {"specific_work": after, "change_of_specific_work": after - before}
    return Figures(found, message="; ".join(doubts))


def specific_work(result: Result) -> float | None:
    """Return shaft power over net gas flow [J/kg]; None where no gas is delivered."""
    flow = result.performance.gas_mass_flow
    return result.performance.shaft_power / flow if flow > 0.0 else None
