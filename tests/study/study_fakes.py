"""Simulators that take no time, for studies: figures that are known functions of the inputs."""

import math
import os

from result_fakes import SCENE

from screwsim.outputs import Figures, Result
from screwsim.scene import Scene, loads


def scene(extra: str = "") -> Scene:
    """Return the scene without time, with more sections."""
    return loads(SCENE + extra)


def result_of(efficiency: float | None, error: float = 1e-9, **figures: float) -> Result:
    """Return a closed result with an isothermal efficiency, its relative error, and further figures."""
    performance = Figures(isothermal_efficiency=efficiency, **figures)
    errors = Figures({name: None if value is None else error for name, value in performance.items()})
    return Result("ok", performance=performance, error=errors, notes={"isothermal_efficiency": "no gas is delivered"})


def parabola(scene: Scene) -> Result:
    """Return 0.8 − 0.05 ln²(d/d*), with d* = speed / (100 rad/s): a parabola in ln d."""
    best = scene.operation.speed / 100.0
    return result_of(0.8 - 0.05 * math.log(scene.oil_supply.ratio / best) ** 2)


def rough(scene: Scene) -> Result:
    """Return the parabola with an error that is the wanted accuracy, and noise of that size."""
    accuracy, d = scene.numerics.accuracy, scene.oil_supply.ratio
    smooth = parabola(scene).performance.isothermal_efficiency
    return result_of(smooth + 0.5 * accuracy * math.sin(1e3 * d), accuracy)


def two_tops(scene: Scene) -> Result:
    """Return a higher top at d = 0.5 and a lower one at d = 4."""
    x = math.log(scene.oil_supply.ratio)
    first, second = (math.exp(-(((x - math.log(at)) / 0.4) ** 2)) for at in (0.5, 4.0))
    return result_of(0.3 + 0.4 * first + 0.3 * second)


def gappy(scene: Scene) -> Result:
    """Fail from d = 5 on, at 2000 rpm everywhere; without a figure below d = 0.3."""
    d = scene.oil_supply.ratio
    if abs(scene.operation.speed - 2000.0 * math.pi / 30.0) < 1e-6 or d >= 5.0:
        return Result("failed", message="pressure left the range (choose a smaller gap)")
    return result_of(None) if d < 0.3 else parabola(scene)


def steady(scene: Scene) -> Result:
    """Return a figure that falls with the isentropic exponent."""
    return result_of(1.0 - 0.1 * scene.gas.isentropic_exponent)


def flat(scene: Scene) -> Result:
    """Return the same for every d, within the wanted accuracy."""
    accuracy = scene.numerics.accuracy
    return result_of(0.7 + 1e-3 * accuracy * math.sin(1e3 * scene.oil_supply.ratio), accuracy)


def raising(scene: Scene) -> Result:
    """Raise above d = 5."""
    if scene.oil_supply.ratio > 5.0:
        raise ZeroDivisionError("float division\nby zero")
    return parabola(scene)


def deadly(scene: Scene) -> Result:
    """Kill the process at 2000 rpm."""
    if abs(scene.operation.speed - 2000.0 * math.pi / 30.0) < 1e-6:
        os._exit(9)
    return parabola(scene)


def ishigami(scene: Scene) -> Result:
    """Return Ishigami's function of diameter (0.1 … 0.2 m), density (900 … 1000) and oil ratio (1 … 2); 5 W always.

    Each goes over −π … π. The length of the rotors does nothing.
    """
    shares = 10.0 * scene.machine.rotor_diameter - 1.0, 0.01 * scene.oil.density - 9.0, scene.oil_supply.ratio - 1.0
    x1, x2, x3 = (math.pi * (2.0 * share - 1.0) for share in shares)
    return result_of(math.sin(x1) + 7.0 * math.sin(x2) ** 2 + 0.1 * x3**4 * math.sin(x1), shaft_power=5.0)


def noisy(scene: Scene) -> Result:
    """Return a figure that varies by its error."""
    return result_of(0.5 + 1e-3 * math.sin(1e4 * scene.oil_supply.ratio), 1e-2)
