"""Stored results as an xarray.Dataset: axes as coordinates, units and meanings as attributes."""

from typing import Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import KNOCK_OUT_STATUSES, STATUSES
from screwsim.outputs.display import cf_unit, library
from screwsim.results.group import OWN, Group
from screwsim.results.read import Results
from screwsim.results.schema import Axis

_PREFIXED = ("balance", "error", "numerics", "cycle", "ledger", "knock_out", "optimum", "contributions", "derivatives")
_UNCERTAIN = "_u"  # suffix of a figure's standard uncertainty due to the inputs


def dataset(results: Results, group: str | None) -> Any:
    """Return a group of results as an xarray.Dataset; None: performance, and the other groups with a prefix."""
    import xarray as xr

    if group is None:
        parts = [("", results.performance)] + [(f"{name}_", getattr(results, name)) for name in _PREFIXED]
    else:
        parts = [("", getattr(results, group))]
    variables = {}
    for prefix, part in parts:
        variables |= _variables(part, prefix, results.axis_list)
    if group in (None, "performance"):
        own = _variables(results.uncertainty, "", results.axis_list)
        variables |= {name + _UNCERTAIN: variable for name, variable in own.items()}
    coordinates = {
        inner.name: (axis.name, inner.values, inner.about)
        for axis in results.axis_list
        for inner in (axis, *axis.joined)
    }
    for name, part in ((OWN[part.name], part) for _, part in parts if part.name in OWN):
        if name in part:
            coordinates[name] = (name, part[name], part.about[name]._asdict())
    return xr.Dataset(variables, coordinates, dict(results.attributes))


def frame(results: Results, group: str) -> Any:
    """Return a group of results as a pandas.DataFrame, one row per case; raise UsageError if it has its own axis.

    Its attrs have `units` (SI, CF style: "kg s-1", "rad s-1") and `meanings` by column.
    """
    part: Group = getattr(results, group)
    if OWN.get(group) is not None:
        raise UsageError(f"{group}: has more than one value a case (use to_xarray({group!r}))")
    columns = {path: results.along(path).ravel() for path in results.varied}
    about = {inner.path: (inner.units, inner.long_name) for axis in results.axis_list for inner in (axis, *axis.joined)}
    about |= {name: (each.units, each.long_name) for name, each in part.about.items()}
    joined = {inner.name for axis in results.axis_list for inner in axis.joined}
    for name, found in part.items():
        values = np.asarray(found)
        if name == "status":
            values = results.status
        if name not in joined and values.ndim in (0, len(results.shape)):
            columns[name] = np.broadcast_to(values, results.shape).ravel()
    if group == "performance":
        columns |= {name + _UNCERTAIN: np.asarray(values).ravel() for name, values in results.uncertainty.items()}
        spread = results.uncertainty.about
        about |= {name + _UNCERTAIN: (each.units, each.long_name) for name, each in spread.items()}
    made = library("pandas").DataFrame({name: np.atleast_1d(column) for name, column in columns.items()})
    there = {name: about[name] for name in columns if name in about}
    made.attrs["units"] = {name: cf_unit(units) for name, (units, _) in there.items()}
    made.attrs["meanings"] = {name: meaning for name, (_, meaning) in there.items()}
    return made


def _variables(part: Group, prefix: str, axes: tuple[Axis, ...]) -> dict[str, Any]:
    """Return (dimensions, values, attributes) by name; variables that are the same for all cases have no dimension."""
    names = [axis.name for axis in axes]
    joined = {inner.name for axis in axes for inner in axis.joined}
    found = {}
    for name, values in part.items():
        own = OWN.get(part.name)
        if name == own or name in joined:
            continue
        about = part.about[name]._asdict()
        dimensions = [*names, own] if own is not None else names[: values.ndim]
        if name == "status":
            words = KNOCK_OUT_STATUSES if part.name == "knock_out" else STATUSES
            about |= {"flag_values": list(range(len(words))), "flag_meanings": " ".join(words)}
        found[prefix + name] = (dimensions, values, about)
    return found
