"""Kernels of a fluid's saturation and two-phase region, from its tables (saturation.py).

Inside the dome both phases are in equilibrium at p_sat(T) with one Gibbs energy g(T). The Helmholtz energy is then f =
g(T) − p_sat(T) v, and everything follows from these two functions of T (a prime is d/dT):
    s = −g' + p' v,   u = g − T g' + v (T p' − p),   h = u + p v,   c_v = −T g'' + v T p'',
    w² = T p'²/(ρ² c_v)    (homogeneous equilibrium; Clapeyron's relation makes u and s linear in v between the phases).
So du/dT = c_v and (∂u/∂v)_T = T p' − p hold exactly, whatever the tables' error.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.fluid.always_gas import P_MOST
from screwsim.fluid.description import describe
from screwsim.fluid.helmholtz import entropy_kernel, phased_state_text, state_kernel
from screwsim.fluid.nozzle import choking, critical_power
from screwsim.fluid.saturation import BINS, DEGREE, Table, saturation
from screwsim.numerics.kernel import Kernel, written

PHASES = "vapour", "liquid"
GAS_MOST = 4.0  # density over the reducing one that a gas stays below
QUICK = 128  # intervals of the table that quickly identifies certain vapour

LOG_DENSITY = '''def log_density(theta, fine):
    """Return ln of the saturated density [kg/m3] by theta = +-sqrt(1 - T/T_c), - for vapour; fine = sqrt|theta|."""
    i = int(fine * PER_FINE)
    i = {middle} + i if theta >= 0.0 else {middle} - i
    i = min(max(i, 0), {last})
    s = (theta - MIDDLE[i]) * SCALE[i]
    j = {n} * i
    return {value}
'''

DENSITY = '''def saturated_{phase}(T):
    """Return the density [kg/m3] of saturated {phase} at T [K], from T_low to the critical point."""
    theta = math.sqrt(max(1.0 - T * {per_T_c!r}, 0.0))
    return math.exp(log_density({sign}theta, math.sqrt(theta)))
'''

PRESSURE = '''def saturation_pressure(T):
    """Return (p_sat [Pa], dp_sat/dT [Pa/K], d2p_sat/dT2 [Pa/K2]) at T [K], from T_low to the critical point."""
    fine = math.sqrt(math.sqrt(max(1.0 - T * {per_T_c!r}, 0.0)))
    i = max({last} - int(fine * PER_FINE), 0)
    scale = SCALE[i]
    s = (T - MIDDLE[i]) * scale
    j = {n} * i
    value = {value}
    first = ({first}) * scale
    second = ({second}) * scale * scale
    p = math.exp(value)
    return p, p * first, p * (first * first + second)
'''

GIBBS = '''def saturation_gibbs(T):
    """Return (g [J/kg], dg/dT, d2g/dT2) of both phases at T [K], from T_low to the critical point."""
    fine = math.sqrt(math.sqrt(max(1.0 - T * {per_T_c!r}, 0.0)))
    i = max({last} - int(fine * PER_FINE), 0)
    scale = SCALE[i]
    s = (T - MIDDLE[i]) * scale
    j = {n} * i
    return {value}, ({first}) * scale, ({second}) * scale * scale
'''

TEMPERATURE = '''def saturation_temperature(p):
    """Return T_sat [K] at p [Pa], from p_sat(T_low) to the critical pressure: a table, and one Newton step."""
    y = math.log(p)
    i = min(max(int((y - {low!r}) * {per!r}), 0), {last})
    s = (y - MIDDLE[i]) * SCALE[i]
    j = {n} * i
    T = min({value}, {T_c!r})
    found, slope, _ = saturation_pressure(T)
    return min(T + (y - math.log(found)) * found / slope, {T_c!r})
'''

MIXTURE = '''def mixture(T, rho):
    """Return what `state` returns for both phases of {name} in equilibrium at T [K], rho [kg/m3]."""
    p, slope, curvature = saturation_pressure(T)
    g, dg, ddg = saturation_gibbs(T)
    v = 1.0 / rho
    tpt = T * slope
    c_v = T * (v * curvature - ddg)
    a = p * rho * c_v / (tpt * slope)
    choke, choked = choking(1.0 / a)
    return p, g - T * dg + v * tpt, c_v, tpt, a, choke, choked
'''

INSIDE = '''def inside(T, rho):
    """Return whether T [K], rho [kg/m3] lies between saturated vapour and liquid of {name} (at and above T_low)."""
    if T >= {T_c!r} or T < {T_low!r} or rho < QUICK_DENSITY[int((T - {T_low!r}) * {per!r})]:
        return False
    theta = math.sqrt(1.0 - T * {per_T_c!r})
    fine = math.sqrt(theta)
    y = math.log(rho)
    return log_density(-theta, fine) < y < log_density(theta, fine)
'''

PHASE = '''def phase(T, rho):
    """Return 1 where two phases of {name} are in equilibrium at T [K], rho [kg/m3], else 0."""
    return 1 if inside(T, rho) else 0
'''

EQUILIBRIUM = '''def state(T, rho):
    """Return the state of {name}, two phases in equilibrium in the dome."""
    return phased_state(phase(T, rho), T, rho)
'''

ENTROPY = '''def entropy(T, rho):
    """Return the specific entropy s [J/(kg K)] of {name}, two phases in equilibrium in the dome."""
    if inside(T, rho):
        return saturation_pressure(T)[1] / rho - saturation_gibbs(T)[1]
    return single(T, rho)
'''

GAS_DENSITY = '''def saturated_{phase}(T):
    """Return a density [kg/m3] above all that are searched: {name} is known as a gas only, without saturation."""
    return {most!r}
'''

GAS_PRESSURE = '''def saturation_pressure(T):
    """Return an infinite pressure [Pa]: {name} is known as a gas only, without saturation."""
    return math.inf, 0.0, 0.0
'''

GAS_TEMPERATURE = '''def saturation_temperature(p):
    """Return the temperature [K] from which {name} is known, as a gas only, without saturation."""
    return {T_low!r}
'''

GAS_MARGIN = '''def margin(T, rho):
    """Return how far T [K], rho [kg/m3] lies inside the gas that {name}'s equation covers; <= 0 outside.

    It is the least of the relative distances from T_low, T_max and p_max.
    """
    return min(T * {per_T_low!r} - 1.0, 1.0 - T * {per_T_max!r}, 1.0 - single(T, rho)[0] * {per_p_max!r})
'''

MARGIN = '''def margin(T, rho):
    """Return how far T [K], rho [kg/m3] lies inside the vapour that {name}'s equation covers; <= 0 outside.

    It is the least of ln(rho_sat/rho), below the critical temperature, and of the relative distances from T_low, T_max
    and p_max.
    """
    found = min(T * {per_T_low!r} - 1.0, 1.0 - T * {per_T_max!r}, 1.0 - single(T, rho)[0] * {per_p_max!r})
    if {T_low!r} <= T < {T_c!r}:
        theta = math.sqrt(1.0 - T * {per_T_c!r})
        found = min(found, log_density(-theta, math.sqrt(theta)) - math.log(rho))
    return found
'''


def _polynomial(order: int = 0) -> str:
    """Return the text of a derivative by s of the polynomial whose coefficients begin at C[j]."""
    text = ""
    for k in range(DEGREE, order - 1, -1):
        weight = math.perm(k, order)
        term = f"C[j + {k}]" if weight == 1 else f"{float(weight)!r} * C[j + {k}]"
        text = f"{term} + s * ({text})" if text else term
    return text


def _arrays(table: Table) -> dict[str, np.ndarray]:
    """Return the arrays that a table's kernel reads."""
    low, high = table.edges[:-1], table.edges[1:]
    return {"MIDDLE": 0.5 * (low + high), "SCALE": 2.0 / (high - low), "C": table.c.ravel()}


