"""The dew and the bubble line of a blend of fixed composition z, by equal fugacities and pressures (M315).

Unknowns are k_i = ln(w_i/z_i) of the incipient phase w, ln ρ of both phases and ln T; the equations are ln f_i(w) = ln
f_i(z), p(w) = p(z) and Σ w_i = 1, with one of ln T and ln ρ_z prescribed. With densities in place of the pressure no
root of p(ρ) has to be chosen; and since ln ρ_z increases along the whole envelope, from thin vapour over the highest
temperature to dense liquid, the envelope has no turning point in it. Newton's method with complex-step derivatives.

Both lines begin at a middle temperature from Wilson's equilibrium constants and are followed down by T and up by ρ_z,
each start extrapolated from the points before it, until both phases are nearly the same. The remaining stretch across
the critical point is interpolated. Over θ = ±√(1 − T/T_m), with T_m the highest temperature of two phases and minus for
the vapour's side, the envelope is one smooth curve, which the tables of `saturation` hold as they do a pure fluid's.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from screwsim.fluid.composition import REMEDY
from screwsim.fluid.description import Description
from screwsim.fluid.fugacity import Fugacities
from screwsim.inputs.faults import UsageError
from screwsim.numerics.identity_cache import IdentityCache
from screwsim.outputs.customary import in_celsius

Array = np.ndarray
TINY = 1e-100  # complex step, whose derivatives have no rounding error
CLOSE = 1e-11  # largest last Newton step of a solution
MOST = 0.3  # longest Newton step in any logarithm
LIKE = 0.08  # |ln(ρ_w/ρ_z)| below which the phases count as nearly the same
STARTS = (0.75, 0.7, 0.8, 0.65, 0.85, 0.6, 0.55)  # starting temperatures over the reducing one
COLDER, DENSER = 0.05, 0.02  # steps of ln T, and of ln ρ_z
FINE = 1e-3  # smallest step over the initial one
RICHER = 0.6  # share of one component in an enriched start
DENSE, THIN = 1.6, 0.4  # least δ of a liquid, largest δ of a vapour in a first point
AWAY, FIRST = 0.2, 0.8  # largest distance of a point from its extrapolation; the same with fewer than three points
LEAST_SPAN = 0.98  # T_low over T_m above which an envelope is too short
APART, TURN = 0.3, 0.03  # |ln(ρ_w/ρ_z)| and |θ| above which points are solved for, not interpolated
NEAR = 0.05  # largest distance of a solved point from its interpolated start
SAME = 1e-4  # |θ| below which rounding of T matters
WIDEST = 0.4  # largest step of ln ρ_z across the critical point
R = 8.31446261815324  # [J/(mol K)]


def _residuals(f: Fugacities, u: Array) -> Array:
    """Return the n + 2 residuals at u = (k, ln ρ_w, ln ρ_z, ln T) [n + 3, ...].

    Both phases are asked for in one call: most of its time goes into numpy's calls, which few points hardly lengthen.
    """
    n, m = f.n, u.shape[-1]
    T, z, rho = np.exp(u[n + 2]), f.z.reshape(-1, *([1] * (u.ndim - 1))), np.exp(u[n : n + 2])
    w = z * np.exp(u[:n])
    total = np.sum(w, axis=0)
    phases = np.concatenate([w / total, z + 0.0 * u[:n]], axis=-1)
    log_f, p = f(np.concatenate([T, T], axis=-1), np.concatenate([*rho], axis=-1), phases)
    of_p = (p[..., :m] - p[..., m:]) / rho[1]
    return np.concatenate([log_f[..., :m] - log_f[..., m:], of_p[None], (total - 1.0)[None]])


def newton(
    residuals: Callable[[Array], Array], u: Array, free: Sequence[int], steps: int, close: float
) -> tuple[Array, Array]:
    """Return u [n, m] after Newton's method in the unknowns `free`, and the last step of each of the m.

    `residuals` takes complex u [n, free, m], a step of one unknown in each column. The iteration ends where all steps
    are below `close`; the last step is infinite where the equations have no solution.
    """
    u, last = u.copy(), np.full(u.shape[1], np.inf)
    with np.errstate(all="ignore"):
        for _ in range(steps):
            moved = np.repeat(u[:, None, :].astype(complex), len(free), axis=1)
            moved[free, np.arange(len(free))] += 1j * TINY
            found = residuals(moved)
            matrix, value = np.imag(found) / TINY, np.real(found[:, 0])
            sound = np.isfinite(matrix).all(axis=(0, 1)) & np.isfinite(value).all(axis=0)
            matrix = np.where(sound, matrix, np.eye(len(free))[:, :, None]).transpose(2, 0, 1)
            step = _steps(matrix, np.where(sound, value, np.nan).T).T
            last = np.where(np.isfinite(step).all(axis=0), np.abs(step).max(axis=0), np.inf)
            u[free] -= np.clip(np.nan_to_num(step), -MOST, MOST)
            if (last < close).all():
                break
    return u, last


def solved(f: Fugacities, u: Array, stated: int, steps: int = 25) -> tuple[Array, Array]:
    """Return u [n + 3, m] with the unknown `stated` (−1: ln T, −2: ln ρ_z) held, and which of the m have converged."""
    free = [i for i in range(f.n + 3) if i != f.n + 3 + stated]
    u, last = newton(lambda moved: _residuals(f, moved), u, free, steps, CLOSE)
    return u, last < 1e3 * CLOSE


def _steps(matrix: Array, value: Array) -> Array:
    try:
        return np.linalg.solve(matrix, value[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        return np.array([_step(one, of) for one, of in zip(matrix, value, strict=True)])


def _step(matrix: Array, value: Array) -> Array:
    try:
        return np.linalg.solve(matrix, value)
    except np.linalg.LinAlgError:
        return np.full(value.shape, np.nan)


@dataclass
class _Line:
    """A line while it is being followed: columns u, in order from its start."""

    f: Fugacities
    found: list[Array] = field(default_factory=list)

    def go(self, stated: int, step: float, done: float | None) -> None:
        """Follow the line by ln T (−1) or ln ρ_z (−2) to the value `done`, or until its phases are nearly the same."""
        n, here, size = self.f.n, [self.found[0]], step
        while True:
            old = here[-1]
            target, last = old[stated] + size, False
            if done is not None and (target - done) * step >= 0.0:
                target, last = done, True
            # extrapolated from the last three points to a value of the stated unknown
            used = here[-3:]
            at = [each[stated] for each in used]
            guess = np.zeros_like(used[-1])
            for i, each in enumerate(used):
                guess += each * np.prod([(target - x) / (at[i] - x) for j, x in enumerate(at) if j != i])
            guess[stated] = target
            u, good = solved(self.f, guess[:, None], stated, 12)
            away = np.abs(u[:, 0] - guess).max() if good[0] else np.inf
            apart = (u[n, 0] - u[n + 1, 0]) * (old[n] - old[n + 1]) > 0.0
            if good[0] and apart and away < (AWAY if len(here) > 2 else FIRST):
                here.append(u[:, 0])
                size = np.sign(step) * min(1.5 * abs(size), abs(step))
                if last or abs(u[n, 0] - u[n + 1, 0]) < LIKE:
                    break
            elif abs(size) < FINE * abs(step):
                break
            else:
                size *= 0.4
        self.found = [*here[::-1], *self.found[1:]]


def liquid_density(f: Fugacities, T: float, p_RT: float, x: Array, v_r: float) -> float:
    """Return the density [mol/m³] of a liquid at T and p/(R T): Newton's method from a denser one."""
    rho = 3.2 / v_r
    for _ in range(60):
        moved = f(T, rho * (1.0 + 1j * TINY), x.astype(complex))[1]
        step = (np.real(moved) - p_RT) / (np.imag(moved) / TINY)
        rho *= np.exp(np.clip(-step, -0.1, 0.1))
        if abs(step) < 1e-8:
            break
    return float(rho)


