"""The Helmholtz energy of a blend's two phases in equilibrium, by direct flashes and as a table (M350, M351).

At T and v a flash solves for k_i = ln(y_i/x_i), ln ρ', ln ρ'' and the vapour's molar share β: equal fugacities, equal
pressures, Σ(y_i − x_i) = 0 and v = (1 − β)/ρ' + β/ρ''. Newton's method with complex-step derivatives, from a start
interpolated linearly between bubble and dew point of that T. β may leave 0…1 a little: nothing special happens there.

The Gibbs energy of the mixture is Σ z_i μ_i, and of μ_i only ln f_i changes with ρ: with one state of the single phase
at the same T it gives f = Σ z_i μ_i − p v on the reference of M311. The table is a polynomial of two variables in each
cell: T, and w = (v − v')/(v'' − v') between the border's volumes, which are polynomials of T themselves.
"""

import hashlib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from screwsim.fluid.coolprop_cache import cached_answer
from screwsim.fluid.description import Description, describe
from screwsim.fluid.fugacity import Fugacities
from screwsim.fluid.helmholtz import potentials_kernel, vectorised
from screwsim.fluid.phase_envelope import R, envelope, newton
from screwsim.fluid.saturation import saturation
from screwsim.inputs.faults import UsageError
from screwsim.numerics.compiling import announced

Array = np.ndarray
POINTS_T, POINTS_W = 12, 12  # Chebyshev points of a cell
W_EDGES = (0.0, 0.08, 0.3, 1.0)  # narrower towards the bubble point, where the vapour's composition changes most
REACHES = ((0.005, 0.42), (0.005, 0.36), (0.02, 0.36), (0.02, 0.3))  # ranges of 1 − T/T_m: the first one solved
WIDEST = 0.1  # largest width of a cell in 1 − T/T_m
ALIKE = 1e-5  # largest relative difference of p between table and flashes; more means a wrong solution among them
CLOSE, STEPS = 1e-10, 30  # last step of a solution, number of steps
INSTEAD = "write refuse, or another blend, such as R454B, R513A or R448A"
PROBED, PROBES = 9, (0.1, 0.2, 0.28)  # states that are tried first per temperature, and their 1 − T/T_m
WALK = 8  # continuation steps from the dew point to a state that is not found directly


class Flash(NamedTuple):
    """Two phases in equilibrium, per mole: p [Pa], f [J/mol] up to the reference, β, and both compositions."""

    p: Array
    f: Array
    beta: Array
    liquid: Array
    vapour: Array
    densities: Array  # of liquid and vapour [mol/m³]


def _parts(f: Fugacities, u: Array) -> tuple[Array, Array]:
    """Return the liquid's and the vapour's mole fractions [n, ...] at u = (k, ln ρ', ln ρ'', β)."""
    K, z = np.exp(u[: f.n]), f.z.reshape(-1, *([1] * (u.ndim - 1)))
    x = z / (1.0 + u[f.n + 2] * (K - 1.0))
    return x, K * x


def _residuals(f: Fugacities, T: Array, v: Array, u: Array) -> Array:
    n = f.n
    x, y = _parts(f, u)
    rho_l, rho_v, beta = np.exp(u[n]), np.exp(u[n + 1]), u[n + 2]
    log_l, p_l = f(T, rho_l, x)
    log_v, p_v = f(T, rho_v, y)
    last = [(p_l - p_v) / rho_v, np.sum(y - x, axis=0), ((1.0 - beta) / rho_l + beta / rho_v) / v - 1.0]
    return np.concatenate([log_v - log_l, np.array(last)])


