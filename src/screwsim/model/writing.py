"""Write the functions of a composition itself (slots.py): calls of kernels with their numbers filled in.

Numbers go into P and TAB; whatever affects the terms goes into the text. Where the speed varies over the pitch,
quantities per time are multiplied by `Network.slow`.
"""

import ast
import math
from collections import ChainMap
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from types import MappingProxyType
from typing import Any

from screwsim.effects.base import (
    GAS,
    OIL,
    ChamberState,
    FlowKind,
    FlowPath,
    HeatRate,
    PathStream,
    Scaled,
    Stops,
    Wall,
)
from screwsim.model import pulsation
from screwsim.model.network.cell import taken
from screwsim.model.network.flows import NUMBERS, Around, PortState
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import PRESSURES, Heat, Network, Stop, WallHeat, identifier, line_pressures
from screwsim.model.numbers import Numbers
from screwsim.model.parts import Parts
from screwsim.model.speed import flat_curve, slowness
from screwsim.numerics.kernel import Kernel

# names that kernels can ask for, besides numbers of the scene
STATE_SYMBOLS = ("T", "m", "p", "rho", "V", "phi", *PRESSURES)
OPENING_SYMBOLS = ("drop", "width", "held")
PUSH_SYMBOLS = ("p", *PRESSURES)
GAS_SYMBOLS = "T, rho, y, R, P, TAB"  # arguments of a push on what moves, by the state of the gas
HEAT_SYMBOLS = ("T", "m", "p", "rho", "V", "phi", "T_oil", "m_oil", "d")
WALL_SYMBOLS = HEAT_SYMBOLS[:6]
ANY = PortState(*["1.0"] * len(NUMBERS))
SOMEWHERE = Around(ANY, ANY, "1.0", ANY)  # in which the text of a stream is tried
NO_FACTORS: Mapping[str, Sequence[str]] = MappingProxyType({})


class ModelWriter:
    """Writes the composition's own small functions and collects the kernels they call."""

    def __init__(
        self, symbols: Mapping[str, float], head: Sequence[float], made: Mapping[str, float], network: Network
    ) -> None:
        self.numbers = Numbers(list(head))
        self.made = {name: self.numbers.add(value, name, of=(made, name)) for name, value in made.items()}
        self.symbols = symbols
        self.text: list[str] = []
        self.speed_curve: int | None = None  # its index in P (speed.slowness)
        self.network = network

    def call(
        self,
        kernel: Kernel,
        values: Mapping[str, float],
        tables: Mapping[str, Any],
        free: Sequence[str],
        prefix: str | None = None,
        factors: Mapping[str, Sequence[str]] = NO_FACTORS,
        of: str = "",
    ) -> str:
        """Return a call of the kernel as text.

        Its arguments are free names, its own numbers (with a prefix, `operating` names them by it) times their
        factors, unknowns of the cycle, or symbols of the scene. The text names numbers after what they are
        `of`, or after the kernel's module.
        """
        self.network.kernels[kernel.flat_name] = kernel.plain
        arguments, whose = [], of or kernel.flat_name.partition("__")[0]
        for name in kernel.arguments:
            if name in free:
                arguments.append(name)
            elif name in values:
                operating = None if prefix is None else prefix + name
                held = next(each for each in values.maps if name in each) if isinstance(values, ChainMap) else values
                number = self.numbers.add(values[name], f"{whose}_{name}", operating, (held, name))
                arguments.append(" * ".join([number, *factors.get(name, ())]))
            elif name in tables:
                arguments.append(self.numbers.add_table(tables[name], f"{whose}_{name}"))
            elif name in self.made:
                arguments.append(self.made[name])
            elif name in self.symbols:
                arguments.append(self.numbers.add(self.symbols[name], f"{of}_{name}" if of else name, name))
            else:
                known = ", ".join(sorted({*free, *values, *tables, *self.made, *self.symbols}))
                raise TypeError(f"kernel {kernel.flat_name}: nothing is called {name!r}; known here: {known}")
        return f"{kernel.flat_name}({', '.join(arguments)})"

    def in_time(self, rate: str) -> str:
        """Return the text of a rate at the mean speed, converted to the speed at the angle by `slow` (M217)."""
        return f"slow * {rate}" if self.network.slow else rate

    def function(self, head: str, body: Sequence[str]) -> None:
        """Write a function of the composition."""
        self.text.append("\n".join([f"def {head}:", *(f"    {line}" for line in body)]))

    def chosen(self, head: str, calls: Sequence[str], otherwise: str, before: Sequence[str] = ()) -> None:
        """Write a function that selects one of several calls by index, for use from Python."""
        body = [line for i, call in enumerate(calls) if call for line in (f"if i == {i}:", f"    return {call}")]
        self.function(head, [*before, *body, f"return {otherwise}"])

    def asked(self, name: str, arguments: Sequence[str], calls: Sequence[str], before: Sequence[str] = ()) -> None:
        """Write such a function for rates of one chamber, if there are any (`evaluate.own_effects`)."""
        slow = [f"slow = {self.network.slow}"] if any(call.startswith("slow *") for call in calls) else []
        if calls:
            self.chosen(f"{name}(i, {', '.join(arguments)}, P)", calls, "0.0", [*before, *slow])


