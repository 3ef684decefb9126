"""From what a scene names to one flat module: kernels, constants, and the numbers that go in.

What is not named is not there: no term, no state, no cost. Structure (which paths, states, laws) goes into the
module's text; numbers go into the vector P and the tables TAB, so that one compiled module serves a whole sweep.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from screwsim.effects.base import ChamberState, FlowPath, HeatRate, Stops
from screwsim.fluid import nozzle
from screwsim.model import ledger, slots
from screwsim.model import stops as model_stops
from screwsim.model.module_text import module_text
from screwsim.model.network import balances, between, places, steps
from screwsim.model.network.cell import RESERVED, Cell
from screwsim.model.network.chamber import chamber_texts
from screwsim.model.network.chambers import chambers_texts, room
from screwsim.model.network.moments import moment_text
from screwsim.model.network.network import Gap, Network, Port, identifier
from screwsim.model.parts import Parts
from screwsim.model.sampled import unstated_knots
from screwsim.model.slots import (
    FIRST_OWN,
    OIL_NUMBERS,
    P_FIRST_OIL,
    P_PORT_WIDTH,
    PLACE,
    Q_WALLS,
    R_SIZE,
)
from screwsim.model.writing import (
    Writer,
    operating,
    scales,
    symbols_of,
    write_areas,
    write_flash,
    write_gas,
    write_heat,
    write_laws,
    write_openings,
    write_own_states,
    write_ports,
    write_pulsations,
    write_resistances,
    write_speed,
    write_stops,
    write_supply,
    write_walls,
)

SHARED = {name: getattr(slots, name) for name in slots.FIXED}  # what texts call by name
HELD_GAS = "w_gas"  # the state of what the oil holds dissolved
PORTS, LINES = ("suction_port", "discharge_port"), ("suction", "discharge")


@dataclass(frozen=True)
class Recipe:
    """P as it was composed, and which of its numbers, by place and name, may be others while the structure stays."""

    P: np.ndarray
    places: list[int]
    names: list[str]  # of `writing.operating`


@dataclass(frozen=True)
class Composition:
    """A model ready to be compiled (`text`) and run (`P`, `TAB`, `knots`)."""

    text: str
    together: Callable[[], str] = field(compare=False)  # the text of all chambers, written when it is asked for
    P: np.ndarray
    TAB: np.ndarray
    knots: np.ndarray  # of one chamber's life, neighbours' included [rad]
    states: tuple[str, ...]
    plenum_paths: tuple[str, ...]
    gap_paths: tuple[tuple[str, int], ...]  # effect, lobe offset
    ends: tuple[str, ...]  # of plenum paths and gaps: line or plenum to which what leaves through them goes
    heats: tuple[str, ...]  # the effect of each heat rate
    n_place: int  # columns of a history beyond the states
    n_sums: int
    n_E: int
    n_E_all: int
    chambers: int
    carried: bool
    recipe: Recipe
    width: int = 2  # sums of each category
    n_widths: int = 3  # of the regularisation, from P_PORT_WIDTH on
    n_R: int = R_SIZE
    ported: bool = False
    oil_room: bool = False
    walls: tuple[str, ...] = ()  # the effect of each wall
    made: tuple[int, ...] = ()  # where the numbers that the cycle makes stand in P
    speed_curve: int | None = None  # where in P the square of the speed over its mean begins (speed.slowness)
    own_states: tuple[str, ...] = ()  # the last of `states`: those that effects declare
    stops: tuple[tuple[int, int], ...] = ()  # columns of position and speed of what moves between seat and stop
    signed: tuple[int, ...] = ()  # columns of the states that may be zero or negative
    starts: tuple[float, ...] = ()  # of the own states
    pulsating: bool = False
    n_work_all: int = 0  # numbers that the functions of all chambers write aside

    @property
    def dissolves(self) -> bool:
        """Is what the oil holds dissolved a state?"""
        return self.width == 5

    @property
    def widths(self) -> slice:
        """Where the widths of the regularisation stand in P."""
        return slice(P_PORT_WIDTH, P_PORT_WIDTH + self.n_widths)

    @property
    def first_stream(self) -> int:
        """Index of the first of the streams' sums among the quadratures."""
        return Q_WALLS + 2 * len(self.walls)

    @property
    def n_quadratures(self) -> int:
        """Work, heat, those of the walls, and the streams' sums."""
        return self.first_stream + self.n_sums


