"""Figures and curves of one result as tables of other libraries, which are asked for when they are wanted."""

import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np

ANGLE = "angle"


def library(name: str) -> Any:
    """Return a library that is an extra; raise ImportError with what installs it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"{name} is not installed (pip install 'screwsim[{name}]')") from error


def frame(cycle: Mapping[str, np.ndarray], figures: Mapping[str, Any]) -> Any:
    """Return curves as a pandas.DataFrame over the angle; the figures are its `attrs`."""
    pandas = library("pandas")
    columns = {name: values for name, values in cycle.items() if name != ANGLE}
    made = pandas.DataFrame(columns, index=pandas.Index(cycle.get(ANGLE, np.zeros(0)), name=ANGLE))
    made.attrs.update(figures)
    return made


def dataset(
    figures: Mapping[str, Any], about: Mapping[str, Any], cycle: Mapping[str, np.ndarray], curves: Mapping[str, Any]
) -> Any:
    """Return figures and curves as an xarray.Dataset; `about` and `curves` hold (units, long_name) of each."""
    xarray = library("xarray")
    values = {name: ((), np.nan if value is None else value, about[name]._asdict()) for name, value in figures.items()}
    values |= {name: (ANGLE, column, curves[name]._asdict()) for name, column in cycle.items() if name != ANGLE}
    coordinates = {ANGLE: (ANGLE, cycle[ANGLE], curves[ANGLE]._asdict())} if ANGLE in cycle else {}
    return xarray.Dataset(values, coordinates)
