"""Declarations of inputs: what a field of a scene means, without parsing, units or files.

The lower layers (machine, fluid, effects, numerics) describe their inputs as frozen dataclasses whose fields are made
with `quantity`, `optional`, `number`, `count`, `choice` and `file`. Values are in SI units; the layer `scene` reads the
descriptions and turns YAML text into these dataclasses.

A value outside the limits `gt`, `ge`, `lt`, `le`, or beyond what the kind of a quantity admits, is refused. A value
outside `hardly=(low, high)` is implausible: it is accepted with a warning.

A field whose value another field can state instead names that field in `otherwise`: the speed can be stated by
`tip_speed`. Its value is then a `Derived` one, which is computed anew whenever its source changes, and is not written.
"""

import dataclasses
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypedDict, Unpack

REQUIRED: Any = dataclasses.MISSING


class Derived(float):
    """A quantity that the scene does not state itself: it follows from other values."""


class FoundWithCycle(float):
    """A quantity that a scene leaves open, found with the cycle: the current value of the search, 0 before it."""


AUTO = "auto"  # word in a scene for a quantity to be found


AREA, VOLUME = "area_m2", "volume_m3"  # column names of curves over the angle


class ReplaceableDefault(float):
    """A default that another value of the scene may replace, as long as the scene does not state it."""


class DerivedCount(int):
    """A whole number that the scene does not state itself."""


class DerivedWord(str):
    """A word that the scene does not state itself."""


def is_derived(value: Any) -> bool:
    """Tell whether a value follows from others, or from a default that others may replace."""
    return isinstance(value, Derived | DerivedCount | DerivedWord)


def plain(value: Any) -> Any:
    """Return a value as if the scene stated it itself."""
    for kind in (Derived, DerivedCount, DerivedWord):
        if isinstance(value, kind):
            return kind.__mro__[1](value)
    return value


@dataclass(frozen=True)
class Kind:
    """A dimension: its SI unit, an example of how a person writes it, and limits that no machine exceeds."""

    name: str
    si: str
    example: str
    most: float = math.inf  # of the magnitude
    least: float = -math.inf


KINDS = {
    kind.name: kind
    for kind in (
        Kind("length", "m", "128 mm", most=1e6),
        Kind("area", "m^2", "20 cm^2", most=1e9),
        Kind("volume", "m^3", "500 cm^3", most=1e9),
        Kind("volume_flow", "m^3/s", "20 m^3/min", most=1e9),
        Kind("displacement", "m^3/s", "600 m^3/h", most=1e9),
        Kind("pressure", "Pa", "2 bar", most=1e13),
        Kind("pressure_difference", "Pa", "0.5 bar", most=1e9),
        Kind("temperature", "K", "285 K", most=1e4, least=1.0),
        Kind("temperature_difference", "K", "10 K", most=1e5),
        Kind("speed", "rad/s", "3000 rpm", most=1e6),
        Kind("velocity", "m/s", "30 m/s", most=1e6),
        Kind("angle", "rad", "60 deg"),
        Kind("density", "kg/m^3", "980 kg/m^3", most=1e12),
        Kind("heat_capacity", "J/(kg K)", "2.0 kJ/(kg K)", most=1e5),
        Kind("viscosity", "Pa s", "20 mPa s", most=1e12),
        Kind("force", "N", "8 kN", most=1e10),
        Kind("mass", "kg", "0.3 g", most=1e9),
        Kind("time", "s", "10 ms", most=1e9),
        Kind("stiffness", "N/m", "500 N/m", most=1e15),
        Kind("power", "W", "75 kW", most=1e11),
        Kind("torque", "N m", "200 N m", most=1e10),
        Kind("inertia", "kg m^2", "0.5 kg m^2", most=1e9),
        Kind("torsional_stiffness", "N m/rad", "5000 N m/rad", most=1e15),
        Kind("torsional_damping", "N m s/rad", "10 N m s/rad", most=1e12),
        Kind("thermal_conductivity", "W/(m K)", "0.0146 W/(m K)", most=1e4),
        Kind("surface_tension", "N/m", "30 mN/m", most=10.0),
        Kind("heat_transfer_coefficient", "W/(m^2 K)", "500 W/(m^2 K)", most=1e12),
        Kind("conductance", "W/K", "0.5 kW/K", most=1e12),
        Kind("molar_mass", "kg/mol", "590 g/mol", most=1e3),
        Kind("thermal_expansion", "1/K", "11.5 um/(m K)", most=0.01),
    )
}


Bounds = tuple[float | None, float | None]
UNBOUNDED: Bounds = (None, None)


