"""Transport properties of the gas for heat transfer correlations: as stated, or CoolProp's at one state.

Source: screwsim. They are constant over the cycle: at the stated reference state, else at suction pressure and the
warmer of suction gas and injected oil.
"""

from collections.abc import Iterator, Sequence
from typing import Any

from screwsim.effects.base import Around
from screwsim.fluid.transport import transport
from screwsim.inputs.declare import quantity
from screwsim.inputs.faults import Fault, UsageError, incomplete

GAS = ("gas_conductivity", "gas_viscosity", "prandtl")
STATE = ("reference_pressure", "reference_temperature")


def declared_gas_viscosity() -> Any:
    """Declare the viscosity of the gas."""
    return quantity("viscosity", "mu of the gas (default: from CoolProp)", None, gt=0.0, le=1.0, hardly=(2e-6, 2e-4))


def declared_gas_conductivity() -> Any:
    """Declare the thermal conductivity of the gas."""
    what = "lambda of the gas (default: from CoolProp)"
    return quantity("thermal_conductivity", what, None, gt=0.0, le=10.0, hardly=(1e-3, 1.0))


def gas_numbers(parameters, around: Around, names: Sequence[str] = GAS) -> dict[str, float]:
    """Return the named ones of conductivity [W/(m K)], viscosity [Pa s] and Prandtl number. Raises UsageError."""
    stated: dict[str, float] = {name: getattr(parameters, name) for name in names}
    if None not in stated.values():
        return stated
    p = parameters.reference_pressure or around.p_s
    T = parameters.reference_temperature or max(around.T_s, around.T_oil or 0.0)
    known: dict[str, float] = dict(zip(GAS, transport(around.fluid, p, T), strict=True))
    return {name: known[name] for name in names}


def gas_faults(path: str, parameters, fluid: str, names: Sequence[str] = GAS) -> Iterator[Fault]:
    """Yield gas properties stated twice or in part only, and a gas whose transport CoolProp does not know."""
    stated, state = ([name for name in some if getattr(parameters, name) is not None] for some in (names, STATE))
    if stated and len(stated) < len(names):
        yield incomplete(path, names, stated)
    elif stated and state:
        yield Fault(f"{path}.{state[0]}", "is given as well as the gas's own numbers (remove it)")
    elif len(state) == 1:
        yield incomplete(path, STATE, state)
    elif not stated:
        try:
            transport(fluid, parameters.reference_pressure or 1e4, parameters.reference_temperature or 400.0)
        except UsageError as error:
            yield Fault(path, f"{error} (state {', '.join(names)})")
