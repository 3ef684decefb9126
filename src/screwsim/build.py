"""From a typed scene to the built parts that the composer takes: geometry, gas, oil, effects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from traceback import walk_tb
from typing import Any, NamedTuple

from screwsim import sought
from screwsim.effects.base import (
    Around,
    ChamberState,
    CoolsOil,
    FlowPath,
    HeatRate,
    InSeparator,
    LineLeak,
    LosesPressure,
    Made,
    OilContent,
    OilGas,
    OilSolution,
    Plenum,
    PressureLosses,
    Scaled,
    Site,
    Wall,
)
from screwsim.faults import Fault, Unfound, UsageError, own_number
from screwsim.fluid import constants
from screwsim.fluid.gas import Gas
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.models import Asked, find_gas_model, lacking
from screwsim.fluid.moist_air import moist_air
from screwsim.fluid.oils import OILS
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.reservoir import Reservoir
from screwsim.fluid.settings import GasSettings
from screwsim.machine.kinds import kind_of
from screwsim.machine.protocol import MachineGeometry, MachineSettings
from screwsim.model.parts import Effects, OilPart, Parts, Widths
from screwsim.scene.checks import cross_check, oil_faults
from screwsim.scene.grid import case, case_count, only
from screwsim.scene.lines import Lines, lines, refrigerating_effect, suction_enthalpy
from screwsim.scene.types import COLDEST, HOTTEST, ActiveEffect, Found, Scene


def blamed(error: BaseException, own: Iterable[str]) -> str | None:
    """Return in which of the user's own modules an error was raised; None in none of them."""
    modules = [frame.f_globals.get("__name__", "") for frame, _ in walk_tb(error.__traceback__)]
    tops = {module.partition(".")[0] for module in modules}
    exact = [name for name in own if name in modules]
    near = [name for name in own if name.partition(".")[0] in tops]
    return next(iter((*exact, *near)), None)


@contextmanager
def faults_of_own(scene: Scene) -> Iterator[None]:
    """Raise UsageError, in one line, for what fails while modules of the user's own are built and compiled."""
    try:
        yield
    except UsageError:
        raise
    except (Exception, SystemExit) as error:
        own = scene.own.values()
        if not own:
            raise
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        text = lines[0] if lines else ""
        what = f"cannot be built or compiled ({type(error).__name__}: {text}); mend that module"
        raise UsageError(f"{', '.join(own)}: {what}") from error


Numbered = FlowPath | HeatRate | Wall | ChamberState | LineLeak
WARMED, COOLED = 45.0, 12.0  # [K] in first guesses: of gas and oil over suction gas, of oil by its cooler
WIDTH = 0.25  # of the regularisation over the wanted accuracy
LEAST = 1e-300  # above nothing
MOST_PREPARED = 10_000  # conditions of one sweep that are asked for ahead


def build_gas(scene: Scene) -> Gas:
    """Return the gas of a scene."""
    dry, humidity = _dry_gas(scene), scene.gas.relative_humidity
    if humidity is None:
        return dry
    assert isinstance(dry, IdealGas | RealGas)  # `scene.humidity` refuses others
    at = lines(scene)
    return moist_air(dry, at.p_s, at.T_s, humidity)


def _dry_gas(scene: Scene) -> Gas:
    said = scene.gas
    asked = Asked(said.name, said.isentropic_exponent, said.two_phase, lambda: lines(scene).T_s)
    gas = find_gas_model(said.model).make(asked)
    missing = lacking(gas) if "." in said.model else []
    if missing:
        raise TypeError(f"its gas has no {', '.join(missing)}")
    return gas


class Temperatures(NamedTuple):
    """Temperatures [K] that effects.separator finds: of the oil's supply, and of the separator."""

    supply: float
    separator: float


def package_of(scene: Scene) -> LosesPressure | None:
    """Return the parameters of the effect that puts a package around the machine; None where there is none."""
    every = (active.parameters for active in scene.effects.values())
    return next((parameters for parameters in every if isinstance(parameters, LosesPressure)), None)


def completed(
    scene: Scene,
    near: Temperatures | None = None,
    losses: PressureLosses | None = None,
    open_numbers: Sequence[float] | None = None,
) -> Scene:
    """Return a scene in which all has values that is found with the cycle: what is `near`, or first guesses.

    These are temperatures that effects.separator finds, and the losses of a package. Raise Unfound where oil or effects
    cannot be at the first guess either.
    """
    package = package_of(scene)
    if package is not None and scene.losses is None:
        at = lines(scene)
        guess = package.losses(package.at_rated_flow, at.p_s, at.p_d)
        near_by = losses is not None and min(losses.behind, guess.behind) >= 0.0  # both deliver
        scene = replace(scene, losses=losses if near_by else guess)
    return _tempered(sought.completed(scene, open_numbers), near)


