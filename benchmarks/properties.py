"""Print cost and errors of the gas properties per fluid, compared with CoolProp; and the nozzle's error.

Run: python benchmarks/properties.py [FLUID ...]. Times are medians of several runs on one core of this computer,
compiled and warm, in a loop over slowly changing states; compare ratios. Errors are the largest over 0.5-40 bar from
saturation to 150 C, at the same temperature and density.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from math import sqrt
from typing import Any

import CoolProp.CoolProp as coolprop
import numpy as np
from scipy.optimize import minimize_scalar

from screwsim.codegen.modules import for_speed, load
from screwsim.fluid.nozzle import flow
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.saturation import saturation
from screwsim.numerics.kernel import HEADER, Kernel, flatten

FLUIDS = ("R134a", "R1234yf", "R1234ze(E)", "R32", "Ammonia", "CarbonDioxide", "n-Propane", "Nitrogen", "Air")
RUNS = 9
LOOP = """
def loop(n, T, rho):
    total = 0.0
    for _ in range(n):
        p, h, c_v, tpt, a, choke, choked = {state}(T, rho)
        total += p + h + c_v + tpt + a + choke + choked
        T += 1e-6
        rho += 1e-9 * rho
    return total
"""


def nanoseconds(call: Callable[[int], Any], n: int) -> float:
    """Return the median time of one of n calls [ns]."""
    call(10)
    times = []
    for _ in range(RUNS):
        started = time.perf_counter()
        call(n)
        times.append(time.perf_counter() - started)
    return 1e9 * statistics.median(times) / n


def loop_cost(kernel: Kernel, T: float, rho: float) -> float:
    """Return the time of one call of a state kernel in a compiled loop [ns]."""
    text = "\n\n".join([HEADER, *flatten((kernel,)).values(), LOOP.format(state=kernel.flat_name)])
    loop = load(text, "bench").loop
    return nanoseconds(lambda n: loop(n, T, rho), 200_000)


def coolprop_cost(fluid: str, T: float, rho: float) -> float:
    """Return the time of CoolProp's update by density and temperature, including the five properties [ns]."""
    state = coolprop.AbstractState("HEOS", fluid)

    def calls(n: int) -> None:
        for i in range(n):
            state.update(coolprop.DmassT_INPUTS, rho, T + 1e-6 * i)
            state.p(), state.hmass(), state.cvmass(), state.speed_sound()
            state.first_partial_deriv(coolprop.iP, coolprop.iT, coolprop.iDmass)

    return nanoseconds(calls, 2000)


def points(fluid: str) -> tuple[Any, list[tuple[float, float]]]:
    """Return CoolProp's state and (T, ρ) over 0.5-40 bar, from saturation or 1.02 T_c to 150 C."""
    state, gas, sat = coolprop.AbstractState("HEOS", fluid), RealGas(fluid), saturation(fluid)
    found = []
    for p in np.geomspace(0.5e5, 40e5, 15):
        T_sat = gas.saturation_temperature(p) if p < 0.9 * sat.p_c else None
        first = 1.02 * sat.T_c if T_sat is None else T_sat + 0.1
        if gas.known.pseudo_pure and T_sat is not None:
            state.update(coolprop.PQ_INPUTS, p, 1.0)
            first = state.T() + 0.1
        for T in np.linspace(first, max(min(423.15, gas.known.T_max), 1.1 * first), 15):
            state.update(coolprop.PT_INPUTS, p, float(T))
            found.append((float(T), state.rhomass()))
    return state, found


def errors(fluid: str) -> list[float]:
    """Return the largest errors of p, c_v, w (relative), h (over R T) and s (over R)."""
    gas, (state, found) = RealGas(fluid), points(fluid)
    rows = []
    for T, rho in found:
        state.update(coolprop.DmassT_INPUTS, rho, T)
        p, h, c_v, _, a, *_ = gas.state(T, rho)
        relative = [p / state.p(), c_v / state.cvmass(), sqrt(p / (rho * a)) / state.speed_sound()]
        s = gas.specific_entropy(T, rho)
        rows.append([*(x - 1 for x in relative), (h - state.hmass()) / (gas.R * T), (s - state.smass()) / gas.R])
    return [float(x) for x in np.max(np.abs(rows), axis=0)]


def property_table(fluids: list[str]) -> None:
    """Print cost and errors of each fluid."""
    head = ("refuse", "equil.", "in dome", "CoolProp")
    print("ns per state: p, h, c_v, T dp/dT, 1/k, choking; largest errors against CoolProp at equal T and density")
    print(
        f"{'fluid':<14}"
        + "".join(f"{name:>9}" for name in head)
        + "".join(f"{x:>9}" for x in ("p", "c_v", "w", "h", "s"))
    )
    for fluid in fluids:
        gas, sat = RealGas(fluid), saturation(fluid)
        T, rho = max(0.9 * sat.T_c, 280.0), 0.03 * sat.rho_c
        cost = [loop_cost(gas.state, T, rho)]
        if gas.known.pseudo_pure:
            cost += [float("nan")] * 2
        else:
            both = RealGas(fluid, "equilibrium").state
            cost += [loop_cost(both, T, rho), loop_cost(both, 0.9 * sat.T_c, 0.5 * sat.rho_c)]
        cost.append(coolprop_cost(fluid, T, rho))
        print(f"{fluid:<14}" + "".join(f"{x:>9.0f}" for x in cost) + "".join(f"{x:>9.0e}" for x in errors(fluid)))


def flux_error(gas: RealGas, p: float, T: float, ratio: float) -> float:
    """Return the relative error of the nozzle with the local exponent, against the real isentrope in equilibrium."""
    s, h = gas.entropy(p, T), gas.enthalpy(p, T)

    def flux(at: float) -> float:
        found = gas.isentrope(at, s)
        return found[1] * sqrt(2.0 * max(h - found[2], 0.0))

    throat = minimize_scalar(lambda x: -flux(x), bounds=(0.3 * p, 0.95 * p), method="bounded").x
    _, rho, _, *rest = gas.port_state(p, T)
    return flow(1.0, ratio * p, 1.0, 1.0, 0.5, 0.5, p, rho, *rest, 0.0) / flux(max(ratio * p, throat)) - 1.0


def nozzle_table() -> None:
    """Print the error of the local exponent for some upstream states."""
    ratios = (0.95, 0.9, 0.8, 0.7, 0.6, 0.2)
    print("\nnozzle with the local exponent against the real isentrope, error of the flow [%] by pressure ratio")
    print(f"{'fluid':<14}{'bar':>6}{'superheat':>10}{'k':>7}" + "".join(f"{ratio:>8}" for ratio in ratios))
    for fluid, bar in (
        ("R134a", (2, 8, 20)),
        ("Ammonia", (2, 12, 20)),
        ("CarbonDioxide", (20, 35, 60)),
        ("n-Propane", (2, 12, 20)),
    ):
        gas = RealGas(fluid, "equilibrium")
        for p in (1e5 * x for x in bar):
            for superheat in (10.0, 50.0):
                T = float(gas.saturation_temperature(p) or 0.0) + superheat
                cells = "".join(f"{100 * flux_error(gas, p, T, ratio):>8.3f}" for ratio in ratios)
                print(f"{fluid:<14}{p / 1e5:>6.0f}{superheat:>8.0f} K{1 / gas.port_state(p, T)[3]:>7.3f}{cells}")


if __name__ == "__main__":
    with for_speed():
        property_table(sys.argv[1:] or list(FLUIDS))
        nozzle_table()
