"""The equations of Chernov et al. 2015 in plain Python, to be read beside the paper; nothing of screwsim is imported.

An independent second writing of the model: numbers in brackets, as (10), are the paper's equations, with its misprints
mended as docs/model.md lists them; M20 and the like are equations of docs/model.md where the paper has none. States,
first law, integrator, closing and quadratures are other ones than the package's: gas mass and temperature by the
paper's own (5), (8), (10), (14), the 2 z chambers that are alive at once integrated together over one lobe pitch by
scipy's LSODA, and the pitch repeated until it ends as it began.

SI units; angles in rad, in the laws in degrees of the male rotor; a flow is positive into the chamber.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import exp, expm1, log, log1p, pi, sqrt

import numpy as np
from scipy.integrate import solve_ivp

LIFE = 720.0  # [degree] suction, compression and discharge of one chamber
INJECTION = 360.0  # [degree]


@dataclass(frozen=True)
class Machine:
    """Everything that the equations ask for; SI, but angles of the laws in degrees."""

    lobes: int
    D: float
    V_max: float
    V_min: float
    phi_A: float
    S_suc: float
    phi_B: float
    S_dis: float
    phi_dis: float
    phi_C: float
    k: float
    R: float
    rho_oil: float
    c_oil: float
    carried: bool  # oil moves with the leaks (M8-M10); else the paper's constant ratio
    omega: float
    p_s: float
    T_s: float
    p_d: float
    d: float
    T_inj: float
    mu_port: float
    mu_gap: float
    h_tip: float
    h_interlobe: float
    l_interlobe: float
    A_blow_hole: float
    h_end_face: float
    l_end_face: float
    suction_share: float
    r: float
    alpha: float
    pump_efficiency: float
    pump_loss: float
    acceleration_factor: float
    mechanical_fraction: float
    width: float  # widths of the regularised root over the pressure of the line (M12)

    @property
    def pitch(self) -> float:
        """Return the lobe pitch [degree]."""
        return 360.0 / self.lobes

    @property
    def alive(self) -> int:
        """Return how many chambers are alive at once."""
        return 2 * self.lobes


# Laws of the angle [degree].


def bump(x: float, c: float) -> float:
    """Return the common form of (16), (17) and of (18) as corrected."""
    if not 0.0 < x < 2.0:
        return 0.0
    if x < c:
        return x**2 / c
    if x < 2.0 - c:
        return 1.0 + (x - 1.0) ** 2 / (c - 1.0)
    return (x - 2.0) ** 2 / c


def bump_slope(x: float, c: float) -> float:
    """Return its derivative by x."""
    if not 0.0 < x < 2.0:
        return 0.0
    if x < c:
        return 2.0 * x / c
    if x < 2.0 - c:
        return 2.0 * (x - 1.0) / (c - 1.0)
    return 2.0 * (x - 2.0) / c


def volume(a: Machine, phi: float) -> float:
    """Return V [m³], (16) and the dead volume."""
    return a.V_min + a.V_max * bump(phi / 360.0, a.phi_A / 360.0)


def dV_dphi(a: Machine, phi: float) -> float:
    """Return dV/dφ [m³/rad], (7), (13)."""
    return a.V_max * bump_slope(phi / 360.0, a.phi_A / 360.0) / (2.0 * pi)


def suction_area(a: Machine, phi: float) -> float:
    """Return S [m²], (17)."""
    return a.S_suc * bump(phi / 180.0, a.phi_B / 180.0)


def discharge_area(a: Machine, phi: float) -> float:
    """Return S [m²], (18) with its middle branch corrected."""
    half = (LIFE - a.phi_dis) / 2.0
    return a.S_dis * bump((phi - a.phi_dis) / half, (a.phi_C - a.phi_dis) / half)


def tip_area(a: Machine, phi: float) -> float:
    """Return S [m²] to the chamber a pitch ahead: half of (19) in the middle of both, M260."""
    middle, born = (phi + 0.5 * a.pitch) / 360.0, min(1.0, phi / 20.0)
    half = 0.5 * 9.83 * a.h_tip * a.D * max(0.0, min(middle, 2.0 - middle))
    return half * born * born * (3.0 - 2.0 * born)


def interlobe_area(a: Machine, phi: float) -> float:
    """Return S [m²] to the chamber 360° ahead, M20."""
    if phi >= 360.0:
        return 0.0
    return a.h_interlobe * a.l_interlobe * max(0.0, min(1.0, phi / 60.0, (360.0 - phi) / 130.0))


def ramp(phi: float, a: float, b: float, c: float, e: float) -> float:
    """Return M23: from 0 at a to 1 at b, and from 1 at c to 0 at e [degree]."""
    if not a < phi < e:
        return 0.0
    x = min(1.0, (phi - a) / (b - a), (e - phi) / (e - c))
    return x * x * (3.0 - 2.0 * x)


def blow_hole_area(a: Machine, phi: float) -> float:
    """Return S [m²] to the chamber a pitch ahead, M21."""
    return a.A_blow_hole * ramp(phi + a.pitch, 373.0, 393.0, 673.0, 693.0)


def end_face_area(a: Machine, phi: float, ahead: int) -> float:
    """Return S [m²] to the chamber so many pitches ahead, M22."""
    share = a.suction_share if ahead == a.lobes else 1.0 - a.suction_share
    return a.h_end_face * a.l_end_face * share * ramp(phi + ahead * a.pitch, 360.0, 380.0, 700.0, 720.0)


@dataclass(frozen=True, slots=True)
class Laws:
    """What the angle of one chamber gives: volume [m³], its slope [m³/rad], areas [m²]."""

    V: float
    dV: float
    suction: float
    discharge: float
    tip: float
    other: float  # blow hole and end face, to the chamber a pitch ahead
    across: float  # interlobe gap and end face, to the chamber 360° ahead


@lru_cache(maxsize=1)  # an implicit integrator asks at one angle for many states
def laws(a: Machine, phi: float) -> list[Laws]:
    """Return the laws at all chambers, the youngest standing at φ [degree]."""
    found = []
    for j in range(a.alive):
        at = phi + j * a.pitch
        across = interlobe_area(a, at) + end_face_area(a, at, a.lobes) if j < a.lobes else 0.0
        other = blow_hole_area(a, at) + end_face_area(a, at, 1)
        ports = suction_area(a, at), discharge_area(a, at)
        found.append(Laws(volume(a, at), dV_dphi(a, at), *ports, tip_area(a, at), other, across))
    return found


# Flow.


@dataclass(slots=True)
class Place:
    """A chamber or a line, as a nozzle sees it, and the sums of what flows into it [kg/s], [K kg/s]."""

    p: float
    T: float
    oil_ratio: float = 0.0
    T_oil: float = 0.0
    out: float = 0.0  # Σ ṁ_j, negative
    come: float = 0.0  # Σ ṁ_i
    come_T: float = 0.0  # Σ ṁ_i T_i
    oil: float = 0.0  # Σ ṁ_o
    oil_come: float = 0.0  # Σ ṁ_o,i of what comes
    oil_come_T: float = 0.0  # Σ ṁ_o,i T_o,i

    def leave(self, flow: float) -> None:
        """Let a flow [kg/s] leave, with the oil that belongs to it."""
        self.out -= flow
        self.oil -= flow * self.oil_ratio

    def receive(self, flow: float, donor: Place) -> None:
        """Let a flow [kg/s] of the donor's gas and oil come."""
        self.come += flow
        self.come_T += flow * donor.T
        self.oil += flow * donor.oil_ratio
        self.oil_come += flow * donor.oil_ratio
        self.oil_come_T += flow * donor.oil_ratio * donor.T_oil


