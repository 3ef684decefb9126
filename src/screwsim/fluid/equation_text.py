"""The Helmholtz equation of state of one fluid, written out term by term as source text of kernels.

With Euler's operators D = δ ∂/∂δ and E = τ ∂/∂τ a product N = n δ^d τ^t e^A(δ) e^B(τ) has
    D N = q N,  D²N = (q² + Dq) N,  E N = r N,  E²N = (r² + Er) N,  D E N = q r N,   q = d + D A,  r = t + E B,
and everything that a simulation needs is a sum of these (Span 2000, table 3.10, rewritten):
    p = ρ R T (1 + Dα),  T p_T = ρ R T (1 + Dα − D E α),  p_ρ = R T (1 + Dα + D²α),
    h = R T (1 + Eα⁰ + Eα + Dα),  c_v = R (−(E² − E)(α⁰ + α)),  s = R (Eα⁰ + Eα − α⁰ − α)     (α residual).
"""

from collections import defaultdict
from collections.abc import Sequence

from screwsim.fluid.powers import Powers
from screwsim.fluid.terms import NONE, Factor, Ideal, NonAnalytic, Product

ALL = ("A", "D", "E", "DD", "EE", "DE")


class EquationText:
    """Writes the wanted sums of `A, D, E, DD, EE, DE` of the residual part, and the ideal part, as lines of text."""

    def __init__(self, wanted: Sequence[str]) -> None:
        self.wanted = tuple(wanted)
        self.lines: list[str] = []
        self.sums: dict[str, list[str]] = defaultdict(list)
        self.delta = Powers(self.lines, "delta", "(1.0 / delta)", "log_delta")
        self.tau = Powers(self.lines, "tau", "inverse_tau", "log_tau")
        self.factors: dict[tuple[str, Factor], tuple[str, str, str]] = {}
        self.count = 0

    def new(self, text: str, stem: str = "v") -> str:
        """Write `name = text` with a new name and return the name."""
        self.count += 1
        name = f"{stem}{self.count}"
        self.lines.append(f"{name} = {text}")
        return name

    def add(self, kind: str, text: str) -> None:
        """Add a summand to one of the sums, if that sum is wanted."""
        if kind in self.wanted:
            self.sums[kind].append(text)

    def finish(self) -> None:
        """Write the sums under their own names."""
        for kind in self.wanted:
            self.lines.append(f"{kind} = {' + '.join(self.sums[kind]) or '0.0'}")

    # ---- residual part --------------------------------------------------------------------------------------

    def residual(self, terms: Sequence[Product | NonAnalytic]) -> None:
        """Write all residual terms."""
        plain: dict[Factor, list[Product]] = defaultdict(list)
        products = [term for term in terms if isinstance(term, Product)]
        for term in products:
            if term.of_tau == NONE and term.of_delta[0] in ("none", "power"):
                plain[term.of_delta].append(term)
        grouped = [term for group in plain.values() for term in group]
        self.delta.write([term.d for term in products] + [float(factor[2]) for factor in plain if factor != NONE])
        self.tau.write([term.t for term in grouped])
        # exponentials first: a call among the sums would spill registers
        decays = {factor: self._decay(factor) for factor in plain if factor != NONE}
        for factor, group in plain.items():
            self._polynomial(factor, group, decays.get(factor, ""))
        for term in products:
            if term not in grouped:
                self._product(term)
        for term in terms:
            if isinstance(term, NonAnalytic):
                self._non_analytic(term)

    def _decay(self, factor: Factor) -> str:
        _, g, order = factor
        power = self.delta.name(order)
        return self.new(f"math.exp(-{power})" if g == 1.0 else f"math.exp({-g!r} * {power})", "e")

    def _polynomial(self, factor: Factor, group: Sequence[Product], e: str) -> None:
        """Write Σ n δ^d τ^t e^(−g δ^l) of one l: sums over τ for each d, then over d, then the exponential."""
        by_d: dict[float, list[Product]] = defaultdict(list)
        for term in group:
            by_d[term.d].append(term)
        sums: dict[str, list[str]] = {kind: [] for kind in ALL}
        for d, terms in sorted(by_d.items()):
            base: str | None = None
            for power, kinds in ((0, ("A", "D", "DD")), (1, ("E", "DE")), (2, ("EE",))):
                if not set(kinds) & set(self.wanted):
                    continue
                if power and len(terms) == 1 and base:
                    t = terms[0].t ** power
                    name = (base if t == 1.0 else self.new(f"{t!r} * {base}", "s")) if t else None
                else:
                    name = self._scaled(self.delta.name(d), [(term.n * term.t**power, term.t) for term in terms])
                base = base or name
                for times, kind in enumerate(kinds):
                    weight = d**times
                    if name and weight:
                        sums[kind].append(name if weight == 1.0 else f"{weight!r} * {name}")
        total = {kind: self.new(" + ".join(items) or "0.0", "P") for kind, items in sums.items()}
        if factor == NONE:
            for kind in self.wanted:
                self.add(kind, total[kind])
            return
        _, g, order = factor
        power = self.delta.name(order)
        L = self.new(f"{g * order!r} * {power}" if g * order != 1.0 else power, "L")
        for kind in ("A", "E", "EE"):
            if kind in self.wanted:
                self.add(kind, f"{e} * {total[kind]}")
        A, D = total["A"], total["D"]
        self.add("D", f"{e} * ({D} - {L} * {A})")
        self.add("DE", f"{e} * ({total['DE']} - {L} * {total['E']})")
        self.add("DD", f"{e} * ({total['DD']} - {L} * (2.0 * {D} - ({L} - {order!r}) * {A}))")

    def _scaled(self, x: str, terms: Sequence[tuple[float, float]]) -> str | None:
        """Write δ^d Σ n τ^t and return its name; None where all n are zero."""
        parts = [repr(n) if t == 0.0 else f"{n!r} * {self.tau.name(t)}" for n, t in terms if n != 0.0]
        if not parts:
            return None
        total = " + ".join(parts)
        if x != "1.0":
            total = f"{x} * ({total})"
        return self.new(total, "s")

    def _factor(self, variable: str, factor: Factor) -> tuple[str, str, str]:
        """Return names of (exponent B, x B', x (x B')') of a factor e^B(x), written once."""
        key = (variable, factor)
        if key in self.factors:
            return self.factors[key]
        kind, *numbers = factor
        if kind == "none":
            found = ("0.0", "0.0", "0.0")
        elif kind == "power":
            g, order = numbers
            B = self.new(f"{-g!r} * {(self.delta if variable == 'delta' else self.tau).name(order)}", "B")
            found = (B, self.new(f"{order!r} * {B}", "q"), self.new(f"{order * order!r} * {B}", "q"))
        elif kind == "bell":
            eta, center = numbers
            z = self.new(f"{variable} - {center!r}", "z")
            slope = self.new(f"{-2.0 * eta!r} * {variable}", "z")
            B, q = self.new(f"{-eta!r} * {z} * {z}", "B"), self.new(f"{slope} * {z}", "q")
            found = (B, q, self.new(f"{slope} * ({variable} + {z})", "q"))
        else:
            beta, gamma, b = numbers
            z = self.new(f"{variable} - {gamma!r}", "z")
            B = self.new(f"1.0 / ({b!r} + {beta!r} * {z} * {z})", "B")
            slope = self.new(f"{-2.0 * beta!r} * {variable} * {B} * {B}", "z")
            q = self.new(f"{slope} * {z}", "q")
            bend = f"{4.0 * beta!r} * {variable} * {z} * {z} * {B} * (-{slope})"
            found = (B, q, self.new(f"{slope} * ({variable} + {z}) + {bend}", "q"))
        self.factors[key] = found
        return found

    def _product(self, term: Product) -> None:
        """Write one product with factors in both variables."""
        A, q, dq = self._factor("delta", term.of_delta)
        B, r, dr = self._factor("tau", term.of_tau)
        exponent = [item for item in (A, B) if item != "0.0"]
        front = [repr(term.n), *([self.delta.name(term.d)] if term.d else [])]
        if self.tau.cheap(term.t):
            front += [self.tau.name(term.t)] if term.t else []
        else:
            exponent.append(f"{term.t!r} * log_tau")
        N = self.new(" * ".join([*front, f"math.exp({' + '.join(exponent)})"]), "N")
        q = self.new(f"{term.d!r} + {q}", "q")
        r = self.new(f"{term.t!r} + {r}", "r")
        self._add_product(N, q, dq, r, dr, "0.0")

    def _add_product(self, N: str, q: str, dq: str, r: str, dr: str, cross: str) -> None:
        self.add("A", N)
        self.add("D", f"{q} * {N}")
        self.add("DD", f"({q} * {q} + {dq}) * {N}")
        self.add("E", f"{r} * {N}")
        self.add("EE", f"({r} * {r} + {dr}) * {N}")
        self.add("DE", f"{q} * {r} * {N}" if cross == "0.0" else f"({q} * {r} + {cross}) * {N}")

    def _non_analytic(self, term: NonAnalytic) -> None:
        """Write one non-analytic term; 1e-40 keeps it finite at the critical point and changes nothing elsewhere."""
        new, m, a, b = self.new, 0.5 / term.beta, term.a, term.b
        if ("x", NONE) not in self.factors:
            x = new("delta - 1.0", "x")
            square = new(f"{x} * {x} + 1e-40", "x")
            self.factors["x", NONE] = (x, square, new(f"math.log({square})", "x"))
        x, square, log_x = self.factors["x", NONE]
        if ("u", ("", m, a)) not in self.factors:
            u1 = new(f"math.exp({m - 1.0!r} * {log_x})", "u")
            v1 = new(f"math.exp({a - 1.0!r} * {log_x})", "u")
            self.factors["u", ("", m, a)] = (u1, v1, "")
        u1, v1, _ = self.factors["u", ("", m, a)]  # x^(m−1), x^(a−1) of x = (δ−1)²
        theta = new(f"1.0 - tau + {term.A!r} * {u1} * {square}", "t")
        theta_d = new(f"{2.0 * m * term.A!r} * {x} * {u1}", "t")
        Delta = new(f"{theta} * {theta} + {term.B!r} * {v1} * {square} + 1e-40", "w")
        over = new(f"{b!r} / {Delta}", "w")
        Dd = new(f"2.0 * {theta} * {theta_d} + {2.0 * a * term.B!r} * {x} * {v1}", "w")
        Ddd = new(
            f"2.0 * {theta_d} * {theta_d} + {4.0 * m * (2.0 * m - 1.0) * term.A!r} * {theta} * {u1}"
            f" + {2.0 * a * (2.0 * a - 1.0) * term.B!r} * {v1}",
            "w",
        )
        N = new(
            f"{term.n!r} * delta * math.exp({b!r} * math.log({Delta}) + {-term.C!r} * {x} * {x}"
            f" + {-term.D!r} * (tau - 1.0) * (tau - 1.0))",
            "N",
        )
        slope = new(f"delta * {over} * {Dd}", "w")
        q = new(f"1.0 + {slope} + {-2.0 * term.C!r} * delta * {x}", "q")
        dq = new(
            f"{slope} + delta * delta * {over} * {Ddd} - {slope} * {slope} * {1.0 / b!r}"
            f" + {-2.0 * term.C!r} * delta * (delta + {x})",
            "q",
        )
        down = new(f"-2.0 * tau * {over} * {theta}", "w")
        r = new(f"{down} + {-2.0 * term.D!r} * tau * (tau - 1.0)", "r")
        dr = new(
            f"{down} + 2.0 * tau * tau * {over} - {down} * {down} * {1.0 / b!r}"
            f" + {-2.0 * term.D!r} * tau * (2.0 * tau - 1.0)",
            "r",
        )
        cross = new(f"-2.0 * delta * tau * {over} * {theta_d} - {slope} * {down} * {1.0 / b!r}", "r")
        self._add_product(N, q, dq, r, dr, cross)

    # ---- ideal part -----------------------------------------------------------------------------------------

    def ideal(self, ideal: Ideal) -> None:
        """Write `E0` = E α⁰; also `C0` = (E − E²) α⁰ if EE is wanted, and `A0` = α⁰ if A is wanted."""
        value, first, second = [f"log_delta + {ideal.constant!r}"], [repr(ideal.log)], [repr(ideal.log)]
        if ideal.linear:
            value.append(f"{ideal.linear!r} * tau")
            first.append(f"{ideal.linear!r} * tau")
        if ideal.log:
            value.append(f"{ideal.log!r} * log_tau")
        if ideal.product:  # E(τ ln τ) = τ ln τ + τ, E² − E of it = τ
            value.append(f"{ideal.product!r} * tau * log_tau")
            first.append(f"{ideal.product!r} * tau * (log_tau + 1.0)")
            second.append(f"{-ideal.product!r} * tau")
        for n, t in ideal.powers:
            x = self.tau.name(t)
            value.append(f"{n!r} * {x}")
            first.append(f"{n * t!r} * {x}")
            second.append(f"{-n * t * (t - 1.0)!r} * {x}")
        for n, theta, c, d in ideal.oscillators:
            front = {1.0: "", -1.0: "-"}.get(d, f"{d!r} * ")
            e = self.new(f"{front}math.exp({theta!r} * tau)", "e")
            over = self.new(f"{theta!r} * tau / ({c!r} + {e})", "o")
            share = self.new(f"{over} * {e}", "o")
            value.append(f"{n!r} * math.log({c!r} + {e})")
            first.append(f"{n!r} * {share}")
            second.append(f"{-n * c!r} * {over} * {share}")
        self.lines.append(f"E0 = {' + '.join(first)}")
        if "EE" in self.wanted:
            self.lines.append(f"C0 = {' + '.join(second)}")
        if "A" in self.wanted:
            self.lines.append(f"A0 = {' + '.join(value)}")
