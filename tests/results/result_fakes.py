"""A scene, and a simulator that takes no time: its figures are simple functions of the inputs."""

import numpy as np

from screwsim.outputs import Figures, Result
from screwsim.scene import Scene, loads

SCENE = """\
title: fake
machine:
  rotor_diameter: 128 mm
  rotor_length: 140 mm
  volume: {max: 500 cm^3, phi_A: 60 deg}
  suction_port: {area: 40 cm^2, phi_B: 60 deg}
  discharge_port: {area: 12 cm^2, opens: 600 deg, phi_C: 640 deg}
gas: {fluid: R134a}
oil: {density: 1000 kg/m^3, heat_capacity: 2 kJ/(kg K), viscosity: 20 mPa s}
operation:
  speed: 3000 rpm
  suction: {pressure: 1.5 bar, temperature: 283 K}
  discharge: {pressure: 12 bar}
oil_supply: {kind: pump, ratio: 3, temperature: 293 K}
effects:
  suction_port:
  discharge_port:
  tip_leakage: {gap: 50 um}
"""

GRID = """\
sweep:
  operation.speed: [1000 rpm, 2000 rpm, 3000 rpm]
  oil_supply.ratio: {from: 0, to: 9, count: 10, spacing: linear}
"""

CYCLE = "output: {keep: cycle}\n"


def scene(text: str = SCENE) -> Scene:
    """Return a scene of a text."""
    return loads(text)


def fake_simulate(case: Scene) -> Result:
    """Return figures that tell the case; ratio 4 does not close, ratio 5 fails."""
    ratio, speed = case.oil_supply.ratio, case.operation.speed
    if ratio == 5.0:
        return Result("failed", message="pressure left the range at 123° (choose a smaller gap)")
    angle = np.linspace(0.0, 720.0, 73)
    return Result(
        status="not_closed" if ratio == 4.0 else "ok",
        message="energy residual 1e-3 above the bound" if ratio == 4.0 else "",
        warnings=("first warning", "η of 2"),
        effects=("suction_port", "tip_leakage"),
        states=("m", "T"),
        performance=Figures(isothermal_efficiency=0.5 + 0.01 * ratio, shaft_power=10.0 * speed, oil_ratio=ratio),
        balance=Figures(mass=1e-7, energy=2e-7, bound=3e-4),
        error=Figures(shaft_power=1e-5, isothermal_efficiency=None),
        numerics=Figures(integrator="rodas4", closing="histories", rtol=1e-6, steps=1000, wall_time=0.001),
        notes={"isothermal_efficiency": "no meaning here"},
        ledger=Figures(
            shaft_power=10.0 * speed,
            oil_exergy_rise=None,
            gas_moved_tip_leakage=0.1,
            exergy_destroyed_tip_leakage=ratio,
        ),
        cycle={"angle": angle, "pressure": 1e5 + speed * angle, "mass_flow_tip_leakage_leading": 1e-3 * angle},
    )
