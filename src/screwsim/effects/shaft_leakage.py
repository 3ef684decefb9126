"""Shaft leakage: gas and oil from the discharge end to suction, around the shafts and through drains and pistons.

What: nozzle flow (M12, M13), or the share of it that passes beside the oil (M192, M300), from the discharge line to the
suction line outside the chambers, with the line's oil ratio and the gas dissolved in that oil (M274). It is driven by
the discharge pressure all the time, where the leaks of chambers follow the chamber pressure: a volumetric efficiency
that falls in proportion to the pressure ratio calls for such a leak. The area is stated, or an annulus around each
shaft.
Source: annular clearances (textbook); M12.
Assumptions: fed from the mean state of the discharge line; oil in the ratio there, at the gas's speed. The power of
pumping the leaked oil up again counts (M28). Labyrinths, bushings and bearings resist more than a nozzle does: take a
smaller flow coefficient, or `model: oil_sealed`, the rule of gaps in flooded machines (M192); no wall moves in it.
Parameters: area, or shaft_diameter, clearance and shafts; flow_coefficient; model, mixture_viscosity, mixture_friction,
passage and gas_viscosity.
"""

from dataclasses import dataclass
from math import pi

from screwsim.effects.base import Effect, Faults, LineLeak
from screwsim.effects.parts import gap_flow
from screwsim.effects.parts.gap import declared_friction, flow_coefficient
from screwsim.effects.parts.gas_transport import declared_gas_viscosity
from screwsim.effects.parts.usual import LEAK
from screwsim.inputs.declare import choice, number, optional, quantity
from screwsim.inputs.faults import Fault, incomplete
from screwsim.machine.protocol import ROTORS
from screwsim.outputs import HEATED, Figure, over

_ANNULUS = ("shaft_diameter", "clearance")
_SHAFTS = 2  # default number of shafts
_SEALED = {"mixture_viscosity": "mcadams", "passage": "10 mm"}
FIGURES = (
    Figure("shaft_leakage_gas_flow", "kg s-1", "gas that leaks from discharge to suction, past the chambers"),
    Figure("shaft_leakage_oil_flow", "kg s-1", "oil that leaks with that gas", over("oil_mass_flow"), needs=HEATED),
)


@dataclass(frozen=True)
class Parameters:
    """Size of the leak."""

    area: float | None = quantity(
        "area", "area of all paths together, in place of the annulus of each shaft", None, ge=0.0
    )
    shaft_diameter: float | None = optional("length", "diameter of a shaft where it passes the discharge end")
    clearance: float | None = quantity("length", "radial clearance between shaft and bore", None, ge=0.0)
    shafts: int = number("number of shafts of that diameter and clearance", _SHAFTS, ge=1, le=4)
    flow_coefficient: float = flow_coefficient("the leak", 0.7)
    model: str = choice("flow model (M190)", ("nozzle", "oil_sealed"), "nozzle")
    mixture_viscosity: str | None = choice("viscosity rule (model: oil_sealed)", tuple(gap_flow.MIXTURES), None)
    mixture_friction: str | None = declared_friction()
    passage: float | None = quantity(
        "length", "length of the annulus along the shaft (model: oil_sealed)", None, gt=0.0, hardly=(1e-5, 0.5)
    )
    gas_viscosity: float | None = declared_gas_viscosity()


def area_of(parameters: Parameters) -> float:
    """Return the area [m²] of the leak: as stated, or of annuli of a clearance c around a diameter d, π (d + c) c."""
    if parameters.area is not None:
        return parameters.area
    d, c = parameters.shaft_diameter or 0.0, parameters.clearance or 0.0
    return parameters.shafts * pi * (d + c) * c


def build(parameters: Parameters, machine) -> list[LineLeak]:
    area = parameters.flow_coefficient * area_of(parameters)
    if gap_flow.MODELS[parameters.model].resistance is None:
        return [LineLeak(area)]
    rule, clearance, passage = parameters.mixture_viscosity, parameters.clearance, parameters.passage
    assert rule is not None and clearance is not None and passage is not None  # of `check`
    return [LineLeak(area, gap_flow.sealed(rule, parameters.mixture_friction, clearance, passage))]


def check(parameters: Parameters, facts) -> Faults:
    path = "effects.shaft_leakage"
    given = [name for name in _ANNULUS if getattr(parameters, name) is not None]
    if parameters.area is None and len(given) < len(_ANNULUS):
        if given:
            yield incomplete(path, _ANNULUS, given)
        else:
            yield Fault(f"{path}.area", "is missing (state it, or shaft_diameter and clearance)")
    elif parameters.area is not None and given:
        yield Fault(f"{path}.{given[0]}", "is stated as well as area (remove one of the two)")
    elif parameters.area is not None and parameters.shafts != _SHAFTS:
        what = "is stated as well as area, which is that of all shafts together (remove one of the two)"
        yield Fault(f"{path}.shafts", what)
    yield from _model_faults(path, parameters, facts)
    if "suction_line" not in facts.effects:
        what = "needs effects.suction_line, which takes its gas and oil (add it)"
        yield Fault(path, what)
    if facts.operation.discharge.temperature is not None:
        what = "is given, but what leaks has the temperature of the outflow (remove it, or effects.shaft_leakage)"
        yield Fault("operation.discharge.temperature", what)


def _model_faults(path: str, parameters: Parameters, facts) -> Faults:
    """Yield keys that the flow model needs and lacks, and those that have no meaning with it."""
    if gap_flow.MODELS[parameters.model].resistance is None:
        for extra in (*_SEALED, "mixture_friction", "gas_viscosity"):
            if getattr(parameters, extra) is not None:
                yield Fault(f"{path}.{extra}", "has no meaning with model: nozzle (remove it)")
        return
    if parameters.area is not None:
        yield Fault(
            f"{path}.area", "has no clearance that oil could seal (give shaft_diameter and clearance, or model: nozzle)"
        )
    elif parameters.clearance == 0.0:
        yield Fault(f"{path}.clearance", "is zero, so that there is no leak to seal (remove effects.shaft_leakage)")
    for name, example in _SEALED.items():
        if getattr(parameters, name) is None:
            what = f"is missing (model: oil_sealed needs it, e.g. {name}: {example})"
            yield Fault(f"{path}.{name}", what)
    yield from gap_flow.viscosity_faults(path, parameters, facts)
    yield from gap_flow.oil_faults(path, "oil_sealed", facts)


EFFECT = Effect(
    name="shaft_leakage",
    title="leak from the discharge end to suction around the shafts",
    equations=("M12", "M13", "M274", "M300"),
    source="annular clearances",
    parameters=Parameters,
    build=build,
    check=check,
    numbers=gap_flow.numbers,
    needs=frozenset({ROTORS}),
    figures=FIGURES,
    usual={ROTORS: LEAK},
    in_expander="never",
)
