"""What a scene leaves out of what scenes of its kind of machine name, and what a run tells beside its warnings.

A machine without half of its leaks has unrealistic efficiencies, and nothing in its figures shows why.
"""

import math
from collections.abc import Iterator

from screwsim.effects import catalogue
from screwsim.effects.base import Effect
from screwsim.effects.parts.usual import LEAK, USUAL, Usual
from screwsim.inputs.declare import AREA
from screwsim.inputs.suggestions import counted, joined_names
from screwsim.machine.kinds import kind_of
from screwsim.machine.moved_port import opening_row
from screwsim.machine.settings import TwinScrew
from screwsim.numerics.spline import read_curve
from screwsim.scene.types import Scene

LEAST_SHIFT = 0.5  # [deg] of a tabulated port that is told


def left_out_lines(scene: Scene) -> list[str]:
    """Return one line each on the leaks that a scene omits and on the number of effects that it omits."""
    return [line for line in (leaks_in_words(scene), left_out_in_words(scene)) if line]


def moved_port_lines(scene: Scene) -> list[str]:
    """Return a line on a tabulated discharge port that the built-in volume ratio shifts noticeably."""
    machine = scene.machine
    port = machine.discharge_port if isinstance(machine, TwinScrew) else None
    ratio = getattr(machine, "built_in_volume_ratio", None)
    if port is None or port.file is None or ratio is None:
        return []
    drawn = math.degrees(opening_row(*read_curve(port.file, AREA)))
    opens = math.degrees(kind_of(machine).geometry(machine).discharge_law().opens or 0.0)
    if abs(opens - drawn) < LEAST_SHIFT:
        return []
    what = f"the table of machine.discharge_port opens at {drawn:.4g} deg, and is shifted to {opens:.4g} deg by"
    return [f"{what} machine.built_in_volume_ratio: {ratio:g} (null keeps it as it is)"]


def idle_figures(scene: Scene) -> dict[str, float]:
    """Return the values of figures that say nothing, by name.

    They are the quality of what leaves as gas alone, and the duty of an oil cooler that the separator lacks.
    """
    coolers = [active.parameters.cooler for active in scene.effects.values() if hasattr(active.parameters, "cooler")]
    dry = {"discharge_quality": 1.0}
    return dry if any(cooler is not None for cooler in coolers) else {**dry, "oil_cooler_duty": 0.0}


def leaks_in_words(scene: Scene) -> str:
    """Return which of a machine's leaks are simulated; empty where all of them are."""
    leaks = _usual_effects(scene).get(LEAK, [])
    there = [name.removesuffix("_leakage").replace("_", " ") for name in leaks if name in scene.effects]
    lacking = [name for name in leaks if name not in scene.effects]
    if not lacking:
        return ""
    only = f"{joined_names(there)} only" if there else "none"
    return f"leaks simulated: {only}; typical scenes name {joined_names(lacking)}{', too' if there else ''}"


def left_out_in_words(scene: Scene) -> str:
    """Return in one line how many effects are not simulated, and which of these typical scenes name."""
    left = [name for name, effect in suitable_effects(scene).items() if name not in scene.effects]
    if not left:
        return ""
    usual = list(_usual(scene))
    among = f", among them {joined_names(usual)}, which typical scenes name" if usual else ""
    many = counted(len(left), "effect")
    return f"not simulated: {many} of {machine_in_words(scene)}{among} (screwsim explain says what each is)"


def machine_in_words(scene: Scene) -> str:
    """Return what a scene's machine is, with its article."""
    if not scene.machine.expands:
        return f"a {scene.machine.kind}"
    return "an expander" if scene.oil_supply is None else "an expander with oil"


def _usual(scene: Scene) -> Iterator[str]:
    """Yield effects other than leaks that typical scenes of this kind of machine name and this one does not."""
    named = _usual_effects(scene)
    for what in USUAL:
        names = named.get(what, [])
        dry = scene.oil_supply is None and what.oiled
        if names and not dry and not any(name in scene.effects for name in names):
            yield " or ".join(names)


def suitable_effects(scene: Scene) -> dict[str, Effect]:
    """Return the effects that a scene's machine can have, by name."""
    kind, expands, oiled = kind_of(scene.machine), scene.machine.expands, scene.oil_supply is not None
    return {name: effect for name, effect in catalogue().items() if effect.suits(kind, expands, oiled)}


def _usual_effects(scene: Scene) -> dict[Usual, list[str]]:
    """Return the effects that count as usual for this kind of machine, by what they stand for."""
    kind, found = kind_of(scene.machine), {}
    for name, effect in suitable_effects(scene).items():
        for offer, what in effect.usual.items():
            if offer in kind.offers:
                found.setdefault(what, []).append(name)
    return found