def _knots(parts: Parts, law: Any, named: Sequence[tuple[str, FlowPath]], more: Sequence[float]) -> np.ndarray:
    """Return the angles of one life at which own or neighbours' laws are not smooth, sorted, ends included."""
    geometry, paths = parts.geometry, [path for _, path in named]
    own = {geometry.injection_angle, *law.knots, *more}
    for path in paths:
        own.update(path.knots)
    shifts = {0}
    for path in paths:
        shifts |= {path.offset, -path.offset}
    found = [knot + shift * geometry.pitch for knot in own for shift in shifts]
    found += law.own_knots
    for path in paths:
        found += [knot + shift * geometry.pitch for knot in path.own_knots for shift in {0, path.offset}]
    symbols = symbols_of(parts)
    for name, path in named:
        unstated = unstated_knots(name, path, symbols, geometry.life)
        found += [knot + shift * geometry.pitch for knot in unstated for shift in {0, path.offset}]
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
    geometry, gas, oil, port = parts.geometry, parts.gas, parts.oil, parts.oil_port
    named = parts.all(FlowPath)
    plenum = [(name, path) for name, path in named if path.to != "neighbour"]
    gaps = [(name, path) for name, path in named if path.to == "neighbour"]
    heating = parts.all(HeatRate)
    heats = [part for _, part in heating]
    heated = bool(heats) or port is not None or parts.oil_room
    carried = heated and oil is not None and oil.transport == "carried"
    if not carried and (port is not None or parts.oil_room):
        raise TypeError("oil that enters through ports or takes room needs oil, and oil.transport: carried")
    if not carried and any(parts.films):
        raise TypeError("oil that leaks as a film needs a temperature of the oil, and oil.transport: carried")
    own_states = [part for _, part in parts.all(ChamberState)]
    names = tuple(part.name for part in own_states)
    held = (HELD_GAS,) if parts.dissolves else ()
    states = ("T", "rho", *(("T_oil",) if heated else ()), *(("x_oil",) if carried else ()), *held, *names)
    signed = {HELD_GAS, *(part.name for part in own_states if not part.positive)}
    stops = [part for _, part in parts.all(Stops)]
    stopped = tuple((states.index(part.position), states.index(part.speed)) for part in stops)
    opened = any(path.opening is not None for _, path in plenum)
    network = Network(states, names, heated, carried, parts.dissolves, parts.oil_room, gas.varies, oil is not None)
    network.pumped, network.positive = parts.pumped, tuple(part.positive for part in own_states)
    writer = Writer(symbols_of(parts), _fixed_numbers(parts), parts.made, network)
    _connect(network, parts, plenum, gaps)
    _refuse(parts, states, opened or bool(stops))
    law = geometry.volume_law()
    write_gas(writer, gas)
    for name, of_law, sign in (("volume_at", law.volume, ""), ("volume_slope_at", law.slope, "-")):
        call = writer.call(of_law, law.values, law.tables, ("phi", "TAB"))
        body = [f"return {call}"]
        if law.mirror is not None:
            body = [f"phi = {writer.numbers.add(law.mirror, 'volume_mirror')} - phi", f"return {sign}{call}"]
        writer.function(f"{name}(phi, P, TAB)", body)
    speed_curve = write_speed(writer, geometry.pitch) if parts.shaft is not None else None
    factors = scales(writer, parts)
    write_areas(writer, "plenum_area", plenum, factors)
    write_areas(writer, "gap_area", gaps, factors)
    write_heat(writer, heats)
    write_walls(writer, [wall for _, wall in parts.walls])
    write_pulsations(writer, parts)
    write_supply(writer, oil if port is None else None, geometry.pitch, parts.omega)
    if port is not None:
        write_ports(writer, parts, port, _structure(parts)["P_TRAPPED"])
    if parts.oil_gas is not None:
        assert oil is not None
        write_flash(writer, parts, oil, parts.oil_gas)
    write_laws(writer, [path for _, path in plenum], network.ports)
    write_laws(writer, [path for _, path in gaps], network.gaps)
    _refuse_resistances(parts)
    write_resistances(writer, [path for _, path in gaps])
    if own_states:
        write_own_states(writer, own_states, states)
    if opened:
        write_openings(writer, [path for _, path in plenum], states)
    if stops:
        write_stops(writer, stops, states)
    network.stops = len(stops)
    resting = (model_stops.keep_at_rest, model_stops.keep_rows_at_rest, model_stops.note_end, model_stops.note_start)
    called = (*balances.KERNELS, *places.KERNELS, *between.KERNELS, *steps.step_kernels(network), nozzle.flow)
    for each in (*called, *(resting if stops else ())):
        network.kernels[each.flat_name] = each
    constants = {
        "N": len(states),
        "STORED": len(places.columns(network)),
        "N_PLENUM": len(plenum),
        "PLENUM": f"np.array({[parts.number(path.to) for _, path in plenum] or [0]})",
        "N_GAPS": len(gaps),
        "GAP_OFFSET": f"np.array({[gap.side for gap in network.gaps] or [0]})",
        "N_OFFSETS": len(network.offsets),
        "OFFSETS": f"np.array({network.offsets or [0]})",
        "CHAMBERS": geometry.chambers,
    }
    if stops:
        constants["STOP_POSITION"] = f"np.array({[position for position, _ in stopped]})"
        constants["STOP_SPEED"] = f"np.array({[speed for _, speed in stopped]})"
    cell = Cell(network)
    structure = _structure(parts) | {"STOPS": len(stops), "QUADRATURES": len(cell.quadratures)}
    texts, kernels = chamber_texts(network.key())
    texts = *writer.text, *texts, moment_text(network.key())
    n_areas = 4 + len(plenum)
    structure["E_LINES"] = n_areas + 2 * len(gaps) + 2 * (PLACE + 1) * len(network.offsets)
    structure["ALL_LINES"] = geometry.chambers * (n_areas + len(gaps))
    held = (FIRST_OWN + len(parts.plenums)) * PLACE if parts.pulsations else 0
    numbers = writer.numbers
    constants |= {name: getattr(ledger, name) for name in ledger.SUMS}
    constants |= numbers.places | SHARED | {name: structure[name] for name in (*OIL_NUMBERS, "E_LINES", "ALL_LINES")}
    return Composition(
        text=module_text(texts, (*writer.kernels, *kernels), tuple(constants.items()), tuple(structure.items())),
        together=_together(writer, network, constants, structure),
        P=np.array(numbers.values),
        TAB=np.concatenate([*numbers.tables, np.zeros(1)]),
        knots=_knots(parts, law, named, port.knots if port is not None else ()),
        states=states,
        plenum_paths=tuple(name for name, _ in plenum),
        gap_paths=tuple((name, path.offset) for name, path in gaps),
        ends=(*(path.to for _, path in plenum), *("discharge" for _ in gaps)),
        heats=tuple(name for name, _ in heating),
        n_place=constants["STORED"],
        n_sums=len(cell.sums) * len(network.quantities),
        width=len(network.quantities),
        n_E=structure["E_LINES"] + held,
        n_E_all=structure["ALL_LINES"] + held,
        chambers=geometry.chambers,
        carried=carried,
        recipe=Recipe(np.array(numbers.values), list(numbers.named), list(numbers.named.values())),
        n_widths=3 + len(parts.plenums),
        n_R=(FIRST_OWN + len(parts.plenums)) * PLACE if parts.plenums or parts.pulsations else R_SIZE,
        ported=port is not None,
        oil_room=parts.oil_room,
        walls=tuple(name for name, _ in parts.walls),
        made=tuple(numbers.place_of(cell) for cell in writer.made.values()),
        speed_curve=speed_curve,
        own_states=names,
        stops=stopped,
        signed=tuple(i for i, name in enumerate(states) if name in signed),
        starts=tuple(part.start for part in own_states),
        pulsating=bool(parts.pulsations),
        n_work_all=room(network),
    )


