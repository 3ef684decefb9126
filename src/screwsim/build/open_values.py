"""Unknown parameters that a scene leaves open, each found with the cycle from a figure stated in its place.

`oil_supply.discharge_temperature` states the mixture's discharge temperature that the oil flow must produce
(docs/model.md M370), `oil_supply.flow` the flow that a pump delivers (M393). Effects define their own open parameters
(`effects.parts.made`). All are solved together with the cycle (`solve.circuit`), each as a coordinate in kelvin.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from screwsim.effects.base import Sought, Span
from screwsim.effects.parts.made import AT_END
from screwsim.fluid.settings import OilSettings
from screwsim.inputs.declare import FoundWithCycle
from screwsim.numerics.frozen import with_changes
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.outputs.customary import celsius
from screwsim.scene.lines import lines
from screwsim.scene.types import ActiveEffect, OilSupply, Scene, parameters_of_type

MIXTURE, OIL_SUPPLY = "mixture_discharge_temperature", "oil_supply"
LOG = 20.0  # [K] change of the coordinate that makes a factor e of the oil flow
LEAST_OIL, MOST_OIL, FIRST_OIL = 0.02, 60.0, 2.0  # oil per gas by mass: limits and first guess
OIL = Span(LOG * math.log(LEAST_OIL), LOG * math.log(MOST_OIL))


class CoordinateChange(NamedTuple):
    """Change that the figures require of a coordinate [K], and the remaining relative error of its flow.

    Both are zero where the coordinate is `held` at an end of its range: it would have to move outwards.
    """

    off: float
    open: float
    held: bool = False


@dataclass(frozen=True)
class _OilRatio(Sought):
    """The oil-to-gas ratio, open where the scene states a discharge temperature or the pump's flow in its place.

    `T_oil` [K] is the temperature at which the oil is injected.
    """

    supply: OilSupply
    oil: OilSettings | None
    T_oil: float

    @property
    def is_open(self) -> bool:
        return self.supply.discharge_temperature is not None or self.supply.flow is not None

    @property
    def stands(self) -> float | None:
        return LOG * math.log(self.supply.ratio) if self.supply.ratio else None

    def span(self, facts: Any, suction_pressure: Callable[[], float]) -> Span:
        return OIL

    def first(self, span: Span) -> float:
        return LOG * math.log(FIRST_OIL)

    def placed(self, x: float) -> dict[str, Any]:
        return {"ratio": FoundWithCycle(math.exp(x / LOG))}

    def off(self, figures: Mapping[str, Any], oil_follows: bool) -> tuple[float, float] | None:
        if self.supply.flow is not None:
            share = self._flow_share(figures)
            return None if share is None else (-LOG * math.log(share), LOG)
        wanted, T = self.supply.discharge_temperature or 0.0, figures.get(MIXTURE)
        least = 1e-3 * (wanted - self.T_oil)
        return None if T is None else (LOG * math.log(max(T - self.T_oil, least) / (wanted - self.T_oil)), LOG)

    def idle(self, figures: Mapping[str, Any], x: float, lowest: bool) -> str:
        ratio, T = math.exp(x / LOG), figures.get(MIXTURE)
        if self.supply.flow is not None:
            share = self._flow_share(figures)
            if share is None:
                return ""
            what = f"with {ratio:.3g} kg of oil per kg of gas, the {'least' if share > 1.0 else 'most'} ratio tried"
            return f"{what}, {share:.3g} times oil_supply.flow is injected (choose another oil_supply.flow)"
        if T is None:
            return ""
        what = f"no oil flow brings the mixture to {celsius(self.supply.discharge_temperature or 0.0)}"
        end = f"with {ratio:.3g} kg per kg of gas it reaches {celsius(T)}"
        return f"{what}: {end} (choose another oil_supply.discharge_temperature or oil temperature)"

    def _flow_share(self, figures: Mapping[str, Any]) -> float | None:
        """Return the injected oil flow over the requested one; None where no oil is injected."""
        flow = figures.get("oil_mass_flow")
        assert self.oil is not None and self.supply.flow is not None
        return flow / (self.oil.at(self.T_oil).density * self.supply.flow) if flow and flow > 0.0 else None


@IdentityCache
def _of_effects(effects: Mapping[str, ActiveEffect]) -> dict[str, Sought]:
    """Return the parameters of the effects that leave a number open, by effect name."""
    return {name: sought for name, sought in parameters_of_type(effects, Sought).items() if sought.is_open}


def _open(scene: Scene, T_oil: float | None = None) -> dict[str, Sought]:
    """Return what a scene leaves open, the oil's ratio first, by effect name or `OIL_SUPPLY`.

    `T_oil` [K]: that of the injected oil, if it is not the one that the scene states.
    """
    supply = scene.oil_supply
    if supply is None:
        return _of_effects(scene.effects)
    ratio = _OilRatio(supply, scene.oil, (supply.temperature or 0.0) if T_oil is None else T_oil)
    return ({OIL_SUPPLY: ratio} if ratio.is_open else {}) | _of_effects(scene.effects)


def has_open_values(scene: Scene) -> bool:
    """Tell whether a scene leaves any parameter open."""
    return bool(_open(scene))


def coordinate_ranges(scene: Scene) -> list[Span]:
    """Return the range of each coordinate, in the order of `current_coordinates`."""
    return [one.span(scene, lambda: lines(scene).p_s) for one in _open(scene).values()]


def completed(scene: Scene, near: Sequence[float] | None = None) -> Scene:
    """Return a scene whose open parameters have values: the coordinates `near`, or first guesses."""
    standing_now = current_coordinates(scene)
    if None not in standing_now:
        return scene
    if near is None or len(near) != len(standing_now):
        near = [one.first(span) for one, span in zip(_open(scene).values(), coordinate_ranges(scene), strict=True)]
    return with_coordinates(scene, near)


def cautious_coordinates(scene: Scene) -> list[float]:
    """Return first guesses of the coordinates for a machine that has no net flow with those of `completed`."""
    return [one.cautious(span) for one, span in zip(_open(scene).values(), coordinate_ranges(scene), strict=True)]


def current_coordinates(scene: Scene) -> list[float | None]:
    """Return the current value of each coordinate [K]; None where it has none yet."""
    return [one.stands for one in _open(scene).values()]


def ends(scene: Scene) -> list[Span | None]:
    """Return the range of each coordinate that is at an end of it, where it follows from no figure; else None."""
    places = zip(coordinate_ranges(scene), current_coordinates(scene), strict=True)
    return [span if x is not None and span.at_end(x) else None for span, x in places]


def with_coordinates(scene: Scene, at: Sequence[float]) -> Scene:
    """Return a scene with its coordinates at the given values, limited to their ranges."""
    effects = {**scene.effects}
    for (name, one), span, x in zip(_open(scene).items(), coordinate_ranges(scene), at, strict=True):
        found = one.placed(span.kept(x))
        if name == OIL_SUPPLY:
            scene = replace(scene, oil_supply=with_changes(scene.oil_supply, **found))
        else:
            effects[name] = with_changes(effects[name], parameters=with_changes(effects[name].parameters, **found))
    return replace(scene, effects=effects) if _of_effects(scene.effects) else scene


def required_changes(
    scene: Scene, figures: Mapping[str, Any], T_oil: float, follows: bool
) -> list[CoordinateChange] | None:
    """Return the change that the figures of a cycle require of each coordinate; None where a figure has no value.

    A change may lead beyond the coordinate's range, which bounds where the search goes but not what it learns from: a
    change cut off at the end of the range depends on the place, not on the flow. `follows`: the oil's temperature moves
    with that of the discharge, so that the oil does not hold the latter.
    """
    found = []
    for span, one in zip(coordinate_ranges(scene), _open(scene, T_oil).values(), strict=True):
        off, x = one.off(figures, follows), one.stands
        if off is None or x is None:
            return None
        step, scale = off
        outward = span.at_end(x) and abs(span.kept(x + step) - x) <= AT_END
        found.append(CoordinateChange(0.0, 0.0, held=True) if outward else CoordinateChange(step, abs(step) / scale))
    return found


def warnings(scene: Scene, figures: Mapping[str, Any]) -> Iterator[str]:
    """Yield a warning for each open parameter at an end of its range: no value gives the requested figure."""
    for one, span in zip(_open(scene).values(), coordinate_ranges(scene), strict=True):
        x = one.stands
        words = one.idle(figures, x, x - span.low < span.high - x) if x is not None and span.at_end(x) else ""
        if words:
            yield words
