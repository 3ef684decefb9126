"""The group of an optimisation's results: objectives at each evaluation, and which evaluations are best."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from screwsim.outputs import Variable
from screwsim.results.netcdf import Layout, number_attributes, set_attributes

EVALUATION, POINT = "evaluation", "point"  # names of dimensions
AIM, ERROR, EXCESS = "aim_", "error_", "excess_"  # prefixes of names
EXCESS_MEANING = "by how much {} exceeds its bound; negative inside"
FLAGS = {
    "feasible": "1: it has results and satisfies all bounds",
    "front": "1: feasible, and no other is better in all aims",
}


@dataclass(frozen=True)
class EvaluationColumns:
    """Columns over the evaluations, by figure: objectives, their errors, excess over bounds; the question as text."""

    aims: Mapping[str, np.ndarray]
    errors: Mapping[str, np.ndarray]
    excess: Mapping[str, np.ndarray]
    feasible: np.ndarray
    front: np.ndarray  # 1: no other is better in all objectives
    units: Mapping[str, str]
    minimum: Sequence[str]  # objectives to be minimised
    question: str  # JSON


def write_optimum(layout: Layout, found: EvaluationColumns) -> None:
    """Write the group `optimum`."""
    group, count = layout.group("optimum"), len(found.feasible)
    about = {"units": "1", "long_name": "number of the evaluation, from 0", "path": EVALUATION}
    layout.coordinate(group, EVALUATION, np.arange(count, dtype=np.int32), about)
    set_attributes(group, {"question": found.question})
    for name, values in found.aims.items():
        sense = "lowest" if name in found.minimum else "highest"
        told = Variable(found.units[name], f"{name.replace('_', ' ')} over the operating points, to be {sense}")
        layout.variable(group, AIM + name, values, (EVALUATION,), number_attributes(told) | {"sense": sense})
        told = Variable(found.units[name], f"estimated numerical error of {name.replace('_', ' ')}, absolute")
        layout.variable(group, ERROR + name, found.errors[name], (EVALUATION,), number_attributes(told))
    for name, values in found.excess.items():
        told = Variable(found.units[name], EXCESS_MEANING.format(name))
        layout.variable(group, EXCESS + name, values, (EVALUATION,), number_attributes(told))
    for name, values in (("feasible", found.feasible), ("front", found.front)):
        about = {"units": "1", "long_name": FLAGS[name]}
        layout.variable(group, name, values.astype(np.int8), (EVALUATION,), about)