def _start(f: Fugacities, vapour: bool) -> Array:
    """Return a first point; with `vapour` the phase z is the vapour (dew point), else the liquid. Raises ValueError.

    Of several incipient phases that satisfy the equations the one that appears first is stable: that of the lowest
    pressure at a dew point, of the highest at a bubble point. Starts are Wilson's phase, and the same enriched in each
    component.
    """
    T_r = float(f.reducing(f.z)[0][0])
    for share in STARTS:
        T = share * T_r
        wilson = f.p_c * np.exp(5.373 * (1.0 + f.acentric) * (1.0 - f.T_c / T))  # K p
        p = 1.0 / np.sum(f.z / wilson) if vapour else np.sum(f.z * wilson)
        first = f.z * p / wilson if vapour else f.z * wilson / p
        tried = [first, *((1.0 - RICHER) * first + RICHER * one for one in np.eye(f.n))]
        u = np.array([_guess(f, vapour, T, p / (R * T), w) for w in tried]).T
        u, good = solved(f, u, -1, 40)
        good &= _plausible(f, u, vapour)
        if good.any():
            p_RT = f(T, np.exp(u[f.n]), normal(f, u))[1]
            return u[:, int(np.argmin(np.where(good, p_RT if vapour else -p_RT, np.inf)))]
    raise ValueError("no start")


