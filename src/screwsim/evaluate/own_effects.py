"""Check what a user's own effects return: no negative area, no share beyond 0 and 1, nothing that is not a number.

The model takes an area that is not above zero for shut, so that a kernel returning NaN there would go unnoticed.
Therefore the compiled kernels of own effects are called again, with the numbers of the model, where the closed cycle
was integrated: at the ends of its steps, at the nodes of the method and of the quadrature between, and at every degree.
Where an integration stopped they are called around the state in which it did. Scenes without own effects skip this.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from screwsim.cycle.problem import Problem
from screwsim.cycle.solution import CycleSolution
from screwsim.effects.base import LINES, ChamberState, FlowPath, HeatRate, OilPort, Stops, Wall
from screwsim.model.parts import Parts
from screwsim.model.slots import LOOSE, P_PORT_WIDTH, PORT_STATE, PRESSURE, R_RATIO, S_RHO, S_T, S_T_OIL, S_X_OIL
from screwsim.model.trajectory import Trajectory
from screwsim.model.within import NODES as GAUSS
from screwsim.numerics.rodas import NODES, dense_value
from screwsim.outputs.customary import in_bar, in_celsius

Array = np.ndarray
SHARES = sorted({*NODES[:4], GAUSS[1]})  # nodes of a step; the quadrature's first is close to a node of the method
ROUNDING = 1e-9  # of its largest value, tolerated below zero; of 1, tolerated for a share beyond its ends
SPEEDS = (0.0, 1.0, 30.0, 300.0)  # [m/s] at which the share of a gap is checked
BEYOND = np.radians((0.0, 1e-6, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0))  # [rad] after the angle where an integration stopped
AROUND = (1.0, 0.999, 1.001, 0.99, 1.01, 0.9, 1.1)  # factors on the temperature there


class ChamberPoint(NamedTuple):
    """A chamber at an angle [rad]: its states, pressure [Pa], volume [m³] and gas mass [kg]."""

    phi: float
    y: Array
    p: float
    V: float
    m: float


class KernelCheck(NamedTuple):
    """A kernel of an own effect: its value at a point, and the least and the largest value that is possible."""

    effect: str
    what: str
    unit: str
    at: Callable[[ChamberPoint], float]
    least: float = -math.inf
    most: float = math.inf


def impossible(problem: Problem, cycle: CycleSolution) -> str:
    """Return which own effect returned something impossible, and where; empty where none did."""
    scene, parts, life = problem.scene, problem.parts, cycle.trajectory
    own = {name for name in scene.effects if "." in name}
    if scene.machine.kind in scene.own:
        own |= {name for name, path in parts.all(FlowPath) if path.port}  # their areas are those of an own machine
    if not own:
        return ""
    wrong = next(_declared(parts, own), "")
    if wrong:
        return wrong
    phi, rows = _states_along(life) if not cycle.failed else (np.empty(0), np.empty((0, 1)))
    degrees = np.radians(np.arange(0.0, math.degrees(parts.geometry.life), 1.0))
    wrong = next(_areas(parts, life, own, np.union1d(phi, degrees)), "")
    if wrong:
        return wrong
    stopped = cycle.failed  # NaN would not have closed: check a closed cycle for signs and shares only
    rates = [asked for asked in _rates(parts, life) if asked.effect in own and (stopped or asked.least > -math.inf)]
    if not rates:
        return ""
    points = list(_points(parts, life, phi, rows)), *(_points_at_stop(parts, cycle) if stopped else ())
    return next(filter(None, (_first_message(asked, some) for some in points for asked in rates)), "")


def _first_message(asked: KernelCheck, points: Sequence[ChamberPoint]) -> str:
    """Return a message on the first point at which a kernel returns something impossible; empty where none does."""
    values = [asked.at(point) for point in points]
    finite = [abs(value) for value in values if math.isfinite(value)]
    slack = ROUNDING * max(finite, default=0.0)
    for point, value in zip(points, values, strict=True):
        if not (math.isfinite(value) and asked.least - slack <= value <= asked.most + slack):
            return _message(asked.effect, asked.what, asked.unit, point, value)
    return ""


def _message(effect: str, what: str, unit: str, point: ChamberPoint, value: float) -> str:
    states = f", T = {in_celsius(point.y[S_T])}, p = {in_bar(point.p)}" if point.m else ""
    shown = f"{value:.6g} {unit}".rstrip()
    where = f"at {math.degrees(point.phi):.2f} deg{states}"
    return f"effects.{effect}: its {what} is {shown} {where}, which is impossible; fix that module"


def _declared(parts: Parts, own: set[str]) -> Iterator[str]:
    """Yield messages on impossible numbers that own effects declare."""
    for name, path in parts.all(FlowPath):
        if name not in own:
            continue
        numbers = {"flow_coefficient": path.flow_coefficient, **path.values}
        for what, value in numbers.items():
            if not math.isfinite(value) or (what == "flow_coefficient" and value < 0.0):
                yield f"effects.{name}: its {what} is {value:.6g}, which is impossible; fix that module"
        breakpoints = [at for at in (*path.breakpoints, *path.own_breakpoints) if not math.isfinite(at)]
        if breakpoints:
            yield f"effects.{name}: its breakpoint at {breakpoints[0]:.6g} rad is impossible; fix that module"


def _states_along(life: Trajectory) -> tuple[Array, Array]:
    """Return angles [rad] of the last cycle, and the states and pressure there, a row each."""
    times, dense, steps = life.rows
    curves = [dense[:steps, k, : len(life.composition.states) + 1] for k in range(4)]
    phis = [times[:steps] + share * np.diff(times[: steps + 1]) for share in SHARES]
    return np.concatenate(phis), np.concatenate([dense_value(share, *curves) for share in SHARES])


def _points(parts: Parts, life: Trajectory, phi: Array, rows: Array) -> Iterator[ChamberPoint]:
    """Yield the points of a cycle at angles, with states and pressure from the rows, in the order of the angles."""
    order = np.argsort(phi, kind="stable")
    y = np.ascontiguousarray(rows[order, :-1])
    for angle, state, p in zip(phi[order].tolist(), y, rows[order, -1].tolist(), strict=True):
        yield _point(parts, life, angle, state, p)


def _points_at_stop(parts: Parts, cycle: CycleSolution) -> tuple[list[ChamberPoint], list[ChamberPoint]]:
    """Return points at, and around, the states of the chambers where an integration stopped."""
    geometry, n = parts.geometry, len(cycle.trajectory.composition.states)
    here, around = [], []
    for j, y in enumerate(np.asarray(cycle.y).reshape(-1, n)):
        if not np.all(np.isfinite(y)):
            continue
        for factor in AROUND:
            for more in BEYOND:
                phi = min(cycle.angle + j * geometry.pitch + float(more), geometry.life)
                state = np.array(y)
                state[S_T] *= factor
                (here if factor == 1.0 else around).append(_point(parts, cycle.trajectory, phi, state))
    return here, around


def _point(parts: Parts, life: Trajectory, phi: float, y: Array, p: float | None = None) -> ChamberPoint:
    """Return the point of a chamber at an angle [rad] with states y; its pressure [Pa] is computed if not given."""
    c, module = life.composition, life.module
    V, rho = module.volume_at(phi, c.P, c.TAB), float(y[S_RHO])
    if p is None:
        p = float(module.gas_state(float(y[S_T]), rho, c.P, c.TAB)[0])
    return ChamberPoint(phi, y, p, V, rho * V / parts.volume_over_gas(rho, float(y[S_X_OIL]) if c.carried else 0.0))


def _areas(parts: Parts, life: Trajectory, own: set[str], angles: Array) -> Iterator[str]:
    """Yield messages on impossible areas of paths, which depend on the angle [rad] alone; one for each path."""
    c, found = life.composition, np.empty(len(angles))
    for i, (name, path) in enumerate([*parts.ports, *parts.gaps]):
        if name not in own:
            continue
        life.module.trace__areas_along(angles, i, c.P, c.TAB, found)
        areas = found / (path.flow_coefficient or 1.0)
        finite = np.isfinite(areas)
        slack = ROUNDING * float(np.max(np.abs(areas), initial=0.0, where=finite))
        wrong = np.flatnonzero(~(finite & (areas >= -slack)))
        if len(wrong):
            where = ChamberPoint(float(angles[wrong[0]]), areas, 0.0, 0.0, 0.0)
            yield _message(name, "area", "m²", where, float(areas[wrong[0]]))


def _rates(parts: Parts, life: Trajectory) -> Iterator[KernelCheck]:
    """Yield the kernels of own effects that depend on the state of a chamber; each is called by its number."""
    c, R, module = life.composition, life.R, life.module
    P, TAB, ratio = c.P, c.TAB, float(R[R_RATIO])
    lines = [float(R[parts.number(line) * PORT_STATE + PRESSURE]) for line in LINES]

    def oil_of(point: ChamberPoint) -> float:
        """Return the oil per gas of a chamber."""
        if c.carried:
            return float(point.y[S_X_OIL])
        return ratio if point.phi >= parts.geometry.injection_angle else 0.0

    def around(point: ChamberPoint) -> tuple[float, ...]:
        """Return temperature, mass, pressure and density of the gas, volume and angle of a chamber."""
        return float(point.y[S_T]), point.m, point.p, float(point.y[S_RHO]), point.V, point.phi

    def heat(i: int, point: ChamberPoint) -> float:
        oil = float(point.y[S_T_OIL]), oil_of(point) * point.m
        return float(module.heat_part(i, *around(point), *oil, ratio, P))

    def conductance(i: int, point: ChamberPoint) -> float:
        return float(module.wall_conductance(i, *around(point), P))

    def rate(i: int, point: ChamberPoint) -> float:
        return float(module.state_rate(i, *around(point), *lines, point.y, 0, P))

    def push(i: int, point: ChamberPoint) -> float:
        return float(module.stop_push(i, point.p, *lines, point.y, 0, P))

    def inflow(i: int, point: ChamberPoint) -> float:
        return float(module.oil_inflow(point.phi, point.p, P, TAB))

    asked = (
        (HeatRate, "heat rate", "W", heat, -math.inf),
        (Wall, "conductance", "W/K", conductance, 0.0),
        (ChamberState, "rate of {}", "1/s", rate, -math.inf),
        (Stops, "push", "", push, -math.inf),
        (OilPort, "oil flow", "kg/s", inflow, 0.0),
    )
    for kind, what, unit, at, least in asked:
        for i, (name, part) in enumerate(parts.all(kind)):
            yield KernelCheck(name, what.format(getattr(part, "name", "")), unit, partial(at, i), least)
    yield from _shares(parts, life, oil_of)


def _shares(parts: Parts, life: Trajectory, oil_of: Callable[[ChamberPoint], float]) -> Iterator[KernelCheck]:
    """Yield the kernels of the shares of valves, and those of kinds of flow that have bounds."""
    module, R, P = life.module, life.R, life.composition.P

    def opening(i: int, point: ChamberPoint) -> float:
        number = parts.number(parts.ports[i][1].to)
        drop = float(R[number * PORT_STATE + PRESSURE]) - point.p
        return float(module.path_opening(i, drop, float(P[P_PORT_WIDTH + number]), LOOSE, point.y, 0, P))

    def farthest(path: FlowPath, role: str, i: int, point: ChamberPoint) -> float:
        """Return the value of a kind of flow's kernel that is nearest to a bound, or beyond it, over several speeds."""
        arguments, bounds, rho = path.flow.roles[role], path.flow.bounds[role], float(point.y[S_RHO])
        known, call = {"density": rho, "oil_ratio": oil_of(point), "drop": point.p}, getattr(module, path.checked(role))
        found = []
        for speed in SPEEDS if "flux" in arguments else SPEEDS[:1]:
            known["flux"] = rho * speed
            found.append(float(call(i, *(known[name] for name in arguments), P)))
        return max(found, key=lambda at: max(bounds.least - at, at - bounds.most) if math.isfinite(at) else math.inf)

    for i, (name, path) in enumerate(parts.ports):
        if path.opening is not None:
            yield KernelCheck(name, "opening", "", partial(opening, i), 0.0, 1.0)
    for paths in (parts.ports, parts.gaps):
        for i, (name, path) in enumerate(paths):
            kernels = path.flow.kernels()
            for role, (what, unit, least, most) in path.flow.bounds.items():
                if role in kernels:
                    yield KernelCheck(name, what, unit, partial(farthest, path, role, i), least, most)
