"""A flooded screw in plain Python, with what plain.py leaves out of oil and gaps; nothing of screwsim is imported.

An independent second writing of oil that takes room (M106-M108), gaps with friction (M191), sealed by oil (M192,
M193) or full of it (M250-M257), the suction cusp and the line over the tip (M261-M263), droplets that slip (M154),
oil through bores (M30, M104) or from a pump (M194), a slide valve (M162), shafts that oil seals (M300), and a suction
line that keeps what flows back (M270, M271). M… are equations of docs/model.md. All chambers are integrated together
over one pitch by scipy's LSODA, and the pitch repeated until it ends as it began. An ideal gas.

SI units; angles in degrees of the male rotor; a flow is positive into the chamber.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import exp, expm1, log, log1p, log10, pi, radians, sqrt
from typing import NamedTuple

import numpy as np
from scipy.integrate import odeint

CLOSED = 360.0
# a0 to a10 and Re* of M191
RADIAL = (25932.107, 0.914825434, -177.588568, -0.237052788, -172347.611, -12.06876, -0.012886116, -151.202604)
RADIAL = (*RADIAL, -0.999674458, 0.016143504, 0.825533457, 5243.58)
FLANK = (-2.639703959, -0.567164431, 0.836554999, 0.810567168, 6174.02826, -7.609079625, -0.510200923, -1205.17483)
FLANK = (*FLANK, -1.029389142, 0.689497786, 1.096077351, 826.167)
FRICTION = {"radial": RADIAL, "flank": FLANK}
STATES = 4  # of a chamber: m, T, m_o, m_o T_o
SUMS = ("taken", "taken_oil", "back", "back_h", "back_oil", "back_oil_h", "out", "out_h", "out_oil", "out_oil_h")
SUMS += ("work", "injected", "injected_p", "dragged")


@dataclass(frozen=True)
class Gap:
    """A gap between a chamber and the one `ahead` pitches before it; area [m²] of the trailing chamber's angle."""

    area: Callable[[float], float]
    ahead: int
    mu: float = 0.7
    model: str = "nozzle"
    passage: float = 0.0
    clearance: float = 0.0
    rule: str = ""  # of friction or of the mixture's viscosity
    filled_from: float = 0.0
    wall_speed: float = 0.0


@dataclass(frozen=True)
class Machine:
    """Everything that the equations ask for."""

    lobes: int
    D: float
    V_max: float
    V_min: float
    phi_A: float
    suction: Callable[[float], float]
    discharge: Callable[[float], float]
    slot: Callable[[float], float]
    gaps: tuple[Gap, ...]
    breaks: tuple[float, ...]
    k: float
    R: float
    mu_gas: float
    rho_o: float
    c_o: float
    mu_o: float
    omega: float
    p_s: float
    T_s: float
    p_d: float
    T_inj: float
    bore: float  # diameter of the bore; 0: a pump
    ratio: float  # of the pump
    window: tuple[float, float]
    heat: tuple[float, float]  # of M154: 12 λ/(d² ρ_o), 0.3 (s u d/μ)^½ Pr^⅓
    shafts: tuple[float, float, float]  # μ A, clearance and passage
    mechanical_fraction: float
    width: float

    @property
    def pitch(self) -> float:
        """Return the lobe pitch [degree]."""
        return 360.0 / self.lobes


# Laws of the angle.


def bump(x: float, c: float) -> tuple[float, float]:
    """Return M15 and its slope."""
    if x <= 0.0 or x >= 2.0:
        return 0.0, 0.0
    if x < c:
        return x**2 / c, 2.0 * x / c
    if x <= 2.0 - c:
        return 1.0 + (x - 1.0) ** 2 / (c - 1.0), 2.0 * (x - 1.0) / (c - 1.0)
    return (x - 2.0) ** 2 / c, 2.0 * (x - 2.0) / c


def smooth(x: float) -> float:
    """Return the cubic from 0 to 1 of M23, M250 and M260."""
    x = min(1.0, max(0.0, x))
    return x * x * (3.0 - 2.0 * x)


def ramp(at: float, a: float, b: float, c: float, e: float) -> float:
    """Return M23."""
    return smooth((at - a) / (b - a)) * smooth((e - at) / (e - c))


