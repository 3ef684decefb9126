"""Print differences of moist air from CoolProp's (HAPropsSI): saturation, pressure dew point, heat.

Run: python benchmarks/moist_air.py [-o PAGE.md]. The air is that of 25 degC, 1 bar and a relative humidity of 0.6,
except where it is saturated. HAPropsSI's equations (Herrmann, Kretzschmar, Gatley, HVAC&R Research 15 (2009) 961)
include third virial coefficients, air dissolved in the liquid and the pressure on the liquid, which ours leave out.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import CoolProp.CoolProp as coolprop

from screwsim.fluid import constants
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.fluid.moist_air import MoistAir, moist_air, saturated_ratio
from screwsim.fluid.real_gas import RealGas

P_S, T_S, HUMIDITY = 1e5, 298.15, 0.6
BAR = (1.0, 4.0, 8.0, 11.0, 14.0)
SATURATED = (283.15, 303.15, 323.15, 343.15, 363.15)  # [K]
HEATED = (323.15, 353.15, 383.15, 413.15)  # [K], dry at these pressures unless marked
HEAD = """\
# Moist air beside HAPropsSI

Made by `python benchmarks/moist_air.py -o docs/reference/moist-air.md`: what `gas.relative_humidity` makes of air (M320
to M326), ideal and real, beside CoolProp {version}'s `HAPropsSI`. *Saturated*: vapour per dry air of saturated air,
relative difference. *Dew point*: of air of 25 °C, 1 bar, relative humidity 0.6, compressed; difference. *Heat*:
enthalpy of the same air above that at 25 °C and 1 bar, per dry air, relative difference; – where water has condensed.
*Density*: of the same, per dry air.

The ideal gas has no enhancement factor: its dew point lies too high, on the safe side. The real one has that of the
second virial coefficients; what it lacks is the pressure upon the liquid (Poynting's factor), on the same side. Entropy
is not compared here: that of HAPropsSI misses T ds = dh - v dp by 5e-4 of moist air at 14 bar; ours keeps it.
"""


def reference(output: str, **given: float) -> float:
    """Return a property of humid air from CoolProp."""
    pairs = [each for name, value in given.items() for each in (name, value)]
    return coolprop.HAPropsSI(output, *pairs)


def saturated(gas: MoistAir, p: float, T: float) -> float:
    """Return the relative difference of the saturated humidity ratio."""
    return saturated_ratio(gas, p, T) / reference("W", T=T, P=p, R=1.0) - 1.0


def dew_point(gas: MoistAir, p: float) -> float:
    """Return the difference of the dew point [K]."""
    return gas.dew_point(p) - reference("D", T=450.0, P=p, W=gas.humidity_ratio)


def heat(gas: MoistAir, p: float, T: float) -> float:
    """Return the relative difference of the enthalpy above that of suction."""
    W = gas.humidity_ratio
    ours = (gas.enthalpy(p, T) - gas.enthalpy(P_S, T_S)) * (1.0 + W)
    return ours / (reference("H", T=T, P=p, W=W) - reference("H", T=T_S, P=P_S, W=W)) - 1.0


def density(gas: MoistAir, p: float, T: float) -> float:
    """Return the relative difference of the density of dry air in the mixture."""
    W = gas.humidity_ratio
    return gas.density(p, T) / (1.0 + W) * reference("V", T=T, P=p, W=W) - 1.0


def dry(gas: MoistAir, p: float, T: float) -> bool:
    """Tell whether all water is vapour, with a margin of 1 K."""
    return T > gas.dew_point(p) + 1.0


def gases() -> dict[str, MoistAir]:
    """Return both models of that air."""
    own = IdealGas(constants.gas_constant("Air"), constants.isentropic_exponent("Air", T_S)), RealGas("Air")
    made = {each.name: moist_air(each, P_S, T_S, HUMIDITY) for each in own}
    return {name: gas for name, gas in made.items() if isinstance(gas, MoistAir)}


def table(what: str, gas: MoistAir, temperatures: tuple[float, ...], row: Callable[..., float]) -> Iterator[str]:
    """Yield a table of relative differences over temperature and pressure."""
    yield f"\n## {what}, {gas.name} gas\n"
    yield "| T \\ p | " + " | ".join(f"{bar:g} bar" for bar in BAR) + " |"
    yield "|---" * (len(BAR) + 1) + "|"
    for T in temperatures:
        told = []
        for bar in BAR:
            wet = row is not saturated and not dry(gas, 1e5 * bar, T)
            told.append("–" if wet else f"{100.0 * row(gas, 1e5 * bar, T):+.2f} %")
        yield f"| {T - 273.15:.0f} °C | " + " | ".join(told) + " |"


def page() -> str:
    """Return the page."""
    lines = [HEAD.format(version=coolprop.get_global_param_string("version"))]
    lines += ["## Dew point\n", "| | " + " | ".join(f"{bar:g} bar" for bar in BAR) + " |", "|---" * 6 + "|"]
    for name, gas in gases().items():
        lines.append(f"| {name} | " + " | ".join(f"{dew_point(gas, 1e5 * bar):+.2f} K" for bar in BAR) + " |")
    for gas in gases().values():
        lines += table("Saturated", gas, SATURATED, saturated)
        lines += table("Heat", gas, HEATED, heat)
        lines += table("Density", gas, HEATED, density)
    return "\n".join(lines) + "\n"


def main() -> None:
    """Print the page, or write it."""
    words = sys.argv[1:]
    if words[:1] == ["-o"]:
        Path(words[1]).write_text(page(), encoding="utf-8")
    else:
        print(page(), end="")


if __name__ == "__main__":
    main()
