"""Completes a scene with quantities found with its cycle: temperatures of oil and separator, losses of a package."""

from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple

from screwsim.build import open_values
from screwsim.effects.base import CoolsOil, InSeparator, LosesPressure, PressureLosses
from screwsim.fluid import constants
from screwsim.fluid.models import condenses
from screwsim.fluid.oils import OILS
from screwsim.fluid.settings import COLDEST, HOTTEST
from screwsim.inputs.faults import Fault, QuantityNotFound, UsageError
from screwsim.numerics.frozen import with_changes
from screwsim.outputs.customary import in_celsius
from screwsim.scene.checks import oil_faults
from screwsim.scene.lines import lines
from screwsim.scene.types import ActiveEffect, FoundWithCycle, Scene, parameters_of_type

WARMED, COOLED = 45.0, 12.0  # [K] first guesses: mixture above suction gas, temperature drop of oil in its cooler


class Temperatures(NamedTuple):
    """Temperatures [K] found by effects.separator: of the oil supply and of the separator."""

    supply: float
    separator: float


class OpenTemperatures(NamedTuple):
    """Whether the temperatures of oil supply and separator are to be found with the cycle."""

    supply: bool
    separator: bool


def package_of(scene: Scene) -> LosesPressure | None:
    """Return the parameters of the effect that puts a package around the machine; None without one."""
    return next(iter(parameters_of_type(scene.effects, LosesPressure).values()), None)


def completed(
    scene: Scene,
    near: Temperatures | None = None,
    losses: PressureLosses | None = None,
    open_numbers: Sequence[float] | None = None,
) -> Scene:
    """Return a scene with values for everything found with the cycle: the values given nearby, or first guesses.

    These are the temperatures that effects.separator finds, the losses of a package, and open parameters
    (`open_values`). Raise Unfound where oil or effects do not admit the first guess either.
    """
    package = package_of(scene)
    if package is not None and scene.losses is None:
        at = lines(scene)
        guess = package.losses(package.at_rated_flow, at.p_s, at.p_d)
        near_by = losses is not None and min(losses.behind, guess.behind) >= 0.0  # both deliver air
        scene = with_changes(scene, losses=losses if near_by else guess)
    return _tempered(open_values.completed(scene, open_numbers), near)


def _tempered(scene: Scene, near: Temperatures | None) -> Scene:
    supply = scene.oil_supply
    if not any(open_temperatures(scene)):
        return scene if supply is None or not _is_open(supply.temperature) else _with_kept_temperature(scene)
    if near is not None:
        found = with_temperatures(scene, near)
        if not temperature_faults(found):
            return found
    asked = [one.parameters.separator_temperature for one in _effects_to_complete(scene).values()]
    if supply is not None and None not in (supply.temperature, *asked):
        return scene
    found = with_temperatures(scene, _guessed(scene, _cooling(scene)))
    faults = temperature_faults(found)
    if faults:
        raise QuantityNotFound(f"the first guess of the oil temperatures is an impossible state: {faults[0]}")
    return found


def _with_kept_temperature(scene: Scene) -> Scene:
    """Return a scene whose oil is supplied at the temperature that its cooler keeps, and follows that temperature."""
    supply, outlet = scene.oil_supply, _cooling(scene).outlet
    assert supply is not None
    temperature = None if outlet is None else FoundWithCycle(outlet)
    return with_changes(scene, oil_supply=with_changes(supply, temperature=temperature))


def with_temperatures(scene: Scene, at: Temperatures) -> Scene:
    """Return a scene with the given temperatures in place of those that it leaves open."""
    supply, effects = scene.oil_supply, scene.effects
    assert supply is not None
    if open_temperatures(scene).supply:
        scene = with_changes(scene, oil_supply=with_changes(supply, temperature=FoundWithCycle(at.supply)))
    elif _is_open(supply.temperature):
        scene = _with_kept_temperature(scene)
    for name, active in _effects_to_complete(scene).items():
        parameters = with_changes(active.parameters, separator_temperature=FoundWithCycle(at.separator))
        effects = {**effects, name: with_changes(active, parameters=parameters)}
    return with_changes(scene, effects=effects)


def _cooling(scene: Scene) -> CoolsOil:
    """Return the settings of the scene's oil cooler."""
    return next(iter(parameters_of_type(scene.effects, CoolsOil).values()), CoolsOil())


def open_temperatures(scene: Scene) -> OpenTemperatures:
    """Tell which temperatures of the oil's circuit are to be found with the cycle."""
    supply = scene.oil_supply
    if supply is None:
        return OpenTemperatures(False, False)
    follows = _is_open(supply.temperature) and _cooling(scene).outlet is None
    return OpenTemperatures(follows, bool(_effects_to_complete(scene)))


def _effects_to_complete(scene: Scene) -> dict[str, ActiveEffect]:
    """Return the effects of a scene that need the separator temperature and do not state it."""
    asking = parameters_of_type(scene.effects, InSeparator)
    return {name: scene.effects[name] for name, one in asking.items() if _is_open(one.separator_temperature)}


def separator_effects(scene: Scene) -> list[InSeparator]:
    """Return the parameters of the effects that need the separator temperature, stated or not."""
    return list(parameters_of_type(scene.effects, InSeparator).values())


def _is_open(value: float | None) -> bool:
    """Tell whether a temperature is not stated: absent, or the current value of the search."""
    return value is None or isinstance(value, FoundWithCycle)


def temperature_faults(scene: Scene) -> list[Fault]:
    """Return why oil or effects do not admit the temperatures with which a scene was completed."""
    found = [] if scene.oil is None else list(oil_faults(scene))
    T = None if scene.oil_supply is None else scene.oil_supply.temperature
    if T is not None and not COLDEST <= T <= HOTTEST:
        what = f"{in_celsius(T)} lies outside {in_celsius(COLDEST)} to {in_celsius(HOTTEST)}, the range for oil"
        found.append(Fault("oil_supply.temperature", f"{what} (choose another duty or temperature of the cooler)"))
    for active in _effects_to_complete(scene).values():
        found += [] if active.effect.check is None else active.effect.check(active.parameters, scene)
    return found


def _guessed(scene: Scene, kept: CoolsOil) -> Temperatures:
    """Return first guesses: a mixture warmer than the suction gas, hot enough for gas that condenses not to do so."""
    at, T_c = lines(scene), scene.operation.condensing_temperature
    T = at.T_s + WARMED if kept.discharge is None else kept.discharge
    if T_c is None and (condenses(scene.gas) or _effects_to_complete(scene)):
        with suppress(UsageError):  # above the critical pressure
            T_c = constants.saturation_temperature(scene.gas.name, at.p_d)
    mixture = T if T_c is None else max(T, T_c + COOLED)
    if scene.oil is not None and scene.oil.name is not None:
        stored = OILS[scene.oil.name]
        mixture = min(max(mixture, stored.low), stored.high)
    return Temperatures(mixture if kept.discharge is None else mixture - COOLED, mixture)
