"""One cylinder in plain Python, to be read beside docs/reference/slider-crank.md; nothing of screwsim is imported.

An independent second writing of the piston machine: S… are equations of that page, M… of docs/model.md. States are gas
mass and temperature, and lift and speed of the reeds; scipy's LSODA integrates turn after turn, with seats and stops
met as its own events, until a turn ends as it began. An ideal gas.

SI units; angles in rad from the top dead centre; a flow is positive into the cylinder.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import asin, cos, exp, expm1, log1p, pi, sin, sqrt

import numpy as np
from scipy.integrate import solve_ivp


@dataclass(frozen=True)
class Reed:
    """A reed and its port (S25, S27)."""

    area: float
    perimeter: float
    stop: float
    mass: float
    stiffness: float
    preload: float


@dataclass(frozen=True)
class Cylinder:
    """Everything that the equations ask for. `reeds` are those of suction and discharge, None: ideal valves (S22)."""

    bore: float
    crank: float
    rod: float
    offset: float
    clearance: float
    k: float
    R: float
    omega: float
    p_s: float
    T_s: float
    p_d: float
    mu: float  # flow coefficient of the valves
    areas: tuple[float, float]  # of ideal valves
    reeds: tuple[Reed, Reed] | None
    damping: float
    seat: float  # restitution
    stop: float
    force: float  # c_F
    ring: float  # μ π D δ of S28
    T_wall: float
    heat: tuple[float, float, float]  # a, b, c of S30; a = 0: no heat
    gas: tuple[float, float, float]  # λ, μ, Pr
    mechanical_fraction: float
    width: float  # of the regularised root, over the line's pressure

    @property
    def piston(self) -> float:
        """Area of the piston [m²]."""
        return 0.25 * pi * self.bore**2

    @property
    def top(self) -> float:
        """Crank angle at the top dead centre (S4)."""
        return asin(self.offset / (self.rod + self.crank))

    @property
    def bottom(self) -> float:
        """Angle from there to the bottom dead centre (S4)."""
        return pi + asin(self.offset / (self.rod - self.crank)) - self.top

    def position(self, alpha: float) -> float:
        """Return x [m], S1."""
        return self.crank * cos(alpha) + sqrt(self.rod**2 - (self.crank * sin(alpha) - self.offset) ** 2)

    @property
    def swept(self) -> float:
        """Swept volume [m³]."""
        return self.piston * (self.position(self.top) - self.position(self.top + self.bottom))


def volume(a: Cylinder, phi: float) -> float:
    """Return V [m³], S5."""
    return a.clearance + a.piston * (a.position(a.top) - a.position(phi + a.top))


def dV_dphi(a: Cylinder, phi: float) -> float:
    """Return dV/dφ [m³/rad], S5 with S2."""
    alpha = phi + a.top
    u = a.crank * sin(alpha) - a.offset
    return a.piston * (a.crank * sin(alpha) + a.crank * cos(alpha) * u / sqrt(a.rod**2 - u**2))


def nozzle(a: Cylinder, mu_S: float, p: float, T: float, p_low: float, eps: float) -> float:
    """Return ṁ [kg/s] from p, T to a lower pressure, M12 and M13; 0 against a higher one."""
    drop = p - p_low
    if drop <= 0.0 or mu_S <= 0.0:
        return 0.0
    x = min(drop / p, 1.0 - (2.0 / (a.k + 1.0)) ** (a.k / (a.k - 1.0)))
    bracket = exp(2.0 / a.k * log1p(-x)) * -expm1((a.k - 1.0) / a.k * log1p(-x))
    root = sqrt(2.0 * a.k / (a.k - 1.0) * p**2 / (a.R * T) * bracket)
    return mu_S * root * sqrt(drop / sqrt(drop**2 + eps**2))


def opening(a: Cylinder, reed: Reed, lift: float) -> float:
    """Return μ S [m²] of a reed, S27."""
    x = reed.perimeter * reed.stop / reed.area * max(lift, 0.0)
    return a.mu * reed.area * x / sqrt(1.0 + x * x)


def push(a: Cylinder, reed: Reed, drop: float, lift: float) -> float:
    """Return P of S25; `drop` is the pressure difference that opens."""
    scale = a.force * reed.area * abs(a.p_d - a.p_s) + reed.stiffness * reed.stop
    return (a.force * reed.area * drop - reed.preload - reed.stiffness * reed.stop * lift) / scale


def frequency(a: Cylinder, reed: Reed) -> float:
    """Return Ω [1/s] of S25."""
    return sqrt((a.force * reed.area * abs(a.p_d - a.p_s) / reed.stop + reed.stiffness) / reed.mass)


def wall_heat(a: Cylinder, V: float, m: float, T: float) -> float:
    """Return Q̇ [W], S29 and S30."""
    factor, b, c = a.heat
    conductivity, viscosity, prandtl = a.gas
    speed = a.swept / a.piston * a.omega / pi
    alpha = conductivity / a.bore * factor * (m / V * speed * a.bore / viscosity) ** b * prandtl**c
    return alpha * (2.0 * a.piston + 4.0 * V / a.bore) * (a.T_wall - T)


SUMS = ("work", "net", "out", "out_T", "heat", "suction_cost", "discharge_cost")
Rest = tuple[bool, bool]


def rates(phi: float, y: Sequence[float], a: Cylinder, T_d: float, rest: Rest) -> list[float]:
    """Return dy/dφ of (m, T, ξ_s, η_s, ξ_d, η_d) and of the sums; a reed at rest stays where it is (S33)."""
    m, T, c_v = y[0], y[1], a.R / (a.k - 1.0)
    c_p, V, dV = a.k * c_v, volume(a, phi), dV_dphi(a, phi)
    p = m * a.R * T / V
    eps_s, eps_d = a.width * a.p_s, a.width * a.p_d
    if a.reeds is None:
        suction, discharge = (a.mu * area for area in a.areas)
        back_s = back_d = 0.0
    else:
        suction, discharge = (opening(a, reed, lift) for reed, lift in zip(a.reeds, (y[2], y[4]), strict=True))
        back_s, back_d = nozzle(a, suction, p, T, a.p_s, eps_s), nozzle(a, discharge, a.p_d, T_d, p, eps_d)
    come = nozzle(a, suction + a.ring, a.p_s, a.T_s, p, eps_s)
    back_s += nozzle(a, a.ring, p, T, a.p_s, eps_s)
    out = nozzle(a, discharge, p, T, a.p_d, eps_d)
    heat = wall_heat(a, V, m, T) if a.heat[0] else 0.0
    leave, enthalpy = back_s + out, c_p * (come * a.T_s + back_d * T_d)
    dm = come + back_d - leave
    dT = ((enthalpy - c_p * T * leave - c_v * T * dm + heat) / a.omega - p * dV) / (m * c_v)  # M2
    moved = [0.0] * 4
    for i, drop in enumerate((a.p_s - p, p - a.p_d) if a.reeds is not None else ()):
        if not rest[i]:
            reed, (lift, speed) = a.reeds[i], y[2 + 2 * i : 4 + 2 * i]
            fast = frequency(a, reed)
            damped = 2.0 * a.damping * sqrt(reed.stiffness / reed.mass) * speed
            moved[2 * i : 2 * i + 2] = fast * speed / a.omega, (fast * push(a, reed, drop, lift) - damped) / a.omega
    sums = [-p * dV, (come - back_s) / a.omega, out / a.omega, out * T / a.omega, heat / a.omega]
    return [dm / a.omega, dT, *moved, *sums, max(a.p_s - p, 0.0) * max(dV, 0.0), max(p - a.p_d, 0.0) * max(-dV, 0.0)]


Event = Callable[..., float]


def events(a: Cylinder, rest: Rest) -> list[tuple[int, str, Event]]:
    """Return where a reed meets its seat or its stop, and where one at rest leaves: of which one, what, and when."""
    found: list[tuple[int, str, Event]] = []

    def met(i: int, what: str, at: Event, direction: float) -> None:
        at.terminal, at.direction = True, direction  # type: ignore[attr-defined]
        found.append((i, what, at))

    for i in range(2 if a.reeds is not None else 0):
        if rest[i]:
            met(i, "leaves", lambda phi, y, *_, i=i: pushed(a, phi, y, i) * (1.0 if y[2 + 2 * i] == 0.0 else -1.0), 1.0)
        else:
            met(i, "seat", lambda _, y, *__, i=i: y[2 + 2 * i], -1.0)
            met(i, "stop", lambda _, y, *__, i=i: y[2 + 2 * i] - 1.0, 1.0)
    return found


def pushed(a: Cylinder, phi: float, y: Sequence[float], i: int) -> float:
    """Return P of a reed, S25."""
    assert a.reeds is not None
    p = y[0] * a.R * y[1] / volume(a, phi)
    return push(a, a.reeds[i], a.p_s - p if i == 0 else p - a.p_d, y[2 + 2 * i])


def impact(a: Cylinder, phi: float, y: np.ndarray, i: int, what: str) -> bool:
    """Let a reed bounce (S26); return whether it stays, since it would rise by next to nothing (S33)."""
    seated = what == "seat"
    y[2 + 2 * i] = 0.0 if seated else 1.0
    y[3 + 2 * i] *= -(a.seat if seated else a.stop)
    P = pushed(a, phi, y, i)
    if (P < 0.0) == seated and 0.5 * y[3 + 2 * i] ** 2 <= 1e-9 * abs(P):
        y[3 + 2 * i] = 0.0
        return True
    return False


def turn(a: Cylinder, y: np.ndarray, T_d: float, rest: Rest, rtol: float) -> tuple[np.ndarray, Rest, float]:
    """Integrate one turn; return states and sums at its end, which reeds rest, and the mass at the bottom."""
    mass = a.p_s * a.swept / (a.R * a.T_s)
    scales = [1e-6 * mass, 1e-3, *[1e-2] * 4, 1e-2 * a.p_s * a.swept, *[1e-2 * mass] * 2, 1e-2 * mass * a.T_s]
    atol = rtol * np.array([*scales, *[1e-2 * a.p_s * a.swept] * 3])
    y, phi, trapped = np.concatenate([y, np.zeros(len(SUMS))]), 0.0, 0.0
    for end in (a.bottom, 2.0 * pi):
        while phi < end:
            of = events(a, rest)
            asked = [at for _, _, at in of] or None
            options = {"method": "LSODA", "rtol": rtol, "atol": atol, "max_step": 0.02}
            found = solve_ivp(rates, (phi, end), y, args=(a, T_d, rest), events=asked, **options)
            if not found.success:
                raise ArithmeticError(found.message)
            phi, y = float(found.t[-1]), found.y[:, -1].copy()
            for (i, what, _), when in zip(of, found.t_events or (), strict=True):
                if len(when):
                    stays = what != "leaves" and impact(a, phi, y, i, what)
                    rest = (stays, rest[1]) if i == 0 else (rest[0], stays)
        trapped = trapped or float(y[0])
    return y, rest, trapped


def figures(a: Cylinder, rtol: float = 1e-9, most: int = 60) -> dict[str, float]:
    """Repeat the turn until it ends as it began; return powers [W], flows [kg/s], temperatures [K] and λ."""
    T_d = a.T_s * (a.p_d / a.p_s) ** ((a.k - 1.0) / a.k)
    y, rest = np.array([a.p_d * a.clearance / (a.R * T_d), T_d, 0.0, 0.0, 0.0, 0.0]), (True, True)
    for _ in range(most):
        end, rest, trapped = turn(a, y, T_d, rest, rtol)
        sums = dict(zip(SUMS, end[6:].tolist(), strict=True))
        T_new = sums["out_T"] / sums["out"]
        change = max(*np.abs(end[:2] / y[:2] - 1.0), *np.abs(end[2:6] - y[2:]), abs(T_new / T_d - 1.0))
        y, T_d = end[:6], T_new
        if change < 50.0 * rtol:
            break
    else:
        raise ArithmeticError(f"not periodic after {most} turns: a state still changes by {change:.2g}")
    rate = a.omega / (2.0 * pi)
    indicated, gas = rate * sums["work"], rate * sums["net"]
    found = {
        "indicated_power": indicated,
        "shaft_power": indicated + a.mechanical_fraction * abs(indicated),
        "gas_mass_flow": gas,
        "volumetric_efficiency": gas / (a.p_s / (a.R * a.T_s) * a.swept * rate),
        "discharge_temperature": T_d,
        "trapped_mass": trapped,
        "suction_valve_power": rate * sums["suction_cost"],
        "discharge_valve_power": rate * sums["discharge_cost"],
    }
    return found | ({"wall_heat": rate * sums["heat"]} if a.heat[0] else {})
