"""Checks whether a pair of rotors is possible: undercut, self-intersection, thin lobes, interference; with remedies.

The checks look only at the polygons of both rotors, so they do not depend on how the chain was made. Lengths in m,
angles in rad.
"""

import math
from collections.abc import Sequence

import numpy as np

from screwsim.inputs.faults import Fault
from screwsim.machine.rotors.flanks import female_flanks, male_flanks
from screwsim.machine.rotors.pair import Array, Chain, Pair, outline, outlines

PATH = "machine.profile"
THIN = 0.01  # thickness over centre distance below which a lobe is refused
SEEN = 2e-4  # step along a curve over the outer radius (10 µm at 50 mm)
OTHER_SIZE = 2e-3  # relative error of the outer radius allowed to points, whose tip may be cut or rounded
SCALED = "to change the size of a machine, scale all lengths of its profile"
NEAR = 1e-2  # search radius over the centre distance for points that lie no nearer than the steps of the curves
DEEP = 1e-4  # interference over centre distance above which is refused (8 µm at 80 mm; closed forms: 1e-7)
DEEPER = 3.0  # further interference allowed to measured points, over their tolerance
OPEN = 3e-3  # relative difference of swept and enclosed areas above which points are refused: V_max errs about as much
OF_POINTS = "set machine.profile.tolerance to 3 to 5 times the noise of the points, or give more points there"


def check_pair(pair: Pair) -> list[Fault]:
    """Return the faults of the main dimensions, which need no profile."""
    A, R1, R2 = pair.centre_distance, pair.male_radius, pair.female_radius
    what = ""
    if R1 + R2 <= A:
        what = "the rotors do not mesh (choose a smaller one"
    elif pair.addendum <= 0.0 or pair.dedendum < 0.0:
        what = "a tip lies inside its pitch circle (choose a smaller one"
    elif R1 >= A or R2 >= A:
        what = "it lies inside a rotor and leaves no shaft (choose a larger one"
    if not what:
        return []
    sizes = f"{1e3 * A:.6g} mm with rotors of {2e3 * R1:.6g} mm and {2e3 * R2:.6g} mm"
    return [Fault(f"{PATH}.centre_distance", f"{sizes}: {what}; {SCALED})")]


def check_size(pair: Pair, chain: Chain) -> list[Fault]:
    """Return the fault of points whose lobe belongs to a rotor of another outer diameter."""
    reach = float(np.max(np.hypot(*chain.male)))
    if abs(reach - pair.male_radius) <= OTHER_SIZE * pair.male_radius:
        return []
    what = f"{2e3 * pair.male_radius:.6g} mm, and the points of machine.profile.file reach to {2e3 * reach:.6g} mm"
    return [Fault("machine.rotor_diameter", f"is {what} (write that; {SCALED})")]


def check_profile(pair: Pair, chain: Chain, interference: bool = True, tolerance: float | None = None) -> list[Fault]:
    """Return the faults of the rotors: undercut, self-intersection, thin lobes and, if asked for, interference.

    `tolerance` [m]: that of measured points; None: the profile is a closed form, whose radii can be chosen.
    """
    faults, female_turn, points = [], -2.0 * math.pi / pair.female_lobes, tolerance is not None
    for name, curve, turn in (("male", chain.male, pair.pitch), ("female", chain.female(pair), female_turn)):
        back = reversals(*curve)
        if len(back):
            remedy = (
                OF_POINTS
                if points
                else "choose a larger female_tip_radius; 1.25 times the female lobe's height is safe"
            )
            place = f"where it meets the male lobe at a radius of {1e3 * chain.male_radii[back[0]]:.4g} mm"
            faults.append(Fault(PATH, f"the {name} flank turns back: undercut, {place} ({remedy})"))
        elif crosses_itself(*curve, turn):
            remedy = OF_POINTS if points else "choose larger tip radii or fewer lobes"
            faults.append(Fault(PATH, f"the {name} profile crosses itself ({remedy})"))
    if faults:
        return faults  # the checks below would only repeat them
    faults = _thin(pair, chain, points)
    if interference:
        depth, most = mesh(pair, chain)[1], DEEP * pair.centre_distance + DEEPER * (tolerance or 0.0)
        if depth > most:
            what = f"the rotors cut into each other by {depth * 1e3:.3g} mm, and {most * 1e3:.2g} mm is the limit"
            faults.append(Fault(PATH, f"{what} ({OF_POINTS if points else 'choose a smaller male_tip_radius'})"))
    return faults