def nozzle(a: Machine, mu_S: float, high: Place, low: Place, eps: float) -> float:
    """Return ṁ [kg/s] from high to low, (3), (4), with choking (M13) and the root's stated width eps [Pa] (M12)."""
    k, drop = a.k, high.p - low.p
    critical = (2.0 / (k + 1.0)) ** (k / (k - 1.0))
    x = min(drop / high.p, 1.0 - critical)  # 1 - p_low/p_high
    # (p_l/p_h)^(2/k) - (p_l/p_h)^((k+1)/k), written so that nothing cancels at small x
    bracket = exp(2.0 / k * log1p(-x)) * -expm1((k - 1.0) / k * log1p(-x))
    root = sqrt(2.0 * k / (k - 1.0) * high.p**2 / (a.R * high.T) * bracket)
    return mu_S * root * sqrt(drop / sqrt(drop**2 + eps**2))


def exchange(a: Machine, mu_S: float, one: Place, other: Place, eps: float) -> float:
    """Let gas flow between two places; return ṁ [kg/s] into the first."""
    if mu_S <= 0.0 or one.p == other.p:
        return 0.0
    high, low = (one, other) if one.p > other.p else (other, one)
    flow = nozzle(a, mu_S, high, low, eps)
    high.leave(flow)
    low.receive(flow, high)
    return flow if low is one else -flow


