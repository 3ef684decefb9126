"""One tight chamber of a screw on a real fluid in plain Python; nothing of screwsim is imported.

An independent second writing of what the fluid does: both phases in equilibrium (M46 to M48), a port to a plenum of
vapour or of liquid (M100 to M103), the machine run backwards (M150). M… are equations of docs/model.md. Without gaps a
chamber meets the lines alone. States are gas mass and temperature; scipy's odeint (LSODA) integrates life after life
until one ends as it began. Of the fluid CoolProp gives one phase and saturation; what two phases make of it is
written here, from Chebyshev polynomials of the saturated states.

SI units; angles in degrees of the male rotor; a flow is positive into the chamber.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import degrees, exp, expm1, log1p, pi, sqrt
from typing import NamedTuple

import numpy as np
from CoolProp import AbstractState, CoolProp
from numpy.polynomial import chebyshev
from scipy.integrate import odeint

LIFE, NODES = 720.0, 60


class State(NamedTuple):
    """A state of the fluid: c_v, T (∂p/∂T)_ρ and ρw²/p beside p, ρ, T, h, s."""

    p: float
    rho: float
    T: float
    h: float
    s: float
    c_v: float
    T_p_T: float
    k: float


class Fluid:
    """A pure fluid, in two phases between T_low and T_high [K]."""

    def __init__(self, name: str, T_low: float, T_high: float) -> None:
        self.asked, self.T_low, self.T_high = AbstractState("HEOS", name), T_low, T_high
        at = np.cos(pi * (np.arange(NODES) + 0.5) / NODES)
        rows = [self._saturated(0.5 * (T_low + T_high) + 0.5 * (T_high - T_low) * x) for x in at]
        self.curves = chebyshev.chebfit(at, np.array(rows), NODES - 1)
        self.slopes = chebyshev.chebder(self.curves) * 2.0 / (T_high - T_low)

    def _saturated(self, T: float) -> list[float]:
        found = []
        for quality in (0, 1):
            self.asked.update(CoolProp.QT_INPUTS, quality, T)
            found += [np.log(self.asked.rhomass()), self.asked.hmass(), self.asked.smass()]
        return [*found, np.log(self.asked.p())]

    def at(self, T: float, rho: float) -> State:
        """Return the state at T and ρ, of one phase or of both (M46, M47)."""
        if self.T_low < T < self.T_high:
            x = (2.0 * T - self.T_low - self.T_high) / (self.T_high - self.T_low)
            r_l, h_l, s_l, r_v, h_v, s_v, p = chebyshev.chebval(x, self.curves).tolist()
            if r_v < np.log(rho) < r_l:
                dr_l, dh_l, _, dr_v, dh_v, _, dp = chebyshev.chebval(x, self.slopes).tolist()
                p, v_l, v_v = exp(p), exp(-r_l), exp(-r_v)
                dp, dv_l, dv_v = p * dp, -v_l * dr_l, -v_v * dr_v
                q = (1.0 / rho - v_l) / (v_v - v_l)
                dq = -(dv_l + q * (dv_v - dv_l)) / (v_v - v_l)  # by T, at constant volume
                du_l, du_v = dh_l - dp * v_l - p * dv_l, dh_v - dp * v_v - p * dv_v
                c_v = du_l + q * (du_v - du_l) + dq * (h_v - h_l - p * (v_v - v_l))
                k = T * dp * dp / (rho * c_v * p)  # ρ w²/p, M47 and M48
                return State(p, rho, T, h_l + q * (h_v - h_l), s_l + q * (s_v - s_l), c_v, T * dp, k)
        return self.of(CoolProp.DmassT_INPUTS, rho, T, CoolProp.iphase_gas)

    def of(self, pair: int, first: float, second: float, phase: int | None = None) -> State:
        """Return the state of a pair of CoolProp's inputs; where that lies in two phases as `at` has it."""
        a = self.asked
        a.unspecify_phase() if phase is None else a.specify_phase(phase)
        a.update(pair, first, second)
        if phase is None and 0.0 < a.Q() < 1.0:
            return self.at(a.T(), a.rhomass())
        if phase is None and a.Q() in (0.0, 1.0):  # at the border: that of the one phase
            liquid = a.Q() == 0.0
            side = CoolProp.iphase_liquid if liquid else CoolProp.iphase_gas
            return self.of(CoolProp.DmassT_INPUTS, a.rhomass(), a.T(), side)
        p, rho, T = a.p(), a.rhomass(), a.T()
        T_p_T = T * a.first_partial_deriv(CoolProp.iP, CoolProp.iT, CoolProp.iDmass)
        return State(p, rho, T, a.hmass(), a.smass(), a.cvmass(), T_p_T, rho * a.speed_sound() ** 2 / p)


