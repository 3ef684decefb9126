"""Terms of a Helmholtz equation of state in a few common forms, from CoolProp's contributions.

α(δ, τ) = α⁰ + αʳ with δ = ρ/ρ_r, τ = T_r/T. Residual terms are
    n δ^d τ^t · exp(factor of δ) · exp(factor of τ)      `Product`: power, exponential, Gaussian, Gao's, Lemmon's
    n Δ^b δ ψ                                            `NonAnalytic`: Span & Wagner 1996 (critical region)
and ideal-gas terms those of `Ideal`. Terms that cannot be written in these forms are refused by name.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from math import log
from typing import Any

from screwsim.fluid.description import Description
from screwsim.inputs.faults import UsageError

Factor = tuple[str, *tuple[float, ...]]
NONE: Factor = ("none",)


@dataclass(frozen=True)
class Product:
    """n δ^d τ^t exp(A(δ)) exp(B(τ)).

    A factor is ('none',), ('power', g, l): −g x^l, ('bell', η, ε): −η (x − ε)², or ('gao', β, γ, b):
    1/(b + β (x − γ)²).
    """

    n: float
    d: float
    t: float
    of_delta: Factor = NONE
    of_tau: Factor = NONE


@dataclass(frozen=True)
class NonAnalytic:
    """n Δ^b δ exp(−C (δ−1)² − D (τ−1)²), Δ = (1−τ + A (δ−1)^(1/β))² + B (δ−1)^(2a)."""

    n: float
    a: float
    b: float
    beta: float
    A: float
    B: float
    C: float
    D: float


@dataclass
class Ideal:
    """α⁰ = ln δ + constant + linear τ + log ln τ + product τ ln τ + Σ n τ^t + Σ n ln(c + d e^(θτ))."""

    constant: float = 0.0
    linear: float = 0.0
    log: float = 0.0
    product: float = 0.0
    powers: list[tuple[float, float]] = field(default_factory=list)  # n, t
    oscillators: list[tuple[float, float, float, float]] = field(default_factory=list)  # n, θ, c, d


Contribution = Mapping[str, Any]


def _rows(item: Contribution, *names: str) -> Iterator[tuple[float, ...]]:
    return zip(*([float(value) for value in item[name]] for name in names), strict=True)


def _decay(g: float, order: float) -> Factor:
    return ("power", g, order) if order and g else NONE


# kind of contribution: its columns, and the term that a row of them makes
RESIDUAL: dict[str, tuple[str, Callable[..., Product | NonAnalytic]]] = {
    "ResidualHelmholtzPower": ("n d t l", lambda n, d, t, order: Product(n, d, t, _decay(1.0, order))),
    "ResidualHelmholtzExponential": ("n d t g l", lambda n, d, t, g, order: Product(n, d, t, _decay(g, order))),
    "ResidualHelmholtzGaussian": (
        "n d t eta epsilon beta gamma",
        lambda n, d, t, eta, eps, beta, gamma: Product(n, d, t, ("bell", eta, eps), ("bell", beta, gamma)),
    ),
    "ResidualHelmholtzGaoB": (
        "n d t eta epsilon beta gamma b",
        lambda n, d, t, eta, eps, beta, gamma, b: Product(n, d, t, ("bell", -eta, eps), ("gao", beta, gamma, b)),
    ),
    "ResidualHelmholtzLemmon2005": (
        "n d t l m",
        lambda n, d, t, order, m: Product(n, d, t, _decay(1.0, order), _decay(1.0, m)),
    ),
    "ResidualHelmholtzDoubleExponential": (
        "n d t gd ld gt lt",
        lambda n, d, t, gd, ld, gt, lt: Product(n, d, t, ("power", gd, ld), ("power", gt, lt)),
    ),
    "ResidualHelmholtzNonAnalytic": ("n a b beta A B C D", NonAnalytic),
}


def _lead(ideal: Ideal, item: Contribution) -> None:
    ideal.constant += item["a1"]
    ideal.linear += item["a2"]


def _log_tau(ideal: Ideal, item: Contribution) -> None:
    ideal.log += item["a"]


def _powers(ideal: Ideal, item: Contribution) -> None:
    ideal.powers += _rows(item, "n", "t")  # type: ignore[arg-type]


def _einstein(ideal: Ideal, item: Contribution) -> None:
    """Add Planck-Einstein terms in any notation: with θ, with v/T_c, or with c and d of their own."""
    if "c" in item:
        ideal.oscillators += _rows(item, "n", "t", "c", "d")  # type: ignore[arg-type]
    elif "v" in item:
        ideal.oscillators += [(n, -v / item["Tcrit"], 1.0, -1.0) for n, v in _rows(item, "n", "v")]
    else:
        ideal.oscillators += [(n, -t, 1.0, -1.0) for n, t in _rows(item, "n", "t")]


def _constant_cp(ideal: Ideal, item: Contribution, cp_over_R: float | None = None) -> None:
    """Add a constant cp⁰/R: that of the item, or the given one."""
    tau_0 = item["Tc"] / item["T0"]
    share: float = item["cp_over_R"] if cp_over_R is None else cp_over_R
    ideal.constant += share * (1.0 - log(tau_0))
    ideal.linear -= share / tau_0
    ideal.log += share


def _cp_polynomial(ideal: Ideal, item: Contribution) -> None:
    """Add ∫∫ of cp⁰/R = Σ c T^t: t = 0 and t = −1 give logarithms."""
    T_c, T_0 = item["Tc"], item["T0"]
    for c, t in _rows(item, "c", "t"):
        if abs(t) < 1e-15:
            _constant_cp(ideal, item, c)
        elif abs(t + 1.0) < 1e-15:
            ideal.linear += c / T_c * (log(T_c / T_0) + 1.0)
            ideal.product -= c / T_c
            ideal.constant -= c / T_0
        else:
            ideal.powers.append((-c * T_c**t / (t * (t + 1.0)), -t))
            ideal.linear -= c * T_0 ** (t + 1.0) / (T_c * (t + 1.0))
            ideal.constant += c * T_0**t / t


def _aly_lee(ideal: Ideal, item: Contribution) -> None:
    """Add cp⁰/R = A + B ((C/T)/sinh(C/T))² + D ((E/T)/cosh(E/T))² (Aly & Lee 1981)."""
    A, B, C, D, E = item["c"]
    if A:
        _constant_cp(ideal, item, A)
    ideal.oscillators += [(n, -2.0 * x / item["Tc"], 1.0, s) for n, x, s in ((B, C, -1.0), (-D, E, 1.0)) if n]


IDEAL: dict[str, Callable[[Ideal, Contribution], None]] = {
    "IdealGasHelmholtzLead": _lead,
    "IdealGasHelmholtzEnthalpyEntropyOffset": _lead,
    "IdealGasHelmholtzLogTau": _log_tau,
    "IdealGasHelmholtzPower": _powers,
    "IdealGasHelmholtzPlanckEinstein": _einstein,
    "IdealGasHelmholtzPlanckEinsteinFunctionT": _einstein,
    "IdealGasHelmholtzPlanckEinsteinGeneralized": _einstein,
    "IdealGasHelmholtzCP0Constant": _constant_cp,
    "IdealGasHelmholtzCP0PolyT": _cp_polynomial,
    "IdealGasHelmholtzCP0AlyLee": _aly_lee,
}


def _refuse(fluid: str, kind: str) -> UsageError:
    return UsageError(
        f"gas.fluid: {fluid}: its equation has the term {kind}, which gas.model: real does not support; use "
        "gas.model: ideal, or a fluid such as R134a, Ammonia, CarbonDioxide"
    )


def residual_terms(fluid: Description) -> list[Product | NonAnalytic]:
    """Return the residual terms of a fluid. Raises UsageError for an unknown kind of term."""
    found: list[Product | NonAnalytic] = []
    for item in fluid.residual:
        if item["type"] not in RESIDUAL:
            raise _refuse(fluid.name, item["type"])
        columns, term = RESIDUAL[item["type"]]
        found += [term(*row) for row in _rows(item, *columns.split())]
    return found


def ideal_terms(fluid: Description) -> Ideal:
    """Return the ideal-gas terms of a fluid. Raises UsageError for an unknown kind of term."""
    found = Ideal()
    for item in fluid.ideal:
        if item["type"] not in IDEAL:
            raise _refuse(fluid.name, item["type"])
        IDEAL[item["type"]](found, item)
    return found
