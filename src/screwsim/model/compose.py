"""From what a scene names to one flat module: kernels, constants, and the numbers that go in.

What is not named is not there: no term, no state, no cost. Structure (which paths, states, laws) goes into the
module's text; numbers go into the vector P and the tables TAB, so that one compiled module serves a whole sweep.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.effects.base import FlowPath, HeatRate
from screwsim.fluid.orifice import orifice_flow
from screwsim.model import chamber, coupled, ledger, places, trace
from screwsim.model.slots import FIRST_FREE
from screwsim.numerics import history, rodas
from screwsim.numerics.kernel import HEADER, Kernel, decorate, flatten, without_wrapper
from screwsim.numerics.spline import pack_curve

# what is called from Python; a wrapper for every small kernel would cost a sixth of the compilation
CALLED = ("own ", "rodas__integrate", "coupled__all", "trace__", "history__", "chamber__inject", "chamber__path_flows")
CALLED += ("chamber__surroundings", "chamber__rates", "chamber__jacobian", "places__places_along", "ledger__account")

# what the integrator calls of both drivers
DRIVEN = ("surroundings", "rates", "jacobian", "error_size", "share_in_phase", "conserve")

# what a composition writes itself (slots.py)
OWN = ("gas_state", "gas_phase", "phased_state", "gas_entropy", "volume_at", "volume_slope_at", "plenum_area")
OWN += ("gap_area", "heat_rates", "heat_part", "injected_oil")

# symbols that a kernel can ask for and that are not numbers of the scene
HEAT_SYMBOLS = ("T", "m", "p", "rho", "V", "phi", "T_oil", "m_oil", "d")


@dataclass(frozen=True)
class OilPart:
    """The oil in the model: properties [SI], transport ('paper' or 'carried') and supply.

    `supply` is {'ratio': d} for a pump, or the orifice's density, viscosity, diameter, length, number, p_separator.
    """

    density: float
    heat_capacity: float
    temperature: float
    transport: str
    supply: Mapping[str, float]


@dataclass(frozen=True)
class Parts:
    """What a scene names, built: the machine's geometry, the gas, operation, oil, and every effect's parts."""

    geometry: Any
    gas: Any
    omega: float
    widths: tuple[float, float, float]  # regularisation [Pa]: suction port, discharge port, gaps
    effects: Mapping[str, Sequence[Any]]
    oil: OilPart | None


@dataclass
class _Numbers:
    """P and TAB while they are being laid out."""

    values: list[float] = field(default_factory=lambda: [0.0] * FIRST_FREE)
    tables: list[np.ndarray] = field(default_factory=list)

    def add(self, value: float) -> str:
        self.values.append(float(value))
        return f"P[{len(self.values) - 1}]"

    def add_table(self, curve: tuple[np.ndarray, ...]) -> str:
        start = sum(len(table) for table in self.tables)
        self.tables.append(pack_curve(*curve))
        return self.add(float(start))


@dataclass(frozen=True)
class Composition:
    """A model ready to be compiled (`text`) and run (`P`, `TAB`, `knots`)."""

    text: str
    P: np.ndarray
    TAB: np.ndarray
    knots: np.ndarray  # of one chamber's life, neighbours' included [rad]
    states: tuple[str, ...]
    plenum_paths: tuple[str, ...]
    gap_paths: tuple[tuple[str, int], ...]  # effect, lobe offset
    heats: tuple[str, ...]  # the effect of each heat rate
    n_place: int  # columns of a history beyond the states
    n_sums: int
    n_E: int
    n_E_all: int
    chambers: int
    carried: bool

    @property
    def n_quadratures(self) -> int:
        """Work, heat, and the streams' sums."""
        return 2 + self.n_sums


class _Writer:
    """Writes the composition's own small functions and collects the kernels they call."""

    def __init__(self, symbols: Mapping[str, float]) -> None:
        self.numbers = _Numbers()
        self.symbols = symbols
        self.kernels: list[Kernel] = []
        self.text: list[str] = []

    def call(self, kernel: Kernel, values: Mapping[str, float], tables: Mapping[str, Any], free: Sequence[str]) -> str:
        """Return a call of the kernel: its arguments are free names, numbers of its own, or symbols of the scene."""
        self.kernels.append(kernel)
        arguments = []
        for name in kernel.arguments:
            if name in free:
                arguments.append(name)
            elif name in values:
                arguments.append(self.numbers.add(values[name]))
            elif name in tables:
                arguments.append(self.numbers.add_table(tables[name]))
            elif name in self.symbols:
                arguments.append(self.numbers.add(self.symbols[name]))
            else:
                known = ", ".join(sorted({*free, *values, *tables, *self.symbols}))
                raise TypeError(f"kernel {kernel.flat_name}: nothing is called {name!r}; known here: {known}")
        return f"{kernel.flat_name}({', '.join(arguments)})"

    def function(self, head: str, body: Sequence[str]) -> None:
        self.text.append(decorate("\n".join([f"def {head}:", *(f"    {line}" for line in body)])))


