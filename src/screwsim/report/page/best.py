"""The page's part on an optimisation: what was sought, over which inputs, and the best evaluations."""

from typing import NamedTuple

import numpy as np

from screwsim.figures.engineering import figure_text, shown_name
from screwsim.report.front import objective_names
from screwsim.report.quantities import is_numeric, shown_axis
from screwsim.results import Results
from screwsim.results.optimum import AIM, ERROR

MOST_ROWS = 12  # of a front that are shown, evenly spread along its first objective; all are in the file


class BestTable(NamedTuple):
    """The best of an optimisation: what was sought, heads with classes and rows of a table, and a line below it."""

    sought: str
    heads: list[tuple[str, str]]
    rows: list[list[str]]
    note: str


def is_optimisation(results: Results) -> bool:
    """Tell whether the file was written by a search for an optimum."""
    return bool(objective_names(results))


def front_of(results: Results) -> np.ndarray:
    """Return the evaluations of the Pareto front, ordered by the first objective."""
    front = np.flatnonzero(results.optimum["front"] == 1)
    return front[np.argsort(results.optimum[AIM + objective_names(results)[0]][front], kind="stable")]


def best_table(results: Results) -> BestTable:
    """Return what an optimisation sought and found."""
    names, front = objective_names(results), front_of(results)
    evaluations, *points = results.axis_list
    varied = [axis for axis in evaluations.joined or (evaluations,) if is_numeric(axis)]
    spread = np.linspace(0, len(front) - 1, min(len(front), MOST_ROWS)).round().astype(int)
    shown = front[spread]
    words = [shown_axis(axis) for axis in varied]
    heads = [(head, "n") for head in (*map(shown_name, names), "error", *(how.words for how in words), "evaluation")]
    rows = [
        [
            *(figure_text(results.figure(name), float(results.optimum[AIM + name][int(row)])) for name in names),
            f"{_error(results, names, int(row)):.0e}",
            *(how.value(float(axis.values[row])).rpartition(" = ")[2] for how, axis in zip(words, varied, strict=True)),
            str(row),
        ]
        for row in shown
    ]
    some = f"{len(shown)} of the {len(front)}" if len(shown) < len(front) else f"the {len(front)}"
    many = f"{some} evaluations that no other beats in all aims; " if len(names) > 1 else ""
    over = f" over {len(points[0].values)} operating points" if points and len(points[0].values) > 1 else ""
    lowest = [results.optimum.about[AIM + name].long_name.endswith("lowest") for name in names]
    senses = zip(names, lowest, strict=True)
    wanted = " and ".join(f"{'lowest' if least else 'highest'} {shown_name(name)}" for name, least in senses)
    sought = f"Search for the {wanted}{over}, {len(evaluations.values)} evaluations"
    return BestTable(sought, heads, rows, f"{many}error: estimated numerical error of an aim, relative")


def _error(results: Results, names: list[str], row: int) -> float:
    """Return the largest relative error among the objectives of an evaluation."""
    sizes = ((results.optimum[ERROR + name][row], abs(results.optimum[AIM + name][row])) for name in names)
    return max((float(error / size) for error, size in sizes if size), default=0.0)
