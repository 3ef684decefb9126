"""Figures of two stages together, from the results of both at one intermediate pressure (docs/model.md M203)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from screwsim.build import build_gas
from screwsim.cycle.problem import Inlet
from screwsim.effects.air_package import FREE_AIR, INPUT_POWER
from screwsim.effects.parts.rating import isentropic_power
from screwsim.evaluate.performance import beyond_suction_gas, efficiencies, parted
from screwsim.fluid import constants
from screwsim.fluid.composition import is_blend
from screwsim.fluid.reservoir import Reservoir
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.scene import Scene, suction_enthalpy
from screwsim.scene.lines import condensate_enthalpy, lines
from screwsim.study.stages.axes import STAGE_NAMES
from screwsim.study.stages.result import (
    FiguresAndReasons,
    capacities,
    delivery_temperature_figure,
    electrical_figures,
    figures_of_both,
)

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain

OF_FREE_AIR = FREE_AIR, "package_specific_power"  # which the second stage alone has not
NO_FREE_AIR = "free air is what the first stage draws in, and this figure is that of both stages together"
NO_INPUT_POWER = "the input power of both stages is not positive"
SEPARATOR_FIGURES = ("separator_temperature", "oil_cooler_duty")  # figures of each stage's separator


class StagePair(NamedTuple):
    """Both stages at one intermediate pressure: scenes, results, tank vapour per unit of the first stage's gas."""

    p: float
    scenes: tuple[Scene, Scene]
    results: tuple[Result, Result]
    vapour: float
    T: float
    unparted: str = ""  # why gas and oil of the second stage are not separated

    @property
    def flows(self) -> tuple[float, float]:
        """Return the flow that reaches the second stage and the one that it takes [kg/s]."""
        first, second = (result.performance.gas_mass_flow for result in self.results)
        return first * (1.0 + self.vapour), second

    @property
    def excess(self) -> float:
        """Return ln of the flow that arrives over the flow taken: it falls with the pressure."""
        comes, taken = self.flows
        return float(np.log(max(comes, 1e-12) / max(taken, 1e-12)))


def delivery_temperature(result: Result) -> float:
    """Return the temperature [K] of the gas that a stage delivers."""
    return result.performance[delivery_temperature_figure(result)]


class ChainEnds:
    """A chain with its gas, and the lines that its scenes state."""

    def __init__(self, chain: StageChain) -> None:
        self.chain, self.gas = chain, build_gas(chain.first)
        self.low, self.high = lines(chain.first), lines(chain.second)

    def liquid(self) -> float:
        """Return the enthalpy [J/kg] of the liquid behind the condenser (M43), or behind the gas cooler (M330)."""
        found = condensate_enthalpy(self.chain.second)
        assert found is not None
        return found

    def flashed(self, p: float, superheat: float = 0.0) -> float:
        """Return the vapour that leaves a flash tank at p [Pa], over the liquid that does (M202).

        `superheat` [J/kg] is heat that the tank's liquid takes up besides, over the liquid that leaves. Raises
        UsageError where there is no saturation, or the liquid from the condenser forms no vapour.
        """
        fluid, h_c = self.chain.first.gas.name, self.liquid()
        h_g, h_f = (constants.wet_enthalpy(fluid, p, quality) for quality in (1.0, 0.0))
        if not h_f < h_c < h_g:
            raise UsageError(f"the liquid from the condenser forms no vapour at {p / 1e5:.4g} bar")
        return (h_c - h_f + superheat) / (h_g - h_c)

    def saturation(self, p: float) -> float | None:
        """Return the saturation temperature [K] of the gas at p [Pa]; None above the critical pressure."""
        with suppress(UsageError):
            return constants.saturation_temperature(self.chain.first.gas.name, p)
        return None


def chain_figures(ends: ChainEnds, pair: StagePair) -> tuple[Figures, Mapping[str, str]]:
    """Return the figures of the whole that the chain calls for (M203), and why some are None."""
    first, second = (result.performance for result in pair.results)
    power, flow, p = first.shaft_power + second.shaft_power, first.gas_mass_flow, pair.p
    h_d = ends.gas.enthalpy(p, delivery_temperature(pair.results[0]))
    h_2 = ends.gas.enthalpy(p - ends.chain.intercooler.pressure_drop, pair.T)
    T_e = None if pair.vapour == 0.0 else constants.saturation_temperature(ends.chain.first.gas.name, p)
    # vapour that cools the first stage's gas is not counted: no evaporator gives it off
    drawn = [] if T_e is None else [(ends.flashed(p) * flow, ends.gas.vapour(p, T_e))]
    port_state = ends.gas.port_state(ends.low.p_s, ends.low.T_s)
    if ends.low.quality is not None:
        port_state = ends.gas.port_state_of_enthalpy(ends.low.p_s, suction_enthalpy(ends.chain.first))
    both = replace(ends.low, p_d=ends.high.p_d)
    etas, notes = parted(efficiencies(ends.gas, both, Inlet(port_state[1], port_state[2]), flow, power, drawn))
    comes, taken = pair.flows
    cooled, reasons = _capacities(ends, pair, flow, power, port_state[2], drawn)
    electrical, unknown = electrical_figures(pair.results, cooled, reasons)
    package, why = _air_figures(pair, port_state[1], (ends.low.p_s, ends.high.p_d))
    notes = {**notes, **reasons, **unknown, **why}
    found = dict[str, Any](
        intermediate_pressure=p,
        **_saturation(ends, p),
        second_suction_temperature=pair.T,
        intercooler_heat=0.0 if drawn else flow * (h_d - h_2),
        **({"vapour_mass_flow": pair.vapour * flow} if drawn else {}),
        gas_mass_flow=flow,
        first_shaft_power=first.shaft_power,
        second_shaft_power=second.shaft_power,
        shaft_power=power,
        **_cooler_figures(pair),
        first_pressure_ratio=first.pressure_ratio,
        second_pressure_ratio=second.pressure_ratio,
        first_discharge_temperature=first.discharge_temperature,
        discharge_temperature=second.discharge_temperature,
        **etas,
        **cooled,
        **electrical,
        **package,
        flow_mismatch=abs(comes - taken) / max(comes, taken),
    )
    notes |= {f"{STAGE_NAMES[1]}_{name}": pair.unparted for name in SEPARATOR_FIGURES if pair.unparted}
    return figures_of_both(found), {
        name: notes.get(name, "this gas has none") for name, value in found.items() if value is None
    }