@dataclass(frozen=True)
class Port:
    """A bore to a plenum whose state is held: area with its coefficient, angles between which chambers face it."""

    area: float
    opens: float
    closes: float
    held: State


@dataclass(frozen=True)
class Chamber:
    """Everything that the equations ask for; SI, angles of the laws in degrees."""

    fluid: Fluid
    lobes: int
    V_max: float
    V_min: float
    phi_A: float
    suction: tuple[float, float]  # area, phi_B
    discharge: tuple[float, float, float]  # area, angles at which it opens, phi_C
    omega: float
    sucked: State
    p_d: float
    mechanical_fraction: float
    width: float  # of the regularised root, over the line's pressure
    liquid: State | None = None  # behind the condenser
    port: Port | None = None
    backwards: bool = False


def bump(x: float, c: float) -> tuple[float, float]:
    """Return M15 and its derivative."""
    if not 0.0 < x < 2.0:
        return 0.0, 0.0
    if c <= x <= 2.0 - c:
        return (1.0 + (x - 1.0) ** 2 / (c - 1.0), 2.0 * (x - 1.0) / (c - 1.0)) if c < 1.0 else (1.0, 0.0)
    x = x if x < c else x - 2.0
    return x * x / c, 2.0 * x / c


def volume(a: Chamber, phi: float) -> tuple[float, float]:
    """Return V [m³] and dV/dφ [m³/rad], M16, M150."""
    size, slope = bump((LIFE - phi if a.backwards else phi) / 360.0, a.phi_A / 360.0)
    return a.V_min + a.V_max * size, a.V_max * (-slope if a.backwards else slope) / (2.0 * pi)


def areas(a: Chamber, phi: float) -> tuple[float, float]:
    """Return the areas [m²] to suction and discharge line, M17, M18, M150."""
    at, (largest, opens, phi_C) = LIFE - phi if a.backwards else phi, a.discharge
    half = 0.5 * (LIFE - opens)
    early = a.suction[0] * bump(at / 180.0, a.suction[1] / 180.0)[0]
    late = largest * bump((at - opens) / half, (phi_C - opens) / half)[0]
    return (late, early) if a.backwards else (early, late)


def window(port: Port, phi: float) -> float:
    """Return the area [m²] of a port, M100 with M23."""
    x = min(1.0, (phi - port.opens) / 10.0, (port.closes - phi) / 10.0)
    return port.area * x * x * (3.0 - 2.0 * x) if x > 0.0 else 0.0


def flux(high: State, p: float, eps: float) -> float:
    """Return the mass flux [kg/(m² s)] from a state to a lower pressure, M12, M13; 0 against a higher one."""
    drop, k = high.p - p, high.k
    if drop <= 0.0:
        return 0.0
    log = log1p(-min(drop / high.p, 1.0 - (2.0 / (k + 1.0)) ** (k / (k - 1.0))))
    bracket = exp(2.0 / k * log) * -expm1((k - 1.0) / k * log)
    root = sqrt(2.0 * k / (k - 1.0) * high.p * high.rho * bracket)
    return root * sqrt(drop / sqrt(drop * drop + eps * eps))


SUMS = ("work", "sucked", "delivered", "delivered_h", "net_d", "drawn", "back", "back_h")


def rates(y: np.ndarray, phi: float, a: Chamber, back: State) -> list[float]:
    """Return dy/dφ [1/degree] of m, T and the sums; `back` is the state of what flows back from the discharge line."""
    V, dV = volume(a, phi)
    m, T = float(y[0]), float(y[1])
    gas = a.fluid.at(T, m / V)
    sucking, delivering = areas(a, phi)
    eps_s, eps_d = a.width * a.sucked.p, a.width * a.p_d
    come, leave = sucking * flux(a.sucked, gas.p, eps_s), sucking * flux(gas, a.sucked.p, eps_s)
    come_d, leave_d = delivering * flux(back, gas.p, eps_d), delivering * flux(gas, a.p_d, eps_d)
    drawn = given = h = 0.0
    if a.port is not None:
        S, eps, h = window(a.port, phi), max(eps_s, eps_d), a.port.held.h
        drawn, given = S * flux(a.port.held, gas.p, eps), S * flux(gas, a.port.held.p, eps)
    dm = come + come_d + drawn - leave - leave_d - given
    dH = come * a.sucked.h + come_d * back.h + drawn * h - (leave + leave_d + given) * gas.h
    dT = ((dH - (gas.h - gas.T_p_T / gas.rho) * dm) / a.omega - gas.T_p_T * dV) / (m * gas.c_v)  # M2
    sums = [come - leave, leave_d, leave_d * gas.h, leave_d - come_d, drawn - given, given, given * gas.h]
    every = [dm / a.omega, dT, -gas.p * dV, *(each / a.omega for each in sums)]
    return [each / degrees(1.0) for each in every]


