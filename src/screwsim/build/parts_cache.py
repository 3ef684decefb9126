"""Cache of the machine, gas and effects built for scenes of a sweep, and the data that effects can ask of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from screwsim.build.own_modules import checked_parts
from screwsim.effects.base import Around, ChamberState, FlowPath, HeatRate, LineLeak, Made, Scaled, Site, Wall
from screwsim.fluid.consistency import inconsistency
from screwsim.fluid.gas import Gas
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.models import GasRequest, find_gas_model, lacking
from screwsim.fluid.moist_air import moist_air
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.settings import GasSettings
from screwsim.inputs.declare import files_in
from screwsim.inputs.faults import QuantityNotFound, UsageError
from screwsim.inputs.textfiles import stamp
from screwsim.machine.kinds import kind_of
from screwsim.machine.protocol import MachineGeometry, MachineSettings
from screwsim.model.parts import Effects
from screwsim.numerics.frozen import with_changes
from screwsim.numerics.identity_cache import IdentityCache, keep
from screwsim.scene.lines import Lines, lines, refrigerating_effect, suction_enthalpy
from screwsim.scene.types import ActiveEffect, Scene

TakesNumbers = FlowPath | HeatRate | Wall | ChamberState | LineLeak


class _Built(NamedTuple):
    """Parts of an effect and the objects they were built from, kept alive as the cache identifies them by `id`."""

    active: ActiveEffect
    geometry: MachineGeometry
    parts: list[Any]


class PartsCache:
    """Cache of the machine, gas and effects built for previous scenes: scenes of a sweep share most of them.

    Identical section objects give identical part objects, which `model.series.Composer` relies on. More than the last
    ones are kept, for courses that are solved side by side.
    """

    def __init__(self) -> None:
        self._gas: dict[tuple[Any, ...], tuple[GasSettings, Gas]] = {}  # by id of the settings, and by `GasModel.told`
        self._geometry: dict[tuple[Any, ...], MachineGeometry] = {}  # by id of the settings, and stamps of their files
        self._built: dict[str, dict[tuple[Any, ...], _Built]] = {}
        self._whole: dict[tuple[Any, ...], tuple[Any, Any, Effects]] = {}  # by all of a scene that matters

    def lent(self) -> PartsCache:
        """Return an independent copy: it has the same contents, and additions to it do not come back."""
        found = PartsCache()
        for name in ("_gas", "_geometry", "_whole"):
            setattr(found, name, dict(getattr(self, name)))
        found._built = {name: dict(known) for name, known in self._built.items()}
        return found

    def gas(self, scene: Scene) -> Gas:
        """Return the gas of a scene: the same object for the same settings and the same dependence on the lines."""
        settings, told = scene.gas, find_gas_model(scene.gas.model).told
        if settings.relative_humidity or told is None:
            return build_gas(scene)
        key = id(settings), told(gas_request(scene))
        found = self._gas.get(key)
        return found[1] if found else keep(self._gas, key, (settings, build_gas(scene)))[1]

    def geometry(self, machine: MachineSettings) -> MachineGeometry:
        """Return the geometry of a machine."""
        key = id(machine), *_stamps(machine)
        found = self._geometry.get(key)
        if found is not None and found.settings is machine:
            return found
        return keep(self._geometry, key, kind_of(machine).geometry(machine))

    def effects(self, scene: Scene, geometry: Any, at: Lines) -> Effects:
        """Return the parts of a scene's effects on a geometry."""
        around = surroundings_of(scene, at)
        every = scene.effects
        asking = _effects_taking_numbers(every)
        numbers = {name: _numbers(name, one, around) for name, one in asking.items()}
        whole = id(every), id(geometry), *_stamps(every), *[(name, *given.items()) for name, given in numbers.items()]
        known = self._whole.get(whole)
        if known is not None:
            return known[2]
        parts = {name: self._effect(name, active, geometry, numbers.get(name, {})) for name, active in every.items()}
        return keep(self._whole, whole, (every, geometry, Effects(_with_present_factors(parts))))[2]

    def _effect(self, name: str, active: ActiveEffect, geometry: Any, numbers: Mapping[str, float]) -> list[Any]:
        known = self._built.setdefault(name, {})
        key = id(active), id(geometry), *_stamps(active.parameters), *numbers.items()
        found = known.get(key) or keep(known, key, _Built(active, geometry, _built(name, active, numbers, geometry)))
        return found.parts


