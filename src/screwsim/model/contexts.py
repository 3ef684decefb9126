"""What kernels are given beside the state, by name: parameters, tables, histories, working arrays."""

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class ChamberContext(NamedTuple):
    """Of one chamber among neighbours whose histories are known.

    `own` is the chamber's port state, then the phase that its gas is held in during a step (`slots.FREE`: none) and
    what the openings remember; `kept` are the numbers of steps of both histories, the new one first.
    """

    P: Array  # parameters
    TAB: Array  # tables
    R: Array  # run-time cells
    t_old: Array  # times of the last turn's steps, and their dense output
    d_old: Array
    t_new: Array  # of the turn that is being integrated
    d_new: Array
    kept: Array
    hints: Array  # where the last search in a history ended
    state: Array  # spare
    own: Array


class Changes(NamedTuple):
    """How what the rates of all chambers take changes along one direction; states and angles have a row each."""

    y: Array
    angles: Array
    P: Array
    TAB: Array
    R: Array


class Sides(NamedTuple):
    """Parameters, tables and run-time cells moved along a direction, moved back, and as they are: three rows each."""

    P: Array
    TAB: Array
    R: Array


class CoupledContext(NamedTuple):
    """Of all chambers together.

    `port_states` has one of each chamber and a spare one, then the phase in which each chamber's gas is held during a
    step. `work` takes what the chambers give each other, and derivatives (`network.chambers`).
    """

    P: Array
    TAB: Array
    R: Array
    port_states: Array
    work: Array
