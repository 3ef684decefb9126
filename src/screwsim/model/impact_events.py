"""Impacts on seat and stop under scipy's integrators, which find them as terminal events of their own.

Source: docs/reference/slider-crank.md S32, S33. What happens there is that of `model.impacts`: only the place is found
otherwise.
"""

from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import numpy as np

from screwsim.model.impacts import LEAVES, MOVES, SEATED, STOPPED
from screwsim.model.port_states import SHARP

Array = np.ndarray


class ImpactEvents:
    """What the pairs of positions and speeds of one chamber meet during a turn."""

    def __init__(
        self,
        module: ModuleType,
        states: int,
        pairs: Sequence[tuple[int, int]],
        own: Array,
        first: int,
        around: tuple[Any, ...],
    ) -> None:
        """`own` holds the modes from index `first` on; `around` is (R, P, TAB) of the machinery."""
        self.module, self.pairs, self.own, self.first, self.around = module, pairs, own, first, around
        self.rtol = 0.0
        self.least = np.zeros(states)
        self.least[np.array(pairs).ravel()] = SHARP
        self._due: list[tuple[int, float]] = []

    def begin(self, y: Array, rtol: float) -> None:
        """Set the modes at the start of a turn, from its state (changed in place)."""
        self.rtol = rtol
        self.module.chamber__begin_modes(y, self.own, *self.around)

    def watched(self, t: float, y: Array) -> list[Callable[[float, Array], float]]:
        """Return scipy's terminal events from angle t [rad] and state y on."""
        found, self._due = [], []
        for k, (position, _) in enumerate(self.pairs):
            side = float(self.own[self.first + k])
            if side != MOVES:
                found.append(self._leaving(k, side))
                self._due.append((k, LEAVES))
                continue
            for side in (SEATED, STOPPED):
                end = 0.5 * (1.0 + side)
                found.append(_meeting(position, side, end, t if y[position] == end else -np.inf))
                self._due.append((k, side))
        for event in found:
            event.terminal, event.direction = True, 1.0
        return found

    def _leaving(self, k: int, side: float) -> Any:
        def off(t: float, state: Array) -> float:
            y = np.ascontiguousarray(state)
            return -side * self.module.push_on(k, y[0], y[1], y, *self.around)

        return off

    def passed(self, which: int, y: Array) -> bool:
        """Apply event `which` of the last `watched` to the state, in place; return whether the turn may go on."""
        k, due = self._due[which]
        if due != LEAVES:
            y[self.pairs[k][0]] = 0.5 * (1.0 + due)
        self.own[self.first + len(self.pairs) + k] = due
        return bool(self.module.chamber__take_event(y, self.rtol, self.own, *self.around))


def _meeting(position: int, side: float, end: float, started: float) -> Any:
    """Return how far a position is beyond its end; from an end that it leaves at `started`, over the angle since."""

    def beyond(t: float, state: Array) -> float:
        if t == started:
            return -1.0
        far = side * float(state[position] - end)
        return far / (t - started) if np.isfinite(started) else far

    return beyond
