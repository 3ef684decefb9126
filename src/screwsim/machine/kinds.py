"""The registry of machines: the built-in kinds by name, those of a user's own by the dotted name of their module."""

import math
from functools import lru_cache

import numpy as np

from screwsim.inputs.faults import Fault
from screwsim.machine import twin_screw as _twin_screw
from screwsim.machine.protocol import MachineGeometry, MachineKind, MachineSettings
from screwsim.machine.settings import TwinScrew
from screwsim.machine.slider_crank import cylinder as _slider_crank
from screwsim.numerics.trial import found_in

STEP = math.radians(0.5)  # at which a law of the user's own is looked at
GAUSS = np.array((-1.0, 1.0)) / math.sqrt(3.0)
SLACK = 1e-6  # of the largest volume
OFF = 1e-3  # of the swept volume, whose ends a step may miss
ROUNDING = 1e-9
TWIN_SCREW = "twin_screw"  # the default
MACHINES: dict[str, MachineKind] = {TWIN_SCREW: _twin_screw.MACHINE, "slider_crank": _slider_crank.MACHINE}


def find_machine(name: str) -> MachineKind:
    """Return the kind of a name; raise KeyError when there is none, ImportError when a dotted one is not there."""
    return found_in(MACHINES, name, "MACHINE", MachineKind)


def kind_of(machine: MachineSettings) -> MachineKind:
    """Return the kind of a machine."""
    return find_machine(machine.kind)


def offering(needs: frozenset[str]) -> str:
    """Return the built-in kinds that offer what is needed, in words."""
    return " or ".join(name for name, kind in MACHINES.items() if needs <= kind.offers)


def twin_screw(machine: MachineSettings) -> TwinScrew:
    """Return a machine that is known to be a twin-screw machine; raise TypeError for another."""
    if not isinstance(machine, TwinScrew):
        raise TypeError(f"a {TWIN_SCREW} is asked for, not a {machine.kind}")
    return machine


def check_machine(machine: MachineSettings) -> list[Fault]:
    """Return the faults of a machine's geometry."""
    return _check_own(machine) if "." in machine.kind else kind_of(machine).check(machine)


@lru_cache(maxsize=64)
def _check_own(machine: MachineSettings) -> list[Fault]:
    """Return the faults of a machine of the user's own: its own, and a geometry that cannot be."""
    kind = kind_of(machine)
    try:
        found = kind.check(machine)
        wrong = "" if found else _impossible(kind.geometry(machine))
    except Exception as error:  # noqa: BLE001 - a module of the user's may raise anything
        text = " ".join(f"{type(error).__name__}: {error}".split())
        return [Fault("machine.kind", f"{machine.kind} fails ({text}); mend that module")]
    return [Fault("machine.kind", f"{machine.kind}: {wrong}; mend that module")] if wrong else found


def _impossible(geometry: MachineGeometry) -> str:
    """Return in words what of a geometry cannot be, empty where all can: its angles, its volume and the slope of it."""
    life, pitch, at = geometry.life, geometry.pitch, geometry.injection_angle
    if not (0.0 < pitch <= life and _whole(life / pitch)):
        return f"its life of {_degrees(life)} is no whole number of pitches of {_degrees(pitch)}"
    alone = geometry.chambers == 1
    if not (0.0 < at < life if alone else at <= life - pitch + ROUNDING and at > 0.0 and _whole(at / pitch)):
        where = "inside its life" if alone else f"a whole number of pitches of {_degrees(pitch)} inside its life"
        return f"its injection_angle of {_degrees(at)} is not {where}"
    law = geometry.volume_law()
    inside = [at for at in law.breakpoints if 0.0 < at < life]
    ends = np.union1d(np.linspace(0.0, life, 1 + math.ceil(life / STEP)), inside)
    half = 0.5 * np.diff(ends)
    nodes = np.add.outer(ends[:-1] + half, np.zeros(2)) + np.outer(half, GAUSS)
    V, slope = law.along(ends)[0], law.along(nodes.ravel())[1].reshape(nodes.shape)
    for phi, value in zip(ends.tolist(), V.tolist(), strict=True):
        if not (math.isfinite(value) and value > 0.0):
            return f"its volume is {value:.6g} m³ at {_degrees(phi)}, which cannot be"
    off = np.abs(V[0] + np.concatenate([[0.0], np.cumsum(half * slope.sum(axis=1))]) - V)
    if not off.max() <= SLACK * V.max():
        first = float(ends[np.argmax(off > SLACK * V.max())])
        return f"its volume_slope is not the slope of its volume up to {_degrees(first)}"
    if abs(V[-1] - V[0]) > SLACK * V.max():
        return f"its volume ends at {V[-1]:.6g} m³ and begins at {V[0]:.6g} m³"
    swept = float(V.max() - V.min())
    if not abs(geometry.swept_volume - swept) <= OFF * swept:
        return f"its swept_volume is {geometry.swept_volume:.6g} m³, and its volume changes by {swept:.6g} m³"
    return ""


def _whole(number: float) -> bool:
    return abs(number - round(number)) <= ROUNDING


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.6g} deg"
