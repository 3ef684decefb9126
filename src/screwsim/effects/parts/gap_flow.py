"""Flow models of a gap with a clearance: the paper's nozzle, with friction of the gas, sealed by oil, or full of oil.

What: `nozzle` is M12, M13. The other models let a share of that flow pass: `nozzle_friction` that of Bell et al. (M190,
M191), `oil_sealed` that of a homogeneous mixture of gas and oil, in the ratio of the upstream chamber, with inertia and
friction, laminar at any Reynolds number unless `mixture_friction: blasius` has the turbulent one where that is larger
(M190, M192, M193). With `oil_film` oil fills a share of the gap's length and
leaks there as a viscous film without gas; through the rest gas flows as through a nozzle (M250–M252). Where the housing
slides past the gap it drags oil along, from the chamber ahead to that behind (M256–M258).
Source: Bell et al. 2013, fitted to gaps of dry scroll machines; McAdams et al. 1942, Cicchitti et al. 1960 for the
viscosity of a mixture, which differ a hundredfold; Blasius 1913 for turbulent friction; of the film, textbook (plane
Poiseuille and Couette flow).
Assumptions: walls at rest, except in `oil_film`; constant viscosities: the gas's, unless stated, at suction pressure
and the warmer of suction gas and injected oil, the oil's that of its supply; no heat passes from oil to gas inside the
gap. Of `oil_film`: the share that is full follows the oil per gas of the upstream chamber, for dragged oil that of the
chamber ahead, and reaches one at the stated `filled_from`, for which there is no measurement.
Parameters: model, passage, friction_fit, mixture_viscosity, mixture_friction, gas_viscosity, filled_from, wall_speed.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from screwsim.effects.base import Around, Resistance
from screwsim.effects.parts.oil import oil_in_chambers
from screwsim.fluid import gap_flow
from screwsim.fluid.transport import viscosity as vapour_viscosity
from screwsim.inputs.faults import Fault, UsageError

FITS = {"radial": gap_flow.radial_friction, "flank": gap_flow.flank_friction}
LAMINAR, BLASIUS = "laminar", "blasius"
FRICTIONS = (LAMINAR, BLASIUS)
MIXTURES = {  # by the rule of the viscosity, and the friction
    "mcadams": {LAMINAR: gap_flow.mcadams_mixture, BLASIUS: gap_flow.mcadams_blasius},
    "cicchitti": {LAMINAR: gap_flow.cicchitti_mixture, BLASIUS: gap_flow.cicchitti_blasius},
}


class FlowModel(NamedTuple):
    """A flow model of a gap: the resistance that it adds to a nozzle, and what a scene states for it.

    `key` is the parameter that this model alone needs, with an `example`; `optional` are others that it alone takes.
    `gas`: it needs the gas's viscosity; `oil`: it needs carried oil with a viscosity; `walls`: a wall that slides past
    the gap drags oil along.
    """

    # of a gap's parameters and the speed of the wall past it (`gap.gap_path`); None: the plain nozzle
    resistance: Callable[[Any, float | None], Resistance] | None = None
    key: str = ""
    example: str = ""
    optional: tuple[str, ...] = ()
    gas: bool = True
    oil: bool = False
    walls: bool = False


def _friction(parameters: Any, slides: float | None) -> Resistance:
    fit = parameters.friction_fit
    return Resistance(FITS[fit], values=_size(parameters), title=f"friction by Bell et al., {fit} fit (M191)")


def _sealed(parameters: Any, slides: float | None) -> Resistance:
    return sealed(parameters.mixture_viscosity, parameters.mixture_friction, *_size(parameters).values())


def _film(parameters: Any, slides: float | None) -> Resistance:
    title = f"full of oil from {parameters.filled_from:g} kg per kg of gas upwards: viscous film (M250-M252)"
    stated = parameters.wall_speed
    wall = 0.0 if slides is None else slides if stated is None else stated
    values = {**_size(parameters), "filled_from": parameters.filled_from, "wall_speed": wall}
    if wall == 0.0:
        return Resistance(gap_flow.open_share, gap_flow.oil_film, values=values, title=title)
    title += f", dragged at {wall:.3g} of the tip speed (M256)"
    return Resistance(gap_flow.open_share, gap_flow.oil_film, gap_flow.dragged_oil, values=values, title=title)


def _size(parameters: Any) -> dict[str, float]:
    return {"gap": parameters.gap, "passage": parameters.passage or 0.0}


NOZZLE = "nozzle"
MODELS = {
    NOZZLE: FlowModel(gas=False),
    "nozzle_friction": FlowModel(_friction, "friction_fit", "radial"),
    "oil_sealed": FlowModel(_sealed, "mixture_viscosity", "cicchitti", ("mixture_friction",), oil=True),
    "oil_film": FlowModel(_film, "filled_from", "0.2", ("wall_speed",), gas=False, oil=True, walls=True),
}

HOLES: Mapping[str, Resistance | None] = {  # of an opening without depth: of the gas alone, or with its oil (M192)
    NOZZLE: None,
    "homogeneous": Resistance(gap_flow.homogeneous, title="gas and oil as one fluid (M192)"),
}


def sealed(rule: str, friction: str | None, gap: float, passage: float) -> Resistance:
    """Return the resistance of a gas–oil mixture in a clearance `gap` [m] that is `passage` [m] deep (M192, M193)."""
    by = f", friction by {friction}" if friction not in (None, LAMINAR) else ""
    title = f"mixture of gas and oil, viscosity by {rule}{by} (M192, M193)"
    return Resistance(MIXTURES[rule][friction or LAMINAR], values={"gap": gap, "passage": passage}, title=title)


def numbers(parameters: Any, around: Around) -> Mapping[str, float]:
    """Return the viscosities [Pa s] that a gap's flow model takes, by the names of the kernel's arguments."""
    model = MODELS[parameters.model]
    if model.resistance is None:
        return {}
    viscosity = around.oil.viscosity if around.oil is not None else None
    of_oil = {"oil_viscosity": viscosity} if viscosity is not None else {}
    if not model.gas:
        return of_oil
    gas = parameters.gas_viscosity
    if gas is None:
        gas = vapour_viscosity(around.fluid, around.p_s, max(around.T_s, around.T_oil or 0.0))
    return {"gas_viscosity": gas} | of_oil


def faults(name: str, parameters: Any, facts: Any) -> Iterator[Fault]:
    """Yield keys that a gap's flow model needs and lacks, and those that have no meaning with it."""
    path, word, model = f"effects.{name}", parameters.model, MODELS[parameters.model]
    needed = {} if model.resistance is None else {"passage": "2 mm", model.key: model.example}
    used = {*needed, *model.optional, *(["gas_viscosity"] if model.gas else [])}
    of_models = (key for each in MODELS.values() for key in (each.key, *each.optional) if key)
    for key in ("passage", *of_models, "gas_viscosity"):
        given = getattr(parameters, key) is not None
        if key in needed and not given:
            yield Fault(f"{path}.{key}", f"is missing (model: {word} needs it, e.g. {key}: {needed[key]})")
        elif given and key == "wall_speed" and needed and name == "interlobe_leakage":
            yield Fault(f"{path}.{key}", "has no meaning here: no housing wall bounds that gap (remove it)")
        elif given and key not in used:
            yield Fault(f"{path}.{key}", f"has no meaning with model: {word} (remove it)")
    if model.gas:
        yield from viscosity_faults(path, parameters, facts)
    if model.oil:
        yield from oil_faults(path, word, facts)


