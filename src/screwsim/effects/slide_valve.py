"""Slide valve: part of the trapped gas returns to suction before compression begins, and the radial port moves too.

What: with the slide moved by x (0: full load, 1: its end) a slot to the suction line stays open until
φ_0 + x (φ_1 − φ_0), its area x S_slot; the radial discharge port of area S_r opens at φ_a + x (φ_b − φ_a) and closes
with the chamber's life (M162): nozzle flow (M12, M13). Where `machine.slide_valve` states the slide of rotors with a
profile, the area of the slot over the angle is that of its geometry (M164), and the machine's own radial port follows.
Source: geometry of a slide in the housing's cusp (textbook); one of the four ways that Chernov et al. 2015 name.
Assumptions: both edges move linearly with x; `machine.discharge_port` is the axial port, which does not move (with
`machine.slide_valve`: both ports); the suction line keeps its state, as with any gas that flows back into it.
Parameters: flow_coefficient; position, slot_area, closes; radial_area, radial_opens, radial_opens_moved; or area_file.
"""

from dataclasses import dataclass
from math import pi

from screwsim.effects.base import DISCHARGE, SUCTION, Effect, Faults, FlowPath
from screwsim.effects.bypass import RAMP, area, window
from screwsim.effects.parts.gap import flow_coefficient, table_area
from screwsim.effects.parts.usual import SLIDES, Sized
from screwsim.inputs.declare import AREA, file, number, optional, quantity
from screwsim.inputs.faults import Fault, incomplete
from screwsim.machine.protocol import ROTORS, SHELL, WIDEST
from screwsim.numerics.spline import features, negligible_areas, read_curve

BEFORE = 60.0 * pi / 180.0  # angle before the beginning of compression at which the chamber reaches the slot
DEG = 180.0 / pi
_OWN = "(needed without machine.slide_valve)"
_SLOT = {"position": "0.5", "slot_area": "40 cm^2", "closes": "560 deg"}
_RADIAL = ("radial_area", "radial_opens", "radial_opens_moved")


@dataclass(frozen=True)
class Parameters:
    """Position of the slide, its slot and its discharge edge."""

    position: float | None = number(f"x: 0 is full load, 1 the end of the travel {_OWN}", None, ge=0.0, le=1.0)
    slot_area: float | None = quantity("area", f"S_slot: area to suction at the end of the travel {_OWN}", None, ge=0.0)
    closes: float | None = optional("angle", f"phi_1: angle at which the slot closes at the end of the travel {_OWN}")
    flow_coefficient: float = flow_coefficient("slot and radial port", 1.0)
    radial_area: float | None = quantity("area", "S_r: area of the radial discharge port", None, ge=0.0)
    radial_opens: float | None = optional("angle", "phi_a: angle at which it opens at full load")
    radial_opens_moved: float | None = optional("angle", "phi_b: angle at which it opens at the end of the travel")
    area_file: str | None = file(
        "CSV with columns angle_deg, area_m2: the slot, in place of position, slot_area and closes", curve=AREA
    )


def build(parameters: Parameters, machine) -> list[FlowPath]:
    slot = machine.profile.slot if machine.profile is not None else None
    if slot is not None:
        return [_slot(parameters, slot.curve, slot.breakpoints)]
    if parameters.area_file is not None:
        angles, areas = read_curve(parameters.area_file, "area_m2")
        return [_slot(parameters, (angles, areas), _open_rows(angles, areas))]
    x, begins = parameters.position, machine.injection_angle
    assert x is not None and parameters.slot_area is not None and parameters.closes is not None  # checked
    closes = begins + x * (parameters.closes - begins)
    found = [window(x * parameters.slot_area, begins - BEFORE, closes, parameters.flow_coefficient)]
    if parameters.radial_area is not None:
        opens = (1.0 - x) * (parameters.radial_opens or 0.0) + x * (parameters.radial_opens_moved or 0.0)
        angles = {"opens": opens, "full": opens + 2.0 * RAMP, "falls": machine.life - RAMP, "closes": machine.life}
        sized, coefficient = {"size": parameters.radial_area, **angles}, parameters.flow_coefficient
        found.append(
            FlowPath(DISCHARGE, area, sized, tuple(angles.values()), flow_coefficient=coefficient, beside=True)
        )
    return found


def _open_rows(angles, areas) -> tuple[float, ...]:
    """Return the rows [rad] of a table at which steps end: those of its features, its ends only where it is open."""
    shut = negligible_areas(areas)
    return tuple(sorted({*features(angles, areas), *(float(angles[i]) for i in (0, -1) if not shut[i])}))


def _slot(parameters: Parameters, curve, own: tuple[float, ...]) -> FlowPath:
    """Return the path to suction through a slot whose area by angle is given as a curve."""
    coefficient, tables = parameters.flow_coefficient, {"curve": curve}
    return FlowPath(SUCTION, table_area, {}, own, flow_coefficient=coefficient, tables=tables, beside=True)


def check(parameters: Parameters, facts) -> Faults:
    path = "effects.slide_valve"
    if getattr(facts.machine, "slide_valve", None) is not None:
        yield from _beside(
            parameters, path, "machine.slide_valve, which finds it from the rotors", (*_SLOT, *_RADIAL, "area_file")
        )
        return
    if parameters.area_file is not None:
        yield from _beside(parameters, path, "area_file, the slot at one position", tuple(_SLOT))
    for name, example in _SLOT.items():
        if parameters.area_file is None and getattr(parameters, name) is None:
            what = f"is missing (write e.g. {name}: {example}, or state machine.slide_valve for rotors with a profile)"
            yield Fault(f"{path}.{name}", what)
    given = [name for name in _RADIAL if getattr(parameters, name) is not None]
    if given and len(given) < len(_RADIAL):
        yield incomplete(path, _RADIAL, given)


def _beside(parameters: Parameters, path: str, what: str, names: tuple[str, ...]) -> Faults:
    for name in names:
        if getattr(parameters, name) is not None:
            yield Fault(f"{path}.{name}", f"is given as well as {what} (remove it)")


def check_geometry(parameters: Parameters, geometry) -> Faults:
    """Yield the stated angles that lie outside the compression."""
    low, life = geometry.injection_angle, geometry.life
    for name in ("closes", *_RADIAL[1:]):
        angle, high = getattr(parameters, name), life - (2.0 if name == "closes" else 4.0) * RAMP
        if angle is not None and not low < angle < high:
            where = f"outside ({low * DEG:.6g} deg, {high * DEG:.6g} deg)"
            yield Fault(f"effects.slide_valve.{name}", f"{angle * DEG:.6g} deg lies {where} (choose an angle inside)")


EFFECT = Effect(
    name="slide_valve",
    title="slide with a slot to suction and a moving radial port",
    equations=("M12", "M13", "M162", "M164"),
    source="geometry of the slide",
    parameters=Parameters,
    build=build,
    check=check,
    check_geometry=check_geometry,
    needs=frozenset({ROTORS}),
    roles={SLIDES: ".position"},
    sizes=(
        Sized("slot_area", SHELL, WIDEST, (0.0, 0.5)),
        Sized("radial_area", SHELL, WIDEST, (0.0, 0.5)),
        Sized("area_file", SHELL, WIDEST, (0.0, 0.5)),
    ),
    in_expander="never",
)