@dataclass
class Line:
    """What the discharge line gives back: the mean of what flowed into it (M27)."""

    T: float
    oil_ratio: float = 0.0
    T_oil: float = 0.0


STATES = 4  # of a chamber: m, T, T_oil, m_oil
SUMS = ("work", "net_suction", "out", "out_T", "oil_out", "oil_out_T")


def all_flows(a: Machine, found: Sequence[Laws], places: Sequence[Place], suction: Place, line: Place) -> float:
    """Let all flows at once happen, with the laws of all chambers; return the net one from suction."""
    eps_s, eps_d = a.width * a.p_s, a.width * a.p_d
    net = 0.0
    for j, (here, area) in enumerate(zip(places, found, strict=True)):
        net += exchange(a, a.mu_port * area.suction, here, suction, eps_s)
        exchange(a, a.mu_port * area.discharge, here, line, eps_d)
        ahead = places[j + 1] if j + 1 < a.alive else line  # beyond 720° lies the discharge line
        between = 0.5 * a.width * (here.p + ahead.p)
        exchange(a, a.mu_gap * area.tip, here, ahead, between)
        exchange(a, a.mu_gap * area.other, here, ahead, between)
        if j < a.lobes:
            across = places[j + a.lobes]
            exchange(a, a.mu_gap * area.across, here, across, 0.5 * a.width * (here.p + across.p))
    return net


# The balances.


def rates(a: Machine, phi: float, y: Sequence[float], known: Line) -> list[float]:
    """Return dy/dφ [1/rad] of all chambers and sums, the youngest chamber standing at φ [degree]."""
    omega, k, c_v = a.omega, a.k, a.R / (a.k - 1.0)
    heat = 3.0 * a.alpha / (a.r * a.rho_oil)
    suction, line = Place(a.p_s, a.T_s), Place(a.p_d, known.T, known.oil_ratio, known.T_oil)
    places, at_phi = [], laws(a, phi)
    for j, law in enumerate(at_phi):
        m, T, T_oil, m_oil = y[STATES * j : STATES * (j + 1)]
        places.append(Place(m * a.R * T / law.V, T, m_oil / m if a.carried else 0.0, T_oil))
    net_suction = all_flows(a, at_phi, places, suction, line)

    found, work = [], 0.0
    for j, (here, law) in enumerate(zip(places, at_phi, strict=True)):
        at = phi + j * a.pitch
        m, T, T_oil, m_oil = y[STATES * j : STATES * (j + 1)]
        V, dV = law.V, law.dV
        oiled = a.carried or at >= INJECTION
        d = (m_oil / m if a.carried else a.d) if oiled else 0.0
        dm = (here.come + here.out) / omega  # (8), (14)
        dT = (  # (10); without the first term (5)
            heat * d / c_v * (T_oil - T) / omega
            + (k - 1.0) * T / m * here.out / omega
            + (k * here.come_T - T * here.come) / (m * omega)
            - (k - 1.0) * T / V * dV
        )
        dT_oil = heat / (a.c_oil * omega) * (T - T_oil) if oiled else 0.0  # (2); (12) has a factor d too many
        dm_oil = 0.0
        if a.carried:  # M8; what comes mixes, M4
            dm_oil = here.oil / omega
            dT_oil += (here.oil_come_T - here.oil_come * T_oil) / (m_oil * omega)
        work -= here.p * dV  # (9), (15), of the gas on the rotors with the other sign
        found += [dm, dT, dT_oil, dm_oil]
    found += [work, net_suction / omega, line.come / omega, line.come_T / omega]
    return [*found, line.oil_come / omega, line.oil_come_T / omega]


