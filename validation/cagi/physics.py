"""What each piece of the air package's physics makes of its curve: one changed at a time, then all as first taken."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from screwsim.study.validation import read_table

GAPS = ("tip_leakage", "interlobe_leakage", "end_face_leakage")
LARGER = 1.5  # than the machine of 160 mm that was fitted to Bitzer's curves
GAP, CLEARANCE, AREA = 26e-6, 42e-6, 9.6e-6  # m, m, m²: of that machine's gaps, shafts, and shaft leak as a nozzle
DIAMETER = 0.240  # m
BAR = 1e5


@dataclass(frozen=True)
class Variant:
    """Changes of machine.yaml, pressures [Pa] lost at full flow behind and before the rotors (None: as predicted)."""

    name: str
    changes: Sequence[str] = ()
    lost: tuple[float, float] | None = None
    note: str = ""


def tolerance(length: float) -> float:
    """Return the tolerance unit i of ISO 286-1 of a length [m]: 0.45 D^(1/3) + 0.001 D µm, D in mm."""
    D = 1e3 * length
    return 1e-6 * (0.45 * D ** (1.0 / 3.0) + 1e-3 * D)


def nozzle(area: float) -> str:
    """Return the change that lets shafts leak as a nozzle of an area [m²]."""
    annulus = "shaft_diameter: null, clearance: null, model: nozzle, mixture_viscosity: null, passage: null"
    return f"effects.shaft_leakage={{{annulus}, area: {1e6 * area:g} mm^2}}"


def as_tolerances() -> list[str]:
    """Return the changes with clearances of gaps, films and shafts that grew as tolerances of rotors and shafts do."""
    gap = 1e6 * GAP * tolerance(0.240) / tolerance(0.160)
    shaft = 1e6 * CLEARANCE * tolerance(0.105) / tolerance(0.070)
    films = [f"effects.oil_drag.{which}_gap={gap:.2f} um" for which in ("tip", "end")]
    gaps = [f"effects.{each}.gap={gap:.2f} um" for each in GAPS]
    return [*gaps, *films, f"effects.shaft_leakage.clearance={shaft:.2f} um"]


def end_clearance(diameter: float) -> float:
    """Return the clearance [m] that a maker sets at the discharge end faces of rotors of a diameter [m].

    It is interpolated between the middles of its limits, and in proportion to the diameter beyond them.
    """
    rows = read_table(Path(__file__).parent / "end_clearances.csv")
    known = [1e-3 * float(row["nominal_mm"]) for row in rows]
    middles = [0.5e-3 * (float(row["from_mm"]) + float(row["to_mm"])) for row in rows]
    within = min(max(diameter, known[0]), known[-1])
    return float(np.interp(within, known, middles)) * diameter / within


def end_faces(gap: float, leak: bool = True) -> list[str]:
    """Return the changes to end faces of a clearance [m], for their film alone or for their leak, too."""
    film = [f"effects.oil_drag.end_gap={1e6 * gap:.6g} um"]
    return [*film, f"effects.end_face_leakage.gap={1e6 * gap:.6g} um"] if leak else film


def friction(share: float) -> list[str]:
    """Return the changes to a friction that is a share of the indicated power."""
    return ["effects.bearings=off", "effects.oil_drag=off", f"effects.mechanical={{fraction: {share:g}}}"]


DRY = [f"effects.{each}={{model: nozzle, mixture_viscosity: null, passage: null}}" for each in GAPS]
PUMP = "oil_supply={kind: pump, ratio: 4, orifice_diameter: null}"
COARSE = "effects.oil_heat={droplet_radius: 50 um, heat_transfer_coefficient: 540 W/(m^2 K)}"
BY_LOAD = "effects.motor={efficiency_file: null, efficiency: 0.96}"
AT_FIRST = "all as first taken"
BOTH = "end faces as a maker sets them, gas and oil through blow-holes at one speed"
NO_PORT = "effects.oil_injection=off"


def variants(here: Path, behind: float) -> Iterator[Variant]:
    """Yield what was tried; `behind` [Pa] is what the predicted package loses."""
    shafts = [nozzle(LARGER**2 * AREA)]
    inverter = [f"effects.motor.efficiency_file={here / 'inverter.csv'}", "effects.motor.drive_efficiency=1"]
    yield Variant("shafts leak as a nozzle (M274)", shafts, note="21.6 mm²: 9.6 mm² of the fit times 1.5²")
    yield Variant("the same, not made larger", [nozzle(AREA)], note="9.6 mm²")
    yield Variant("gaps dry", DRY, note="nozzles without oil (M12); shafts stay sealed")
    hole = ["effects.blow_hole.model=homogeneous"]
    yield Variant("gas and oil through blow-holes at one speed", hole, note="M192; gas alone in machine.yaml (M21)")
    yield Variant("clearances grow as tolerances do", as_tolerances(), note="ISO 286: gaps 1.17, shafts 1.16 times")
    gap = end_clearance(DIAMETER)
    note = f"{1e6 * gap:.0f} µm: manual of Mayekawa's SCV series (end_clearances.csv)"
    yield Variant("end faces as a maker sets them", end_faces(gap), note=note)
    yield Variant("the same, for their film alone", end_faces(gap, leak=False))
    alike = end_faces(LARGER * end_clearance(DIAMETER / LARGER))
    yield Variant("the same, that of 160 mm in proportion to the diameter", alike)
    yield Variant(BOTH, [*end_faces(gap), *hole])
    yield Variant("oil at the suction's closing, all at once", [NO_PORT], note="M30, no port")
    yield Variant("oil in proportion to the gas", [PUMP], note="a pump, d = 4 at every speed")
    yield Variant("friction 9.6 % of the indicated power", friction(0.096), note="R134a's fit")
    yield Variant("friction 13 % of the indicated power", friction(0.13))
    yield Variant("friction 5 % of the indicated power", friction(0.05))
    yield Variant("films in half of the gaps", ["effects.oil_drag.film_share=0.5"])
    yield Variant("coarse droplets", [COARSE], note="50 µm, as configs/r134a: gas leaves at 170 °C")
    yield Variant("motor by its load alone (M148)", [BY_LOAD], note="copper loss falls with the load squared")
    yield Variant("inverter's loss by its current", inverter, note="seven tenths of it at every speed; estimated")
    yield Variant("a package that loses nothing", lost=(0.0, 0.0))
    yield Variant("a package that loses 0.5 bar", lost=(0.5 * BAR, 0.0))
    intake = ["effects.suction_throttle={pressure_ratio: 1}"]
    yield Variant("intake filter and valve lose 20 mbar, too", intake, (behind, 0.02 * BAR))
    first = [*shafts, PUMP, NO_PORT, COARSE, BY_LOAD, *friction(0.096)]
    yield Variant(AT_FIRST, first, (0.5 * BAR, 0.0), "nozzle, pump, 9.6 %, coarse, M148, 0.5 bar")
