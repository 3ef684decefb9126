"""Laws that tie a random scene to a similar machine, or its gas to another description of the same gas.

A machine of other lengths, times, masses and temperatures, whose numbers without dimension are the same, is similar
(Buckingham's theorem). `relations.py` asks these laws.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

import pytest
from relating import Case, Lost, NotAsked, Pair, believed_twin, exponent, law, scaled, twin
from test_dimensions import SI

from screwsim.fluid import transport
from screwsim.inputs.declare import is_derived
from screwsim.scene import Scene, value_at, with_values
from screwsim.scene.fields import leaves_of
from screwsim.simulate import simulate

LOST = 3e5  # [Pa] pressure loss of a package above which a multiple of it is not found
RARE = 1e-4  # of the pressure: there a real gas is an ideal one within 1e-6
ALMOST = 1e-5  # relative difference that stays then
TRACE = 1e-9  # mass fraction of the second component of a blend that is nearly pure


@law
def similar(case: Case) -> Iterator[Pair]:
    """A machine of other lengths, times, masses and temperatures with the same numbers without dimension is similar."""
    here, scene, random = case.result, case.scene, case.random
    own = "refrigerant_solubility", "thermal_clearances"
    if any(name in scene.effects for name in own) or has_sizes(scene) or case.value("machine.volume.law") == "table":
        raise NotAsked("laws with sizes of their own")
    if scene.oil is not None and scene.oil.name:
        raise NotAsked("an oil with a temperature of its own")
    if (here.performance.get("package_pressure_loss") or 0.0) > LOST:
        raise NotAsked("its losses are found in steps of a size")
    length = math.exp(random.uniform(-1.0, 1.0))
    mass = length**3
    if scene.gas.model == "ideal" and scene.gas.relative_humidity is None and "bearings" not in scene.effects:
        mass = math.exp(random.uniform(-1.0, 1.0))
    factors = {"kg": mass, "m": length, "s": length}
    with pytest.MonkeyPatch.context() as patch:
        other = _in_units(scene, factors, patch)
        there = twin(other)
    about = there.performance.about
    back = {name: 1.0 / factor(about[name].units, factors) for name in there.performance}
    yield Pair(f"similar by {length:.3g} m, {mass:.3g} kg", here, scaled(there, back), slack=1e-6)


def has_sizes(scene: Scene) -> bool:
    """Return whether a scene has fits to gaps of a size, or motors of classes, which are listed by power."""
    parameters = [each.parameters for each in scene.effects.values()]
    fitted = any(getattr(each, "friction_fit", None) is not None for each in parameters)
    return fitted or any(getattr(each, "efficiency_class", "stated") != "stated" for each in parameters)


def factor(unit: str, factors: Mapping[str, float]) -> float:
    """Return the factor of a quantity of an SI unit, where those of kg, m, s and K are given."""
    over, _, under = unit.partition("/")
    found = 1.0
    for part, sign in ((over, 1), (under.strip("()"), -1)):
        for name, raised in re.findall(r"([A-Za-z]+|1)\^?(-?\d+)?", part):
            kelvins = factors.get("K", 1.0) if name in ("K", "kelvin") else 1.0
            kg, m, s = SI[name]
            found *= (factors["kg"] ** kg * factors["m"] ** m * factors["s"] ** s * kelvins) ** (
                sign * int(raised or 1)
            )
    return found


def _in_units(scene: Scene, factors: Mapping[str, float], patch: pytest.MonkeyPatch) -> Scene:
    """Return a scene in other units, and make CoolProp's transport properties those of the same gas in them."""
    _scale_transport(patch, factors)
    found = {}
    for path, leaf in leaves_of(scene).items():
        value = None if leaf.dimension is None else value_at(scene, path)
        if value and leaf.dimension is not None and not is_derived(value):
            found[path] = value * factor(leaf.dimension.si, factors)
    return with_values(scene, found)