def injected(a: Machine, m: float, m_oil: float, T_oil: float) -> tuple[float, float, float]:
    """Return (oil injected [kg], oil [kg], its temperature [K]) of a chamber that passes 360° (M9)."""
    if not a.carried:
        return a.d * m, a.d * m, a.T_inj
    added = max(0.0, a.d * m - m_oil)
    return added, m_oil + added, (m_oil * T_oil + added * a.T_inj) / (m_oil + added)


def shifted(a: Machine, y: Sequence[float]) -> tuple[list[float], float]:
    """Return the states in which the next pitch begins, and the oil injected [kg]."""
    cells = [list(y[STATES * j : STATES * (j + 1)]) for j in range(a.alive)]
    cells = [cells[-1], *cells[:-1]]  # each takes the place of the one ahead of it; (16): the rest at 720° begins anew
    m, T, T_oil, m_oil = cells[a.lobes]
    added, m_oil, T_oil = injected(a, m, m_oil, T_oil)
    cells[a.lobes] = [m, T, T_oil, m_oil]
    if not a.carried:
        for cell in cells[: a.lobes]:
            cell[2:] = [a.T_inj, 0.0]  # no oil before 360°
    return [value for cell in cells for value in cell], added


def first_guess(a: Machine) -> list[float]:
    """Return states at the beginning of a pitch: suction until 360°, then the isentrope up to p_d."""
    cells: list[float] = []
    for j in range(a.alive):
        V, closed = volume(a, j * a.pitch), volume(a, INJECTION)
        ratio = 1.0 if j <= a.lobes else min(a.p_d / a.p_s, (closed / V) ** a.k)
        T = a.T_s * ratio ** ((a.k - 1.0) / a.k)
        m = a.p_s * ratio * V / (a.R * T)
        oil = a.d * m if j >= a.lobes else 0.01 * m * a.carried
        cells += [m, T, a.T_inj, oil]
    return cells


def one_pitch(a: Machine, y: Sequence[float], line: Line, rtol: float) -> np.ndarray:
    """Integrate all chambers over one pitch; return states and sums at its end."""
    m_scale = a.p_s * a.V_max / (a.R * a.T_s)
    sums = np.array([a.p_d * a.V_max, m_scale, m_scale, m_scale * a.T_s, m_scale, m_scale * a.T_s])
    atol = rtol * np.concatenate([np.tile([1e-6 * m_scale, 1.0, 1.0, 1e-6 * m_scale], a.alive), sums])
    solved = solve_ivp(
        lambda x, now: rates(a, np.degrees(x), now.tolist(), line),
        (0.0, np.radians(a.pitch)),
        np.concatenate([y, np.zeros(len(SUMS))]),
        method="LSODA",
        rtol=rtol,
        atol=atol,
        t_eval=[np.radians(a.pitch)],
    )
    if not solved.success:
        raise ArithmeticError(solved.message)
    return solved.y[:, -1]


# The periodic cycle and its figures.


@dataclass(frozen=True)
class Cycle:
    """What one periodic pitch gave: sums over it (of one chamber's life) and the state at 360°."""

    sums: dict[str, float]
    m_360: float
    p_360: float
    oil_injected: float
    pitches: int
    change: float