def check_blow_holes(*areas: float) -> list[Fault]:
    """Return the fault of blow-holes [m²] without an area, where the end of contact at the tip was not found."""
    if min(areas) > 0.0:
        return []
    what = f"a blow-hole would have an area of {min(areas) * 1e6:.3g} mm²: the contact at the tip is lost in noise"
    return [Fault(PATH, f"{what} ({OF_POINTS})")]


def check_swept(swept: float, grooves: float) -> list[Fault]:
    """Return the fault of points whose contact has gaps: of areas [m²] that the rotors sweep, and that they leave."""
    differ = swept / grooves - 1.0
    if abs(differ) <= OPEN:
        return []
    what = f"the areas that the rotors sweep differ from those of their grooves by {100.0 * abs(differ):.2g} %"
    return [Fault(PATH, f"{what}: stretches of the contact are lost in noise ({OF_POINTS})")]


def reversals(x: Array, y: Array) -> Array:
    """Return the indices at which a curve turns by more than a right angle; loops shorter than `SEEN` are ignored."""
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    first = np.unique((way / (SEEN * np.hypot(x, y).max())).astype(int), return_index=True)[1]
    dx, dy = np.diff(x[first]), np.diff(y[first])
    return first[1:-1][dx[1:] * dx[:-1] + dy[1:] * dy[:-1] < 0.0]


