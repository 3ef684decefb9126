"""Start-up: chambers and drive from a creeping speed to the steady one, against the discharge pressure (M218).

The chambers are not periodic: each carries its own state from pitch to pitch. Within a pitch the chambers are
integrated at the speed over time, and the drive under the torque of the chambers, alternately until both agree.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from screwsim.cycle.close import close
from screwsim.cycle.guess import lease_for
from screwsim.cycle.pitch import POINTS, Pitch
from screwsim.cycle.problem import LEAST_OIL, ClosingTask, Problem, Series, problem_of
from screwsim.effects.base import OilSolution
from screwsim.effects.gas_torque import raw_torque
from screwsim.evaluate.evaluation import Evaluation, evaluate, loss_torque
from screwsim.inputs.faults import Interrupted, UsageError
from screwsim.machine.drive.response import NoMotion, Response
from screwsim.machine.drive.run_up import Motion, run_up
from screwsim.machine.drive.train import Train
from screwsim.model import compiled, leases, speed
from screwsim.model.all_chambers import install_pitch, moved_on
from screwsim.model.renumbering import set_speed
from screwsim.model.run import Machinery
from screwsim.model.slots import Q_WORK, R_SUCTION
from screwsim.outputs import Figures
from screwsim.outputs.customary import RPM
from screwsim.outputs.variables import FAILED, NOT_CLOSED, OK
from screwsim.scene.lines import discharge_path
from screwsim.scene.types import Scene
from screwsim.solve import circuit, drive
from screwsim.solve.start_up_reading import StartUpPitch, figures_of, mean_speed, traces_of

Array = np.ndarray
Told = Callable[[float], None]
CREEP_SPEED = 30.0 * RPM  # rad/s, initial speed
LONGEST = 10.0  # s, longest start-up
MOST_PITCHES = 4000  # of a start-up
MOST_TURNS = 8  # rounds of chambers and drive within a pitch
STEADY_WITHIN = 2e-3  # relative distance of a pitch's mean speed from the steady one, within which it has arrived ...
STEADY_PITCHES = 12  # ... for so many pitches
END_MARGIN = 5e-7  # rad, left out at both ends of a pitch, where the speed's course is not periodic
NOTED_LIFT = 0.1  # of the load of rotors that stop: least share of the oil's lift that is told
STEP = 1e-3  # rad, initial step
INTERRUPTED = "interrupted"  # status of a start that Ctrl-C ended
UNCLOSED = "the cycle at the steady speed did not close (screwsim run says why)"


@dataclass(frozen=True)
class StartUp:
    """The outcome of a start: status (ok, failed, not_closed, interrupted), message, figures [SI], traces over time."""

    status: str
    message: str = ""
    warnings: tuple[str, ...] = ()
    figures: Figures = field(default_factory=Figures)
    traces: dict[str, Array] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        """Return what `startup --json` prints."""
        kept = {"status": self.status, "message": self.message, "warnings": list(self.warnings)}
        return {**kept, "figures": dict(self.figures)}


def start_up(
    scene: Scene, creep: float = CREEP_SPEED, longest: float = LONGEST, told: Told = lambda share: None
) -> StartUp:
    """Return the start-up of a scene with a `drive`, from a creeping speed [rad/s], in at most `longest` [s].

    `told` is called after each lobe pitch, with its mean speed over the steady one.
    Raises UsageError where the scene has no drive, its motor has no torque limit, or `creep` is not below the
    steady speed. Ctrl-C raises KeyboardInterrupt, or `Interrupted` with the start so far once there is a pitch.
    """
    problem = steady_problem(scene, creep)
    machinery, part = lease_for(problem), problem.parts.shaft
    assert part is not None  # `steady_problem`
    task = ClosingTask(problem, machinery, problem.criteria)
    cycle = drive.close_with_drive(task, close(task))
    if cycle.failed:
        return StartUp(FAILED, UNCLOSED)
    of = evaluate(problem, cycle)
    try:
        steady = part.respond(of.complete)
    except NoMotion as reason:
        return StartUp(FAILED, f"there is no steady speed to start to: {reason}")
    if not cycle.closed:
        return StartUp(cycle.status, UNCLOSED)
    if creep >= steady.mean_speed:
        target = _rpm(steady.mean_speed)
        raise UsageError(f"the start creeps at {_rpm(creep)}, the steady speed is {target} (choose a slower creep)")
    found = StartUpRun(of, machinery, steady, creep, longest).run(told)
    leases.give_back(machinery)
    return found


def steady_problem(scene: Scene, creep: float) -> Problem:
    """Return the problem at its steady speed; raise UsageError where it cannot be started."""
    series = Series()
    with compiled.equation_announced(scene.gas.name):
        problem = problem_of(scene, series)
    part = problem.parts.shaft
    if part is None:
        raise UsageError(
            "the scene has no drive to start (name drive under effects; docs/reference/drive.md has an example)"
        )
    if problem.parts.geometry.expands:
        raise UsageError("only a compressor has a start-up, and this is an expander (name the scene of a compressor)")
    if not math.isfinite(part.train(1.0).motor.most):
        raise UsageError("a start needs the motor's limit (give effects.drive.motor.torque_limit)")
    if not creep > 0.0:
        raise UsageError("a start begins from a creeping speed above 0 (e.g. 30 rpm)")
    return circuit.steady_state(problem, series)[0]


class StartUpRun:
    """A start in progress: state of chambers and drive, and the pitches so far."""

    def __init__(self, of: Evaluation, machinery: Machinery, steady: Response, creep: float, longest: float) -> None:
        """Start at rest; `of` is the steady cycle, which the machinery holds."""
        self.problem, self.machinery = of.problem, machinery
        self.steady, self.creep, self.longest = steady, creep, longest
        self.train: Train = steady.train
        self.pitches: list[StartUpPitch] = []
        self.lifting = 0.0  # N m, of the losses of the last pitch: what lifts the oil
        self.chambers = self._at_rest()
        work = float(of.life.quads[of.life.steps - 1, 0])
        loss = float(np.mean(steady.load)) - work / of.problem.parts.geometry.pitch
        twist = self.train.coupling.twist(min(max(loss, 0.0), self.train.motor.most))
        self.drive = np.array([creep**2, creep, twist, 0.0])
        self.load = np.full(POINTS + 1, loss)
        self.begins = self.train.stored(creep, creep, twist)

    def _at_rest(self) -> Array:
        """Return the states of all chambers, full of gas of the suction line with a trace of oil.

        The trace avoids a singularity: the rate of the oil temperature goes as 1 / oil mass.
        """
        parts, composition, suction = self.problem.parts, self.problem.composition, self.problem.suction
        T_s = suction.temperature(suction.line, self.problem.lines.T_s)
        one = [T_s, float(self.machinery.R[R_SUCTION + 1])]
        if parts.oil is not None and "T_oil" in composition.states:
            one.append(parts.oil.temperature)
        if composition.carried:
            one.append(LEAST_OIL)
        if isinstance(parts.oil_content, OilSolution):
            one.append(parts.oil_content.supply)
        return np.tile([*one, *composition.starts], composition.chambers)

    # ---- one pitch -------------------------------------------------------------------------------------------

    def advance(self) -> StartUpPitch | str:
        """Return the next pitch; a text where the chambers could not be integrated."""
        tolerance, change = self.problem.criteria.tolerance, math.inf
        gas, loss, work, end = self.load, 0.0, 0.0, self.chambers
        motion = run_up(self.train, self.steady.no_load_speed, self.drive, self.load, self.creep)
        for _ in range(MOST_TURNS):
            if motion.stalled:
                return StartUpPitch(motion, gas[: len(motion.time)], loss, 0.0, self.chambers, True)
            if change <= tolerance:
                break
            found = self._chambers_under(motion)
            if isinstance(found, str):
                return found
            gas, loss, work, end = found
            before = motion.speed
            motion = run_up(self.train, self.steady.no_load_speed, self.drive, gas + loss, self.creep)
            if not motion.stalled:
                change = float(np.max(np.abs(motion.speed - before))) / mean_speed(motion, self.train.pitch)
        self.load = gas + loss
        return StartUpPitch(motion, gas, loss, work, end, change <= tolerance)

    def go_on(self, step: StartUpPitch) -> None:
        """Set the start of the next pitch to the end of the last."""
        m = step.motion
        self.drive = np.array([m.squares[-1], m.motor_speed[-1], m.twist[-1], m.time[-1]])
        self.chambers = step.states

    def _chambers_under(self, motion: Motion) -> tuple[Array, float, float, Array] | str:
        """Return torques of gas and losses, gas work and final states at a course of the speed; a text if failed."""
        problem, machinery = self.problem, self.machinery
        composition, pitch = machinery.composition, problem.parts.geometry.pitch
        mean = mean_speed(motion, pitch)
        at = composition.speed_curve
        assert at is not None  # the scene has a drive
        set_speed(composition, problem.parts, mean)
        speed.put(composition.P, at, speed.curve_of(motion.squares / mean**2, motion.slopes / mean**2, pitch))
        y = self.chambers.copy()
        status, angle, q = machinery.pitch(y, problem.criteria.rtol, STEP, END_MARGIN)
        if status != 0 or not np.isfinite(y).all():
            return f"the chambers could not be integrated beyond {math.degrees(angle):.2f} deg of a pitch"
        install_pitch(machinery)
        of = Evaluation(problem, machinery.trajectory, q)
        gas = _gas_torque(of.pitch, pitch)
        gas += (float(q[Q_WORK]) - float(np.trapezoid(gas, dx=pitch / POINTS))) / pitch
        loss, self.lifting = loss_torque(of, mean)
        return gas, loss, float(q[Q_WORK]), moved_on(machinery, y)

    # ---- all of it -------------------------------------------------------------------------------------------

    def run(self, told: Told = lambda share: None) -> StartUp:
        """Continue until the steady speed is reached and kept, or the start ends otherwise."""
        try:
            return self._run(told)
        except KeyboardInterrupt as pressed:
            if not self.pitches:
                raise
            last = self.pitches[-1].motion
            reached = f"at {_rpm(float(last.speed[-1]))} of the steady {_rpm(self.steady.mean_speed)}"
            so_far = self._ended(INTERRUPTED, f"{last.time[-1]:.4g} s after the start, {reached}")
            raise Interrupted(so_far) from pressed

    def _run(self, told: Told) -> StartUp:
        stays, unsettled, target = 0, 0, self.steady.mean_speed
        while len(self.pitches) < MOST_PITCHES:
            try:
                step = self.advance()
            except UsageError as reason:
                return self._ended(FAILED, str(reason))
            if isinstance(step, str):
                return self._ended(FAILED, f"at {self.drive[3]:.4g} s {step}")
            self.pitches.append(step)
            broken = self._broken(step.motion)
            if broken:
                return self._ended(FAILED, broken)
            if step.motion.stalled:
                return self._ended(FAILED, self._stalled(step))
            unsettled += not step.settled
            self.go_on(step)
            m, mean = step.motion, mean_speed(step.motion, self.train.pitch)
            told(mean / target)
            stays = stays + 1 if abs(mean / target - 1.0) <= STEADY_WITHIN else 0
            if stays >= STEADY_PITCHES:
                status = OK if unsettled == 0 else NOT_CLOSED
                return self._ended(status, "" if unsettled == 0 else f"{unsettled} pitches did not settle")
            if m.time[-1] > self.longest:
                text = f"after {m.time[-1]:.4g} s a pitch has a mean of {_rpm(mean)}, not yet the steady {_rpm(target)}"
                return self._ended(
                    FAILED, f"{text} (choose a larger motor, a smaller load, or a longer time with --longest)"
                )
        return self._ended(FAILED, f"the speed is not steady after {MOST_PITCHES} lobe pitches")

    def _broken(self, motion: Motion) -> str:
        """Return how the coupling fails in a pitch; empty where it is sound."""
        i = int(np.argmax(np.abs(motion.twist)))
        state = self.train.coupling.state(float(motion.twist[i]))
        return "" if state == "sound" else f"at {motion.time[i]:.4g} s of the start {state}"

    def _stalled(self, step: StartUpPitch) -> str:
        """Return why the rotors stopped."""
        load = float(np.mean(step.gas_torque)) + step.loss_torque
        at_rest = self.train.motor.limited_torque(0.0, self.steady.no_load_speed)
        much = self.lifting > NOTED_LIFT * load
        oil = f", {self.lifting:.4g} N m of which lift its oil" if much else ""
        less = f"at a lower {discharge_path(self.problem.scene.operation)}{', or with less oil' if much else ''}"
        return (
            f"the motor cannot start the machine: the rotors stop after {step.motion.time[-1]:.4g} s under {load:.4g} "
            f"N m on average{oil}, and the motor gives {at_rest:.4g} N m at rest (choose a larger motor, or start "
            f"without load, {less})"
        )

    def _ended(self, status: str, message: str) -> StartUp:
        """Return the outcome of the pitches so far."""
        if not self.pitches:
            return StartUp(status, message)
        traces = traces_of(self.pitches, self.train.pitch)
        figures = figures_of(self.pitches, traces, self.steady, self.begins)
        return StartUp(status, message, tuple(self._warnings(figures)), figures, traces)

    def _warnings(self, figures: Figures) -> Iterator[str]:
        """Yield warnings where the coupling hammers, and where plenums pulsate as at the steady speed."""
        lowest = figures["coupling_torque_lowest"]
        if lowest < 0.0:
            hammering = "flanks and cords hammer (no play is modelled)"
            yield f"the coupling torque falls to {lowest:.4g} N m: {hammering}"
        if self.problem.parts.pulsations:
            what = "the pressures behind the ports pulsate from the first pitch on as they do at the steady speed"
            yield f"{what}: a start does not follow plenums (leave them out to start against constant pressures)"


def _gas_torque(pitch: Pitch, length: float) -> Array:
    """Return the gas torque [N m] at even angles of a pitch [rad] and its end.

    At its ends no chamber begins where the one ahead has ended: each is read within its own pitch.
    """
    pressure, slope = pitch.at(np.array([2.0 * END_MARGIN, length - 2.0 * END_MARGIN]))
    first, last = raw_torque(pitch._replace(pressure=pressure, slope=slope))
    return np.array([first, *raw_torque(pitch)[1:], last])


def _rpm(omega: float) -> str:
    """Return a speed [rad/s] as text in rpm."""
    return f"{omega / RPM:.5g} rpm"