@dataclass(frozen=True)
class SaturationKernels:
    """Kernels of the saturated fluid, as functions of T [K]; `temperature` of p [Pa], `log_density` of theta."""

    vapour: Kernel
    liquid: Kernel
    pressure: Kernel
    temperature: Kernel


@dataclass(frozen=True)
class DomeKernels(SaturationKernels):
    """Those of a fluid whose two phases are known."""

    log_density: Kernel
    gibbs: Kernel


def numbers(fluid: str) -> dict[str, Any]:
    """Return the values that are filled into the texts above."""
    known, found = describe(fluid), saturation(fluid)
    return {
        "name": known.name,
        "T_c": found.T_c,
        "T_low": found.T_low,
        "per_T_c": 1.0 / found.T_c,
        "per_T_low": 1.0 / found.T_low,
        "per_T_max": 1.0 / known.T_max,
        "per_p_max": 1.0 / known.p_max,
        "n": DEGREE + 1,
        "last": BINS - 1,
        "value": _polynomial(),
        "first": _polynomial(1),
        "second": _polynomial(2),
    }


@lru_cache(maxsize=64)
def saturation_kernels(fluid: str) -> SaturationKernels:
    """Return the saturation kernels of a fluid; of one that is known as a gas only, those that say so."""
    if not saturation(fluid).always_gas:
        return dome_kernels(fluid)
    known, found = numbers(fluid), saturation(fluid)
    of, most = f"{known['name']} gas", GAS_MOST * found.rho_c
    vapour, liquid = (written(GAS_DENSITY.format(**known | {"phase": x, "most": most}), of) for x in PHASES)
    pressure, temperature = (written(text.format(**known), of) for text in (GAS_PRESSURE, GAS_TEMPERATURE))
    return SaturationKernels(vapour, liquid, pressure, temperature)


