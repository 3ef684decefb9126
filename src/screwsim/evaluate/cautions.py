"""Warnings on a closed cycle: implausible figures, flows in unintended directions, errors larger than asked for."""

import math
from collections.abc import Iterator

import numpy as np

from screwsim.build import open_values, package_of, separator_effects
from screwsim.cycle.balances import heat_flowing_back
from screwsim.cycle.problem import LEAST_OIL, Problem
from screwsim.effects import having, stating
from screwsim.effects.base import SUCTION, CoolsOil, FlowPath, PowerLoss, Wall
from screwsim.effects.parts.coolant import AIR, DENSEST_ROOM
from screwsim.effects.parts.usual import OIL_ROOM, SUCTION_BACK
from screwsim.evaluate import humidity, late_valves, plausible
from screwsim.evaluate.evaluation import Evaluation
from screwsim.evaluate.separator import Circuit
from screwsim.figures.errors import LEAST_FILLING, worst
from screwsim.fluid.orifice import outside_fit
from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import find_machine
from screwsim.machine.protocol import CYLINDER
from screwsim.model.parts import Parts
from screwsim.model.slots import R_OIL_BEFORE
from screwsim.outputs import Figures
from screwsim.outputs.customary import celsius, in_bar
from screwsim.scene.plausible import scene_warnings
from screwsim.scene.types import FoundWithCycle, parameters_of_type

CONTRADICTS = 1.0  # [K] between a stated separator temperature and that of its balance, tolerated
OPEN_TO_SUCTION = math.radians(1.0)  # of a plenum's port before the end of suction, tolerated
HARDLY_KNOWN = 0.01  # relative error of figures over the net flow that deserves a warning
OVER_FLOW = "specific_power", "oil_flow_ratio", "economizer_flow_ratio", "liquid_injection_flow_ratio"
MOST_OIL = 1 / 3  # of a chamber: neglected, it costs some 5 % of the power, 30 % of the peak pressure (test_oil_volume)
LEFT_BEHIND, RECOMPRESSED = 0.01, 2.0  # gas left where a chamber vanishes, over the charge, and its pressure over p_d
LOST, LOST_DRY = 0.02, 0.05  # of the shaft power: heat to suction, or from outside, that deserves a warning


def warnings(of: Evaluation) -> Iterator[str]:
    """Yield warnings on oil, effects and flow."""
    for caution in CAUTIONS:
        yield from caution(of)


def _more_oil_than_asked(of: Evaluation) -> Iterator[str]:
    """Yield a warning where leaks bring more oil than a pump is to, so that it injects none."""
    parts, supply, ratio = of.problem.parts, of.problem.scene.oil_supply, of.figures.get("oil_ratio")
    if supply is None or not supply.pumped or parts.oil_port is not None or parts.geometry.expands:
        return  # an expander's oil comes in with the gas
    if ratio and ratio > (supply.ratio or 0) * (1 + 1e-9) + LEAST_OIL:
        yield (
            f"leaks already bring more oil ({of.life.R[R_OIL_BEFORE]:.3g} kg) into the chamber than oil_supply.ratio "
            f"asks for; no oil is injected, and the ratio is {ratio:.4g}"
        )


def _open_values(of: Evaluation) -> Iterator[str]:
    """Yield the warnings of open numbers at an end of their range."""
    yield from open_values.warnings(of.problem.scene, of.figures)


def _of_effects(of: Evaluation) -> Iterator[str]:
    """Yield the effects' own warnings on the figures."""
    for active in of.problem.scene.effects.values():
        yield from active.effect.warnings(of.figures) if active.effect.warnings else ()


def _sucks(parts: Parts) -> bool:
    """Return whether the chambers have a way to the suction line; if not, the doubts about the scene say so."""
    return SUCTION in plausible.lines_met(parts)


