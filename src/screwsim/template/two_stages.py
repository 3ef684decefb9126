"""Two screws in series: a scene of each, and the file that joins them.

Both are the machines of one stage (`template.gas`, `template.refrigeration`), each for its part of the pressure ratio.
Air is cooled between them, but stays so warm that its water would not condense; refrigerants pass a flash tank.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from screwsim.fluid import constants
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import joined_names
from screwsim.outputs.customary import ZERO_CELSIUS, in_bar
from screwsim.template import gas, refrigeration, sizes, texts
from screwsim.template.duty import COPPER_CORROSIVES, EFFICIENCIES, duty_of
from screwsim.template.request import ATMOSPHERE, SPEED, SceneRequest, Stage

OPTION, ENDING = "--two-stage", ".stages.yaml"
AIR, COOLING, HEATING = "air", "refrigeration", "heat_pump"
PLANTS = {COOLING: refrigeration.COOLING, HEATING: refrigeration.HEATING}
# of two stages, by kind
CONDITIONS = {AIR: "0 bar(g)/10 bar(g), 20 degC", COOLING: "-30/40 degC", HEATING: "0/80 degC"}
LEAST_RATIO, LARGEST_RATIO = (
    6.0,
    256.0,
)  # of the outer pressures: below, one stage does it; above, each has more than 16
OVER_DEW = 5.0  # [K] margin of cooled air above the dew point of saturated air from the inlet: assumed
COLDEST_INLET = 275.0  # [K] from which the vapour pressure of that water is taken
GAS_SHARE = 0.75  # of the second stage's gas that the first delivers, for an estimate
PRESSURE_DROP = 0.1e5  # [Pa] of the cooler between two stages of air: assumed
TOLD = {  # comment on what lies between both stages, by its kind
    "economizer": "# The vapour of a flash tank mixes into the gas between both (M202).",
    "flash_intercooler": (
        "# The gas passes the liquid of a flash tank, which cools it to saturation (open intercooler, M202), as is\n"
        "# usual for ammonia."
    ),
    "cooler": (
        "# The gas stays at least 5 K warmer than where the water of saturated air from the inlet would condense.\n"
        "# That margin and the pressure drop are assumed."
    ),
    "none": "# No cooler: the water of saturated air from the inlet would condense in it.",
}
ALONE = {  # what is written instead of two stages, by kind
    "booster": "; write a booster to the pressure between and one from it, and join them: docs/how-to/two-stages.md"
}
REFUSED = {
    "--motor": "each stage has a motor of its own, for the load that is found",
    "--vi": "each stage has its own built-in volume ratio",
    "--economizer": "two stages have a flash tank between them",
    "--slide": "a slide valve belongs to one stage",
}


@dataclass(frozen=True)
class Ends:
    """The outer pressures [Pa] of two stages, both lines as a condition states them, and the state at the inlet.

    `T` is the temperature [K] there, `beside` its text or that of the superheat; `cooled` [K] is what a cooler between
    both leaves of air, None without one; `ambient` [Pa] is the reference of gauge pressures.
    """

    p_s: float
    p_d: float
    low: str
    high: str
    T: float
    beside: str
    cooled: float | None = None
    ambient: float = ATMOSPHERE

    @property
    def between(self) -> float:
        """The pressure [Pa] between both stages that divides the pressure ratio equally."""
        return math.sqrt(self.p_s * self.p_d)


class Found(NamedTuple):
    """What is known of two stages when their scenes are written: displacements [m³/s], the state between, loads [W].

    `suction` is the suction temperature [K] of the second stage.
    """

    first: float
    second: float
    between: float
    suction: float
    loads: tuple[float, float] | None = None


class Names(NamedTuple):
    """The names of the files: both scenes and the file that joins them."""

    low: str
    high: str
    stages: str


def names_from(stages: str) -> Names:
    """Return the names of both scenes beside that of the file that joins them."""
    root = stages.removesuffix(ENDING)
    return Names(f"{root}_low.yaml", f"{root}_high.yaml", stages)


def check_options(kind: str, stated: Mapping[str, Any]) -> None:
    """Raise UsageError for a kind that is not written in two stages, or an option that they do not take."""
    if kind not in CONDITIONS:
        what = f"is for {joined_names(list(CONDITIONS))}"
        raise UsageError(f"{OPTION}: {what} (remove it{ALONE.get(kind, '')})")
    for option, why in REFUSED.items():
        if stated.get(option):
            raise UsageError(f"{option}: {why} (remove it, and change the scenes that are written)")


def ends_of(kind: str, asked: SceneRequest) -> Ends:
    """Return the outer ends of two stages; raise UsageError, in one line, where they make no sense."""
    asked = replace(asked, condition=asked.condition or CONDITIONS[kind])
    ends = _ends_of_air(asked) if kind == AIR else _ends_of_plant(kind, asked)
    ratio = ends.p_d / ends.p_s
    if ratio < LEAST_RATIO:
        what = f"a pressure ratio of {ratio:.3g} takes one stage; two make sense from about {LEAST_RATIO:g}"
        raise UsageError(f"{OPTION}: {what} (remove it)")
    if ratio > LARGEST_RATIO:
        what = f"a pressure ratio of {ratio:.4g} takes more than two stages"
        raise UsageError(f"{OPTION}: {what} (choose ends closer together, {LARGEST_RATIO:g} at the most)")
    return ends


def _ends_of_air(asked: SceneRequest) -> Ends:
    duty = gas.air_duty(asked)
    low, high = duty.at.low_text, duty.at.high_text
    ends = Ends(duty.at.low, duty.at.high, low, high, duty.T, duty.temperature, ambient=gas.ambient_of(duty.at))
    water = constants.dew_pressure("Water", max(duty.T, COLDEST_INLET)) * ends.between / ends.p_s
    dry = constants.saturation_temperature("Water", water) + OVER_DEW
    cooled = ZERO_CELSIUS + 5.0 * math.ceil((dry - ZERO_CELSIUS) / 5.0)
    return replace(ends, cooled=cooled) if cooled < gas.LEAVES else ends


def _ends_of_plant(kind: str, asked: SceneRequest) -> Ends:
    example, fluid = CONDITIONS[kind], _refrigerant(kind, asked)
    if constants.parts_on_boiling(fluid):
        what = f"vapour boiling off {fluid}, a blend, in the tank between both stages differs from it in composition"
        raise UsageError(f"{OPTION}: {what} (choose a pure fluid or one that hardly glides, e.g. R134a or R404A)")
    states = duty_of(fluid, 1.0, asked.condition or example, example)
    low, high = (f"{T - ZERO_CELSIUS:.6g} degC" for T in (states.T_e, states.T_c))
    return Ends(states.p_s, states.p_d, low, high, states.T_e + states.more, f"{states.more:g} K")


def _refrigerant(kind: str, asked: SceneRequest) -> str:
    return asked.fluid or PLANTS[kind].fluid


def first_found(kind: str, asked: SceneRequest, ends: Ends) -> Found:
    """Return an estimate from which both sizes are sought: equal filling of both stages."""
    usual = 1200.0 / 3600.0 if kind == AIR else refrigeration.DEFAULT_DISPLACEMENT_FLOW
    flow = asked.flow or (usual if asked.free_air is None else sizes.rounded_flow(asked.free_air / gas.LAMBDA))
    if kind == AIR:
        suction = ends.cooled or gas.LEAVES
        second = flow * ends.p_s / ends.between * suction / ends.T
    else:
        suction = _mixed_suction(_refrigerant(kind, asked), ends)
        second = flow * ends.p_s / ends.between
    return Found(flow, sizes.rounded_flow(second), ends.between, suction)


def _mixed_suction(fluid: str, ends: Ends) -> float:
    """Return an estimate of the second stage's suction temperature [K]: gas of the first with vapour of the tank."""
    T = ends.T
    T_m, k = constants.saturation_temperature(fluid, ends.between), constants.isentropic_exponent(fluid, T)
    if fluid.lower() in COPPER_CORROSIVES:
        return T_m  # the tank's liquid cools the gas to saturation
    hot = T + T * ((ends.between / ends.p_s) ** ((k - 1.0) / k) - 1.0) / EFFICIENCIES[1]
    return T_m + GAS_SHARE * max(hot - T_m, 0.0)


