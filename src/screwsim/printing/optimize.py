"""Output of `screwsim optimize`."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from screwsim.figures import declared
from screwsim.figures.engineering import difference_unit, error_text, figure_text, shown_name
from screwsim.outputs.display import picked
from screwsim.printing.tables import column_heads, print_scene_title, print_table, print_text, print_wrapped
from screwsim.printing.uncertain import by_inputs_line
from screwsim.results.warning_kinds import kinds_of
from screwsim.screen import say
from screwsim.study.asked.inputs import shown_number, shown_range, shown_value
from screwsim.study.asked.spans import BORDER_MARKS, border_note, idle_note
from screwsim.study.optimize import EquallyGoodRange, Optimum
from screwsim.study.seek import VALUE_DIGITS

MOST_FRONT_ROWS = 12  # most rows of a front printed; all are in the file
MOST_REASONS = 3  # most reasons for failed evaluations
POINT = ("name", "weight", "load", "values")  # of an operating point in the document
# for operating points, beside objectives
OTHER_FIGURES = (
    *("free_air_delivered", "package_specific_power"),
    *("cooling_capacity", "shaft_power", "cop", "discharge_temperature"),
)
OF_HEATING = {"cooling_capacity": "heating_capacity", "cop": "heating_cop"}


def optimize_document(found: Optimum) -> dict[str, Any]:
    """Return what `optimize --json` prints: the question, the best or the front, counts; in SI units."""
    asked = found.asked
    names = [aim.figure for aim in asked.aims]
    return {
        "title": asked.scene.title,
        **picked(found, "status", "message"),
        "vary": {span.path: [span.low, span.high] for span in asked.spans},
        "maximize": [aim.figure for aim in asked.aims if not aim.minimum],
        "minimize": [aim.figure for aim in asked.aims if aim.minimum],
        "subject_to": [bound._asdict() for bound in asked.bounds],
        "over": None if asked.points.single else asked.points.name,
        "operating_points": [] if asked.points.single else [picked(each, *POINT) for each in asked.points.points],
        "mapping": list(asked.points.told),
        "front": [
            {
                "evaluation": int(row),
                "values": found.values_at(row),
                "aims": dict(zip(names, found.aims[row].tolist(), strict=True)),
                "errors": dict(zip(names, found.errors[row].tolist(), strict=True)),
                "excess": found.excess[row].tolist(),
                "warnings": list(found.warnings.get(int(row), ())),
            }
            for row in found.front
        ],
        "as_good": {path: reach.__dict__ for path, reach in found.reach.items()},
        "uncertainties_by_inputs": {name: spread.as_json() for name, spread in found.by_inputs.items()},
        "other_optima": [list(other) for other in found.others],
        "best_points": [
            {"name": point.point.name, "values": point.values, "performance": dict(point.result.performance)}
            for point in found.points
        ],
        "evaluations": len(found.places),
        "cut_short": found.cut_short,
        **picked(found, failed_evaluations="failed", outside_bounds="outside", reasons="reasons", reused="reused"),
        "seed": asked.seed,
    }


def print_optimize(found: Optimum, changed: Sequence[str] = ()) -> None:
    """Print the question, the best or the front, remarks, and the counts."""
    asked = found.asked
    print_scene_title(asked.scene.title, changed)
    senses = (f"{'lowest' if aim.minimum else 'highest'} {shown_name(aim.figure)}" for aim in asked.aims)
    over = "" if asked.points.single else f" over {asked.points.name}"
    shown = (f"{span.path} {shown_range(asked.scene, span.path, span.low, span.high)}" for span in asked.spans)
    ranges = ", ".join(shown)
    print_text(f"{' and '.join(senses)}{over}, varying {ranges}" if ranges else f"the scene itself{over}")
    for bound in asked.bounds:
        print_text(f"subject to {shown_name(bound.figure)} {bound.sign} {figure_text(bound.figure, bound.value)}")
    print_wrapped(asked.points.told)
    say()
    if found.status != "ok":
        print_text(found.message)
    elif len(asked.aims) == 1:
        _print_best(found)
    else:
        _print_front(found)
    for count, text in kinds_of(found.warnings.values()):
        of_front = "" if len(found.front) == 1 else f" in {count} of the {len(found.front)}"
        print_text(f"warning{of_front}: {text}")
    if asked.spans:
        say()
        print_wrapped(_counts(found))


def _print_best(found: Optimum) -> None:
    """Print the best values with ranges of equally good ones, the objective and its error, and the operating points."""
    asked, row, aim = found.asked, int(found.front[0]), found.asked.aims[0]
    rows = []
    for path, value in found.values.items():
        reach = found.reach[path]
        mark = BORDER_MARKS[reach.border]
        rows.append([path, shown_value(asked.scene, path, value, VALUE_DIGITS) + mark, _reach(found, path, reach)])
    if rows:
        print_table(["", "best", "as good"], rows, 1)
        say()
    value, error = found.aims[row, 0], found.errors[row, 0]
    say(f"{shown_name(aim.figure)} {figure_text(aim.figure, value)}, error {error_text(aim.figure, value, error)}")
    print_wrapped(_by_inputs(found))
    for name in getattr(asked.scene, "beside", ()):
        value = found.points[0].result.performance.get(name)
        if value is not None:
            say(f"{shown_name(name)} {figure_text(name, value)}")
    if not asked.points.single:
        say()
        _print_points(found)
    for path, reach in found.reach.items():
        if reach.border:
            print_text(f"{path}: {border_note(path, reach.border, reach.beyond)}")
        elif reach.beyond:
            print_text(f"{path}: at the edge of the values that have a solution: {reach.beyond}")
        if reach.idle:
            print_text(idle_note(path))
    for place, height in found.others:
        where = shown_value(asked.scene, asked.spans[0].path, place, 4)
        print_text(f"another local optimum at {where}: {figure_text(aim.figure, height)}")


def _by_inputs(found: Optimum) -> Iterator[str]:
    """Yield how far the inputs' tolerances move the aim and bounded figures of the best, and what has no part in it."""
    for name, spread in found.by_inputs.items():
        value = found.points[0].result.performance[name]
        factor, unit = difference_unit(declared(name), value)
        if name != found.asked.aims[0].figure:
            yield f"{shown_name(name)} {figure_text(name, value)}"
        if spread.standard:
            yield by_inputs_line(f"{factor * spread.expanded:.2g} {unit}".strip(), spread)
    if found.message:
        yield found.message


