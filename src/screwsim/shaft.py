"""A speed that changes over the pitch: chambers and drive closed by turns until they agree (docs/reference/drive.md).

The chambers are closed under the speed's course of the drive, the drive moves under the torque of the chambers
(docs/model.md M214, M217). A ripple changes the torque by much less than itself, so that two or three turns do.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from screwsim.machine.drive.collocation import differentiation, resampled
from screwsim.machine.drive.response import NoMotion, Response
from screwsim.model import close as closing
from screwsim.model import speed
from screwsim.scene.types import Scene
from screwsim.solution import Solution

MOST_TURNS = 20  # of chambers and drive by turns
MOST_SPEEDS = 20  # tried for a mean speed that follows from the motor's line


def settled(solution: Any, closed: closing.Closed) -> closing.Closed:
    """Return the cycle closed together with its drive; as it is where the scene has none, or it did not close.

    `not_closed` where the turns do not settle, or the drive has no steady motion: the cycle is that of the last speed.
    """
    part = solution.parts.shaft
    if part is None or closed.status != "ok":
        return closed
    change = 0.0
    for _ in range(MOST_TURNS):
        try:
            motion = part.respond(solution.complete(closed.q))
        except NoMotion:
            return replace(closed, status="not_closed", change=change)
        change = set_course(solution, motion)
        if change <= solution.wanted.tolerance:
            return closed
        again = closing.again(solution, closed)
        if again.status != "ok":
            return again
        closed = replace(again, needed=closed.needed, first_gap=closed.first_gap)
    return replace(closed, status="not_closed", change=change)


def set_course(solution: Any, motion: Response) -> float:
    """Let the chambers feel the speed of a motion; return the largest change of the speed over its mean.

    A change below the tolerance leaves what the chambers feel as it is; the next scene of a course begins with it.
    """
    composition, pitch = solution.machinery.composition, solution.parts.geometry.pitch
    ratio = (motion.speed / motion.mean_speed) ** 2
    squares = resampled(ratio, speed.ROWS - 1)
    slopes = resampled(differentiation(pitch) @ ratio, speed.ROWS - 1)
    old = speed.squares_at(composition.P, composition.speed_curve)
    change = float(np.max(np.abs(np.sqrt(np.maximum(squares, 0.0)) - np.sqrt(old))))
    if squares.min() > (1.0 - speed.TOO_LARGE) ** 2:
        ends = np.append(squares, squares[0]), np.append(slopes, slopes[0])
        solution.moved = speed.curve_of(*ends, pitch)
        if change > solution.wanted.tolerance:
            speed.put(composition.P, composition.speed_curve, solution.moved)
    return change


def at_its_speed(solution: Solution) -> Solution:
    """Return the solution of the scene at the mean speed that its motor's line gives.

    The same one where the speed is held, or where the drive has no steady motion at the speed tried last; another one
    takes its place else, and releases it.
    """
    part = solution.parts.shaft
    if part is None or part.train(solution.scene.operation.speed).holds_mean:
        return solution
    stated = solution.scene.operation.speed
    solution = _instead(solution, solution.scene, stated)
    for _ in range(MOST_SPEEDS):
        closed = settled(solution, solution.close())
        if closed.status != "ok":
            return solution
        try:
            found = part.respond(solution.complete(closed.q)).mean_speed
        except NoMotion:
            return solution
        change = abs(found / solution.scene.operation.speed - 1.0)
        solution = _instead(solution, _at(solution.scene, found), stated)
        if change <= 0.1 * solution.wanted.tolerance:
            break
    return solution


def _instead(solution: Solution, scene: Scene, stated: float) -> Solution:
    """Return the solution of a scene in place of one that nobody reads any more."""
    solution.release()
    return Solution(scene, solution.series, stated)


def _at(scene: Scene, omega: float) -> Scene:
    return replace(scene, operation=replace(scene.operation, speed=omega))


def judged(solution: Any, closed: closing.Closed) -> tuple[str, tuple[str, ...], float | None]:
    """Return what forbids the motion of a closed cycle's drive, or an empty text; warnings; its powers' residue."""
    part = solution.parts.shaft
    if part is None:
        return "", (), None
    try:
        return part.judge(part.respond(solution.complete(closed.q)))
    except NoMotion as reason:
        return str(reason), (), None
