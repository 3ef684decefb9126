"""Kernels of one fluid's Helmholtz equation of state: `state` and `entropy` by temperature and density.

Source: the fluid's equation as CoolProp describes it (Bell et al. 2014, doi:10.1021/ie4033999); Span, Multiparameter
Equations of State, 2000. The reference state is CoolProp's default for the fluid.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.fluid.description import describe
from screwsim.fluid.equation_text import EquationText
from screwsim.fluid.mixture import ideal_terms, residual_terms
from screwsim.fluid.nozzle import critical_power
from screwsim.numerics.kernel import Kernel, written

STATE = '"""Return (p, h, c_v, T dp/dT, 1/k, drop and psi2 of choking) of {name} at T [K], rho [kg/m3] ({source})."""'
PHASED = (
    '"""Return what `state` of {name} returns, in one phase (0) or in both (1), beyond their border too ({source})."""'
)
ENTROPY = '"""Return the specific entropy s [J/(kg K)] of {name} at T [K], rho [kg/m3] ({source})."""'
HEAT_CAPACITY = '"""Return cp0 [J/(kg K)] of the ideal gas of {name} at T [K] ({source})."""'
POTENTIALS = '"""Return (p [Pa], dp/drho [m2/s2], g = h - T s [J/kg]) of {name} at T [K], rho [kg/m3] ({source})."""'


def _lines(fluid: str, wanted: tuple[str, ...]) -> list[str]:
    """Return the lines that compute the wanted sums and the ideal part from T and rho."""
    known = describe(fluid)
    text = EquationText(wanted)
    text.residual(residual_terms(known))
    text.ideal(ideal_terms(known))
    text.finish()
    head = [
        f"tau = {known.T_r!r} / T",
        f"inverse_tau = T * {1.0 / known.T_r!r}",
        f"delta = rho * {1.0 / known.rho_r!r}",
    ]
    body = "\n".join(text.lines)
    head += [f"log_{name} = math.log({name})" for name in ("tau", "delta") if f"log_{name}" in body]
    return [*head, *text.lines, f"RT = {known.R!r} * T"]


def _function(name: str, fluid: str, doc: str, lines: list[str], arguments: str = "T, rho") -> str:
    known = describe(fluid)
    body = "\n".join(f"    {line}" for line in [doc.format(name=known.name, source=known.source), *lines])
    return f"def {name}({arguments}):\n{body}\n"


def phased_state_text(fluid: str) -> str:
    """Return the text of `phased_state(phase, T, rho)`, which calls `mixture(T, rho)` in phase 1."""
    lines = ["if phase == 1:", "    return mixture(T, rho)", *_state_lines(fluid)]
    return _function("phased_state", fluid, PHASED, lines, "phase, T, rho")


def _state_lines(fluid: str) -> list[str]:
    return [
        *_lines(fluid, ("D", "E", "DD", "EE", "DE")),
        "z = 1.0 + D",
        "cv = C0 + E - EE",
        "zt = z - DE",
        "b = z + DD + zt * zt / cv",  # ρ w²/(ρ R T), so that k = b/z
        "y = (b - z) / (b + z)",
        "e = critical_power(y)",
        "p = rho * RT",
        f"c_v = {describe(fluid).R!r} * cv",
        "return p * z, RT * (z + E0 + E), c_v, p * zt, z / b, 1.0 - (1.0 - y) * e, (1.0 + y) * e * e",
    ]


@lru_cache(maxsize=64)
def state_kernel(fluid: str) -> Kernel:
    """Return `state(T, rho)` of the fluid; k = ρ w²/p is the local exponent of p v^k = const on the isentrope."""
    text = _function("state", fluid, STATE, _state_lines(fluid))
    return written(text, describe(fluid).name, {"critical_power": critical_power})


@lru_cache(maxsize=64)
def entropy_kernel(fluid: str) -> Kernel:
    """Return `entropy(T, rho)` of the fluid."""
    lines = [*_lines(fluid, ("A", "E")), f"return {describe(fluid).R!r} * (E0 + E - A0 - A)"]
    return written(_function("entropy", fluid, ENTROPY, lines), describe(fluid).name)


@lru_cache(maxsize=64)
def potentials_kernel(fluid: str) -> Kernel:
    """Return `potentials(T, rho)` of the fluid, for finding saturation."""
    lines = [
        *_lines(fluid, ("A", "D", "DD")),
        "return rho * RT * (1.0 + D), RT * (1.0 + D + DD), RT * (1.0 + D + A0 + A)",
    ]
    return written(_function("potentials", fluid, POTENTIALS, lines), describe(fluid).name)


@lru_cache(maxsize=64)
def ideal_heat_capacity_kernel(fluid: str) -> Kernel:
    """Return `ideal_heat_capacity(T)` [J/(kg K)] at constant pressure."""
    known = describe(fluid)
    text = EquationText(("EE",))
    text.ideal(ideal_terms(known))
    body = "\n".join(text.lines)
    head = [f"tau = {known.T_r!r} / T", f"inverse_tau = T * {1.0 / known.T_r!r}"]
    head += ["log_tau = math.log(tau)"] if "log_tau" in body else []
    lines = [*head, *text.lines, f"return {known.R!r} * (1.0 + C0)"]
    return written(_function("ideal_heat_capacity", fluid, HEAT_CAPACITY, lines, "T"), known.name)


def vectorised(kernel: Kernel) -> Any:
    """Return the kernel's text as a function of arrays, of any precision."""
    space: dict[str, Any] = {"math": np, "np": np}
    exec(kernel.source, space)
    return space[kernel.__name__]
