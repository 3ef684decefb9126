"""One cycle from a results file: its traces, the pressures of the lines, and angles to be marked."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from screwsim.outputs import Result, effect_words, words_of_effects
from screwsim.outputs.variables import FAILED, NOT_CLOSED, OK
from screwsim.report.families import efficiency_name
from screwsim.report.quantities import ANGLE, CRANK_ANGLE, DEGREE, Display, value_of
from screwsim.results import Results
from screwsim.results.warning_kinds import warning_caption, warnings_of

_SLACK = 0.1  # of the distance of two samples, for rounding of volume and ratio
_INJECTION = 360.0  # [degree] where oil is injected (docs/model.md)
_LONE = 0.03  # largest share of the angles of a spike that may exceed the axis
_ROOM = 1.25  # axis limit over the highest pressure outside spikes
_EMPTY = 0.01  # share of the largest gas mass of a life
_SIDES = ("leading", "trailing")
_LOBES = "machine.male_lobes"
_LINES = {"$p_s$": "suction", "$p_d$": "discharge"}
_SAID = {OK: "", NOT_CLOSED: "not closed", FAILED: "failed"}  # of the status, in a title


class Trace(NamedTuple):
    """Traces [SI] over the angle [degree], pressures of the lines [Pa] by symbol, marked angles [degree] by name."""

    title: str
    angle: np.ndarray
    values: Mapping[str, np.ndarray]
    pressures: Mapping[str, float]
    marks: Mapping[str, float]
    axis: Display = ANGLE
    male_lobes: float = np.nan


def angle_axis(results: Results) -> Display:
    """Return how the angle of a file's machine is shown."""
    return CRANK_ANGLE if np.isfinite(results.stated("machine.crank_radius")).any() else ANGLE


def chosen_trace(results: Results) -> Trace | None:
    """Return the cycle of the run, or of a sweep's case with the best efficiency; None if no cycle is stored."""
    if "angle" not in results.cycle:
        return None
    index = best_case(results)
    if index is None:
        return None
    values = {name: results.cycle[name][index] for name in results.cycle if name != "angle"}
    angle = results.cycle["angle"]
    title = case_title(results, index)
    lines = {symbol: _line_pressure(results, line, index) for symbol, line in _LINES.items()}
    pressures = {symbol: value for symbol, value in lines.items() if np.isfinite(value)}
    marks = marks_of(results, index, angle, values)
    return Trace(title, angle, values, pressures, marks, angle_axis(results), _input(results, _LOBES, index))


def trace_of(result: Result) -> Trace:
    """Return the cycle of a result in memory, with the lines' pressures that the result has, and no marks."""
    values = {name: column for name, column in result.cycle.items() if name != "angle"}
    lines = {symbol: result.performance.get(f"{line}_pressure") for symbol, line in _LINES.items()}
    pressures = {symbol: float(value) for symbol, value in lines.items() if value is not None}
    return Trace(_SAID[result.status], result.cycle["angle"], values, pressures, {})


def case_title(results: Results, index: tuple[int, ...]) -> str:
    """Return the title of a case: its values in a sweep, its status unless ok, its warnings; '' if none apply."""
    title = ", ".join(value_of(axis, i) for axis, i in zip(results.axis_list, index, strict=True))
    status = _SAID[str(np.asarray(results.status)[index])]
    best = title and (results.asked is None or results.asked.sum() > 1)
    told = (f"best case: {title}" if best else title, status, warning_caption(warnings_of(results, index)))
    return "; ".join(part for part in told if part)


def status_in_words(results: Results, index: tuple[int, ...]) -> str:
    """Return the status of a case and why, 'failed; …'; empty for one that is ok."""
    status, message = (str(np.asarray(of)[index]) for of in (results.status, results.messages))
    return "" if status == OK else f"{status}; {message}"


def best_case(results: Results) -> tuple[int, ...] | None:
    """Return the index of the case with the best efficiency among those asked for with a cycle, closed ones first."""
    there = np.isfinite(results.cycle["pressure"]).any(axis=-1)
    there = there if results.asked is None else there & results.asked
    if not there.any():
        return None
    closed = there & (np.asarray(results.status) == "ok")
    among, name = closed if closed.any() else there, efficiency_name(results)
    score = np.where(among, results.performance[name] if name else 0.0, np.nan)
    score = np.where(np.isfinite(score), score, -np.inf) if np.isfinite(score).any() else among
    return tuple(int(i) for i in np.unravel_index(np.argmax(score), results.shape))


def _line_pressure(results: Results, line: str, index: tuple[int, ...]) -> float:
    """Return the pressure of a line [Pa] as figures have it, in a package at the machine; else the stated one."""
    name = f"{line}_pressure"
    found = float(results.performance[name][index]) if name in results.performance else np.nan
    return found if np.isfinite(found) else _input(results, f"operation.{line}.pressure", index)


