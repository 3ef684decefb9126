"""What CoolProp knows of a pure fluid's equation of state: terms, reducing state, limits; kept on disk.

The terms are CoolProp's own fluid description. The cache is keyed by CoolProp's version, so that a new version is
asked again, and a process that finds its fluid there never imports CoolProp (seconds).
"""

from __future__ import annotations

import importlib.metadata
import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from screwsim.faults import UsageError
from screwsim.numerics.compiling import begins
from screwsim.numerics.store import keep, read


@dataclass(frozen=True)
class Description:
    """A fluid's equation of state (SI units, per kg).

    `T_r`, `rho_r` reduce the equation; `T_c`, `p_c`, `rho_c` are the critical point; `residual` and `ideal` are the
    contributions of the Helmholtz energy as CoolProp writes them.
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
    residual: Sequence[Mapping[str, Any]]
    ideal: Sequence[Mapping[str, Any]]


def kept(name: str, question: Callable[[], Any]) -> Any:
    """Return the answer to a question to CoolProp, from the cache folder where it is known."""
    version = importlib.metadata.version("CoolProp")
    file = f"coolprop-{version}-{re.sub('[^A-Za-z0-9]+', '_', name)}.answer"
    found = json.loads(read(file) or b"{}")
    if found.get("name") == name:
        return found["answer"]
    begins()
    answer = question()
    keep(file, json.dumps({"name": name, "answer": answer}).encode())
    return answer


def no_fluid(fluid: str, error: ValueError) -> UsageError:
    """Return what to raise where CoolProp refuses a fluid."""
    reason = str(error).splitlines()[0][:120]
    return UsageError(f"gas.fluid: CoolProp has no pure fluid {fluid!r} ({reason}); name one such as R134a")


def _ask(fluid: str) -> dict[str, Any]:
    import CoolProp.CoolProp as coolprop

    try:
        state = coolprop.AbstractState("HEOS", fluid)
        if len(state.fluid_names()) > 1:
            raise UsageError(f"gas.fluid: {fluid} is a mixture; gas.model: real takes pure fluids such as R134a")
        found = json.loads(coolprop.get_fluid_param_string(state.name(), "JSON"))
    except ValueError as error:
        raise no_fluid(fluid, error) from None
    equation = (found[0] if isinstance(found, list) else found)["EOS"][0]
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
    }


@lru_cache(maxsize=64)
def describe(fluid: str) -> Description:
    """Return the description of a pure fluid by any of CoolProp's names. Raises UsageError for others."""
    return Description(**kept(f"fluid {fluid}", lambda: _ask(fluid)))
