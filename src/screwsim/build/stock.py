"""Machine, gas and effects of a scene, kept for the next one of a sweep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from screwsim.build.gas import build_gas
from screwsim.build.site import around_of
from screwsim.effects.base import (
    Around,
    ChamberState,
    FlowPath,
    HeatRate,
    LineLeak,
    Made,
    Scaled,
    Wall,
)
from screwsim.fluid.gas import Gas
from screwsim.fluid.settings import GasSettings
from screwsim.machine.kinds import kind_of
from screwsim.machine.protocol import MachineGeometry, MachineSettings
from screwsim.model.parts import Effects
from screwsim.scene.lines import Lines
from screwsim.scene.types import ActiveEffect, Scene

Numbered = FlowPath | HeatRate | Wall | ChamberState | LineLeak


class _Built(NamedTuple):
    """Parts of an effect, and what they were built of beside the machine."""

    active: ActiveEffect
    numbers: Mapping[str, float]
    parts: list[Any]


class Stock:
    """What was built of machine and effects for the scene before: the next of a sweep shares most of it.

    Sections that are the same objects give the same parts, which is what `model.series.Composer` looks for.
    """

    def __init__(self) -> None:
        self._gas: tuple[GasSettings, Gas] | None = None
        self._geometry: Any = None
        self._built: dict[str, _Built] = {}
        self._effects = Effects()

    def gas(self, scene: Scene) -> Gas:
        """Return the gas of a scene; the same one where nothing but the scene's gas tells it."""
        settings = scene.gas
        if (settings.model != "real" and settings.isentropic_exponent is None) or settings.relative_humidity:
            return build_gas(scene)
        if self._gas is None or self._gas[0] is not settings:
            self._gas = settings, build_gas(scene)
        return self._gas[1]

    def geometry(self, machine: MachineSettings) -> MachineGeometry:
        """Return the geometry of a machine."""
        if self._geometry is None or self._geometry.settings is not machine:
            self._geometry = kind_of(machine).geometry(machine)
            self._built, self._effects = {}, Effects()
        return self._geometry

    def effects(self, scene: Scene, geometry: Any, at: Lines) -> Effects:
        """Return the parts of a scene's effects, on the geometry that was asked for last."""
        around = around_of(scene, at)
        found = {name: self._effect(name, active, geometry, around) for name, active in scene.effects.items()}
        same = list(found) == list(self._built) and all(found[name] is self._built[name] for name in found)
        if not same:
            self._built = found
            self._effects = Effects(_acting({name: built.parts for name, built in found.items()}))
        return self._effects

    def _effect(self, name: str, active: ActiveEffect, geometry: Any, around: Around) -> _Built:
        effect, last = active.effect, self._built.get(name)
        numbers = effect.numbers(active.parameters, around) if effect.numbers is not None else {}
        if last is not None and last.active is active and last.numbers == numbers:
            return last
        return _Built(active, numbers, _built(active, numbers, geometry))


def _acting(effects: Mapping[str, list[Any]]) -> dict[str, list[Any]]:
    """Return the effects' parts without factors on the areas of effects that the scene does not name."""
    scaled = [part for items in effects.values() for part in items if isinstance(part, Scaled)]
    idle = {part.by for part in scaled if part.effect not in effects}
    idle -= {part.by for part in scaled if part.effect in effects}

    def acts(part: Any) -> bool:
        if isinstance(part, Scaled):
            return part.effect in effects
        return not (isinstance(part, Made) and part.entry.name in idle)

    return {name: [part for part in items if acts(part)] for name, items in effects.items()}


def _built(active: ActiveEffect, numbers: Mapping[str, float], geometry: Any) -> list[Any]:
    """Return what an effect is made of; the flow paths of an expander are those of the machine run backwards."""
    built = list(active.effect.build(active.parameters, geometry))
    if active.effect.numbers is not None:
        built = [_with(part, numbers) if isinstance(part, Numbered) else part for part in built]
    if not geometry.expands:
        return built
    life, pitch = geometry.life, geometry.pitch
    return [part.mirrored(life, pitch) if isinstance(part, FlowPath) else part for part in built]


def _with(part: Numbered, numbers: Mapping[str, float]) -> Numbered:
    return replace(part, values={**part.values, **numbers})
