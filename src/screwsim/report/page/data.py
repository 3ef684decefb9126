"""Data that the page draws, as one document: axes, figures with errors, balances, traces and ledgers of each case."""

import math
from typing import Any, NamedTuple

import numpy as np

from screwsim.figures.engineering import figure_scales, shown_name
from screwsim.outputs import LEDGER_ENTRY, LEDGER_SUMMARY, STATUSES, ledger_entries, words_of_effects
from screwsim.outputs.customary import SCALES
from screwsim.report import quantities
from screwsim.report.families import efficiency_name, family_of, is_log, outcome_family
from screwsim.report.front import front_of, objective_names
from screwsim.report.page.pack import bytes_of, floats, quantised, reduce_angles
from screwsim.report.page.uncertain import half_of, inputs_document
from screwsim.report.quantities import PRESSURE, TEMPERATURE, Display, is_numeric, shown_axis, shown_figure
from screwsim.report.trace import Trace, angle_axis, flow_paths, marks_of, pressure_limit
from screwsim.results import Results
from screwsim.results.optimum import EVALUATION, POINT
from screwsim.results.warning_kinds import cases_with_warnings
from screwsim.scene.operation import is_condition

MOST_CASES, MOST_WITH_TRACES, MOST_WITH_FLOWS = 20_000, 2_000, 400  # most cases shown; all are in the file
STATES_OFF, FLOWS_OFF = 2e-4, 2e-3  # of a trace's span: largest deviation of the page's straight segments
BALANCES = ("mass", "energy", "entropy", "oil_mass")  # those with a bound
_STATES = {
    "volume": quantities.VOLUME,
    "pressure": PRESSURE,
    "gas_temperature": TEMPERATURE,
    "oil_temperature": TEMPERATURE,
    "gas_mass": quantities.GAS_MASS,
}


class Selection(NamedTuple):
    """The cases that the page shows: every n-th value of each axis."""

    strides: tuple[int, ...]
    shape: tuple[int, ...]

    @property
    def part(self) -> tuple[slice, ...]:
        """Slices that take the shown cases from an array on the axes."""
        return tuple(slice(None, None, stride) for stride in self.strides)

    def place(self, case: int) -> tuple[int, ...]:
        """Return the place of a shown case on the axes of the results."""
        places = np.unravel_index(case, self.shape) if self.shape else ()
        return tuple(int(place) * stride for place, stride in zip(places, self.strides, strict=True))

    def of(self, values: np.ndarray) -> np.ndarray:
        """Return the shown cases (cases,), the last axis fastest."""
        return np.asarray(values)[self.part].reshape(-1)


