"""The case of a sweep that is meant by values of its paths, and the values of a case in words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import MACHINES
from screwsim.outputs.customary import in_celsius
from screwsim.scene.fields import Leaf, catalogue_leaves, unknown_key
from screwsim.scene.units import readable_quantity, refused_at
from screwsim.scene.values import convert

if TYPE_CHECKING:
    from screwsim.results.read import Results

SAME = 3e-5  # relative difference within which a value is the one that is meant: it may be as printed
MOST_SHOWN = 12


def read_case(texts: Iterable[str]) -> dict[str, str]:
    """Return values by path of texts PATH=VALUE; raise UsageError in one line."""
    found: dict[str, str] = {}
    for text in texts:
        path, equals, value = (part.strip() for part in text.partition("="))
        if not (equals and path and value):
            raise UsageError(f"{text}: is not PATH=VALUE (write e.g. operation.speed='2950 rpm')")
        if path in found:
            raise UsageError(f"{path}: is given twice (remove one)")
        found[path] = value
    return found


def cases_with(results: Results, values: Mapping[str, Any]) -> np.ndarray:
    """Return which cases have these values, numbers [SI] or texts with units, by path; raise UsageError for none."""
    found = np.ones(results.shape, bool)
    for path, value in values.items():
        if path not in results.varied:
            there = ", ".join(results.varied)
            if not there:
                raise UsageError(f"{path}: {results.path} has a single case (leave it out)")
            raise UsageError(f"{path} {unknown_key(path, results.varied, f'the sweep varies {there}')}")
        own = results.along(path)
        same = _same(own, _read(path, value))
        if not same.any():
            raise UsageError(f"{path}: there is no case at {value} (there are {_listed(path, own)})")
        found &= same
    if not found.any():
        raise UsageError("no case has all of these values (see the cases of the file)")
    return found


def case_in_words(results: Results, index: tuple[int, ...]) -> str:
    """Return the varied values of a case: 'operation.speed = 2950 rpm'; empty for one run."""
    varied = {path: results.along(path)[index] for path in results.varied}
    return ", ".join(f"{path} = {_shown(path, value)}" for path, value in varied.items())


def _same(own: np.ndarray, asked: Any) -> np.ndarray:
    if own.dtype.kind != "f":
        return own == asked
    return np.isclose(own, asked, rtol=SAME, atol=0.0) if isinstance(asked, float) else np.zeros(own.shape, bool)


def _read(path: str, value: Any) -> Any:
    """Return a value [SI] of a path, a text where it is no number."""
    if not isinstance(value, str):
        return float(value)
    leaf = _leaf(path)
    if leaf is not None and leaf.dimension is not None:
        with refused_at(path):
            return float(convert(leaf, value))
    try:
        return float(value)
    except ValueError:
        return value  # a word, such as a fluid


def _leaf(path: str) -> Leaf | None:
    """Return the input at a path; None for one of an effect of a user's own."""
    return next((leaf for kind in MACHINES if (leaf := catalogue_leaves(kind).get(path))), None)


def _listed(path: str, own: np.ndarray) -> str:
    shown = [_shown(path, value) for value in np.unique(own)]
    return ", ".join(shown if len(shown) <= MOST_SHOWN else [*shown[: MOST_SHOWN - 2], "…", shown[-1]])


def _shown(path: str, value: Any) -> str:
    """Return a value [SI] of a path in its customary unit, a temperature in °C."""
    leaf = _leaf(path)
    if isinstance(value, str) or leaf is None or leaf.dimension is None:
        return str(value) if isinstance(value, str) else f"{value:.6g}"
    if leaf.dimension.name == "temperature":
        return in_celsius(float(value))
    return readable_quantity(leaf.dimension, float(value))