def _input(results: Results, path: str, index: tuple[int, ...]) -> float:
    """Return a numeric input of one case [SI]; NaN if the file has none."""
    return float(results.stated(path)[index])


def marks_of(
    results: Results, index: tuple[int, ...], angle: np.ndarray, values: Mapping[str, np.ndarray]
) -> dict[str, float]:
    """Return the angles of injection and of the port's opening, if the scene has them; none for an expander."""
    marks: dict[str, float] = {}
    if "output_power" in results.performance and np.isfinite(results.performance["output_power"][index]):
        return marks
    if np.isfinite(_input(results, "oil_supply.temperature", index)):
        marks["oil injection"] = _injection(results, index, angle, values)
    opens = _input(results, "machine.discharge_port.opens", index) * DEGREE
    flow = np.abs(values.get("mass_flow_discharge_port", np.zeros_like(angle)))
    if not np.isfinite(opens) and flow.any():  # rotors, or a tabulated port: at its first flow
        opens = _first_flow(results, index, angle, flow, values)
    if np.isfinite(opens) and flow.any():
        marks["port opens"] = opens
    return dict(sorted(marks.items(), key=lambda mark: mark[1]))


def _first_flow(
    results: Results, index: tuple[int, ...], angle: np.ndarray, flow: np.ndarray, values: Mapping[str, np.ndarray]
) -> float:
    """Return the angle [degree] of the first flow through the discharge port.

    Between the samples around it, this is where the chamber has the volume of the built-in volume ratio, if it does.
    """
    first = int(np.argmax(flow > 0.0))
    before = max(first - 1, 0)
    if "volume" in values and "built_in_volume_ratio" in results.performance and before < first:
        V = values["volume"]
        share = (V[before] - np.max(V) / results.performance["built_in_volume_ratio"][index]) / (V[before] - V[first])
        if -_SLACK <= share <= 1.0 + _SLACK:
            return float(angle[before] + min(max(share, 0.0), 1.0) * (angle[first] - angle[before]))
    return float(angle[before])


def _injection(results: Results, index: tuple[int, ...], angle: np.ndarray, values: Mapping[str, np.ndarray]) -> float:
    """Return the angle of injection [degree]: a table's own, for rotors that of the largest volume, else 360°."""
    given = _input(results, "machine.volume.injection_angle", index) * DEGREE
    if np.isfinite(given):
        return given
    profiled = np.isfinite(_input(results, "machine.profile.wrap_angle", index))
    return float(angle[int(np.argmax(values["volume"]))]) if profiled and "volume" in values else _INJECTION


def pressure_limit(trace: Trace) -> tuple[float, float, float]:
    """Return the top of the pressure axis, the highest pressure [Pa] and its angle [degree].

    A spike over few degrees, such as that in the dead volume at the end of a life, may exceed the top.
    """
    p = trace.values["pressure"]
    place = int(np.nanargmax(p))
    peak = float(p[place])
    usual = max([float(np.nanquantile(p, 1.0 - _LONE)), *trace.pressures.values()])
    top = _ROOM * usual
    return (top if peak > 1.3 * top else 1.06 * max(peak, usual)), peak, float(trace.angle[place])


def temperature_limits(trace: Trace) -> tuple[float, float, float | None]:
    """Return the lowest and highest temperature [K] of a chamber with gas in it, and the furthest one far beyond them.

    That is one of a chamber with less than `_EMPTY` of its largest mass, at the ends of a life, where a port that opens
    empties or fills it within a few degrees; None where there is none.
    """
    m, T = trace.values["gas_mass"], trace.values["gas_temperature"]
    oil = trace.values.get("oil_temperature", np.full(len(T), np.nan))
    there = m >= _EMPTY * np.nanmax(m)
    shown = np.concatenate([T[there], oil[there]])
    low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
    room = 0.25 * (high - low)
    coldest, warmest = float(np.nanmin(T)), float(np.nanmax(T))
    furthest = coldest if low - coldest > warmest - high else warmest
    return low, high, None if low - room <= furthest <= high + room else furthest


def flow_paths(values: Mapping[str, np.ndarray]) -> dict[str, dict[str, str]]:
    """Return {path in words: {side: name of the trace}}; ports have one side, '', gaps two. Ports come first.

    Paths that have the same words, as those of two packages of one's own, have the names of their effects.
    """
    paths: dict[str, dict[str, str]] = {}
    for name in values:
        if not name.startswith("mass_flow_") or not np.isfinite(values[name]).any():
            continue
        effect = name.removeprefix("mass_flow_")
        side = next((side for side in _SIDES if effect.endswith(f"_{side}")), "")
        effect = effect.removesuffix(f"_{side}") if side else effect
        paths.setdefault(effect, {})[side] = name
    words = words_of_effects(paths)
    ordered = sorted(paths.items(), key=lambda path: (len(path[1]), effect_words(path[0]) == "discharge port"))
    return {words[effect]: sides for effect, sides in ordered}