def selection(results: Results) -> Selection:
    """Return the cases that the page shows: all, or few enough to keep it small."""
    most = MOST_WITH_TRACES if "angle" in results.cycle else MOST_CASES
    strides = [1] * len(results.shape)

    def shape() -> list[int]:
        return [-(-size // stride) for size, stride in zip(results.shape, strides, strict=True)]

    while math.prod(shape()) > most:
        strides[int(np.argmax(shape()))] += 1
    return Selection(tuple(strides), tuple(shape()))


def document(results: Results, shown: Selection) -> dict[str, Any]:
    """Return the document that the page's script reads, of JSON types only."""
    texts = shown.of(results.messages)
    balances = [name for name in (*BALANCES, "bound") if name in results.balance]
    return {
        "axes": [_axis(axis, stride) for axis, stride in zip(results.axis_list, shown.strides, strict=True)],
        "figures": _figures(results, shown),
        "status": bytes_of(shown.of(results.performance["status"])),
        "statuses": list(STATUSES),
        "messages": {str(case): str(texts[case]) for case in np.flatnonzero(texts != "").tolist()},
        "warnings": _warnings(results, shown),
        "balance": {name: floats(shown.of(results.balance[name])) for name in balances},
        "cycle": _cycle(results, shown),
        "ledger": _ledger(results, shown),
        "inputs": inputs_document(results, shown.part),
        "watts": [list(entry) for entry in SCALES["W"]],
        "start": _first_view(results, shown),
    }


def plain_label(shown: Display) -> str:
    """Return words and unit, without mathematical symbols."""
    return f"{shown.words} ({shown.unit})" if shown.unit else shown.words


def _axis(axis: Any, stride: int) -> dict[str, Any]:
    values = axis.values[::stride]
    if axis.joined:
        joined = [_axis(inner, stride) for inner in axis.joined]
        name = {EVALUATION: "evaluation", POINT: "operating point"}.get(axis.path, "case")
        return {"label": name, "words": name, "texts": [str(value) for value in values], "joined": joined}
    if not is_numeric(axis):
        words = axis.path.split(".")[-1].replace("_", " ")
        return {"label": words, "words": words, "texts": [str(value) for value in values]}
    how = shown_axis(axis)
    numbers = how.of(values)
    return {
        "label": plain_label(how),
        "words": how.words,
        "unit": how.unit,
        "values": [float(f"{number:.9g}") for number in numbers],
        "log": is_log(numbers),
        "chosen": not is_condition(axis.path),
    }


def _figures(results: Results, shown: Selection) -> list[dict[str, Any]]:
    """Return every figure that any case has: its format, its drawing, values and errors [SI]."""
    found = []
    results.error.take(results.figures)
    for name in results.figures:
        if not np.isfinite(values := shown.of(results.performance[name])).any():
            continue
        about = results.figure(name)
        how, errors = shown_figure(results, name), shown.of(results.error[name])
        found.append(
            {
                "name": name,
                "words": shown_name(name),
                "label": plain_label(how),
                "factor": how.factor,
                "offset": how.offset,
                "unit": how.unit,
                "kelvin": about.units == "K",
                "scales": [list(entry) for entry in figure_scales(about)],
                "values": floats(values),
                "errors": floats(errors) if np.isfinite(errors).any() else None,
                "halves": floats(halves) if np.isfinite(halves := shown.of(half_of(results, name))).any() else None,
            }
        )
    return found


def _warnings(results: Results, shown: Selection) -> dict[str, str]:
    """Return {number of the case: its warnings, one per line}."""
    found = np.flatnonzero(shown.of(cases_with_warnings(results)))
    numbers = shown.of(np.arange(results.status.size).reshape(results.shape))[found]
    texts = results.performance.texts_at("warnings", numbers) if found.size else []
    return {str(case): text for case, text in zip(found.tolist(), texts, strict=True)}


def _cycle(results: Results, shown: Selection) -> dict[str, Any] | None:
    """Return the traces on a reduced set of angles, with the deviation of the straight segments between these."""
    if "angle" not in results.cycle:
        return None
    angle, cases = results.cycle["angle"], max(1, math.prod(shown.shape))
    kinds = [[name for name in results.cycle if name in _STATES], []]
    if cases <= MOST_WITH_FLOWS:
        kinds[1] = [name for name in results.cycle if name.startswith("mass_flow_")]
    states, flows = (_traces_with_values(results, shown, names, cases) for names in kinds)
    lines = [shown.of(results.performance[f"{line}_pressure"]) for line in ("suction", "discharge")]
    found: list[float | None] = []
    for case, p in enumerate(states["pressure"]):
        levels = {str(i): float(line[case]) for i, line in enumerate(lines) if np.isfinite(line[case])}
        trace = Trace("", angle, {"pressure": p}, levels, {})
        found.append(round(PRESSURE.of(pressure_limit(trace)[0]), 4) if np.isfinite(p).any() else None)
    return {
        **_packed(angle, states, STATES_OFF),
        "points": int(angle.size),
        "angle_label": plain_label(angle_axis(results)),
        "flows": _packed(angle, flows, FLOWS_OFF) | {"paths": flow_paths(flows)} if flows else None,
        "marks": _all_marks(results, shown, angle, states | flows),
        "top": found,
    }


def _traces_with_values(results: Results, shown: Selection, names: list[str], cases: int) -> dict[str, np.ndarray]:
    """Return the traces (cases, points) that have any value."""
    traces = {name: results.cycle.part(name, shown.part).reshape(cases, -1) for name in names}
    return {name: trace for name, trace in traces.items() if np.isfinite(trace).any()}


def _packed(angle: np.ndarray, traces: dict[str, np.ndarray], wanted: float) -> dict[str, Any]:
    """Return traces on a reduced set of angles, with the deviation of the straight segments between these."""
    thinned = reduce_angles(angle, traces, wanted)
    displays = {name: _STATES.get(name, quantities.MASS_FLOW) for name in traces}
    return {
        "angle": floats(angle[thinned.kept]),
        "traces": {
            name: {"label": plain_label(how), "unit": how.unit} | quantised(how.of(traces[name][:, thinned.kept]))
            for name, how in displays.items()
        },
        "off": {name: how.factor * thinned.deviation[name] for name, how in displays.items()},
    }


def _all_marks(results: Results, shown: Selection, angle: np.ndarray, traces: Any) -> list[dict[str, float]]:
    """Return the marked angles [degree] by name, one mapping per case, or a single one where all agree."""
    found = []
    for case in range(math.prod(shown.shape)):
        values = {name: trace[case] for name, trace in traces.items()}
        found.append(marks_of(results, shown.place(case), angle, values))
    return found if any(marks != found[0] for marks in found) else found[:1]


def _ledger(results: Results, shown: Selection) -> dict[str, Any] | None:
    """Return the ledger of each case: totals, and what each effect destroys, generates and transfers [SI]."""
    if "shaft_power" not in results.ledger:
        return None
    entries = words_of_effects(ledger_entries(dict.fromkeys(results.ledger)))
    values = {name: floats(shown.of(results.ledger[name])) for name in results.ledger}
    return {
        "totals": {name: values[name] for name in LEDGER_SUMMARY if name in values},
        "entries": [
            {"words": words}
            | {quantity: values[f"{quantity}_{name}"] for quantity in LEDGER_ENTRY if f"{quantity}_{name}" in values}
            for name, words in entries.items()
        ],
    }


def _word_axis(results: Results) -> int | None:
    """Return the first axis of words with two values or more, over which a sweep without numeric axes is drawn."""
    words = (len(axis.values) > 1 and not axis.joined and not is_numeric(axis) for axis in results.axis_list)
    return next((place for place, several in enumerate(words) if several), None)


def _first_view(results: Results, shown: Selection) -> dict[str, Any]:
    """Return what is shown first: the best case, and its efficiency over the axes of the printed figures.

    For an optimisation it is the first objective, and its best evaluation at the first operating point.
    """
    name = efficiency_name(results)
    case = 0
    if (sought := objective_names(results)) and len(front := front_of(results)):
        name = sought[0]
        row = int(front[0]) // shown.strides[0]
        case = row * int(np.prod(shown.shape[1:], dtype=int))
    elif name is not None:
        score = shown.of(results.performance[name])
        closed = np.isfinite(score) & (shown.of(results.status) == "ok")
        case = int(np.argmax(np.where(closed, score, -np.inf))) if closed.any() else 0
    outcome = outcome_family(results)
    family = outcome or family_of(results)
    return {
        "case": case,
        "figure": name,
        "x": "oil_ratio" if outcome else family.x if family else _word_axis(results),
        "curves": family.by if family else None,
    }
