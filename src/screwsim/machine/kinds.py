"""The registry of machines: built-in kinds by name, the user's own by the dotted name of their module."""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from screwsim.inputs.faults import Fault, in_one_line
from screwsim.machine import twin_screw as _twin_screw
from screwsim.machine.profile_law import Interface
from screwsim.machine.protocol import GAPS, PORTS, AreaLaw, MachineGeometry, MachineKind, MachineSettings, VolumeKernels
from screwsim.machine.settings import TwinScrew
from screwsim.machine.slider_crank import cylinder as _slider_crank
from screwsim.numerics.trial import registry_entry

Array = np.ndarray
STEP = math.radians(0.5)  # spacing of the angles at which a user's own law is checked
GAUSS = np.array((-1.0, 1.0)) / math.sqrt(3.0)
SLACK = 1e-6  # allowed inconsistency of volumes, over the largest volume
OFF = 1e-3  # allowed error of a swept volume, whose extremes may lie between the checked angles
ROUNDING = 1e-9
TWIN_SCREW = "twin_screw"  # the default
MACHINES: dict[str, MachineKind] = {TWIN_SCREW: _twin_screw.MACHINE, "slider_crank": _slider_crank.MACHINE}


def find_machine(name: str) -> MachineKind:
    """Return the kind of a name; KeyError where there is none, ImportError where a dotted one has no module."""
    return registry_entry(MACHINES, name, "MACHINE", MachineKind)


def kind_of(machine: MachineSettings) -> MachineKind:
    """Return the kind of a machine."""
    return find_machine(machine.kind)


def kinds_offering(needs: frozenset[str]) -> str:
    """Return in words the built-in kinds that offer what is needed."""
    return " or ".join(name for name, kind in MACHINES.items() if needs <= kind.offers)


def twin_screw(machine: MachineSettings) -> TwinScrew:
    """Return a machine as a `TwinScrew`; raise TypeError for any other kind."""
    if not isinstance(machine, TwinScrew):
        raise TypeError(f"a {TWIN_SCREW} is needed here, not a {machine.kind}")
    return machine


def check_machine(machine: MachineSettings) -> list[Fault]:
    """Return the faults of a machine's geometry."""
    return _check_own(machine) if "." in machine.kind else kind_of(machine).check(machine)


@lru_cache(maxsize=64)
def _check_own(machine: MachineSettings) -> list[Fault]:
    """Return the faults of a user's own machine: those that it reports, else an impossible geometry."""
    kind = kind_of(machine)
    try:
        found = list(kind.check(machine))
        wrong = "" if found else _impossible(kind.geometry(machine), kind.offers)
    except Exception as error:  # noqa: BLE001 - a module of the user's may raise anything
        return [Fault("machine.kind", f"{machine.kind} fails ({in_one_line(error)}); fix that module")]
    return [Fault("machine.kind", f"{machine.kind}: {wrong}; fix that module")] if wrong else found


def _impossible(geometry: MachineGeometry, offers: frozenset[str]) -> str:
    """Return in words what is impossible about a geometry; empty where nothing is."""
    moves = geometry.settings.surface_speed(1.0)
    if not (isinstance(moves, int | float) and math.isfinite(moves) and moves >= 0.0):
        return f"its surface_speed is {moves!r} m/s at 1 rad/s, which is impossible"
    ports = (("suction", geometry.suction_law), ("discharge", geometry.discharge_law)) if PORTS in offers else ()
    gaps = [(gap, each) for gap in GAPS if gap in offers for each in geometry.interfaces(gap) or ()]
    wrong = (_volume(geometry), *(_port(geometry, *port) for port in ports), *(_gap(geometry, *gap) for gap in gaps))
    return next(filter(None, wrong), "")


