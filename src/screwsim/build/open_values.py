"""Unknown parameters that a scene leaves open, each found with the cycle from a figure stated in its place.

`oil_supply.discharge_temperature` states the mixture's discharge temperature that the oil flow must produce
(docs/model.md M370), `oil_supply.flow` the flow that a pump delivers (M393). Effects define their own open parameters
(`effects.parts.made`). All are solved together with the cycle (`solve.circuit`), each as a coordinate in kelvin.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from screwsim.effects.base import Sought, Span
from screwsim.effects.parts.made import AT_END
from screwsim.inputs.declare import FoundWithCycle
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.outputs.customary import celsius
from screwsim.scene.lines import lines
from screwsim.scene.types import ActiveEffect, Scene

MIXTURE = "mixture_discharge_temperature"
LOG = 20.0  # [K] change of the coordinate that makes a factor e of the oil flow
LEAST_OIL, MOST_OIL, FIRST_OIL = 0.02, 60.0, 2.0  # oil per gas by mass: limits and first guess
OIL = Span(LOG * math.log(LEAST_OIL), LOG * math.log(MOST_OIL))


class CoordinateChange(NamedTuple):
    """Change that the figures require of a coordinate [K], and the remaining relative error of its flow.

    Both are zero where the coordinate is at an end of its range and would have to move outwards.
    """

    off: float
    open: float


def oil_ratio_is_open(scene: Scene) -> bool:
    """Tell whether the oil-to-gas ratio is to be found."""
    supply = scene.oil_supply
    return supply is not None and (supply.discharge_temperature is not None or supply.flow is not None)


@IdentityCache
def _open(effects: Mapping[str, ActiveEffect]) -> dict[str, Sought]:
    """Return the parameters of the effects that leave a number open, by effect name."""
    every = ((name, active.parameters) for name, active in effects.items())
    return {name: parameters for name, parameters in every if isinstance(parameters, Sought) and parameters.is_open}


def has_open_values(scene: Scene) -> bool:
    """Tell whether a scene leaves any parameter open."""
    return oil_ratio_is_open(scene) or bool(_open(scene.effects))


def coordinate_ranges(scene: Scene) -> list[Span]:
    """Return the range of each coordinate, in the order of `current_coordinates`."""
    return [*([OIL] if oil_ratio_is_open(scene) else ()), *_of_effects(scene).values()]


def _of_effects(scene: Scene) -> dict[str, Span]:
    return {name: one.span(scene, lambda: lines(scene).p_s) for name, one in _open(scene.effects).items()}


def completed(scene: Scene, near: Sequence[float] | None = None) -> Scene:
    """Return a scene whose open parameters have values: the coordinates `near`, or first guesses."""
    standing_now = current_coordinates(scene)
    if None not in standing_now:
        return scene
    if near is None or len(near) != len(standing_now):
        near = list(_guesses(scene))
    return with_coordinates(scene, near)


def _guesses(scene: Scene) -> Iterator[float]:
    if oil_ratio_is_open(scene):
        yield LOG * math.log(FIRST_OIL)
    for name, span in _of_effects(scene).items():
        yield _open(scene.effects)[name].first(span)


def current_coordinates(scene: Scene) -> list[float | None]:
    """Return the current value of each coordinate [K]; None where it has none yet."""
    found: list[float | None] = []
    if oil_ratio_is_open(scene):
        assert scene.oil_supply is not None
        ratio = scene.oil_supply.ratio
        found.append(LOG * math.log(ratio) if ratio else None)
    return found + [one.stands for one in _open(scene.effects).values()]


def with_coordinates(scene: Scene, at: Sequence[float]) -> Scene:
    """Return a scene with its coordinates at the given values, limited to their ranges."""
    wanted = [span.kept(x) for span, x in zip(coordinate_ranges(scene), at, strict=True)]
    if oil_ratio_is_open(scene):
        ratio = FoundWithCycle(math.exp(wanted.pop(0) / LOG))
        assert scene.oil_supply is not None
        scene = replace(scene, oil_supply=replace(scene.oil_supply, ratio=ratio))
    effects = {**scene.effects}
    for (name, one), x in zip(_open(scene.effects).items(), wanted, strict=True):
        parameters: Any = one
        effects[name] = replace(effects[name], parameters=replace(parameters, **one.placed(x)))
    return replace(scene, effects=effects) if wanted else scene


def required_changes(
    scene: Scene, figures: Mapping[str, Any], T_oil: float, follows: bool = False
) -> list[CoordinateChange] | None:
    """Return the change that the figures of a cycle require of each coordinate; None where a figure has no value.

    A change may lead beyond the coordinate's range, which bounds where the search goes but not what it learns from: a
    change cut off at the end of the range depends on the place, not on the flow. `follows`: the oil's temperature moves
    with that of the discharge, so that the oil does not hold the latter.
    """
    found = []
    for span, x, off in zip(
        coordinate_ranges(scene), current_coordinates(scene), _deviations(scene, figures, T_oil, follows), strict=True
    ):
        if off is None or x is None:
            return None
        step, scale = off
        outward = span.at_end(x) and abs(span.kept(x + step) - x) <= AT_END
        found.append(CoordinateChange(0.0, 0.0) if outward else CoordinateChange(step, abs(step) / scale))
    return found


def _deviations(
    scene: Scene, figures: Mapping[str, Any], T_oil: float, follows: bool
) -> Iterator[tuple[float, float] | None]:
    """Yield (approximate error [K], change [K] that makes a factor e of its flow) of each coordinate."""
    if oil_ratio_is_open(scene):
        yield _oil_deviation(scene, figures, T_oil)
    for one in _open(scene.effects).values():
        yield one.off(figures, follows)


def _oil_deviation(scene: Scene, figures: Mapping[str, Any], T_oil: float) -> tuple[float, float] | None:
    """Return (approximate error [K], change [K] that makes a factor e of its flow) of the oil's coordinate."""
    assert scene.oil_supply is not None
    if scene.oil_supply.flow is not None:
        share = _oil_flow_share(scene, figures, T_oil)
        return None if share is None else (-LOG * math.log(share), LOG)
    wanted, T = scene.oil_supply.discharge_temperature or 0.0, figures.get(MIXTURE)
    least = 1e-3 * (wanted - T_oil)
    return None if T is None else (LOG * math.log(max(T - T_oil, least) / (wanted - T_oil)), LOG)


