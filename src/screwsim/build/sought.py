"""Numbers that a scene leaves open, one figure each that tells them: oil flow, economizer, valve of injected liquid.

`oil_supply.discharge_temperature` asks for the oil that brings the mixture to that temperature (docs/model.md M370),
`oil_supply.flow` for so much that it is that of a pump (M393),
`effects.economizer.temperature: auto` for the saturation temperature at which the port draws what exchanger or flash
tank gives off (M371), `effects.liquid_injection.discharge_temperature` for the opening of the valve that brings the
discharge there (M391). They are found with the cycle (`solve.circuit`), each as a coordinate in kelvin.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from screwsim.fluid import constants
from screwsim.inputs.declare import Found
from screwsim.scene.lines import lines
from screwsim.scene.types import Scene
from screwsim.scene.units import ZERO_CELSIUS

LIQUID, INJECTED, DISCHARGE = "liquid_injection", "liquid_injection_flow_ratio", "discharge_temperature"
ECONOMIZER, DRAWN, MIXTURE = "economizer", "economizer_draw_ratio", "mixture_discharge_temperature"
LOG = 20.0  # [K] of a coordinate for a factor e of an oil flow
GAIN = 8.0  # [K] by which an economizer's temperature is about wrong where its port draws e times what there is
LEAST_OIL, MOST_OIL, FIRST_OIL = 0.02, 60.0, 2.0  # oil over gas
VALVE = 10.0  # [K] of a coordinate for a factor e of a valve's opening
SHUT, FIRST_OPENING = 1e-4, 0.2  # of a valve
LATENT = 200.0  # [K] by which as much liquid as gas would about cool the gas
WARMS = 2.0  # heat capacity of oil over that of gas, about
APART = 0.5  # [K] at least, of an economizer from both lines and from the liquid that it cools
AT_END = 1e-6  # [K]


class Asked(NamedTuple):
    """By how much one coordinate should change [K], and what it leaves open, relative; neither at an end of its way."""

    off: float
    open: float


class Span(NamedTuple):
    """Ends of a coordinate [K]."""

    low: float
    high: float

    def kept(self, x: float) -> float:
        """Return the nearest coordinate between both ends."""
        return min(max(x, self.low), self.high)

    def at_end(self, x: float) -> bool:
        """Tell whether a coordinate stands at an end."""
        return min(x - self.low, self.high - x) <= AT_END


def oil_is_sought(scene: Scene) -> bool:
    """Tell whether the oil's ratio is found."""
    supply = scene.oil_supply
    return supply is not None and (supply.discharge_temperature is not None or supply.flow is not None)


def economizer_is_sought(scene: Scene) -> bool:
    """Tell whether the economizer's temperature is found."""
    active = scene.effects.get(ECONOMIZER)
    return active is not None and isinstance(active.parameters.temperature, Found)


def liquid_is_sought(scene: Scene) -> bool:
    """Tell whether the opening of the valve of injected liquid is found."""
    active = scene.effects.get(LIQUID)
    return active is not None and active.parameters.discharge_temperature is not None


def is_sought(scene: Scene) -> bool:
    """Tell whether a scene leaves any such number open."""
    return oil_is_sought(scene) or economizer_is_sought(scene) or liquid_is_sought(scene)


def spans(scene: Scene) -> list[Span]:
    """Return the ends of each coordinate, in the order of `standing`."""
    found = []
    if oil_is_sought(scene):
        found.append(Span(LOG * math.log(LEAST_OIL), LOG * math.log(MOST_OIL)))
    if economizer_is_sought(scene):
        found.append(_of_economizer(scene))
    if liquid_is_sought(scene):
        found.append(Span(VALVE * math.log(SHUT), 0.0))
    return found


def _of_economizer(scene: Scene) -> Span:
    """Return the temperatures between evaporation and the liquid that an economizer can cool."""
    operation, fluid, at = scene.operation, scene.gas.name, lines(scene)
    parameters = scene.effects[ECONOMIZER].parameters
    low = operation.evaporating_temperature or constants.saturation_temperature(fluid, at.p_s)
    cooler, T_c = operation.gas_cooler, operation.condensing_temperature
    if cooler is not None:
        limits = constants.limits(fluid)
        most = cooler.outlet_temperature if limits is None else limits.T_critical - 1.0
        liquid, warmest = cooler.outlet_temperature, most
    else:
        liquid = constants.condensed(fluid, T_c or 0.0) - (operation.subcooling or 0.0)
        warmest = T_c or liquid
    approach = parameters.approach if parameters.kind == "heat_exchanger" else 0.0
    return Span(low + APART, max(min(liquid - approach, warmest) - APART, low + APART))


