"""What a kind of machine provides: settings, geometry, what effects may use of it, and bounds of its sizes.

Source: screwsim, docs/how-to/adding-a-machine.md.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np

from screwsim.inputs.faults import Fault
from screwsim.numerics.kernel import Kernel
from screwsim.numerics.spline import negligible_areas, pack_curve

# features that a machine may offer and an effect may need
PORTS = "ports"  # area laws: `suction_law`, `discharge_law`
TIP_GAP, CONTACT_GAP, BLOW_HOLE, END_GAP = "tip gap", "contact-line gap", "blow-hole", "end-face gap"
GAPS = TIP_GAP, CONTACT_GAP, BLOW_HOLE, END_GAP  # returned by `interfaces`
OIL = "oil"  # injected into the chambers
HOLES = "holes"  # in the housing, passed by the chambers, at angles like a twin screw's
ROTORS = "screw rotors"  # a male and a female rotor, with their settings and symbols
CYLINDER = "cylinder"  # one chamber with a bore, valves and rings

# length scales of a machine, to which sizes of effects are compared
LOBE = "height of a lobe"
DIAMETER, SQUARE = "rotor diameter", "square of the rotor diameter"
SPAN = "rotor diameter and length together"
SHELL = "both bores and their ends"
WIDEST = 350.0  # largest area over the shell's: an ideal machine may have ports far too wide to throttle
BORE, PISTON = "bore", "area of the piston"


COMPRESSOR, EXPANDER = "compressor", "expander"  # options of `machine.mode`


@dataclass(frozen=True)
class AreaLaw:
    """A port area: kernel, values of its arguments [SI], breakpoints [rad], tables (angle [rad], area [m²]).

    `rows` are angles [rad] between which the area is monotone, and the areas there. When a port opens or is widest is
    read from these, never from the breakpoints, which only say where steps end.
    """

    area: Kernel
    values: Mapping[str, float]
    breakpoints: tuple[float, ...]
    rows: tuple[Any, Any]
    tables: Mapping[str, Any] = field(default_factory=dict)
    own_breakpoints: tuple[float, ...] = ()  # those that matter to this chamber, not to its neighbours

    @cached_property
    def widest(self) -> float:
        """Angle at which the port is widest [rad]."""
        angles, areas = self.rows
        return float(angles[int(np.argmax(areas))])

    @cached_property
    def opens(self) -> float | None:
        """Angle up to which the port is shut before its widest [rad]; None where it is open from the first row on."""
        angles, areas = self.rows
        before = np.flatnonzero(negligible_areas(areas)[: int(np.argmax(areas))])
        return float(angles[before[-1]]) if len(before) else None


@dataclass(frozen=True)
class VolumeKernels:
    """The volume law: V(φ) and dV/dφ from the same numbers; with `mirror` [rad] they are evaluated at mirror − φ."""

    volume: Kernel
    slope: Kernel
    values: Mapping[str, float]
    breakpoints: tuple[float, ...]
    tables: Mapping[str, Any] = field(default_factory=dict)
    own_breakpoints: tuple[float, ...] = ()  # those that matter to this chamber, not to its neighbours
    mirror: float | None = None

    @cached_property
    def known(self) -> dict[str, Any]:
        """Values of the kernels' arguments, with all tables packed into one array."""
        TAB, start = np.zeros(1), {}
        for name, curve in self.tables.items():
            start[name] = float(len(TAB))
            TAB = np.concatenate([TAB, pack_curve(*curve)])
        return {**self.values, **start, "TAB": TAB}

    def along(self, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return V [m³] and dV/dφ [m³/rad] at angles [rad], in plain Python."""
        known = self.known
        sign, at = (1.0, angle) if self.mirror is None else (-1.0, self.mirror - angle)
        found = []
        for law in (self.volume, self.slope):
            others = [known[name] for name in law.arguments if name != "phi"]
            found.append(np.array([law(phi, *others) for phi in at.ravel().tolist()]).reshape(at.shape))
        return found[0], sign * found[1]


class MachineSettings(Protocol):
    """The settings of a machine in a scene: a frozen dataclass of `screwsim.inputs.declare` fields, in SI units.

    `kind` is the name under which scenes ask for it, `mode` 'compressor' or 'expander'. `symbol_names` are those of its
    settings that a kernel can take.
    """

    kind: str
    mode: str
    symbol_names: ClassVar[tuple[str, ...]] = ()

    @property
    def finds_gaps(self) -> str:
        """What determines lengths and neighbours of the gaps, in words; empty where formulas of the effects do."""
        return ""

    @property
    def counts_otherwise(self) -> bool:
        """Whether the angles of those formulas have no meaning for this machine."""
        return False

    @property
    def expands(self) -> bool:
        """Whether the machine runs backwards, as an expander (M150)."""
        return self.mode == EXPANDER

    def symbols(self) -> dict[str, float]:
        """Return the numbers [SI] that a kernel can take by name (docs/reference/nomenclature.md)."""
        return {name: float(getattr(self, name)) for name in self.symbol_names}

    def surface_speed(self, omega: float) -> float:
        """Return the speed of the surfaces that move the gas [m/s] at a speed [rad/s]."""
        raise NotImplementedError


class MachineGeometry(Protocol):
    """What model and effects need to know of a machine. Angles [rad] are a chamber's, from its birth at 0 to `life`.

    A chamber is born every `pitch`; the life is a whole number of pitches. Suction ends, and the trapped mass is taken,
    at `injection_angle`, also a whole number of pitches. `volume_law` gives V(φ) > 0 and its exact slope, and V(life) =
    V(0). A machine need not define what has a default here.
    """

    settings: Any

    @property
    def pitch(self) -> float:
        """Angle between neighbouring chambers [rad]."""
        raise NotImplementedError

    @property
    def life(self) -> float:
        """Angle of a chamber's life [rad]."""
        raise NotImplementedError

    @property
    def injection_angle(self) -> float:
        """Angle at which suction ends, the trapped mass is taken and oil is injected [rad]."""
        raise NotImplementedError

    @property
    def swept_volume(self) -> float:
        """Swept volume of one chamber [m³]."""
        raise NotImplementedError

    def volume_law(self) -> VolumeKernels:
        """Return the volume law."""
        raise NotImplementedError

    @property
    def chambers(self) -> int:
        """Number of chambers alive at once."""
        return round(self.life / self.pitch)

    @property
    def expands(self) -> bool:
        """Whether the machine runs backwards, as an expander (M150)."""
        return False

    @property
    def discharge_opens(self) -> float | None:
        """Angle [rad] at which the discharge port opens, or an expander's inlet closes; None where there is none."""
        return None

    @property
    def inlet_closes(self) -> float | None:
        """Angle at which the inlet of an expander closes [rad]; None for others, or where it never closes."""
        return self.discharge_opens if self.expands else None

    def widest_discharge(self) -> float:
        """Return the angle up to which the peak pressure is searched for [rad]."""
        return self.life

    def suction_law(self) -> AreaLaw:
        """Return the area law of the suction port, where the machine offers ports."""
        raise NotImplementedError

    def discharge_law(self) -> AreaLaw:
        """Return the area law of the discharge port, where the machine offers ports."""
        raise NotImplementedError

    def interfaces(self, gap: str) -> tuple[Any, ...] | None:
        """Return a kind's gaps (`profile_law.Interface`) such as TIP_GAP; None: the effects' formulas define them."""
        return None

    def wall_speed(self, gap: str) -> float:
        """Return the mean speed at which a wall slides past the gaps of a kind towards the chamber behind (M256).

        It is over `surface_speed` and perpendicular to the gap's line; 0 where no wall slides, or where it is not
        known.
        """
        return 0.0

    @property
    def profile(self) -> Any:
        """The curves that a profile of screw rotors gives by angle; None without a profile."""
        return None

    def male_slope(self, angle: np.ndarray) -> np.ndarray | None:
        """Return the part of dV/dφ [m³/rad] that the male of two screw rotors displaces; None where it is unknown."""
        return None

    @property
    def stated_volume_ratio(self) -> float | None:
        """Built-in volume ratio that the scene states; None where it follows from the laws."""
        return None

    def built_in_volume_ratio(self, volume_at: Callable[[float], float]) -> float | None:
        """Return the chamber's volume where suction closes over that where the discharge port opens.

        It is the stated value where the port follows from that; None for a machine without a port that opens at an
        angle. `volume_at` returns the volume [m³] at an angle [rad] of the chamber.
        """
        stated, opens = self.stated_volume_ratio, self.discharge_opens
        return stated if stated or opens is None else volume_at(self.injection_angle) / volume_at(opens)

    @property
    def outcomes(self) -> tuple[float, ...]:
        """Numbers that distinguish machines whose laws are all in tables."""
        return ()


class Measure(NamedTuple):
    """A length, area or volume scale of a machine [SI] from its settings, and its name in words: 'of the bore'."""

    of: Callable[[Any], float]
    what: str


@dataclass(frozen=True)
class Size:
    """A size at a path of a scene: over a scale `of` [SI] it must not exceed `most`, and is unusual outside `usual`."""

    path: str
    of: Callable[[Any], float]
    what: str  # the scale, in words
    most: float
    usual: tuple[float, float]
    remedy: str = "choose a smaller one; is the unit right?"


@dataclass(frozen=True)
class Speed:
    """What moves at `surface_speed`, in words; the highest speed [m/s], the highest usual one, and the reason.

    `with_oil` is the highest usual one of a machine with oil in its chambers, where that is lower.
    """

    what: str
    most: float
    usual: float
    why: str
    with_oil: float | None = None


@dataclass(frozen=True)
class MachineKind:
    """One kind of machine: a module of its own with a variable MACHINE.

    `settings` is the type of its settings, `geometry` makes a `MachineGeometry` of them, `check` returns their faults.
    `offers` are the features that effects may need. `sizes` and `speed` bound what is possible, `tables` the largest
    area of a table; `scales` are those to which effects compare sizes of their own. `called` are other words for the
    kind, `chamber` is its chamber in words. `dead_volume` returns path and size [m³] of the volume left in a chamber,
    an empty path where a table holds it. `derived` fills in settings that follow from others stated in their place, and
    `stated` yields the faults of settings that are stated twice or not at all, or of lengths that make no machine; it
    is called before anything else.
    """

    settings: type
    geometry: Callable[[Any], MachineGeometry]
    offers: frozenset[str]
    check: Callable[[Any], list[Fault]] = lambda machine: []
    sizes: tuple[Size, ...] = ()
    scales: Mapping[str, Measure] = field(default_factory=dict)
    speed: Speed | None = None
    tables: Size | None = None
    called: tuple[str, ...] = ()
    chamber: str = "this machine"
    dead_volume: Callable[[Any], tuple[str, float]] = lambda machine: ("", 0.0)
    derived: Callable[[Any], Any] = lambda machine: machine
    stated: Callable[[Any], Iterable[Fault]] = lambda machine: ()