def _oil_flow_share(scene: Scene, figures: Mapping[str, Any], T_oil: float) -> float | None:
    """Return the injected oil flow over the requested one; None where no oil is injected."""
    flow = figures.get("oil_mass_flow")
    assert scene.oil is not None and scene.oil_supply is not None and scene.oil_supply.flow is not None
    return flow / (scene.oil.at(T_oil).density * scene.oil_supply.flow) if flow and flow > 0.0 else None


def warnings(scene: Scene, figures: Mapping[str, Any]) -> Iterator[str]:
    """Yield a warning for each open parameter at an end of its range: no value gives the requested figure."""
    ends = list(zip(coordinate_ranges(scene), current_coordinates(scene), strict=True))
    if oil_ratio_is_open(scene):
        span, x = ends.pop(0)
        if x is not None and span.at_end(x):
            yield from _of_oil(scene, figures, math.exp(x / LOG))
    for one, (span, x) in zip(_open(scene.effects).values(), ends, strict=True):
        words = one.idle(figures, x, x - span.low < span.high - x) if x is not None and span.at_end(x) else ""
        if words:
            yield words


def _of_oil(scene: Scene, figures: Mapping[str, Any], ratio: float) -> Iterator[str]:
    """Yield that the smallest or largest oil-to-gas ratio does not give the requested figure."""
    supply, T = scene.oil_supply, figures.get(MIXTURE)
    assert supply is not None
    if supply.flow is not None:
        share = _oil_flow_share(scene, figures, supply.temperature or 0.0)
        if share is not None:
            what = f"with {ratio:.3g} kg of oil per kg of gas, the {'least' if share > 1.0 else 'most'} ratio tried"
            yield f"{what}, {share:.3g} times oil_supply.flow is injected (choose another oil_supply.flow)"
    elif T is not None:
        what = f"no oil flow brings the mixture to {celsius(supply.discharge_temperature or 0.0)}"
        end = f"with {ratio:.3g} kg per kg of gas it reaches {celsius(T)}"
        yield f"{what}: {end} (choose another oil_supply.discharge_temperature or oil temperature)"
