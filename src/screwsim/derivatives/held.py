"""What chambers are held in on each slice, so that no node changes sides of a border while a cycle is being closed.

A chamber is held in the phase of its gas that it has in the middle of a slice. A single chamber is also held in the
state of its valves: a check valve is open or shut, and what moves between seat and stop rests or moves.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from screwsim.derivatives.events import Course
from screwsim.derivatives.mesh import Mesh
from screwsim.model.parts import Parts
from screwsim.model.run import Machinery
from screwsim.model.slots import FREE, P_PITCH, PORT_STATE, PRESSURE
from screwsim.numerics.identity_cache import once

Array = np.ndarray


@dataclass
class Held:
    """What the kernels hold chambers in: the `cells` (m,) of the machinery that tell them, and their values by slice.

    The first of the `values` (slices, m) are the phases of the `chambers`; FREE are those that states determine.
    """

    cells: Array
    values: Array
    chambers: int

    @property
    def phases(self) -> Array:
        """The phase of each chamber on each slice (slices, chambers)."""
        return self.values[:, : self.chambers]

    def runs(self, of: Array) -> Iterator[slice]:
        """Yield ranges of rows that are held alike, with the chambers held so; `of` is the slice of each row."""
        if self._free:
            yield slice(0, len(of))
            return
        cells, values, free = self.cells, self.values[of], self.cells.copy()
        ends = np.flatnonzero((values[1:] != values[:-1]).any(axis=1)) + 1
        try:
            for low, high in pairwise([0, *ends.tolist(), len(of)]):
                cells[:] = values[low]
                yield slice(low, high)
        finally:
            cells[:] = free

    @contextmanager
    def on(self, k: int, phases: Array) -> Iterator[None]:
        """Hold the chambers as on slice k, but in given phases."""
        free = self.cells.copy()
        self.cells[:] = self.values[k]
        self.cells[: len(phases)] = phases
        try:
            yield
        finally:
            self.cells[:] = free

    @once
    def _free(self) -> bool:
        """Whether nothing is held on any slice."""
        return bool((self.values == FREE).all())


def held_of(machinery: Machinery, parts: Parts, mesh: Mesh, course: Course) -> Held:
    """Return what the chambers of the last history are held in on each slice of a mesh."""
    c, phases = machinery.composition, _phases(machinery, parts, mesh)
    if not machinery.alone:
        return Held(machinery.coupled.port_states[(c.chambers + 1) * PORT_STATE :], phases, c.chambers)
    switches = _switches(machinery, parts, mesh)
    values = np.hstack([phases, np.zeros_like(switches), switches, course.modes_at(mesh.middles)])
    return Held(machinery.coupled.port_states[c.own.holding], values, c.chambers)


def has_phases(parts: Parts) -> bool:
    """Return whether the gas of a chamber can have two phases."""
    return parts.gas.phased_state is not None


def _phases(machinery: Machinery, parts: Parts, mesh: Mesh) -> Array:
    """Return the phase of each chamber at the middle of each slice (slices, chambers)."""
    c = machinery.composition
    found = np.full((mesh.count, c.chambers), FREE)
    if has_phases(parts):
        starts = float(c.P[P_PITCH]) * np.arange(c.chambers)[:, None]
        states = machinery.lives.states_at((starts + mesh.middles).ravel())
        found[:] = machinery.trajectory.phases(states).reshape(c.chambers, -1).T
    return found


def _switches(machinery: Machinery, parts: Parts, mesh: Mesh) -> Array:
    """Return the switch of each port on each slice (slices, ports): whether a check valve is open; else FREE."""
    life, middles = machinery.trajectory, mesh.middles
    found = np.full((mesh.count, len(parts.ports)), FREE)
    for i, (_, path) in enumerate(parts.ports):
        if path.one_way:
            number = parts.number(path.to)
            line = float(life.R[number * PORT_STATE + PRESSURE])
            line = line * (1.0 + life.line_pulses(number, middles).sum(axis=1))
            found[:, i] = path.one_way * (line - life.pressures_at(middles)) > 0.0
    return found