def _reach(found: Optimum, path: str, reach: EquallyGoodRange) -> str:
    if reach.low == reach.high:
        return "no other"
    low, high = (shown_number(found.asked.scene, path, end, 5) for end in (reach.low, reach.high))
    return f"{low} … {high}"


def _print_points(found: Optimum) -> None:
    """Print a table of the operating points at the best evaluation."""
    asked, points = found.asked, found.asked.points
    sought = [aim.figure for aim in asked.aims]
    others = [OF_HEATING.get(name, name) for name in OTHER_FIGURES] if points.heating else OTHER_FIGURES
    names = list(dict.fromkeys((*sought, *(bound.figure for bound in asked.bounds), *others)))
    there = [name for name in names if all(point.result.performance.get(name) is not None for point in found.points)]
    weight = "energy share" if points.energy else "weight"
    paths = list(dict.fromkeys(path for point in found.points for path in point.values))
    heads = ["point", weight, *column_heads(paths)]
    rows = []
    total = sum(point.weight for point in points.points)
    for each in found.points:
        cells = [each.point.name, f"{each.point.weight / total:.3g}"]
        cells += [shown_value(asked.scene, path, each.values[path]) if path in each.values else "" for path in paths]
        rows.append([*cells, *(figure_text(name, each.result.performance[name]) for name in there)])
    print_table([*heads, *(shown_name(name) for name in there)], rows, 1)


def _print_front(found: Optimum) -> None:
    """Print some rows of the front, evenly spread along it and including both ends."""
    asked, front = found.asked, found.front
    picked = evenly_spread(found.aims[front], MOST_FRONT_ROWS)
    heads = [*(shown_name(aim.figure) for aim in asked.aims), "error"]
    heads += [*column_heads([span.path for span in asked.spans]), "evaluation"]
    print_table(heads, [_front_cells(found, int(front[i])) for i in picked])
    some = f"{len(picked)} of the {len(front)}" if len(picked) < len(front) else f"the {len(front)}"
    many = "s" if len(front) > 1 else ""
    error = "error: relative, the largest of the aims"
    print_text(f"{some} evaluation{many} that no other beats in all aims; {error}")


def evenly_spread(aims: np.ndarray, most: int) -> np.ndarray:
    """Return the indices of at most `most` rows, evenly spread along the line through all of them."""
    if len(aims) <= most:
        return np.arange(len(aims))
    width = np.ptp(aims, axis=0)
    steps = np.abs(np.diff(aims, axis=0)) / np.where(width > 0.0, width, 1.0)
    along = np.concatenate([[0.0], np.cumsum(steps.sum(axis=1))])
    return np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], most) - 1e-12 * along[-1]))


def _front_cells(found: Optimum, row: int) -> list[str]:
    asked = found.asked
    aims, errors = found.aims[row], found.errors[row]
    largest = max(error / abs(aim) for aim, error in zip(aims, errors, strict=True) if aim)
    values = found.values_at(row)
    cells = [figure_text(aim.figure, value) for aim, value in zip(asked.aims, aims, strict=True)]
    return [*cells, f"{largest:.0e}", *(shown_value(asked.scene, path, values[path], 4) for path in values), str(row)]


def _counts(found: Optimum) -> Iterator[str]:
    words = [f"{len(found.places)} evaluations"]
    words += [f"{found.reused} of them from an earlier run"] if found.reused else []
    words += [f"{found.outside} outside the bounds"] if found.outside else []
    words += [f"{found.failed} failed"] if found.failed else []
    yield ", ".join(words) + f", seed {found.asked.seed}"
    if found.cut_short:
        yield "all evaluations were used before the search settled: more of them may find better (--evaluations)"
    shown: Sequence[tuple[str, int]] = list(found.reasons.items())[:MOST_REASONS]
    yield from (f"{count}: {reason}" for reason, count in shown)
    rest = sum(found.reasons.values()) - sum(count for _, count in shown)
    if rest:
        yield f"{rest}: other reasons"
