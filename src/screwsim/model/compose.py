"""Compose the parts of a scene into one flat module: kernels, constants, and the numbers that go in.

What a scene does not name is not in the module: no term, no state, no cost. Structure (paths, states, laws) goes into
the text; numbers go into the vector P and the tables TAB, so that one compiled module serves a whole sweep.
"""

from dataclasses import fields
from functools import lru_cache
from typing import Any

import numpy as np

from screwsim.effects.base import DISCHARGE, LINES, ChamberState, HeatRate, Stops
from screwsim.fluid import nozzle
from screwsim.model import ledger, line_flow, slots, trace, writing, writing_oil
from screwsim.model.breakpoints import breakpoints
from screwsim.model.composition import Composition, NumbersRecipe, Structure
from screwsim.model.module_text import module_text
from screwsim.model.network import balances, port_states, steps, stops, surroundings
from screwsim.model.network.cell import RESERVED, Cell
from screwsim.model.network.chambers import room, work_constants
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import Gap, Network, Port, identifier
from screwsim.model.numbers import fixed_numbers, oil_places, symbols_of
from screwsim.model.parts import Parts
from screwsim.model.renumbering import angles_of, stored_numbers
from screwsim.model.slots import FIRST_OWN, PORT_STATE, R_SIZE
from screwsim.model.writing import ModelWriter, scales
from screwsim.numerics.kernel import Kernel

SHARED = {name: getattr(slots, name) for name in slots.FIXED}  # constants that texts use by name
HELD_GAS = "w_gas"  # name of the state of dissolved gas


def compose(parts: Parts) -> Composition:
    """Return the composition of a scene's parts."""
    network = _network(parts)
    _refuse(network, parts)
    writer, law = ModelWriter(symbols_of(parts), fixed_numbers(parts), parts.made, network), parts.geometry.volume_law()
    _write(writer, parts, law)
    numbers = writer.numbers
    places, oil = tuple(numbers.places.items()), tuple(oil_places(parts).items())
    structure = structure_of(network.key(), tuple(writer.text), places, oil)
    return Composition(
        **{each.name: getattr(structure, each.name) for each in fields(Structure)},
        P=np.array(numbers.values),
        TAB=np.concatenate([*numbers.tables, np.zeros(1)]),
        breakpoints=breakpoints(parts, law),
        recipe=NumbersRecipe(
            np.array(numbers.values),
            list(numbers.named),
            list(numbers.named.values()),
            None if numbers.lost else stored_numbers(parts, law, numbers.held),
            angles_of(parts, law),
            law,
        ),
        ends=(*(path.to for _, path in parts.ports), *(DISCHARGE for _ in parts.gaps)),
        made=tuple(numbers.place_of(cell) for cell in writer.made.values()),
        speed_curve=writer.speed_curve,
        starts=tuple(part.start for _, part in parts.all(ChamberState)),
    )


@lru_cache(maxsize=64)
def structure_of(
    key: tuple[Any, ...],
    own: tuple[str, ...],
    places: tuple[tuple[str, int], ...],
    oil: tuple[tuple[str, int], ...],
) -> Structure:
    """Return the texts and the layout of a network, given by its key.

    `own` are the texts that the parts wrote, `places` the indices of numbers in P, `oil` those of the oil's.
    """
    network = Network(*key)
    cell, layout = Cell(network), Layout(network)
    structure = {"QUADRATURES": len(cell.quadratures), **dict(oil)}
    constants = _constants(network, cell, layout) | dict(places) | SHARED | dict(oil)
    lines = len(network.cells)
    held = lines * PORT_STATE if network.pulsating else 0
    items, numbers = tuple(constants.items()), tuple(structure.items())
    positive = dict(zip(network.own_states, network.positive, strict=True)) | {HELD_GAS: False}
    return Structure(
        text=module_text(key, own, items, numbers, _read_with(network)),
        together=lambda: module_text(key, own, items, numbers, together=True),
        states=network.states,
        ports=tuple(each.effect for each in network.ports),
        gaps=tuple((each.effect, network.offsets[each.side]) for each in network.gaps),
        heats=tuple(each.effect for each in network.heats),
        n_port_state=len(port_states.columns(network)),
        n_sums=len(cell.sums) * len(network.quantities),
        width=len(network.quantities),
        n_E=layout.lines + held,
        n_E_all=network.chambers * layout.size + held,
        chambers=network.chambers,
        carried=network.carried,
        n_films=len(layout.oil_beside),
        n_widths=lines,
        n_R=lines * PORT_STATE if lines > FIRST_OWN or network.pulsating else R_SIZE,
        ported=network.ported,
        walls=tuple(each.effect for each in network.walls),
        own_states=network.own_states,
        stops=tuple((network.states.index(each.position), network.states.index(each.speed)) for each in network.stops),
        signed=tuple(i for i, name in enumerate(network.states) if not positive.get(name, True)),
        pulsating=network.pulsating,
        pushes=network.pushes,
        offsets=tuple(network.offsets),
        n_work_all=room(network),
    )


