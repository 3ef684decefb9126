"""Profiles in closed form: symmetric circular, and rack-generated asymmetric.

Source: theory of gearing (the common normal at a contact passes through the pitch point; Litvin & Fuentes 2004, ch. 6);
the two profiles are composed of its textbook cases: circle about the pitch point, rack of arcs and a straight line
(Stosic, Smith & Kovacevic 2005), circular tips. Formulas: docs/reference/rotors.md. Lengths in m, angles in rad.
"""

import math

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors.pair import Array, Chain, Pair
from screwsim.numerics.roots import bisected

POINTS = 801  # points per segment: areas and volumes are exact to 1e-6 (error ∝ POINTS⁻²); odd: one lies on a tip
Segment = tuple[Array, Array, Array]  # ψ, X, Y


def circular(pair: Pair, r4: float, points: int = POINTS) -> Chain:
    """Return the symmetric circular profile: male arc of radius ha about the pitch point, female tips of radius r4."""
    r2, Re, ha = pair.r2, pair.female_radius - r4, pair.addendum
    T = ha + r4
    ux = (T * T + r2 * r2 - Re * Re) / (2.0 * r2 * T)
    if abs(ux) >= 1.0:
        raise UsageError(
            "machine.profile: the male arc and the female tip do not touch (choose a smaller female_diameter)"
        )
    end = math.acos(ux)
    a = np.linspace(-end, end, points)
    arc = np.zeros(points), pair.r1 + ha * np.cos(a), ha * np.sin(a)
    trailing = female_tip(pair, r4, 0.0, (ux, math.sin(end)), points, far=r2 * ux <= T)
    leading = -trailing[0][::-1], trailing[1][::-1], -trailing[2][::-1]
    return join(pair, [leading, arc, trailing], points, lead=1, trail=2)


def rack(pair: Pair, r3: float, r4: float, rho: float, alpha: float, r5: float, points: int = POINTS) -> Chain:
    """Return the asymmetric profile: leading flank from a rack (arc r5, line at angle alpha, arc rho), trailing tips.

    r3, r4: radii of the male and of the female tip on the trailing side.
    """
    leading = rack_flank(pair, rho, alpha, r5, points)
    theta = _contact_of_tips(pair, r3, r4)
    psi = np.linspace(0.0, -theta, points)
    cx, cy = (pair.male_radius - r3) * np.cos(psi), -(pair.male_radius - r3) * np.sin(psi)
    distance = np.hypot(cx - pair.r1, cy)
    ux, uy = (cx - pair.r1) / distance, cy / distance
    tip = psi, cx + r3 * ux, cy + r3 * uy
    trailing = female_tip(pair, r4, -theta, (float(ux[-1]), float(uy[-1])), points)
    return join(pair, [*leading, tip, trailing], points, lead=3, trail=4)


def rack_flank(pair: Pair, rho: float, alpha: float, r5: float, points: int) -> list[Segment]:
    """Return the contact points of a rack of arc r5, straight line and arc rho, from root to tip (Y = −x dx/dy)."""
    g1 = 0.5 * math.pi - alpha
    length, yL = rack_line(pair, rho, alpha, r5)
    if length < 0.0:
        raise UsageError(
            "machine.profile: the arcs of the rack overlap (choose a smaller flank_radius or a larger pressure_angle)"
        )
    g = np.linspace(0.0, g1, points)
    root = r5 - pair.dedendum - r5 * np.cos(g), -yL + r5 * np.sin(g), np.tan(g)
    s = np.linspace(0.0, length, points)
    line = root[0][-1] + s * math.sin(g1), root[1][-1] + s * math.cos(g1), np.full(points, math.tan(g1))
    g = g[::-1]
    top = pair.addendum - rho + rho * np.cos(g), -rho * np.sin(g), np.tan(g)
    return [((y + x * slope) / pair.r1, pair.r1 + x, -x * slope) for x, y, slope in (root, line, top)]


def rack_line(pair: Pair, rho: float, alpha: float, r5: float) -> tuple[float, float]:
    """Return the length ℓ of the rack's straight line (negative: the arcs overlap) and the rack's width yL [m]."""
    g1 = 0.5 * math.pi - alpha
    height = pair.addendum - rho + rho * math.cos(g1) - r5 + pair.dedendum + r5 * math.cos(g1)
    length = height / math.sin(g1)
    return length, (rho + r5) * math.sin(g1) + length * math.cos(g1)


