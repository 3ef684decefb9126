"""Saturation of a pure fluid by its own equation: equal pressure and Gibbs energy of both phases, as compiled kernels.

The tables are piecewise polynomials, solved for in extended precision at Chebyshev points of their intervals:
    ln ρ over θ = ±√t, minus for the vapour;  ln p and g (the Gibbs energy) over T;  T over ln p (a start for Newton),
with t = 1 − T/T_c. At the critical point of an analytic equation ρ is analytic in θ, and p and g are in T; but accurate
equations are so flat there that this shows only below t = 1e-4. The intervals of the first three are therefore equal in
t^(1/4), which makes them ever shorter towards the critical point.

A pseudo-pure fluid (air, R410A) boils and condenses at two pressures: its vapour's tables are CoolProp's dew line. So
does a blend: its tables are the phase envelope of `phase_envelope`, with T_c the highest temperature of two phases; ln
p of the whole envelope is also tabulated over θ. A blend whose envelope cannot be followed, or lies below the range of
its equations, has no tables: it is known as a gas only, from the temperature of `always_gas` on.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.fluid.always_gas import gas_from
from screwsim.fluid.coolprop_cache import cached_answer
from screwsim.fluid.description import Description, describe
from screwsim.fluid.helmholtz import potentials_kernel, vectorised
from screwsim.fluid.phase_envelope import Untraced, envelope
from screwsim.inputs.faults import UsageError

Array = np.ndarray
DEGREE = 9  # degree of the polynomials
BINS = 64  # intervals from the critical point to the lowest temperature
LOG_P_BINS = 48  # intervals of the table of T over ln p
CUT = 0.3  # longest step of Newton's method in ln ρ
FURTHER = 60  # most further steps where the start is farther off than the usual ones reach
APART = 1e-6  # vapour's density over the liquid's, below which they are taken
POLISHED = 1e-5  # t above which pressures are solved for; below, they follow from the density table


@dataclass(frozen=True)
class Table:
    """A piecewise polynomial between increasing edges; `c` holds the coefficients in −1 ≤ s ≤ 1 of each interval."""

    edges: Array
    c: Array

    def __call__(self, x: Array) -> Array:
        i = np.clip(np.searchsorted(self.edges, np.asarray(x, float), side="right") - 1, 0, len(self.c) - 1)
        low, high = self.edges[i], self.edges[i + 1]
        s = (2.0 * x - (low + high)) / (high - low)
        value = np.zeros_like(s)
        for k in range(DEGREE, -1, -1):
            value = value * s + self.c[i, k]
        return value


def nodes(edges: Array) -> Array:
    """Return the Chebyshev points of each interval [intervals, DEGREE + 1] in extended precision."""
    s = np.cos(np.pi * (np.arange(DEGREE + 1, dtype=np.longdouble) + 0.5) / (DEGREE + 1))
    low, high = edges[:-1, None].astype(np.longdouble), edges[1:, None].astype(np.longdouble)
    return 0.5 * (low + high) + 0.5 * (high - low) * s


def fitted(edges: Array, values: Array) -> Table:
    """Return the table through values at `nodes`."""
    n = DEGREE + 1
    angle = np.pi * (np.arange(n, dtype=np.longdouble) + 0.5) / n
    a = 2.0 / n * (values @ np.cos(np.arange(n)[:, None] * angle).T)
    a[:, 0] *= 0.5
    rows = (np.polynomial.chebyshev.cheb2poly(row) for row in np.eye(n))
    return Table(edges, (a @ np.array([np.pad(row, (0, n - len(row))) for row in rows])).astype(float))


@dataclass(frozen=True)
class Saturation:
    """The tables of one fluid, from `T_low` to the equation's own critical point; `log_p_of_theta` for blends only.

    A blend that is known as a gas only (`always_gas`) has empty tables, and no states below T_low = T_c.
    """

    T_low: float
    T_c: float
    p_c: float
    rho_c: float
    log_rho: Table
    log_p: Table
    gibbs: Table
    T_of_log_p: Table
    log_p_of_theta: Table | None = None
    always_gas: bool = False


def _critical(known: Description, potentials: Any) -> tuple[float, float]:
    """Return (T_c, ρ_c) where p_ρ = p_ρρ = 0 in the equation, by Newton's method.

    p_ρρ is a fourth-order difference: its error of (1e-3)⁴ moves ρ_c by about 1e-11 and T_c by the square of that.
    """
    if any(item["type"] == "ResidualHelmholtzNonAnalytic" for item in known.residual):
        return known.T_r, known.rho_r  # critical by construction

    def both(T: Any, rho: Any) -> Array:
        h = np.longdouble(1e-3)
        d, c, middle, a, b = (potentials(T, rho * (1 + k * h))[1] for k in (-2, -1, 0, 1, 2))
        return np.array([middle, (8 * (a - c) - (b - d)) / (12 * h)]) / (known.R * known.T_c)

    x = np.array([known.T_r, known.rho_r], dtype=np.longdouble)
    for _ in range(12):
        f, steps = both(*x), x * 1e-7
        J = np.array([(both(*(x + dx)) - f) / dx[k] for k, dx in enumerate(np.diag(steps))]).T
        x -= np.linalg.solve(J.astype(float), f.astype(float))
    if not np.all(np.abs(x / (known.T_c, known.rho_c) - 1.0) < (5e-3, 0.2)):
        return known.T_c, known.rho_c
    return float(x[0]), float(x[1])


def _newton(potentials: Any, T: Array, liquid: Array, vapour: Array, steps: int) -> tuple[Array, Array]:
    """Return densities of both phases with equal p and g by Newton's method in ln ρ, from given starts.

    Where the last step is still cut while both phases are far apart (CoolProp's cold vapour of propylene glycol is off
    by up to e⁵), up to FURTHER steps follow.
    """
    with np.errstate(all="ignore"):
        far = np.ones(T.shape, bool)
        for step in range(steps + FURTHER):
            p_l, slope_l, g_l = potentials(T, liquid)
            p_v, slope_v, g_v = potentials(T, vapour)
            dp, dg, gap = p_l - p_v, g_l - g_v, liquid - vapour
            by_l, by_v = (dg * vapour - dp) / (slope_l * gap), (dg * liquid - dp) / (slope_v * gap)
            liquid = np.where(far, liquid * np.exp(np.clip(by_l, -CUT, CUT)), liquid)
            vapour = np.where(far, vapour * np.exp(np.clip(by_v, -CUT, CUT)), vapour)
            if step >= steps - 1:
                far = far & (np.abs(by_v) > CUT) & (vapour < APART * liquid)
                if not far.any():
                    break
    return liquid, vapour


def _start(known: Description, T_low: float) -> tuple[Array, Array, Array]:
    """Return decreasing temperatures with CoolProp's densities of saturated liquid and vapour, as starts."""
    import CoolProp.CoolProp as coolprop

    state = coolprop.AbstractState("HEOS", known.name)
    found: list[tuple[float, float, float]] = []
    for T in known.T_c * (1.0 - np.linspace(0.02, np.sqrt(1.0 - T_low / known.T_c), 120) ** 2):
        state.update(coolprop.QT_INPUTS, 0.0, max(float(T), T_low))
        liquid = state.rhomass()
        state.update(coolprop.QT_INPUTS, 1.0, max(float(T), T_low))
        found.append((float(T), liquid, state.rhomass()))
    T, liquid, vapour = np.array(found).T
    return T, liquid, vapour


