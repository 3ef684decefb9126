"""Compose parts that differ from earlier ones in numbers only: nothing is written, P is filled from the parts.

Whatever affects the text is compared; each number is read from where the earlier composition read it. Tables, and parts
that affect more than calls of kernels, must be the same.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache
from operator import attrgetter
from typing import Any

import numpy as np

from screwsim.effects.base import (
    NOZZLE,
    ChamberState,
    FlowKind,
    FlowPath,
    HeatRate,
    LineLeak,
    Made,
    OilPort,
    OilThinning,
    PowerLoss,
    Reading,
    Separator,
    Shaft,
    SuctionChange,
    SuctionHeat,
    Wall,
)
from screwsim.model.breakpoints import breakpoints
from screwsim.model.composition import Composition, NumbersRecipe, StoredNumber
from screwsim.model.numbers import SPAN, fixed_numbers, operating
from screwsim.model.parts import Parts
from screwsim.model.slots import P_OMEGA
from screwsim.numerics.frozen import with_changes

Array = np.ndarray

BY_SPEED = ("omega", "tip_speed", SPAN)  # numbers of `operating` that follow from the mean speed
# fields of a part that affect the text as a whole, besides the names of its numbers; for the others, `_structure_of`
STRUCTURE: dict[type, tuple[str, ...]] = {
    FlowPath: ("to", "area", "offset", "opening", "narrow", "one_way", "beside", "port"),
    HeatRate: ("kernel", "oil_factor"),
    Wall: ("name", "conductance"),
    ChamberState: ("name", "rate", "positive"),
    OilPort: ("flow", "pumped"),
}
_STRUCTURE = {kind: attrgetter(*names) for kind, names in STRUCTURE.items()}
# parts of which the text has nothing, or (`Made`) the name alone: they may differ; all others must be equal
OUTSIDE_TEXT = (Made, OilThinning, PowerLoss, Reading, Shaft, Separator, SuctionChange, LineLeak, SuctionHeat)
OF_GAS = ("state", "phased_state", "specific_entropy", "varies")  # the same of a gas, besides the names of its values


def stored_numbers(parts: Parts, law: Any, numbers: Mapping[int, tuple[Any, str]]) -> tuple[StoredNumber, ...] | None:
    """Return where numbers, by index in P, are stored in parts; None where one is stored nowhere or ambiguously."""
    holders = list(_holders(parts, law))
    by_id = {id(each): i for i, each in enumerate(holders)}
    times, used = Counter(map(id, holders)), {id(holder) for holder, _ in numbers.values()}
    if any(times[each] != 1 for each in used):
        return None
    return tuple(
        StoredNumber(place, by_id[id(holder)], name, isinstance(holder, Mapping))
        for place, (holder, name) in numbers.items()
    )


def angles_of(parts: Parts, law: Any) -> tuple[Any, ...]:
    """Return everything that the breakpoints of parts follow from, unless an effect is a user's own (`breakpoints`)."""
    geometry, port = parts.geometry, parts.oil_port
    paths = [(*path.breakpoints, None, *path.own_breakpoints, path.offset) for _, path in parts.all(FlowPath)]
    of_law = tuple(law.breakpoints), tuple(law.own_breakpoints), () if port is None else tuple(port.breakpoints)
    return geometry.pitch, geometry.life, geometry.injection_angle, *of_law, *paths


def renumbered(before: Parts, composition: Composition, parts: Parts) -> Composition | None:
    """Return the composition of parts that differ from earlier ones in numbers only; None where more differs."""
    recipe = composition.recipe
    if recipe.held is None or not differ_in_numbers_only(parts, before):
        return None
    law = parts.geometry.volume_law()
    if _structure(parts, law) != _structure(before, recipe.law):
        return None
    holders, P = list(_holders(parts, law)), operating_numbers(recipe, parts)
    P[[each.place for each in recipe.held]] = [
        holders[at][name] if by_key else getattr(holders[at], name) for _, at, name, by_key in recipe.held
    ]
    angles = angles_of(parts, law)
    own = any("." in name for name, _ in parts.all(FlowPath))
    found = composition.breakpoints
    if own or angles != recipe.angles:
        found = breakpoints(parts, law)
    return with_changes(
        composition,
        P=P,
        breakpoints=found,
        recipe=NumbersRecipe(P.copy(), recipe.places, recipe.names, recipe.held, angles, law),
        starts=tuple(part.start for _, part in parts.all(ChamberState)),
    )