def _guess(f: Fugacities, vapour: bool, T: float, p_RT: float, w: Array) -> Array:
    """Return a starting column u for an incipient phase w beside the phase z at T and p/(R T)."""
    liquid = w if vapour else f.z
    dense = np.log(liquid_density(f, T, p_RT, liquid, float(f.reducing(liquid)[1][0])))
    both = [dense, np.log(1.1 * p_RT)]
    return np.array([*np.log(w / f.z), *(both if vapour else both[::-1]), np.log(T)])


def _plausible(f: Fugacities, u: Array, vapour: bool) -> Array:
    """Tell which columns u are a liquid and a vapour, each stable: the equations have false loops in between."""
    T, sound = np.exp(u[f.n + 2]), np.ones(u.shape[1], dtype=bool)
    z = np.repeat(f.z[:, None], u.shape[1], axis=1)
    for log_rho, x, dense in ((u[f.n], normal(f, u), vapour), (u[f.n + 1], z, not vapour)):
        delta = np.exp(log_rho) * f.reducing(x)[1][0]
        p = f(T, np.exp(log_rho) * (1.0 + 1j * TINY), x)[1]
        sound &= (np.real(p) > 0.0) & (np.imag(p) > 0.0) & (delta > DENSE if dense else delta < THIN)
    return sound


def normal(f: Fugacities, u: Array) -> Array:
    """Return the mole fractions [n, m] of the incipient phase."""
    w = f.z[:, None] * np.exp(u[: f.n])
    return w / w.sum(axis=0)


def _line(f: Fugacities, vapour: bool, T_low: float) -> Array:
    """Return the columns u of a line, in order of rising ln ρ_z."""
    line = _Line(f, [_start(f, vapour)])
    if line.found[0][-1] > np.log(T_low):
        line.go(-1, -COLDER, float(np.log(T_low)))
    cold = line.found
    line.found = [cold[-1]]
    line.go(-2, DENSER if vapour else -DENSER, None)  # hotter
    found = np.array([*cold[:-1], *line.found[::-1]]).T
    return found if vapour else found[:, ::-1]


