"""Compose parts that differ from earlier ones in numbers only: nothing is written, P is filled from the parts.

Whatever affects the text is compared; each number is read from where the earlier composition read it. Tables, and parts
that affect more than calls of kernels, must be the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from operator import attrgetter
from typing import Any

import numpy as np

from screwsim.effects.base import (
    ChamberState,
    FlowPath,
    HeatRate,
    OilGas,
    OilPort,
    OilRoom,
    Plenum,
    Pulsation,
    Resistance,
    Scaled,
    Shaft,
    Stops,
    SuctionLine,
    Wall,
)
from screwsim.fluid.gas import Gas
from screwsim.model.breakpoints import breakpoints
from screwsim.model.composition import Composition, NumbersRecipe, StoredNumber
from screwsim.model.numbers import fixed_numbers, operating
from screwsim.model.parts import Parts
from screwsim.numerics.frozen import with_changes

Array = np.ndarray

# fields of a part that affect the text, besides the names of its numbers
STRUCTURE: dict[type, Callable[[Any], Any]] = {
    FlowPath: attrgetter("to", "area", "offset", "opening", "narrow", "one_way", "beside", "port", "law"),
    Resistance: attrgetter("share", "film", "drag"),
    HeatRate: attrgetter("kernel", "oil_factor"),
    Wall: attrgetter("name", "conductance"),
    ChamberState: attrgetter("name", "rate", "positive"),
    OilPort: attrgetter("flow", "pumped"),
}
OF_GAS = ("state", "phased_state", "specific_entropy", "varies")  # the same of a gas, besides the names of its values
WHOLE = (OilGas, OilRoom, Plenum, Pulsation, Scaled, Shaft, Stops, SuctionLine)  # parts that must be equal


def stored_numbers(parts: Parts, law: Any, numbers: Mapping[int, tuple[Any, str]]) -> tuple[StoredNumber, ...] | None:
    """Return where numbers, by index in P, are stored in parts; None where one is stored nowhere or ambiguously."""
    holders = list(_holders(parts, law))
    by_id = {id(each): i for i, each in enumerate(holders)}
    if len(by_id) < len(holders) or not all(id(holder) in by_id for holder, _ in numbers.values()):
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
    if recipe.held is None or not _gas_alike(parts.gas, before.gas) or not differ_in_numbers_only(parts, before):
        return None
    law = parts.geometry.volume_law()
    if not _machine_alike(parts, before) or not _law_alike(law, recipe.law) or not _effects_alike(parts, before):
        return None
    holders, P = list(_holders(parts, law)), operating_numbers(recipe, parts)
    P[[each.place for each in recipe.held]] = [
        holders[at][name] if by_key else getattr(holders[at], name) for _, at, name, by_key in recipe.held
    ]
    angles, paths, port = angles_of(parts, law), parts.all(FlowPath), parts.oil_port
    own = any("." in name for name, _ in paths)
    found = composition.breakpoints
    if own or angles != recipe.angles:
        found = breakpoints(parts, law, paths, () if port is None else port.breakpoints)
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


def differ_in_numbers_only(parts: Parts, other: Parts) -> bool:
    """Return whether parts, besides machine, effects and gas, differ in numbers only."""
    if parts.oil_content is not other.oil_content or list(parts.plenums) != list(other.plenums):
        return False
    if parts.oil_content is not None and parts.plenums != other.plenums:
        return False
    return list(parts.made) == list(other.made) and _supplied(parts) == _supplied(other)


def _gas_alike(gas: Gas, other: Gas) -> bool:
    """Return whether the contributions of two gases to the text differ in numbers only."""
    if gas == other:
        return True
    kernels = all(getattr(gas, name) == getattr(other, name) for name in OF_GAS)
    return kernels and gas.values.keys() == other.values.keys()


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
                if isinstance(part, FlowPath) and part.resistance is not None:
                    yield part.resistance.values


def _machine_alike(parts: Parts, other: Parts) -> bool:
    """Return whether two machines have the same structure, apart from their laws."""
    one, two = parts.geometry, other.geometry
    return type(one) is type(two) and one.chambers == two.chambers and one.expands == two.expands


def _law_alike(law: Any, other: Any) -> bool:
    """Return whether two laws of volume differ in numbers only."""
    kernels = law.volume is other.volume and law.slope is other.slope
    mirrored = (law.mirror is None) == (other.mirror is None)
    return kernels and mirrored and law.values.keys() == other.values.keys() and _same_tables(law, other)


def _same_tables(part: Any, other: Any) -> bool:
    """Return whether two parts have the same tables (identical arrays)."""
    one, two = part.tables, other.tables
    if not (one or two):
        return True
    return one.keys() == two.keys() and all(_same_arrays(one[name], two[name]) for name in one)


def _same_arrays(curve: Sequence[Any], other: Sequence[Any]) -> bool:
    return len(curve) == len(other) and all(one is two for one, two in zip(curve, other, strict=True))


def _effects_alike(parts: Parts, other: Parts) -> bool:
    """Return whether all contributions of effects to the text differ in numbers only."""
    if parts.effects.keys() != other.effects.keys():
        return False
    pairs = [(items, other.effects[name]) for name, items in parts.effects.items()]
    if list(parts.effects) != list(other.effects) or any(len(items) != len(others) for items, others in pairs):
        return False
    return all(_alike(one, two) for items, others in pairs for one, two in zip(items, others, strict=True))


def _alike(part: Any, other: Any) -> bool:
    """Return whether the contributions of two parts to the text differ in numbers only."""
    if part is other:
        return True
    kind = type(part)
    if kind is not type(other):
        return False
    structure = STRUCTURE.get(kind)
    if structure is None:
        return part == other if isinstance(part, (*WHOLE, *STRUCTURE)) else True
    if structure(part) != structure(other) or part.values.keys() != other.values.keys():
        return False
    if kind is FlowPath:
        mirrored, held_back = (part.mirror is None) == (other.mirror is None), part.resistance
        if held_back is None or other.resistance is None:
            return mirrored and held_back is other.resistance and _same_tables(part, other)
        return mirrored and _same_tables(part, other) and _alike(held_back, other.resistance)
    if kind is Wall:
        return type(part.temperature) is type(other.temperature) and (
            not isinstance(part.temperature, str) or part.temperature == other.temperature
        )
    return True