def _nothing_delivered(of: Evaluation) -> Iterator[str]:
    """Yield a warning where no net gas is delivered, with a valve that stays shut or without."""
    parts, flow = of.problem.parts, of.figures["gas_mass_flow"]
    idle = [part.idle for part in parts.pulsations if part.shut is not None]
    if flow == 0.0 and idle:
        nothing = "takes in nothing" if parts.plenums else "delivers nothing"
        yield idle[0].format(nothing=nothing) or f"a valve stays shut: the machine {nothing}"
    elif flow is not None and flow <= 0.0 and _sucks(parts):
        yield (
            "no net gas is delivered; gas that flows in from the discharge line, beyond what flowed out, is taken at "
            "operation.discharge.temperature, or if that is not given at the temperature of isentropic compression"
        )


def _little_flow(of: Evaluation) -> Iterator[str]:
    """Yield the warning of `little_flow`."""
    yield from little_flow(of.problem.scene.numerics.accuracy, of.figures)


def _flows_back_through_intake(of: Evaluation) -> Iterator[str]:
    """Yield a warning where gas flows back through what changes it before the machine."""
    flow = of.figures["gas_mass_flow"]
    if flow is not None and flow < 0.0 and of.problem.suction.changed and _sucks(of.problem.parts):
        yield (
            "gas flows back to the suction line, but throttle, filter and bypass before the machine are modelled for "
            "inflow only (choose smaller leaks or a higher speed, or leave them out)"
        )


def little_flow(accuracy: float, found: Figures) -> Iterator[str]:
    """Yield a warning where the net gas flow is so small that figures over it are hardly known (M41)."""
    filling = found.get("volumetric_efficiency") or 0.0
    if filling <= 0.0:
        return
    known = accuracy * LEAST_FILLING / filling
    if known > HARDLY_KNOWN:
        which = ", ".join(name for name in OVER_FLOW if found.get(name) is not None)
        within = f"to a relative error of {known:.1g} only" if known < 1.0 else "not even to its order of magnitude"
        yield (
            f"the machine delivers {filling:.2g} of its displacement: what is divided by that flow ({which}) is known "
            f"{within}, at the stated accuracy of {accuracy:g} (choose a tighter numerics.accuracy)"
        )


def _separator_warnings(of: Evaluation) -> Iterator[str]:
    """Yield warnings on the separator: an idle thermostat, a stated temperature that contradicts its balance."""
    circuit = of.circuit
    if not isinstance(circuit, Circuit):
        return
    if circuit.parted.told:
        yield circuit.parted.told
    stated = next((one.separator_temperature for one in separator_effects(of.problem.scene)), None)
    found, T = circuit.outflow, circuit.parted.T_separator
    if stated is None or isinstance(stated, FoundWithCycle) or abs(stated - T) <= CONTRADICTS:
        return
    try:
        needed = found.heat_of(stated) + found.oil_capacity * (stated - found.T_supply)
    except UsageError:  # no gas there
        return
    needed -= found.energy + found.heating + found.friction
    what = f"{1e-3 * abs(needed):.4g} kW of {'heating' if needed > 0.0 else 'cooling'}"
    yield (
        f"the separator's balance closes at {celsius(T)}, not at the stated {celsius(stated)}: it would need {what} "
        f"(name effects.{stating(CoolsOil)}, which finds the temperature)"
    )


def _oil_colder_than_room(of: Evaluation) -> Iterator[str]:
    """Yield that oil is colder than the air with which the fan of a package cools it.

    A cooler with a size bounds it, by its own coolant; a second stage, which takes no air of the room, has another.
    Beside a coolant of water the fan cools the room of the machine alone.
    """
    circuit, scene, at = of.circuit, of.problem.scene, of.problem.lines
    if not isinstance(circuit, Circuit) or at.p_s > DENSEST_ROOM:
        return
    bounded = any(one.bounded for one in parameters_of_type(scene.effects, CoolsOil).values())
    oil = circuit.outflow.T_supply
    package = package_of(scene)
    coolant = getattr(package, "coolant", None)
    by_air = getattr(package, "fan", None) is not None and (coolant is None or coolant.medium == AIR)
    if not by_air or bounded or oil >= at.T_s:
        return
    what = f"the oil is cooled to {celsius(oil)}, below the {celsius(at.T_s)} of the air with which the fan cools it"
    remedy = "state a warmer oil, or a cooler with a conductance and its coolant_temperature"
    yield f"{what} ({remedy})"


