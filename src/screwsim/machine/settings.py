"""What a scene says of a twin-screw machine (typed, SI units), and the checks that its geometry demands."""

from __future__ import annotations

import math
from dataclasses import dataclass

from screwsim.declare import choice, count, file, quantity
from screwsim.faults import Fault

TURN = 2.0 * math.pi
LIFE = 2.0 * TURN  # angle of a chamber's life, 720° (paper, before eq. 5)


@dataclass(frozen=True)
class VolumeLaw:
    """Chamber volume over the male-rotor angle."""

    law: str = choice("paper: eq. (16), model.md M16; table: C1 spline through a CSV file", ("paper", "table"), "paper")
    max: float = quantity("volume", "swept volume of one chamber", gt=0.0)
    min: float | None = quantity("volume", "dead volume (default: 1e-4 of max)", None, gt=0.0)
    phi_A: float | None = quantity("angle", "end of the opening branch of (16), in (0, 360 deg]", None)
    file: str | None = file("CSV with columns angle_deg, volume_m3 (swept part; law: table)")

    @property
    def dead(self) -> float:
        """Dead volume [m³]."""
        return 1e-4 * self.max if self.min is None else self.min


@dataclass(frozen=True)
class SuctionPort:
    """Area of the suction port over the male-rotor angle."""

    law: str = choice("paper: eq. (17), model.md M17; table: C1 spline through a CSV file", ("paper", "table"), "paper")
    area: float | None = quantity("area", "largest area (law: paper)", None, gt=0.0)
    phi_B: float | None = quantity("angle", "end of the opening branch of (17), in (0, 180 deg]", None)
    file: str | None = file("CSV with columns angle_deg, area_m2 (law: table)")


@dataclass(frozen=True)
class DischargePort:
    """Area of the discharge port over the male-rotor angle."""

    law: str = choice("paper: eq. (18), model.md M18; table: C1 spline through a CSV file", ("paper", "table"), "paper")
    area: float | None = quantity("area", "largest area (law: paper)", None, gt=0.0)
    opens: float | None = quantity("angle", "angle phi_dis at which the port opens, inside (360 deg, 720 deg)", None)
    phi_C: float | None = quantity("angle", "end of the opening branch of (18), in (opens, (opens + 720 deg)/2]", None)
    file: str | None = file("CSV with columns angle_deg, area_m2 (law: table)")


@dataclass(frozen=True)
class TwinScrew:
    """A twin-screw machine: one chamber per male lobe and revolution, living 720° of the male rotor."""

    kind: str = choice("kind of machine", ("twin_screw",), "twin_screw")
    mode: str = choice(
        "compressor, or expander (discharge below suction pressure)", ("compressor", "expander"), "compressor"
    )
    male_lobes: int = count("number of male lobes z1", 4, ge=1, le=12)
    female_lobes: int = count("number of female lobes z2", 6, ge=1, le=14)
    rotor_diameter: float = quantity("length", "outer diameter of the male rotor", gt=0.0)
    rotor_length: float = quantity("length", "length of the rotors", gt=0.0)
    volume: VolumeLaw = None  # type: ignore[assignment]  # the scene always gives it
    suction_port: SuctionPort | None = None
    discharge_port: DischargePort | None = None

    @property
    def pitch(self) -> float:
        """Angle between neighbouring chambers, 2π/z1 [rad]."""
        return TURN / self.male_lobes


def _inside(
    path: str, value: float | None, low: float, high: float, low_text: str, high_text: str, closed: bool
) -> list[Fault]:
    if value is None:
        return [Fault(path, f"is missing (law: paper needs it; give an angle between {low_text} and {high_text})")]
    if value > low and (value <= high * (1 + 1e-12) if closed else value < high):
        return []
    bracket = "]" if closed else ")"
    return [
        Fault(
            path,
            f"{math.degrees(value):.6g} deg lies outside ({low_text}, {high_text}{bracket}; choose an angle inside",
        )
    ]


def check_twin_screw(machine: TwinScrew) -> list[Fault]:
    """Return the faults of the geometry: ranges of φ_A, φ_B, φ_dis, φ_C (0 excluded: it divides), missing fields."""
    faults: list[Fault] = []
    volume, suction, discharge = machine.volume, machine.suction_port, machine.discharge_port
    if volume.law == "paper":
        faults += _inside("machine.volume.phi_A", volume.phi_A, 0.0, TURN, "0 deg", "360 deg", True)
    if suction is not None and suction.law == "paper":
        faults += _inside("machine.suction_port.phi_B", suction.phi_B, 0.0, TURN / 2, "0 deg", "180 deg", True)
    if discharge is not None and discharge.law == "paper":
        opening = _inside("machine.discharge_port.opens", discharge.opens, TURN, LIFE, "360 deg", "720 deg", False)
        faults += opening
        if not opening and discharge.opens is not None:
            middle = 0.5 * (discharge.opens + LIFE)
            low, high = f"{math.degrees(discharge.opens):.6g} deg", f"{math.degrees(middle):.6g} deg"
            faults += _inside("machine.discharge_port.phi_C", discharge.phi_C, discharge.opens, middle, low, high, True)
    for name, law, extra in (
        ("volume", volume, ()),
        ("suction_port", suction, ("area",)),
        ("discharge_port", discharge, ("area",)),
    ):
        if law is None:
            continue
        if law.law == "table" and law.file is None:
            faults.append(Fault(f"machine.{name}.file", "is missing (law: table needs a CSV file)"))
        if law.law == "paper" and law.file is not None:
            faults.append(
                Fault(f"machine.{name}.file", "belongs to law: table (write `law: table`, or remove the file)")
            )
        faults += [
            Fault(f"machine.{name}.{field}", "is missing (law: paper needs it)")
            for field in extra
            if law.law == "paper" and getattr(law, field) is None
        ]
    return faults
