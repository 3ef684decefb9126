"""The registry of a twin screw's laws: sources of its volume and port areas over the angle.

Each law says itself what a scene states for it and which kernels it gives. A new law is a `Law` in `LAWS`.
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
from screwsim.numerics.spline import features, negligible_areas, read_curve, slope_oscillation, table_slope, table_value

if TYPE_CHECKING:
    from screwsim.machine.geometry import Geometry
    from screwsim.machine.profile_law import Table
    from screwsim.machine.settings import DischargePort, SuctionPort

ROUNDED = 1e-6  # [degree] allowance for rounded angles of rows
COARSE_AREAS = np.radians(10.0 - ROUNDED)  # tables of areas at least this coarse have a breakpoint at every row ...
COARSE_VOLUMES = np.radians(5.0 - ROUNDED)  # ... and tables of volumes, whose slope does the work, from this one on
ROUGH = 0.005  # oscillation of a volume's slope, over its largest, above which steps end at every row


def table_breakpoints(angles: np.ndarray) -> tuple[float, ...]:
    """Return the breakpoints of a table: its ends, or all rows where they lie at least 10° apart."""
    return tuple(angles) if _apart(angles) >= COARSE_AREAS else (float(angles[0]), float(angles[-1]))


def volume_rows(angles: np.ndarray, volumes: np.ndarray) -> tuple[float, ...]:
    """Return the rows of a volume table at which steps of its own chamber end: all where it is coarse or rough.

    While a port is open the gas has its line's pressure whatever the volume does, so the error control of the states
    does not see how the work follows the volume's slope between the rows.
    """
    by_rows = _apart(angles) >= COARSE_VOLUMES or slope_oscillation(angles, volumes)[0] > ROUGH
    return tuple(angles) if by_rows else ()


def _apart(angles: np.ndarray) -> float:
    return float(np.min(np.diff(angles)))


def area_breakpoints(angles: np.ndarray, areas: np.ndarray) -> tuple[float, ...]:
    """Return the breakpoints of an area table: those of its angles, where the port opens or closes, narrow peaks.

    Rows of zeros before it opens and after it has closed have none.
    """
    is_open = np.flatnonzero(~negligible_areas(areas))
    some = slice(max(int(is_open[0]) - 1, 0), int(is_open[-1]) + 2) if len(is_open) else slice(None)
    return tuple(sorted({*table_breakpoints(angles[some]), *features(angles, areas)}))


def _rows(angles: np.ndarray, areas: np.ndarray) -> AreaLaw:
    return AreaLaw(area, {}, area_breakpoints(angles, areas), (angles, areas), {"curve": (angles, areas)})


def _laid(table: Table) -> AreaLaw:
    curve, own = {"curve": table.curve}, table.breakpoints
    return AreaLaw(area, {}, table.ends, (table.angle, table.value), curve, own_breakpoints=own)


@dataclass(frozen=True)
class Law(ABC):
    """One option of `law`: what it means in a scene, and the kernels of a geometry's volume and ports.

    `by_formula`: a scene states angles and sizes of a formula; `from_file`: a table; `from_rotors`: the rotor profile
    determines everything. `source` is the source of its equations where that is not the section's own.
    """

    by_formula: bool = False
    from_file: bool = False
    from_rotors: bool = False
    source: str = ""

    @abstractmethod
    def volume(self, geometry: Geometry) -> VolumeKernels:
        """Return the law of the volume, over the angle of a compressor."""

    @abstractmethod
    def suction(self, geometry: Geometry, port: SuctionPort) -> AreaLaw:
        """Return the law of the suction port, over the angle of a compressor."""

    @abstractmethod
    def discharge(self, geometry: Geometry, port: DischargePort) -> AreaLaw:
        """Return the law of the discharge port, over the angle of a compressor."""


class PaperLaw(Law):
    """The formulas of the paper (M16 to M18)."""

    def volume(self, geometry: Geometry) -> VolumeKernels:
        """Return the paper's volume law (M16)."""
        law = geometry.settings.volume
        values = {"V_max": law.max or 0.0, "V_min": law.dead, "phi_A": float(law.phi_A or 0.0)}
        breakpoints = (values["phi_A"], LIFE - values["phi_A"])
        return VolumeKernels(paper_law.volume, paper_law.volume_slope, values, breakpoints)

    def suction(self, geometry: Geometry, port: SuctionPort) -> AreaLaw:
        """Return the paper's law of the suction port (M17)."""
        phi_B, area = float(port.phi_B or 0.0), float(port.area or 0.0)
        breakpoints, rows = (phi_B, TURN - phi_B, TURN), ((0.0, 0.5 * TURN, TURN), (0.0, area, 0.0))
        return AreaLaw(paper_law.suction_area, {"S_suc": area, "phi_B": phi_B}, breakpoints, rows)

    def discharge(self, geometry: Geometry, port: DischargePort) -> AreaLaw:
        """Return the paper's law of the discharge port (M18)."""
        opens, phi_C = float(port.opens or 0.0), float(port.phi_C or 0.0)
        values = {"S_dis": float(port.area or 0.0), "phi_dis": opens, "phi_C": phi_C}
        rows = (opens, 0.5 * (opens + LIFE), LIFE), (0.0, values["S_dis"], 0.0)
        return AreaLaw(paper_law.discharge_area, values, (opens, phi_C, LIFE - (phi_C - opens)), rows)