# Flow.


class Place(NamedTuple):
    """A chamber or a line: p, T, ρ, oil per gas, T_o, and the gas's share of room (M107)."""

    p: float
    T: float
    rho: float
    x: float
    T_o: float
    beta: float


def place(a: Machine, p: float, T: float, x: float, T_o: float) -> Place:
    """Return a place of given pressure and temperature."""
    rho = p / (a.R * T)
    return Place(p, T, rho, x, T_o, 1.0 / (1.0 + x * rho / a.rho_o))


def nozzle(a: Machine, high: Place, low: Place, eps: float) -> float:
    """Return the flux [kg/(m² s)] of M12, M13."""
    k, drop = a.k, high.p - low.p
    if drop <= 0.0:
        return 0.0
    x = min(drop / high.p, 1.0 - (2.0 / (k + 1.0)) ** (k / (k - 1.0)))
    bracket = exp(2.0 / k * log1p(-x)) * -expm1((k - 1.0) / k * log1p(-x))
    return sqrt(2.0 * k / (k - 1.0) * high.p * high.rho * bracket * drop / sqrt(drop**2 + eps**2))


def sealed(a: Machine, gap: Gap, high: Place, flux: float) -> float:
    """Return the share of M192 with the viscosity of M193."""
    x = high.x
    beta = max(high.beta, 1.0 - high.beta)
    inertia = 1.0 / sqrt((1.0 + x) * beta)
    mcadams, cicchitti = (1.0 + x) / (1.0 / a.mu_gas + x / a.mu_o), (a.mu_gas + x * a.mu_o) / (1.0 + x)
    mu = mcadams if gap.rule == "mcadams" else cicchitti
    r = 12.0 * mu * gap.passage / ((1.0 + x) * inertia * flux * gap.clearance**2)
    return inertia / (sqrt(1.0 + r * r) + r)


def rubbed(a: Machine, gap: Gap, flux: float) -> float:
    """Return the share of M191."""
    c = FRICTION[gap.rule]
    Re = 2.0 * gap.clearance * flux / a.mu_gas
    weight = 1.0 / (1.0 + exp(-0.01 * (Re - c[11])))
    fast = c[4] * max(Re, 50.0) ** c[5] + c[6]
    slow = c[7] * Re ** c[8] + c[9]
    size = c[0] * (gap.passage / 5e-3) ** c[1] / (c[2] * gap.clearance / 1e-5 + c[3])
    return 1.0 / max(1.0, size * (weight * fast + (1.0 - weight) * slow) + c[10])


def gas_share(a: Machine, gap: Gap, high: Place, flux: float) -> float:
    """Return σ of M190."""
    if gap.model == "oil_sealed":
        return sealed(a, gap, high, flux)
    if gap.model == "nozzle_friction":
        return rubbed(a, gap, flux)
    return 1.0 - smooth(high.x / gap.filled_from) if gap.model == "oil_film" else 1.0


def film(a: Machine, gap: Gap, high: Place, low: Place) -> float:
    """Return the oil's flux [kg/(m² s)] through a full gap (M251, M252)."""
    drop = high.p - low.p
    creeping = a.rho_o * gap.clearance**2 * drop / (12.0 * a.mu_o * gap.passage)
    if drop <= 0.0:
        return 0.0
    return smooth(high.x / gap.filled_from) * 2.0 * creeping / (1.0 + sqrt(1.0 + 2.0 * creeping**2 / (a.rho_o * drop)))


def bores(a: Machine, drop: float) -> float:
    """Return the oil [kg/s] through a bore of two diameters' length (M30)."""
    if drop <= 0.0:
        return 0.0
    speed = sqrt(2.0 * drop / a.rho_o)
    Re = a.rho_o * a.bore * speed / a.mu_o
    resistance = 1.0 / (0.827 - 0.017) + 20.0 / Re * 5.5 - 0.01 / (1.0 + 7.5 * log10(0.00015 * Re) ** 2)
    return a.rho_o * pi * a.bore**2 / 4.0 * speed / resistance


# The balances.


