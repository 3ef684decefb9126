"""The registry of a twin screw's laws: what volume and port areas over the angle are read from.

Each answers for itself what a scene states under it and what kernels it gives. Another one is a `Law` in `LAWS`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from screwsim.machine import moved_port, paper_law
from screwsim.machine.paper_law import LIFE, TURN
from screwsim.machine.protocol import AreaLaw, VolumeKernels
from screwsim.numerics.kernel import kernel
from screwsim.numerics.spline import features, read_curve, table_slope, table_value, to_and_fro

if TYPE_CHECKING:
    from screwsim.machine.geometry import Geometry
    from screwsim.machine.profile_tables import Table

ROUNDED = 1e-6  # degrees by which rows may lie nearer than they are stated to
COARSE_AREAS = np.radians(10.0 - ROUNDED)  # tables at least this coarse have a breakpoint at every row ...
COARSE_VOLUMES = np.radians(5.0 - ROUNDED)  # ... those of volumes, whose slope does the work, from finer ones on
ROUGH = 0.005  # of its largest slope, by which that of a volume jumps to and fro in a table that steps cannot leap over


def table_breakpoints(angles: np.ndarray) -> tuple[float, ...]:
    """Return the breakpoints of a table: its ends, and its rows when they lie at least 10° apart."""
    return tuple(angles) if _apart(angles) >= COARSE_AREAS else (float(angles[0]), float(angles[-1]))


def volume_rows(angles: np.ndarray, volumes: np.ndarray) -> tuple[float, ...]:
    """Return the rows of a table of volumes at which steps of its own chamber end: all, where it is coarse or rough.

    The gas of a port that is open has its line's pressure whatever the volume does, so that no error of the states
    sees how the work follows the slope of the volume between the rows.
    """
    by_rows = _apart(angles) >= COARSE_VOLUMES or to_and_fro(angles, volumes)[0] > ROUGH
    return tuple(angles) if by_rows else ()


def _apart(angles: np.ndarray) -> float:
    return float(np.min(np.diff(angles)))


def area_breakpoints(angles: np.ndarray, areas: np.ndarray) -> tuple[float, ...]:
    """Return the breakpoints of a table of areas: those of its angles, where it opens or has shut, narrow tops."""
    return tuple(sorted({*table_breakpoints(angles), *features(angles, areas)}))


def _rows(angles: np.ndarray, areas: np.ndarray) -> AreaLaw:
    return AreaLaw(area, {}, area_breakpoints(angles, areas), (angles, areas), {"curve": (angles, areas)})


def _laid(table: Table) -> AreaLaw:
    curve, own = {"curve": table.curve}, table.breakpoints
    return AreaLaw(area, {}, table.ends, (table.angle, table.value), curve, own_breakpoints=own)


@dataclass(frozen=True)
class Law(ABC):
    """A word of `law`: what it is in a scene, and the kernels of a geometry's volume and ports.

    `by_formula`: a scene states its angles and sizes; `from_file`: a table; `from_rotors`: the profile finds all.
    `source` is where its equations are, where that is not the section's own.
    """

    by_formula: bool = False
    from_file: bool = False
    from_rotors: bool = False
    source: str = ""

    @abstractmethod
    def volume(self, geometry: Geometry) -> VolumeKernels:
        """Return the law of the volume, over the angle of a compressor."""

    @abstractmethod
    def suction(self, geometry: Geometry) -> AreaLaw:
        """Return the law of the suction port, over the angle of a compressor."""

    @abstractmethod
    def discharge(self, geometry: Geometry) -> AreaLaw:
        """Return the law of the discharge port, over the angle of a compressor."""


class PaperLaw(Law):
    """The formulas of the paper (M16 to M18)."""

    def volume(self, geometry: Geometry) -> VolumeKernels:
        """Return M16."""
        law = geometry.settings.volume
        values = {"V_max": law.max or 0.0, "V_min": law.dead, "phi_A": float(law.phi_A or 0.0)}
        breakpoints = (values["phi_A"], LIFE - values["phi_A"])
        return VolumeKernels(paper_law.volume, paper_law.volume_slope, values, breakpoints)

    def suction(self, geometry: Geometry) -> AreaLaw:
        """Return M17."""
        law = geometry.settings.suction_port
        assert law is not None  # checked with the scene
        phi_B, area = float(law.phi_B or 0.0), float(law.area or 0.0)
        breakpoints, rows = (phi_B, TURN - phi_B, TURN), ((0.0, 0.5 * TURN, TURN), (0.0, area, 0.0))
        return AreaLaw(paper_law.suction_area, {"S_suc": area, "phi_B": phi_B}, breakpoints, rows)

    def discharge(self, geometry: Geometry) -> AreaLaw:
        """Return M18."""
        law = geometry.settings.discharge_port
        assert law is not None  # checked with the scene
        opens, phi_C = float(law.opens or 0.0), float(law.phi_C or 0.0)
        values = {"S_dis": float(law.area or 0.0), "phi_dis": opens, "phi_C": phi_C}
        rows = (opens, 0.5 * (opens + LIFE), LIFE), (0.0, values["S_dis"], 0.0)
        return AreaLaw(paper_law.discharge_area, values, (opens, phi_C, LIFE - (phi_C - opens)), rows)


class TableLaw(Law):
    """A spline through the rows of a file (M14)."""

    def volume(self, geometry: Geometry) -> VolumeKernels:
        """Return M14, scaled so that its maximum is the swept volume."""
        law = geometry.settings.volume
        angles, volumes = read_curve(str(law.file), "volume_m3")
        tables = {"volume_curve": (angles, volumes * (geometry.swept_volume / np.max(volumes)))}
        ends, rows = (float(angles[0]), float(angles[-1])), volume_rows(angles, volumes)
        return VolumeKernels(volume, volume_slope, {"V_min": law.dead}, ends, tables, rows)

    def suction(self, geometry: Geometry) -> AreaLaw:
        """Return M14."""
        law = geometry.settings.suction_port
        assert law is not None  # checked with the scene
        return _rows(*read_curve(str(law.file), "area_m2"))

    def discharge(self, geometry: Geometry) -> AreaLaw:
        """Return M14, moved to the built-in volume ratio if one is stated (M394)."""
        law, ratio = geometry.settings.discharge_port, geometry.settings.built_in_volume_ratio
        assert law is not None  # checked with the scene
        rows = read_curve(str(law.file), "area_m2")
        return _rows(*(rows if ratio is None else moved_port.moved(*rows, geometry.opening_angle(ratio), ratio)))


class ProfileLaw(PaperLaw):
    """What the profile of the rotors gives (docs/reference/rotors.md); the paper's of a port beside another volume."""

    def volume(self, geometry: Geometry) -> VolumeKernels:
        """Return what the rotors enclose."""
        profile = geometry.profile
        assert profile is not None  # its own law is that of the volume
        table, values = profile.volume, {"V_min": geometry.settings.volume.dead_of(profile.swept)}
        laws, tables = (volume, volume_slope), {"volume_curve": table.curve}
        return VolumeKernels(*laws, values, table.ends, tables, table.breakpoints)

    def suction(self, geometry: Geometry) -> AreaLaw:
        """Return what the lobes leave open at the suction end."""
        return super().suction(geometry) if geometry.profile is None else _laid(geometry.profile.suction)

    def discharge(self, geometry: Geometry) -> AreaLaw:
        """Return what the lobes leave open at the discharge end."""
        return super().discharge(geometry) if geometry.profile is None else _laid(geometry.profile.discharge)