def scenes_of(kind: str, asked: SceneRequest, ends: Ends, found: Found) -> tuple[str, str]:
    """Return the texts of both scenes; raise UsageError or SceneError where there can be none."""
    loads = found.loads or (None, None)
    low = replace(asked, flow=found.first, load=loads[0], free_air=None, capacity=None)
    high = replace(asked, flow=found.second, load=loads[1], free_air=None, capacity=None, diameter=None)
    if kind == AIR:
        between = f"{1e-5 * found.between:.4g} bar"
        motors = None if found.loads is None else 1e3 * sum(sizes.motor_for(load, reserve=1.0) for load in found.loads)
        stage = Stage(False, ends.ambient, ends.beside, ends.T, motors)
        warm = f"{found.suction - ZERO_CELSIUS:.3g} degC"
        low = replace(low, condition=f"{ends.low}/{between}, {ends.beside}", stage=stage)
        high = replace(high, condition=f"{between}/{ends.high}, {warm}", stage=replace(stage, second=True))
        return gas.air(low), gas.air(high)
    T_m = constants.saturation_temperature(_refrigerant(kind, asked), found.between)
    between, more = f"{T_m - ZERO_CELSIUS:.3g} degC", max(found.suction - T_m, 0.0)
    low = replace(low, condition=f"{ends.low}/{between}, {ends.beside}")
    high = replace(high, condition=f"{between}/{ends.high}, {more:.0f} K")

    def both(condenses: bool) -> tuple[str, str]:
        first, second = (Stage(second, condenses=condenses) for second in (False, True))
        plant = PLANTS[kind]
        return (
            refrigeration.scene_of(plant, replace(low, stage=first)),
            refrigeration.scene_of(plant, replace(high, stage=second)),
        )

    each_by_itself = both(condenses=False)
    condenses = [texts.FOLLOWS_PHASES in text for text in each_by_itself]
    return both(condenses=True) if any(condenses) and not all(condenses) else each_by_itself


