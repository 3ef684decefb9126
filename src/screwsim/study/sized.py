"""A new machine by what its maker's sheet states: its size is sought with the cycle, so that it does what is stated.

A sheet gives what a machine delivers or takes, not what it displaces. A larger machine delivers more in nearly the same
proportion, so that a few solutions find the displacement.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate
from screwsim.study.inputs import shown_figure
from screwsim.template import Asked, new_scene
from screwsim.template.gas import INVERTER, first_flow
from screwsim.template.sizes import rpm

DELIVERED, TAKEN = "free_air_delivered", "shaft_power"
NEAR, TRIES = 1e-3, 8  # of what is stated, within which it is met, and how many sizes are tried
FAST = (
    40.0  # [m/s] of the tips, above which films of oil cost a package points of efficiency (docs/how-to/new-machine.md)
)
HEAVY, LIGHT = 1.15, 0.6  # loads of a motor (NEMA MG 1: service factor 1.15) beyond which sheet and machine hardly fit


class Sized(NamedTuple):
    """The text of a new scene, the scene, and its result."""

    text: str
    scene: Scene
    result: Result


def sized(kind: str, asked: Asked) -> Sized:
    """Return a new machine that delivers the flow that is stated, or where none is, loads the motor in full.

    Raise UsageError, in one line, where no size does.
    """
    figure, wanted = (DELIVERED, asked.free_air) if asked.free_air is not None else (TAKEN, asked.motor)
    assert wanted is not None
    option = "--flow" if figure == DELIVERED else "--motor"
    flow = first_flow(asked)
    for _ in range(TRIES):
        text = _text(kind, replace(asked, flow=flow), option)
        scene = loads(text)
        result = simulate(scene, trace=False)
        value = result.performance.get(figure)
        if result.status != "ok" or not value or value <= 0.0:
            why = result.told if result.status != "ok" else f"no {figure.replace('_', ' ')}"
            raise UsageError(f"{option}: the machine of the size that is tried does not run: {why}")
        if abs(value / wanted - 1.0) <= NEAR:
            return Sized(text, scene, result)
        flow *= wanted / value
    raise UsageError(
        f"{option}: no size was found that gives {shown_figure(figure, wanted)} (--displacement states one)"
    )


def _text(kind: str, asked: Asked, option: str) -> str:
    """Return the text of a machine of some size; raise UsageError of the option that asks for it."""
    try:
        return new_scene(kind, asked)
    except UsageError as error:
        what = str(error)
        displaced = what.removeprefix("--displacement ")
        raise UsageError(what if displaced == what else f"{option}: a displacement of {displaced}") from None


def told(asked: Asked, found: Sized) -> Iterator[str]:
    """Yield what the machine does, how that fits what was stated, and what was assumed, in a line each."""
    p, scene = found.result.performance, found.scene
    every = (active.parameters for active in scene.effects.values())
    rated = next(parameters.rated_power for parameters in every if hasattr(parameters, "rated_power"))
    load = p.shaft_power / rated
    over = 1e-5 * (p.package_discharge_pressure - scene.operation.suction.pressure)
    does = [
        f"delivers {shown_figure(DELIVERED, p[DELIVERED])} at {over:.4g} bar over its inlet",
        f"takes {shown_figure(TAKEN, p.shaft_power)}",
    ]
    does[1] += f" at the shaft ({100.0 * load:.0f} % of a motor of {1e-3 * rated:g} kW)"
    does.append(f"{shown_figure('package_input_power', p.package_input_power)} with motor and fan")
    does.append(shown_figure("package_specific_power", p.package_specific_power))
    yield f"computed: {', '.join(does)}"
    if asked.motor is not None and not LIGHT <= load <= HEAVY:
        word = "more" if load > HEAVY else "less"
        yield f"the motor gets {word} than sheets have it carry (check --flow, --motor and --pressure, or --speed)"
    tips = 0.5 * scene.operation.speed * scene.machine.rotor_diameter
    if tips > FAST:
        yield f"tips run at {tips:.0f} m/s, where films of oil take much (a lower --speed, larger rotors)"
    ratio = scene.machine.built_in_volume_ratio
    assumed = [] if asked.ratio is not None else [f"built-in volume ratio {ratio:g} by the pressure ratio"]
    assumed += [] if asked.speed is not None else [rpm(scene.operation.speed)]
    rotors = 1e3 * scene.machine.rotor_diameter
    assumed += [f"rotors of family b, {rotors:.0f} mm", "clearances, shafts and bearings by that size"]
    assumed += ["4 kg of oil per kg of air", "losses of a typical package, a fan of 4 % of the motor"]
    assumed += [f"an inverter that loses {100.0 * INVERTER:g} % of it"] if asked.variable else []
    yield f"assumed: {', '.join(assumed)}"
    yield from (f"warning: {each}" for each in found.result.warnings)
