"""The feedback unknowns of a collocated cycle: what they are made of again, and how that changes.

The unknowns u, in coordinates of similar size, equal their image U after a pitch on which they acted. Changes of the
cycle change the image; where a unit change of u itself is among them, the columns are those of dU/du.
"""

from functools import partial

import numpy as np

from screwsim.cycle.feedback import LineInflow, set_unknowns, unknowns
from screwsim.cycle.feedback import image as image_of
from screwsim.derivatives.argument_changes import ArgumentChange
from screwsim.derivatives.collocated_cycle import CollocatedCycle
from screwsim.derivatives.linear import Response
from screwsim.derivatives.pitch import CollocatedPitch
from screwsim.derivatives.rate_numbers import RateNumbers
from screwsim.derivatives.shifted_life import ShiftedLife
from screwsim.model.trajectory import Trajectory

Array = np.ndarray
SHIFT = 1e-6  # of coordinates, for differences of the image
IDENTITY_WITHIN = 1e-6  # departure of an image's derivatives from identity, up to which the scene states the unknown


def unknowns_of(pitch: CollocatedPitch) -> Array:
    """Return the unknowns that the rates use, in their own units."""
    return unknowns(pitch.problem, pitch.machinery)


def coordinates_of(pitch: CollocatedPitch, values: Array) -> Array:
    """Return the coordinates of unknowns."""
    return pitch.problem.entries.coordinates(values)


def put_unknowns(pitch: CollocatedPitch, coordinates: Array, near: Array) -> None:
    """Set the unknowns that the rates use from coordinates, `near` the values given."""
    set_unknowns(pitch.problem, pitch.machinery, pitch.problem.entries.values(coordinates, near))


def image(pitch: CollocatedPitch, q: Array, life: Trajectory, into: LineInflow | None) -> Array:
    """Return the image, in coordinates, after a life with quadratures q, and flows to lines if known."""
    return coordinates_of(pitch, image_of(pitch.problem, life, q, into=into))


def as_argument(pitch: CollocatedPitch, at: RateNumbers, unknowns_in: Array, j: int) -> ArgumentChange:
    """Return the change of the numbers `at` a cycle with coordinate j of its unknowns."""
    coordinates = coordinates_of(pitch, unknowns_in)
    found = []
    for sign in (1.0, -1.0):
        pitch.put(at)
        there = coordinates.copy()
        there[j] += sign * SHIFT
        put_unknowns(pitch, there, unknowns_in)
        found.append(pitch.numbers)
    pitch.put(at)
    return ArgumentChange(RateNumbers(*((above - below) / (2.0 * SHIFT) for above, below in zip(*found, strict=True))))


def image_response(cycle: CollocatedCycle, response: Response, *, to_unknowns: bool) -> Array:
    """Return the response of the image (u, k), in coordinates, to the columns of a response.

    Where the response is one `to_unknowns`, column j includes a unit change of unknown j itself.
    """
    pitch, unknowns_in = cycle.pitch, cycle.unknowns_in
    coordinates, read = coordinates_of(pitch, unknowns_in), False
    found = np.empty((len(coordinates), response.sums.shape[1]))

    def fill(by: float, j: int) -> None:
        nonlocal read
        read = True
        pitch.install_shifted(cycle.start, cycle.nodes, by, response.of(j))

    for j in range(found.shape[1]):
        images = []
        for by in (SHIFT, -SHIFT):
            pitch.put(cycle.at)
            pitch.period.move_cells(by, response.cells[:, j])
            there = coordinates.copy()
            if to_unknowns:
                there[j] += by
            put_unknowns(pitch, there, unknowns_in)
            life = ShiftedLife.of(pitch, partial(fill, by, j))
            into = None if cycle.into is None else cycle.into.moved(by * response.lines[..., j])
            images.append(image(pitch, cycle.sums + by * response.sums[:, j], life, into))
        found[:, j] = (images[0] - images[1]) / (2.0 * SHIFT)
    pitch.put(cycle.at)
    if read:
        pitch.install(cycle.start, cycle.nodes)
    return found


def stated(back: Array) -> Array:
    """Return which unknowns the scene states: these map to themselves."""
    return np.abs(np.eye(len(back)) - back).max(axis=1, initial=0.0) < IDENTITY_WITHIN


def solved(back: Array, off: Array, given: Array) -> Array:
    """Return the change of the unknowns that makes them equal their image; stated ones change by `off` itself."""
    if not len(off):
        return np.zeros_like(off)
    matrix, right = np.eye(len(back)) - back, off.copy()
    matrix[given] = np.eye(len(back))[given]
    return np.linalg.solve(matrix, right)
