"""Traces over the angle of a closed cycle, read from its history."""

import math

import numpy as np

from screwsim.effects.base import LINES, Reading
from screwsim.evaluate.evaluation import Evaluation
from screwsim.model.slots import R_RATIO
from screwsim.model.speed import slowness
from screwsim.model.trace import SAMPLED

TRACE_STEP = 1.0  # degree


def traces(of: Evaluation) -> dict[str, np.ndarray]:
    """Return the traces of a closed cycle (contract: cycle)."""
    life, c, parts = of.life, of.life.composition, of.problem.parts
    geometry = parts.geometry
    degrees = trace_angles(geometry.life)
    out, flows = life.sample(np.minimum(np.radians(degrees), geometry.life))
    seen, states = dict(zip(SAMPLED, out.T, strict=False)), dict(zip(c.states, out.T[len(SAMPLED) :], strict=True))
    found = {"angle": degrees, **{name: seen[name] for name in ("volume", "pressure", "work")}}
    found |= {"gas_temperature": states["T"], "gas_mass": states["rho"] * seen["volume"]}
    if c.oil_room and parts.oil is not None:
        found["gas_mass"] /= 1.0 + states["x_oil"] * states["rho"] / parts.oil.density
    if "T_oil" in c.states:
        present = c.carried | (degrees >= math.degrees(geometry.injection_angle))
        found["oil_temperature"] = np.where(present, states["T_oil"], np.nan)
        ratio = states["x_oil"] if c.carried else np.where(present, float(life.R[R_RATIO]), 0.0)
        found["oil_mass"] = ratio * found["gas_mass"]
    if parts.dissolves:
        found["dissolved_gas_ratio"] = states["w_gas"]
    found |= {name: states[name] for name in c.own_states}
    to_lines = [i for i, (_, path) in enumerate(parts.ports) if path.to in LINES and not path.narrow]
    _smooth_plenum_flows(flows, to_lines, parts.omega * seen["mass_rate"])
    films = life.oil_films(np.minimum(np.radians(degrees), geometry.life)) if any(parts.films) else np.empty((0, 0))
    if c.speed_curve is not None:  # the model's flows refer to the mean speed
        slow = np.array([slowness(phi, geometry.pitch, c.speed_curve, c.P) for phi in np.radians(degrees).tolist()])
        flows /= slow[:, None]
        if any(parts.films):
            films /= slow[:, None]
    for i, name in enumerate(c.plenum_paths):
        found[f"mass_flow_{name}"] = found.get(f"mass_flow_{name}", 0.0) + flows[:, i]
    for i, (name, _) in enumerate(c.gap_paths):
        for side, word in enumerate(("leading", "trailing")):
            key, column = f"mass_flow_{name}_{word}", len(c.plenum_paths) + 2 * i + side
            found[key] = found.get(key, 0.0) + flows[:, column]
            if parts.films[i]:
                key = f"oil_flow_{name}_{word}"
                found[key] = found.get(key, 0.0) + films[:, 2 * i + side]
    known, pitch = of.known if parts.shaft is None else of.complete, math.degrees(geometry.pitch)
    for read in [part.traces for _, part in parts.all(Reading) if part.traces is not None]:
        for name, values in read(known).items():
            grid = np.linspace(0.0, pitch, len(values) + 1)
            found[name] = np.interp(degrees, grid, np.append(values, values[0]), period=pitch)
    return found


def trace_angles(life: float) -> np.ndarray:
    """Return the angles of a trace [degree]: every degree of a life [rad], and its end."""
    end = math.degrees(life)
    degrees = np.arange(0.0, end + 1e-6, TRACE_STEP)
    return degrees if end - degrees[-1] < 1e-6 else np.append(degrees, end)


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
