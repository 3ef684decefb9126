"""Arguments of kernels besides the state, by name: parameters, tables, histories, working arrays."""

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class ChamberContext(NamedTuple):
    """For one chamber among neighbours with known histories.

    `own` is the chamber's port state, then the phase in which its gas is held during a step (`slots.FREE`: none)
    and the memory of its openings; `kept` are the numbers of steps of both histories, the new one first.
    """

    P: Array  # parameters
    TAB: Array  # tables
    R: Array  # run-time cells
    t_old: Array  # times of the last turn's steps, and their dense output
    d_old: Array
    t_new: Array  # the same of the turn being integrated
    d_new: Array
    kept: Array
    hints: Array  # where the last search in each history ended
    state: Array  # scratch
    own: Array


class CoupledContext(NamedTuple):
    """For all chambers together.

    `port_states` has one for each chamber and a spare one, then the phase in which each chamber's gas is held
    during a step. `work` holds flows between chambers, and derivatives (`network.chambers`).
    """

    P: Array
    TAB: Array
    R: Array
    port_states: Array
    work: Array
