"""The settings of a twin-screw machine in a scene (typed, SI units), and the checks of its geometry."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from screwsim.inputs.declare import AREA, VOLUME, DerivedCount, choice, count, file, number, optional, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.laws import LAWS, ByLaw
from screwsim.machine.paper_law import LIFE, TURN
from screwsim.machine.protocol import COMPRESSOR, EXPANDER, MachineSettings
from screwsim.machine.rotors.settings import FAMILIES, Family, Profile, SlideValve


def _law_of(equation: str) -> Any:
    what = f"paper: {equation}; table: C1 spline through a CSV file; profile: from machine.profile"
    return choice(what, tuple(LAWS), "paper")


@dataclass(frozen=True)
class VolumeLaw(ByLaw):
    """Chamber volume over the male-rotor angle."""

    law: str = _law_of("eq. (16), model.md M16")
    max: float | None = optional("volume", "swept volume of one chamber (law: profile finds it)")
    min: float | None = optional("volume", "dead volume (default: 1e-4 of max)")
    phi_A: float | None = quantity("angle", "end of the opening branch of (16), in (0, 360 deg]", None)
    file: str | None = file(
        "CSV with columns angle_deg, volume_m3 (swept part, scaled to max; law: table)", curve=VOLUME
    )
    life: float | None = optional(
        "angle", "angle of a chamber's life, a multiple of the lobe pitch (law: table; default: 720 deg)"
    )
    injection_angle: float | None = optional(
        "angle", "angle at which oil is injected, a multiple of the lobe pitch (law: table; default: 360 deg)"
    )

    @property
    def dead(self) -> float:
        """Dead volume [m³] of a law that states the swept volume."""
        return self.dead_of(self.max or 0.0)

    def dead_of(self, swept: float) -> float:
        """Return the dead volume [m³] for a swept volume [m³]."""
        return 1e-4 * swept if self.min is None else self.min


@dataclass(frozen=True)
class SuctionPort(ByLaw):
    """Area of the suction port over the male-rotor angle."""

    law: str = _law_of("eq. (17), model.md M17")
    area: float | None = optional("area", "largest area (law: paper)")
    phi_B: float | None = quantity("angle", "end of the opening branch of (17), in (0, 180 deg]", None)
    file: str | None = file("CSV with columns angle_deg, area_m2 (law: table)", curve=AREA)


@dataclass(frozen=True)
class DischargePort(ByLaw):
    """Area of the discharge port over the male-rotor angle."""

    law: str = _law_of("eq. (18), model.md M18")
    area: float | None = optional("area", "largest area (law: paper)")
    opens: float | None = quantity(
        "angle",
        "angle phi_dis at which the port opens, inside (360 deg, 720 deg) (found with machine.built_in_volume_ratio)",
        None,
    )
    phi_C: float | None = quantity(
        "angle",
        "end of the opening branch of (18), in (opens, (opens + 720 deg)/2] (with machine.built_in_volume_ratio: "
        "5/16 of the way)",
        None,
    )
    file: str | None = file("CSV with columns angle_deg, area_m2 (law: table)", curve=AREA)


@dataclass(frozen=True)
class Displacement:
    """The size of a machine as catalogues state it: the volume flow that it displaces at a stated speed."""

    flow: float = quantity("displacement", "displaced volume per time, of all chambers", gt=0.0, hardly=(1e-3, 10.0))
    at: float = quantity("speed", "speed of the male rotor for that flow (catalogues: 2950 rpm)", gt=0.0)

    @property
    def volume(self) -> float:
        """Volume displaced per revolution [m³]."""
        return TURN * self.flow / self.at


@dataclass(frozen=True)
class TwinScrew(MachineSettings):
    """A twin-screw machine: one chamber per male lobe and revolution."""

    symbol_names = ("rotor_diameter", "rotor_length", "male_lobes", "female_lobes")
    kind: str = choice("kind of machine", ("twin_screw",), "twin_screw")  # pyrefly: ignore[bad-override] - frozen
    # pyrefly: ignore[bad-override] - frozen
    mode: str = choice("compressor, or expander (discharge below suction pressure)", (COMPRESSOR, EXPANDER), COMPRESSOR)
    male_lobes: int = count("number of male lobes z1 (with a family: the family's)", DerivedCount(4), ge=1, le=12)
    female_lobes: int = count("number of female lobes z2 (with a family: the family's)", DerivedCount(6), ge=1, le=14)
    rotor_diameter: float = quantity(
        "length", "outer diameter of the male rotor", None, gt=0.0, hardly=(0.02, 1.5), otherwise=("displacement",)
    )
    rotor_length: float = quantity(
        "length", "length of the rotors", None, gt=0.0, hardly=(0.02, 3.0), otherwise=("displacement", "profile")
    )
    displacement: Displacement | None = None
    built_in_volume_ratio: float | None = number(
        "largest chamber volume over that at which the discharge port opens; moves the port, also one from a table, "
        "which stays as drawn without it",
        None,
        gt=1.0,
        hardly=(None, 12.0),
    )
    axial_volume_ratio: float | None = number(
        "volume ratio to which the axial discharge port is cut, where built_in_volume_ratio is that of the radial "
        "port at a slide's stop (law: profile; default: the same for both)",
        None,
        gt=1.0,
        hardly=(None, 12.0),
    )
    slide_valve: SlideValve | None = None
    profile: Profile | None = None
    volume: VolumeLaw = None  # type: ignore[assignment]  # the scene always gives it
    suction_port: SuctionPort | None = None
    discharge_port: DischargePort | None = None

    @property
    def pitch(self) -> float:
        """Angle between neighbouring chambers, 2π/z1 [rad]."""
        return TURN / self.male_lobes

    @property
    def family(self) -> Family | None:
        """The named rotors of its profile; None where that states its own lengths, or there is none."""
        return None if self.profile is None or self.profile.family is None else FAMILIES[self.profile.family]

    def surface_speed(self, omega: float) -> float:
        """Return the speed of the male rotor's tips [m/s], the surfaces that move gas and oil."""
        return 0.5 * self.rotor_diameter * omega

    @property
    def finds_gaps(self) -> str:
        """What determines lengths and neighbours of the gaps, in words; empty where formulas of the effects do."""
        return "machine.volume.law: profile" if self.volume.from_rotors else ""

    @property
    def counts_otherwise(self) -> bool:
        """Whether the volume table has another life than 720°, or another injection angle than 360°."""
        return (self.volume.life or LIFE, self.volume.injection_angle or TURN) != (LIFE, TURN)