def completed(scene: Scene, near: Sequence[float] | None = None) -> Scene:
    """Return a scene whose open numbers have values: those `near`, or first guesses."""
    if not is_sought(scene):
        return scene
    standing_now = standing(scene)
    if None not in standing_now:
        return scene
    if near is not None and len(near) == len(standing_now):
        return placed(scene, near)
    return placed(scene, list(_guesses(scene)))


def _guesses(scene: Scene) -> Iterator[float]:
    if oil_is_sought(scene):
        yield LOG * math.log(FIRST_OIL)
    if economizer_is_sought(scene):
        span = _of_economizer(scene)
        yield span.low + 0.4 * (span.high - span.low)
    if liquid_is_sought(scene):
        yield VALVE * math.log(FIRST_OPENING)


def standing(scene: Scene) -> list[float | None]:
    """Return where each coordinate stands [K]; None where it has no value yet."""
    found: list[float | None] = []
    if oil_is_sought(scene):
        assert scene.oil_supply is not None
        ratio = scene.oil_supply.ratio
        found.append(LOG * math.log(ratio) if ratio else None)
    if economizer_is_sought(scene):
        T = scene.effects[ECONOMIZER].parameters.temperature
        found.append(float(T) if T > 0.0 else None)
    if liquid_is_sought(scene):
        opening = scene.effects[LIQUID].parameters.opening
        found.append(VALVE * math.log(opening) if opening else None)
    return found


def placed(scene: Scene, at: Sequence[float]) -> Scene:
    """Return a scene with its coordinates at these, kept between their ends."""
    wanted = [span.kept(x) for span, x in zip(spans(scene), at, strict=True)]
    if oil_is_sought(scene):
        ratio = Found(math.exp(wanted.pop(0) / LOG))
        assert scene.oil_supply is not None
        scene = replace(scene, oil_supply=replace(scene.oil_supply, ratio=ratio))
    if economizer_is_sought(scene):
        scene = _with(scene, ECONOMIZER, temperature=Found(wanted.pop(0)))
    if liquid_is_sought(scene):
        scene = _with(scene, LIQUID, opening=Found(math.exp(wanted.pop(0) / VALVE)))
    return scene


def _with(scene: Scene, name: str, **changes: Found) -> Scene:
    active = scene.effects[name]
    other = replace(active, parameters=replace(active.parameters, **changes))
    return replace(scene, effects={**scene.effects, name: other})


def asked(scene: Scene, figures: Mapping[str, Any], T_oil: float, follows: bool = False) -> list[Asked] | None:
    """Return what the figures of a cycle ask of each coordinate; None where a figure has no value.

    `follows` tells that the oil's temperature goes with that of the discharge, which it then does not hold.
    """
    found = []
    for span, x, off in zip(spans(scene), standing(scene), _off(scene, figures, T_oil, follows), strict=True):
        if off is None or x is None:
            return None
        step, scale = off
        change = span.kept(x + step) - x
        outward = span.at_end(x) and abs(change) <= AT_END
        found.append(Asked(0.0 if outward else change, 0.0 if outward else abs(step) / scale))
    return found


def _off(scene: Scene, figures: Mapping[str, Any], T_oil: float, follows: bool) -> Iterator[tuple[float, float] | None]:
    """Yield by how much each coordinate is about wrong [K], and how much of it is a factor e of its flow."""
    if oil_is_sought(scene):
        yield _off_oil(scene, figures, T_oil)
    if economizer_is_sought(scene):
        ratio = figures.get(DRAWN)
        yield None if ratio is None else (-GAIN * math.log(max(ratio, 1e-2)), GAIN)
    if liquid_is_sought(scene):
        wanted, T = scene.effects[LIQUID].parameters.discharge_temperature, _at_discharge(figures)
        ratio = figures.get(INJECTED)
        if T is None or ratio is None:
            yield None
            return
        oil = 0.0 if follows else figures.get("oil_ratio") or 0.0
        cools = max(ratio, 1e-6) * LATENT / (1.0 + WARMS * oil)
        yield VALVE * math.log(max(1.0 + (T - wanted) / cools, 1e-3)), VALVE


