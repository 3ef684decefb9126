"""Profiles from points: a male curve or a rack, faired or smoothed, becomes a chain by the general gearing equation.

The common normal at a contact passes through the pitch point: for a male point p with unit tangent t, ψ = ang(t) −
acos(p·t/r1); for a rack point (x, y), Y = −x dx/dy, ψ = (y − Y)/r1 (Litvin & Fuentes 2004, ch. 6). Smoothing: the
tangent's angle is averaged over the length `smoothing` of the curve; the points stay. (It is the tangent that noise of
points spoils; a smoothing spline would overshoot where the curvature jumps.) Lengths: m; angles: rad.
"""

import math

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.inputs.sheets import read_sheet, sheet_or_usage_error
from screwsim.machine.rotors.closed_form import Segment
from screwsim.machine.rotors.pair import Array, Chain, Pair, tangents

POINTS = 4001  # least number of points of the curve
CORNER = math.radians(40.0)  # turn at a point above which it is a corner, not a curve
CLOSED = 1e-3  # distance of a curve's end from the root circle over the centre distance that is allowed
LOOP = 5e-3  # length over centre distance below which a loop of contact on a rotor is noise, and is cut off
TURNED = 0.02  # [rad] angle of the tip from the points' x axis below which the frame is not turned
NOISE = 1e-3  # [rad] reversal of the contact, outside the tip, below which it is noise, and is straightened


def read_profile(path: str) -> tuple[Array, Array]:
    """Return x and y [m] from a CSV file with the columns x_mm, y_mm; lines that begin with # are comments."""
    if path.lower().endswith((".dxf", ".dwg", ".step", ".stp", ".igs", ".iges")):
        remedy = "export the points of one male lobe, from root to root, as CSV with the columns x_mm, y_mm"
        raise UsageError(f"{path}: is a drawing ({remedy})")
    words = "needs the columns x_mm and y_mm with a number in every row"
    with sheet_or_usage_error("name an existing CSV file", path):
        points = np.array(read_sheet(path).numbers("x_mm", "y_mm", words=words))
    if len(points) < 20:
        raise UsageError(f"{path}: has {len(points)} rows; a profile needs at least 20 points of one lobe")
    beyond = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(beyond):
        x, y = points[beyond[0]]
        raise UsageError(f"{path}: point {beyond[0] + 1}, {x:g}, {y:g}, is not finite (correct it, or leave it out)")
    return points[:, 0] * 1e-3, points[:, 1] * 1e-3


def in_order(x: Array, y: Array, curve: str) -> tuple[Array, Array]:
    """Return the points in the order of the program: a male lobe counter-clockwise, a rack towards growing y."""
    along = np.unwrap(np.arctan2(y, x)) if curve == "male" else y
    return (x, y) if along[-1] > along[0] else (x[::-1], y[::-1])


def averaged(way: Array, angle: Array, length: float) -> Array:
    """Return the angle averaged over a length of the curve around each point (less near its ends)."""
    half = np.minimum(0.5 * length, np.minimum(way - way[0], way[-1] - way))
    total = np.concatenate([[0.0], np.cumsum(0.5 * (angle[1:] + angle[:-1]) * np.diff(way))])
    fine = np.linspace(way[0], way[-1], 20 * len(way))  # the integral of a linear angle, nearly exact
    # corrected for the difference between the integral of a piecewise linear function and its chords
    i = np.clip(np.searchsorted(way, fine, side="right") - 1, 0, len(way) - 2)
    slope = (angle[i + 1] - angle[i]) / (way[i + 1] - way[i])
    sums = np.interp(fine, way, total) + (-0.5 * slope * (fine - way[i]) * (way[i + 1] - fine))
    mean = (np.interp(way + half, fine, sums) - np.interp(way - half, fine, sums)) / np.maximum(2.0 * half, 1e-12)
    return np.where(half > 1e-3 * length, mean, angle)


