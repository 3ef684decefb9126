"""What a start shows (M218): traces over time, peaks, and the balance of its energies."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from screwsim.cycle.pitch import POINTS
from screwsim.machine.drive.response import Response
from screwsim.machine.drive.run_up import Motion
from screwsim.numerics.parabola import top, vertex
from screwsim.outputs import Figures

Array = np.ndarray


class StartUpPitch(NamedTuple):
    """One pitch of a start-up: motion of the drive, torques of gas and losses [N m], gas work [J], final states."""

    motion: Motion
    gas_torque: Array
    loss_torque: float
    gas_work: float
    states: Array
    settled: bool


def mean_speed(motion: Motion, pitch: float) -> float:
    """Return the mean speed while the rotors turn [rad/s]."""
    return pitch / (float(motion.time[-1] - motion.time[0]) - motion.held)


def figures_of(pitches: Sequence[StartUpPitch], traces: dict[str, Array], steady: Response, begins: float) -> Figures:
    """Return the figures of a start [SI], with the residual of its energies; `begins` [J] is stored where it begins."""
    train, m = steady.train, pitches[-1].motion
    whole = [each for each in pitches if not each.motion.stalled]
    motor, damped = (sum(getattr(each.motion, name) for each in whole) for name in ("motor_work", "damped"))
    gas = sum(each.gas_work for each in whole)
    losses = sum(each.loss_torque for each in whole) * train.pitch
    end = whole[-1].motion if whole else m
    stored = train.stored(float(end.speed[-1]), float(end.motor_speed[-1]), float(end.twist[-1])) - begins
    peak, peak_time = peak_of(np.abs(traces["coupling_torque"]), traces["time"])
    steady_torque = float(np.mean(steady.coupling_torque))
    residual = motor - damped - gas - losses - stored
    energy = {"motor_work": motor, "gas_work": gas, "loss_work": losses, "coupling_work": damped, "stored": stored}
    return Figures(
        time=float(m.time[-1]),
        turns=float(traces["angle"][-1]) / (2.0 * math.pi),
        end_speed=float(m.speed[-1]),
        steady_speed=steady.mean_speed,
        coupling_torque_peak=peak,
        coupling_torque_peak_time=peak_time,
        coupling_torque_lowest=-peak_of(-traces["coupling_torque"], traces["time"])[0],
        coupling_torque_steady=steady_torque,
        peak_over_steady=peak / abs(steady_torque) if steady_torque else None,
        twist_peak=peak_of(np.abs(traces["twist"]), traces["time"])[0],
        motor_torque_peak=min(peak_of(np.abs(traces["motor_torque"]), traces["time"])[0], train.motor.most),
        **(energy if whole else dict.fromkeys(energy)),  # unknown for a pitch in which the rotors stop
        residue=abs(residual) / max(abs(motor), abs(gas) + abs(losses)) if whole else None,
        unsettled=float(sum(not each.settled for each in pitches)),
    )


def peak_of(curve: Array, time: Array) -> tuple[float, float]:
    """Return the highest value of a curve and its time, by the parabola through it and its neighbours.

    At an end, and on a plateau as at the motor's limit, it is the highest point.
    """
    i = int(np.argmax(curve))
    if not 0 < i < len(curve) - 1 or not curve[i - 1] < curve[i] > curve[i + 1]:
        return float(curve[i]), float(time[i])
    around = tuple(map(float, curve[i - 1 : i + 2]))
    return top(*around), float(np.interp(i + float(vertex(*around)), (i - 1, i, i + 1), time[i - 1 : i + 2]))


def traces_of(pitches: Sequence[StartUpPitch], pitch: float) -> dict[str, Array]:
    """Return the traces of all pitches over time."""
    kept: dict[str, list[Array]] = {}
    for i, each in enumerate(pitches):
        m = each.motion
        n = len(m.time) if each.motion.stalled or i == len(pitches) - 1 else POINTS
        values = {
            "time": m.time,
            "angle": pitch * (i + np.arange(len(m.time)) / POINTS),
            "speed": m.speed,
            "motor_speed": m.motor_speed,
            "twist": m.twist,
            "coupling_torque": m.coupling_torque,
            "motor_torque": m.motor_torque,
            "gas_torque": each.gas_torque[: len(m.time)],
            "loss_torque": np.full(len(m.time), each.loss_torque),
        }
        for name, value in values.items():
            kept.setdefault(name, []).append(value[:n])
    return {name: np.concatenate(values) for name, values in kept.items()}