def _off_oil(scene: Scene, figures: Mapping[str, Any], T_oil: float) -> tuple[float, float] | None:
    """Return by how much the oil's coordinate is about wrong [K], and how much of it is a factor e of its flow."""
    assert scene.oil_supply is not None
    if scene.oil_supply.flow is not None:
        share = _share(scene, figures, T_oil)
        return None if share is None else (-LOG * math.log(share), LOG)
    wanted, T = scene.oil_supply.discharge_temperature or 0.0, figures.get(MIXTURE)
    least = 1e-3 * (wanted - T_oil)
    return None if T is None else (LOG * math.log(max(T - T_oil, least) / (wanted - T_oil)), LOG)


def _share(scene: Scene, figures: Mapping[str, Any], T_oil: float) -> float | None:
    """Return the injected oil over that which is wanted; None where there is none."""
    flow = figures.get("oil_mass_flow")
    assert scene.oil is not None and scene.oil_supply is not None and scene.oil_supply.flow is not None
    return flow / (scene.oil.at(T_oil).density * scene.oil_supply.flow) if flow and flow > 0.0 else None


def _at_discharge(figures: Mapping[str, Any]) -> float | None:
    """Return the temperature [K] that a sensor at discharge has: of gas and oil, where they come to one."""
    T = figures.get(MIXTURE)
    return figures.get(DISCHARGE) if T is None else T


def warnings(scene: Scene, figures: Mapping[str, Any]) -> Iterator[str]:
    """Yield that no value of an open number does what is asked: it stands at an end."""
    ends = list(zip(spans(scene), standing(scene), strict=True))
    if oil_is_sought(scene):
        span, x = ends.pop(0)
        if x is not None and span.at_end(x):
            yield from _of_oil(scene, figures, math.exp(x / LOG))
    if economizer_is_sought(scene):
        span, x = ends.pop(0)
        ratio = figures.get(DRAWN)
        if x is not None and span.at_end(x) and ratio is not None:
            what = "at no temperature does the economizer's port draw what the liquid gives off"
            end = f"at {_celsius(x)}, the {'lowest' if x - span.low < span.high - x else 'highest'}"
            remedy = (
                "a smaller port, or one that opens later" if ratio > 1.0 else "a larger port, or one that opens earlier"
            )
            yield f"{what}: {end}, it draws {ratio:.3g} times that ({remedy})"
    if liquid_is_sought(scene):
        span, x = ends.pop(0)
        T, wanted = _at_discharge(figures), scene.effects[LIQUID].parameters.discharge_temperature
        if x is not None and span.at_end(x) and T is not None:
            yield _idle(T, wanted, x - span.low < span.high - x)


def _of_oil(scene: Scene, figures: Mapping[str, Any], ratio: float) -> Iterator[str]:
    """Yield that the least or most oil per gas does not do what is asked."""
    supply, T = scene.oil_supply, figures.get(MIXTURE)
    assert supply is not None
    if supply.flow is not None:
        share = _share(scene, figures, supply.temperature or 0.0)
        if share is not None:
            what = f"with {ratio:.3g} kg of oil per kg of gas, the {'least' if share > 1.0 else 'most'} that is tried"
            yield f"{what}, {share:.3g} times oil_supply.flow is injected (another oil_supply.flow)"
    elif T is not None:
        what = f"no oil flow brings the mixture to {_celsius(supply.discharge_temperature or 0.0)}"
        end = f"with {ratio:.3g} kg per kg of gas it comes to {_celsius(T)}"
        yield f"{what}: {end} (another oil_supply.discharge_temperature, or oil of another temperature)"


def _idle(T: float, wanted: float, shut: bool) -> str:
    """Return that a valve of injected liquid stands at an end, with the temperatures [K] there and wanted."""
    if shut:
        what = f"the valve of injected liquid stays shut: without it the discharge comes to {_celsius(T)}"
        return f"{what}, not to {_celsius(wanted)} (lower effects.{LIQUID}.discharge_temperature, or none)"
    what = f"no injected liquid brings the discharge to {_celsius(wanted)}: wide open it comes to {_celsius(T)}"
    return f"{what} (a larger effects.{LIQUID}.area, or a bore that opens earlier)"


def _celsius(T: float) -> str:
    return f"{T - ZERO_CELSIUS:.1f} degC"
