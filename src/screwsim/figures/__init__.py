"""Figures that a scene calls for: those of the core, by what the scene states, and those that effects declare.

Their numerical errors (`errors`) and their customary units (`engineering`) have modules of their own.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, fields, is_dataclass
from functools import cache
from operator import is_
from typing import Any

from screwsim.effects import catalogue, having, imported
from screwsim.effects.base import Effect, PowerLoss, Reading, SuctionChange
from screwsim.effects.parts.oil import oil_in_chambers
from screwsim.figures.curves import known_traces, reading_figure, trace_variable
from screwsim.fluid.composition import is_blend
from screwsim.inputs.faults import ImpossibleValue, UsageError
from screwsim.model.parts import Parts
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.outputs.core import (
    AFTERCOOLED,
    CHANGED,
    GLIDING,
    HEATED,
    HELD,
    PERFORMANCE,
    STAGES,
    SUBCRITICAL,
    WALLED,
    WETTED,
)
from screwsim.outputs.declared import ITSELF, TIMES, Figure, Scale
from screwsim.outputs.display import ShownFigure
from screwsim.outputs.figures import ListedFigures, shown_of
from screwsim.scene.lines import saturates
from screwsim.scene.types import ActiveEffect, Scene

_ROLES: Mapping[str, Callable[[Scene, Parts], bool]] = {  # conditions on a scene that no single key expresses
    HEATED[0]: lambda scene, parts: oil_in_chambers(scene.effects),
    CHANGED[0]: lambda scene, parts: bool(parts.all(SuctionChange)) or parts.suction_line,
    WALLED[0]: lambda scene, parts: bool(parts.walls),
    HELD[0]: lambda scene, parts: parts.dissolves,
    SUBCRITICAL[0]: lambda scene, parts: saturates(scene),
    GLIDING[0]: lambda scene, parts: saturates(scene) and is_blend(scene.gas.name),
    WETTED[0]: lambda scene, parts: saturates(scene) and scene.gas.equilibrium and not is_blend(scene.gas.name),
    AFTERCOOLED[1]: lambda scene, parts: scene.gas.relative_humidity is not None and _has(scene, AFTERCOOLED[1]),
}


class Performance(ListedFigures):
    """Performance figures with their declarations; the error for a missing one says what would call for it.

    `about` holds the figures that the scene calls for, also of a case that failed.
    """

    def __init__(self, values: Mapping[str, Any], about: Mapping[str, Figure]) -> None:
        super().__init__(values)
        self.about = about

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "about":  # not there yet, as where a copy is being made
            raise AttributeError(name)
        return super().__getattr__(name)

    def lacks(self, name: str) -> str:
        """Return in words why there is no such figure."""
        if name in self.about:
            return f"no figure {name!r} here: the case failed (see its message)"
        if needs := needs_of(name):
            return f"no figure {name!r} here: it needs {needs}"
        return super().lacks(name)

    def described(self, name: str) -> ShownFigure | None:
        """Return unit and meaning of a figure; None where it is not declared."""
        about = self.about.get(name) or PERFORMANCE.get(name)
        return None if about is None else shown_of(about, self.get(name))

    def copy(self) -> Performance:
        """Return a copy of the figures that may be changed."""
        return Performance(self, self.about)


@cache
def known() -> dict[str, Figure]:
    """Return every figure that the core and the effects of the catalogue declare."""
    return PERFORMANCE | {each.name: each for effect in catalogue().values() for each in effect.figures}


def declaration(name: str, figures: Any = None) -> Figure | None:
    """Return the declaration of a figure: of the results `figures`, of this program, or of an imported user effect.

    Those of this program include the figures that only two stages have, and curves at angles.
    """
    about: Mapping[str, Figure] = getattr(figures, "about", {})
    found = about.get(name) or known().get(name) or STAGES.get(name) or reading_figure(name)
    if found is None:
        found = next((each for effect in imported().values() for each in effect.figures if each.name == name), None)
    return found


def declared(name: str, figures: Any = None) -> Figure:
    """Return the declaration of a figure (`declaration`); raise ValueError where there is none."""
    about = declaration(name, figures)
    if about is None:
        where = "no entry in screwsim.outputs, and no effect declares it"
        raise ValueError(f"performance.{name} has {where} (add its unit and meaning there)")
    return about


def needs_of(name: str) -> str:
    """Return in words what calls for a figure; empty where nothing does, or every scene does."""
    if name in PERFORMANCE:
        return " or ".join(map(_with_effects, PERFORMANCE[name].needs))
    every = (catalogue() | imported()).items()
    givers = ((effect, each) for effect, declares in every for each in declares.figures if each.name == name)
    return " or ".join(dict.fromkeys(_giving_effect(effect, figure) for effect, figure in givers))


def _with_effects(need: str) -> str:
    """Return the condition for a figure of the core; for a role of effects also the catalogue's effects with it."""
    those = having(need)
    return f"{need}, such as {' or '.join(those)}" if those else need