def line_after(a: Machine, sums: dict[str, float]) -> Line:
    """Return the discharge line's state: the mean of what flowed out (M27)."""
    T = sums["out_T"] / sums["out"]
    if not a.carried:
        return Line(T)
    return Line(T, sums["oil_out"] / sums["out"], sums["oil_out_T"] / sums["oil_out"])


def largest_change(a: Machine, before: Sequence[float], after: Sequence[float]) -> float:
    """Return the largest relative change of a state; oil counts as at least a thousandth of the gas."""
    old, new = (np.reshape(values, (a.alive, STATES)) for values in (before, after))
    scale = np.array(new)
    scale[:, 3] = np.maximum(new[:, 3], 1e-3 * new[:, 0])
    return float(np.max(np.abs(new - old) / scale))


def close(a: Machine, rtol: float = 1e-8, loosest: float = 1e-5, most: int = 200) -> Cycle:
    """Repeat the pitch until it ends as it began; raise ArithmeticError when it does not.

    Closed are states of all chambers that one pitch changes by no more than 50 rtol. The tolerance of the integration
    is the loosest until they have changed by no more than 50 times that.
    """
    y, line = first_guess(a), Line(a.T_s * (a.p_d / a.p_s) ** (0.5 * (a.k - 1.0) / a.k), a.d * a.carried, a.T_inj)
    now = loosest
    for pitch in range(1, most + 1):
        end = one_pitch(a, y, line, now)
        sums = dict(zip(SUMS, end[STATES * a.alive :].tolist(), strict=True))
        m, T = end[STATES * (a.lobes - 1) : STATES * (a.lobes - 1) + 2].tolist()
        before = y
        y, added = shifted(a, end.tolist())
        line, change = line_after(a, sums), largest_change(a, before, y)
        if change <= 50.0 * now and now <= rtol:
            return Cycle(sums, m, m * a.R * T / volume(a, INJECTION), added, pitch, change)
        if change <= 50.0 * now:
            now = rtol
    raise ArithmeticError(f"not periodic after {most} pitches: a state still changes by {change:.2g}")


def figures(a: Machine, cycle: Cycle) -> dict[str, float]:
    """Return powers [W], flows [kg/s], temperatures [K] and efficiencies of a periodic cycle (M25-M36)."""
    per_second = a.omega / np.radians(a.pitch)  # lives that end
    gas, oil = per_second * cycle.sums["net_suction"], per_second * cycle.oil_injected
    indicated = per_second * cycle.sums["work"]
    lift = oil / a.rho_oil * (a.p_d - cycle.p_360)
    delivered = max(cycle.p_360, a.p_d) + a.pump_loss  # the pump draws from the separator, at p_d
    pump = oil / a.rho_oil / a.pump_efficiency * max(0.0, delivered - a.p_d)
    hydromechanical = a.acceleration_factor * oil * (a.omega * a.D / 2.0) ** 2
    mechanical = a.mechanical_fraction * abs(indicated)
    shaft = indicated + lift + pump + hydromechanical + mechanical
    c_p, ratio = a.R * a.k / (a.k - 1.0), a.p_d / a.p_s
    isentropic = c_p * a.T_s * (ratio ** ((a.k - 1.0) / a.k) - 1.0)
    return {
        "isothermal_efficiency": gas * a.R * a.T_s * log(ratio) / shaft,
        "isentropic_efficiency": gas * isentropic / shaft,
        "volumetric_efficiency": gas / (a.p_s / (a.R * a.T_s) * a.V_max * per_second),
        "gas_mass_flow": gas,
        "oil_mass_flow": oil,
        "indicated_power": indicated,
        "oil_lift_power": lift,
        "oil_pump_power": pump,
        "hydromechanical_power": hydromechanical,
        "mechanical_power": mechanical,
        "shaft_power": shaft,
        "discharge_temperature": cycle.sums["out_T"] / cycle.sums["out"],
        "work_per_cycle": cycle.sums["work"],
        "trapped_mass": cycle.m_360,
    }
