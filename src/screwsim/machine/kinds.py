"""The kinds of machines: what a scene says of each, its checks, and the geometry that model and effects ask.

A geometry has `settings`, `pitch` and `life` [rad], `injection_angle` [rad] (where suction ends and the trapped mass is
taken), `chambers` (alive at once), `swept_volume` [m³], `volume_law()`, `widest_discharge()` and `discharge_opens`
[rad], and tells whether the machine `expands`; a chamber lives `omega / pitch` times a second.
"""

from __future__ import annotations

from screwsim.faults import Fault
from screwsim.machine.geometry import Geometry
from screwsim.machine.profile_law import check_profile_law
from screwsim.machine.settings import TwinScrew, check_twin_screw
from screwsim.machine.slider_crank.cylinder import Cylinder
from screwsim.machine.slider_crank.settings import SliderCrank, check_slider_crank

Machine = TwinScrew | SliderCrank
TWIN_SCREW, SLIDER_CRANK = "twin_screw", "slider_crank"
MACHINES: dict[str, type[TwinScrew] | type[SliderCrank]] = {TWIN_SCREW: TwinScrew, SLIDER_CRANK: SliderCrank}


def twin_screw(machine: Machine) -> TwinScrew:
    """Return a machine that is known to be a twin-screw machine; raise TypeError for another."""
    if not isinstance(machine, TwinScrew):
        raise TypeError(f"a {TWIN_SCREW} is asked for, not a {machine.kind}")
    return machine


def check_machine(machine: Machine) -> list[Fault]:
    """Return the faults of a machine's geometry."""
    if isinstance(machine, SliderCrank):
        return check_slider_crank(machine)
    return [*check_twin_screw(machine), *check_profile_law(machine)]


def geometry_of(machine: Machine) -> Geometry | Cylinder:
    """Return the geometry of a machine."""
    return Cylinder(machine) if isinstance(machine, SliderCrank) else Geometry(machine)
