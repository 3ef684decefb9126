"""What gas that the oil holds dissolved makes of its viscosity (M199), in films and as it is supplied."""

from collections.abc import Callable, Iterator
from typing import Any

from screwsim.effects.parts.flows import LINES, SUCTION
from screwsim.effects.parts.oil import OilThinning
from screwsim.effects.parts.readings import Around
from screwsim.fluid import solubility
from screwsim.fluid.description import describe
from screwsim.fluid.solubility_laws import SolubilityLaw
from screwsim.fluid.solution_viscosity import solution_viscosity
from screwsim.inputs.declare import choice, quantity
from screwsim.inputs.faults import Fault, UsageError
from screwsim.outputs import Figure

SUPPLIED_OIL_VISCOSITY = Figure(
    "supplied_oil_viscosity",
    "Pa s",
    "viscosity of the injected oil with what it holds dissolved",
    needs=(".films_at",),
)


def declared_films() -> Any:
    """Declare with which gas the films' oil is in equilibrium."""
    doc = "line with whose gas oil in films is in equilibrium, which makes it thinner (absent: viscosity of pure oil)"
    return choice(doc, LINES, None)


def declared_molar_mass() -> Any:
    """Declare the molar mass of the oil."""
    doc = "molar mass of the oil (with films_at; default: 590 g/mol, of an ester; needed with points_file)"
    return quantity("molar_mass", doc, None, ge=0.05, hardly=(0.15, 3.0))


def thinning(parameters: Any, law_for: Callable[[str], SolubilityLaw], T_separator: float) -> OilThinning | None:
    """Return what dissolved gas makes of the oil's viscosity (M199); None without `films_at`.

    `law_for(fluid)` is what the oil dissolves; it left gas of discharge pressure at `T_separator` [K].
    """
    molar_mass = parameters.oil_molar_mass or solubility.M_OIL

    def viscosity(law: SolubilityLaw, held: float, T: float, mu: float) -> float:
        liquid = law.liquid_viscosity(law.within(T))
        return solution_viscosity(held, liquid, mu, describe(law.fluid).molar_mass, molar_mass)

    def supply(around: Around, T: float, mu: float) -> float:
        law = law_for(around.fluid)
        return viscosity(law, law.content(around.p_d, T_separator), T, mu)

    def films(around: Around, T: float, mu: float) -> float:
        law = law_for(around.fluid)
        p = around.p_s if parameters.films_at == SUCTION else around.p_d
        held = min(law.content(around.p_d, T_separator), law.content(p, law.within(T)))
        return viscosity(law, held, T, mu)

    return None if parameters.films_at is None else OilThinning(films, supply)


def thinning_faults(path: str, parameters: Any, facts: Any, law: SolubilityLaw) -> Iterator[Fault]:
    """Yield what `films_at` needs and lacks, and a molar mass that is stated in vain."""
    if parameters.films_at is None:
        if parameters.oil_molar_mass is not None:
            yield Fault(f"{path}.oil_molar_mass", "is used with films_at only (write films_at, or remove it)")
        return
    if parameters.points_file is not None and parameters.oil_molar_mass is None:
        what = "is missing (films_at needs it with points_file, e.g. oil_molar_mass: 590 g/mol)"
        yield Fault(f"{path}.oil_molar_mass", what)
    if facts.oil is not None and not facts.oil.knows_viscosity:
        yield Fault("oil.viscosity", f"is missing ({path}.films_at needs it, or oil.name)")
    try:
        law.liquid_viscosity(law.high)
    except UsageError as error:
        yield Fault(f"{path}.films_at", f"{error} (remove it)")