def _contact_of_tips(pair: Pair, r3: float, r4: float) -> float:
    """Return θ* [rad] by bisection: the male angle at which both tip arcs touch on a line through the pitch point."""
    centre, r1, r2, Re = pair.male_radius - r3, pair.r1, pair.r2, pair.female_radius - r4

    def gap(theta: float) -> float:
        cx = centre * math.cos(theta) - r1
        cy = centre * math.sin(theta)
        distance = math.hypot(cx, cy)
        return _tip_centre(r2, Re, cx / distance) - distance - r3 - r4

    low, high = 1e-6, 0.999 * 2.0 * pair.beta1
    first = gap(low)
    if first * gap(high) > 0.0:
        raise UsageError(
            "machine.profile: the male and the female tip never touch (choose smaller tip radii, "
            "or a larger female_diameter)"
        )
    return 0.5 * sum(bisected(lambda theta: first * gap(theta) > 0.0, low, high))


def _tip_centre(r2: float, Re: float, ux: float, far: bool = True) -> float:
    """Return t(u) [m]: distance of the female tip arc's centre from the pitch point in a direction with x-part ux.

    That direction meets the centre's circle twice, nearer to the pitch point where not `far`.
    """
    root = math.sqrt(max(r2 * r2 * ux * ux - r2 * r2 + Re * Re, 0.0))
    return r2 * ux + (root if far else -root)


def female_tip(pair: Pair, r4: float, start: float, u: tuple[float, float], points: int, far: bool = True) -> Segment:
    """Return the contact of a female tip arc of radius r4 from ψ = start (direction u from P) to the centre line."""
    r2, Re = pair.r2, pair.female_radius - r4
    if r4 <= pair.dedendum:
        raise UsageError(
            f"machine.profile.female_tip_radius: not above the female lobe's height of {pair.dedendum * 1e3:.4g} mm: "
            "undercut of the male flank (choose 1.25 times that height, or a smaller female_diameter)"
        )
    t = _tip_centre(r2, Re, u[0], far)
    eta_start = math.atan2(t * u[1], r2 - t * u[0])
    eta = eta_start * np.linspace(1.0, 0.0, points) ** 2  # dense at the end, where the direction to P turns fast
    psi = start + (eta_start - eta) / pair.k
    ex, ey = pair.centre_distance - Re * np.cos(eta), Re * np.sin(eta)
    distance = np.hypot(pair.r1 - ex, ey)
    return psi, ex + r4 * (pair.r1 - ex) / distance, ey - r4 * ey / distance


def join(pair: Pair, segments: list[Segment], points: int, lead: int, trail: int) -> Chain:
    """Return the chain of segments over one pitch, with half of the flat (female land on male root) at each end.

    `lead`, `trail`: indices of the segments that begin at S' and at S.
    """
    first, last = float(segments[0][0][0]), float(segments[-1][0][-1])
    flat = pair.pitch - (last - first)
    if flat < 0.0:
        raise UsageError(
            f"machine.profile: the lobe is {-flat * pair.r1 * 1e3:.3g} mm wider than the pitch, on the pitch circle "
            "(choose a smaller flank_radius or pressure_angle, fewer lobes, or a larger centre_distance)"
        )
    root = pair.r1 - pair.dedendum
    count = max(points // 8, 2)
    ends = []
    for begin, end in ((first - 0.5 * flat, first), (last, last + 0.5 * flat)):
        ends.append((np.linspace(begin, end, count), np.full(count, root), np.zeros(count)))
    parts = [ends[0], *segments, ends[1]]
    cut = [part if i == 0 else tuple(column[1:] for column in part) for i, part in enumerate(parts)]
    joints = tuple(int(j) for j in np.cumsum([len(part[0]) for part in cut]) - 1)
    psi, x, y = (np.concatenate(column) for column in zip(*cut, strict=True))
    return Chain(psi, x, y, joints[lead], joints[trail], (joints[0], joints[-2]), joints)