def _has(scene: Scene, role: str) -> bool:
    every = ((active, active.effect.roles.get(role)) for active in scene.effects.values())
    return any(key is not None and (not key or _states(scene, active.parameters, key)) for active, key in every)


def _giving_effect(effect: str, figure: Figure) -> str:
    own = [f"effects.{effect}{need}" for need in figure.needs if need.startswith(".")]
    others = [_with_effects(need) for need in figure.needs if not need.startswith(".")]
    return " or ".join(own or [f"effects.{effect}"]) + (f", and {' or '.join(others)}" if others and not own else "")


_last_called_for: tuple[tuple[Any, ...], Any, dict[str, Figure]] = (), None, {}


def called_for(scene: Scene, parts: Parts) -> dict[str, Figure]:
    """Return the figures that a scene calls for; those of the previous case are reused where both state the same.

    Raise UsageError, in one line, where an effect gives a figure that is declared nowhere.
    """
    global _last_called_for
    same = scene.effects, parts.effects, scene.machine, scene.gas, scene.oil, parts.geometry
    operation = _stated(scene.operation), _stated(scene.oil_supply), parts.oil is None, parts.set_speed is None
    operation = *operation, saturates(scene)
    last, stated, found = _last_called_for  # read as one: threads share it
    if len(last) != len(same) or stated != operation or not all(map(is_, same, last)):
        found = _called_for(scene, parts)
        _last_called_for = same, operation, found
    return dict(found)


@IdentityCache
def _stated(part: Any) -> Any:
    """Return which values a section states, and its words: these decide which figures are called for."""
    if isinstance(part, float) or part is None:  # most of them
        return part is None
    if is_dataclass(part):
        values = vars(part).values()
        return tuple([value is None if value is None or type(value) is float else _stated(value) for value in values])
    return part if isinstance(part, str) else False


def _called_for(scene: Scene, parts: Parts) -> dict[str, Figure]:
    """Return the core's figures, with the effects' losses before the shaft power, then other figures."""
    given = dict(_given_figures(scene, parts))
    losses = {part.figure for _, part in parts.all(PowerLoss)}
    called: dict[str, Figure] = {}
    met = {needs: _is_met(needs, scene, parts) for needs in {each.needs for each in PERFORMANCE.values()}}
    for each in PERFORMANCE.values():
        if each.name == "shaft_power":
            called |= {name: figure for name, figure in given.items() if name in losses}
        if met[each.needs]:
            called[each.name] = each
    return called | given