def write_areas(
    writer: ModelWriter, paths: Sequence[tuple[str, FlowPath]], scales: Mapping[str, Sequence[str]]
) -> None:
    """Write the area [m²] of each port and gap at an angle, flow coefficient included."""
    layout = Layout(writer.network)
    openings = [*writer.network.ports, *writer.network.gaps]
    for opening, (effect, path) in zip(openings, paths, strict=True):
        label = layout.label(opening)
        of = path, "flow_coefficient"
        flow = writer.numbers.add(path.flow_coefficient, f"{label}_flow_coefficient", of=of)
        coefficient = " * ".join([flow, *scales.get(effect, ())])
        call = writer.call(path.area, path.values, path.tables, ("phi", "TAB"), of=label)
        turned = []
        if path.mirror is not None:
            turned = [f"phi = {writer.numbers.add(path.mirror, label + '_mirror', of=(path, 'mirror'))} - phi"]
        result = [f"return {coefficient} * {call}"]
        slow = writer.network.slow
        if slow:  # evaluated only where something is open
            if path.mirror is not None:  # it goes by the chamber's own angle
                slow, turned = slow.replace("(phi,", "(here,"), ["here = phi", *turned]
            result = [f"area = {call}", f"return {slow} * {coefficient} * area if area != 0.0 else 0.0"]
        writer.function(f"area__{label}(phi, P, TAB)", [*turned, *result])
    writer.chosen("path_area(i, phi, P, TAB)", [layout.area_at(each, "phi") for each in openings], "0.0")


def write_heat(writer: ModelWriter, heats: Sequence[tuple[str, HeatRate]]) -> None:
    """Add the heat [W] from the oil to the gas to the network."""
    for effect, part in heats:
        call = writer.in_time(writer.call(part.kernel, part.values, {}, HEAT_SYMBOLS, of=identifier(effect)))
        writer.network.heats.append(Heat(effect, call, "d * " if part.oil_factor == "printed" else ""))
    writer.asked("heat_part", HEAT_SYMBOLS, [each.call for each in writer.network.heats])


def write_walls(writer: ModelWriter, walls: Sequence[tuple[str, Wall]]) -> None:
    """Add each wall's conductance [W/K] and temperature [K] to the network (M170)."""
    for effect, wall in walls:
        held, of = wall.temperature, (wall, "temperature")
        stated = not isinstance(held, str)
        temperature = writer.numbers.add(held, "wall_temperature", of=of) if stated else made(writer, held)
        call = writer.in_time(writer.call(wall.conductance, wall.values, {}, WALL_SYMBOLS, of=identifier(effect)))
        writer.network.walls.append(WallHeat(effect, call, temperature))
    writer.asked("wall_conductance", WALL_SYMBOLS, [each.call for each in writer.network.walls])


def write_pulsations(writer: ModelWriter, parts: Parts) -> None:
    """Write the relative offset and harmonics of each pulsating line's pressure (M185)."""
    if not parts.pulsations:
        return
    writer.network.kernels[pulsation.harmonics.flat_name] = pulsation.harmonics
    calls = [""] * 2
    for part in parts.pulsations:
        offset, first = made(writer, part.offset), made(writer, part.harmonics[0])
        phase = f"phi * {writer.numbers.add(2.0 * math.pi / parts.geometry.pitch, 'per_pitch', structural=True)}"
        first = first.removeprefix("P[").removesuffix("]")
        call = f"{pulsation.harmonics.flat_name}({phase}, P, {first}, {len(part.harmonics) // 2})"
        number = parts.number(part.to)
        line = writer.network.cells[number]
        writer.function(f"pulse__{line}(phi, P)", [f"return {offset}, {call}"])
        writer.network.pulses = (*writer.network.pulses, line)
        calls[number] = f"pulse__{line}(phi, P)"
    writer.chosen("line_pulse(i, phi, P)", calls, "0.0, 0.0")