def _inside(path: str, value: float | None, low: float, high: float, end: str = "]") -> Iterator[Fault]:
    """Yield a fault for an angle that is missing, or outside (low, high] or, with `end` ')', (low, high)."""
    low_text, high_text = (f"{math.degrees(each):.6g} deg" for each in (low, high))
    if value is None:
        yield Fault(path, f"is missing (law: paper needs it; give an angle between {low_text} and {high_text})")
    elif not (value > low and (value <= high * (1 + 1e-12) if end == "]" else value < high)):
        where = f"({low_text}, {high_text}{end}"
        yield Fault(path, f"{math.degrees(value):.6g} deg lies outside {where}; choose an angle inside")


def check_twin_screw(machine: TwinScrew) -> list[Fault]:
    """Return the faults of the geometry: missing fields, and φ_A, φ_B, φ_dis, φ_C out of range (0 is a divisor)."""
    parts = {name: getattr(machine, name) for name in ("volume", "suction_port", "discharge_port")}
    laws = {name: law for name, law in parts.items() if law is not None}
    angles = (fault for name, law in laws.items() if law.by_formula for fault in _angles(name, law))
    return [*angles, *(fault for name, law in laws.items() for fault in _law(name, law)), *_life(machine)]


def _angles(name: str, law: VolumeLaw | SuctionPort | DischargePort) -> Iterator[Fault]:
    """Yield the angles of a paper law that are missing or outside their range."""
    path = f"machine.{name}"
    if isinstance(law, VolumeLaw):
        yield from _inside(f"{path}.phi_A", law.phi_A, 0.0, TURN)
    elif isinstance(law, SuctionPort):
        yield from _inside(f"{path}.phi_B", law.phi_B, 0.0, TURN / 2)
    elif law.opens is None or not TURN < law.opens < LIFE:
        yield from _inside(f"{path}.opens", law.opens, TURN, LIFE, ")")
    else:
        yield from _inside(f"{path}.phi_C", law.phi_C, law.opens, 0.5 * (law.opens + LIFE))


def _law(name: str, law: VolumeLaw | SuctionPort | DischargePort) -> Iterator[Fault]:
    """Yield keys that a law needs and lacks, and those given that belong to another law."""
    path = f"machine.{name}"
    if law.from_file and law.file is None:
        yield Fault(f"{path}.file", "is missing (law: table needs a CSV file)")
    if not law.from_file and law.file is not None:
        yield Fault(f"{path}.file", "applies only to law: table (write `law: table`, or remove the file)")
    if isinstance(law, VolumeLaw):
        if not law.from_rotors and law.max is None:
            yield Fault(f"{path}.max", "is missing (write e.g. max: 500 cm^3; swept volume of one chamber)")
    elif law.by_formula and law.area is None:
        yield Fault(f"{path}.area", "is missing (law: paper needs it)")
    for field in ("max", "phi_A", "area", "phi_B", "opens", "phi_C") if law.from_rotors else ():
        if getattr(law, field, None) is not None:
            yield Fault(f"{path}.{field}", "applies only to other laws: profile finds it from the rotors (remove it)")


def _life(machine: TwinScrew) -> Iterator[Fault]:
    """Yield the faults of the angles of a chamber's life: fractions of pitches, laws that do not fit together."""
    volume, pitch, good = machine.volume, machine.pitch, True
    for field in ("life", "injection_angle"):
        angle, what = getattr(volume, field), ""
        if angle is not None and not volume.from_file:
            what = f"applies only to law: table; law: {volume.law} fixes it (remove it)"
        elif angle is not None and abs(angle / pitch - round(angle / pitch)) > 1e-9:
            step = f"{math.degrees(pitch):.6g} deg"
            what = f"{math.degrees(angle):.6g} deg is not a whole number of lobe pitches of {step}"
        if what:
            good = False
            yield Fault(f"machine.volume.{field}", what)
    life, injection = volume.life or LIFE, volume.injection_angle or TURN
    if good and injection > life - pitch + 1e-9:
        what = "leaves no lobe pitch before the end of the life (choose a smaller angle, or a longer life)"
        yield Fault("machine.volume.injection_angle", what)
    for name in ("suction_port", "discharge_port"):
        law = getattr(machine, name)
        if law is not None and law.by_formula and (volume.from_rotors or machine.counts_otherwise):
            what = "paper is for a chamber life of 720 deg, and volume has another (write law: table or law: profile)"
            yield Fault(f"machine.{name}.law", what)
        if law is not None and law.from_rotors and not volume.from_rotors:
            yield Fault(f"machine.{name}.law", "profile needs machine.volume.law: profile (write that as well)")
