"""Description of a scene in words: effects, states, flow paths, equations (docs/model.md), and what is left out.

Nothing is compiled for it.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from screwsim.build import build_parts, faults_of_own, regularisation
from screwsim.cycle.solution import closing_criteria
from screwsim.effects import base, catalogue
from screwsim.effects.base import LINES
from screwsim.effects.parts.flow_kinds import FlowKind, Nozzle, Resistance
from screwsim.explain.media import gas_rows, oil_rows
from screwsim.explain.parameters import NO_BREAK, parameters_text, row
from screwsim.figures import called_for
from screwsim.inputs.declare import KINDS
from screwsim.inputs.suggestions import counted, joined_names
from screwsim.machine.kinds import kind_of
from screwsim.machine.profile_law import LaidCurves
from screwsim.machine.protocol import ROTORS
from screwsim.machine.rotors.curves import closed_in
from screwsim.machine.settings import TwinScrew
from screwsim.machine.slider_crank.cylinder import SliderCrank
from screwsim.model.compose import HELD_GAS, compose
from screwsim.model.composition import Composition
from screwsim.model.parts import Parts
from screwsim.numerics.settings import CLOSINGS
from screwsim.outputs.customary import in_bar, in_celsius, with_printed_units
from screwsim.scene.fields import Section, section_of
from screwsim.scene.grid import FLUID, case_count, dimensions
from screwsim.scene.left_out import leaks_in_words, machine_in_words, suitable_effects
from screwsim.scene.types import ActiveEffect, Scene
from screwsim.scene.units import readable_quantity

STATE_MEANINGS = {
    "T": "gas temperature [K]",
    "rho": "gas density [kg/m³], gas mass over volume",
    "T_oil": "oil temperature [K]",
    "x_oil": "oil mass over gas mass",
    "w_gas": "dissolved gas per mass of oil",
}
BALANCES = "balances of mass and energy M1, M2; work M7"


@dataclass(frozen=True)
class Explanation:
    """Description of what a scene simulates; `str` gives the text. `sections` are (heading, lines)."""

    title: str
    active: tuple[str, ...]
    left_out: tuple[str, ...]
    states: tuple[str, ...]
    sections: tuple[tuple[str, tuple[str, ...]], ...]

    def __str__(self) -> str:
        blocks = ["\n".join([heading, *lines]) for heading, lines in self.sections]
        return with_printed_units("\n\n".join([self.title, *blocks] if self.title else blocks))


def code(scene: Scene) -> str:
    """Return the code that is compiled for a scene. Raise UsageError for an unknown fluid."""
    with faults_of_own(scene):
        composition = compose(build_parts(scene))
        if composition.chambers == 1:
            return composition.text
        between = "\n\n# all chambers together, compiled only when needed\n\n"
        return composition.text + between + composition.together()


def explain(scene: Scene) -> Explanation:
    """Return what a scene simulates, and what it leaves out. Raise UsageError for an unknown fluid."""
    with faults_of_own(scene):
        parts = build_parts(scene)
        model = compose(parts)
    kind = kind_of(scene.machine)
    left_out = tuple(name for name in suitable_effects(scene) if name not in scene.effects)
    omitted = [row(name, catalogue()[name].title) for name in left_out]
    omitted = omitted or [row("none", "every effect of the catalogue is active")]
    sections: list[tuple[str, Iterable[str]]] = [
        ("Machine", _machine(scene, parts)),
        (f"Active effects ({_effect_counts(scene, left_out)})", _effects(scene, parts)),
        ("Left out: adds no term, no state and no computing time", omitted),
        ("Chamber", _chamber(parts, model, "male rotor" if ROTORS in kind.offers else "shaft")),
        ("Flow paths", _paths(parts)),
        ("Gas", gas_rows(scene, parts)),
        ("Oil", oil_rows(scene, parts)),
        ("Numerics (docs/explanation/numerics.md)", _numerics(scene)),
        ("Compiled model", _size(model)),
    ]
    if scene.sweep:
        sections.append((f"Sweep ({case_count(scene)} cases)", _sweep(scene)))
    filled = tuple((heading, tuple(lines)) for heading, lines in sections)
    return Explanation(scene.title, tuple(scene.effects), left_out, model.states, filled)


def _effect_counts(scene: Scene, left_out: tuple[str, ...]) -> str:
    """Return how many effects are active, how many this kind of machine can have, and how many there are."""
    every = catalogue()
    active = sum(name in every for name in scene.effects)
    own = len(scene.effects) - active
    machine = machine_in_words(scene)
    text = f"{active} of the {active + len(left_out)} of {machine}; {len(every)} in all"
    return f"{text}; {own} of your own" if own else text


def _machine(scene: Scene, parts: Parts) -> Iterator[str]:
    if isinstance(scene.machine, SliderCrank):
        yield from _cylinder(scene.machine, scene.operation.speed)
    elif isinstance(scene.machine, TwinScrew):
        yield from _screws(scene.machine, parts)
    else:
        yield row("kind", f"{scene.machine.kind}, {scene.machine.mode}")
        swept = f"swept volume {parts.geometry.swept_volume * 1e6:.6g} cm³".replace(" ", NO_BREAK)
        yield row("parameters", f"{parameters_text(scene.machine, skip=('kind', 'mode'))}; {swept}")
    speed, tips = readable_quantity(KINDS["speed"], scene.operation.speed), scene.operation.tip_speed
    stated = "" if tips is None else f" (tips at {readable_quantity(KINDS['velocity'], tips)})"
    yield row("speed", f"{speed}{stated}, {parts.omega / parts.geometry.pitch:.5g} chamber lives/s")


def _cylinder(machine: SliderCrank, omega: float) -> Iterator[str]:
    yield row("kind", f"{machine.kind}, {machine.mode}")
    yield row("volume", f"crank and rod (S1, S5), {parameters_text(machine, skip=('kind', 'mode'))}")
    stroke = f"stroke {1e3 * machine.stroke:.6g} mm".replace(" ", NO_BREAK)
    swept = f"swept volume {machine.swept_volume * 1e6:.6g} cm³".replace(" ", NO_BREAK)
    yield row("", f"{stroke}, {swept}, clearance {machine.clearance_ratio:.3%} of it")
    yield row("", f"mean piston speed {machine.surface_speed(omega):.5g} m/s")


def _screws(machine: TwinScrew, parts: Parts) -> Iterator[str]:
    size = " x ".join(f"{1e3 * each:.6g} mm" for each in (machine.rotor_diameter, machine.rotor_length))
    yield row(
        "kind", f"{machine.kind}, {machine.mode}, lobes {machine.male_lobes}/{machine.female_lobes}, rotor {size}"
    )
    yield from _size_rows(machine, parts)
    if parts.geometry.expands:
        yield row(
            "", "the machine below runs backwards: its laws at one life minus the angle, its lines swapped (M150)"
        )
    laws = {"volume": machine.volume, "suction_port": machine.suction_port, "discharge_port": machine.discharge_port}
    numbers = {"volume": "M16", "suction_port": "M17", "discharge_port": "M18"}
    for name, law in laws.items():
        if law is not None:
            equation = law.read_by.source or numbers[name]
            yield row(name, ", ".join(filter(None, (f"law: {law.law} ({equation})", parameters_text(law)))))
    yield from _rotors(machine, parts)


def _size_rows(machine: TwinScrew, parts: Parts) -> Iterator[str]:
    """Yield the rows on a displacement or volume ratio that replaces lengths or angles."""
    stated = machine.displacement
    if stated is not None:
        flow, at = readable_quantity(KINDS["displacement"], stated.flow), readable_quantity(KINDS["speed"], stated.at)
        follows = "the rotors' size" if machine.volume.from_rotors else "the chambers' volume"
        yield row("displacement", f"{flow} at {at}, from which {follows} follows")
    port, ratio = machine.discharge_port, machine.built_in_volume_ratio
    if ratio is not None and port is not None and port.from_file:
        opens = math.degrees(parts.geometry.discharge_law().opens or 0.0)
        what = f"to which the table of the discharge port is shifted: opens {opens:.5g} deg (M394)"
        yield row("volume ratio", f"{ratio:g}, {what}")
    elif ratio is not None and not machine.volume.from_rotors:
        yield row("volume ratio", f"{ratio:g}, from which the discharge port's angles follow (M16)")


def _rotors(machine: Any, parts: Parts) -> Iterator[str]:
    laid = parts.geometry.profile
    if laid is None:
        return
    degrees = [f"{math.degrees(angle):.5g}" for angle in (laid.born, laid.injection, laid.opens, laid.ends)]
    yield row("profile", parameters_text(machine.profile, skip=()))
    if laid.rotors.chain.faired:
        yield row("", laid.rotors.chain.faired)
    swept = f"{laid.swept * 1e6:.6g} cm³".replace(" ", NO_BREAK)
    axial = "" if machine.axial_volume_ratio is None else f", of the axial port {machine.axial_volume_ratio:g}"
    ratio, found = machine.built_in_volume_ratio, closed_in(laid.rotors, laid.curves)[1]
    built_in = f"{found:.4g}, where the table of the discharge port opens" if ratio is None else f"{ratio:g}"
    yield row("", f"swept volume {swept} of a chamber; built-in volume ratio {built_in}{axial}")
    if machine.slide_valve is not None:
        yield row("slide valve", _slide(machine.slide_valve, laid))
    yield row(
        "angles",
        f"born at {degrees[0]} deg, suction closes at {degrees[1]} deg, discharge opens at {degrees[2]} deg, "
        f"ends at {degrees[3]} deg; idle before and after, with its dead volume",
    )


def _slide(slide: Any, laid: LaidCurves) -> str:
    """Return the position of a slide valve, and its effect on a chamber."""
    told = parameters_text(slide, skip=())
    if not laid.moved:
        return f"{told}; at full load, with its slot shut"
    share, ratio = closed_in(laid.rotors, laid.curves)
    return f"{told}; traps {100.0 * share:.3g} % of the volume, at a volume ratio of {ratio:.3g}"


def _sections(values: Any, under: str = "") -> Iterator[str]:
    """Yield the sections among the parameters of an effect, with their contents."""
    for name, item in section_of(type(values)).fields.items():
        value = getattr(values, name)
        if isinstance(item, Section) and value is not None:
            own = parameters_text(value, skip=())
            yield f"{under}{name}: {own}" if own else f"{under}{name}"
            yield from _sections(value, f"{under}{name}.")


def _effects(scene: Scene, parts: Parts) -> Iterator[str]:
    called = called_for(scene, parts)
    for name, active in scene.effects.items():
        yield row(name, active.effect.title)
        given = [figure.name for figure in active.effect.figures if figure.name in called]
        yield from (row("", text) for text in _effect_rows(active, parts.effects[name], parts.dissolves, given))
    if not scene.effects:
        yield row("none", "a closed chamber, whose gas is compressed and expands again")
    told = leaks_in_words(scene)
    if told:
        yield row("leaks", told.removeprefix("leaks "))


def _effect_rows(active: ActiveEffect, built: Any, dissolves: bool, given: list[str]) -> Iterator[str]:
    effect = active.effect
    yield f"{', '.join(effect.equations)}; source: {effect.source}"
    parameters = parameters_text(active.parameters, skip=())
    if parameters:
        yield parameters
    yield from _sections(active.parameters)
    added = [f"state {name}" for name in effect.states]
    added += [f"state {part.name}" for part in built if isinstance(part, base.ChamberState)]
    added += [f"state {HELD_GAS}" for part in built if isinstance(part, base.OilGas) and dissolves]
    added += [f"plenum {part.name}" for part in built if isinstance(part, base.Plenum)]
    added += [f"figure {name}" for name in given]
    added += ["a changed state of the suction gas" for part in built if isinstance(part, base.SuctionChange)]
    added += [
        "speed, motor speed and twist over the pitch, closed with the chambers"
        for part in built
        if isinstance(part, base.Shaft)
    ]
    added += ["heat to the gas" for part in built if isinstance(part, base.HeatRate)]
    added += [f"heat between gas and {part.name}" for part in built if isinstance(part, base.Wall)]
    waves = {name for part in built if isinstance(part, base.Pulsation) for name in part.harmonics}
    added += [
        f"{_words(part.entry.name)}, found with the cycle"
        for part in built
        if isinstance(part, base.Made) and part.entry.name not in waves
    ]
    added += [f"pressure of the {part.to} line over the angle" for part in built if isinstance(part, base.Pulsation)]
    added += [f"areas of {part.effect} times {_words(part.by)}" for part in built if isinstance(part, base.Scaled)]
    if added:
        yield f"adds: {', '.join(added)}"


def _words(name: str) -> str:
    return name.replace("_", " ")


def _chamber(parts: Parts, model: Composition, axis: str) -> Iterator[str]:
    geometry = parts.geometry
    states = ", ".join(f"{name} {STATE_MEANINGS.get(name, '')}".strip() for name in model.states)
    yield row("states", f"{states}; {BALANCES}")
    if geometry.chambers == 1:
        yield row("life", f"{math.degrees(geometry.life):g} deg of the crank, from top dead centre; one chamber")
        yield row("trapped mass", f"at bottom dead centre, {math.degrees(geometry.injection_angle):.6g} deg")
        return
    yield row("life", f"{math.degrees(geometry.life):g} deg of the {axis}")
    pitch = math.degrees(geometry.pitch)
    yield row("alive at once", f"{geometry.chambers} chambers, one lobe pitch of {pitch:.6g} deg apart")
    if geometry.expands:
        return  # its oil comes in with the gas
    port = parts.oil_port
    at = f"at {math.degrees(geometry.injection_angle):g} deg"
    yield row("injection", at if port is None else f"through a port, up to {math.degrees(port.closes):g} deg")


def _paths(parts: Parts) -> Iterator[str]:
    for name, built in parts.effects.items():
        for path in (part for part in built if isinstance(part, base.FlowPath)):
            if path.to in LINES:
                ends = f"chamber - {path.to} line"
            elif path.to in parts.plenums:
                held = parts.plenums[path.to]
                state = f"{in_bar(held.p)}, {in_celsius(held.T)}, {held.rho:.6g} kg/m³, {held.h / 1e3:.6g} kJ/kg"
                ends = f"chamber - {path.to.replace('_', ' ')} plenum ({state})"
            else:
                pitches = "lobe pitch" if path.offset == 1 else "lobe pitches"
                ends = f"chamber - chamber {path.offset} {pitches} ahead"
            law = path.flow.title or _own_law(path.flow)
            held = f", {law}" if law else ""
            held += ", opened by its valve" if path.opening is not None else ""
            yield row(name, f"{ends}, flow coefficient {path.flow_coefficient:g}{held}")
    laws = [bool(_own_law(path.flow)) for path in _flow_paths(parts)]
    if not all(laws):
        which = "other paths" if any(laws) else "every path"
        yield row(which, "nozzle flow in both directions, choking included (M12, M13)")
    if parts.geometry.chambers > 1:
        yield row("ahead of the last", "chamber lies the discharge line; behind the first one there is no gap")


def _flow_paths(parts: Parts) -> Iterator[base.FlowPath]:
    return (part for built in parts.effects.values() for part in built if isinstance(part, base.FlowPath))


def _own_law(flow: FlowKind) -> str:
    """Return by which kernels a kind of flow replaces the nozzle's; empty for a nozzle, or a share of its flow."""
    if isinstance(flow, Nozzle | Resistance):
        return ""
    return f"flow by {joined_names([kernel.__name__ for kernel in flow.kernels().values()] or [type(flow).__name__])}"