def made(writer: ModelWriter, name: str) -> str:
    """Return how the text reads an unknown of the cycle; raise TypeError where no effect declares it."""
    if name not in writer.made:
        raise TypeError(f"no effect declares {name!r} as made by the cycle; known: {', '.join(writer.made) or 'none'}")
    return writer.made[name]


def scales(writer: ModelWriter, parts: Parts, clearances: bool = False) -> dict[str, list[str]]:
    """Return each effect's factors on areas that the cycle determines; with `clearances` those of its gap."""
    found: dict[str, list[str]] = {}
    for _, part in parts.all(Scaled):
        if part.clearance or not clearances:
            found.setdefault(part.effect, []).append(made(writer, part.by))
    return found


def write_gas(writer: ModelWriter, gas: Any) -> None:
    """Write the gas's phase, state and specific entropy at a temperature and density (`fluid.gas.Gas`)."""
    free = ("phase", "T", "rho")
    if gas.phased_state is None:
        phase, state = "0", writer.call(gas.state, gas.values, {}, free)
    else:
        phase, state = (writer.call(kernel, gas.values, {}, free) for kernel in gas.phased_state)
    writer.network.gas, writer.network.phases = state, gas.phased_state is not None
    writer.function("gas_phase(T, rho, P, TAB)", [f"return {phase}"])
    writer.function("phased_state(phase, T, rho, P, TAB)", [f"return {state}"])
    writer.function("gas_state(T, rho, P, TAB)", ["return phased_state(gas_phase(T, rho, P, TAB), T, rho, P, TAB)"])
    entropy = writer.network.entropy = writer.call(gas.specific_entropy, gas.values, {}, free)
    writer.function("gas_entropy(T, rho, P, TAB)", [f"return {entropy}"])


def write_volume(writer: ModelWriter, law: Any) -> None:
    """Write the volume of a chamber and its slope."""
    for name, of_law, sign in (("volume_at", law.volume, ""), ("volume_slope_at", law.slope, "-")):
        call = writer.call(of_law, law.values, law.tables, ("phi", "TAB"))
        body = [f"return {call}"]
        if law.mirror is not None:
            mirror = writer.numbers.add(law.mirror, "volume_mirror", of=(law, "mirror"))
            body = [f"phi = {mirror} - phi", f"return {sign}{call}"]
        writer.function(f"{name}(phi, P, TAB)", body)


def write_speed(writer: ModelWriter, pitch: float) -> None:
    """Make all quantities per time follow the speed over the pitch."""
    start = writer.speed_curve = len(writer.numbers.values) + 1
    curve = writer.numbers.add(float(start), "speed_curve", structural=True)
    writer.numbers.values.extend(flat_curve(pitch).tolist())
    writer.network.kernels[slowness.flat_name] = slowness
    writer.network.slow = f"{slowness.flat_name}(phi, P[P_PITCH], {curve}, P)"


def write_flows(
    writer: ModelWriter, paths: Sequence[tuple[str, FlowPath]], openings: list[Any], scaled: Mapping[str, Sequence[str]]
) -> None:
    """Write the streams through paths into the ports or gaps of the network, as their kinds of flow state them.

    `scaled` has each effect's factors on the `gap` that its kernels take (M190). Kernels with bounds can also be called
    from Python, by number (`evaluate.own_effects`).
    """
    layout, found = Layout(writer.network), []
    for opening, (effect, path) in zip(openings, paths, strict=True):
        kind, factors = path.flow, {"gap": scaled.get(effect, ())}
        maps: tuple[Any, ...] = kind.values, path.values
        call = partial(writer.call, factors=factors, of=layout.label(opening))
        values, roles = ChainMap(*maps), kind.roles
        found.append({role: call(each, values, path.tables, roles[role]) for role, each in kind.kernels().items()})
    openings[:] = [
        replace(opening, streams=_streams(effect, path.flow, calls, writer.network))
        for opening, (effect, path), calls in zip(openings, paths, found, strict=True)
    ]
    checked = {role: path.flow.roles[role] for _, path in paths for role in path.flow.bounds}
    for role, arguments in checked.items():
        writer.asked(paths[0][1].checked(role), arguments, [calls.get(role, "") for calls in found])


def _streams(effect: str, kind: FlowKind, calls: Mapping[str, str], network: Network) -> tuple[PathStream, ...]:
    """Return the streams of a kind of flow; raise TypeError where they are not what the network can take."""
    found = tuple(each._replace(before=tuple(each.before)) for each in kind.streams(calls))
    beside = [each.driven for each in found[1:]]
    name = f"{effect}: {type(kind).__name__}"
    if not found or found[0].of != GAS or found[0].driven or any(each.of != OIL for each in found[1:]):
        raise TypeError(f"{name}: its streams are one of gas, first, and any of oil")
    if len(beside) > len(set(beside)):
        raise TypeError(f"{name}: one stream of oil may be driven by pressures, and one by a wall")
    try:
        names = names_set(found)
    except (LookupError, AttributeError, ValueError, SyntaxError) as error:
        raise TypeError(f"{name}: its text cannot be read ({error})") from None
    if twice := sorted(names and names & taken(network)):
        raise TypeError(f"{name}: its text may not set {', '.join(twice)}, which the text of every chamber has")
    return found


