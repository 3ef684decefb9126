"""Values that follow from others: machine sizes (`machine.derived_sizes`), and the speed from that of the rotors' tips.

They are filled in when a scene is read and when a case of a sweep is made; `Derived` values are not written to files.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from screwsim.inputs.declare import Derived, is_derived
from screwsim.inputs.faults import Fault, given_twice
from screwsim.machine.kinds import kind_of
from screwsim.machine.settings import TwinScrew
from screwsim.scene.operation import SPEED, TIP_SPEED
from screwsim.scene.types import Scene


def with_derived_values(scene: Scene, changed: Iterable[str] = ("machine", "operation")) -> Scene:
    """Return a scene with all values that follow from what it states; `changed` are the paths of new values."""
    heads = {path.partition(".")[0] for path in changed}
    if "machine" in heads:
        machine = kind_of(scene.machine).derived(scene.machine)
        scene = scene if machine is scene.machine else replace(scene, machine=machine)
    if heads & {"machine", "operation"} and scene.operation.tip_speed is not None:
        scene = _at_tip_speed(scene)
    return scene


def _at_tip_speed(scene: Scene) -> Scene:
    machine, operation = scene.machine, scene.operation
    stated = operation.speed is not None and not is_derived(operation.speed)
    if stated or not isinstance(machine, TwinScrew) or machine.rotor_diameter is None:
        return scene
    speed = Derived(2.0 * (operation.tip_speed or 0.0) / machine.rotor_diameter)
    return replace(scene, operation=replace(operation, speed=speed))


def stated_faults(scene: Scene) -> list[Fault]:
    """Return the faults of values stated twice or not at all; called before all other checks."""
    return [*kind_of(scene.machine).stated(scene.machine), *_of_speed(scene)]


def _of_speed(scene: Scene) -> Iterator[Fault]:
    operation, turns = scene.operation, isinstance(scene.machine, TwinScrew)
    if operation.tip_speed is None:
        if operation.speed is None:
            yield Fault(SPEED, "is missing (write speed: … rpm; speed of the male rotor, or of the crank)")
        elif TIP_SPEED in scene.sweep:
            what = f"has no meaning with {SPEED} (vary that one, or state the tip speed in its place)"
            yield Fault(f"sweep.{TIP_SPEED}", what)
        return
    if not turns:
        what = f"applies only to screw rotors, which a {scene.machine.kind} does not have (write speed: … rpm)"
        yield Fault(TIP_SPEED, what)
    elif operation.speed is not None and not is_derived(operation.speed):
        yield given_twice(TIP_SPEED, f"{SPEED}, which it states already")
    if SPEED in scene.sweep:
        yield Fault(f"sweep.{SPEED}", f"has no meaning with {TIP_SPEED} (vary that one, or state the speed)")
