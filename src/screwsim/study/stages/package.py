"""Figures of two stages of air as a package rated by ISO 1217 (docs/model.md M203, M340, M345–M347).

Its inlet is the suction of the first stage, its outlet the discharge of the second. Filters, valves, coolers and fans
are those that `effects.air_package` of each scene names, whose lines are then those of that stage with its parts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from screwsim.effects.air_package import AIR, FREE_AIR
from screwsim.effects.parts.rating import isentropic_power

if TYPE_CHECKING:
    from screwsim.study.stages.figures import StagePair
    from screwsim.study.stages.result import FiguresAndReasons

NO_POWER = "the input power of both stages is not positive"


def air_figures(pair: StagePair, density: float, ends: tuple[float, float]) -> FiguresAndReasons:
    """Return the figures of a package, and why some are None; none where the gas is not air or a stage has no motor.

    `density` [kg/m³] is that of the air at the inlet, `ends` are the pressures [Pa] at inlet and outlet.
    """
    figures = [result.performance for result in pair.results]
    if pair.scenes[0].gas.name.lower() != AIR or any(each.get("electrical_power") is None for each in figures):
        return {}, {}
    flow = figures[0].gas_mass_flow / density
    power = sum(each.electrical_power + (each.get("fan_power") or 0.0) for each in figures)
    own = {FREE_AIR: flow, "package_input_power": power}
    names = ("package_specific_power", "package_isentropic_efficiency")
    if not power > 0.0:
        return {**own, **dict.fromkeys(names)}, dict.fromkeys(names, NO_POWER)
    return {**own, **dict(zip(names, (power / flow, isentropic_power(flow, *ends) / power), strict=True))}, {}