def _together(writer: Writer, network: Network, constants: Any, structure: Any) -> Callable[[], str]:
    """Return what writes the module of all chambers."""
    own, called, items = tuple(writer.text), tuple(writer.kernels), (tuple(constants.items()), tuple(structure.items()))
    key = network.key()

    def text() -> str:
        texts, kernels = chambers_texts(key)
        return module_text((*own, *texts), (*called, *kernels), *items, together=True)

    return text


def _connect(network: Network, parts: Parts, plenum: Sequence[Any], gaps: Sequence[Any]) -> None:
    """Put cells, ports and gaps into a network; what is called of them is written later."""
    network.cells = [*(f"{name}_line" for name in LINES), "", *(identifier(name) for name in parts.plenums)]
    network.offsets = sorted({path.offset for _, path in gaps})
    for i, (name, path) in enumerate(plenum):
        number = parts.number(path.to)
        width = f"P[P_PORT_WIDTH + {number}]"
        network.ports.append(
            Port(i, name, network.cells[number], number, width, one_way=path.one_way, narrow=path.narrow)
        )
    network.gaps = [Gap(i, name, network.offsets.index(path.offset)) for i, (name, path) in enumerate(gaps)]
    network.across = _across(parts)
    network.pulsating, network.chambers = bool(parts.pulsations), parts.geometry.chambers


