"""The catalogue of effects: every file of this package that defines EFFECT, in a fixed order.

An effect whose name has a dot (`my_package.my_effect`) is imported from the user's own code, so a new effect needs no
edit here.
"""

import importlib
import pkgutil
from functools import cache

from screwsim.effects.base import Effect
from screwsim.numerics import sources
from screwsim.numerics.trial import registry_entry

_PORTS = ("suction_port", "discharge_port", "check_valves", "reed_valves", "ring_leakage", "cylinder_heat")
_GAPS = ("tip_leakage", "interlobe_leakage", "blow_hole", "end_face_leakage", "slide_valve", "bypass")
_LINES = ("shaft_leakage", "suction_line", "suction_throttle")
_HEAT = ("oil_heat", "droplets", "wall_heat", "thermal_clearances", "plenums")
_LOSSES = ("oil_pump", "hydromechanical", "mechanical", "oil_drag", "bearings", "motor", "gas_torque", "drive")
_ORDER = (*_PORTS, *_GAPS, *_LINES, *_HEAT, *_LOSSES, "air_package")


@cache
def catalogue() -> dict[str, Effect]:
    """Return {name: effect} of the built-in effects: ports, gaps, lines, heat, losses, then the others by name."""
    names = [module.name for module in pkgutil.iter_modules(__path__) if not module.ispkg and module.name != "base"]
    found = {name: importlib.import_module(f"{__name__}.{name}").EFFECT for name in names}
    rank = {name: index for index, name in enumerate(_ORDER)}
    return {name: found[name] for name in sorted(found, key=lambda name: (rank.get(name, len(rank)), name))}


@cache
def having(role: str) -> tuple[str, ...]:
    """Return the keys (`effects.NAME.key`) by which effects of the catalogue take on a role (`effects.base`)."""
    return tuple(f"effects.{name}{each.roles[role]}" for name, each in catalogue().items() if role in each.roles)


def stating(parameters: type) -> str:
    """Return the name of the catalogue's effect whose parameters derive from a class."""
    return next(name for name, effect in catalogue().items() if issubclass(effect.parameters, parameters))


def imported() -> dict[str, Effect]:
    """Return {name: effect} of the user's own effects that this program has imported."""
    return {name: each.made for name, each in sources.recorded.items() if isinstance(each.made, Effect)}


def find_effect(name: str) -> Effect:
    """Return the effect of a name; KeyError where there is none, ImportError where a dotted one has no module."""
    return registry_entry(catalogue(), name, "EFFECT", Effect)
