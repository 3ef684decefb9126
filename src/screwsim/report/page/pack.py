"""Arrays for the page as text, in as few bytes as their accuracy needs."""

import base64
import gzip
import json
from functools import lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

QUANTISATION_STEPS = 65534  # of a trace's own span; 65535 marks missing values
_MOST_POINTS = 400
_FIRST = 24  # initial number of intervals


class ReducedAngles(NamedTuple):
    """Indices of the angles that are kept, and {trace: largest deviation of the straight segments between} [SI]."""

    kept: np.ndarray
    deviation: dict[str, float]


def floats(values: np.ndarray) -> str:
    """Return numbers as base64 of little-endian float32 (seven digits); NaN is kept."""
    with np.errstate(over="ignore"):  # becomes infinite beyond float32's range
        return base64.b64encode(np.ascontiguousarray(values, "<f4").tobytes()).decode()


def bytes_of(values: np.ndarray) -> str:
    """Return small integers as base64 of int8."""
    return base64.b64encode(np.ascontiguousarray(values, np.int8).tobytes()).decode()


def quantised(values: np.ndarray) -> dict[str, str]:
    """Return traces (cases, points) as base64: 16-bit steps of each trace's span, with its minimum and its span."""
    there = np.isfinite(values)
    low = np.min(values, axis=1, where=there, initial=np.inf)
    span = np.max(values, axis=1, where=there, initial=-np.inf) - low
    low, span = (np.where(there.any(axis=1), part, 0.0) for part in (low, span))
    share = np.where(there, values - low[:, None], 0.0) / np.where(span > 0.0, span, 1.0)[:, None]
    numbers = np.where(there, np.rint(share * QUANTISATION_STEPS), QUANTISATION_STEPS + 1).astype("<u2")
    return {"low": floats(low), "span": floats(span), "steps": base64.b64encode(numbers.tobytes()).decode()}


def compressed(document: Any) -> str:
    """Return a JSON document, or a text, as base64 of gzip; the same content always gives the same bytes."""
    if isinstance(document, str):
        return _compressed(document)
    return _compressed.__wrapped__(json.dumps(document, allow_nan=False, ensure_ascii=False))


@lru_cache(maxsize=1)
def _compressed(text: str) -> str:
    """Return a text as base64 of gzip; the last one is cached, as the library in each page takes half a second."""
    return base64.b64encode(gzip.compress(text.encode(), 9, mtime=0)).decode()


def reduce_angles(angle: np.ndarray, traces: dict[str, np.ndarray], wanted: float) -> ReducedAngles:
    """Return the angles to keep for traces {name: (cases, points)}, so that straight segments between them suffice.

    Intervals whose segment is off by more than `wanted` of a trace's span are split at their worst angle, repeatedly,
    up to 400 angles; the ends of stretches without values are kept.
    """
    last = len(angle) - 1
    found: set[int] = set()
    for trace in traces.values():
        changes = np.flatnonzero((np.diff(np.isfinite(trace).astype(np.int8), axis=1) != 0).any(axis=0))
        found.update(changes.tolist(), (changes + 1).tolist())
    kept = {*np.linspace(0, last, min(_FIRST, last) + 1).astype(int).tolist(), *found}
    while len(kept) < _MOST_POINTS:
        places = np.array(sorted(kept))
        off = _relative(angle, traces, places)
        worst = [start + int(np.argmax(off[start:stop])) for start, stop in pairwise(places)]
        split = sorted((place for place in worst if off[place] > wanted), key=lambda place: -off[place])
        if not split:
            break
        kept.update(split[: _MOST_POINTS - len(kept)])
    places = np.array(sorted(kept))
    off = {name: float(np.max(_segment_deviation(angle, trace, places))) for name, trace in traces.items()}
    return ReducedAngles(places, off)


def _relative(angle: np.ndarray, traces: dict[str, np.ndarray], places: np.ndarray) -> np.ndarray:
    """Return the deviation of the segments at each angle over the trace's span, the largest of all traces and cases."""
    worst = np.zeros(len(angle))
    for trace in traces.values():
        there = np.isfinite(trace)
        span = np.max(trace, axis=1, where=there, initial=-np.inf) - np.min(trace, axis=1, where=there, initial=np.inf)
        scale = np.where(np.isfinite(span) & (span > 0.0), span, np.inf)
        off = _segment_deviation(angle, trace, places) / scale[:, None]
        worst = np.maximum(worst, np.max(off, axis=0, initial=0.0))
    return worst


def _segment_deviation(angle: np.ndarray, trace: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return |trace − straight segments between the kept angles| (cases, points); 0 where there is no value."""
    right = np.clip(np.searchsorted(places, np.arange(len(angle)), side="left"), 1, len(places) - 1)
    a, b = places[right - 1], places[right]
    share = (angle - angle[a]) / (angle[b] - angle[a])
    off = np.abs(trace - (trace[:, a] + share * (trace[:, b] - trace[:, a])))
    return np.where(np.isfinite(off), off, 0.0)
