"""Whether a user's own gas is one equation: its kernels and its plain Python, compared by thermodynamics at two states.

The states are that of the suction line and the one at discharge pressure with the same entropy. Derivatives are central
differences, whose own error is far below SLACK. Built-in gases are not checked here: their tests do that.

Source: T ds = du + p d(1/ρ), Maxwell's relation, k = ρ c²/p with c² = ∂p/∂ρ|T + T (∂p/∂T)²/(ρ² c_v) (textbook).
"""

import math
from collections.abc import Iterator

from screwsim.fluid.gas import Gas, kernel_value

STEP = 1e-4  # relative step of a central difference
SLACK = 1e-3  # largest relative difference of quantities that must be equal
Pair = tuple[str, float, float, float]  # description, value found, value wanted, least scale of their difference


def inconsistency(gas: Gas, p_s: float, T_s: float, p_d: float) -> str:
    """Return in words how a gas contradicts itself between two lines [Pa, K]; empty where it does not."""
    for what, found, wanted, scale in _pairs(gas, p_s, T_s, p_d):
        if not abs(found - wanted) <= SLACK * max(abs(wanted), scale):
            return f"{what} is {found:.6g}, and its other functions give {wanted:.6g}"
    return ""


def _pairs(gas: Gas, p_s: float, T_s: float, p_d: float) -> Iterator[Pair]:
    yield from _state(gas, p_s, T_s)
    T_d = gas.temperature(p_d, gas.enthalpy(p_s, T_s) + gas.isentropic_work(p_s, p_d, T_s))
    h, s = gas.enthalpy(p_s, T_s), gas.entropy(p_s, T_s)
    yield "its entropy [J/(kg K)] after isentropic_work", gas.entropy(p_d, T_d), s, gas.c_p
    work = gas.isentropic_work(p_s, p_d, T_s)
    yield "its isentropic_work_of_enthalpy [J/kg]", gas.isentropic_work_of_enthalpy(p_s, p_d, h), work, 0.0
    if gas.isothermal_obstacle(p_s, p_d, T_s) is None:
        rise = gas.enthalpy(p_d, T_s) - h - T_s * (gas.entropy(p_d, T_s) - s)
        found = gas.isothermal_work(p_s, p_d, T_s)
        yield "its isothermal_work [J/kg]", math.nan if found is None else found, rise, 0.0
    ideal = gas.R * T_s * math.log(p_d / p_s)
    yield "its ideal_isothermal_work [J/kg]", gas.ideal_isothermal_work(p_s, p_d, T_s), ideal, 0.0
    yield from _state(gas, p_d, T_d)


def _state(gas: Gas, p: float, T: float) -> Iterator[Pair]:
    """Yield the pairs of values that must be equal in one state."""
    at, rho = f" at {p / 1e5:.4g} bar, {T:.4g} K", gas.density(p, T)

    def state(T: float, rho: float) -> tuple[float, ...]:
        return kernel_value(gas, gas.state, T, rho)

    def entropy(T: float, rho: float) -> float:
        return kernel_value(gas, gas.specific_entropy, T, rho)

    found_p, h, c_v, TpT, inverse, drop, choked = state(T, rho)
    yield f"p of its kernel `state`, with its density({p:.4g} Pa, {T:.4g} K)", found_p, p, 0.0
    up, down = state(T * (1 + STEP), rho), state(T * (1 - STEP), rho)
    more, less = state(T, rho * (1 + STEP)), state(T, rho * (1 - STEP))
    dT, drho = 2 * STEP * T, 2 * STEP * rho
    dp_drho = (more[0] - less[0]) / drho
    yield f"T ∂p/∂T [Pa] of its `state`{at}", TpT, T * (up[0] - down[0]) / dT, 0.0
    yield f"c_v [J/(kg K)] of its `state`{at}", c_v, (up[1] - down[1] - (up[0] - down[0]) / rho) / dT, 0.0
    yield f"1/k of its `state`{at}", inverse, p / (rho * (dp_drho + TpT**2 / (T * c_v * rho**2))), 0.0
    ds_dT = (entropy(T * (1 + STEP), rho) - entropy(T * (1 - STEP), rho)) / dT
    ds_drho = (entropy(T, rho * (1 + STEP)) - entropy(T, rho * (1 - STEP))) / drho
    yield f"T ∂s/∂T [J/(kg K)] of its `specific_entropy`{at}", T * ds_dT, c_v, 0.0
    yield f"-ρ² T ∂s/∂ρ [Pa] of its `specific_entropy`{at}", -T * rho**2 * ds_drho, TpT, 0.0
    scale = gas.c_p * T  # of enthalpies, whose zero is arbitrary
    yield f"its enthalpy [J/kg]{at}", gas.enthalpy(p, T), h, scale
    yield f"its entropy [J/(kg K)]{at}", gas.entropy(p, T), entropy(T, rho), gas.c_p
    yield f"its temperature [K] of that enthalpy{at}", gas.temperature(p, h), T, 0.0
    flow = (inverse, drop, choked)
    names = "p", "density", "enthalpy", "1/k", "drop of choking", "ψ² of choking"
    for of, port in (
        ("port_state", gas.port_state(p, T)),
        ("port_state_of_enthalpy", gas.port_state_of_enthalpy(p, h)),
        ("vapour", gas.vapour(p, T).port_state),
    ):
        for name, found, wanted in zip(names, port, (p, rho, h, *flow), strict=True):
            yield f"{name} of its {of}{at}", found, wanted, scale if name == "enthalpy" else 0.0
