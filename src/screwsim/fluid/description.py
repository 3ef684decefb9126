"""CoolProp's data of an equation of state, of a pure fluid or a blend: terms, reducing state, limits; cached on disk.

The terms are CoolProp's own fluid description. The cache is keyed by CoolProp's version, so that a new version is asked
again, and a process that finds its fluid there never imports CoolProp, which takes seconds.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations
from typing import Any, NamedTuple

from screwsim.fluid.composition import BlendComposition, abstract_state, composition, predefined_name
from screwsim.fluid.coolprop_cache import cached_answer, no_fluid
from screwsim.inputs.faults import UsageError

PAIR = ("betaT", "gammaT", "betaV", "gammaV", "Fij")  # CoolProp's names of the first fields of a `ComponentPair`


class ComponentPair(NamedTuple):
    """Two components of a blend: parameters of the reducing functions, weight and name of the departure function."""

    beta_T: float
    gamma_T: float
    beta_v: float
    gamma_v: float
    F: float
    departure: str


@dataclass(frozen=True)
class Description:
    """A fluid's equation of state (SI units, per kg).

    `T_r`, `rho_r` reduce the equation; `T_c`, `p_c`, `rho_c` are the critical point; `residual` and `ideal` are the
    contributions to the Helmholtz energy as CoolProp writes them. A blend has neither, but the names of its
    `components`, their mole `fractions` and their `pairs` (0-1, 0-2, …, 1-2, …); its reducing state stands in for the
    critical point, and its p_c is 0: the phase envelope has the true ones. `ideal_state` is the T [K] and ρ [mol/m³] by
    which CoolProp reduces a component's ideal part in blends: its critical point as written in the fluid's description.
    """

    name: str
    source: str
    R: float
    molar_mass: float
    T_r: float
    rho_r: float
    T_c: float
    p_c: float
    rho_c: float
    T_min: float
    T_max: float
    p_max: float
    pseudo_pure: bool
    residual: Sequence[Mapping[str, Any]] = ()
    ideal: Sequence[Mapping[str, Any]] = ()
    components: Sequence[str] = ()
    fractions: Sequence[float] = ()
    pairs: Sequence[ComponentPair] = ()
    ideal_state: Sequence[float] = ()
    acentric: float = 0.0

    @property
    def blend(self) -> bool:
        """Whether it is a blend of several components."""
        return bool(self.components)

    @property
    def glides(self) -> bool:
        """Whether its two phases differ in composition, so that it boils and condenses at different temperatures."""
        return self.pseudo_pure or self.blend


def _ask(fluid: str) -> dict[str, Any]:
    import CoolProp.CoolProp as coolprop

    try:
        state = coolprop.AbstractState("HEOS", fluid)
        if len(state.fluid_names()) > 1:
            raise UsageError(f"gas.fluid: {fluid} is a mixture; write fluid: [NAME, NAME] with mass_fractions")
        found = json.loads(coolprop.get_fluid_param_string(state.name(), "JSON"))
    except ValueError as error:
        raise no_fluid(fluid, error) from None
    found = found[0] if isinstance(found, list) else found
    equation, critical = found["EOS"][0], found["STATES"]["critical"]
    M = state.molar_mass()
    return {
        "name": state.name(),
        "source": equation.get("BibTeX_EOS", ""),
        "R": state.gas_constant() / M,
        "molar_mass": M,
        "T_r": equation["STATES"]["reducing"]["T"],
        "rho_r": equation["STATES"]["reducing"]["rhomolar"] * M,
        "T_c": state.T_critical(),
        "p_c": state.p_critical(),
        "rho_c": state.rhomolar_critical() * M,
        "T_min": state.Tmin(),
        "T_max": state.Tmax(),
        "p_max": state.pmax(),
        "pseudo_pure": bool(equation.get("pseudo_pure", False)),
        "residual": equation["alphar"],
        "ideal": equation["alpha0"],
        "ideal_state": [critical["T"], critical["rhomolar"]],
        "acentric": equation["acentric"],
    }


def _departure(coolprop: Any, first: str, second: str) -> str:
    """Return the name of a pair's departure function, which CoolProp stores for one order of the CAS numbers only."""
    try:
        return coolprop.get_mixture_binary_pair_data(first, second, "function")
    except ValueError:
        return coolprop.get_mixture_binary_pair_data(second, first, "function")


def _ask_blend(fluid: str, made: BlendComposition) -> dict[str, Any]:
    """Return the description of a blend: its reducing state, and as its limits the narrowest of its components'."""
    import CoolProp.CoolProp as coolprop

    called = "&".join(made.components)
    state = abstract_state(fluid, called)
    (state.set_mole_fractions if made.by_mole else state.set_mass_fractions)(list(made.fractions))
    x, M = state.get_mole_fractions(), state.molar_mass()
    known = [describe(name) for name in made.components]
    numbers = [coolprop.get_fluid_param_string(name, "CAS") for name in made.components]
    pairs: list[list[Any]] = []
    for i, j in combinations(range(len(x)), 2):
        values = [state.get_binary_interaction_double(i, j, what) for what in PAIR]
        departure = ""
        if values[-1] != 0.0:
            departure = _departure(coolprop, numbers[i], numbers[j])
        pairs.append([*values, departure])
    return {
        "name": predefined_name(fluid) or fluid,
        "source": ", ".join(dict.fromkeys(each.source for each in known)),
        "R": state.gas_constant() / M,
        "molar_mass": M,
        "T_r": state.T_reducing(),
        "rho_r": state.rhomolar_reducing() * M,
        "T_c": state.T_reducing(),
        "p_c": 0.0,
        "rho_c": state.rhomolar_reducing() * M,
        "T_min": max(each.T_min for each in known),
        "T_max": min(each.T_max for each in known),
        "p_max": min(each.p_max for each in known),
        "pseudo_pure": False,
        "components": [each.name for each in known],
        "fractions": x,
        "pairs": pairs,
    }


PSEUDO_PURE = (
    "{} is a mixture described as if it were pure, although its two phases differ in composition; use two_phase: "
    "refuse, or a pure fluid, or the blend itself (such as R410A.mix)"
)


@lru_cache(maxsize=64)
def describe(fluid: str) -> Description:
    """Return the description of a fluid by any of CoolProp's names, or of a blend. Raises UsageError for others."""
    made = composition(fluid)
    if made is None:
        return Description(**cached_answer(f"fluid equation {fluid}", lambda: _ask(fluid)))
    found = Description(**cached_answer(f"equation of blend {fluid}", lambda: _ask_blend(fluid, made)))
    return replace(found, pairs=tuple(ComponentPair(*each) for each in found.pairs))