class TableLaw(Law):
    """A spline through the rows of a file (M14)."""

    def volume(self, geometry: Geometry) -> VolumeKernels:
        """Return the table's volume (M14), scaled so that its maximum is the swept volume."""
        law = geometry.settings.volume
        angles, volumes = read_curve(str(law.file), "volume_m3")
        tables = {"volume_curve": (angles, volumes * (geometry.swept_volume / np.max(volumes)))}
        ends, rows = (float(angles[0]), float(angles[-1])), volume_rows(angles, volumes)
        return VolumeKernels(volume, volume_slope, {"V_min": law.dead}, ends, tables, rows)

    def suction(self, geometry: Geometry, port: SuctionPort) -> AreaLaw:
        """Return the table of the suction port (M14)."""
        return _rows(*read_curve(str(port.file), "area_m2"))

    def discharge(self, geometry: Geometry, port: DischargePort) -> AreaLaw:
        """Return the table of the discharge port (M14), moved to the built-in volume ratio if one is stated (M394)."""
        rows, ratio = read_curve(str(port.file), "area_m2"), geometry.settings.built_in_volume_ratio
        return _rows(*(rows if ratio is None else moved_port.moved_area(*rows, geometry.opening_angle(ratio), ratio)))


class ProfileLaw(PaperLaw):
    """Laws from the rotor profile (docs/reference/rotors.md); the paper's for a port beside another volume law."""

    def volume(self, geometry: Geometry) -> VolumeKernels:
        """Return the volume that the rotors enclose."""
        profile = geometry.profile
        assert profile is not None  # its own law is that of the volume
        table, values = profile.volume, {"V_min": geometry.settings.volume.dead_of(profile.swept)}
        laws, tables = (volume, volume_slope), {"volume_curve": table.curve}
        return VolumeKernels(*laws, values, table.ends, tables, table.breakpoints)

    def suction(self, geometry: Geometry, port: SuctionPort) -> AreaLaw:
        """Return the area that the lobes leave open at the suction end."""
        return super().suction(geometry, port) if geometry.profile is None else _laid(geometry.profile.suction)

    def discharge(self, geometry: Geometry, port: DischargePort) -> AreaLaw:
        """Return the area that the lobes leave open at the discharge end."""
        return super().discharge(geometry, port) if geometry.profile is None else _laid(geometry.profile.discharge)


LAWS: dict[str, Law] = {
    "paper": PaperLaw(by_formula=True),
    "table": TableLaw(from_file=True, source="M14"),
    "profile": ProfileLaw(from_rotors=True, source="docs/reference/rotors.md"),
}


@dataclass(frozen=True)
class ByLaw:
    """A section of a scene that names the law by which it is read."""

    law: str

    @property
    def read_by(self) -> Law:
        """The law that the section names."""
        return LAWS[self.law]

    @property
    def by_formula(self) -> bool:
        """Whether the section states angles and sizes of a formula."""
        return self.read_by.by_formula

    @property
    def from_file(self) -> bool:
        """Whether the section names a table."""
        return self.read_by.from_file

    @property
    def from_rotors(self) -> bool:
        """Whether the rotor profile determines everything."""
        return self.read_by.from_rotors


@kernel
def volume(phi, TAB, volume_curve, V_min):
    """Return the chamber volume [m³]: dead volume plus the table's value."""
    return V_min + table_value(phi, TAB, volume_curve)


@kernel
def volume_slope(phi, TAB, volume_curve):
    """Return dV/dφ [m³/rad], the derivative of the same spline."""
    return table_slope(phi, TAB, volume_curve)


@kernel
def area(phi, TAB, curve):
    """Return a port area [m²]."""
    return table_value(phi, TAB, curve)
