"""The coordinates in which closing iterates: logarithms of the states, and signed states as they are."""

import numpy as np

from screwsim.cycle.problem import LEAST_OIL
from screwsim.model.composition import Composition
from screwsim.model.slots import HELD, S_T_OIL, S_X_OIL

Array = np.ndarray
WEIGHT = 0.1  # weight of changes of states against those of mass and work: the states' noise exceeds the tolerance


def logarithms(states: Array, c: Composition) -> Array:
    """Return ln of the states; states that may be negative stay as they are.

    An oil ratio of at most LEAST_OIL counts as LEAST_OIL, at one temperature and without dissolved gas.
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
    """Return states from `logarithms`; where there is too little oil to count, its raw values are kept."""
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
    """Return the larger relative change of trapped mass and work, that of work over `least_work` [J] at least."""
    mass = abs(new[0] - old[0]) / max(new[0], old[0], 1e-300)
    return max(mass, abs(new[1] - old[1]) / max(abs(new[1]), abs(old[1]), least_work))