@dataclass(frozen=True)
class Envelope:
    """The phase envelope of a blend over θ: splines of k, ln ρ_w, ln ρ_z and ln T through the points solved for."""

    f: Fugacities
    molar_mass: float
    T_low: float
    T_m: float
    log_z_m: float
    columns: Any  # u by θ

    def phases(self, flat: Array) -> Array:
        """Return u [n + 3, m] at θ [m], solved for except next to the critical point: both phases, by moles."""
        n, u = self.f.n, self.columns(flat).T
        u[n + 2] = np.log(self.T_m * (1.0 - flat**2))
        apart = (np.abs(u[n] - u[n + 1]) > APART) & (np.abs(flat) > TURN)
        found, good = solved(self.f, u[:, apart], -1, 12)
        near = good & (np.abs(found - u[:, apart]).max(axis=0) < NEAR)
        u[:, apart] = np.where(near, found, u[:, apart])
        return u

    def at(self, theta: Array) -> tuple[Array, Array]:
        """Return ln ρ_z [kg/m³] and ln p [Pa] at θ of any shape."""
        n, u = self.f.n, self.phases(theta.ravel())
        thin = np.where(u[n] < u[n + 1], u[n], u[n + 1])  # a liquid's pressure has few of its density's digits
        x = self.f.z[:, None] * np.exp(np.where(u[n] < u[n + 1], u[:n], 0.0))
        p_RT = self.f(np.exp(u[n + 2]), np.exp(thin), x / x.sum(axis=0))[1]
        log_p = np.log(p_RT * R) + u[n + 2]
        return (u[n + 1] + np.log(self.molar_mass)).reshape(theta.shape), log_p.reshape(theta.shape)


def _highest(log_z: Array, T: Array) -> tuple[float, float]:
    """Return (ln ρ_z, T) of the highest temperature, on the polynomial through the points around it."""
    from scipy.interpolate import BarycentricInterpolator
    from scipy.optimize import minimize_scalar

    top = int(np.argmax(T))
    some = slice(max(top - 4, 0), top + 5)
    curve = BarycentricInterpolator(log_z[some], T[some], rng=np.random.default_rng(0))  # fixes the factors' order
    ends = float(log_z[max(top - 2, 0)]), float(log_z[min(top + 2, len(T) - 1)])
    found = minimize_scalar(lambda s: -float(curve(s)), bounds=ends, method="bounded", options={"xatol": 1e-9})
    return float(found.x), float(-found.fun)


class Untraced(UsageError):
    """A phase envelope that cannot be followed, or lies below its equations; `hottest` is a known point [K], or 0."""

    def __init__(self, message: str, hottest: float) -> None:
        super().__init__(message)
        self.hottest = hottest


def _followed(known: Description) -> Envelope:
    """Return the phase envelope of a blend. Raises Untraced where it cannot be followed."""
    from scipy.interpolate import CubicSpline

    f = Fugacities(known)
    lines: list[Array] = []
    for vapour in (True, False):
        with suppress(ValueError):
            lines.append(_line(f, vapour, known.T_min))
    hottest = max((float(np.exp(line[-1].max())) for line in lines), default=0.0)
    if len(lines) < 2:
        raise _untraced(known, hottest)
    dew, bubble = lines
    u = np.concatenate([dew, bubble], axis=1)
    T_low = max(known.T_min, *(float(np.exp(line[-1].min())) for line in (dew, bubble)))
    log_z, T = u[f.n + 1], np.exp(u[f.n + 2])
    if not (np.diff(log_z) > 0.0).all() or log_z[dew.shape[1]] - log_z[dew.shape[1] - 1] > WIDEST:
        raise _untraced(known, hottest)
    log_z_m, T_m = _highest(log_z, T)
    if T_low > LEAST_SPAN * T_m:
        what = (
            f"it has two phases only below {in_celsius(T_m)}, and the equations of its components end at "
            f"{in_celsius(T_low)}"
        )
        raise Untraced(f"gas.fluid: {known.name}: {what}; {REMEDY}", hottest)
    theta = np.sign(log_z - log_z_m) * np.sqrt(np.maximum(1.0 - T / T_m, 0.0))
    kept = np.abs(theta) > SAME
    if not (np.diff(theta[kept]) > 0.0).all():
        raise _untraced(known, hottest)
    return Envelope(f, known.molar_mass, T_low, T_m, log_z_m, CubicSpline(theta[kept], u[:, kept].T))


envelope = IdentityCache(_followed)  # takes a second for three components, and serves all states of a blend


def _untraced(known: Description, hottest: float) -> Untraced:
    return Untraced(f"gas.fluid: {known.name}: its dew and bubble lines cannot be found; {REMEDY}", hottest)