def crosses_itself(x: Array, y: Array, turn: float, points: int = 250) -> bool:
    """Tell whether the outline of a pitch crosses itself or its neighbours."""
    stride = max(len(x) // points, 1)
    px, py = np.append(x[:-1:stride], x[-1]), np.append(y[:-1:stride], y[-1])
    ax, ay = outline(px, py, 2, turn)  # this pitch and the next
    p, q = np.column_stack([ax, ay]), np.column_stack([np.append(ax[1:], np.nan), np.append(ay[1:], np.nan)])
    p, q = p[:-1], q[:-1]
    d, own = q - p, len(p) // 2 + 1  # steps of this pitch, against both; the next against itself would be the same
    low, high = np.minimum(p, q), np.maximum(p, q)
    meet = (low[:own, None, 0] <= high[None, :, 0]) & (low[None, :, 0] <= high[:own, None, 0])
    i, j = np.nonzero(meet & (low[:own, None, 1] <= high[None, :, 1]) & (low[None, :, 1] <= high[:own, None, 1]))
    far = np.abs(i - j) > 1
    i, j = i[far], j[far]  # steps whose boxes meet and that are not neighbours
    a, one, two = p[j] - p[i], d[i], d[j]
    cross = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (a[:, 0] * two[:, 1] - a[:, 1] * two[:, 0]) / cross
        t = (a[:, 0] * one[:, 1] - a[:, 1] * one[:, 0]) / cross
    return bool(np.any((s > 1e-9) & (s < 1.0 - 1e-9) & (t > 1e-9) & (t < 1.0 - 1e-9)))


def lobe_thickness(pair: Pair, chain: Chain) -> tuple[float, float]:
    """Return the least thickness [m] of the male lobe below nine tenths of its height, and of the female lobe."""
    male, female = male_flanks(pair, chain), female_flanks(pair, chain)
    body = male.radii < male.radii[-1] - 0.1 * (male.radii[-1] - male.radii[0])
    land = pair.k * (pair.pitch - chain.land_start + chain.land_end) * pair.female_radius
    return float(np.min((male.radii * male.inner)[body])), min(float(np.min(female.radii * female.outer)), land)


def _thin(pair: Pair, chain: Chain, points: bool) -> list[Fault]:
    least, faults = THIN * pair.centre_distance, []
    remedies = {"male": "a larger flank_radius", "female": "a smaller flank_radius or pressure_angle"}
    if points:
        remedies = dict.fromkeys(remedies, "other points")
    for (name, remedy), thickness in zip(remedies.items(), lobe_thickness(pair, chain), strict=True):
        if thickness < least:
            what = f"the {name} lobe is only {thickness * 1e3:.3g} mm thick, less than {least * 1e3:.3g} mm"
            faults.append(Fault(PATH, f"{what} (choose {remedy} or fewer lobes)"))
    return faults


def mesh(pair: Pair, chain: Chain, angles: int = 12) -> tuple[float, float]:
    """Return the largest gap and the deepest interference [m] of the polygons at angles over one pitch."""
    from scipy.spatial import KDTree

    (mx, my), (fx, fy) = outlines(pair, chain)
    near = pair.centre_distance - pair.female_radius
    female = np.column_stack([fx, fy])
    longest = max(float(np.hypot(np.diff(x), np.diff(y)).max()) for x, y in ((mx, my), (fx, fy)))
    reaches = 2.0 * longest, max(NEAR * pair.centre_distance, 2.0 * longest)
    tree, gap, depth = KDTree(female), -math.inf, -math.inf
    for psi in chain.psi[0] + pair.pitch * (np.arange(angles) + 0.5) / angles:
        c, s = math.cos(psi), math.sin(psi)
        x, y = c * mx + s * my, c * my - s * mx
        close = x > near - 1e-3 * pair.centre_distance
        x, y = x[close] - pair.centre_distance, y[close]
        c, s = math.cos(pair.k * psi), math.sin(pair.k * psi)
        least = _least(np.column_stack([c * x + s * y, c * y - s * x]), female, tree, reaches)
        gap, depth = max(gap, least), max(depth, -least)
    return max(gap, 0.0), max(depth, 0.0)


def inside(points: Array, polygon: Array) -> Array:
    """Return which points lie inside a polygon (ray crossing)."""
    x, y = points[:, :1], points[:, 1:]
    ax, ay = polygon[:, 0], polygon[:, 1]
    bx, by = np.roll(ax, -1), np.roll(ay, -1)
    spans = (ay <= y) != (by <= y)
    with np.errstate(divide="ignore", invalid="ignore"):
        right = ax + (y - ay) * (bx - ax) / (by - ay) > x
    return np.count_nonzero(spans & right, axis=1) % 2 == 1


def _least(points: Array, polygon: Array, tree, reaches: Sequence[float]) -> float:
    """Return the least distance of points on a curve from a clockwise polygon [m], negative inside.

    Points within a reach of a corner are enough where the result is less than half of that: the polygon's sides and the
    steps along the curve are at most half as long, so that no other point can be nearer, or deeper inside, without a
    point between it and the edge having been considered. Short reaches come first: few points lie within them.
    """
    for reach in reaches:
        away, i = tree.query(points, distance_upper_bound=reach)
        near = np.isfinite(away)
        if near.any():
            least = float(_signed(points[near], polygon, i[near]).min())
            if abs(least) < 0.5 * reach:
                return least
    return float(_signed(points, polygon, tree.query(points)[1]).min())


def _signed(points: Array, polygon: Array, i: Array) -> Array:
    """Return the distances of points from a clockwise polygon [m], negative inside; `i`: the corner nearest to each."""
    best = np.full(len(points), np.inf)
    for first, second in ((i - 1, i), (i, (i + 1) % len(polygon))):
        p, d = polygon[first], polygon[second] - polygon[first]
        length = np.hypot(d[:, 0], d[:, 1])
        r = points - p
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.clip((r * d).sum(axis=1) / length**2, 0.0, 1.0)
        r = r - np.where(np.isfinite(t), t, 0.0)[:, None] * d
        left = d[:, 0] * r[:, 1] - d[:, 1] * r[:, 0]  # a clockwise polygon lies on the right of its sides
        value = np.hypot(r[:, 0], r[:, 1]) * np.where(left >= 0.0, 1.0, -1.0)
        best = np.where((np.abs(value) < np.abs(best)) & (length > 0.0), value, best)
    doubtful = np.flatnonzero(best < -1e-6 * np.abs(polygon).max())  # at sharp corners the sign may be wrong
    doubtful = doubtful[np.argsort(best[doubtful])][:40]
    best[doubtful] = np.where(inside(points[doubtful], polygon), best[doubtful], -best[doubtful])
    return best