class Flashes:
    """Direct flashes of a blend between its bubble and its dew points."""

    def __init__(self, known: Description) -> None:
        self.known, self.around = known, envelope(known)
        self.f = self.around.f

    def borders(self, T: Array) -> tuple[Array, Array, Array]:
        """Return u of the bubble and of the dew point at T [m], and the volumes [2, m] [m³/mol] of both."""
        n, theta = self.f.n, np.sqrt(1.0 - T / self.around.T_m)
        bubble, dew = (self.around.phases(side * theta) for side in (1.0, -1.0))
        volumes = np.exp(-np.array([bubble[n + 1], dew[n + 1]]))
        beta = np.zeros_like(T)
        return (
            np.concatenate([bubble[:n], bubble[[n + 1, n]], [beta]]),
            np.concatenate([-dew[:n], dew[[n, n + 1]], [beta + 1.0]]),
            volumes,
        )

    def _solved(self, T: Array, v: Array, start: Array) -> tuple[Array, Array]:
        """Return u [n + 3, m], and which of the m are two phases."""
        n = self.f.n
        u, last = newton(lambda u: _residuals(self.f, T, v, u), start, range(n + 3), STEPS, 1e-2 * CLOSE)
        return u, (last < CLOSE) & (u[n] > u[n + 1]) & (np.abs(u[n + 2] - 0.5) < 0.6)

    def probe(self, T: float) -> None:
        """Raise ValueError where flashes across the dome fail at T [K]."""
        temperatures = np.full(PROBED, T)
        _, _, (liquid, vapour) = self.borders(temperatures)
        self(temperatures, liquid + np.linspace(0.0, 1.0, PROBED) * (vapour - liquid))

    def __call__(self, T: Array, v: Array) -> Flash:
        """Return the phases at T [m] [K] and v [m] [m³/mol]. Raises ValueError where there are none."""
        n = self.f.n
        bubble, dew, volumes = self.borders(T)
        w = (v - volumes[0]) / (volumes[1] - volumes[0])
        u, good = self._solved(T, v, bubble + (dew - bubble) * w)
        if not good.all():  # wide glide: continuation from the dew point
            far = ~good
            before = last = dew[:, far]
            for share in np.linspace(0.0, 1.0, WALK + 1)[1:]:
                at = volumes[1, far] + share * (v - volumes[1])[far]
                before, (last, good) = last, self._solved(T[far], at, 2.0 * last - before)
                if not good.all():
                    raise ValueError("no two phases")
            u[:, far] = last
        x, y = _parts(self.f, u)
        rho = np.exp(u[n : n + 2])
        log_f, p = self.f(T, rho[1], y)
        p = p * R * T
        z = self.f.z[:, None]
        return Flash(p, R * T * np.sum(z * log_f, axis=0) - p * v, u[n + 2], x, y, rho)


def references(known: Description, f: Fugacities, T: Array, rho: Array) -> Array:
    """Return Σ z_i μ°_i(T) [J/mol], which puts f of `Flash` on M311's reference, from one phase at any ρ [mol/m³]."""
    g = vectorised(potentials_kernel(known.name))(T, rho * known.molar_mass)[2] * known.molar_mass
    log_f, _ = f(T, rho, f.z[:, None] + 0.0 * T)
    return g - R * T * np.sum(f.z[:, None] * log_f, axis=0)


def _points(count: int) -> Array:
    return np.cos(np.pi * (np.arange(count) + 0.5) / count)


@lru_cache
def _fit(count: int) -> Array:
    """Return the matrix that maps values at Chebyshev points to coefficients of powers."""
    angle = np.pi * (np.arange(count, dtype=np.longdouble) + 0.5) / count
    to_cheb = 2.0 / count * np.cos(np.arange(count)[:, None] * angle)
    to_cheb[0] *= 0.5
    rows = [np.pad(row, (0, count - len(row))) for row in map(np.polynomial.chebyshev.cheb2poly, np.eye(count))]
    return np.array(rows).T @ to_cheb


def _edges(nearest: float, farthest: float) -> Array:
    """Return t = 1 − T/T_m of the cells' edges from warm to cold: each doubles its distance, up to the widest cell."""
    found = [nearest]
    while found[-1] < farthest:
        found.append(min(farthest, found[-1] + min(found[-1], WIDEST)))
    return np.array(found)


@dataclass(frozen=True)
class Dome:
    """The table of f(T, v) [J/kg] of two phases in equilibrium, from `edges[0]` to `edges[-1]` [K]."""

    edges: Array
    border: Array  # [cell of T, (v', v'' − v'), power] [m³/kg]
    c: Array  # [cell of T, cell of w, power of T, power of w]