def symbols_of(parts: Parts) -> dict[str, float]:
    """Return the numbers of the scene that any kernel can ask for by name (docs/nomenclature.md)."""
    machine = parts.geometry.settings
    found = {
        "omega": parts.omega,
        "pitch": parts.geometry.pitch,
        "rotor_diameter": machine.rotor_diameter,
        "rotor_length": machine.rotor_length,
        "male_lobes": float(machine.male_lobes),
        "female_lobes": float(machine.female_lobes),
    }
    if parts.oil is not None:
        found["oil_density"] = parts.oil.density
        found["oil_heat_capacity"] = parts.oil.heat_capacity
    return found


def _flow_paths(parts: Parts) -> list[tuple[str, FlowPath]]:
    return [(name, part) for name, items in parts.effects.items() for part in items if isinstance(part, FlowPath)]


def _write_areas(writer: _Writer, name: str, paths: Sequence[FlowPath]) -> None:
    body = []
    for index, path in enumerate(paths):
        coefficient = writer.numbers.add(path.flow_coefficient)
        call = writer.call(path.area, path.values, path.tables, ("phi", "TAB"))
        body += [f"if i == {index}:", f"    return {coefficient} * {call}"]
    writer.function(f"{name}(i, phi, P, TAB)", [*body, "return 0.0"])


def _write_heat(writer: _Writer, heats: Sequence[HeatRate]) -> None:
    arguments = ", ".join([*HEAT_SYMBOLS, "P"])
    body = ["total = 0.0", "lost = 0.0"]
    one = []
    for index, part in enumerate(heats):
        call = writer.call(part.kernel, part.values, {}, HEAT_SYMBOLS)
        factor = "d * " if part.oil_factor == "printed" else ""
        body += [f"heat = {call}", "total += heat", f"lost += {factor}heat"]
        one += [f"if i == {index}:", f"    heat = {call}", f"    return heat, {factor}heat"]
    writer.function(f"heat_rates({arguments})", [*body, "return total, lost"])
    writer.function(f"heat_part(i, {arguments})", [*one, "return 0.0, 0.0"])


def _write_gas(writer: _Writer, gas: Any) -> None:
    free = ("phase", "T", "rho")
    if gas.phased_state is None:
        phase, state = "0", writer.call(gas.state, gas.values, {}, free)
    else:
        phase, state = (writer.call(kernel, gas.values, {}, free) for kernel in gas.phased_state)
    writer.function("gas_phase(T, rho)", [f"return {phase}"])
    writer.function("phased_state(phase, T, rho, P, TAB)", [f"return {state}"])
    writer.function("gas_state(T, rho, P, TAB)", ["return phased_state(gas_phase(T, rho), T, rho, P, TAB)"])
    entropy = writer.call(gas.specific_entropy, gas.values, {}, free)
    writer.function("gas_entropy(T, rho, P, TAB)", [f"return {entropy}"])


def _write_supply(writer: _Writer, oil: OilPart | None, pitch: float, omega: float) -> None:
    if oil is None:
        body = ["return 0.0"]
    elif "ratio" in oil.supply:
        body = [f"return {writer.numbers.add(oil.supply['ratio'])} * m"]
    else:
        separator = writer.numbers.add(oil.supply["separator_pressure"])
        writer.text.append("")
        call = writer.call(orifice_flow, oil.supply, {}, ("dp",))
        body = [f"dp = {separator} - p", f"return {call} * {writer.numbers.add(pitch / omega)}"]
    writer.function("injected_oil(p, m, P)", body)


def _knots(parts: Parts, law: Any, paths: Sequence[FlowPath]) -> np.ndarray:
    """Return the angles of one life at which own or neighbours' laws are not smooth, sorted, ends included."""
    geometry = parts.geometry
    own = {geometry.injection_angle, *law.knots}
    for path in paths:
        own.update(path.knots)
    shifts = {0}
    for path in paths:
        shifts |= {path.offset, -path.offset}
    found = [knot + shift * geometry.pitch for knot in own for shift in shifts]
    found += law.own_knots
    for path in paths:
        found += [knot + shift * geometry.pitch for knot in path.own_knots for shift in {0, path.offset}]
    # where a neighbour is born or ends
    found += [shift * geometry.pitch + edge for shift in shifts for edge in (0.0, geometry.life)]
    inside = sorted({0.0, geometry.life, *(knot for knot in found if 0.0 < knot < geometry.life)})
    kept = [inside[0]]
    for knot in inside[1:]:
        if knot - kept[-1] > 1e-7:
            kept.append(knot)
    kept[-1] = geometry.life
    return np.array(kept)