def _saturation(ends: ChainEnds, p: float) -> dict[str, float]:
    """Return the saturation temperature [K] at p [Pa] of a chain with a condenser, if its refrigerant has one."""
    if condensate_enthalpy(ends.chain.second) is None or is_blend(ends.chain.first.gas.name):
        return {}
    T = ends.saturation(p)
    return {} if T is None else {"intermediate_temperature": T}


def _capacities(
    ends: ChainEnds, pair: StagePair, flow: float, power: float, h_s: float, drawn: Sequence[tuple[float, Reservoir]]
) -> FiguresAndReasons:
    """Return the result of `capacities` for a flow of the first stage [kg/s] and its inlet enthalpy h_s [J/kg]."""
    if condensate_enthalpy(ends.chain.second) is None:
        return {}, {}
    sucked, liquid, second = suction_enthalpy(ends.chain.first), ends.liquid(), pair.results[1].performance
    evaporated = liquid if pair.vapour == 0.0 else constants.wet_enthalpy(ends.chain.first.gas.name, pair.p, 0.0)
    T = second.get(SEPARATOR_FIGURES[0]) or second.discharge_temperature
    p, own = pair.p - ends.chain.intercooler.pressure_drop, build_gas(pair.scenes[1])
    rise = ends.gas.enthalpy(p, pair.T) - h_s + own.enthalpy(ends.high.p_d, T) - own.enthalpy(p, pair.T)
    rejected = None if pair.unparted else sucked - liquid + rise
    beyond = beyond_suction_gas(ends.chain.first, h_s, drawn)
    return capacities(flow * (sucked - evaporated), power, second, rejected, pair.unparted, beyond)


def _cooler_figures(pair: StagePair) -> dict[str, float | None]:
    """Return the figures of each oiled stage's separator and oil cooler (M287); None where gas and oil stay mixed."""
    stages = zip(STAGE_NAMES, pair.scenes, (result.performance for result in pair.results), strict=True)
    oiled = [(which, p) for which, scene, p in stages if scene.oil_supply is not None]
    return {f"{which}_{name}": p.get(name) for name in SEPARATOR_FIGURES for which, p in oiled}


def without_free_air(second: Result) -> Result:
    """Return a second stage's result without figures of free air: what it draws in has been compressed before."""
    none = {name: None for name in OF_FREE_AIR if name in second.performance}
    if not none:
        return second
    performance, error = second.performance.copy(), second.error.copy()
    performance.update(none)
    error.update({name: None for name in none if name in error})
    return replace(
        second, performance=performance, error=error, notes={**second.notes, **dict.fromkeys(none, NO_FREE_AIR)}
    )


def _air_figures(pair: StagePair, density: float, ends: tuple[float, float]) -> FiguresAndReasons:
    """Return the figures of a package by ISO 1217 (M340, M345–M347), and why some are None.

    Its inlet is the suction of the first stage, its outlet the discharge of the second; filters, valves, coolers and
    fans are those that `effects.air_package` of each scene names, whose lines are those of that stage with its parts.
    There are no figures where the gas is not air or a stage has no motor. `density` [kg/m³] is that of the air at the
    inlet, `ends` are the pressures [Pa] at inlet and outlet.
    """
    figures = [result.performance for result in pair.results]
    if not pair.scenes[0].gas.is_air or any(each.get("electrical_power") is None for each in figures):
        return {}, {}
    flow = figures[0].gas_mass_flow / density
    power = sum(each.electrical_power + (each.get("fan_power") or 0.0) for each in figures)
    own = {FREE_AIR: flow, INPUT_POWER: power}
    names = ("package_specific_power", "package_isentropic_efficiency")
    if not power > 0.0:
        return {**own, **dict.fromkeys(names)}, dict.fromkeys(names, NO_INPUT_POWER)
    return {**own, **dict(zip(names, (power / flow, isentropic_power(flow, *ends) / power), strict=True))}, {}
