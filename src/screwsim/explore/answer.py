"""One answer to a page: a JSON head, followed by the traces as float32, which a browser reads without parsing.

Figures are written such that reading them gives the same bits; traces are rounded to seven digits.
"""

import json
import math
import struct
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from screwsim.figures import known, trace_variable
from screwsim.figures.engineering import figure_scales, shown_name
from screwsim.outputs import LEDGER_SUMMARY, Figure, Result, sorted_entries, words_of_effects

CURVE = "curve"  # a point of a small sweep
SOLVED = "solved"
SLOPES = "slopes"  # derivatives of figures
FILE = "file"  # a file, in `text`
REFUSED = "refused"  # settings that make no scene; `message` has one line per fault


def pack_message(head: Mapping[str, Any], arrays: Iterable[np.ndarray] = ()) -> bytes:
    """Return a message: the length of its head, the head and the arrays.

    The length has 4 bytes, little-endian; the head is JSON, padded with blanks to a multiple of four; the arrays follow
    one after another as little-endian float32.
    """
    text = json.dumps(head, allow_nan=False, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    return b"".join((struct.pack("<I", len(text)), text, *(np.asarray(array, "<f4").tobytes() for array in arrays)))


def unpack_message(message: bytes) -> tuple[dict[str, Any], np.ndarray]:
    """Return head and numbers of a message."""
    (size,) = struct.unpack_from("<I", message)
    return json.loads(message[4 : 4 + size]), np.frombuffer(message, "<f4", offset=4 + size)


def result_answer(result: Result, more: Mapping[str, Any]) -> bytes:
    """Return the answer for a result, with further entries of its head."""
    traces = {name: np.asarray(values, float) for name, values in result.cycle.items()}
    about = getattr(result.performance, "about", {})
    head = {
        "kind": SOLVED,
        **figures_document(result),
        "warnings": list(result.warnings),
        "notes": dict(result.notes),
        "effects": list(result.effects),
        "error": finite(result.error),
        "balance": finite(result.balance),
        "ledger": _ledger(result),
        "traces": [[name, trace_variable(name).units] for name in traces],
        "about": [about_figure(figure) for name, figure in about.items() if name not in known()],
        **more,
    }
    return pack_message(head, traces.values())


def file_answer(text: str) -> bytes:
    """Return the answer with a file."""
    return pack_message({"kind": FILE, "text": text})


def refused_answer(message: str, more: Mapping[str, Any]) -> bytes:
    """Return the answer to settings that make no scene, or for which no solution was found."""
    return pack_message({"kind": REFUSED, "status": REFUSED, "message": message, **more})


def figures_document(result: Result) -> dict[str, Any]:
    """Return status, message and figures of a result."""
    return {"status": result.status, "message": result.message, "performance": finite(result.performance)}


def finite(figures: Mapping[str, Any]) -> dict[str, Any]:
    """Return figures, with null for values that JSON cannot represent."""
    bad = (name for name, value in figures.items() if isinstance(value, float) and not math.isfinite(value))
    return {**figures, **dict.fromkeys(bad)}


def _ledger(result: Result) -> dict[str, Any] | None:
    """Return totals and entries of a ledger for the page's waterfall; None without a ledger."""
    ledger = result.ledger
    if ledger.get("shaft_power") is None:
        return None
    found = sorted_entries(ledger)
    words = words_of_effects(name for name, _ in found)
    entries = [{"words": words[name], **finite(values)} for name, values in found]
    return {**finite({name: ledger[name] for name in LEDGER_SUMMARY if name in ledger}), "entries": entries}


def about_figure(figure: Figure) -> dict[str, Any]:
    """Return how the page writes a figure."""
    return {
        "name": figure.name,
        "words": shown_name(figure.name),
        "about": figure.long_name,
        "kelvin": figure.units == "K",
        "scales": [list(entry) for entry in figure_scales(figure)],
    }