def viscosity_faults(path: str, parameters: Any, facts: Any) -> Iterator[Fault]:
    """Yield a fault where the gas's viscosity is neither stated nor known."""
    if parameters.gas_viscosity is None:
        try:
            vapour_viscosity(facts.gas.name, 1e4, 400.0)
        except UsageError as error:
            yield Fault(f"{path}.gas_viscosity", f"is missing: {error} (state it, e.g. gas_viscosity: 0.012 mPa s)")


def oil_faults(path: str, model: str, facts: Any, *, viscous: bool = True) -> Iterator[Fault]:
    """Yield what a flow model that needs oil lacks; `viscous`: it needs the oil's viscosity."""
    if facts.oil is None:
        other = "nozzle_friction" if viscous else NOZZLE
        yield Fault(f"{path}.model", f"{model} needs oil (write an oil section, or choose {other})")
        return
    if not facts.oil.carried:
        yield Fault(f"{path}.model", f"{model} needs oil.transport: carried (write that, or choose another model)")
    if not oil_in_chambers(facts.effects):
        yield Fault(f"{path}.model", f"{model} needs oil in the chambers (add e.g. effects.oil_heat)")
    if viscous and not facts.oil.knows_viscosity:
        yield Fault("oil.viscosity", f"is missing ({path}.model: {model} needs it, or oil.name)")