def _tempered(scene: Scene, near: Temperatures | None) -> Scene:
    if not any(open_temperatures(scene)):
        return scene if scene.oil_supply is None or scene.oil_supply.temperature is not None else _kept(scene)
    if near is not None:
        found = filled(scene, near)
        if not temperature_faults(found):
            return found
    supply, asked = scene.oil_supply, [one.parameters.separator_temperature for one in _asking(scene).values()]
    if supply is not None and None not in (supply.temperature, *asked):
        return scene
    found = filled(scene, _guessed(scene, _cooling(scene)))
    faults = temperature_faults(found)
    if faults:
        raise Unfound(f"the first guess of the oil's temperatures leads to where {faults[0]}")
    return found


def _kept(scene: Scene) -> Scene:
    """Return a scene whose oil comes with the temperature that a cooler keeps."""
    supply = scene.oil_supply
    assert supply is not None
    return replace(scene, oil_supply=replace(supply, temperature=_cooling(scene).outlet))


def filled(scene: Scene, at: Temperatures) -> Scene:
    """Return a scene with these temperatures in place of those that it leaves open."""
    supply, effects = scene.oil_supply, scene.effects
    assert supply is not None
    if open_temperatures(scene)[0]:
        scene = replace(scene, oil_supply=replace(supply, temperature=Found(at.supply)))
    elif supply.temperature is None:
        scene = _kept(scene)
    for name, active in _asking(scene).items():
        parameters = replace(active.parameters, separator_temperature=Found(at.separator))
        effects = {**effects, name: replace(active, parameters=parameters)}
    return replace(scene, effects=effects)


def _cooling(scene: Scene) -> CoolsOil:
    """Return what a scene says of its oil's cooler."""
    every = (active.parameters for active in scene.effects.values())
    return next((parameters for parameters in every if isinstance(parameters, CoolsOil)), CoolsOil())


def open_temperatures(scene: Scene) -> tuple[bool, bool]:
    """Tell whether the temperatures of the oil's supply and of the separator are found with the cycle."""
    supply = scene.oil_supply
    if supply is None:
        return False, False
    follows = _is_open(supply.temperature) and _cooling(scene).outlet is None
    return follows, bool(_asking(scene))


def _asking(scene: Scene) -> dict[str, ActiveEffect]:
    """Return the effects of a scene that ask for the separator's temperature, which the scene does not state."""
    every = ((name, one) for name, one in scene.effects.items() if isinstance(one.parameters, InSeparator))
    return {name: one for name, one in every if _is_open(one.parameters.separator_temperature)}


def _is_open(value: float | None) -> bool:
    """Tell whether a temperature is not stated: absent, or where the search for it stands."""
    return value is None or isinstance(value, Found)


def temperature_faults(scene: Scene) -> list[Fault]:
    """Return why effects or the oil cannot be at the temperatures with which a scene was completed."""
    found = [] if scene.oil is None else list(oil_faults(scene))
    T = None if scene.oil_supply is None else scene.oil_supply.temperature
    if T is not None and not COLDEST <= T <= HOTTEST:
        what = f"{T:.6g} K lies outside {COLDEST:g} K to {HOTTEST:g} K, where oil can be"
        found.append(Fault("oil_supply.temperature", f"{what} (another duty or temperature of the cooler)"))
    for active in _asking(scene).values():
        found += [] if active.effect.check is None else active.effect.check(active.parameters, scene)
    return found


def _guessed(scene: Scene, kept: CoolsOil) -> Temperatures:
    """Return first guesses: of a mixture that is warmer than suction gas, and of gas that does not condense."""
    at, T_c = lines(scene), scene.operation.condensing_temperature
    T = at.T_s + WARMED if kept.discharge is None else kept.discharge
    if T_c is None and (scene.gas.model == "real" or _asking(scene)):
        with suppress(UsageError):  # above the critical pressure
            T_c = constants.saturation_temperature(scene.gas.name, at.p_d)
    mixture = T if T_c is None else max(T, T_c + COOLED)
    if scene.oil is not None and scene.oil.name is not None:
        stored = OILS[scene.oil.name]
        mixture = min(max(mixture, stored.low), stored.high)
    return Temperatures(mixture if kept.discharge is None else mixture - COOLED, mixture)