def _theta_edges(T_low: float, T_c: float) -> Array:
    """Return interval edges over ±θ; the middle interval extends across the critical point."""
    half = np.sqrt(1.0 - T_low / T_c) * (np.arange(1, BINS + 1) / BINS) ** 2
    return np.concatenate([-half[::-1], half])


def _boiling_and_dew(known: Description, T_low: float) -> Table:
    """Return the table of ln ρ over ±θ of a pseudo-pure fluid: CoolProp's boiling and dew lines, which do not meet.

    Near the critical point, where CoolProp has none, it is interpolated.
    """
    import CoolProp.CoolProp as coolprop
    from scipy.interpolate import CubicSpline

    state = coolprop.AbstractState("HEOS", known.name)
    edges = _theta_edges(T_low, known.T_c)
    points = nodes(edges).astype(float)
    theta, values = [0.0], [np.log(known.rho_c)]
    for x in np.sort(points.ravel()):
        T = known.T_c * (1.0 - x * x)
        if abs(x) < 0.05 or T <= T_low:
            continue
        try:
            state.update(coolprop.QT_INPUTS, float(x < 0.0), T)
        except ValueError:
            continue
        theta.append(x)
        values.append(np.log(state.rhomass()))
    order = np.argsort(theta)
    return fitted(edges, CubicSpline(np.array(theta)[order], np.array(values)[order])(points).astype(np.longdouble))


def _densities(potentials: Any, known: Description, T_low: float, T_c: float, rho_c: float) -> Table:
    """Return the table of ln ρ over ±θ, solved interval by interval towards the critical point.

    Each start is interpolated between the solved part and the critical point. Where the solution fails, next to the
    critical point of an equation that is not analytic there, the start is kept.
    """
    from scipy.interpolate import CubicSpline

    edges = _theta_edges(T_low, T_c)
    points = nodes(edges)
    values = np.empty(points.shape, np.longdouble)
    T, *both = _start(known, T_low)
    solved = [np.sqrt(1.0 - T / T_c), *map(np.log, both)]
    for left in range(BINS):
        right = 2 * BINS - 2 - left
        theta, liquid, vapour = (np.asarray(column, float) for column in solved)
        x = np.concatenate([-theta[::-1], [0.0], theta])
        start = CubicSpline(x, np.concatenate([vapour[::-1], [np.log(rho_c)], liquid]))
        size = np.abs(points[right])
        guess = [np.exp(start((sign * size).astype(float)).astype(np.longdouble)) for sign in (1.0, -1.0)]
        found = _newton(potentials, T_c * (1.0 - size**2), guess[0], guess[1], 12)
        log_l, log_v = _kept_apart(found, guess)
        values[left] = log_v[::-1]
        values[right] = np.where(points[right] > 0.0, log_l, log_v)
        rows = np.argsort(size)
        new = [column[rows] for column in (size, log_l, log_v)]
        solved = new if left == 0 else [np.concatenate(pair) for pair in zip(new, solved, strict=True)]
    return fitted(edges, values)


