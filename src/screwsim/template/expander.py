"""A screw expander with a generator, dry or with oil that comes in with the gas."""

import math

import numpy as np

from screwsim.fluid import constants
from screwsim.fluid.oils import OILS
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import ZERO_CELSIUS, in_celsius
from screwsim.template import sizes, texts
from screwsim.template.gas import RPM, Duty, common_values, gas_duty, motor_values
from screwsim.template.refrigeration import STAND_IN, substitute_properties
from screwsim.template.request import SceneRequest

DRY_CLEARANCE = 80e-6  # [m], clearances of dry rotors of 160 mm: two to four times those of flooded ones, assumed
DRYNESS_FACTOR = 1.3  # of the outlet's pressure: estimate of how much drier an ideal gas is than a real one
PRESSURES = 8  # on the way down at which the gas is asked whether it condenses
INLET = "20/7 bar"  # condition that is the default
OIL_ROOM = 0.02  # of the gas at the inlet, which its oil takes up: assumed


def expander(asked: SceneRequest) -> str:
    """Return the scene of a screw expander with a generator; dry, unless an oil is named."""
    fluid, flow, speed = asked.fluid or "R134a", asked.flow or 375.0 / 3600.0, asked.speed or 2950.0 * RPM
    size, duty = texts.sized(flow, speed), gas_duty(asked, fluid, INLET, "100 degC", expands=True)
    ratio = asked.ratio or sizes.matching(duty.ratio, duty.k, 1.0)
    _refuse_without_power(asked, duty, ratio)
    lowest = min(duty.at.high, duty.at.low * ratio**-duty.k)  # of a chamber, before its outlet opens
    _refuse_frozen(asked, fluid, duty, lowest)
    common = common_values(asked, duty, size, 1.0)
    values = {
        **common,
        **motor_values(sizes.motor_for(flow / ratio * duty.density * duty.work)),
        "machine": common["machine"].replace("kind: twin_screw\n", "kind: twin_screw\n  mode: expander\n"),
        "fluid": fluid,
        "two_phase": _two_phase(asked, fluid, duty, lowest),
    }
    if asked.oil is None:
        return texts.filled("expander", {**values, "gap": sizes.um(DRY_CLEARANCE * size.clearance)})
    return texts.filled("flooded_expander", {**values, **_ports(fluid, duty, size), **_oil(asked.oil, fluid, duty)})


def _ports(fluid: str, duty: Duty, size: sizes.Size) -> dict[str, str]:
    """Return ports and gaps; a substitute's viscosity slows a gas of which CoolProp has none."""
    substitute = substitute_properties(fluid, duty.at.high, duty.T)
    if substitute is None:
        return {"ports": texts.ports(size)}
    told = f"  # CoolProp has no viscosity of {fluid}: that in the gaps is {STAND_IN}'s.\n"
    return {"ports": told + texts.ports(size, f",\n    gas_viscosity: {1e3 * substitute[1]:.3g} mPa s")}


def _oil(name: str, fluid: str, duty: Duty) -> dict[str, str]:
    """Return the entries on the oil: as warm as the gas at the inlet, as far as its data reach.

    Raise UsageError where they begin above that, or the gas would condense on it.
    """
    coldest, warmest = OILS[name].low, OILS[name].high
    if duty.T < coldest:
        what = f"its data begin at {in_celsius(coldest)}, above the inlet's {in_celsius(duty.T)}"
        raise UsageError(f"--oil {name}: {what} (choose a warmer inlet, or leave the oil out)")
    T, text = min((duty.T, duty.temperature), (warmest, f"{warmest - ZERO_CELSIUS:g} degC"))
    dew = constants.liquid_below(fluid, duty.at.low, T)
    if dew is not None:
        what = f"the data of {name} end at {text}, and {fluid} condenses on it below {in_celsius(dew)}"
        raise UsageError(f"--oil {name}: {what} (choose a lower inlet pressure, or leave the oil out)")
    ratio = OIL_ROOM * OILS[name].density_at(T) / duty.density
    return {"oil": name, "oil_ratio": f"{ratio:.2g}", "oil_temperature": text}