def doubts(problem: Problem, found: Figures, error: Figures) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the implausibilities of a scene and of its cycle's figures, and the figures that no machine can have."""
    scene, parts = problem.scene, problem.parts
    checked = plausible.CheckedCycle(scene, parts, problem.lines, found, error)
    of_figures = [doubt for ask in plausible.DOUBTS for doubt in ask(checked)]
    words = (*scene_warnings(scene), *plausible.blocked_paths(scene, parts), *(each.words for each in of_figures))
    return words, tuple(each.figure for each in of_figures if each.figure is not None)


def _lost_to_suction(of: Evaluation) -> Iterator[str]:
    """Yield a warning where much of the shaft power leaves to the suction line without being followed there."""
    parts, power = of.problem.parts, of.figures["shaft_power"]
    delivers = power > 0.0 and (of.figures["gas_mass_flow"] or 0.0) > 0.0
    carried = of.problem.composition.carried
    if parts.suction_line or parts.geometry.expands or not delivers or (parts.oil is not None and not carried):
        return
    what, most = ("gas", LOST_DRY) if parts.oil is None else ("gas and oil", LOST)
    heat = heat_flowing_back(of.problem, of.streams, of.problem.lines.T_s)
    if abs(heat) > most * power:
        brings, remedy = "warms" if heat > 0.0 else "cools", " or ".join(having(SUCTION_BACK))
        yield (
            f"{1e-3 * abs(heat):.3g} kW, {abs(heat) / power:.0%} of the shaft power, leaves with {what} flowing back "
            f"into the suction line, although in reality it {brings} the intake (name {remedy}, which takes that into "
            "account)"
        )


def _warmed_from_outside(of: Evaluation) -> Iterator[str]:
    """Yield a warning where walls of stated temperatures give the gas more heat than friction can bring them."""
    parts, found, power = of.problem.parts, of.figures, of.figures["shaft_power"]
    stated = [name for name, wall in parts.all(Wall) if not isinstance(wall.temperature, str)]
    heat = found.get("wall_heat")
    if not stated or heat is None or parts.geometry.expands or not power > 0.0:
        return
    friction = sum(found.get(loss.figure) or 0.0 for _, loss in parts.all(PowerLoss) if loss.friction)
    if heat - friction > LOST_DRY * power:
        what = f"the walls give the gas {1e-3 * heat:.3g} kW, more than the {1e-3 * friction:.3g} kW of friction there"
        share = f"{(heat - friction) / power:.1%} of the shaft power comes in from outside the machine"
        yield f"{what}: {share} (state colder walls in effects.{stated[0]})"


def _oil_fills_chamber(of: Evaluation) -> Iterator[str]:
    """Yield a warning where the neglected volume of a chamber's oil is much of the chamber as its discharge port opens.

    For an expander the volume is that when its inlet closes.
    """
    parts, found = of.problem.parts, of.figures
    oil, geometry = parts.oil, parts.geometry
    opens = geometry.discharge_opens
    if oil is None or opens is None or parts.oil_room:
        return
    ratio, trapped = found["oil_ratio"], found["trapped_mass"]
    if not ratio or not trapped:
        return
    share = ratio * trapped / oil.density / of.life.volume(opens)
    if not share < MOST_OIL:
        when = "inlet closes" if geometry.expands else "discharge port opens"
        what = (
            f"the oil would fill {share:.0%} of the chamber when the {when}; oil takes up no volume in this scene's "
            "model"
        )
        beside = "" if oil.carried else " with oil.transport: carried"
        yield f"{what} (name {' or '.join(having(OIL_ROOM))}{beside}, use less oil, or treat the result as a limit)"


def _unfitted_bore(of: Evaluation) -> Iterator[str]:
    """Yield a warning where the oil's bore or flow lies outside the range to which its flow formula was fitted."""
    oil, port = of.problem.parts.oil, of.problem.parts.oil_port
    if oil is None or "diameter" not in oil.supply:
        return
    bore, source = oil.supply, oil.supply["separator_pressure"]
    before = source - (0.0 if port is None else port.loss(source))
    drop = max(before - (of.figures.injection_pressure or 0.0), 0.0)
    reynolds = bore["diameter"] * math.sqrt(2.0 * drop * bore["density"]) / bore["viscosity"]
    why = outside_fit(bore["length"] / bore["diameter"], reynolds)
    if why:
        yield f"the formula for the oil flow is used outside its range: {why}"


