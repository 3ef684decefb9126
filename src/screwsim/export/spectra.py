"""Spectra of what repeats every lobe pitch: harmonics of the lobe frequency; volume flows of both lines."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from screwsim.build import build_parts
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene

Array = np.ndarray
HARMONICS = 20
FLOW_POINTS = 360  # of a pitch
PORTS = {"suction": ("mass_flow_suction_port", 1.0), "discharge": ("mass_flow_discharge_port", -1.0)}


class Harmonic(NamedTuple):
    """One harmonic: number, frequency [Hz], amplitude in the unit of its curve, phase [rad] of a cosine."""

    number: int
    frequency: float
    amplitude: float
    phase: float


def harmonics(values: Array, frequency: float, count: int = HARMONICS) -> list[Harmonic]:
    """Return mean (number 0) and harmonics of a curve over one period, evenly sampled, its end left out.

    value = Σ amplitude cos(2π number t/T + phase).
    """
    found = np.fft.rfft(values) / len(values)
    numbers = range(min(count, (len(values) - 1) // 2) + 1)
    return [
        Harmonic(n, n * frequency, float(abs(found[n])) * (2.0 if n else 1.0), float(np.angle(found[n])) if n else 0.0)
        if n
        else Harmonic(0, 0.0, float(found[0].real), 0.0)
        for n in numbers
    ]


def lobe_frequency(scene: Scene) -> float:
    """Return how often chambers pass a second [Hz]."""
    parts = build_parts(scene)
    return scene.operation.speed / parts.geometry.pitch


def flows_of(scene: Scene, result: Result) -> tuple[Array, dict[str, Array]]:
    """Return the angle over one pitch [rad] and the volume flows of all chambers through each port [m³/s].

    Positive with the machine's flow; at the state of the line: suction as stated, discharge at its pressure and the
    temperature at which the gas leaves. Raise UsageError where the cycle has no ports.
    """
    parts = build_parts(scene)
    pitch, life = parts.geometry.pitch, math.radians(float(result.cycle["angle"][-1]))
    angle = np.arange(FLOW_POINTS) * pitch / FLOW_POINTS
    chambers = angle[:, None] + pitch * np.arange(max(1, round(life / pitch)))
    densities = _densities(parts.gas, result.performance)
    found = {}
    for line, (name, sign) in PORTS.items():
        if name in result.cycle:
            flow = np.interp(chambers, np.radians(result.cycle["angle"]), result.cycle[name])
            found[f"{line}_mass_flow"] = sign * flow.sum(axis=1)
            found[f"{line}_volume_flow"] = found[f"{line}_mass_flow"] / densities[line]
    if not found:
        raise UsageError("the cycle has no flow through a port (name effects.suction_port and effects.discharge_port)")
    return angle, found


def _densities(gas, figures: Mapping[str, float]) -> dict[str, float]:
    return {
        line: gas.density(float(figures[f"{line}_pressure"]), float(figures[f"{line}_temperature"]))
        for line in ("suction", "discharge")
    }