class Rates:
    """Sums of one instant: of each chamber ṁ, Σ ṁ h, ṁ_o and d(m_o T_o)/dt, and of the lines."""

    def __init__(self, a: Machine, places: Sequence[Place], suction: Place, line: Place) -> None:
        self.a, self.places, self.lines = a, [*places, suction, line], len(places)
        self.chambers = [[0.0] * STATES for _ in places]
        self.sums = dict.fromkeys(SUMS, 0.0)

    def move(self, to: int, donor: int, gas: float, oil: float, dragged: bool = False) -> None:
        """Let gas and oil flow (M10, M108); the pressure of dragged oil does not heat it (M257)."""
        a, high, low = self.a, self.places[donor], self.places[to]
        h = a.R * a.k / (a.k - 1.0) * high.T
        fall = 0.0 if dragged else (high.p - low.p) / (a.rho_o * a.c_o)
        for at, sign, T_o in ((donor, -1.0, high.T_o), (to, 1.0, high.T_o + fall)):
            if at < self.lines:
                cell = self.chambers[at]
                cell[0] += sign * gas
                cell[1] += sign * gas * h
                cell[2] += sign * oil
                cell[3] += sign * oil * T_o
        s, oil_h = self.sums, oil * (a.c_o * high.T_o + high.p / a.rho_o)
        if donor == self.lines:
            s["taken"] += gas
            s["taken_oil"] += oil
        elif to >= self.lines:
            name = "back" if to == self.lines else "out"
            s[name] += gas
            s[f"{name}_h"] += gas * h
            s[f"{name}_oil"] += oil
            s[f"{name}_oil_h"] += oil_h
        if dragged:
            s["dragged"] += oil / a.rho_o * (low.p - high.p)

    def exchange(self, one: int, other: int, mu_S: float, eps: float, gap: Gap | None = None) -> None:
        """Let gas, its oil and a film flow between two places."""
        if mu_S <= 0.0:
            return
        a, donor, to = self.a, one, other
        if self.places[one].p < self.places[other].p:
            donor, to = other, one
        high, low = self.places[donor], self.places[to]
        flux = high.beta * nozzle(a, high, low, eps)
        if gap is not None and flux > 0.0:
            flux *= gas_share(a, gap, high, flux)
        self.move(to, donor, mu_S * flux, mu_S * flux * high.x)
        if gap is not None and gap.model == "oil_film":
            self.move(to, donor, 0.0, mu_S * film(a, gap, high, low))
            dragging = 0.5 * a.rho_o * gap.wall_speed * a.omega * a.D / 2.0
            full = smooth(self.places[other].x / gap.filled_from)  # from the chamber ahead (M256)
            self.move(one, other, 0.0, mu_S * full * dragging, dragged=True)


class Laws(NamedTuple):
    """What the angle of one chamber gives: volume [m³], its slope [m³/rad], areas of ports and gaps [m²]."""

    V: float
    dV: float
    suction: float
    discharge: float
    gaps: list[float]


@lru_cache(maxsize=1)  # an implicit integrator asks at one angle for many states
def laws(a: Machine, angle: float) -> list[Laws]:
    """Return the laws at all chambers, the youngest standing at an angle."""
    found = []
    for at in (angle + j * a.pitch for j in range(2 * a.lobes)):
        size, slope = bump(at / CLOSED, a.phi_A / CLOSED)
        ports = a.suction(at) + a.slot(at), a.discharge(at)
        gaps = [gap.mu * gap.area(at) for gap in a.gaps]
        found.append(Laws(a.V_min + a.V_max * size, a.V_max * slope / radians(CLOSED), *ports, gaps))
    return found


class Known(NamedTuple):
    """What a pitch finds and does not change: both lines, and the gas that the pump doses its oil for [kg]."""

    suction: Place
    line: Place
    trapped: float


