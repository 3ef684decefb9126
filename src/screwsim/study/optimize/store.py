"""An optimisation on disk: all its cases in the form of a sweep's results, and the aims over the evaluations.

That of two stages is a table with a row for each evaluation, with the figures of both stages together.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.figures import declared
from screwsim.inputs.faults import UsageError
from screwsim.inputs.workbooks import TABLES
from screwsim.outputs import STATUSES, names_of
from screwsim.results.atomic import has_content
from screwsim.results.identity import differences, installed_version, unpacked
from screwsim.results.optimum import EVALUATION, EXCESS_MEANING, FLAGS, POINT, EvaluationColumns, write_optimum
from screwsim.results.read import read_attributes
from screwsim.results.schema import Axis, Subject, axis_of, digest, subject_of
from screwsim.results.write import Draft
from screwsim.scene import Scene
from screwsim.scene.grid import unit_of
from screwsim.study.asked.varied import leaf_of
from screwsim.study.columns import Column, error_column, figure_column, protect_other_columns, write_columns
from screwsim.study.optimize.question import Question
from screwsim.study.optimize.record import Record
from screwsim.study.stages.store import subject_of_chain
from screwsim.study.sweep.shards import Parts

COMMAND_NAME = "optimize"  # in the history of a results file
TABLE_TITLE, TABLE_COLUMNS = "optimisation", (EVALUATION, "feasible", "front", "status")  # of a table's own
QUESTION_KEY = "question"  # key in the identity of results


def question_text(asked: Question) -> str:
    """Return the question as JSON, SI units."""
    return json.dumps(
        {
            "vary": {span.path: [span.low, span.high] for span in asked.spans},
            "maximize": [aim.figure for aim in asked.aims if not aim.minimum],
            "minimize": [aim.figure for aim in asked.aims if aim.minimum],
            "subject_to": [list(bound) for bound in asked.bounds],
            "over": None if asked.points.single else asked.points.name,
            "energy_weights": asked.points.energy,
            **({"heating": True} if asked.points.heating else {}),
            "loads_by": asked.points.by,
            "points": [
                {"name": point.name, "weight": point.weight, "load": point.load, "values": dict(point.values)}
                for point in asked.points.points
            ],
            "evaluations": asked.evaluations,
            "seed": asked.seed,
        }
    )


def identity(asked: Question) -> dict[str, str]:
    """Return the identity that tells the results of one optimisation from those of another."""
    return {**_subject(asked).identity, QUESTION_KEY: question_text(asked), "pymoo": installed_version("pymoo")}


@contextmanager
def held_parts(output: Path, asked: Question, restart: bool) -> Iterator[Parts]:
    """Hold the parts of an optimisation; raise UsageError where they, or the file, belong to something else."""
    if not isinstance(asked.scene, Scene) and output.suffix.lower() not in (*TABLES, ".h5"):
        raise UsageError(f"{output}: evaluations of two stages are a table (choose a name in .csv, .xlsx or .h5)")
    own = {"scene_sha256": digest(_subject(asked).text), "identity": identity(asked)}
    parts = Parts(output, own, "optimisation")
    if has_content(output):
        _check_own(output, asked)
        if not restart:
            raise UsageError(f"{output}: already exists (choose another -o, or --restart to replace it)")
    if not restart:
        _refuse_others(parts, own)
    parts.open(restart)
    try:
        yield parts
    finally:
        parts.close()


def _check_own(output: Path, asked: Question) -> None:
    """Raise UsageError where a file does not hold results of an optimisation."""
    if not isinstance(asked.scene, Scene):
        protect_other_columns(output, TABLE_TITLE, *TABLE_COLUMNS)
        return
    history = str(read_attributes(output).get("history", ""))  # raises for a file that is not a results file
    if not history.endswith(f" {COMMAND_NAME}"):
        raise UsageError(f"{output}: does not hold results of an optimisation (choose another -o, or remove it)")


def _refuse_others(parts: Parts, own: dict[str, Any]) -> None:
    stored = parts.stored_identity()
    if stored is None:
        return
    found = stored.get("identity")
    found = found if isinstance(found, dict) else unpacked(found) or {}
    if found.get(QUESTION_KEY) != own["identity"][QUESTION_KEY] or stored.get("scene_sha256") != own["scene_sha256"]:
        raise UsageError(f"{parts.folder}: holds evaluations of another optimisation (choose another -o, or --restart)")
    if what := differences(found, own["identity"]):
        why = f"holds evaluations of this optimisation, but {what}"
        raise UsageError(f"{parts.folder}: {why} (--restart computes them again)")


def write(output: Path, record: Record, feasible: np.ndarray, front: np.ndarray) -> None:
    """Write all cases and the answer to HDF5, those of two stages as a table, and remove the parts."""
    assert record.parts is not None
    asked = record.asked
    aims, errors, excess = record.columns()
    on_front = np.zeros(len(record), np.int8)
    on_front[front] = 1
    if not isinstance(asked.scene, Scene):
        write_columns(output, TABLE_TITLE, _table(record, feasible, on_front))
        record.parts.discard()
        return
    names = [aim.figure for aim in asked.aims]
    bounds = [f"{bound.figure}_{_SIDE[bound.sign]}" for bound in asked.bounds]
    found = EvaluationColumns(
        dict(zip(names, aims.T, strict=True)),
        dict(zip(names, errors.T, strict=True)),
        dict(zip(bounds, excess.T, strict=True)),
        feasible,
        on_front,
        {name: declared(name).units for name in names}
        | {label: declared(bound.figure).units for label, bound in zip(bounds, asked.bounds, strict=True)},
        [aim.figure for aim in asked.aims if aim.minimum],
        question_text(asked),
    )
    axes = axes_of(record)
    with Draft(output, _subject(asked), axes, COMMAND_NAME) as draft:
        cases = len(record) * len(asked.points.points)
        draft.complete(record.parts.all(cases), beside=partial(write_optimum, found=found))
    record.parts.discard()


_SIDE = {"<": "most", ">": "least"}


def axes_of(record: Record) -> tuple[Axis, ...]:
    """Return the axes of the cases: evaluations with the paths that vary along them, then operating points."""
    asked, places = record.asked, record.places
    values = [[span.value(float(place)) for place in places[:, i]] for i, span in enumerate(asked.spans)]
    along = tuple(_axis(asked, span.path, row) for span, row in zip(asked.spans, values, strict=True))
    about = "number of the evaluation, from 0"
    axes = [Axis(EVALUATION, np.arange(len(record), dtype=np.int32), "1", about, along)]
    if not asked.points.single:
        points = asked.points.points
        inner = [_axis(asked, path, [point.values[path] for point in points]) for path in points[0].values]
        about = "number of the operating point, from 0"
        axes.append(Axis(POINT, np.arange(len(points), dtype=np.int32), "1", about, tuple(inner)))
    return tuple(axes)


def _axis(asked: Question, path: str, values: list[Any]) -> Axis:
    leaf = leaf_of(asked.scene, path)
    return axis_of(path, values, unit_of(leaf) or "1", leaf.doc)


def _subject(asked: Question) -> Subject:
    """Return a scene, or two stages in series, as the subject of the evaluations."""
    return subject_of(asked.scene) if isinstance(asked.scene, Scene) else subject_of_chain(asked.scene)


def _table(record: Record, feasible: np.ndarray, on_front: np.ndarray) -> dict[str, Column]:
    """Return the columns of all evaluations of one operating point: values, figures, errors of the aims, status."""
    assert record.parts is not None
    asked, (_, errors, excess) = record.asked, record.columns()
    (axis,) = axes_of(record)
    tables = list(record.parts.all(len(record)).tables(traces=False))
    columns = {EVALUATION: Column(axis.values.tolist(), "1", axis.long_name)}
    columns |= {each.path: Column(each.values.tolist(), each.units, each.long_name) for each in axis.joined}
    for name in dict.fromkeys(name for table in tables for name in names_of(table.about)):
        values = np.concatenate([table.column("performance", name) for table in tables])
        columns[name] = figure_column(name, _known(values))
    for aim, wide in zip(asked.aims, errors.T, strict=True):
        columns[f"{aim.figure}_error"] = error_column(aim.figure, _known(wide))
    for bound, over in zip(asked.bounds, excess.T, strict=True):
        about = EXCESS_MEANING.format(bound.figure)
        name = f"{bound.figure}_{_SIDE[bound.sign]}_excess"
        columns[name] = Column(_known(over), declared(bound.figure).units, about)
    columns["feasible"] = Column(feasible.astype(int).tolist(), "1", FLAGS["feasible"])
    columns["front"] = Column(on_front.tolist(), "1", FLAGS["front"])
    told = [text.words[number] for table in tables for text in [table.texts["message"]] for number in text.number]
    status = [STATUSES[code] for table in tables for code in table.status]
    columns["status"] = Column(status, "", "how the evaluation ended")
    columns["message"] = Column(told, "", "why it has no results")
    return columns


def _known(values: np.ndarray) -> list[float | None]:
    return [None if np.isnan(value) else float(value) for value in values]
