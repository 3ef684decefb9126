"""The water that moist air brings: dew point, where it condenses and how much, and what that may harm.

Source: docs/model.md M327, M328, M361.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.build import package_of
from screwsim.cycle.problem import Problem
from screwsim.effects.base import Given
from screwsim.evaluate.performance import NONE_DELIVERED, NONE_LEAVES
from screwsim.evaluate.separator import Circuit
from screwsim.fluid import water
from screwsim.fluid.moist_air import DRIEST, MoistAir
from screwsim.model.slots import DISCHARGE_IN, DISCHARGE_OUT, OF_GAS, R_TRAPPED, S_RHO, S_T, S_X_OIL
from screwsim.outputs.customary import HOUR, celsius, in_celsius

if TYPE_CHECKING:
    from screwsim.evaluate.evaluation import Evaluation

MARGIN = 5.0  # [K] above the pressure dew point, where the scene states none
STEP = np.radians(2.0)  # between angles at which a chamber is checked for liquid
WET = 0.01  # of a chamber's water: liquid that deserves a warning; a dead volume may condense less
AFTERCOOLER = "aftercooler_condensate_flow"
PACKAGE_VAPOUR, PACKAGE_DEW = "package_vapour_flow", "package_dew_point"
DRY = "there is no water in dry air"
NO_DEW = (
    f"water would condense below {in_celsius(DRIEST)} or above {in_celsius(water.T_MOST)}, where condensation is not "
    "modelled"
)
BLOWN_OFF = "the package delivers nothing: it blows off all that the machine delivers"


def figures(of: Evaluation, found: Mapping[str, Any]) -> Given:
    """Return the figures of moist air, or the reasons why there are none; nothing for a scene without humidity.

    `found` has the figures known so far.
    """
    problem, gas, scene = of.problem, of.problem.parts.gas, of.problem.scene
    if scene.gas.relative_humidity is None:
        return {}
    wet = gas if isinstance(gas, MoistAir) else None
    p_d, brought = problem.lines.p_d, found["gas_mass_flow"] * (0.0 if wet is None else wet.share)
    margin = MARGIN if scene.gas.dew_point_margin is None else scene.gas.dew_point_margin
    dew = _dew_point(wet, p_d)
    own: dict[str, float | str] = {
        "humidity_ratio": 0.0 if wet is None else wet.humidity_ratio,
        "water_flow": brought,
        "pressure_dew_point": dew,
        "chamber_condensate_share": 0.0 if wet is None else chamber_share(of, wet),
        "lowest_safe_oil_temperature": dew if isinstance(dew, str) else dew + margin,
    }
    T, out = outlet_temperature(found, of.circuit), _discharge_flow(of)
    names = ("condensate_flow", "vapour_flow", "water_residual", AFTERCOOLER, PACKAGE_VAPOUR, PACKAGE_DEW)
    if T is None or not (out > 0.0 and found["gas_mass_flow"] > 0.0):
        return own | dict.fromkeys(names, NONE_LEAVES if T is None else NONE_DELIVERED)
    liquid = 0.0 if wet is None else out * wet.condensed(p_d, T)
    vapour = 0.0 if wet is None else out * wet.share - liquid
    own["condensate_flow"], own["vapour_flow"] = liquid, vapour
    own["water_residual"] = 0.0 if wet is None else (brought - liquid - vapour) / brought
    return own | _delivered(problem, wet, out, T, vapour)


def _dew_point(wet: MoistAir | None, p: float) -> float | str:
    """Return the dew point [K] of air at p [Pa], or why it has none."""
    found = None if wet is None else wet.dew_point(p)
    return (DRY if wet is None else NO_DEW) if found is None else found


def _delivered(problem: Problem, wet: MoistAir | None, out: float, T: float, vapour: float) -> dict[str, float | str]:
    """Return an aftercooler's condensate and the vapour after it, by the vapour [kg/s] behind the separator (M361)."""
    scene, p_d = problem.scene, problem.lines.p_d
    package = package_of(scene)
    if wet is None or (package is not None and not package.delivers):
        none = BLOWN_OFF if package is not None and not package.delivers else DRY
        return {AFTERCOOLER: 0.0, PACKAGE_VAPOUR: 0.0, PACKAGE_DEW: none}
    outlet = p_d if package is None or scene.losses is None else p_d - scene.losses.behind
    liquid = out * wet.share - vapour
    cooled = min(T, cooled_to(problem, T) or T)
    condensed = max(out * wet.condensed(outlet, cooled) - liquid, 0.0)
    if package is None:
        return {AFTERCOOLER: condensed}
    left = vapour - condensed
    passed = replace(wet, share=left / (left + out * (1.0 - wet.share)))
    return {AFTERCOOLER: condensed, PACKAGE_VAPOUR: left, PACKAGE_DEW: _dew_point(passed, outlet)}