class Between(NamedTuple):
    """What lies between both stages: its kind, and of a cooler its outlet [K] and pressure drop [Pa]."""

    kind: str
    outlet_temperature: float | None = None
    pressure_drop: float = 0.0


def between_of(kind: str, asked: SceneRequest, ends: Ends) -> Between:
    """Return what lies between both stages."""
    if kind in PLANTS:
        return Between("flash_intercooler" if _refrigerant(kind, asked).lower() in COPPER_CORROSIVES else "economizer")
    return Between("none") if ends.cooled is None else Between("cooler", ends.cooled, PRESSURE_DROP)


def stages_text(kind: str, asked: SceneRequest, ends: Ends, names: Names) -> str:
    """Return the text of the file that joins both scenes."""
    between = between_of(kind, asked, ends)
    entry = f"kind: {between.kind}"
    if ends.cooled is not None:
        cooled = f"{ends.cooled - ZERO_CELSIUS:g} degC"
        entry += f", outlet_temperature: {cooled}, pressure_drop: {1e-5 * PRESSURE_DROP:g} bar"
    fluid = "Air" if kind == AIR else _refrigerant(kind, asked)
    plant = "heat pump" if kind == HEATING else "refrigeration plant"
    lines = f"{ends.low}/{ends.high}"
    values = {
        "what": "An oil-flooded air package" if kind == AIR else f"A {plant} on {fluid}",
        "between": in_bar(float(f"{ends.between:.3g}")),
        "title": f"{'Air package' if kind == AIR else f'{plant.capitalize()}, {fluid}'}, {lines}, two stages",
        "low": names.low,
        "high": names.high,
        "told": TOLD[between.kind],
        "intercooler": entry,
        "sweep": _sweep(asked) if asked.variable else "",
    }
    return texts.filled("stages", values)


def _sweep(asked: SceneRequest) -> str:
    """Return the points of a variable-speed package, at which both stages turn at the same share of full speed."""
    speeds = gas.swept_speeds(asked.speed or SPEED)
    return texts.filled("stages_sweep", {"speeds": speeds})