def rates(y: np.ndarray, phi: float, a: Machine, known: Known) -> np.ndarray:
    """Return dy/dφ [1/rad] of all chambers and sums, the youngest standing at φ [rad]."""
    angle, count, c_v = phi * 180.0 / pi, 2 * a.lobes, a.R / (a.k - 1.0)
    cells, places, at_phi = y[: STATES * count].reshape(count, STATES).tolist(), [], laws(a, angle)
    for (m, T, m_o, warmth), law in zip(cells, at_phi, strict=True):
        V_g = law.V - m_o / a.rho_o  # M106
        places.append(Place(m * a.R * T / V_g, T, m / V_g, m_o / m, warmth / m_o, V_g / law.V))
    now = Rates(a, places, known.suction, known.line)
    eps_s, eps_d = a.width * a.p_s, a.width * a.p_d
    for j, (here, law) in enumerate(zip(places, at_phi, strict=True)):
        now.exchange(j, count, law.suction, eps_s)
        now.exchange(j, count + 1, law.discharge, eps_d)
        for gap, mu_S in zip(a.gaps, law.gaps, strict=True):
            ahead = j + gap.ahead if j + gap.ahead < count else count + 1  # beyond 720° lies the discharge line
            now.exchange(j, ahead, mu_S, 0.5 * a.width * (here.p + now.places[ahead].p), gap)
        inject(a, now, j, angle + j * a.pitch, known.trapped)
    found = []
    for (m, T, m_o, _), here, law, moved in zip(cells, places, at_phi, now.chambers, strict=True):
        gas, energy, oil, warmth = moved
        heat = a.heat[0] * (1.0 + a.heat[1] * sqrt(here.rho)) * m_o * (here.T_o - T)  # M154
        grows = law.dV - oil / (a.rho_o * a.omega)
        dT = ((energy - c_v * T * gas + heat) / a.omega - here.p * grows) / (m * c_v)  # M2
        found += [gas / a.omega, dT, oil / a.omega, (warmth - heat / a.c_o) / a.omega]
        now.sums["work"] -= here.p * law.dV * a.omega
    return np.array([*found, *(each / a.omega for each in now.sums.values())])


def inject(a: Machine, now: Rates, j: int, at: float, trapped: float) -> None:
    """Let oil enter a chamber: through a bore from p_d (M104), or from a pump (M194, M255)."""
    opens, closes = a.window
    share, here, cell = ramp(at, opens, opens + 10.0, closes - 10.0, closes), now.places[j], now.chambers[j]
    if share == 0.0:
        return
    drop = a.p_d - here.p
    if a.bore > 0.0:
        oil = share * bores(a, max(0.0, drop) ** 2 / sqrt(drop**2 + (a.width * a.p_d) ** 2))
    else:
        oil, drop = share * a.ratio * trapped * a.omega / radians(closes - opens - 10.0), max(0.0, drop)
    cell[2] += oil
    cell[3] += oil * (a.T_inj + drop / (a.rho_o * a.c_o))
    now.sums["injected"] += oil
    now.sums["injected_p"] += oil * here.p


# The periodic cycle and its figures.


def leak(a: Machine, known: Known) -> float:
    """Return the gas [kg/s] past the shafts (M274, M300)."""
    mu_S, clearance, passage = a.shafts
    if mu_S == 0.0:
        return 0.0
    gap = Gap(lambda _: 0.0, 0, model="oil_sealed", passage=passage, clearance=clearance, rule="mcadams")
    flux = known.line.beta * nozzle(a, known.line, known.suction, 0.0)
    return mu_S * flux * sealed(a, gap, known.line, flux)


def lines_after(a: Machine, known: Known, s: dict[str, float], trapped: float) -> tuple[Known, float]:
    """Return both lines as the sums of a pitch leave them (M27, M270, M271), and the fresh gas [kg]."""
    c_p, time = a.R * a.k / (a.k - 1.0), radians(a.pitch) / a.omega
    T_o = (s["out_oil_h"] / s["out_oil"] - a.p_d / a.rho_o) / a.c_o
    line = place(a, a.p_d, s["out_h"] / s["out"] / c_p, s["out_oil"] / s["out"], T_o)
    past = leak(a, known._replace(line=line)) * time
    back, oil = s["back"] + past, s["back_oil"] + past * line.x
    energy = s["back_h"] + past * c_p * line.T
    energy += s["back_oil_h"] + past * line.x * (a.c_o * T_o + a.p_d / a.rho_o)
    fresh = s["taken"] - back
    T = (fresh * c_p * a.T_s + energy - oil * a.p_s / a.rho_o) / ((fresh + back) * c_p + oil * a.c_o)
    return Known(place(a, a.p_s, T, oil / (fresh + back), T), line, trapped), fresh


