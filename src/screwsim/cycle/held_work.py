"""What the sums of a life misread of its work, in long steps along which a valve or a port holds the pressure.

Such steps may be as long as `numerics.rodas.LONGEST`: no error of the states shows what the stages of a step make of
the slope of the volume. A machine whose chambers take in and give back nearly the same gas does little work, and that
counts over it. By parts, ∫ p dV = Δ(p V) − ∫ V dp: where p hardly changes, next to nothing is left of the law of V.
Source: ours; docs/explanation/errors.md.
"""

import numpy as np

from screwsim.cycle.between_ends import missed_pressure
from screwsim.cycle.problem import Problem
from screwsim.model.slots import Q_WORK
from screwsim.model.trajectory import Trajectory
from screwsim.numerics.quadrature import gauss
from screwsim.numerics.rodas import dense_slope

Array = np.ndarray
DIFFERS = 0.1  # wanted accuracies of the work, from which on it is read by parts
STEADY = 1e-3  # share of the pressure by which it may change within a step that counts as held
NODES, WEIGHTS = gauss(8)  # of a step


def missed_work(problem: Problem, life: Trajectory) -> float:
    """Return what to add to the work on the gas [J] that a life sums; 0 where that is less than `DIFFERS`.

    For a single cylinder: of several chambers, each has more breakpoints and shorter steps.
    """
    steps, column = life.steps, len(life.composition.states)
    if steps == 0:
        return 0.0
    p, after, c3, c4 = life.dense[:steps, :, column].T
    changes = np.maximum(np.maximum(np.abs(after - p), np.abs(c3)), np.abs(c4))
    held = np.flatnonzero(changes <= STEADY * p)
    sums = life.quads[:steps, Q_WORK]
    some = DIFFERS * problem.scene.numerics.accuracy * abs(float(sums[-1]))
    begun, widths = life.times[held], life.times[held + 1] - life.times[held]
    angles = begun[:, None] + widths[:, None] * NODES
    p, after, c3, c4 = (each[held, None] for each in (p, after, c3, c4))
    slope = dense_slope(NODES, p, after, c3, c4)
    left = (life.volumes(angles.ravel()).reshape(angles.shape) * slope) @ WEIGHTS
    moved = after[:, 0] * life.volumes(begun + widths) - p[:, 0] * life.volumes(begun)
    summed = sums[held] - np.where(held > 0, sums[held - 1], 0.0)
    more = left - moved - summed
    doubtful = np.flatnonzero(np.abs(more) > some / max(len(held), 1))
    if not np.abs(more[doubtful]).sum() > some:
        return 0.0
    more = more[doubtful] + _of_what_dense_output_misses(life, angles[doubtful], widths[doubtful])
    found = float(more[np.isfinite(more)].sum())
    return found if abs(found) > some else 0.0


def _of_what_dense_output_misses(life: Trajectory, angles: Array, widths: Array) -> Array:
    """Return the work [J] in steps of what their dense output misses of the pressure; NaN in steps that are not stiff.

    Without that, the sums are as good as the states.
    """
    at = angles.ravel()
    missed = missed_pressure(life, at)
    work = -widths * ((missed * life.volume_slopes(at)).reshape(angles.shape) @ WEIGHTS)
    return np.where(missed.reshape(angles.shape).any(axis=1), work, np.nan)
