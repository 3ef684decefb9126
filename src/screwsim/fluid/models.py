"""The registry of gas models: ideal and real by their names, a user's own by the dotted name of its module.

A scene names a model of the user's own as it names such an effect, `gas.model: my_gases.covolume`: a module with a
variable `GAS`, a `GasModel` that makes a gas (`fluid.gas`) from the scene's settings.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from screwsim.fluid import constants
from screwsim.fluid.gas import CommonGas, Gas
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.settings import GasSettings
from screwsim.numerics.trial import registry_entry


class GasRequest(NamedTuple):
    """The settings of a scene's gas: CoolProp's name of the fluid, k and `two_phase` as stated.

    `suction_temperature` returns T_s [K], from a saturation state where the line is stated by one.
    """

    fluid: str
    isentropic_exponent: float | None
    two_phase: str
    suction_temperature: Callable[[], float]


@dataclass(frozen=True)
class GasModel:
    """A gas model: `make` builds a gas from a scene's settings, or raises ValueError with a message.

    `condenses`: it condenses where CoolProp's fluid of that name saturates, so a line's gas must lie above that.
    `blind`: it treats as gas even what would be a liquid of that fluid. `finds_exponent`: k follows from its equation
    and cannot be stated. `asks_exponent`: a k that is not stated is CoolProp's at suction temperature. `phases`: it can
    compute both phases. `by_coolprop`: CoolProp can take its place. `back_end` is its name among the back ends of
    studies. `told` returns the property of the lines on which the gas depends beside its settings, or None where there
    is no such dependence; without `told` the gas is made anew for every scene.
    """

    make: Callable[[GasRequest], Gas]
    condenses: bool = False
    blind: bool = False
    finds_exponent: bool = False
    asks_exponent: bool = False
    phases: bool = False
    by_coolprop: bool = False
    back_end: str = "own"
    told: Callable[[GasRequest], float | None] | None = None


def _ideal(request: GasRequest) -> IdealGas:
    """Return an ideal gas; k is CoolProp's at suction temperature where none is stated (M6)."""
    k = request.isentropic_exponent
    if k is None:
        k = constants.isentropic_exponent(request.fluid, request.suction_temperature())
    return IdealGas(constants.gas_constant(request.fluid), k)


def _of_line(request: GasRequest) -> float | None:
    """Return the temperature [K] on which the k of an ideal gas depends; None where k is stated."""
    return request.suction_temperature() if request.isentropic_exponent is None else None


MODELS: dict[str, GasModel] = {
    "ideal": GasModel(_ideal, blind=True, asks_exponent=True, back_end="ideal", told=_of_line),
    "real": GasModel(
        lambda request: RealGas(request.fluid, request.two_phase),
        condenses=True,
        finds_exponent=True,
        phases=True,
        by_coolprop=True,
        back_end="compiled",
        told=lambda request: None,
    ),
}


def find_gas_model(name: str) -> GasModel:
    """Return the model of a name; raise KeyError where there is none, ImportError for a dotted one that fails."""
    return registry_entry(MODELS, name, "GAS", GasModel)


def condenses(settings: GasSettings) -> bool:
    """Tell whether the gas of a scene condenses where its fluid saturates."""
    return find_gas_model(settings.model).condenses


def lacking(gas: object) -> list[str]:
    """Return the names of the protocol that a gas lacks."""
    return [name for name in {**vars(Gas), **vars(CommonGas)} if not name.startswith("_") and not hasattr(gas, name)]