def _given_figures(scene: Scene, parts: Parts) -> Iterator[tuple[str, Figure]]:
    """Yield the figures that effects give, as they declare them, or as the core or another effect declares them."""
    whose: dict[str, tuple[str, Figure]] = {}
    for name, active in scene.effects.items():
        own = {each.name: each for each in active.effect.figures}
        parts_of = parts.effects.get(name, ())
        told = [part.figure for part in parts_of if isinstance(part, PowerLoss)]
        told += [figure for part in parts_of if isinstance(part, Reading) for figure in part.figures]
        for figure in dict.fromkeys((*own, *told)):
            about = own.get(figure) or known().get(figure)
            if about is None:
                remedy = f"write figures=(Figure({figure!r}, unit, meaning),) in its EFFECT"
                raise UsageError(f"effects.{name}: its figure {figure} is declared nowhere ({remedy})")
            first, before = whose.setdefault(figure, (name, about))
            if before != about or PERFORMANCE.get(figure, about) != about:
                whom = "the program" if figure in PERFORMANCE else f"effects.{first}"
                raise UsageError(f"effects.{name}: {whom} has a different figure {figure} (rename its own)")
            if _is_met(about.needs, scene, parts, active.parameters):
                yield figure, about


def figures_declared_elsewhere(name: str, effect: Effect, given: Iterable[str]) -> dict[str, Figure]:
    """Return the figures that an effect gives but others declare; raise Impossible where one is declared nowhere."""
    own = {each.name for each in effect.figures}
    nobody = next((figure for figure in given if figure not in own and figure not in known()), None)
    if nobody is not None:
        raise ImpossibleValue(name, f"its figure {nobody} is declared nowhere (EFFECT.figures)")
    return {figure: known()[figure] for figure in given if figure not in own}


def _is_met(needs: tuple[str, ...], scene: Scene, parts: Parts, parameters: Any = None) -> bool:
    return not needs or any(_is_there(need, scene, parts, parameters) for need in needs)


def _is_there(need: str, scene: Scene, parts: Parts, parameters: Any) -> bool:
    if need in _ROLES:
        return _ROLES[need](scene, parts)
    return all(_states(scene, parameters, *key.split(": ")) for key in need.split(" and "))


def _states(scene: Scene, parameters: Any, path: str, word: str = "") -> bool:
    """Tell whether a scene states a path ('.key': of the effect's parameters), with `word` that it is that word."""
    value: Any = parameters if path.startswith(".") else scene
    for name in path.removeprefix(".").split("."):
        if isinstance(value, ActiveEffect):
            value = value.parameters
        value = value.get(name) if isinstance(value, Mapping) else getattr(value, name, None)
    return value is not None and word in ("", value)


def merged(one: Iterable[Figure], other: Iterable[Figure]) -> tuple[Figure, ...]:
    """Return the figures of both, each one that only `other` has behind its predecessor there."""
    every = list(one)
    names = [each.name for each in every]
    place = 0
    for each in other:
        if each.name in names:
            place = names.index(each.name) + 1
            continue
        every.insert(place, each)
        names.insert(place, each.name)
        place += 1
    return tuple(every)


def packed(scale: Scale) -> str:
    """Return an error scale as text: its values other than the defaults, as JSON."""
    return json.dumps({name: value for name, value in asdict(scale).items() if value != getattr(ITSELF, name)})


def unpacked(text: str) -> Scale | None:
    """Return an error scale from its text; None where the text is not one."""
    with suppress(ValueError, TypeError, AttributeError):
        return scale_of(json.loads(text))
    return None


def scale_of(values: Mapping[str, Any]) -> Scale:
    """Return an error scale from values by name; raise TypeError where they are not valid."""
    given: dict[str, Any] = {**values, "of": tuple(values.get("of", ()))}
    scale = Scale(**given)
    kinds = (isinstance(getattr(scale, each.name), type(each.default)) for each in fields(Scale))
    if not all((*kinds, *(isinstance(name, str) for name in scale.of))) or scale.times not in TIMES:
        raise TypeError("a scale of errors has other values")
    return scale


def rotor_speed(found: Mapping[str, Any], stated: float) -> float:
    """Return the mean speed [rad/s] of rotors or crank: among figures where a drive reaches it, else the stated one."""
    reached = found.get("mean_speed")
    return float(stated if reached is None else reached)