class Composer:
    """Composes the scenes of a series: one that differs from the last by its operation alone is not written anew.

    It gets a vector P of its own: what one solution does to its numbers, another never sees.
    """

    def __init__(self) -> None:
        self._last: tuple[Parts, Composition] | None = None

    def compose(self, parts: Parts) -> Composition:
        """Return what `compose` does."""
        if self._last is None or not _alike(parts, self._last[0]):
            self._last = parts, compose(parts)
            return self._last[1]
        return _filled(self._last[1], parts)


def _alike(parts: Parts, other: Parts) -> bool:
    """Tell whether no more than `_fixed_numbers`, `operating` and what the cycle makes differs.

    Machine and effects must be the same objects: what is in them is not looked at.
    """
    if parts.geometry is not other.geometry or parts.effects is not other.effects or parts.gas != other.gas:
        return False
    if parts.oil_content is not other.oil_content or list(parts.plenums) != list(other.plenums):
        return False
    if parts.oil_content is not None and parts.plenums != other.plenums:
        return False
    return list(parts.made) == list(other.made) and _supplied(parts) == _supplied(other)


def _supplied(parts: Parts) -> tuple[str, ...]:
    """Return what of the oil decides on the structure: nothing without oil, its transport, names of its supply."""
    return () if parts.oil is None else (parts.oil.transport, *parts.oil.supply)


def _filled(composition: Composition, parts: Parts) -> Composition:
    """Return a composition with the numbers of parts that are alike."""
    recipe, head = composition.recipe, _fixed_numbers(parts)
    P = recipe.P.copy()
    P[: len(head)] = head
    if composition.made:
        P[list(composition.made)] = list(parts.made.values())
    if recipe.places:
        named = operating(parts)
        P[recipe.places] = [named[name] for name in recipe.names]
    return replace(composition, P=P)


def _refuse(parts: Parts, states: Sequence[str], opened: bool) -> None:
    """Raise TypeError for parts of effects that do not go together."""
    if len(set(states)) < len(states):
        raise TypeError(f"two states have one name: {', '.join(states)}")
    if taken := sorted(RESERVED & set(states)):
        raise TypeError(f"a state cannot be called {', '.join(taken)}: every chamber has a number of that name")
    if opened and parts.geometry.chambers > 1:
        raise TypeError("an opening that depends on the state, or a seat and a stop, is for a machine of one chamber")


def _structure(parts: Parts) -> dict[str, int]:
    """Return the number of own plenums, and where numbers of the oil stand in P, which moves with it."""
    own = len(parts.plenums)
    return {"OWN_PLENUMS": own} | {name: P_FIRST_OIL + own + i for i, name in enumerate(OIL_NUMBERS)}


def _across(parts: Parts) -> bool:
    """Tell whether effects open chambers beyond the injection angle to suction, or others to discharge."""
    return any(name not in PORTS and path.to in LINES for name, path in parts.all(FlowPath))


def _refuse_resistances(parts: Parts) -> None:
    """Refuse resistances that no gap has."""
    if any(path.resistance is not None and path.to != "neighbour" for _, path in parts.all(FlowPath)):
        raise TypeError("a resistance belongs to a gap between chambers; an opening to a line or plenum is a nozzle")


def _fixed_numbers(parts: Parts) -> list[float]:
    """Return the head of P (slots.P_OMEGA …); each own plenum has its width of the regularisation."""
    oil, geometry = parts.oil, parts.geometry
    head = [parts.omega, geometry.pitch, geometry.life, geometry.injection_angle]
    head += parts.widths
    head += [parts.widths[2] for _ in parts.plenums]
    head += [oil.heat_capacity, oil.temperature, float("ratio" in oil.supply)] if oil is not None else [1.0, 0.0, 0.0]
    if oil is not None and (parts.oil_room or parts.oil_port is not None):
        room = 1.0 / oil.density if parts.oil_room else 0.0
        loss = parts.oil_port.loss(oil.source_pressure) if parts.oil_port is not None else 0.0
        if parts.pumped:
            loss = 0.0  # the pump pays it
        at_port = oil.temperature + room * (oil.source_pressure - loss) / oil.heat_capacity
        head += [room, oil.source_pressure, at_port]
        if parts.pumped:
            head.append(0.0)
    return head
