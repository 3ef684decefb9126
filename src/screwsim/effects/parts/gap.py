"""What all gaps share: a clearance, a flow coefficient, and a table that may replace the built-in area.

Source: screwsim. The paper gives (19) for the housing tips and refers to Amosov et al. (1977, not available) for the
profile and end-face gaps; the forms used here for those two are ours (docs/model.md, M20–M22).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from math import isclose, pi
from typing import Any

from screwsim.effects.base import NEIGHBOUR, NOZZLE, Faults, FlowPath, Resistance
from screwsim.effects.parts import gap_flow
from screwsim.effects.parts.gas_transport import declared_gas_viscosity
from screwsim.effects.parts.usual import Sized
from screwsim.inputs.declare import AREA, choice, file, number, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import SQUARE
from screwsim.numerics.kernel import kernel
from screwsim.numerics.spline import features, read_curve, table_value

GAP_FLOW_COEFFICIENT = 0.7  # model.md, contract: default of gaps
BIRTH = 20.0 * pi / 180.0  # angle over which a gap opens that would already be open at its trailing chamber's birth
# a gap of 0.1 of a lobe's height, or 0.02 D, the widest usual one, along a line of 2.5 D has 0.05 D²
AREA_TABLE = Sized("area_file", SQUARE, 1.0, (0.0, 0.05))
COUNTS_720 = "has a formula for a chamber life of 720 deg, and the volume's table has another"


def flow_coefficient(of: str, default: float) -> Any:
    """Declare the flow coefficient of an opening."""
    return number(f"flow coefficient of {of}", default, ge=0.0, le=100.0, hardly=(None, 1.0))


def declared_friction() -> Any:
    """Declare the friction of a mixture of gas and oil in a gap."""
    what = "friction of the mixture, blasius where turbulent; default: laminar (model: oil_sealed)"
    return choice(what, gap_flow.FRICTIONS, None)


@dataclass(frozen=True)
class GapParameters:
    """Parameters of every gap."""

    flow_coefficient: float = flow_coefficient("the gap", GAP_FLOW_COEFFICIENT)
    area_file: str | None = file(
        "CSV with columns angle_deg, area_m2 of the trailing chamber; replaces the built-in area", curve=AREA
    )

    def resistance(self, slides: float | None) -> Resistance | None:
        """Return what the opening adds to a nozzle, None for nothing; `slides` is as for `gap_path`."""
        return None


@dataclass(frozen=True)
class ClearanceParameters(GapParameters):
    """Parameters of a gap that is a clearance times a length."""

    gap: float = quantity("length", "clearance", gt=0.0, hardly=(1e-6, 1e-3))
    model: str = choice("flow model of the gap (M190)", tuple(gap_flow.MODELS), gap_flow.NOZZLE)
    passage: float | None = quantity(
        "length",
        "depth of the gap in the direction of flow; flank fit: difference of the radii",
        None,
        gt=0.0,
        hardly=(1e-5, 0.1),
    )
    friction_fit: str | None = choice("friction fit (model: nozzle_friction)", tuple(gap_flow.FITS), None)
    mixture_viscosity: str | None = choice("viscosity rule (model: oil_sealed)", tuple(gap_flow.MIXTURES), None)
    mixture_friction: str | None = declared_friction()
    filled_from: float | None = number(
        "oil per gas in the upstream chamber above which oil fills the gap (model: oil_film)", None, gt=0.0
    )
    wall_speed: float | None = number(
        "speed at which the housing slides over the gap and drags oil along, over the male tip speed; 0: drags none; "
        "default: that of the rotors (model: oil_film)",
        None,
        ge=0.0,
        le=10.0,
        hardly=(None, 1.0),
    )
    gas_viscosity: float | None = declared_gas_viscosity()

    def resistance(self, slides: float | None) -> Resistance | None:
        of_model = gap_flow.MODELS[self.model].resistance
        return None if of_model is None else of_model(self, slides)


@dataclass(frozen=True)
class PortParameters:
    """Parameters of a port: its area law belongs to the machine."""

    flow_coefficient: float = flow_coefficient("the port", 1.0)


@kernel
def table_area(phi, TAB, curve):
    """Return an area [m²] from the table that begins at index `curve` of TAB."""
    return table_value(phi, TAB, curve)


@kernel
def length_area(phi, gap, TAB, curve):
    """Return clearance times length [m²], the length from the table that begins at index `curve` of TAB."""
    return gap * table_value(phi, TAB, curve)


# M23
@kernel
def ramp(phi, start, full, fall, end):
    """Return 0 outside (start, end), 1 inside [full, fall], and C1 cubic ramps between."""
    if phi <= start or phi >= end:
        return 0.0
    if phi < full:
        x = (phi - start) / (full - start)
    elif phi > fall:
        x = (end - phi) / (end - fall)
    else:
        return 1.0
    return x * x * (3.0 - 2.0 * x)


def gap_path(parameters, area, values, *, breakpoints, offset, corners=(), use_table=True, slides=None) -> FlowPath:
    """Return the flow path of a gap between chambers `offset` pitches apart, from its area kernel or from its table.

    `corners` [rad] are those of a built-in area's slope. `slides` is the speed of the housing past the gap over the tip
    speed; None where no wall slides (M256).
    """
    tables = {}
    if use_table and parameters.area_file is not None:
        angles, areas = read_curve(parameters.area_file, "area_m2")
        area, values, breakpoints = table_area, {}, (angles[0], *features(angles, areas), angles[-1])
        corners = ()
        tables = {"curve": (angles, areas)}
    ends = {"breakpoints": breakpoints, "corners": corners}
    return _between(parameters, area, values, slides, offset=offset, tables=tables, **ends)


def _between(parameters, area, values, slides, **others) -> FlowPath:
    """Return a path between chambers with the gap's flow coefficient and flow model."""
    coefficient, flow = parameters.flow_coefficient, parameters.resistance(slides) or NOZZLE
    return FlowPath(NEIGHBOUR, area, values, flow_coefficient=coefficient, flow=flow, **others)