def _curve(x: Array, y: Array, smoothing: float) -> Segment:
    """Return points of the curve, without repetitions, and the angle of its tangent [rad].

    The tangent at a point is that of the circle through it and its neighbours, and linear in between: so its curvature
    never overshoots where that of the profile jumps, which would make loops in the conjugate curve.
    """
    keep = np.concatenate([[True], np.hypot(np.diff(x), np.diff(y)) > 1e-9])
    x, y = x[keep], y[keep]
    step, chord = np.hypot(np.diff(x), np.diff(y)), np.unwrap(np.arctan2(np.diff(y), np.diff(x)))
    turn = np.abs(np.diff(chord))
    worst = int(np.argmax(turn))
    if turn[worst] > CORNER:
        raise UsageError(
            f"machine.profile.file: the curve turns by {math.degrees(turn[worst]):.0f} deg at x = "
            f"{x[worst + 1] * 1e3:.3f} mm, y = {y[worst + 1] * 1e3:.3f} mm "
            "(give more points there, all in order from root to root, round the corner, or set "
            "machine.profile.tolerance)"
        )
    angle = tangents(step, chord)
    way = np.concatenate([[0.0], np.cumsum(step)])
    from scipy.interpolate import CubicHermiteSpline  # here: it takes long to load, and closed forms need none

    if smoothing > 0.0:
        angle = averaged(way, angle, smoothing)
    fine = max(math.ceil(POINTS / len(x)), 1)
    at = np.unique(np.concatenate([way[:-1] + part * step for part in np.arange(fine) / fine] + [way[-1:]]))
    curve = CubicHermiteSpline(way, np.column_stack([x, y]), np.column_stack([np.cos(angle), np.sin(angle)]))
    return curve(at)[:, 0], curve(at)[:, 1], np.interp(at, way, angle)


def from_male(pair: Pair, x: Array, y: Array, smoothing: float = 0.0) -> Chain:
    """Return the chain of a male lobe: points [m] in the male frame, counter-clockwise, root → tip → root.

    At ψ = 0 the lobe's tip lies on the centre line; a frame that is turned by more than `TURNED` is turned back. The
    rest of the pitch is root circle.
    """
    x, y, angle = _curve(x, y, smoothing)
    tx, ty = np.cos(angle), np.sin(angle)
    reach = (x * tx + y * ty) / pair.r1
    worst = int(np.argmax(np.abs(reach)))
    if abs(reach[worst]) > 1.0 + 1e-9:
        raise UsageError(
            f"machine.profile.file: the normal at x = {x[worst] * 1e3:.3f} mm, y = {y[worst] * 1e3:.3f} mm misses the "
            "pitch circle, so that there is no contact (undercut, or noise: set machine.profile.tolerance, or change "
            "the curve or the centre_distance)"
        )
    psi = angle - np.arccos(np.clip(reach, -1.0, 1.0))
    tip = int(np.argmax(np.hypot(x, y)))
    psi -= 2.0 * math.pi * round(psi[tip] / (2.0 * math.pi))
    c, s = np.cos(psi), np.sin(psi)
    return closed(pair, (_turned_back(psi, tip, math.atan2(y[tip], x[tip])), c * x + s * y, c * y - s * x))


def _turned_back(psi: Array, tip: int, turned: float) -> Array:
    """Return ψ [rad] with the lobe's tip on the centre line at ψ = 0, where it is `turned` [rad] from there."""
    if abs(turned) <= TURNED:
        return psi
    return psi - turned - 2.0 * math.pi * round((psi[tip] - turned) / (2.0 * math.pi))


def from_rack(pair: Pair, x: Array, y: Array, smoothing: float = 0.0) -> Chain:
    """Return a rack's chain: x above the pitch line, y along it [m], increasing.

    At ψ = 0 the lobe's tip lies on the centre line, wherever y begins (within `TURNED` of the male rotor).
    """
    x, y, angle = _curve(x, y, smoothing)
    tx, ty = np.cos(angle), np.sin(angle)
    if np.min(ty) <= 0.0:
        raise UsageError(
            "machine.profile.file: the rack runs back along its pitch line (y must grow, or fall, from row to row)"
        )
    X, Y = pair.r1 + x, -x * tx / ty
    psi, tip = (y - Y) / pair.r1, int(np.argmax(np.hypot(X, Y)))
    return closed(pair, (_turned_back(psi, tip, psi[tip] + math.atan2(Y[tip], X[tip])), X, Y))


