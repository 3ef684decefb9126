"""What must fit into the machine: sizes of a scene against those of its rotors or its cylinder, as a table.

A size beyond what can be is a fault; one that hardly is so is a warning (`scene.plausible`). Bounds are shares of a
measure of the machine. Those of what cannot be leave room for scenes that are extreme on purpose: ports ten times as
wide as the housing let the pressure follow the line, and are allowed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from screwsim.declare import KINDS
from screwsim.faults import Fault
from screwsim.machine.kinds import SLIDER_CRANK, TWIN_SCREW
from screwsim.machine.settings import TwinScrew
from screwsim.machine.slider_crank.settings import SliderCrank
from screwsim.scene.types import Scene
from screwsim.scene.units import readable_quantity

RPM = 30.0 / math.pi


def _bores(machine: TwinScrew) -> float:
    """Return the volume [m³] of both rotors' bores, of the male's size."""
    return 0.5 * math.pi * machine.rotor_diameter**2 * machine.rotor_length


def _a_turn(machine: TwinScrew) -> float:
    """Return what one chamber [m³] can have of both bores: as many pass in a turn as there are male lobes."""
    return _bores(machine) / machine.male_lobes


def _shell(machine: TwinScrew) -> float:
    """Return the area [m²] of both bores and their ends."""
    D, L = machine.rotor_diameter, machine.rotor_length
    return 2.0 * math.pi * D * L + math.pi * D**2


def _diameter(machine: TwinScrew) -> float:
    return machine.rotor_diameter


def _square(machine: TwinScrew) -> float:
    return machine.rotor_diameter**2


def _lobe(machine: TwinScrew) -> float:
    """Return about the height [m] of a lobe."""
    return 0.2 * machine.rotor_diameter


def _line(machine: TwinScrew) -> float:
    return machine.rotor_diameter + machine.rotor_length


def _bore(machine: SliderCrank) -> float:
    return machine.bore


def _piston(machine: SliderCrank) -> float:
    return machine.piston_area


def _swept(machine: SliderCrank) -> float:
    return machine.swept_volume


@dataclass(frozen=True)
class Size:
    """A size at a path of a scene: its share of `of` [SI] is at most `most`, and hardly outside `usual`."""

    path: str
    of: Callable[[Any], float]
    what: str  # `of` is, in words
    most: float
    usual: tuple[float, float]
    remedy: str = "a smaller one; is the unit right?"


_HOLDS = "of what a chamber can have of both rotors' bores"
_WALL = "of the area of both bores and their ends"
_LOBE = "of the height of a lobe"
_D, _DD, _LINE = "rotor diameters", "of the rotor diameter's square", "of rotor diameter and length together"
_AREA, _BORE = "of the piston's area", "of the bore"
_ANY, WIDEST = 0.0, 350.0  # an ideal machine has ports some hundred times too wide to throttle
SIZES = {
    TWIN_SCREW: (
        Size("machine.rotor_length", _diameter, _D, 30.0, (0.4, 4.0), "shorter rotors, or a larger rotor_diameter"),
        Size(
            "machine.volume.max",
            _a_turn,
            _HOLDS,
            2.0,  # a female rotor larger than the male has more room
            (0.03, 0.6),
            "a smaller volume, or a larger rotor_diameter or rotor_length; is the unit right?",
        ),
        Size("machine.volume.min", _a_turn, _HOLDS, 1.0, (_ANY, 0.1)),
        Size("machine.profile.centre_distance", _diameter, _D, 5.0, (0.7, 0.9)),
        Size("machine.profile.female_diameter", _diameter, _D, 5.0, (0.7, 1.1)),
        Size("machine.suction_port.area", _shell, _WALL, WIDEST, (_ANY, 0.5)),
        Size("machine.discharge_port.area", _shell, _WALL, WIDEST, (_ANY, 0.5)),
        Size("oil_supply.orifice_diameter", _diameter, _D, 0.5, (_ANY, 0.2)),
        Size("effects.tip_leakage.gap", _lobe, _LOBE, 1.0, (_ANY, 0.1)),
        Size("effects.interlobe_leakage.gap", _lobe, _LOBE, 1.0, (_ANY, 0.1)),
        Size("effects.end_face_leakage.gap", _lobe, _LOBE, 1.0, (_ANY, 0.1)),
        Size("effects.interlobe_leakage.length", _line, _LINE, 30.0, (0.05, 3.0)),
        Size("effects.end_face_leakage.length", _line, _LINE, 30.0, (0.01, 3.0)),
        Size("effects.blow_hole.area", _square, _DD, 0.2, (_ANY, 0.02)),
        Size("effects.slide_valve.slot_area", _shell, _WALL, WIDEST, (_ANY, 0.5)),
        Size("effects.slide_valve.radial_area", _shell, _WALL, WIDEST, (_ANY, 0.5)),
        Size("effects.bypass.area", _shell, _WALL, WIDEST, (_ANY, 0.2)),
        Size("effects.economizer.area", _shell, _WALL, WIDEST, (_ANY, 0.2)),
        Size("effects.liquid_injection.area", _shell, _WALL, WIDEST, (_ANY, 0.05)),
        Size("effects.oil_heat.droplet_radius", _lobe, _LOBE, 1e9, (_ANY, 0.2)),
        Size("effects.droplets.diameter", _lobe, _LOBE, 1e9, (_ANY, 0.3)),  # none exchange heat in that limit
        Size("effects.droplets.orifice_diameter", _diameter, _D, 1e9, (_ANY, 0.2)),
        Size("effects.oil_drag.tip_gap", _lobe, _LOBE, 1.0, (_ANY, 0.1)),
        Size("effects.oil_drag.end_gap", _lobe, _LOBE, 1.0, (_ANY, 0.1)),
        Size("effects.oil_drag.tip_land", _diameter, _D, 1.0, (_ANY, 0.2)),
        Size("effects.oil_drag.female_diameter", _diameter, _D, 10.0, (0.5, 1.5)),
        Size("effects.bearings.bore", _diameter, _D, 10.0, (0.05, 1.0)),
        Size("effects.bearings.mean_diameter", _diameter, _D, 10.0, (0.05, 1.5)),
        Size("effects.wall_heat.rotor_area", _shell, _WALL, 100.0, (_ANY, 2.0)),
        Size("effects.wall_heat.housing_area", _shell, _WALL, 100.0, (_ANY, 2.0)),
        Size("effects.wall_heat.characteristic_length", _diameter, _D, 30.0, (_ANY, 1.0)),
        Size("effects.thermal_clearances.axis_distance", _diameter, _D, 10.0, (0.5, 1.2)),
        Size("effects.thermal_clearances.bearing_distance", _line, _LINE, 100.0, (_ANY, 2.0)),
    ),
    SLIDER_CRANK: (
        Size("machine.crank_radius", _bore, _BORE, 100.0, (0.05, 5.0)),
        Size("machine.rod_length", _bore, _BORE, 1000.0, (0.1, 30.0)),
        Size("machine.clearance", _swept, "of the swept volume", 100.0, (1e-4, 0.5)),
        Size("effects.ring_leakage.gap", _bore, _BORE, 0.5, (_ANY, 0.01)),
        Size("effects.ring_leakage.area", _piston, _AREA, 1.0, (_ANY, 0.01)),
        Size("effects.check_valves.suction_area", _piston, _AREA, 100.0, (_ANY, 1.0)),
        Size("effects.check_valves.discharge_area", _piston, _AREA, 100.0, (_ANY, 1.0)),
        Size("effects.reed_valves.suction_port_area", _piston, _AREA, 100.0, (_ANY, 1.0)),
        Size("effects.reed_valves.discharge_port_area", _piston, _AREA, 100.0, (_ANY, 1.0)),
        Size("effects.reed_valves.suction_perimeter", _bore, _BORE, 1000.0, (_ANY, 50.0)),
        Size("effects.reed_valves.discharge_perimeter", _bore, _BORE, 1000.0, (_ANY, 50.0)),
        Size("effects.reed_valves.suction_stop", _bore, _BORE, 1.0, (_ANY, 0.1)),
        Size("effects.reed_valves.discharge_stop", _bore, _BORE, 1.0, (_ANY, 0.1)),
    ),
}
SPEEDS = {  # [m/s] of tips, of the piston in the mean: at most, and hardly more than
    TWIN_SCREW: ("moves the rotors' tips at", 1000.0, 150.0, "steel bursts at about 500 m/s"),
    SLIDER_CRANK: ("moves the piston, in the mean, at", 300.0, 25.0, "those of engines for races move at 25 m/s"),
}


def _shares(scene: Scene) -> Iterator[tuple[Size, float]]:
    """Yield each size that the scene states, and its share of what it is measured by."""
    for size in SIZES[scene.machine.kind]:
        value = _value(scene, size.path)
        if value is not None:
            yield size, value / size.of(scene.machine)


@cache
def _keys(path: str) -> tuple[str, ...]:
    return tuple(path.split("."))


def _value(scene: Scene, path: str) -> float | None:
    """Return the value [SI] of a size, None where the scene has none; asked of every case of a sweep."""
    head, *keys = _keys(path)
    part: Any = getattr(scene, head)
    if head == "effects":
        active = part.get(keys.pop(0))
        part = None if active is None else active.parameters
    for name in keys:
        part = None if part is None else getattr(part, name)
    return part


def _speed(scene: Scene) -> tuple[str, float]:
    """Return what moves at which speed [m/s], in words, and that speed."""
    fast = scene.machine.surface_speed(scene.operation.speed)
    return f"{scene.operation.speed * RPM:.6g} rpm {SPEEDS[scene.machine.kind][0]} {fast:.4g} m/s", fast


def size_faults(scene: Scene) -> Iterator[Fault]:
    """Yield the sizes that do not fit into the machine, and a speed that no machine stands."""
    for size, share in _shares(scene):
        if share > size.most:
            what = f"{_shown(scene, size.path)} is {_times(share, size.what)}, which cannot be"
            yield Fault(size.path, f"{what} ({size.remedy})")
    words, fast = _speed(scene)
    _, most, _, why = SPEEDS[scene.machine.kind]
    if fast > most:
        yield Fault("operation.speed", f"{words}, and no machine stands {most:g} m/s (a lower speed; {why})")


def area_fault(scene: Scene, largest: float) -> str | None:
    """Return what is wrong with the largest area [m²] of a table of the machine; None where it can be."""
    machine = scene.machine
    if not isinstance(machine, TwinScrew) or largest <= WIDEST * _shell(machine):
        return None
    what = f"its largest area of {largest:.4g} m^2 is {_times(largest / _shell(machine), _WALL)}"
    return f"{what}, which cannot be (write m^2; is the unit right?)"


def size_warnings(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield (path, what) of sizes that machines hardly have, and of a speed that they hardly reach."""
    for size, share in _shares(scene):
        low, high = size.usual
        if not low <= share <= high:
            bound = f"at most {high:g}" if share > high else f"at least {low:g}"
            yield size.path, f"{_shown(scene, size.path)} is {_times(share, size.what)} (usual: {bound})"
    words, fast = _speed(scene)
    usual = SPEEDS[scene.machine.kind][2]
    if fast > usual:
        yield "operation.speed", f"{words} (usual: at most {usual:g} m/s)"


def _times(share: float, what: str) -> str:
    """Return a share in words: 0.5 of the bore, 3 times the bore."""
    if share > 1.0 and what.startswith("of "):
        return f"{share:.3g} times {what.removeprefix('of ')}"
    return f"{share:.3g} {what}"


def _shown(scene: Scene, path: str) -> str:
    kind = "volume" if path.endswith((".max", ".min", ".clearance")) else "area" if path.endswith("area") else "length"
    return readable_quantity(KINDS[kind], _value(scene, path) or 0.0)