def _tabulated(known: Description, flashes: Flashes, nearest: float, farthest: float) -> Dome:
    """Return the table of a blend between two values of 1 − T/T_m. Raises ValueError where a flash fails."""
    M, T_m = known.molar_mass, flashes.around.T_m
    farthest = min(farthest, 1.0 - flashes.around.T_low / T_m)
    edges = T_m * (1.0 - _edges(nearest, farthest))[::-1]
    s, half = _points(POINTS_T), 0.5 * np.diff(edges)
    T = (0.5 * (edges[1:] + edges[:-1]))[:, None] + half[:, None] * s  # [cell, point]
    _, _, volumes = flashes.borders(T.ravel())
    v = volumes.reshape(2, *T.shape) / M
    border = np.stack([v[0] @ _fit(POINTS_T).T, (v[1] - v[0]) @ _fit(POINTS_T).T], axis=1).astype(float)
    powers = np.vander(s, POINTS_T, increasing=True)
    least, wide = (border[:, i] @ powers.T for i in (0, 1))  # as the kernel computes them
    low, high = np.array(W_EDGES[:-1]), np.array(W_EDGES[1:])
    w = 0.5 * (high + low)[:, None] + 0.5 * (high - low)[:, None] * _points(POINTS_W)  # [cell of w, point]
    at_v = least[:, :, None, None] + wide[:, :, None, None] * w
    at_T = np.broadcast_to(T[:, :, None, None], at_v.shape)
    found = flashes(at_T.ravel(), at_v.ravel() * M)
    own = references(known, flashes.f, T.ravel(), 1.0 / volumes[1]).reshape(T.shape)
    f = (found.f.reshape(at_v.shape) + own[:, :, None, None]) / M
    c = np.einsum("as,isjr,br->ijab", _fit(POINTS_T), f, _fit(POINTS_W))
    by_r = np.vander(_points(POINTS_W), POINTS_W - 1, increasing=True) * np.arange(1, POINTS_W)
    p = -np.einsum("sa,ijab,rb->isjr", powers, c[..., 1:], by_r) * (2.0 / (high - low))[:, None]
    p /= wide[:, :, None, None]
    if not (np.abs(p / found.p.reshape(p.shape) - 1.0) < ALIKE).all():
        raise ValueError("another solution")
    return Dome(edges, border, c.astype(float))


def _solve(fluid: str) -> dict[str, Any]:
    known = describe(fluid)
    flashes = Flashes(known)
    for nearest, farthest in REACHES:
        try:
            for t in (nearest, *PROBES):
                flashes.probe(max(flashes.around.T_m * (1.0 - t), flashes.around.T_low))
            found = _tabulated(known, flashes, nearest, farthest)
        except ValueError:
            continue
        return {"edges": found.edges.tolist(), "border": found.border.tolist(), "c": found.c.tolist()}
    raise UsageError(f"gas.two_phase: {known.name}: no equilibrium of its two phases is found ({INSTEAD})")


@lru_cache(maxsize=16)
def table_name(fluid: str) -> str:
    """Return the name under which a blend's table is cached, with hashes of its equation and of the code behind it."""
    here = Path(__file__)
    sources = (here, *map(here.with_name, ("phase_envelope.py", "fugacity.py")))
    method = hashlib.sha256(b"".join(each.read_bytes() for each in sources)).hexdigest()[:10]
    return f"dome {potentials_kernel(fluid).flat_name} {method}"


@lru_cache(maxsize=16)
def dome(fluid: str) -> Dome:
    """Return the table of a blend, from the cache folder if it is there. Raises UsageError where it cannot be made."""
    if saturation(fluid).always_gas:
        raise UsageError(f"gas.two_phase: {describe(fluid).name}: its phase envelope is not known ({INSTEAD})")
    with announced("dome", f"{describe(fluid).name} in two phases", "some seconds"):
        found = cached_answer(table_name(fluid), lambda: _solve(fluid))
    return Dome(*(np.array(found[name]) for name in ("edges", "border", "c")))