def closed(pair: Pair, contact: Segment) -> Chain:
    """Return the chain over one pitch: the contact between halves of the flat, with S' and S found."""
    psi, x, y = contact
    root = pair.r1 - pair.dedendum
    for end in (0, -1):
        if math.hypot(x[end] - root, y[end]) > CLOSED * pair.centre_distance:
            raise UsageError(
                f"machine.profile.file: the curve must begin and end on the root circle of {root * 1e3:.4g} mm "
                f"(contact at its end: {x[end] * 1e3:.4g}, {y[end] * 1e3:.4g} mm; "
                "add points, set female_diameter, or change machine.profile.tolerance)"
            )
    flat = pair.pitch - (psi[-1] - psi[0])
    if flat < -1e-6:
        raise UsageError(
            f"machine.profile.file: the curve is {math.degrees(-flat):.3g} deg longer than a lobe pitch "
            "(give one lobe, from root to root)"
        )
    lead, trail = _reversal(x, y, psi)
    psi = _straightened(psi, lead, trail)
    count = POINTS // 40
    before, after = np.linspace(-0.5, 0.0, count) * max(flat, 0.0), np.linspace(0.0, 0.5, count) * max(flat, 0.0)
    chain = (
        np.concatenate([psi[0] + before[:-1], psi, psi[-1] + after[1:]]),
        np.concatenate([np.full(count - 1, root), x, np.full(count - 1, root)]),
        np.concatenate([np.zeros(count - 1), y, np.zeros(count - 1)]),
    )
    edges = count - 1, count - 2 + len(psi)
    return _forward(pair, Chain(*chain, lead + count - 1, trail + count - 1, edges))


def _forward(pair: Pair, chain: Chain) -> Chain:
    """Return the chain without points that run back on a rotor by less than `LOOP`: noise of a tangent, no undercut."""
    marks = (0, chain.edges[0], chain.lead, chain.trail, chain.edges[1], len(chain.psi) - 1)
    keep = np.ones(len(chain.psi), dtype=bool)
    for x, y in (chain.male, chain.female(pair)):
        keep &= ~_backward(x.tolist(), y.tolist(), LOOP * pair.centre_distance)
    keep[list(marks)] = True
    place = np.cumsum(keep) - 1
    lead, trail, first, last = (int(place[i]) for i in (chain.lead, chain.trail, *chain.edges))
    return Chain(chain.psi[keep], chain.x[keep], chain.y[keep], lead, trail, (first, last))


def _backward(x: list[float], y: list[float], limit: float) -> Array:
    """Return which points lie behind the farthest one so far, along the last step, and nearer to it than the limit."""
    behind = np.zeros(len(x), dtype=bool)
    px, py, dx, dy = x[0], y[0], 0.0, 0.0
    for i in range(1, len(x)):
        sx, sy = x[i] - px, y[i] - py
        if sx * dx + sy * dy < 0.0 and sx * sx + sy * sy < limit * limit:
            behind[i] = True
        else:
            px, py, dx, dy = x[i], y[i], sx, sy
    return behind


def _reversal(x: Array, y: Array, psi: Array) -> tuple[int, int]:
    """Return the indices of S' and S: the ends of the largest fall of ψ, or of the stretch at rest around the tip."""
    radii = np.hypot(x, y)
    lobe = np.flatnonzero(radii > 0.5 * (radii.min() + radii.max()))
    first, last = int(lobe[0]), int(lobe[-1]) + 1
    part = psi[first:last]
    trail = int(np.argmax(np.maximum.accumulate(part) - part))
    lead = int(np.argmax(part[: trail + 1]))
    if part[lead] - part[trail] > NOISE:
        return first + lead, first + trail
    tip = int(np.argmax(radii))
    moved = np.abs(psi - psi[tip]) > NOISE
    before, after = np.flatnonzero(moved[:tip]), np.flatnonzero(moved[tip:])
    return int(before[-1]) + 1 if len(before) else 0, tip + int(after[0]) - 1 if len(after) else len(psi) - 1


def _straightened(psi: Array, lead: int, trail: int) -> Array:
    """Return ψ made monotone on each branch where it runs back by noise only; a true reversal of the contact stays."""
    parts = (
        np.maximum.accumulate(psi[:lead]),
        np.minimum.accumulate(psi[lead : trail + 1]),
        np.maximum.accumulate(psi[trail + 1 :]),
    )
    result = np.concatenate(parts)
    return result if np.max(np.abs(result - psi)) < NOISE else psi