def profile_paths(parameters, interfaces, gap=None, slides=None) -> list[FlowPath]:
    """Return a gap's flow paths from the rotor profile: clearance [m] times length, or area (gap None).

    `slides` is as for `gap_path`, and applies to the gaps across a lobe.
    """
    area, values = (table_area, {}) if gap is None else (length_area, {"gap": gap})
    found = []
    for each in interfaces:
        tables = {"curve": each.table.curve}
        own, over = {"own_breakpoints": each.table.breakpoints}, slides if each.offset == 1 else None
        found.append(_between(parameters, area, values, over, offset=each.offset, tables=tables, **own))
    return found


def check_gap(
    name: str, parameters, facts, size: str = "", example: str = "", what: str = "", tabled: bool = True
) -> Iterator[Fault]:
    """Yield what a gap lacks apart from the machine's law: its size, or a table where the formula has no meaning.

    size: name of the length or area behind the built-in area; tabled: whether a table replaces all of it.
    """
    machine, path = facts.machine, f"effects.{name}"
    profiled, given = machine.finds_gaps, getattr(parameters, size) if size else None
    built_in = parameters.area_file is None or not tabled
    if built_in and not profiled and machine.counts_otherwise:
        yield Fault(path, f"{COUNTS_720} ({'give area_file' if tabled else 'remove the effect'})")
    elif size and given is None and built_in and not profiled:
        yield Fault(f"{path}.{size}", f"is missing (write e.g. {size}: {example}; {what})")
    elif size == "length" and given is not None and profiled:
        yield Fault(f"{path}.length", f"is given as well as {profiled}, which finds it by angle (remove it)")
    if isinstance(parameters, ClearanceParameters):
        yield from gap_flow.faults(name, parameters, facts)


def check_formula(path: str, facts) -> Iterator[Fault]:
    """Yield why a size that only the formula uses has no meaning: with a profile, or with a table of another life."""
    if facts.machine.finds_gaps:
        yield Fault(path, f"is given as well as {facts.machine.finds_gaps}, which finds it by angle (remove it)")
    elif facts.machine.counts_otherwise:
        yield Fault(path, f"{COUNTS_720} (remove it)")


def check_defaults(name: str, parameters, facts, *keys: str) -> Iterator[Fault]:
    """Yield those of the keys with a default that only the formula uses and that a profiled scene states otherwise."""
    if facts.machine.finds_gaps and parameters.area_file is None:
        for key in _stated_otherwise(parameters, keys):
            yield from check_formula(f"effects.{name}.{key}", facts)


def check_unused(name: str, parameters, what: str, *keys: str) -> Iterator[Fault]:
    """Yield the keys with a default that the scene states otherwise, though nothing uses them, as `what` says."""
    for key in _stated_otherwise(parameters, keys):
        yield Fault(f"effects.{name}.{key}", what)


def _stated_otherwise(parameters, keys: Sequence[str]) -> Iterator[str]:
    """Yield those of the keys whose value is not their default."""
    defaults: dict[str, Any] = {field.name: field.default for field in fields(parameters)}
    return (key for key in keys if not isclose(getattr(parameters, key), defaults[key], rel_tol=1e-9))


def port_path(parameters, law, to) -> FlowPath:
    """Return the flow path of a port to a plenum; its area law belongs to the machine."""
    coefficient, own = parameters.flow_coefficient, law.own_breakpoints
    return FlowPath(
        to, law.area, law.values, law.breakpoints, own, flow_coefficient=coefficient, tables=law.tables, port=True
    )


def check_port(name: str, facts) -> Faults:
    """Yield a fault where the machine has no law of a port (`name`: of the effect and of the machine's section)."""
    if getattr(facts.machine, name, facts.machine) is None:
        yield Fault(f"effects.{name}", f"needs the section machine.{name} (write it, or remove the effect)")