def _port(geometry: MachineGeometry, name: str, law_of: Callable[[], AreaLaw | None]) -> str:
    """Return what is impossible about a port's area, checked every half degree; empty where its kernel takes states."""
    law = law_of()
    if law is None:
        return f"it offers ports, and its {name}_law returns None"
    curves = VolumeKernels(law.area, law.area, {**geometry.settings.symbols(), **law.values}, (), law.tables)
    if not set(law.area.arguments) <= {"phi", *curves.known}:
        return ""
    angles = _angles(geometry.life)
    areas = curves.along(angles)[0]
    return _below_nothing(f"area of its {name} port", "m²", angles, areas)


def _gap(geometry: MachineGeometry, name: str, gap: Interface) -> str:
    """Return what is impossible about a gap: the chamber that it leads to, its angles, its lengths."""
    chambers, angles, lengths = geometry.life / geometry.pitch, gap.table.angle, gap.table.value
    if not (_is_whole(gap.offset) and 1 <= gap.offset <= chambers):
        return f"its {name} leads to a chamber {gap.offset} pitches ahead, and a life has {chambers:g} pitches"
    if not np.all(np.diff(angles) > 0.0):
        first = float(angles[1:][np.argmin(np.diff(angles) > 0.0)])
        return f"the angles of its {name} do not increase, at {_degrees(first)}"
    return _below_nothing(f"size of its {name}", "", angles, lengths)


def _below_nothing(what: str, unit: str, angles: Array, values: Array) -> str:
    wrong = np.flatnonzero(~(np.isfinite(values) & (values >= -ROUNDING * np.nanmax(np.abs(values), initial=0.0))))
    if not len(wrong):
        return ""
    value, at = f"{values[wrong[0]]:.6g} {unit}".rstrip(), _degrees(float(angles[wrong[0]]))
    return f"the {what} is {value} at {at}, which is impossible"


def _angles(life: float) -> Array:
    return np.linspace(0.0, life, 1 + math.ceil(life / STEP))


def _volume(geometry: MachineGeometry) -> str:
    """Return what is impossible about a geometry's angles, its volume, or the slope of its volume."""
    life, pitch, at = geometry.life, geometry.pitch, geometry.injection_angle
    if not (0.0 < pitch <= life and _is_whole(life / pitch)):
        return f"its life of {_degrees(life)} is not a whole number of pitches of {_degrees(pitch)}"
    alone = geometry.chambers == 1
    if not (0.0 < at < life if alone else at <= life - pitch + ROUNDING and at > 0.0 and _is_whole(at / pitch)):
        where = "inside its life" if alone else f"a whole number of pitches of {_degrees(pitch)} inside its life"
        return f"its injection_angle of {_degrees(at)} is not {where}"
    law = geometry.volume_law()
    inside = [at for at in law.breakpoints if 0.0 < at < life]
    ends = np.union1d(_angles(life), inside)
    half = 0.5 * np.diff(ends)
    nodes = np.add.outer(ends[:-1] + half, np.zeros(2)) + np.outer(half, GAUSS)
    V, slope = law.along(ends)[0], law.along(nodes.ravel())[1].reshape(nodes.shape)
    for phi, value in zip(ends.tolist(), V.tolist(), strict=True):
        if not (math.isfinite(value) and value > 0.0):
            return f"its volume is {value:.6g} m³ at {_degrees(phi)}, which is impossible"
    off = np.abs(V[0] + np.concatenate([[0.0], np.cumsum(half * slope.sum(axis=1))]) - V)
    if not off.max() <= SLACK * V.max():
        first = float(ends[np.argmax(off > SLACK * V.max())])
        return f"its volume_slope does not match the slope of its volume up to {_degrees(first)}"
    if abs(V[-1] - V[0]) > SLACK * V.max():
        return f"its volume ends at {V[-1]:.6g} m³ and begins at {V[0]:.6g} m³"
    swept = float(V.max() - V.min())
    if not abs(geometry.swept_volume - swept) <= OFF * swept:
        return f"its swept_volume is {geometry.swept_volume:.6g} m³, and its volume changes by {swept:.6g} m³"
    return ""


def _is_whole(number: float) -> bool:
    return abs(number - round(number)) <= ROUNDING


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.6g} deg"