def life(a: Chamber, y: np.ndarray, back: State, rtol: float) -> tuple[np.ndarray, float]:
    """Integrate one life; return states and sums at its end, and the mass at 360°."""
    first, half, port = a.discharge[1], 0.5 * (LIFE - a.discharge[1]), a.port
    at = [0.0, a.phi_A, a.suction[1], 180.0, 360.0 - a.suction[1], 360.0, LIFE - a.phi_A]
    at += [first, a.discharge[2], first + half, LIFE + first - a.discharge[2], LIFE]
    at = [LIFE - each for each in at] if a.backwards else at
    at += [port.opens, port.opens + 10.0, port.closes - 10.0, port.closes] if port is not None else []
    mass = a.sucked.rho * a.V_max
    heat = mass * abs(a.sucked.h)
    scales = [1e-6 * mass, 1e-2, a.sucked.p * a.V_max, mass, mass, heat, mass, mass, mass, heat]
    atol, trapped, ends = 1e-1 * rtol * np.array(scales), 0.0, sorted(set(at))
    y = np.concatenate([y, np.zeros(len(SUMS))])
    for left, right in pairwise(ends):
        options = {"rtol": rtol, "atol": atol, "hmax": 2.0, "mxstep": 100000}
        y = odeint(rates, y, [left, right], args=(a, back), **options)[-1]
        trapped = float(y[0]) if right == 360.0 else trapped
    return y, trapped


def figures(a: Chamber, rtol: float = 1e-8, most: int = 20) -> dict[str, float]:
    """Repeat the life until it ends as it began; return powers [W], flows [kg/s], temperatures [K], efficiencies."""
    ideal = a.fluid.of(CoolProp.PSmass_INPUTS, a.p_d, a.sucked.s)
    start = a.sucked if a.backwards else ideal
    back, y = ideal, np.array([start.rho * a.V_min, start.T])
    for _ in range(most):
        end, trapped = life(a, y, back, rtol)
        sums = dict(zip(SUMS, end[2:].tolist(), strict=True))
        new = a.fluid.of(CoolProp.HmassP_INPUTS, sums["delivered_h"] / sums["delivered"], a.p_d)
        change = max(*np.abs(end[:2] / y - 1.0), abs(new.h - back.h) / abs(ideal.h - a.sucked.h))
        y, back = end[:2], new
        if change < 100.0 * rtol:
            break
    else:
        raise ArithmeticError(f"not periodic after {most} lives: a state still changes by {change:.2g}")
    rate = a.omega * a.lobes / (2.0 * pi)
    indicated, flow = rate * sums["work"], rate * sums["sucked"]
    shaft = indicated + a.mechanical_fraction * abs(indicated)
    worth = flow * (ideal.h - a.sucked.h)
    found = {"indicated_power": indicated, "shaft_power": shaft, "gas_mass_flow": flow, "discharge_temperature": back.T}
    if a.backwards:
        at_closing = volume(a, LIFE - a.discharge[1])[0]
        filled = flow / (a.sucked.rho * at_closing * rate)
        return found | {"isentropic_efficiency": shaft / worth, "filling_factor": filled}
    swept = a.sucked.rho * a.V_max * rate
    found |= {"volumetric_efficiency": flow / swept, "trapped_mass": trapped}
    drawn = rate * sums["drawn"]
    if a.port is not None:  # M101
        worth += drawn * (a.fluid.of(CoolProp.PSmass_INPUTS, a.p_d, a.port.held.s).h - a.port.held.h)
    if a.liquid is not None:  # M43, M410
        cooling, heating = flow * (a.sucked.h - a.liquid.h), (flow + drawn) * (back.h - a.liquid.h)
        found |= {"heating_capacity": heating} | ({"cooling_capacity": cooling} if a.port is None else {})
    return found | {"isentropic_efficiency": worth / shaft, "drawn": drawn}
