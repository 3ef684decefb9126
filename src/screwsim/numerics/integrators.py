"""The registry of integrators: our own by their coefficients, scipy's as checks, a user's own by the name of a module.

A Rosenbrock method in the form of `numerics.rodas` is compiled into the model and can do everything that Rodas4 does. A
check integrates all chambers together, starting from the cycle that our own method closed. A user's own integrator is a
module with a variable INTEGRATOR, named in a scene as an effect of the user's own is: `numerics.integrator:
my_integrators.rodasp`.
"""

import re
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from screwsim.numerics import rodas, rodas3
from screwsim.numerics.kernel import constant_text
from screwsim.numerics.trial import registry_entry

ROUNDING = 1e-9  # allowance for rounding of published coefficients


@dataclass(frozen=True, eq=False)
class Rosenbrock:
    """Coefficients of a method in the notation of `rodas`: γ, a_ij, C_ij, c_i, d_i; c3 and c4 of the dense output.

    The last two stages are evaluated at the end of the step, which is y + Σ a_5j u_j + u_5, with the error estimate
    u_5.
    """

    order: int
    gamma: float
    a: np.ndarray
    c: np.ndarray
    nodes: np.ndarray
    d: np.ndarray
    dense: np.ndarray

    def __post_init__(self) -> None:
        flaw = self._flaw()
        if flaw:
            raise ValueError(f"its coefficients {flaw}")

    @cached_property
    def couplings(self) -> tuple[np.ndarray, np.ndarray]:
        """α_ij and Γ = γ_ij of the method in its untransformed form, from A = α Γ^(−1) and C = 1/γ − Γ^(−1)."""
        padding = np.zeros((len(self.a), 1))
        gamma = np.linalg.inv(np.eye(len(self.a)) / self.gamma - np.hstack([self.c, padding]))
        return np.hstack([self.a, padding]) @ gamma, gamma

    def conditions(self) -> list[tuple[int, float, float]]:
        """Return (order, left side, right side) of the order conditions up to order 4."""
        (alpha, gamma), one = self.couplings, np.ones(len(self.a))
        b, beta, at = np.append(self.a[-1], 1.0) @ gamma, alpha + gamma, alpha @ one
        found = [(1, one, 1), (2, beta @ one, 2), (3, at**2, 3), (3, beta @ beta @ one, 6), (4, at**3, 4)]
        found += [(4, at * (alpha @ beta @ one), 8), (4, beta @ at**2, 12), (4, beta @ beta @ beta @ one, 24)]
        return [(order, float(b @ each), 1.0 / share) for order, each, share in found]

    def _flaw(self) -> str:
        """Return what is wrong with the coefficients for a method of their order; empty where nothing is."""
        n = len(self.nodes)
        shapes = [np.shape(each) for each in (self.a, self.c, self.d, self.dense)]
        if shapes != [(n, n - 1), (n, n - 1), (n,), (2, n)]:
            return f"have the shapes {shapes}, not those of {n} stages"
        (alpha, gamma), one = self.couplings, np.ones(n)
        if not np.allclose(alpha @ one, self.nodes, atol=ROUNDING) or not np.all(self.nodes[-2:] == 1.0):
            return "are not those of its nodes"
        if not np.allclose(gamma @ one, self.d, atol=ROUNDING):
            return "are not those of its d_i"
        off = [(order, abs(found - wanted)) for order, found, wanted in self.conditions()]
        wrong = [order for order, size in off if order <= self.order and size > ROUNDING]
        if wrong:
            return f"do not meet the conditions of order {wrong[0]}"
        slopes = (alpha + gamma) @ one
        for theta in (0.3, 0.7):
            curve = (1.0 - theta) * (self.dense[0] + theta * self.dense[1])
            inside = theta * (np.append(self.a[-1], 1.0) + curve) @ gamma
            if abs(inside @ one - theta) > ROUNDING or abs(inside @ slopes - 0.5 * theta**2) > ROUNDING:
                return "give no dense output of order 2"
        return ""

    @property
    def constants(self) -> dict[str, Any]:
        """The constants of `rodas` in which methods differ."""
        beta, stages = rodas.quadrature_weights(self.gamma, self.a, self.c), len(self.nodes)
        sizes = {"STAGES": stages, "LAST": stages - 1, "DENSE_STAGES": stages, "POWER": -1.0 / self.order}
        sizes |= {"GAMMA": self.gamma, "A": self.a, "C": self.c, "NODES": self.nodes, "D": self.d, "DENSE": self.dense}
        return sizes | {"BETA": beta, "BETA_D": float(beta @ self.d)}

    def into(self, text: str) -> str:
        """Return a model's text with this method in place of Rodas4."""
        for name, value in self.constants.items() if self is not RODAS4 else ():
            line = f"rodas__{name} = {constant_text(value)}"
            text, found = re.subn(rf"^rodas__{name} = .*$", line, text, flags=re.MULTILINE)
            if found != 1:
                raise ValueError(f"the model's text has {found} constants {name}")
        return text


@dataclass(frozen=True)
class Check:
    """A method of scipy's `solve_ivp`: its name there, or a subclass of OdeSolver. An implicit one takes a Jacobian."""

    method: Any
    implicit: bool = True


Integrator = Rosenbrock | Check
RODAS4 = Rosenbrock(rodas.ORDER, rodas.GAMMA, rodas.A, rodas.C, rodas.NODES, rodas.D, rodas.DENSE)
RODAS3 = Rosenbrock(rodas3.ORDER, rodas3.GAMMA, rodas3.A, rodas3.C, rodas3.NODES, rodas3.D, rodas3.DENSE)
DEFAULT = "rodas4"
INTEGRATORS: dict[str, Integrator] = {  # those that scenes can name
    DEFAULT: RODAS4,
    "scipy-radau": Check("Radau"),
    "scipy-bdf": Check("BDF"),
    "scipy-lsoda": Check("LSODA"),
}
STUDIED: dict[str, Integrator] = {  # in studies only: rodas3 saves next to nothing, explicit methods are far too slow
    "rodas3": RODAS3,
    "scipy-rk45": Check("RK45", implicit=False),
    "scipy-dop853": Check("DOP853", implicit=False),
}
CHECKS = tuple(name for name, each in (INTEGRATORS | STUDIED).items() if isinstance(each, Check))


def find_integrator(name: str) -> Integrator:
    """Return the integrator of a name; raise KeyError where there is none, ImportError for a dotted one that fails."""
    return registry_entry(INTEGRATORS | STUDIED, name, "INTEGRATOR", Rosenbrock, Check)


def check_of(name: str) -> Check | None:
    """Return an integrator as a check; None for one that closes cycles by itself."""
    found = find_integrator(name)
    return found if isinstance(found, Check) else None