def compose(parts: Parts) -> Composition:
    """Return the composition of what a scene names."""
    writer = _Writer(symbols_of(parts))
    geometry, gas, oil = parts.geometry, parts.gas, parts.oil
    named = _flow_paths(parts)
    plenum = [(name, path) for name, path in named if path.to != "neighbour"]
    gaps = [(name, path) for name, path in named if path.to == "neighbour"]
    heating = [(name, part) for name, items in parts.effects.items() for part in items if isinstance(part, HeatRate)]
    heats = [part for _, part in heating]
    carried = bool(heats) and oil is not None and oil.transport == "carried"
    states = ("T", "rho", *(("T_oil",) if heats else ()), *(("x_oil",) if carried else ()))
    law = geometry.volume_law()
    _write_gas(writer, gas)
    for name, kernel in (("volume_at", law.volume), ("volume_slope_at", law.slope)):
        call = writer.call(kernel, law.values, law.tables, ("phi", "TAB"))
        writer.function(f"{name}(phi, P, TAB)", [f"return {call}"])
    _write_areas(writer, "plenum_area", [path for _, path in plenum])
    _write_areas(writer, "gap_area", [path for _, path in gaps])
    _write_heat(writer, heats)
    _write_supply(writer, oil, geometry.pitch, parts.omega)
    offsets = sorted({path.offset for _, path in gaps})
    constants = {
        "N": len(states),
        "VARIES": int(gas.varies),
        "PHASES": int(gas.phased_state is not None),
        "N_HEATS": len(heats),
        "HEATED": int(bool(heats)),
        "CARRIED": int(carried),
        "OILED": int(oil is not None),
        "N_PLENUM": len(plenum),
        "PLENUM": f"np.array({[int(path.to == 'discharge') for _, path in plenum] or [0]})",
        "N_GAPS": len(gaps),
        "GAP_OFFSET": f"np.array({[offsets.index(path.offset) for _, path in gaps] or [0]})",
        "N_OFFSETS": len(offsets),
        "OFFSETS": f"np.array({offsets or [0]})",
        "CHAMBERS": geometry.chambers,
    }
    n_areas = 4 + len(plenum)
    return Composition(
        text=_module_text(tuple(writer.text), tuple(writer.kernels), tuple(constants.items())),
        P=_fixed_numbers(writer, parts),
        TAB=np.concatenate([*writer.numbers.tables, np.zeros(1)]),
        knots=_knots(parts, law, [path for _, path in named]),
        states=states,
        plenum_paths=tuple(name for name, _ in plenum),
        gap_paths=tuple((name, path.offset) for name, path in gaps),
        heats=tuple(name for name, _ in heating),
        n_place=5 if gas.varies else 2,
        n_sums=5 * (4 if carried else 2),
        n_E=n_areas + 2 * len(gaps) + 2 * chamber.SIDE * len(offsets),
        n_E_all=geometry.chambers * (n_areas + len(gaps)),
        chambers=geometry.chambers,
        carried=carried,
    )


def _fixed_numbers(writer: _Writer, parts: Parts) -> np.ndarray:
    """Return P with its fixed head filled in (slots.P_OMEGA …)."""
    oil, geometry = parts.oil, parts.geometry
    head = [parts.omega, geometry.pitch, geometry.life, geometry.injection_angle]
    head += parts.widths
    head += [oil.heat_capacity, oil.temperature, float("ratio" in oil.supply)] if oil is not None else [1.0, 0.0, 0.0]
    writer.numbers.values[:FIRST_FREE] = head
    return np.array(writer.numbers.values)


@lru_cache(maxsize=64)
def _module_text(
    own_functions: tuple[str, ...], kernels: tuple[Kernel, ...], named: tuple[tuple[str, Any], ...]
) -> str:
    """Return the flat module: constants, pasted kernels, the composition's functions, the drivers."""
    constants = dict(named)
    lines = [HEADER, *(f"{name} = {value}" for name, value in named)]
    own = {name: name for name in (*constants, *OWN)}
    rooms = (
        *(getattr(chamber, name) for name in (*DRIVEN, "at_knot", "inject")),
        *(getattr(coupled, f"all_{name}") for name in DRIVEN),
        coupled.no_knot,
        coupled.no_places,
        places.keep_places,
        places.places_along,
    )
    model = flatten(rooms, own)
    model |= flatten((history.add_history, history.states_at))
    model |= flatten((trace.peak_pressure, trace.sample, trace.work_along, ledger.account), own)
    if constants["HEATED"] and not constants["CARRIED"]:
        model |= flatten((trace.oil_with_outflow,), own)
    blocks = flatten(kernels)
    blocks |= {f"own {i}": text for i, text in enumerate(own_functions)}
    blocks |= {name: text for name, text in model.items() if name not in blocks}
    for kind, room, prefix, knot, keep in (
        ("_one", chamber, "", chamber.at_knot, places.keep_places),
        ("_all", coupled, "all_", coupled.no_knot, coupled.no_places),
    ):
        slots = {name: getattr(room, prefix + name).flat_name for name in DRIVEN}
        slots |= {"at_knot": knot.flat_name, "keep_places": keep.flat_name}
        driver = flatten((rodas.integrate,), slots, kind)
        blocks |= {name: text for name, text in driver.items() if name not in blocks}
    texts = [text if name.startswith(CALLED) else without_wrapper(text) for name, text in blocks.items()]
    return "\n\n".join(["\n".join(lines), *texts]) + "\n"