def operating_numbers(recipe: NumbersRecipe, parts: Parts) -> Array:
    """Return P as composed, with the numbers of other parts that may change while the structure stays."""
    P, head, named = recipe.P.copy(), fixed_numbers(parts), operating(parts)
    P[: len(head)] = head
    P[recipe.places] = [named[name] for name in recipe.names]
    return P


def set_speed(composition: Composition, parts: Parts, omega: float) -> None:
    """Set the mean speed [rad/s] in P, and what kernels read of it, to another than that of the parts."""
    recipe, named = composition.recipe, operating(with_changes(parts, omega=omega))
    composition.P[P_OMEGA] = omega
    for place, name in zip(recipe.places, recipe.names, strict=True):
        if name in BY_SPEED:
            composition.P[place] = named[name]


def differ_in_numbers_only(parts: Parts, other: Parts) -> bool:
    """Return whether parts, besides machine, effects and gas, differ in numbers only."""
    if parts.oil_content is not other.oil_content or list(parts.plenums) != list(other.plenums):
        return False
    if parts.oil_content is not None and parts.plenums != other.plenums:
        return False
    return list(parts.made) == list(other.made) and _supplied(parts) == _supplied(other)


def _supplied(parts: Parts) -> tuple[Any, ...]:
    """Return what affects the structure about the oil: nothing without oil, its transport, the names of its supply."""
    return () if parts.oil is None else (parts.oil.carried, *parts.oil.supply)


def _holders(parts: Parts, law: Any) -> Iterator[Any]:
    """Yield everything that stores numbers, in the order of the effects."""
    yield from (law, law.values, parts.gas.values, parts.made)
    for items in parts.effects.values():
        for part in items:
            if type(part) in STRUCTURE:
                yield from (part, part.values)
                if isinstance(part, FlowPath) and part.flow is not NOZZLE:
                    yield part.flow.values


def _structure(parts: Parts, law: Any) -> tuple[Any, ...]:
    """Return what affects the text about machine, gas and effects; equal where these differ in numbers only."""
    geometry, gas = parts.geometry, parts.gas
    return (
        (type(geometry), geometry.chambers, geometry.pitch, geometry.expands),
        (*(getattr(gas, name) for name in OF_GAS), gas.values.keys()),
        (law.volume, law.slope, law.mirror is None, law.values.keys(), _arrays(law)),
        [(name, [_structure_of(part) for part in items]) for name, items in parts.effects.items()],
    )


def _structure_of(part: Any) -> Any:
    """Return what affects the text about a part of an effect: some of its fields, its kind alone, or the whole part."""
    kind = type(part)
    if kind not in STRUCTURE:
        return kind if kind in OUTSIDE_TEXT else part
    found = [kind, _STRUCTURE[kind](part), part.values.keys()]
    if kind is FlowPath:
        found += [part.mirror is None, _arrays(part), part.flow is not NOZZLE and _structure_of_flow(part.flow)]
    if kind is Wall:
        found.append(part.temperature if isinstance(part.temperature, str) else type(part.temperature))
    return found


def _structure_of_flow(kind: FlowKind) -> Any:
    """Return what affects the text about a kind of flow: all its fields, but of its values only their names."""
    return [type(kind), kind.values.keys(), *(getattr(kind, name) for name in _fields_of(type(kind)))]


@cache
def _fields_of(kind: type[FlowKind]) -> list[str]:
    """Return the fields of a kind of flow that affect the text."""
    return [each.name for each in fields(kind) if each.name not in ("values", "title")]


def _arrays(part: Any) -> dict[str, list[int]]:
    """Return which arrays the tables of a part consist of."""
    return {name: list(map(id, curve)) for name, curve in part.tables.items()}
