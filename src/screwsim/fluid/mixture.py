"""Terms of a fluid's Helmholtz energy at fixed composition: those of a pure fluid, or of a blend (M310–M313).

With mole fractions x, δ = ρ/ρ_r(x) and τ = T_r(x)/T of the blend (Kunz & Wagner 2012, doi:10.1021/je300655b, as
CoolProp evaluates it):
    α = Σ x_i (R_i/R) (α⁰_i(ρ, T) + ln x_i) + Σ x_i αʳ_i(δ, τ) + Σ_{i<j} x_i x_j F_ij αʳ_ij(δ, τ).
CoolProp's weights x_i R_i/R, with gas constants from before 2019, add up to 1 within 1e-6; the weight of ln ρ is
exactly 1 here, since otherwise T ds = du + p d(1/ρ) would fail by as much. So a blend is just a longer list of terms,
each with its weight. Departure functions: `departures.json`, those of CoolProp 8.0.0 (its
dev/mixtures/mixture_departure_functions.json, MIT licence), which names their sources; CoolProp does not provide them
at run time. Weights, pairs and reducing parameters are read from it.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import combinations
from math import exp, log
from pathlib import Path
from typing import Any

from screwsim.fluid import terms
from screwsim.fluid.composition import REMEDY
from screwsim.fluid.description import ComponentPair, Description, describe
from screwsim.fluid.terms import NONE, Factor, Ideal, NonAnalytic, Product
from screwsim.inputs.faults import UsageError

Term = Product | NonAnalytic


@cache
def _departures() -> Mapping[str, Any]:
    return json.loads(Path(__file__).with_name("departures.json").read_text(encoding="utf-8"))


def _special(n: float, d: float, t: float, eta: float, epsilon: float, beta: float, gamma: float) -> Product:
    """Return n δ^d τ^t exp(−η (δ − ε)² − β (δ − γ)) of GERG-2008, with the square in its exponent completed."""
    if eta == 0.0:
        decay: Factor = ("power", beta, 1.0) if beta else NONE
        return Product(n * exp(beta * gamma), d, t, decay)
    center = epsilon - 0.5 * beta / eta
    return Product(n * exp(beta * gamma - eta * (epsilon**2 - center**2)), d, t, ("bell", eta, center))


def departure_terms(name: str) -> list[Product]:
    """Return the terms of a departure function by its name (M313). Raises UsageError for an unknown name."""
    found = _departures().get(name)
    if found is None:
        raise UsageError(
            f"gas.fluid: this version of CoolProp uses the departure function {name}, which is not known here; {REMEDY}"
        )
    n, d, t = (found[key] for key in "ndt")
    powers = len(n) if found["type"] == "Exponential" else int(found["Npower"])
    orders = found.get("l", [0] * powers)
    plain = [
        Product(float(a), float(b), float(c), ("power", 1.0, float(order)) if order else NONE)
        for a, b, c, order in zip(n[:powers], d[:powers], t[:powers], orders[:powers], strict=True)
    ]
    bells = (
        [float(x) for x in found[key][powers:]]
        for key in ("n", "d", "t", "eta", "epsilon", "beta", "gamma")
        if powers < len(n)
    )
    rows = list(zip(*bells, strict=True))
    if found["type"] == "GERG-2008":
        return plain + [_special(*row) for row in rows]
    return plain + [
        Product(a, b, c, ("bell", eta, eps), ("bell", beta, gamma)) for a, b, c, eta, eps, beta, gamma in rows
    ]


def paired(known: Description) -> list[tuple[int, int, ComponentPair]]:
    """Return (i, j, pair) of all pairs of a blend's components."""
    return [
        (i, j, pair) for (i, j), pair in zip(combinations(range(len(known.components)), 2), known.pairs, strict=True)
    ]


def _weighted(weight: float, found: Sequence[Term]) -> list[Term]:
    return [replace(term, n=weight * term.n) for term in found]


def residual_terms(known: Description) -> list[Term]:
    """Return the residual terms of a fluid, for a blend with their weights (M310)."""
    if not known.blend:
        return terms.residual_terms(known)
    x = known.fractions
    found: list[Term] = []
    for name, share in zip(known.components, x, strict=True):
        found += _weighted(share, terms.residual_terms(describe(name)))
    for i, j, pair in paired(known):
        if pair.departure:
            found += _weighted(x[i] * x[j] * pair.F, departure_terms(pair.departure))
    return found


def ideal_terms(known: Description) -> Ideal:
    """Return the ideal-gas terms of a fluid, for a blend in terms of the blend's own δ and τ (M311)."""
    if not known.blend:
        return terms.ideal_terms(known)
    total = Ideal()
    R = known.R * known.molar_mass
    for name, x in zip(known.components, known.fractions, strict=True):
        one = describe(name)
        weight = x * one.R * one.molar_mass / R
        _add(total, terms.ideal_terms(one), weight, one, known)
        total.constant += weight * log(x)
    return total


def _add(total: Ideal, own: Ideal, w: float, one: Description, known: Description) -> None:
    """Add w times a component's ideal part, whose δ_i = d δ and τ_i = s τ.

    CoolProp reduces it by the component's critical point, which may differ from the reducing one (R134a: by 0.03 K).
    """
    T_i, rho_i = one.ideal_state
    s, d = T_i / known.T_r, known.rho_r / known.molar_mass / rho_i
    total.constant += w * (own.constant + log(d) + own.log * log(s))
    total.linear += w * s * (own.linear + own.product * log(s))
    total.log += w * own.log
    total.product += w * s * own.product
    total.powers += [(w * n * s**t, t) for n, t in own.powers]
    total.oscillators += [(w * n, s * theta, c, e) for n, theta, c, e in own.oscillators]
