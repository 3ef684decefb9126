"""Simulators that take no time, for goal seek and optimisation: figures that are known functions of the inputs."""

import math
import os

from screwsim.outputs import Figures, Result
from screwsim.scene import Scene

RPM = math.pi / 30.0


def figures_of(scene: Scene, **figures: float) -> Result:
    """Return a closed result with figures and a relative error of 1e-6."""
    return Result("ok", performance=Figures(figures), error=Figures(dict.fromkeys(figures, 1e-6)))


def saturating(scene: Scene) -> Result:
    """Return a flow that rises with the speed to 2 kg/s, 2 (1 − exp(−n/2000 rpm)), and power with n² and the oil."""
    n, d = scene.operation.speed / RPM / 2000.0, scene.oil_supply.ratio
    flow = 2.0 * (1.0 - math.exp(-n))
    power, T_d = 1e4 * n * n + 1e3 * d, 300.0 + 40.0 / d
    return figures_of(scene, gas_mass_flow=flow, shaft_power=power, discharge_temperature=T_d)


def turning(scene: Scene) -> Result:
    """Return a flow that is highest, 1 kg/s, at 3000 rpm."""
    n = scene.operation.speed / RPM
    return figures_of(scene, gas_mass_flow=1.0 - ((n - 3000.0) / 3000.0) ** 2)


def leaping(scene: Scene) -> Result:
    """Return a flow that leaps from 0.5 to 1.5 kg/s at 3000 rpm."""
    n = scene.operation.speed / RPM
    return figures_of(scene, gas_mass_flow=(0.5 if n < 3000.0 else 1.5) + 1e-5 * n)


def torn(scene: Scene) -> Result:
    """Fail between 2500 and 3100 rpm, and rise evenly elsewhere."""
    n = scene.operation.speed / RPM
    if 2500.0 < n < 3100.0:
        return Result("failed", message="pressure left the range (choose a smaller gap)")
    return figures_of(scene, gas_mass_flow=n / 3000.0)


def edged(scene: Scene) -> Result:
    """Return a flow that falls ever faster with the speed, to 1 kg/s at 2500 rpm, from where on it fails."""
    n = scene.operation.speed / RPM
    if n > 2500.0:
        return Result("failed", message="pressure left the range (choose a smaller gap)")
    return figures_of(scene, gas_mass_flow=2.0 - (n / 2500.0) ** 4)


def choosing(scene: Scene) -> Result:
    """Return two aims against each other: x = oil ratio over 1 … 3, y = speed over 1000 … 5000 rpm, both 0 … 1.

    Schaffer's pair x² and (1 − x)², worse by y² both; above y = 0.6 there is no result.
    """
    x, y = (scene.oil_supply.ratio - 1.0) / 2.0, (scene.operation.speed / RPM - 1000.0) / 4000.0
    if y > 0.6:
        return Result("failed", message=f"speed of {y:.3f} is too much (choose a lower one)")
    return figures_of(scene, shaft_power=1.0 + x * x + y * y, gas_mass_flow=2.0 - (1.0 - x) ** 2 - y * y)


def idle(scene: Scene) -> Result:
    """Return an efficiency that the oil ratio does nothing to, a little higher below 1.01 as its error allows."""
    return figures_of(scene, isothermal_efficiency=0.7 * (1.0 + (1.5e-6 if scene.oil_supply.ratio < 1.01 else 0.0)))


def deadly(scene: Scene) -> Result:
    """Kill the process where the oil ratio is above 2.8."""
    if scene.oil_supply.ratio > 2.8:
        os._exit(9)
    return choosing(scene)


def chiller(scene: Scene) -> Result:
    """Return a capacity in proportion to the speed and a COP of 0.6 of Carnot's, with all that a load needs."""
    T_e, T_c = scene.operation.evaporating_temperature, scene.operation.condensing_temperature
    n = scene.operation.speed / RPM
    capacity, cop = 100e3 * n / 3000.0, 0.6 * T_e / (T_c - T_e)
    more = {"gas_mass_flow": capacity / 150e3, "volumetric_cooling_capacity": 2e6}
    states = {"suction_pressure": 3e5, "suction_temperature": T_e + 10.0}
    return figures_of(scene, cooling_capacity=capacity, cop=cop, shaft_power=capacity / cop, **more, **states)


def hollow(scene: Scene) -> Result:
    """Return an efficiency that is as high at an oil ratio of 1 as at 3, and lower between."""
    return figures_of(scene, isothermal_efficiency=0.6 + 0.1 * (scene.oil_supply.ratio - 2.0) ** 2)