@lru_cache(maxsize=256)
def names_set(streams: tuple[PathStream, ...]) -> frozenset[str]:
    """Return the names that the text of streams sets; raise an error where it cannot be read.

    The text of each stands by itself: it is read without those of the others (`Chamber.film_flows`).
    """
    found: set[str] = set()
    for stream in streams:
        nodes = list(ast.walk(ast.parse("\n".join([*SOMEWHERE.lines(stream), SOMEWHERE.flux(stream)]))))
        names = [each for each in nodes if isinstance(each, ast.Name)]
        own = {each.id for each in names if isinstance(each.ctx, ast.Store)}
        called = {each.func.id for each in nodes if isinstance(each, ast.Call) and isinstance(each.func, ast.Name)}
        unknown = {each.id for each in names if not each.id.startswith("P_")} - own - called - {"P", "TAB", "math"}
        if unknown:
            raise ValueError(f"it does not set {', '.join(sorted(unknown))}")
        found |= own
    return frozenset(found)


def named_states(body: list[str], states: Sequence[str], asked: set[str]) -> list[str]:
    """Return a function's body, preceded by reading those states of y, beyond T and rho, that it uses by name."""
    return [*(f"{name} = y[at + S_{name}]" for name in states[2:] if name in asked), *body]


def write_own_states(writer: ModelWriter, own: Sequence[ChamberState], states: Sequence[str]) -> None:
    """Add the rates [1/s] of the effects' own states to the network."""
    for part in own:
        call = writer.call(part.rate, part.values, {}, (*STATE_SYMBOLS, *states), of=part.name)
        writer.network.rates.append(writer.in_time(call))
    asked = {name for part in own for name in part.rate.arguments}
    before = named_states([], states, asked)
    writer.asked("state_rate", (*STATE_SYMBOLS, "y", "at"), writer.network.rates, before)


def write_openings(writer: ModelWriter, paths: Sequence[FlowPath], states: Sequence[str]) -> None:
    """Write the open share of each port whose opening depends on the chamber's state (a valve)."""
    layout, calls = Layout(writer.network), [""] * len(paths)
    for index, path in enumerate(paths):
        if path.opening is not None:
            label = layout.label(writer.network.ports[index])
            call = writer.call(path.opening, path.values, {}, (*OPENING_SYMBOLS, *states[2:]), of=label)
            writer.network.ports[index] = replace(writer.network.ports[index], opening=call)
            head = f"opening__{label}(drop, width, held, y, at, P)"
            writer.function(head, named_states([f"return {call}"], states, set(path.opening.arguments)))
            calls[index] = head
    writer.chosen("path_opening(i, drop, width, held, y, at, P)", calls, "1.0")


def write_stops(writer: ModelWriter, stops: Sequence[Stops], states: Sequence[str]) -> None:
    """Write the push on what moves between a seat and a stop: its acceleration at rest, by pressures or by the gas."""
    lines = ", ".join(line_pressures(writer.network).values())
    arguments = f"{', '.join(PUSH_SYMBOLS)}, y, at, P"
    for part in stops:
        call = writer.call(part.push, part.values, {}, (*PUSH_SYMBOLS, *states[2:]), of=part.position)
        label = f"{part.position}_restitution"
        seat, stop = (writer.numbers.add(each, label, structural=True) for each in part.restitution)
        writer.network.stops.append(Stop(part.position, part.speed, seat, stop))
        asked = named_states([f"return {call}"], states, set(part.push.arguments))
        writer.function(f"push__{part.position}({arguments})", asked)
        gas = "p, _h, _c_v, _TpT, _exponent, _choke, _choked = gas_state(T, rho, P, TAB)"
        push = f"return push__{part.position}(p, {lines}, y, 0, P)"
        writer.function(f"push_on__{part.position}({GAS_SYMBOLS})", [gas, push])
    names = [part.position for part in stops]
    writer.chosen(f"stop_push(i, {arguments})", [f"push__{name}({arguments})" for name in names], "0.0")
    writer.chosen(f"push_on(i, {GAS_SYMBOLS})", [f"push_on__{name}({GAS_SYMBOLS})" for name in names], "0.0")