LAWS: dict[str, Law] = {
    "paper": PaperLaw(by_formula=True),
    "table": TableLaw(from_file=True, source="M14"),
    "profile": ProfileLaw(from_rotors=True, source="docs/reference/rotors.md"),
}


class ByLaw:
    """A section of a scene that says by which law it is read."""

    law: str

    @property
    def read_by(self) -> Law:
        """The law that the section names."""
        return LAWS[self.law]

    @property
    def by_formula(self) -> bool:
        """Tell whether the section states angles and sizes of a formula."""
        return self.read_by.by_formula

    @property
    def from_file(self) -> bool:
        """Tell whether a table is read."""
        return self.read_by.from_file

    @property
    def from_rotors(self) -> bool:
        """Tell whether the profile of the rotors finds all."""
        return self.read_by.from_rotors


@kernel
def volume(phi, TAB, volume_curve, V_min):
    """Return the chamber volume [m³]: dead volume plus the table's."""
    return V_min + table_value(phi, TAB, volume_curve)


@kernel
def volume_slope(phi, TAB, volume_curve):
    """Return dV/dφ [m³/rad], the derivative of the same spline."""
    return table_slope(phi, TAB, volume_curve)


@kernel
def area(phi, TAB, curve):
    """Return a port area [m²]."""
    return table_value(phi, TAB, curve)