@dataclass(frozen=True)
class Leaf:
    """One input: its kind (a name of `KINDS`, or number, count, choice, fluid, word, file), default [SI] and limits.

    `hardly` gives the bounds [SI] of usual values, `remedy` what to write in place of a value out of range; `otherwise`
    names neighbouring inputs that may replace this one; an `auto` input may be solved for with the cycle.
    """

    kind: str
    doc: str
    default: Any
    limits: Mapping[str, Any]
    hardly: Bounds = UNBOUNDED
    remedy: str = ""
    otherwise: tuple[str, ...] = ()
    auto: bool = False

    @property
    def required(self) -> bool:
        return self.default is dataclasses.MISSING

    @property
    def dimension(self) -> Kind | None:
        """Return the dimension of a quantity, None for anything else."""
        return KINDS.get(self.kind)


LEAF = "leaf"  # key of a declared field's metadata, whose value is its `Leaf`
LIMITS = ("gt", "ge", "lt", "le", "options", "own", "curve")  # what a field may have beside its plausible range


def _field(
    kind: str,
    default: Any,
    doc: str,
    hardly: Bounds = UNBOUNDED,
    remedy: str = "",
    otherwise: tuple[str, ...] = (),
    auto: bool = False,
    **limits: Any,
) -> Any:
    wrong = [name for name in limits if name not in LIMITS]
    if wrong:
        known = ", ".join(Limits.__annotations__)
        raise TypeError(f"{', '.join(wrong)}: no such keyword of a declared field; known: {known}")
    stated = {name: value for name, value in limits.items() if value is not None}
    leaf = Leaf(kind, doc, default, stated, hardly, remedy, otherwise, auto)
    return dataclasses.field(default=default, metadata={LEAF: leaf}, kw_only=True)


class Limits(TypedDict, total=False):
    """Limits of a number [SI]: bounds, the plausible range `hardly`, and what to write instead of a refused value.

    `otherwise` names fields of the same section that can state it instead; with `auto` it may be found with the cycle.
    """

    gt: float | None
    ge: float | None
    lt: float | None
    le: float | None
    hardly: Bounds
    remedy: str
    otherwise: tuple[str, ...]
    auto: bool


def quantity(kind: str, doc: str, default: Any = REQUIRED, **limits: Unpack[Limits]) -> Any:
    """Declare a dimensional input of a kind in `KINDS`; default, limits and plausible range are in SI units.

    `remedy` says what to write instead of a value out of range.
    """
    if kind not in KINDS:
        raise ValueError(f"unknown kind of quantity {kind!r}; known: {', '.join(KINDS)}")
    return _field(kind, default, doc, **limits)


def optional(kind: str, doc: str) -> Any:
    """Declare a dimensional input above zero that a scene may leave out."""
    return quantity(kind, doc, None, gt=0.0)


def number(doc: str, default: Any = REQUIRED, **limits: Unpack[Limits]) -> Any:
    """Declare a dimensionless input."""
    return _field("number", default, doc, **limits)


def count(doc: str, default: Any = REQUIRED, *, ge: int | None = None, le: int | None = None) -> Any:
    """Declare a whole number."""
    return _field("count", default, doc, ge=ge, le=le)


def choice(doc: str, options: tuple[str, ...], default: Any = REQUIRED, own: str | None = None) -> Any:
    """Declare a word out of several; a choice may change the compiled code.

    `own` is the variable name by which a user's module, given by its dotted name, can be chosen too.
    """
    return _field("choice", default, doc, options=options, own=own)


def word(doc: str, default: Any = REQUIRED) -> Any:
    """Declare a free text."""
    return _field("word", default, doc)


def fluid(doc: str, default: Any = REQUIRED) -> Any:
    """Declare the name of a fluid, or a list of names of a blend's components, which becomes a tuple."""
    return _field("fluid", default, doc)


def numbers(doc: str, default: Any = None, **limits: Unpack[Limits]) -> Any:
    """Declare a list of dimensionless numbers, which becomes a tuple; the limits hold for each number."""
    return _field("numbers", default, doc, **limits)


def file(doc: str, default: Any = None, curve: str | None = None) -> Any:
    """Declare the path of a file, relative to the scene; for a curve over the angle also the column of its values."""
    return _field("file", default, doc, curve=curve)


def inputs_of(part: Any, path: str = "") -> Iterator[tuple[str, Leaf, Any]]:
    """Yield (dotted path, description, value [SI]) of every declared field below a part of a scene, depth first."""
    if isinstance(part, Mapping):
        for name, active in part.items():
            yield from inputs_of(active.parameters, f"{path}.{name}")
        return
    for field in dataclasses.fields(part):
        value = getattr(part, field.name)
        inner = f"{path}.{field.name}" if path else field.name
        if LEAF in field.metadata:
            yield inner, field.metadata[LEAF], value
        elif field.name == "effects" or dataclasses.is_dataclass(value):
            yield from inputs_of(value, inner)


def files_in(part: Any) -> tuple[str, ...]:
    """Return the files named by declared fields below a part of a scene, in the order of `inputs_of`."""
    return tuple(value for _, leaf, value in inputs_of(part) if leaf.kind == "file" and value)
