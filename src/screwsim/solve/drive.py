"""A speed that varies over the pitch: close chambers and drive alternately until they agree (docs/reference/drive.md).

The chambers are closed at the drive's speed over the angle; the drive moves under the torque of the chambers
(docs/model.md M214, M217). A ripple changes the torque by much less than itself, so two or three rounds suffice.
"""

from dataclasses import replace

import numpy as np

from screwsim.cycle.close import close, close_again
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import ClosingTask, Problem, Series, problem_of
from screwsim.cycle.solution import CycleSolution
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.machine.drive.collocation import differentiation, resampled
from screwsim.machine.drive.response import NoMotion, Response
from screwsim.model import leases, speed
from screwsim.model.run import Machinery
from screwsim.outputs.variables import NOT_CLOSED

MOST_TURNS = 20  # rounds of chambers and drive
MOST_SPEEDS = 20  # iterations of a mean speed that follows from the motor's characteristic


def close_with_drive(task: ClosingTask, cycle: CycleSolution) -> CycleSolution:
    """Return the cycle, which the machinery holds, closed together with its drive; unchanged where there is no drive.

    The status is `not_closed` where the rounds do not converge, or the drive has no steady motion; the cycle is
    then that of the last speed.
    """
    problem, machinery, criteria = task
    part, change = problem.parts.shaft, 0.0
    if part is None or not cycle.closed:
        return cycle
    for _ in range(MOST_TURNS):
        try:
            motion = part.respond(evaluate(problem, cycle).complete)
        except NoMotion:
            return replace(cycle, status=NOT_CLOSED, change=change)
        change, curve = set_speed_curve(problem, machinery, motion, criteria.tolerance)
        curve = cycle.speed_curve if curve is None else curve
        if change <= criteria.tolerance:
            return replace(cycle, speed_curve=curve)
        cycle = replace(close_again(task, cycle), speed_curve=curve)
        if not cycle.closed:
            return cycle
    return replace(cycle, status=NOT_CLOSED, change=change)


def set_speed_curve(
    problem: Problem, machinery: Machinery, motion: Response, tolerance: float
) -> tuple[float, np.ndarray | None]:
    """Set the chambers' speed over the angle to that of a motion; return the change over the mean speed, and the curve.

    The change is the largest over the angle; below the tolerance the speed is left as it is. The curve is None
    where the motion nearly stops.
    """
    composition = machinery.composition
    at = composition.speed_curve
    assert at is not None  # the scene has a drive
    old = speed.squares_at(composition.P, at)
    squares, curve = speed_curve_of(motion, problem.parts.geometry.pitch)
    change = float(np.max(np.abs(np.sqrt(np.maximum(squares, 0.0)) - np.sqrt(old))))
    if curve is not None and change > tolerance:
        speed.put(composition.P, at, curve)
    return change, curve


def speed_curve_of(motion: Response, pitch: float) -> tuple[np.ndarray, np.ndarray | None]:
    """Return the squared relative speed of a motion by the angle, and its packed curve; None where it nearly stops."""
    ratio = (motion.speed / motion.mean_speed) ** 2
    squares = resampled(ratio, speed.ROWS - 1)
    if not squares.min() > (1.0 - speed.TOO_LARGE) ** 2:
        return squares, None
    slopes = resampled(differentiation(pitch) @ ratio, speed.ROWS - 1)
    return squares, speed.curve_of(np.append(squares, squares[0]), np.append(slopes, slopes[0]), pitch)


def at_motor_speed(problem: Problem, series: Series) -> Problem:
    """Return the problem at the mean speed that follows from its motor's characteristic.

    It is unchanged where the speed is held, and that of the last speed tried where the drive has no steady motion.
    """
    stated, part = problem.parts.set_speed or problem.scene.operation.speed, problem.parts.shaft
    if part is None or part.train(stated).holds_mean:
        return problem
    problem = problem_of(problem.scene, series, stated)
    for _ in range(MOST_SPEEDS):
        machinery = lease_for(problem)
        task = ClosingTask(problem, machinery, problem.criteria)
        cycle = close_with_drive(task, close(task, series.course))
        leases.give_back(machinery)
        if not cycle.closed:
            return problem
        try:
            found = part.respond(evaluate(problem, cycle).complete).mean_speed
        except NoMotion:
            return problem
        at = problem.scene.operation
        scene = replace(problem.scene, operation=replace(at, speed=found))
        problem = problem_of(scene, series, stated)
        if abs(found / at.speed - 1.0) <= 0.1 * problem.criteria.tolerance:
            break
    return problem


def judge_drive(of: Evaluation) -> tuple[str, tuple[str, ...], float | None]:
    """Return why a closed cycle's drive cannot move so (empty: it can), warnings, and the residual of its powers."""
    part = of.problem.parts.shaft
    if part is None:
        return "", (), None
    try:
        return part.judge(part.respond(of.complete))
    except NoMotion as reason:
        return str(reason), (), None
