"""Fugacities of a blend's components, for finding its phases when tables are made: arrays, real or complex (M314).

At temperature T and density ρ = n/V the residual Helmholtz energy of n moles gives, with αʳ(δ, τ, x) and its Euler
derivatives D = δ ∂/∂δ, E = τ ∂/∂τ (Kunz & Wagner 2012, eqs. 7.28 ff., doi:10.1021/je300655b),
    ln(f_i/(R T)) = ln(x_i ρ) + αʳ + Dαʳ (1 − n∂ρ_r/∂n_i/ρ_r) + Eαʳ n∂T_r/∂n_i/T_r + ∂αʳ/∂x_i − Σ x_k ∂αʳ/∂x_k
and p/(R T) = ρ (1 + Dαʳ). The functions are those of `mixture`, generated from the same text as everywhere; callers
that need derivatives take complex steps.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from screwsim.fluid import terms
from screwsim.fluid.description import Description, describe
from screwsim.fluid.equation_text import EquationText
from screwsim.fluid.helmholtz import vectorised
from screwsim.fluid.mixture import Term, departure_terms, paired
from screwsim.numerics.kernel import written

Array = np.ndarray
Sums = Callable[[Any, Any], tuple[Any, Any, Any]]


def _sums(of: str, found: Sequence[Term]) -> Sums:
    """Return a function (δ, τ) → αʳ, Dαʳ, Eαʳ of the given terms."""
    text = EquationText(("A", "D", "E"))
    text.residual(found)
    text.finish()
    body = "\n".join(text.lines)
    head = ["inverse_tau = 1.0 / tau"]
    head += [f"log_{name} = math.log({name})" for name in ("tau", "delta") if f"log_{name}" in body]
    lines = ["def sums(delta, tau):", *(f"    {line}" for line in [*head, *text.lines, "return A, D, E"])]
    return vectorised(written("\n".join(lines) + "\n", of))


class Fugacities:
    """Fugacities and pressure of a blend's components at any composition."""

    def __init__(self, known: Description) -> None:
        parts = [describe(name) for name in known.components]
        self.n = len(parts)
        self.z = np.array(known.fractions)
        self.T_c, self.p_c, self.acentric = (
            np.array([getattr(one, what) for one in parts]) for what in ("T_c", "p_c", "acentric")
        )
        self.pure = [_sums(one.name, terms.residual_terms(one)) for one in parts]
        self.pairs = paired(known)
        self.departures = [
            _sums(pair.departure, departure_terms(pair.departure)) for *_, pair in self.pairs if pair.departure
        ]
        self.T_i = np.array([one.T_r for one in parts])
        self.v_i = np.array([one.molar_mass / one.rho_r for one in parts])

    def reducing(self, x: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Return (T_r, n∂T_r/∂n_i/T_r) and the same for 1/ρ_r, at mole fractions x [n, ...] (M312)."""
        T = _Quadratic(x, self.T_i)
        v = _Quadratic(x, self.v_i)
        for i, j, pair in self.pairs:
            T.add(i, j, pair.beta_T, pair.gamma_T * np.sqrt(self.T_i[i] * self.T_i[j]))
            v.add(i, j, pair.beta_v, pair.gamma_v * (np.cbrt(self.v_i[i]) + np.cbrt(self.v_i[j])) ** 3 / 8.0)
        return T.relative(), v.relative()

    def __call__(self, T: Any, rho: Any, x: Array) -> tuple[Array, Array]:
        """Return ln(f_i/(R T)) [n, ...] and p/(R T) [mol/m³] at T [K], rho [mol/m³] and mole fractions x [n, ...]."""
        (T_r, by_T), (v_r, by_v) = self.reducing(x)
        delta, tau = rho * v_r, T_r / T
        own = [sums(delta, tau) for sums in self.pure]
        slopes = [np.array(A) for A, _, _ in own]  # ∂αʳ/∂x_i
        A, D, E = (sum(x[i] * one[k] for i, one in enumerate(own)) for k in range(3))
        known = iter(self.departures)
        for i, j, pair in self.pairs:
            if not pair.departure:
                continue
            a, d, e = (pair.F * value for value in next(known)(delta, tau))
            A, D, E = A + x[i] * x[j] * a, D + x[i] * x[j] * d, E + x[i] * x[j] * e
            slopes[i] = slopes[i] + x[j] * a
            slopes[j] = slopes[j] + x[i] * a
        slope = np.array(slopes)
        mean = np.sum(x * slope, axis=0)
        return np.log(x * rho) + A + D * (1.0 + by_v) + E * by_T + slope - mean, rho * (1.0 + D)


class _Quadratic:
    """Y = Σ x_i² Y_i + Σ_{i<j} 2 x_i x_j β γ Y_ij (x_i + x_j)/(β² x_i + x_j), and its derivatives by x_i (M312)."""

    def __init__(self, x: Array, own: Array) -> None:
        self.x = x
        column = own.reshape(-1, *([1] * (x.ndim - 1)))
        self.value = np.sum(x * x * column, axis=0)
        self.slopes = 2.0 * x * column

    def add(self, i: int, j: int, beta: float, gamma_Y: float) -> None:
        a, b = self.x[i], self.x[j]
        c, below = 2.0 * beta * gamma_Y, beta * beta * a + b
        self.value = self.value + c * a * b * (a + b) / below
        self.slopes[i] += c * b * ((2.0 * a + b) / below - beta * beta * a * (a + b) / below**2)
        self.slopes[j] += c * a * ((a + 2.0 * b) / below - b * (a + b) / below**2)

    def relative(self) -> tuple[Array, Array]:
        """Return the value, and n∂/∂n_i of it over the value."""
        mean = np.sum(self.x * self.slopes, axis=0)
        return self.value, (self.slopes - mean) / self.value
