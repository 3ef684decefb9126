"""Checks of what a scene says of the humidity of its air."""

from collections.abc import Iterator

from screwsim.fluid import water
from screwsim.fluid.settings import GasSettings
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import Fault
from screwsim.scene.lines import Lines
from screwsim.scene.units import readable_quantity

HUMIDITY, MARGIN = "gas.relative_humidity", "gas.dew_point_margin"
AFTERCOOLER = "operation.aftercooler_temperature"
AIR = "air"
P_MOST = 1e7  # [Pa] of the lines: beyond, third virial coefficients count (M324)


def humidity_faults(gas: GasSettings, aftercooler: float | None) -> Iterator[Fault]:
    """Yield what does not go together with a relative humidity, whatever the lines are."""
    if gas.relative_humidity is None:
        for path, value in ((MARGIN, gas.dew_point_margin), (AFTERCOOLER, aftercooler)):
            if value is not None:
                yield Fault(path, f"needs {HUMIDITY} (write e.g. relative_humidity: 0.6 there, or remove this)")
        return
    if gas.name.lower() != AIR:
        what = f"belongs to air, and the gas is {gas.name}"
        yield Fault(HUMIDITY, f"{what} (remove it, null in place of a base's, or write fluid: air)")
    elif "." in gas.model:
        what = "needs gas.model: ideal or real, whose air is known to be dry air"
        yield Fault(HUMIDITY, f"{what} (write one of them, or remove this)")
    elif gas.equilibrium:
        what = "belongs to a pure fluid; water of moist air condenses in equilibrium by itself"
        yield Fault("gas.two_phase", f"{what} (remove it, or write refuse)")


def line_faults(gas: GasSettings, lines: Lines) -> Iterator[Fault]:
    """Yield that water boils where a relative humidity is stated, and a pressure beyond that of its virial terms."""
    if not gas.relative_humidity:
        return
    if lines.T_s >= water.T_MOST or lines.p_s <= water.saturation(lines.T_s)[0]:
        p, T = (readable_quantity(KINDS[name], x) for name, x in (("pressure", lines.p_s), ("temperature", lines.T_s)))
        what = f"has no meaning at {p} and {T}, where water boils"
        yield Fault(HUMIDITY, f"{what} (a lower operation.suction.temperature, or a higher pressure)")
        return
    told = readable_quantity(KINDS["pressure"], max(lines.p_s, lines.p_d))
    vapour = gas.relative_humidity * water.saturation(lines.T_s)[0] * max(lines.p_d / lines.p_s, 1.0)
    if vapour >= water.saturation(water.T_MOST)[0]:
        what = f"brings so much water that it condenses above {water.T_MOST:g} K at {told}, where it is not followed"
        yield Fault(HUMIDITY, f"{what} (drier or colder air, or a lower pressure)")
    elif max(lines.p_s, lines.p_d) > P_MOST:
        most = f"{1e-5 * P_MOST:g} bar"
        yield Fault(HUMIDITY, f"is followed up to {most}, not at {told} (remove it, or lower the pressure)")