def _open_to_suction(of: Evaluation) -> Iterator[str]:
    """Yield a warning for each plenum above the suction pressure whose port opens while the chamber sees suction."""
    parts, p_s = of.problem.parts, of.problem.lines.p_s
    if parts.geometry.expands or not parts.plenums:
        return
    what, ends, remedy = "suction", parts.geometry.injection_angle, "open it later"
    for name, path in parts.all(FlowPath):
        if path.to == SUCTION and _last_open(path) > ends + OPEN_TO_SUCTION:
            what, ends = f"the passage of effects.{name} to suction", _last_open(path)
            remedy = "open it later, or leave it out at this load"
    for name, path in parts.all(FlowPath):
        plenum = parts.plenums.get(path.to)
        if plenum is None or plenum.p <= p_s or not path.breakpoints:
            continue
        opens = min(path.breakpoints)
        if opens < ends - OPEN_TO_SUCTION:
            yield (
                f"effects.{name}: its port opens at {math.degrees(opens):.4g} deg, before {what} ends at "
                f"{math.degrees(ends):.4g} deg: what it lets in at {in_bar(plenum.p)} displaces suction gas of "
                f"{in_bar(p_s)} ({remedy})"
            )


def _left_behind(of: Evaluation) -> Iterator[str]:
    """Yield a warning where gaps hold much gas back in a chamber that vanishes, so that it is recompressed.

    A cylinder's clearance always keeps some: of it the pressure is told.
    """
    life, trapped = of.life, of.figures.get("trapped_mass")
    cylinder = CYLINDER in find_machine(of.problem.scene.machine.kind).offers
    if not trapped or not (cylinder or life.composition.gaps):
        return
    end = float(life.times[life.steps])
    density, volume, p_d = float(life.ends[1][-1]), life.volume(end), of.figures["discharge_pressure"]
    share = density * volume / trapped  # at most: oil takes some of that volume
    if share < LEFT_BEHIND:
        return
    pressure = float(life.states_at(np.array([end]))[0, -1])
    if pressure <= RECOMPRESSED * p_d:
        return
    if cylinder:
        what = f"the gas that stays in the clearance reaches {in_bar(pressure)}"
        yield f"{what}, {pressure / p_d:.3g} times the discharge pressure (choose a larger discharge valve)"
    else:
        port, then = ("outlet", "is lost") if of.problem.parts.geometry.expands else ("discharge port", "flows back")
        yield (
            f"{share:.1%} of the charge is not let out: the {port} is nearly shut while the chamber vanishes, where it "
            f"reaches {in_bar(pressure)} and {then} (choose a {port} that is wider there)"
        )


def _last_open(path: FlowPath) -> float:
    """Return the angle [rad] up to which a path is open, as its table or its breakpoints tell; 0 if it is not."""
    if path.values.get("size") == 0.0:
        return 0.0
    if not path.tables:
        return max(path.breakpoints, default=0.0)
    return max(float(np.max(angles[areas > 0.0], initial=0.0)) for angles, areas, *_ in path.tables.values())


CAUTIONS = (  # in the order in which they are told
    *(_more_oil_than_asked, _oil_fills_chamber, _unfitted_bore, _open_to_suction, _lost_to_suction),
    *(_warmed_from_outside, late_valves.warnings, _separator_warnings, humidity.warnings, _open_values, _of_effects),
    *(_oil_colder_than_room, _nothing_delivered, _little_flow, _flows_back_through_intake, _left_behind),
)


def inaccurate(wanted: float, error: Figures) -> tuple[str, ...]:
    """Return a warning where an estimated error exceeds the wanted accuracy, or none could be estimated."""
    if error and all(size is None for size in error.values()):
        return ("the errors could not be estimated: the finer solution failed",)
    name, size = worst(error)
    if size <= wanted:
        return ()
    return (f"the estimated error of {name}, {size:.2g}, is above the wanted accuracy {wanted:.2g}",)