def _kept_apart(found: Sequence[Array], guess: Sequence[Array]) -> list[Array]:
    """Return the logarithms of the densities found, or of the guess where those found are one phase or none."""
    with np.errstate(all="ignore"):
        gap = np.log(guess[0] / guess[1])
        good = np.abs(np.log(found[0] / found[1]) - gap) < 0.5 * gap
    return [np.log(np.where(good, a, b)) for a, b in zip(found, guess, strict=True)]


def _solve(fluid: str) -> dict[str, Any]:
    """Return the tables of a fluid as plain numbers."""
    known = describe(fluid)
    potentials = vectorised(potentials_kernel(fluid))
    T_low, whole = known.T_min, {}
    if known.blend:
        try:
            around = envelope(known)
        except Untraced as untraced:
            T = gas_from(known, untraced.hottest)
            if T is None:
                raise
            return {"gas_from": T}
        T_low, T_c, rho_c = around.T_low, around.T_m, float(np.exp(around.log_z_m)) * known.molar_mass
        edges = _theta_edges(T_low, T_c)
        log_rho, whole["log_p_of_theta"] = (fitted(edges, y) for y in around.at(nodes(edges).astype(float)))
    elif known.pseudo_pure:
        T_c, rho_c = known.T_c, known.rho_c
        log_rho = _boiling_and_dew(known, T_low)
    else:
        T_c, rho_c = _critical(known, potentials)
        log_rho = _densities(potentials, known, T_low, T_c, rho_c)
    log_p, gibbs = _pressures(potentials, T_low, T_c, log_rho, 2.0 if known.glides else POLISHED)
    first, last = log_p(np.array([T_low, T_c]))
    y = np.linspace(first, last, LOG_P_BINS + 1)
    T_of = fitted(y, _inverse(log_p, nodes(y), T_low, T_c))
    tables = {"log_rho": log_rho, "log_p": log_p, "gibbs": gibbs, "T_of_log_p": T_of} | whole
    return {"T_low": T_low, "T_c": T_c, "p_c": float(np.exp(last)), "rho_c": rho_c} | {
        name: [table.edges.tolist(), table.c.tolist()] for name, table in tables.items()
    }


def _pressures(potentials: Any, T_low: float, T_c: float, log_rho: Table, polished: float) -> tuple[Table, Table]:
    """Return tables of ln p and of the vapour's Gibbs energy over T; densities are solved for where t > polished."""
    edges = T_c - (T_c - T_low) * (np.arange(BINS, -1, -1) / BINS) ** 4
    T = nodes(edges)
    theta = np.sqrt(1.0 - T / T_c)
    liquid, vapour = np.exp(log_rho(theta)), np.exp(log_rho(-theta))
    far = theta**2 > polished
    start = liquid[far], vapour[far]
    liquid[far], vapour[far] = np.exp(_kept_apart(_newton(potentials, T[far], *start, 4), start))
    p, _, g = potentials(T, vapour)
    return fitted(edges, np.log(p)), fitted(edges, g)


def _inverse(log_p: Table, y: Array, T_low: float, T_c: float) -> Array:
    """Return T with log_p(T) = y by bisection."""
    low, high = np.full(y.shape, T_low, np.longdouble), np.full(y.shape, T_c, np.longdouble)
    for _ in range(60):
        middle = 0.5 * (low + high)
        below = log_p(middle) < y
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def saturation(fluid: str) -> Saturation:
    """Return the saturation tables of a fluid, from the cache folder if they are there. Raises UsageError."""
    found = _kept(fluid)
    if isinstance(found, UsageError):
        raise found
    return found


@lru_cache(maxsize=64)
def _kept(fluid: str) -> Saturation | UsageError:
    """Return the tables of a fluid, or why there are none: a failed search is not repeated."""
    try:
        return _read(fluid)
    except UsageError as error:
        return error


def _read(fluid: str) -> Saturation:
    sources = (Path(__file__), *map(Path(__file__).with_name, ("phase_envelope.py", "fugacity.py", "always_gas.py")))
    method = hashlib.sha256(b"".join(each.read_bytes() for each in sources)).hexdigest()[:10]
    equation = potentials_kernel(fluid).flat_name  # holds a hash of the equation
    found = cached_answer(f"saturation {equation} {method}", lambda: _solve(fluid))
    if "gas_from" in found:
        T, empty = found["gas_from"], Table(np.empty(0), np.empty((0, DEGREE + 1)))
        return Saturation(T, T, 0.0, describe(fluid).rho_r, empty, empty, empty, empty, always_gas=True)
    numbers = (found[name] for name in ("T_low", "T_c", "p_c", "rho_c"))
    names = [name for name in ("log_rho", "log_p", "gibbs", "T_of_log_p", "log_p_of_theta") if name in found]
    return Saturation(*numbers, *(Table(*map(np.array, found[name])) for name in names))
