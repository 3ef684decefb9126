"""Warnings of gas and oil in a state that is possible but unusual, or beyond what their models and data hold for."""

from collections.abc import Iterator, Mapping
from contextlib import suppress

from screwsim.fluid import constants
from screwsim.fluid.models import condenses, find_gas_model
from screwsim.fluid.oils import OILS
from screwsim.fluid.settings import GasSettings
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import UsageError
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.outputs.customary import in_celsius
from screwsim.scene.fields import value_at
from screwsim.scene.lines import Lines, lines
from screwsim.scene.operation import CONDENSING, GAS_COOLER, GAS_COOLER_P, P_D, T_S
from screwsim.scene.types import ActiveEffect, Scene
from screwsim.scene.units import readable_quantity

LEAST_COMPRESSIBILITY = 0.8  # of a line's gas, below which it is a quarter and more denser than an ideal gas
USUAL_RATIO = 30.0  # usual pressure ratio in one machine, higher over lower, at the most


def medium_warnings(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield (path, what) of the lines, the oil supply and the oil films of a scene."""
    yield from _lines(scene)
    yield from _oil(scene)
    yield from _films(scene)


def _lines(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield warnings about the lines: a large pressure ratio, an ideal gas where its fluid is a liquid."""
    at = lines(scene)
    ratio = max(at.p_d / at.p_s, at.p_s / at.p_d)
    if ratio > USUAL_RATIO:
        path = next((each for each in (P_D, GAS_COOLER_P) if value_at(scene, each) is not None), CONDENSING)
        yield path, f"the pressure ratio of a single machine is {ratio:.4g} (usual: at most {USUAL_RATIO:g})"
    cooler = scene.operation.gas_cooler
    limits = None if cooler is None else constants.limits(scene.gas.name)
    if cooler is not None and (limits is None or cooler.pressure < limits.p_critical):
        T = constants.saturation_temperature(scene.gas.name, cooler.pressure)
        if cooler.outlet_temperature > T:
            here, dew = map(in_celsius, (cooler.outlet_temperature, T))
            what = f"{scene.gas.name} leaves it as a gas at {here}: it condenses below the critical pressure, at {dew}"
            yield f"{GAS_COOLER}.outlet_temperature", f"{what} (choose a colder one, or a higher pressure)"
    if find_gas_model(scene.gas.model).blind:
        boiling = constants.liquid_below(scene.gas.name, at.p_s, at.T_s)
        if boiling is not None:
            p = readable_quantity(KINDS["pressure"], at.p_s)
            here, until = map(in_celsius, (at.T_s, boiling))
            what = f"{scene.gas.name} of {p} is a liquid at {here}, and a gas above {until}"
            yield (
                T_S,
                f"{what}; gas.model: ideal treats it as a gas (use warmer gas, or gas.model: real, which refuses it)",
            )
        else:
            yield from _dense(scene.gas, at)


def _dense(gas: GasSettings, at: Lines) -> Iterator[tuple[str, str]]:
    """Yield a warning where a gas that is taken as ideal is much denser than that in one of its lines (M5).

    The denser line: that of suction, or that of discharge at the temperature of isentropic compression, where the gas
    is least dense.
    """
    limits = constants.limits(gas.name)
    if limits is None or limits.gas_only:
        return
    k = gas.isentropic_exponent or constants.isentropic_exponent(gas.name, at.T_s)
    hot = at.T_s * max(at.p_d / at.p_s, 1.0) ** ((k - 1.0) / k)
    found = {(p, T): virial_compressibility(limits, p, T) for p, T in ((at.p_s, at.T_s), (at.p_d, hot))}
    (p, T), Z = min(found.items(), key=lambda each: each[1])
    if Z < LEAST_COMPRESSIBILITY:
        state = f"{readable_quantity(KINDS['pressure'], round(p, 1))}, {in_celsius(round(T, 1))}"
        what = f"{gas.name} of {state} is about {1.0 / Z - 1.0:.0%} denser than the ideal gas as which it is taken"
        yield "gas.model", f"{what} (write gas.model: real)"


def virial_compressibility(limits: constants.Limits, p: float, T: float) -> float:
    """Return p/(ρ R T) of a gas at p [Pa], T [K] by its second virial coefficient, an estimate that is rather too high.

    Source: K. S. Pitzer's correlation in the form of M. M. Abbott, of a simple fluid: Z = 1 + (p_r/T_r)(0.083 − 0.422
    T_r^−1.6), as in J. M. Smith, H. C. Van Ness, M. M. Abbott, Chemical Engineering Thermodynamics.
    """
    T_r = T / limits.T_critical
    return max(1.0 + p / limits.p_critical / T_r * (0.083 - 0.422 * T_r**-1.6), 0.1)


def _oil(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield a warning where the oil is so cold that a real gas condenses on it at the discharge pressure."""
    supply = scene.oil_supply
    if supply is None or supply.temperature is None or not condenses(scene.gas) or not _oil_warming(scene.effects):
        return
    p_d = lines(scene).p_d
    with suppress(UsageError):  # above the critical pressure
        T = constants.saturation_temperature(scene.gas.name, p_d)
        if supply.temperature < T:
            cold, warm = map(in_celsius, (supply.temperature, T))
            what = f"{scene.gas.name} condenses on it at the discharge pressure, {1e-5 * p_d:.4g} bar, below {warm}"
            yield "oil_supply.temperature", f"the oil enters at {cold}; {what} (use warmer oil)"


def _films(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield a warning for each film of a stored oil whose stated temperature lies beyond its viscosity data (M140)."""
    if scene.oil is None or scene.oil.name is None:
        return
    known = OILS[scene.oil.name]
    for name, active in scene.effects.items():
        T = getattr(active.parameters, "film_temperature", None)
        if T is not None and not known.low <= T <= known.high:
            reach = f"{in_celsius(known.low)} to {in_celsius(known.high)}"
            what = f"the viscosity of {scene.oil.name} is known from {reach}, and extrapolated to {in_celsius(T)}"
            yield f"effects.{name}.film_temperature", what


@IdentityCache
def _oil_warming(effects: Mapping[str, ActiveEffect]) -> bool:
    return any("T_oil" in active.effect.states for active in effects.values())
