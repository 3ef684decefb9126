"""From what a scene names to one flat module: kernels, constants, and the numbers that go in.

What is not named is not there: no term, no state, no cost. Structure (which paths, states, laws) goes into the
module's text; numbers go into the vector P and the tables TAB, so that one compiled module serves a whole sweep.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from screwsim.effects.base import ChamberState, FlowPath, HeatRate, Stops
from screwsim.fluid import nozzle
from screwsim.model import ledger, line_flow, slots, trace, writing, writing_oil
from screwsim.model.breakpoints import breakpoints
from screwsim.model.composition import Composition, Recipe
from screwsim.model.module_text import module_text
from screwsim.model.network import balances, port_states, steps, stops, surroundings
from screwsim.model.network.cell import RESERVED, Cell
from screwsim.model.network.chambers import room, work_constants
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import Gap, Network, Port, identifier
from screwsim.model.numbers import fixed_numbers, oil_places, symbols_of
from screwsim.model.parts import Parts
from screwsim.model.slots import FIRST_OWN, OIL_NUMBERS, PORT_STATE, R_SIZE
from screwsim.model.writing import Writer, scales
from screwsim.numerics.kernel import Kernel

SHARED = {name: getattr(slots, name) for name in slots.FIXED}  # what texts call by name
HELD_GAS = "w_gas"  # the state of what the oil holds dissolved
Named = Sequence[tuple[str, FlowPath]]
LINES = ("suction", "discharge")


def compose(parts: Parts) -> Composition:
    """Return the composition of what a scene names."""
    geometry, port = parts.geometry, parts.oil_port
    named = parts.all(FlowPath)
    plenum = [(name, path) for name, path in named if path.to != "neighbour"]
    gaps = [(name, path) for name, path in named if path.to == "neighbour"]
    _refuse_resistances(named)
    network = _network(parts, plenum, gaps)
    stops = [part for _, part in parts.all(Stops)]
    _refuse(network, bool(stops) or any(path.opening is not None for _, path in plenum))
    stopped = tuple((network.states.index(part.position), network.states.index(part.speed)) for part in stops)
    own_states = [part for _, part in parts.all(ChamberState)]
    signed = {HELD_GAS, *(part.name for part in own_states if not part.positive)}
    writer = Writer(symbols_of(parts), fixed_numbers(parts), parts.made, network)
    _write(writer, parts, plenum, gaps)
    cell, layout, numbers, port_states_of_lines = (
        Cell(network),
        Layout(network),
        writer.numbers,
        len(parts.plenums) + FIRST_OWN,
    )
    constants, structure = _constants(network, parts)
    constants |= numbers.places | SHARED | {name: structure[name] for name in OIL_NUMBERS}
    key, own, called = network.key(), tuple(writer.text), tuple(writer.kernels)
    held = port_states_of_lines * PORT_STATE if parts.pulsations else 0
    items = tuple(constants.items()), tuple(structure.items())
    return Composition(
        text=module_text(key, own, called, *items, _read_with(network)),
        together=lambda: module_text(key, own, called, *items, together=True),
        along=lambda: module_text(key, own, called, *items, together=True, along=True),
        P=np.array(numbers.values),
        TAB=np.concatenate([*numbers.tables, np.zeros(1)]),
        breakpoints=breakpoints(parts, geometry.volume_law(), named, port.breakpoints if port is not None else ()),
        states=network.states,
        plenum_paths=tuple(name for name, _ in plenum),
        gap_paths=tuple((name, path.offset) for name, path in gaps),
        ends=(*(path.to for _, path in plenum), *("discharge" for _ in gaps)),
        heats=tuple(name for name, _ in parts.all(HeatRate)),
        n_port_state=len(port_states.columns(network)),
        n_sums=len(cell.sums) * len(network.quantities),
        width=len(network.quantities),
        n_E=layout.lines + held,
        n_E_all=network.chambers * layout.size + held,
        chambers=geometry.chambers,
        carried=network.carried,
        recipe=Recipe(np.array(numbers.values), list(numbers.named), list(numbers.named.values())),
        n_widths=FIRST_OWN + len(parts.plenums),
        n_R=port_states_of_lines * PORT_STATE if parts.plenums or parts.pulsations else R_SIZE,
        ported=port is not None,
        oil_room=parts.oil_room,
        walls=tuple(name for name, _ in parts.walls),
        made=tuple(numbers.place_of(cell) for cell in writer.made.values()),
        speed_curve=writer.speed_curve,
        own_states=network.own_states,
        stops=stopped,
        signed=tuple(i for i, name in enumerate(network.states) if name in signed),
        starts=tuple(part.start for part in own_states),
        pulsating=network.pulsating,
        pushes=network.pushes,
        offsets=tuple(network.offsets),
        n_work_all=room(network),
    )


def _network(parts: Parts, plenum: Named, gaps: Named) -> Network:
    """Return the cells and connections of a scene; what is called of them is written later."""
    oil, ported = parts.oil, parts.oil_port is not None
    heated = bool(parts.all(HeatRate)) or ported or parts.oil_room
    carried = heated and oil is not None and oil.carried
    if not carried and (ported or parts.oil_room):
        raise TypeError("oil that enters through ports or takes room needs oil, and oil.transport: carried")
    if not carried and any(parts.films):
        raise TypeError("oil that leaks as a film needs a temperature of the oil, and oil.transport: carried")
    own = [part for _, part in parts.all(ChamberState)]
    names, held = tuple(part.name for part in own), (HELD_GAS,) if parts.dissolves else ()
    states = ("T", "rho", *(("T_oil",) if heated else ()), *(("x_oil",) if carried else ()), *held, *names)
    network = Network(states, names, heated, carried, parts.dissolves, parts.oil_room)
    network.varies, network.supplied, network.pumped = parts.gas.varies, oil is not None, parts.pumped
    network.positive = tuple(part.positive for part in own)
    network.cells = [*(f"{name}_line" for name in LINES), "", *(identifier(name) for name in parts.plenums)]
    network.offsets = sorted({path.offset for _, path in gaps})
    for i, (name, path) in enumerate(plenum):
        number = parts.number(path.to)
        cell = network.cells[number]
        port = Port(i, name, cell, number, f"P[P_WIDTH_{cell}]", one_way=path.one_way, narrow=path.narrow)
        network.ports.append(port)
    network.gaps = [Gap(i, name, network.offsets.index(path.offset)) for i, (name, path) in enumerate(gaps)]
    # effects that open chambers beyond the injection angle to suction, or others to discharge
    network.across = any(not path.port and path.to in LINES for _, path in plenum)
    network.chambers = parts.geometry.chambers
    return network


def _write(writer: Writer, parts: Parts, plenum: Named, gaps: Named) -> None:
    """Write what the composition has of its own, and put the calls of its kernels into the network."""
    network, geometry, oil, port = writer.network, parts.geometry, parts.oil, parts.oil_port
    ports, between_chambers = [path for _, path in plenum], [path for _, path in gaps]
    writing.write_gas(writer, parts.gas)
    writing.write_volume(writer, geometry.volume_law())
    if parts.shaft is not None:
        writing.write_speed(writer, geometry.pitch)
    factors = scales(writer, parts)
    writing.write_areas(writer, [*plenum, *gaps], factors)
    writing.write_heat(writer, parts.all(HeatRate))
    writing.write_walls(writer, parts.walls)
    writing.write_pulsations(writer, parts)
    writing_oil.write_supply(writer, oil if port is None else None, geometry.pitch, parts.omega)
    if port is not None:
        writing_oil.write_ports(writer, parts, port)
    if parts.oil_gas is not None:
        assert oil is not None
        writing_oil.write_flash(writer, parts, oil, parts.oil_gas)
    writing.write_laws(writer, ports, network.ports)
    writing.write_laws(writer, between_chambers, network.gaps)
    writing.write_resistances(writer, gaps, scales(writer, parts, clearances=True))
    if network.own_states:
        writing.write_own_states(writer, [part for _, part in parts.all(ChamberState)], network.states)
    if any(path.opening is not None for path in ports):
        writing.write_openings(writer, ports, network.states)
    if stopped := [part for _, part in parts.all(Stops)]:
        writing.write_stops(writer, stopped, network.states)
    called = (*balances.balance_kernels(network), *steps.step_kernels(network))
    called += (*surroundings.surroundings_kernels(network), *port_states.port_state_kernels(), nozzle.flow)
    for each in (*called, *stops.stop_kernels(network)):
        network.kernels[each.flat_name] = each


def _constants(network: Network, parts: Parts) -> tuple[dict[str, Any], dict[str, int]]:
    """Return the constants of the text, and the numbers of its structure (slots.py)."""
    layout = Layout(network)
    constants: dict[str, Any] = {
        "N": len(network.states),
        "N_FLOWS": len(layout.flows),
        "N_FILMS": len(layout.sides),
        "CHAMBERS": network.chambers,
    }
    quadratures = Cell(network).quadratures
    constants |= {name: getattr(ledger, name) for name in ledger.SUMS}
    constants |= layout.constants(list(port_states.columns(network)), quadratures) | work_constants(network)
    structure = {"QUADRATURES": len(quadratures)} | oil_places(parts)
    return constants, structure


def _read_with(network: Network) -> tuple[Kernel, ...]:
    """Return what closed cycles are read with, beside what all are."""
    asked = {
        ledger.held_arriving: network.dissolves,
        ledger.oil_arriving: network.carried and not network.roomed,
        ledger.pressed_oil_arriving: network.roomed,
        trace.oil_with_outflow: network.heated and not network.carried,
        line_flow.into_lines: network.pulsating,
        trace.oil_films: any(gap.film or gap.drag for gap in network.gaps),
        trace.port_oil: network.ported,
        trace.given_off_along: network.dissolves,
        trace.phases: network.phases,
    }
    return tuple(each for each, wanted in asked.items() if wanted)


def _refuse(network: Network, opened: bool) -> None:
    """Raise TypeError for parts of effects that do not go together."""
    if len(set(network.states)) < len(network.states):
        raise TypeError(f"two states have one name: {', '.join(network.states)}")
    if taken := sorted(RESERVED & set(network.states)):
        raise TypeError(f"a state cannot be called {', '.join(taken)}: every chamber has a number of that name")
    if opened and network.chambers > 1:
        raise TypeError("an opening that depends on the state, or a seat and a stop, is for a machine of one chamber")


def _refuse_resistances(named: Named) -> None:
    """Refuse resistances that no gap has."""
    if any(path.resistance is not None and path.to != "neighbour" for _, path in named):
        raise TypeError("a resistance belongs to a gap between chambers; an opening to a line or plenum is a nozzle")
