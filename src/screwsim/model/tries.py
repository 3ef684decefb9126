"""What else may close a cycle that did not close: finer steps, damping, no acceleration, continuation in the speed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from screwsim.model.close import Closed, Task, by_coupling, chambers_at_pitches
from screwsim.model.pace import FULL, Pace
from screwsim.model.residues import Array
from screwsim.model.slots import P_OMEGA

MOST_OF_A_TRY = 2_000_000  # evaluations of one chamber's rates in one further try
PITCHES_OF_A_TRY = 2000  # and pitches: what contracts slowly but surely is waited for
DAMPED_DEPTH = 5  # of Anderson's method where closing is damped
DAMPING = 0.3  # share of the way to the mixed image that damped closing goes
NEAR_DAMPED = 0.05  # change of a pitch below which damped closing goes all the way
NEAR_PLAIN = 1e-3  # change of a pitch below which closing without acceleration is accelerated
FASTER = 4.0  # speed of the easier scene from which a cycle is continued, where leaks and stiffness weigh less


def further_tries(task: Task, start: Callable[[], Array]) -> Iterator[tuple[str, Callable[[], Closed]]]:
    """Yield what else may close a cycle that did not close, the cheapest first: (what it is, how to do it).

    `start` puts the first guess back. All go by coupled chambers, which conserve exactly.
    """
    machinery, wanted = task.machinery, task.wanted
    P = machinery.composition.P

    def coupled(pace: Pace = FULL, most: int = MOST_OF_A_TRY) -> Closed:
        return by_coupling(task, chambers_at_pitches(machinery), pace, most, PITCHES_OF_A_TRY)

    def tighter() -> Closed:
        start()
        task.wanted = replace(wanted, rtol=max(0.03 * wanted.rtol, 1e-12))
        try:
            return coupled()
        finally:
            task.wanted = wanted

    def damped() -> Closed:
        start()
        return coupled(Pace(DAMPED_DEPTH, DAMPING, NEAR_DAMPED))

    def plain() -> Closed:
        start()
        return coupled(Pace(0, near=NEAR_PLAIN), 2 * MOST_OF_A_TRY)

    def faster() -> Closed:
        start()
        omega = P[P_OMEGA]
        P[P_OMEGA] = FASTER * omega
        try:
            easier = coupled()
        finally:
            P[P_OMEGA] = omega
        return easier if easier.status == "failed" else by_coupling(task, easier.y, most=MOST_OF_A_TRY)

    yield "a tighter tolerance of the steps", tighter
    yield "damped closing", damped
    yield "closing without acceleration", plain
    yield f"continuation from {FASTER:g} times the speed", faster
