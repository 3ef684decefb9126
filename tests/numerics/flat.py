"""Rodas4 as the generated modules hold it: flattened kernels with slots filled here, run without a compiler."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from screwsim.numerics import rodas
from screwsim.numerics.kernel import flatten

Array = np.ndarray
SLOTS = ("surroundings", "rates", "jacobian", "at_breakpoint", "lands", "error_size", "share_in_phase", "conserve")
SLOTS += ("keep_port_states", "jump")


class Path(NamedTuple):
    """What an integration leaves behind."""

    status: int
    end: float
    y: Array
    q: Array
    times: Array
    dense: Array
    quads: Array
    counts: Array


class Problem(NamedTuple):
    """y' = f(φ, y) and q' = g(φ, y) with exact derivatives by y: `rates(φ, y)` → (f, g), `slopes(φ, y)` → (J, Jq)."""

    rates: Callable[[float, Array], tuple[Sequence[float], Sequence[float]]]
    slopes: Callable[[float, Array], tuple[Sequence[Sequence[float]], Sequence[Sequence[float]]]]
    jump: Callable[[float, Array], None] = lambda phi, y: None
    correct: Callable[[Array, Array, Array], None] = lambda y, y1, dq: None
    share: Callable[[Array, Array, Array, float], float] = lambda y, y1, u, rtol: 1.0
    lands: Callable[[float, Array], bool] = lambda h, J: True


def emitted(problem: Problem, states: int, quadratures: int) -> dict[str, Any]:
    """Return the names of the flat module with the problem in its slots."""

    def surroundings(phi: float, middle: float, context: Any, E: Array) -> None:
        E[0] = phi

    def rates(y: Array, E: Array, context: Any, f: Array, g: Array) -> None:
        f[:], g[:] = problem.rates(E[0], y)

    def jacobian(
        y: Array, E: Array, E_next: Array, delta: float, context: Any,
        f: Array, g: Array, J: Array, Jq: Array, f_phi: Array, g_phi: Array,
    ) -> None:  # fmt: skip
        f[:], g[:] = problem.rates(E[0], y)
        J[:], Jq[:] = problem.slopes(E[0], y)
        f_phi[:], g_phi[:] = (
            (np.array(b) - a) / delta for a, b in zip((f, g), problem.rates(E_next[0], y), strict=True)
        )

    def at_breakpoint(phi: float, y: Array, context: Any) -> None:
        problem.jump(phi, y)

    def conserve(y: Array, y1: Array, E: Array, E_next: Array, context: Any, dq: Array) -> None:
        problem.correct(y, y1, dq)

    def error_size(y: Array, y1: Array, error: Array, context: Any) -> float:
        return float(np.max(np.abs(error) / np.maximum(np.maximum(np.abs(y), np.abs(y1)), 1e-300)))  # NaN stays NaN

    def share_in_phase(y: Array, y1: Array, u: Array, rtol: float, context: Any) -> float:
        return problem.share(y, y1, u, rtol)

    names: dict[str, Any] = {"np": np, "math": __import__("math")}
    names |= {"p_surroundings": surroundings, "p_rates": rates, "p_jacobian": jacobian}
    names["p_at_breakpoint"] = at_breakpoint
    names |= {"p_error_size": error_size, "p_conserve": conserve}
    names["p_keep_port_states"] = lambda step, dense, context: None
    names["p_share_in_phase"], names["p_lands"] = share_in_phase, lambda h, J, *_: problem.lands(h, J)
    names["p_jump"] = lambda y, rtol, context: True
    sizes = {"STATES": states, "QUADRATURES": quadratures}
    text = flatten((rodas.integrate,), {name: f"p_{name}" for name in SLOTS}, "_p", sizes)
    exec("\n\n".join(text.values()), names)
    return names


def integrate(problem: Problem, breakpoints: Sequence[float], y0: Sequence[float], nq: int = 1, **options: Any) -> Path:
    """Integrate over the breakpoints; without `rtol` every stretch between two breakpoints is one step."""
    rtol, h, room = options.get("rtol", 1e30), options.get("h", 1e30), options.get("room", 5000)
    y, q, counts, kept = np.array(y0, float), np.zeros(nq), np.zeros(4, np.int64), np.zeros(2, np.int64)
    times, dense, quads = np.zeros(room + 1), np.zeros((room, 4, len(y))), np.zeros((room, nq))
    function = emitted(problem, len(y), nq)["rodas__integrate_p"]
    status, end, _ = function(
        np.array(breakpoints, float), len(breakpoints), y, q, (), rtol, h, 1, times, dense, quads, kept, counts
    )
    steps = int(kept[0])
    return Path(status, end, y, q, times[: steps + 1], dense[:steps], quads[:steps], counts)