def build_oil(scene: Scene, at: Lines) -> OilPart | None:
    """Return the oil of a scene with its supply."""
    oil, supply = scene.oil, scene.oil_supply
    if oil is None or supply is None or supply.temperature is None:
        return None
    known = oil.at(supply.temperature)
    if supply.kind == "pump":
        numbers = {"ratio": float(supply.ratio or 0.0)}
    else:
        diameter = float(supply.orifice_diameter or 0.0)
        numbers = {
            "density": known.density,
            "viscosity": float(known.viscosity or 0.0),
            "diameter": diameter,
            "length": supply.orifice_length or 2.0 * diameter,
            "number": supply.orifice_count,
            "separator_pressure": at.p_d,
        }
    source = at.p_s if supply.source == "suction" else at.p_d
    return OilPart(known.density, known.heat_capacity, supply.temperature, oil.transport, numbers, source)


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
            self._built.clear()
        return self._geometry

    def effects(self, scene: Scene, geometry: Any, at: Lines) -> Effects:
        """Return the parts of a scene's effects, on the geometry that was asked for last."""
        around = _around(scene, at)
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


def build_parts(scene: Scene, stock: Stock | None = None, set_speed: float | None = None) -> Parts:
    """Return what the scene names, built for the composer; what it shares with the scene before is in stock."""
    scene = completed(scene)
    stock, at = stock or Stock(), lines(scene)
    geometry = stock.geometry(scene.machine)
    effects = stock.effects(scene, geometry, at)
    gas = stock.gas(scene)
    plenums, made, content = _of_site(effects, scene, gas)
    return Parts(
        geometry=geometry,
        gas=gas,
        omega=scene.operation.speed,
        widths=_widths(scene, at),
        effects=effects,
        oil=build_oil(scene, at),
        plenums=plenums,
        made=made,
        set_speed=set_speed,
        oil_content=content,
    )


def _of_site(
    effects: Effects, scene: Scene, gas: Gas
) -> tuple[dict[str, Reservoir], dict[str, float], OilContent | OilSolution | None]:
    """Return the states of own plenums, first guesses of what the cycle makes, and what the oil brings dissolved."""
    plenums, made, brings = ([part for _, part in effects.all(kind)] for kind in (Plenum, Made, OilGas))
    if not (plenums or made or brings):
        return {}, {}, None
    site = build_site(scene, gas)
    guesses = {part.entry.name: part.guess(site) for part in made}
    for name, part in effects.all(Made):
        own_number(name, f"the guess of {part.entry.name}", guesses[part.entry.name])
    if len(guesses) < len(made):
        names = ", ".join(sorted(part.entry.name for part in made))
        raise TypeError(f"two effects declare the same of {names} as made by the cycle")
    states = {part.name: part.state(site) for part in plenums}
    for name, part in effects.all(Plenum):
        for what in ("p", "T", "rho"):
            own_number(name, f"{what} of its plenum {part.name}", getattr(states[part.name], what), LEAST)
        own_number(name, f"h of its plenum {part.name}", states[part.name].h)
    return states, guesses, brings[0].content(site) if brings else None


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


def _around(scene: Scene, at: Lines) -> Around:
    """Return what effects can ask of the scene."""
    oil, supply = scene.oil, scene.oil_supply
    T_oil = supply.temperature if supply is not None else None
    tip_speed = scene.machine.surface_speed(scene.operation.speed)
    known = oil.at(T_oil) if oil is not None and T_oil is not None else None
    return Around(scene.gas.name, at.p_s, at.T_s, at.p_d, tip_speed, T_oil, known)


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


def build_site(scene: Scene, gas: Gas) -> Site:
    """Return what the state of an effect's own plenum can be made of."""
    at, effect = lines(scene), refrigerating_effect(scene)
    liquid = None if effect is None else suction_enthalpy(scene) - effect
    around = _around(scene, at)
    return Site(gas, scene.gas.name, at.p_s, at.T_s, at.p_d, liquid, effect, around.T_oil, around.oil)


def regularisation(scene: Scene) -> tuple[float, float, float]:
    """Return the widths ε below which a pressure difference is smoothed: suction port, discharge port [Pa], gaps.

    That of gaps is a share of the mean pressure at their ends. ε is `WIDTH` of the wanted accuracy times the pressure.
    The error control lets the pressure err by about as much; a narrower ε would let that error jump across the flow
    law's steep middle, a wider one costs accuracy that no step can regain (docs/explanation/numerics.md).
    """
    return _widths(scene, lines(scene))[:3]


def _widths(scene: Scene, at: Lines) -> Widths:
    width = WIDTH * scene.numerics.accuracy
    return width * at.p_s, width * at.p_d, width, width * max(at.p_s, at.p_d)


def prepare(scene: Scene) -> None:
    """Ask CoolProp once for what the cases of a sweep need, so that no worker imports it."""
    asked = (path for path in scene.sweep if path.startswith(("operation.", "gas.")) and path != "operation.speed")
    conditions = only(scene, asked)
    for index in range(min(case_count(conditions), MOST_PREPARED) if conditions.sweep else 0):
        one = case(conditions, index)
        if not cross_check(one):
            build_gas(one)
            refrigerating_effect(one)