def _scale_transport(patch: pytest.MonkeyPatch, factors: Mapping[str, float]) -> None:
    """Make CoolProp's conductivity and viscosity of a gas those of the same gas in other units."""
    pressure, conducts, viscous = (factor(unit, factors) for unit in ("Pa", "W/(m K)", "Pa s"))
    of_both, of_one, hot = transport.transport, transport.viscosity, factors.get("K", 1.0)

    def both(fluid: Any, p: float, T: float) -> tuple[float, float, float]:
        conductivity, viscosity, prandtl = of_both(fluid, p / pressure, T / hot)
        return conducts * conductivity, viscous * viscosity, prandtl

    for module in ("parts.gas_transport", "cylinder_heat"):
        patch.setattr(f"screwsim.effects.{module}.transport", both)
    one = "screwsim.effects.parts.gap_flow.vapour_viscosity"
    patch.setattr(one, lambda fluid, p, T: viscous * of_one(fluid, p / pressure, T / hot))


@law
def hotter(case: Case) -> Iterator[Pair]:
    """An ideal gas of constant k at other temperatures is the same machine at a speed that goes with their root."""
    here, scene = case.result, case.scene
    own = {"refrigerant_solubility", "thermal_clearances", "economizer", "liquid_injection", "separator", "air_package"}
    if scene.gas.model != "ideal" or own & scene.effects.keys() or has_sizes(scene):
        raise NotAsked("laws with temperatures of their own")
    if scene.gas.relative_humidity is not None or case.value("operation.suction.temperature") is None:
        raise NotAsked("lines by saturation")
    if scene.oil is not None and scene.oil.name:
        raise NotAsked("an oil with a temperature of its own")
    warmer = math.exp(case.random.uniform(-0.3, 0.3))
    factors = {"kg": 1.0, "m": 1.0, "s": warmer**-0.5, "K": warmer}
    constant = case.changed({"gas.isentropic_exponent": exponent(scene, here)})
    about = here.performance.about
    with pytest.MonkeyPatch.context() as patch:
        there = twin(_in_units(constant, factors, patch))
    back = {name: 1.0 / factor(about[name].units, factors) for name in there.performance}
    yield Pair(f"{warmer:.3g} times as hot", here, scaled(there, back), slack=1e-6)


@law
def rare_argon(case: Case) -> Iterator[Pair]:
    """A real gas of single atoms at a low pressure is an ideal gas of k = 5/3."""
    case.believe()
    if case.scene.gas.model != "ideal" or case.value("operation.suction.temperature") is None:
        raise NotAsked("no ideal gas with a stated temperature")
    if {"refrigerant_solubility", "air_package", "economizer", "liquid_injection"} & case.scene.effects.keys():
        raise NotAsked("needs its own gas")
    ideal = case.changed({"gas": {"fluid": "Argon", "isentropic_exponent": 5.0 / 3.0}})
    real = case.changed({"gas": {"fluid": "Argon", "model": "real"}})
    factors = {"kg": RARE, "m": 1.0, "s": 1.0}
    with pytest.MonkeyPatch.context() as patch:
        try:
            one = twin(_in_units(ideal, factors, patch))
        except Lost as why:
            raise NotAsked(str(why)) from None
    with pytest.MonkeyPatch.context() as patch:
        found = simulate(_in_units(real, factors, patch), trace=False)
    if "highest temperature" in found.message:
        raise NotAsked("hotter than the equation of state knows")
    other = believed_twin(found, case.scene)
    yield Pair("rare argon, real", one, other, slack=ALMOST, without=("isothermal_efficiency",))


@law
def nearly_pure(case: Case) -> Iterator[Pair]:
    """A blend with next to nothing of its second component is the pure fluid."""
    case.believe()
    if case.scene.gas.model != "real" or case.scene.gas.two_phase != "refuse":
        raise NotAsked("no real gas of one phase")
    if {"refrigerant_solubility", "economizer", "liquid_injection"} & case.scene.effects.keys():
        raise NotAsked("needs its own gas")
    pure = case.changed({"gas": {"fluid": "R32", "model": "real"}})
    blend = case.changed({"gas": {"fluid": ["R32", "R125"], "mass_fractions": [1.0 - TRACE, TRACE], "model": "real"}})
    try:
        one = twin(pure)
    except Lost as why:
        raise NotAsked(str(why)) from None
    if any(name in case.scene.effects for name in ("cylinder_heat", "wall_heat", "droplets")):
        raise NotAsked("transport properties of blends are those of dilute gases (M318)")
    yield Pair("R32 with a trace of R125", one, twin(blend), slack=ALMOST)
