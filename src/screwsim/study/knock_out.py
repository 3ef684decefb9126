"""Knock-out: what each effect costs, found by leaving it out and solving the scene again (docs/model.md M60).

Each scene is that of `--without EFFECT`. Effects interact, so that the changes need not add up.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

from screwsim.effects.parts.usual import FRICTION, LEAK, OIL_FRICTION, OIL_HEAT, WALLS, WAY_IN, WAY_OUT
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.inputs.suggestions import nearest
from screwsim.machine.kinds import kind_of
from screwsim.outputs import Figures, Result
from screwsim.scene import loads
from screwsim.scene.types import Scene
from screwsim.study.pool.progress import Progress

REFRIGERATION = ("cooling_capacity", "cop")
# roles of effects by which a kind of machine groups them (`effects.parts.usual`)
GROUPS = {"leaks": (LEAK,), "oil": (OIL_HEAT, OIL_FRICTION), "friction": (FRICTION,), "walls": (WALLS,)}


class LeftOut(NamedTuple):
    """Effects that are left out together, and their name in the table."""

    name: str
    effects: tuple[str, ...]


def each_alone(scene: Scene) -> tuple[LeftOut, ...]:
    """Return each effect of a scene, to be left out by itself."""
    return tuple(LeftOut(name, (name,)) for name in scene.effects)


def read_groups(scene: Scene, texts: Iterable[str]) -> tuple[LeftOut, ...]:
    """Return the groups that texts name, each a group or effects separated by commas; raise UsageError in one line."""
    return tuple(dict.fromkeys(_group(scene, text) for text in texts))


def _group(scene: Scene, text: str) -> LeftOut:
    offers = kind_of(scene.machine).offers
    names: list[str] = []
    for word in filter(None, (part.strip() for part in text.split(","))):
        if word in scene.effects:
            names.append(word)
            continue
        if word not in GROUPS:
            known = (*GROUPS, *scene.effects)
            near = nearest(word, known)
            hint = f"did you mean '{near}'?" if near else f"groups are {', '.join(GROUPS)}"
            raise UsageError(f"--together {text}: {word} is neither a group nor an effect of this scene ({hint})")
        own = [
            name
            for name, active in scene.effects.items()
            if any(offer in offers and what in GROUPS[word] for offer, what in active.effect.usual.items())
        ]
        if not own:
            raise UsageError(f"--together {text}: the scene simulates no effect of group {word} (remove it)")
        names += own
    if not names:
        raise UsageError(f"--together {text}: names nothing (write e.g. --together leaks)")
    return LeftOut(text.replace(" ", "").strip(",").replace(",", "+"), tuple(dict.fromkeys(names)))


def knock_out(scene: Scene, result: Result, left_out: Sequence[LeftOut], progress: Progress) -> Result:
    """Return the result with `knock_out`: changes of shaft power and specific work when effects are left out.

    Where the scene calls for them, changes of cooling capacity and COP are included.

    An effect that the scene cannot do without has the status `needed`, with the reason as its message, and so has a way
    in or out of the chambers without which the cycle does not close. Any other without which it does not close has the
    status of that solution, and no figures. Warnings that appear only without
    the effect are in its message.
    """
    costs = []
    progress.start(len(left_out), 0)
    try:
        for each in left_out:
            costs.append(_without(scene, each, result))
            progress.advance(1, int(costs[-1].status not in ("ok", "needed")))
    finally:
        progress.stop()
    return replace(result, knock_out=tuple(costs))


def _without(scene: Scene, left: LeftOut, result: Result) -> Figures:
    """Return the changes when one effect, or several together, are left out."""
    from screwsim.simulate import simulate

    cooled = [each for each in REFRIGERATION if each in result.performance]
    figures = (f"{word}{each}" for each in ("shaft_power", "specific_work", *cooled) for word in ("", "change_of_"))
    found = Figures(effect=left.name, status="needed", message="", **dict.fromkeys(figures))
    try:
        other = simulate(loads(scene.text, folder=scene.folder, without=list(left.effects)), trace=False)
    except SceneError as error:
        return Figures(found, message="; ".join(line.removeprefix("<text>:") for line in error.lines))
    except UsageError as error:
        return Figures(found, message=str(error))
    if other.status != "ok":
        ways = any(role in scene.effects[name].effect.roles for name in left.effects for role in (WAY_IN, WAY_OUT))
        return Figures(found, status="needed" if ways else other.status, message=other.message)
    found |= {"status": other.status, "message": other.message}
    doubts = [warning for warning in other.warnings if warning not in result.warnings]
    before, after = (specific_work(each) for each in (result, other))
    power = other.performance.shaft_power
    found |= {"shaft_power": power, "change_of_shaft_power": power - result.performance.shaft_power}
    for each in cooled:
        value, full = other.performance.get(each), result.performance[each]
        found |= {each: value, f"change_of_{each}": None if value is None or full is None else value - full}
    if after is None:
        doubts.insert(0, "without it no net gas is delivered")
    elif before is not None:
        found |= {"specific_work": after, "change_of_specific_work": after - before}
    return Figures(found, message="; ".join(doubts))


def specific_work(result: Result) -> float | None:
    """Return shaft power over net gas flow [J/kg]; None where no gas is delivered."""
    flow = result.performance.gas_mass_flow
    return result.performance.shaft_power / flow if flow > 0.0 else None
