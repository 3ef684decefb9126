"""A study on disk: accuracy.csv with one row per case, and accuracy.h5 with everything."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.figures import declaration
from screwsim.results.atomic import replacing, write_csv
from screwsim.results.guarded import new_hdf5
from screwsim.results.protection import protect_other_hdf5, protect_other_text
from screwsim.study.accuracy.measure import COMPARED_TRACES, MeasuredCase
from screwsim.study.accuracy.words import sentence

if TYPE_CHECKING:
    from screwsim.study.accuracy import Study

TABLE, DATA = "accuracy.csv", "accuracy.h5"
UNITS = {"time": "s", "estimating_time": "s", "efficiency": "percent"}


def protect_other_studies(folder: Path) -> None:
    """Raise UsageError where a folder holds other files under the names of a study's: they would be lost."""
    protect_other_text({folder / TABLE: fields(MeasuredCase)[0].name})
    protect_other_hdf5(folder / DATA, "sentence")


def write(study: Study, folder: Path) -> list[str]:
    """Write both files and return their paths."""
    columns, data = _case_columns(study), folder / DATA
    rows = zip(*columns.values(), strict=True)
    cells = (["" if isinstance(value, float) and np.isnan(value) else value for value in row] for row in rows)
    table = write_csv(folder / TABLE, columns, cells)
    with replacing(data) as temporary:
        _write_hdf5(study, temporary)
    return [table, str(data)]


def _columns(records: Sequence[Any], without: Sequence[str] = ()) -> dict[str, list[Any]]:
    """Return {field: values} of dataclasses of one kind; None becomes NaN."""
    names = [field.name for field in fields(records[0]) if field.name not in without] if records else []
    return {name: [_nan_if_none(getattr(record, name)) for record in records] for name in names}


def _nan_if_none(value: Any) -> Any:
    return np.nan if value is None else value


def _case_columns(study: Study) -> dict[str, list[Any]]:
    best = study.front()
    columns = _columns(study.measured, ("errors", "traces"))
    columns["pareto"] = [int(any(each is one for one in best)) for each in study.measured]
    for name in dict.fromkeys(name for each in study.measured for name in each.errors):
        columns[f"error_{name}"] = [_nan_if_none(each.errors.get(name)) for each in study.measured]
    return columns


def _write_hdf5(study: Study, path: Path) -> None:
    with new_hdf5(path) as file:
        file.attrs["title"] = study.title
        file.attrs["accuracy"] = study.accuracy
        file.attrs["sentence"] = sentence(study)
        cases = file.create_group("cases")
        _write_columns(cases, _case_columns(study))
        angle = study.reference.traces["angle"]
        cases.create_dataset("angle", data=angle).attrs["units"] = "degree"
        for name, units in zip(COMPARED_TRACES, ("Pa", "K"), strict=True):
            rows = np.array([each.traces.get(name, np.full(len(angle), np.nan)) for each in study.measured])
            cases.create_dataset(name, data=rows, compression="gzip", shuffle=True).attrs["units"] = units
        _write_columns(file.create_group("asked"), _columns(study.asked))
        _write_columns(file.create_group("effects"), _columns(study.effects))
        _write_columns(file.create_group("sweep_points"), _columns(study.points))
        _write_columns(file.create_group("male_lobes"), _columns(study.lobes))
        left_out = {"what": [what for what, _ in study.left_out], "reason": [why for _, why in study.left_out]}
        _write_columns(file.create_group("left_out"), left_out)
        reference = file.create_group("reference")
        known = {name: value for name, value in study.reference.figures.items() if value is not None}
        _write_columns(reference.create_group("performance"), {name: [value] for name, value in known.items()})
        _write_columns(reference.create_group("cycle"), {name: list(v) for name, v in study.reference.traces.items()})
        for name in ("how", "second", "difference", "different_figure", "seconds"):
            reference.attrs[name] = getattr(study.reference, name)
        reference.attrs["traces_difference"] = study.reference.traces_difference


def _write_columns(group: Any, columns: Mapping[str, Sequence[Any]]) -> None:
    for name, values in columns.items():
        text = any(isinstance(value, str) for value in values)
        data = group.create_dataset(name, data=[str(value) for value in values] if text else np.array(values))
        if not text:
            about = declaration(name)
            data.attrs["units"] = UNITS.get(name, about.units if about is not None else "1")