def first_guess(a: Machine) -> np.ndarray:
    """Return states at the beginning of a pitch: suction until 360°, then the isotherm up to p_d."""
    cells: list[float] = []
    for j in range(2 * a.lobes):
        V, late = a.V_min + a.V_max * bump(j * a.pitch / CLOSED, a.phi_A / CLOSED)[0], j > a.lobes
        p = min(a.p_d, a.p_s * a.V_max / V) if late else a.p_s
        T = a.T_inj if late else a.T_s
        x = 1.0 if late else 0.02
        m = p * V / (a.R * T) / (1.0 + x * p / (a.R * T * a.rho_o))
        cells += [m, T, x * m, x * m * a.T_inj]
    return np.array(cells)


def one_pitch(a: Machine, y: np.ndarray, known: Known, rtol: float) -> np.ndarray:
    """Integrate all chambers over one pitch, from break to break; return states and sums at its end."""
    m = a.p_s * a.V_max / (a.R * a.T_s)
    atol = np.concatenate([rtol * np.tile([1e-4 * m, 1.0, 1e-3 * m, m], 2 * a.lobes), np.full(len(SUMS), 1e30)])
    now = np.concatenate([y, np.zeros(len(SUMS))])
    ends = sorted({0.0, a.pitch} | {round(each % a.pitch, 9) for each in a.breaks})
    for begin, end in pairwise(radians(each) for each in ends):
        settings = {"rtol": rtol, "atol": atol, "tcrit": [end], "mxstep": 10**5, "full_output": True}
        now, told = odeint(rates, now, [begin, end], (a, known), **settings)
        if told["message"] != "Integration successful.":
            raise ArithmeticError(told["message"])
        now = now[-1]
    return now


def figures(a: Machine, rtol: float = 1e-8, loosest: float = 1e-5, most: int = 200) -> dict[str, float]:
    """Return figures of the cycle whose pitch ends as it began; raise ArithmeticError when none is found."""
    y, now, count = first_guess(a), loosest, STATES * 2 * a.lobes
    rho_s = a.p_s / (a.R * a.T_s)
    known = Known(place(a, a.p_s, a.T_s, 0.0, a.T_inj), place(a, a.p_d, a.T_inj, 1.0, a.T_inj), rho_s * a.V_max)
    for _ in range(most):
        end = one_pitch(a, y, known, now)
        sums = dict(zip(SUMS, end[count:].tolist(), strict=True))
        new = np.roll(end[:count].reshape(-1, STATES), 1, axis=0)
        change = np.abs(new - y.reshape(-1, STATES)) / np.maximum(np.abs(new), 1e-3 * new[:, :1])
        known, fresh = lines_after(a, known, sums, float(new[a.lobes, 0]))
        y = new.ravel()
        if change.max() <= 20.0 * now:
            if now <= rtol:
                return results(a, sums, fresh, known)
            now = rtol
    raise ArithmeticError(f"not periodic after {most} pitches: a state still changes by {change.max():.2g}")


def results(a: Machine, s: dict[str, float], fresh: float, known: Known) -> dict[str, float]:
    """Return powers [W], flows [kg/s], temperatures [K] and efficiencies (M25-M36, M105, M257)."""
    rate, ratio = a.omega / radians(a.pitch), a.p_d / a.p_s
    gas, indicated, dragged = rate * fresh, rate * s["work"], rate * s["dragged"]
    shaft = indicated + dragged + a.mechanical_fraction * abs(indicated)
    c_p = a.R * a.k / (a.k - 1.0)
    return {
        "isothermal_efficiency": gas * a.R * a.T_s * log(ratio) / shaft,
        "isentropic_efficiency": gas * c_p * a.T_s * (ratio ** (a.R / c_p) - 1.0) / shaft,
        "volumetric_efficiency": gas / (a.p_s / (a.R * a.T_s) * a.V_max * rate),
        "gas_mass_flow": gas,
        "oil_mass_flow": rate * s["injected"],
        "injection_pressure": s["injected_p"] / s["injected"],
        "indicated_power": indicated,
        "shaft_power": shaft,
        "discharge_temperature": known.line.T,
        "oil_discharge_temperature": known.line.T_o,
        "intake_temperature": known.suction.T,
        "trapped_mass": known.trapped,
    }
