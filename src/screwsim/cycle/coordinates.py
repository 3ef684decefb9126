"""What closing iterates on: logarithms of the states, and those that may be negative as they are."""

import numpy as np

from screwsim.cycle.problem import LEAST_OIL
from screwsim.model.composition import Composition
from screwsim.model.slots import HELD, S_T_OIL, S_X_OIL

Array = np.ndarray
NEAR = 0.1  # weight of a change of the states, which stall above the tolerance, beside that of mass and work


def logarithms(states: Array, c: Composition) -> Array:
    """Return ln of states, those that may be negative as they are.

    Oil not above LEAST_OIL of the gas counts as that, of one temperature, without dissolved gas.
    """
    raw = states.reshape(-1, len(c.states))
    rows = np.maximum(raw, 1e-300)
    some = c.carried and np.fmin.reduce(rows[:, S_X_OIL]) <= LEAST_OIL
    little = np.flatnonzero(rows[:, S_X_OIL] <= LEAST_OIL) if some else ()
    if some:
        rows[little, S_T_OIL], rows[little, S_X_OIL] = 1.0, LEAST_OIL
    logs = np.log(rows)
    if c.signed:
        signed = list(c.signed)
        logs[:, signed] = raw[:, signed]
    if some and c.dissolves:
        logs[little, HELD] = 0.0
    return logs.ravel()


def states_of(mixed: Array, raw: Array, c: Composition) -> Array:
    """Return states from mixed `logarithms`; oil too little to count keeps its raw value: mixing makes none."""
    rows, raw, signed = mixed.reshape(-1, len(c.states)), raw.reshape(-1, len(c.states)), list(c.signed)
    logs = rows.copy()
    if signed:
        logs[:, signed] = 0.0
    states = np.exp(logs)
    if signed:
        states[:, signed] = rows[:, signed]
    if c.carried:
        little = raw[:, S_X_OIL] <= LEAST_OIL
        if little.any():
            oil = slice(S_T_OIL, HELD + 1 if c.dissolves else HELD)
            states[little, oil] = raw[little, oil]
    return states.ravel()


def change(new: tuple[float, float], old: tuple[float, float], least_work: float) -> float:
    """Return the larger relative change of trapped mass and work."""
    mass = abs(new[0] - old[0]) / max(new[0], old[0], 1e-300)
    return max(mass, abs(new[1] - old[1]) / max(abs(new[1]), abs(old[1]), least_work))