_files = IdentityCache(files_in)  # files that a machine, an effect's parameters or all effects name


def _stamps(part: Any) -> tuple[tuple[int, ...], ...]:
    """Return stamps of the files that a part of a scene names: a changed file makes its parts be built anew."""
    return tuple(map(stamp, _files(part)))


def _numbers(name: str, active: ActiveEffect, around: Around) -> Mapping[str, float]:
    """Return what an effect takes from the surroundings; raise QuantityNotFound where the gas has no such value."""
    assert active.effect.numbers is not None
    try:
        return active.effect.numbers(active.parameters, around)
    except UsageError as error:
        remedy = f"choose other conditions, or leave out effects.{name}"
        raise QuantityNotFound(f"effects.{name}: {error} ({remedy})") from None


@IdentityCache
def _effects_taking_numbers(effects: Mapping[str, ActiveEffect]) -> dict[str, Any]:
    """Return the effects that take numbers from the scene around them."""
    return {name: active for name, active in effects.items() if active.effect.numbers is not None}


def _with_present_factors(effects: Mapping[str, list[Any]]) -> dict[str, list[Any]]:
    """Return the effects' parts, without area factors on effects that the scene does not have."""
    scaled = [part for items in effects.values() for part in items if isinstance(part, Scaled)]
    idle = {part.by for part in scaled if part.effect not in effects}
    idle -= {part.by for part in scaled if part.effect in effects}

    def acts(part: Any) -> bool:
        if isinstance(part, Scaled):
            return part.effect in effects
        return not (isinstance(part, Made) and part.entry.name in idle)

    return {name: [part for part in items if acts(part)] for name, items in effects.items()}


def _built(name: str, active: ActiveEffect, numbers: Mapping[str, float], geometry: Any) -> list[Any]:
    """Return the parts of an effect; for an expander the flow paths of the machine run backwards."""
    built = active.effect.build(active.parameters, geometry)
    built = checked_parts(built) if "." in name else list(built)
    if active.effect.numbers is not None:
        built = [
            with_changes(part, values={**part.values, **numbers}) if isinstance(part, TakesNumbers) else part
            for part in built
        ]
    if not geometry.expands:
        return built
    life, pitch = geometry.life, geometry.pitch
    return [part.mirrored(life, pitch) if isinstance(part, FlowPath) else part for part in built]


def surroundings_of(scene: Scene, at: Lines) -> Around:
    """Return the data of the scene that effects can ask for."""
    oil, supply = scene.oil, scene.oil_supply
    T_oil = supply.temperature if supply is not None else None
    tip_speed = scene.machine.surface_speed(scene.operation.speed)
    known = oil.at(T_oil) if oil is not None and T_oil is not None else None
    return Around(scene.gas.name, at.p_s, at.T_s, at.p_d, tip_speed, T_oil, known)


def build_site(scene: Scene, gas: Gas) -> Site:
    """Return the data from which the state of an effect's own plenum can be computed."""
    around, effect = surroundings_of(scene, lines(scene)), refrigerating_effect(scene)
    liquid = None if effect is None else suction_enthalpy(scene) - effect
    return Site(**vars(around), gas=gas, liquid_enthalpy=liquid, refrigerating_effect=effect)


def build_gas(scene: Scene) -> Gas:
    """Return the gas of a scene."""
    said = scene.gas
    dry, humidity = find_gas_model(said.model).make(gas_request(scene)), said.relative_humidity
    if "." in said.model:
        _check_own(dry, lines(scene))
    if humidity is None:
        return dry
    assert isinstance(dry, IdealGas | RealGas)  # `scene.fluids` refuses others
    at = lines(scene)
    return moist_air(dry, at.p_s, at.T_s, humidity)


def gas_request(scene: Scene) -> GasRequest:
    """Return the settings of a scene's gas."""
    said = scene.gas
    return GasRequest(said.name, said.isentropic_exponent, said.two_phase, lambda: lines(scene).T_s)


def _check_own(gas: Gas, at: Lines) -> None:
    """Raise TypeError where a user's gas lacks a function or is inconsistent."""
    missing = lacking(gas)
    if missing:
        raise TypeError(f"its gas has no {', '.join(missing)}")
    if type(gas).__hash__ is None:
        raise TypeError("its gas has no hash: make it a frozen dataclass")
    wrong = inconsistency(gas, at.p_s, at.T_s, at.p_d)
    if wrong:
        raise TypeError(wrong)
