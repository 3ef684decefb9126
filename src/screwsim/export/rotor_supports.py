"""What holds the rotors of a scene: its `effects.bearings` with `load: rotors`, unless options say otherwise."""

from typing import Any

from screwsim.effects.bearings import EFFECT, ROTOR_LOADS
from screwsim.effects.parts.bearing_set import ENDS
from screwsim.export.rotor_loads import Spans, Supports, line_pressures
from screwsim.machine.rotors.loads import NAMES, Diameters
from screwsim.outputs import Result
from screwsim.scene import Scene


def supports_of(scene: Scene, result: Result, spans: Spans | None, shafts: Diameters | None) -> Supports:
    """Return the supports of both rotors of a result, those of the scene where `spans` or `shafts` [m] are None.

    `spans` are the distances of the bearings of either rotor, suction first. What neither states is 0. Pistons are
    those of the scene, with the pressures of the result (M480).
    """
    effect = scene.effects.get(EFFECT.name)
    named = effect.parameters if effect is not None and effect.parameters.load == ROTOR_LOADS else None
    diameter = getattr(named, "shaft_diameter", None)
    male, female = (getattr(named, name, None) for name in NAMES)
    sized, pressures = diameter is not None or shafts is not None, line_pressures(scene.machine, result)
    return Supports(
        (_spans(male), _spans(female)) if spans is None else (spans, spans),
        (diameter or 0.0, diameter or 0.0) if shafts is None else shafts,
        (_push(male, pressures), _push(female, pressures)),
        (male is not None, female is not None) if spans is None else (True, True),
        (sized, sized),
    )


def assumed_of(supports: Supports) -> str:
    """Return what is assumed of supports that neither options nor the scene state, with the remedy; else nothing."""
    free = [name for name, located in zip(NAMES, supports.located, strict=True) if not located]
    told, remedies = [], []
    if free:
        told.append(f"bearings of the {' and '.join(free)} rotor in the end planes")
        remedies.append("--bearings")
    if not all(supports.sized):
        told.append("no shafts, whose area the thrust then includes")
        remedies.append("--shafts")
    return f"assumed: {', and '.join(told)} (state {' and '.join(remedies)}, or effects.{EFFECT.name})" if told else ""


def _spans(bearings: Any) -> Spans:
    """Return the distances [m] of a rotor's bearings, 0 where they are not named."""
    suction, discharge = (0.0 if bearings is None else getattr(bearings, end).distance for end in ENDS)
    return suction, discharge


def _push(bearings: Any, pressures: tuple[float, float]) -> float:
    """Return the force [N] of a rotor's balance piston towards the discharge end, between these pressures [Pa]."""
    piston = getattr(bearings, "balance_piston", None)
    if piston is None:
        return 0.0
    return piston.push(*pressures)