def expansion_work(pressures: float, k: float, ratio: float) -> float:
    """Return the lossless work of expansion to a built-in volume ratio, then at constant volume to the outlet.

    It is that of an ideal gas over pressure and volume of the filled inlet; `pressures`: inlet over outlet.
    """
    return 1.0 + (1.0 - ratio ** (1.0 - k)) / (k - 1.0) - ratio / pressures


def _refuse_without_power(asked: SceneRequest, duty: Duty, ratio: float) -> None:
    """Raise UsageError where gas expands so far below the outlet's pressure that the machine would take power."""
    if expansion_work(duty.ratio, duty.k, ratio) > 0.0:
        return
    what = f"expanded to a built-in volume ratio of {ratio:g}, the gas would take power instead of giving it"
    remedy = f"choose pressures farther apart, or a smaller --vi: {duty.ratio ** (1.0 / duty.k):.3g} suits these"
    raise UsageError(f"--condition {asked.condition or INLET}: {what} ({remedy})")


def _refuse_frozen(asked: SceneRequest, fluid: str, duty: Duty, lowest: float) -> None:
    """Raise UsageError where lossless expansion to the lowest pressure [Pa] of a chamber ends below the triple point.

    Above the triple point's pressure the gas would condense first.
    """
    limits, fall = constants.limits(fluid), (duty.at.low / lowest) ** ((duty.k - 1.0) / duty.k)
    if limits is None or lowest >= limits.p_triple or duty.T / fall >= limits.T_triple:
        return
    warm = 5.0 * math.ceil((limits.T_triple * fall - ZERO_CELSIUS) / 5.0)
    pair = (asked.condition or INLET).partition(",")[0].strip()
    ends, triple = in_celsius(duty.T / fall), in_celsius(limits.T_triple)
    what = f"{fluid} would expand to {ends}, below its triple point of {triple}"
    hot = warm + ZERO_CELSIUS >= limits.T_max
    remedy = "choose pressures closer together" if hot else f"write e.g. --condition '{pair}, {warm:g} degC'"
    raise UsageError(f"--condition {asked.condition or INLET}: {what} ({remedy})")


def _two_phase(asked: SceneRequest, fluid: str, duty: Duty, lowest: float) -> str:
    """Return the entry that follows two phases of a gas that may condense; raise UsageError where none can be."""
    wet = _condenses(fluid, duty, lowest)
    entry = texts.two_phase(fluid, wet or _nears_condensing(fluid, duty))
    if wet and not entry:
        what = f"{fluid} gets wet as it expands, and is described as if it were pure, whose two phases are not known"
        remedy = "choose warmer gas, or pressures closer together"
        raise UsageError(f"--condition {asked.condition or INLET}: {what} ({remedy})")
    return entry


def _condenses(fluid: str, duty: Duty, lowest: float) -> bool:
    """Tell whether the real gas gets wet on its lossless way down to the lowest pressure [Pa] of a chamber."""
    ways = (
        constants.compressed(fluid, duty.at.low, duty.T, float(p), 1.0)
        for p in np.geomspace(duty.at.low, lowest, PRESSURES + 1)[1:]
    )
    return any(way is not None and way.over_dew < 0.0 for way in ways)


def _nears_condensing(fluid: str, duty: Duty) -> bool:
    """Tell whether a gas expanding without loss comes close to condensing at the outlet."""
    limits, coldest = constants.limits(fluid), duty.T * (duty.at.high / duty.at.low) ** ((duty.k - 1.0) / duty.k)
    if limits is None or not limits.T_triple < coldest < limits.T_critical:
        return False
    return constants.dew_pressure(fluid, coldest) < DRYNESS_FACTOR * duty.at.high