def _network(parts: Parts) -> Network:
    """Return the cells and connections of a scene; the kernels they call are written later."""
    oil, ported = parts.oil, parts.oil_port is not None
    heated = bool(parts.all(HeatRate)) or ported or parts.oil_room
    carried = heated and oil is not None and oil.carried
    if not carried and (ported or parts.oil_room):
        raise TypeError("oil that enters through ports or takes up volume needs oil, and oil.transport: carried")
    if not carried and any(parts.films):
        raise TypeError("oil that passes beside the gas needs a temperature of the oil, and oil.transport: carried")
    own = [part for _, part in parts.all(ChamberState)]
    names, held = tuple(part.name for part in own), (HELD_GAS,) if parts.dissolves else ()
    states = ("T", "rho", *(("T_oil",) if heated else ()), *(("x_oil",) if carried else ()), *held, *names)
    network = Network(states, names, heated, carried, parts.dissolves, parts.oil_room)
    network.varies, network.supplied = parts.gas.varies, oil is not None
    network.positive = tuple(part.positive for part in own)
    network.cells = [*(f"{name}_line" for name in LINES), "", *(identifier(name) for name in parts.plenums)]
    network.offsets = sorted({path.offset for _, path in parts.gaps})
    for i, (name, path) in enumerate(parts.ports):
        number = parts.number(path.to)
        cell = network.cells[number]
        port = Port(i, name, cell, number, f"P[P_WIDTH_{cell}]", one_way=path.one_way, narrow=path.narrow)
        network.ports.append(port)
    network.gaps = [Gap(i, name, network.offsets.index(path.offset)) for i, (name, path) in enumerate(parts.gaps)]
    # effects that open chambers to suction after the injection angle, or to discharge before it
    network.across = any(not path.port and path.to in LINES for _, path in parts.ports)
    network.chambers = parts.geometry.chambers
    return network


def _write(writer: ModelWriter, parts: Parts, law: Any) -> None:
    """Write the composition's own functions, and register the kernels it calls in the network."""
    network, geometry, oil, port = writer.network, parts.geometry, parts.oil, parts.oil_port
    ports, clearances = [path for _, path in parts.ports], scales(writer, parts, clearances=True)
    writing.write_gas(writer, parts.gas)
    writing.write_volume(writer, law)
    if parts.shaft is not None:
        writing.write_speed(writer, geometry.pitch)
    factors = scales(writer, parts)
    writing.write_areas(writer, [*parts.ports, *parts.gaps], factors)
    writing.write_heat(writer, parts.all(HeatRate))
    writing.write_walls(writer, parts.walls)
    writing.write_pulsations(writer, parts)
    injected = oil if port is None and not geometry.expands else None  # that of an expander comes with the gas
    writing_oil.write_supply(writer, injected, geometry.pitch, parts.omega)
    if port is not None:
        writing_oil.write_ports(writer, parts, port)
    if parts.oil_gas is not None:
        assert oil is not None
        writing_oil.write_flash(writer, parts, oil, parts.oil_gas)
    writing.write_flows(writer, parts.ports, network.ports, clearances)
    writing.write_flows(writer, parts.gaps, network.gaps, clearances)
    if network.own_states:
        writing.write_own_states(writer, [part for _, part in parts.all(ChamberState)], network.states)
    if any(path.opening is not None for path in ports):
        writing.write_openings(writer, ports, network.states)
    if stopped := [part for _, part in parts.all(Stops)]:
        writing.write_stops(writer, stopped, network.states)
    called = (*balances.balance_kernels(network), *steps.step_kernels(network))
    called += (*surroundings.surroundings_kernels(network), *port_states.KERNELS, nozzle.flow)
    for each in (*called, *stops.stop_kernels(network)):
        network.kernels[each.flat_name] = each


def _constants(network: Network, cell: Cell, layout: Layout) -> dict[str, Any]:
    """Return the constants of the text that follow from the network."""
    constants: dict[str, Any] = {
        "N": len(network.states),
        "N_FLOWS": len(layout.flows),
        "N_FILMS": len(layout.oil_beside),
        "CHAMBERS": network.chambers,
    }
    constants |= {name: getattr(ledger, name) for name in ledger.SUMS}
    return constants | layout.constants(list(port_states.columns(network)), cell.quadratures) | work_constants(network)


def _read_with(network: Network) -> tuple[Kernel, ...]:
    """Return the kernels for reading closed cycles that only some structures need."""
    asked = {
        ledger.held_arriving: network.dissolves,
        ledger.oil_arriving: network.carried and not network.roomed,
        ledger.pressed_oil_arriving: network.roomed,
        trace.oil_with_outflow: network.heated and not network.carried,
        line_flow.into_lines: network.pulsating,
        line_flow.line_pulses: network.pulsating,
        trace.heats_along: bool(network.heats),
        trace.oil_films: network.oily,
        trace.port_oil: network.ported,
        trace.given_off_along: network.dissolves,
        trace.phases: network.phases,
    }
    return tuple(each for each, wanted in asked.items() if wanted)


def _refuse(network: Network, parts: Parts) -> None:
    """Raise TypeError for parts of effects that cannot be combined."""
    if len(set(network.states)) < len(network.states):
        raise TypeError(f"two states have one name: {', '.join(network.states)}")
    if taken := sorted(RESERVED & set(network.states)):
        raise TypeError(f"a state cannot be called {', '.join(taken)}: every chamber has a number of that name")
    for name, path in parts.ports:
        if path.flow.in_gaps_alone:
            kind = type(path.flow).__name__
            raise TypeError(
                f"{name}: a {kind} belongs to a gap between chambers, not to an opening to a line or plenum"
            )
        if path.opening is not None and path.flow.with_oil():
            raise TypeError(f"{name}: oil cannot pass beside the gas where the opening depends on the state")
    opened = bool(parts.all(Stops)) or any(path.opening is not None for _, path in parts.ports)
    if opened and network.chambers > 1:
        raise TypeError("an opening that depends on the state, or a seat and a stop, is for a machine of one chamber")