def cooled_to(problem: Problem, T: float) -> float | None:
    """Return the temperature [K] to which an aftercooler brings air of T [K]; None without one."""
    scene, package = problem.scene, package_of(problem.scene)
    by_package = None if package is None else package.cooled(T, problem.lines.T_s)
    return scene.operation.aftercooler_temperature if by_package is None else by_package


def outlet_temperature(found: Mapping[str, Any], circuit: Circuit | str | None) -> float | None:
    """Return the temperature [K] at which gas leaves the separator, or the chambers where there is no oil."""
    return circuit.parted.T_separator if isinstance(circuit, Circuit) else found.get("discharge_temperature")


def _discharge_flow(of: Evaluation) -> float:
    """Return the net flow to the discharge line [kg/s], by the flows through its ports."""
    if isinstance(of.circuit, Circuit):
        return of.circuit.outflow.gas_flow
    problem, streams = of.problem, of.streams
    returned = problem.suction.returned * of.fresh_gas
    return problem.rate * (
        -float(streams[DISCHARGE_IN, OF_GAS] + streams[DISCHARGE_OUT, OF_GAS]) - of.leak.gas - returned
    )


def chamber_share(of: Evaluation, gas: MoistAir, below: float = np.inf) -> float:
    """Return the largest liquid share of a chamber's trapped water, where it is colder than `below` [K] (M327)."""
    problem, life = of.problem, of.life
    angles = np.arange(0.0, problem.parts.geometry.life, STEP)
    states, carried, trapped = life.states_at(angles), problem.composition.carried, float(life.R[R_TRAPPED])
    wet, most = np.flatnonzero((life.phases(states) != 0) & (states[:, S_T] < below)), 0.0
    for angle, state in zip(angles[wet].tolist(), states[wet].tolist(), strict=True):
        rho, ratio = state[S_RHO], state[S_X_OIL] if carried else 0.0
        liquid = gas.liquid_share(state[S_T], rho)
        if liquid > 0.0:
            most = max(most, liquid * rho * life.volume(angle) / problem.parts.volume_over_gas(rho, ratio))
    return min(most / (gas.share * trapped), 1.0) if trapped > 0.0 else 0.0


def warnings(of: Evaluation) -> Iterator[str]:
    """Yield warnings where water condenses, or nearly does (M328)."""
    problem, found, gas = of.problem, of.figures, of.problem.parts.gas
    T, dew = outlet_temperature(found, of.circuit), found.get("pressure_dew_point")
    if not isinstance(gas, MoistAir) or dew is None:
        return
    safe, flow = found["lowest_safe_oil_temperature"], found.get("condensate_flow")
    if T is not None and T < safe:
        oil = problem.parts.oil is not None
        at = f"gas and oil separate at {celsius(T)}" if oil else f"the gas leaves at {celsius(T)}"
        remedy = f"keep them at {celsius(safe)} or above with warmer oil" if oil else "use drier or warmer air"
        if flow:
            what = f"{at}, below the pressure dew point of {celsius(dew)}: {HOUR * flow:.3g} kg/h of water condense"
        else:
            what = f"{at}, only {T - dew:.2g} K above the pressure dew point of {celsius(dew)}"
        yield f"{what} ({remedy})"
    T_2 = None if T is None else cooled_to(problem, T)
    if T_2 is not None and T_2 < water.T_TRIPLE and found.get(AFTERCOOLER):
        yield (
            f"water condenses in the aftercooler at {celsius(T_2)}, and is modelled as liquid, not ice (choose a "
            "warmer outlet)"
        )
    share = found["chamber_condensate_share"]
    if share > WET:
        remedy = "mixed into its oil (use warmer oil)" if problem.parts.oil is not None else "(use drier or warmer air)"
        yield f"up to {share:.0%} of the water in a chamber is liquid {remedy}"
        ice = chamber_share(of, gas, water.T_TRIPLE)
        if ice > WET:
            yield (
                f"up to {ice:.0%} of the water in a chamber condenses below 0 degC, and is modelled as liquid, not ice"
            )