@lru_cache(maxsize=64)
def dome_kernels(fluid: str) -> DomeKernels:
    """Return the saturation kernels of a fluid whose two phases are known."""
    known, found = numbers(fluid), saturation(fluid)
    of = f"{known['name']} saturation"
    per_fine = BINS / (1.0 - found.T_low / found.T_c) ** 0.25
    log_density = written(
        LOG_DENSITY.format(**known | {"middle": BINS - 1, "last": 2 * BINS - 2}),
        of,
        _arrays(found.log_rho) | {"PER_FINE": per_fine},
    )
    vapour, liquid = (
        written(DENSITY.format(**known | {"phase": phase, "sign": sign}), of, {"log_density": log_density})
        for phase, sign in (("vapour", "-"), ("liquid", ""))
    )
    pressure, gibbs = (
        written(text.format(**known), of, _arrays(table) | {"PER_FINE": per_fine})
        for text, table in ((PRESSURE, found.log_p), (GIBBS, found.gibbs))
    )
    edges = found.T_of_log_p.edges
    ends = {"low": float(edges[0]), "per": (len(edges) - 1) / float(edges[-1] - edges[0]), "last": len(edges) - 2}
    temperature = written(
        TEMPERATURE.format(**known | ends), of, _arrays(found.T_of_log_p) | {"saturation_pressure": pressure}
    )
    return DomeKernels(vapour, liquid, pressure, temperature, log_density, gibbs)


@lru_cache(maxsize=64)
def inside_kernel(fluid: str) -> Kernel:
    """Return `inside(T, rho)`; a table of the least vapour density per interval of T decides most cases quickly."""
    known, found, kernels = numbers(fluid), saturation(fluid), dome_kernels(fluid)
    left = found.T_low + (found.T_c - found.T_low) * np.arange(QUICK + 1) / QUICK
    quick = np.exp(found.log_rho(-np.sqrt(np.maximum(1.0 - left / found.T_c, 0.0)))) * (1.0 - 1e-9)
    text = INSIDE.format(**known, per=QUICK / (found.T_c - found.T_low))
    return written(text, f"{known['name']} dome", {"QUICK_DENSITY": quick, "log_density": kernels.log_density})


@lru_cache(maxsize=64)
def equilibrium_kernels(fluid: str) -> Mapping[str, Kernel]:
    """Return the kernels of a fluid whose two phases are in equilibrium inside the dome, by what a gas calls them.

    `phased_state` continues smoothly beyond the border of its phase, so that an integrator that crosses it can end its
    step there.
    """
    known, kernels, inside = numbers(fluid), dome_kernels(fluid), inside_kernel(fluid)
    two = {"saturation_pressure": kernels.pressure, "saturation_gibbs": kernels.gibbs}
    of = f"{known['name']} equilibrium"
    mixture = written(MIXTURE.format(**known), of, two | {"choking": choking})
    phased = written(phased_state_text(fluid), of, {"mixture": mixture, "critical_power": critical_power})
    phase = written(PHASE.format(**known), of, {"inside": inside})
    state = written(EQUILIBRIUM.format(**known), of, {"phase": phase, "phased_state": phased})
    entropy = written(ENTROPY.format(**known), of, two | {"inside": inside, "single": entropy_kernel(fluid)})
    return {"state": state, "specific_entropy": entropy, "phase": phase, "phased_state": phased}


@lru_cache(maxsize=64)
def margin_kernel(fluid: str) -> Kernel:
    """Return `margin(T, rho)` of a fluid."""
    known = numbers(fluid)
    if saturation(fluid).always_gas:
        text = GAS_MARGIN.format(**known | {"per_p_max": 1.0 / min(describe(fluid).p_max, P_MOST)})
        return written(text, f"{known['name']} margin", {"single": state_kernel(fluid)})
    kernels = dome_kernels(fluid)
    uses = {"single": state_kernel(fluid), "log_density": kernels.log_density}
    return written(MARGIN.format(**known), f"{known['name']} margin", uses)
