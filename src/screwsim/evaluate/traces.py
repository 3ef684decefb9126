"""Traces over the angle of a closed cycle, read from its history."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from screwsim.effects.base import LINES, HeatRate, Reading
from screwsim.evaluate.evaluation import Evaluation
from screwsim.model.slots import R_RATIO
from screwsim.model.speed import slowness
from screwsim.model.trace import SAMPLED

TRACE_STEP = 1.0  # [degree] between angles of a trace, which has the end of the life, too


def traces(of: Evaluation) -> dict[str, np.ndarray]:
    """Return the traces of a closed cycle (contract: cycle)."""
    life, c = of.life, of.life.composition
    end = math.degrees(of.problem.parts.geometry.life)
    degrees = np.arange(0.0, end + 1e-6, TRACE_STEP)
    degrees = degrees if end - degrees[-1] < 1e-6 else np.append(degrees, end)
    angles = np.minimum(np.radians(degrees), of.problem.parts.geometry.life)
    out, flows = life.sample(angles)
    seen, states = dict(zip(SAMPLED, out.T, strict=False)), dict(zip(c.states, out.T[len(SAMPLED) :], strict=True))
    found = {"angle": degrees, **{name: seen[name] for name in ("volume", "pressure", "work")}}
    found |= _contents(of, degrees, seen["volume"], states)
    found |= {name: states[name] for name in c.own_states}
    for name, flow in _flows(of, degrees, angles, flows, seen["mass_rate"]):
        found[name] = found.get(name, 0.0) + flow
    found |= _heats(of, angles, found | states)
    return found | _traces_of_effects(of, degrees)


def _heats(of: Evaluation, angles: np.ndarray, seen: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the heat [W] that each effect brings from the oil to the gas of a chamber, from what is `seen` there."""
    parts, module, found = of.problem.parts, of.life.module, dict[str, np.ndarray]()
    rates = [name for name, _ in parts.all(HeatRate)]
    if not rates:
        return found
    ratio, P = float(of.life.R[R_RATIO]), of.life.composition.P
    names = ("T", "gas_mass", "pressure", "rho", "volume", "T_oil", "oil_mass")
    held, heat = np.column_stack([seen[name] for name in names]), np.empty(len(angles))
    for i, name in enumerate(rates):
        module.trace__heats_along(i, angles, held, ratio, P, heat)
        found[f"heat_{name}"] = found.get(f"heat_{name}", 0.0) + heat
    return found


def _contents(
    of: Evaluation, degrees: np.ndarray, volume: np.ndarray, states: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return temperatures and masses of what a chamber holds: gas, oil, and gas dissolved in the oil."""
    life, c, parts = of.life, of.life.composition, of.problem.parts
    mass = states["rho"] * volume / parts.volume_over_gas(states["rho"], states.get("x_oil", 0.0))
    found = {"gas_temperature": states["T"], "gas_mass": mass}
    if "T_oil" in c.states:
        present = c.carried | (degrees >= math.degrees(parts.geometry.injection_angle))
        ratio = states["x_oil"] if c.carried else np.where(present, float(life.R[R_RATIO]), 0.0)
        found["oil_temperature"] = np.where(present, states["T_oil"], np.nan)
        found["oil_mass"] = ratio * found["gas_mass"]
    return found | ({"dissolved_gas_ratio": states["w_gas"]} if parts.dissolves else {})


def _flows(
    of: Evaluation, degrees: np.ndarray, angles: np.ndarray, flows: np.ndarray, mass_rate: np.ndarray
) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the flows through ports and gaps with their names, several of which may be the same."""
    life, c, parts = of.life, of.life.composition, of.problem.parts
    to_lines = [i for i, (_, path) in enumerate(parts.ports) if path.to in LINES and not path.narrow]
    _smooth_plenum_flows(flows, to_lines, parts.omega * mass_rate)
    films = life.oil_films(angles) if any(parts.films) else np.empty((len(degrees), 0))
    if c.speed_curve is not None:  # the model's flows refer to the mean speed
        pitch = parts.geometry.pitch
        slow = np.array([slowness(phi, pitch, c.speed_curve, c.P) for phi in np.radians(degrees).tolist()])
        flows /= slow[:, None]
        films /= slow[:, None]
    oily, column = iter(parts.films), 2 * len(c.gaps)
    for i, name in enumerate(c.ports):
        yield f"mass_flow_{name}", flows[:, i]
        if next(oily):
            yield f"oil_flow_{name}", films[:, column]
            column += 1
    for i, ((name, _), oil) in enumerate(zip(c.gaps, oily, strict=True)):
        for side, word in enumerate(("leading", "trailing")):
            yield f"mass_flow_{name}_{word}", flows[:, c.flow_through(i, side)]
            if oil:
                yield f"oil_flow_{name}_{word}", films[:, 2 * i + side]


def _traces_of_effects(of: Evaluation, degrees: np.ndarray) -> dict[str, np.ndarray]:
    """Return the traces that effects read of one pitch, over all angles."""
    parts, known = of.problem.parts, of.complete
    pitch, found = math.degrees(parts.geometry.pitch), {}
    for read in [part.traces for _, part in parts.all(Reading) if part.traces is not None]:
        for name, values in read(known).items():
            grid = np.linspace(0.0, pitch, len(values) + 1)
            found[name] = np.interp(degrees, grid, np.append(values, values[0]), period=pitch)
    return found


def _smooth_plenum_flows(flows: np.ndarray, to_lines: list[int], mass_rate: np.ndarray) -> None:
    """Where a single port to a line is open, take its flow from the mass balance [in place].

    Between steps the tiny Δp of a wide port carries the whole error of the interpolated pressure; dm/dφ does not.
    """
    open_ports = np.abs(flows[:, to_lines]) > 0.0
    alone = np.count_nonzero(open_ports, axis=1) == 1
    others = np.delete(flows, to_lines, axis=1).sum(axis=1)
    for column, i in enumerate(to_lines):
        mine = alone & open_ports[:, column]
        flows[mine, i] = mass_rate[mine] - others[mine]