def _numerics(scene: Scene) -> Iterator[str]:
    numerics, wanted = scene.numerics, closing_criteria(scene.numerics, regularisation(scene))
    yield row(
        "accuracy", f"{numerics.accuracy:g} requested for the performance figures; also the bound of the balances"
    )
    origin = "given" if numerics.rtol is not None else "from the accuracy"
    histories = f", of histories {wanted.histories_factor * wanted.rtol:.3g}" if wanted.histories_factor < 1.0 else ""
    yield row("integrator", f"{numerics.integrator}, rtol {wanted.rtol:.3g}{histories} ({origin})")
    yield row("closing", f"{numerics.closing}: {CLOSINGS[numerics.closing].text}")
    suction, discharge, gaps = regularisation(scene)
    text = f"pressure differences below {suction:.3g} Pa (suction port), {discharge:.3g} Pa (discharge port)"
    yield row("regularisation", f"{text}, {gaps:.3g} of the pressure (gaps) are smoothed")


def _size(model: Composition) -> Iterator[str]:
    n = len(model.states)
    yield row("one chamber", f"{n} states, {len(model.ports) + len(model.gaps)} flow paths")
    if model.made:
        beside = f"{len(model.made)} values of effects, besides the discharge line (docs/explanation/closing.md)"
        yield row("found with cycle", beside)
    yield row("coupled", f"{n} states x {model.chambers} chambers = {n * model.chambers}")
    yield row("breakpoints", f"{len(model.breakpoints)} angles of one life where a law is not smooth; steps end there")


def _sweep(scene: Scene) -> Iterator[str]:
    for dimension in dimensions(scene):
        kinds = counted(dimension.size, "value")
        if dimension.joint is None:
            words = f": {', '.join(scene.sweep[FLUID])}" if dimension.name == FLUID else ""
            yield row(f"{dimension.name}", f"{kinds}{words}") if words else f"  {dimension.name}: {kinds}"
            continue
        sample = dimension.joint.sample
        how = f"{sample.kind.replace('_', ' ')}, seed {sample.seed}" if sample else "one by one"
        yield f"  {dimension.name}: {kinds} ({how}) of"
        yield from (f"    {path}" for path in dimension.paths)
