"""One value of a scene: from its YAML form to SI, and back to text."""

import os
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from screwsim.fluid.models import find_gas_model
from screwsim.inputs.declare import AUTO, KINDS, FoundWithCycle
from screwsim.inputs.suggestions import nearest, with_article
from screwsim.machine.kinds import MACHINES
from screwsim.numerics.integrators import find_integrator
from screwsim.scene.fields import Leaf
from screwsim.scene.numerals import odd_number, odd_number_text
from screwsim.scene.units import NUMBER, Refused, format_quantity, parse_quantity

LARGEST_GAP = 2e-3  # [m] inputs that are usually shorter are explained by an example of a gap
GAP_KIND = replace(KINDS["length"], example="27 um")


def shown(raw: Any) -> str:
    """Return a value of the YAML tree as shown in messages."""
    if isinstance(raw, dict | list):
        return "a mapping" if isinstance(raw, dict) else "a list"
    if isinstance(raw, bool) or raw is None:
        return "null" if raw is None else str(raw).lower()
    text = repr(raw) if isinstance(raw, str) else _digits(raw)
    return text if len(text) <= 42 else text[:39] + "...'"


def _digits(raw: int | float) -> str:
    return repr(raw) if isinstance(raw, float) or abs(raw) < 10**30 else "a huge number"


def convert(leaf: Leaf, raw: Any, folder: str = ".") -> Any:
    """Return the SI value of a scalar of the YAML tree, checked against the leaf; raise `Refused`."""
    if leaf.auto and raw == AUTO:
        return FoundWithCycle(0.0)
    if leaf.dimension is not None:
        return _limited(leaf, _quantity(leaf, raw), raw)
    return _READERS[leaf.kind](leaf, raw, folder)


def convert_cell(leaf: Leaf, text: str, unit: str, folder: str = ".") -> Any:
    """Return the SI value of a table's cell in the unit of its column's head, '' for none; raise `Refused`."""
    if leaf.dimension is not None:
        return convert(leaf, f"{text} {unit}" if unit else text, folder)
    number = int if leaf.kind == "count" and text.isdigit() else float
    return convert(leaf, number(text) if re.fullmatch(NUMBER, text) else text, folder)


def _quantity(leaf: Leaf, raw: Any) -> float:
    kind = leaf.dimension
    assert kind is not None
    if kind.name == "length" and (leaf.hardly[1] or 1.0) <= LARGEST_GAP:  # inputs the size of a rotor are not gaps
        kind = GAP_KIND
    if isinstance(raw, str):
        return parse_quantity(kind, raw)
    if isinstance(raw, int | float) and not isinstance(raw, bool):
        raise Refused(f"{shown(raw)} has no unit (write e.g. '{kind.example}')")
    raise Refused(f"{shown(raw)} is not {describe_leaf(leaf)} (write e.g. '{kind.example}')")


def describe_leaf(leaf: Leaf) -> str:
    """Return the kind of value that a leaf holds, with its article."""
    return with_article("whole number" if leaf.kind == "count" else leaf.kind.replace("_", " "))


def _number(leaf: Leaf, raw: Any, folder: str) -> float:
    if isinstance(raw, str):
        text = raw.strip()
        if re.fullmatch(NUMBER, text):
            raise Refused(f"{shown(raw)} is text, not a number (write {text} without quotes)")
        raise Refused(f"{shown(raw)} {_not_plain(text)}")
    if isinstance(raw, bool) or not isinstance(raw, int | float):
        raise Refused(f"{shown(raw)} is not a number (write e.g. 0.5)")
    if not -1e300 < raw < 1e300:
        raise Refused(f"{shown(raw)} is not a finite number (write e.g. 0.5)")
    return _limited(leaf, float(raw), raw)


def _not_plain(text: str) -> str:
    """Return what is wrong with a text given in place of a plain number, with the remedy."""
    odd, share = odd_number(text), re.fullmatch(rf"({NUMBER})\s*(%|‰|percent)", text)
    if share is not None:
        return f"is a share (write {float(share[1]) / (1000.0 if share[2] == '‰' else 100.0):.10g})"
    if odd is None:
        return "is not a plain number (write e.g. 0.5, without a unit)"
    numbers = [re.match(NUMBER, reading) for reading in odd.readings]
    return odd_number_text(odd._replace(readings=tuple(match[0] for match in numbers if match)), "")


def _count(leaf: Leaf, raw: Any, folder: str) -> int:
    if isinstance(raw, str) and re.fullmatch("[0-9]{1,9}", raw.strip()):
        raise Refused(f"{shown(raw)} is text, not a number (write {int(raw)} without quotes)")
    if isinstance(raw, float) and raw.is_integer() and abs(raw) <= 10**9:
        raise Refused(f"{shown(raw)} is not written as a whole number (write {int(raw)})")
    if isinstance(raw, bool) or not isinstance(raw, int) or abs(raw) > 10**9:
        raise Refused(f"{shown(raw)} is not a whole number (write e.g. 4)")
    return _limited(leaf, raw, raw)


_CALLED = {"perfect": "ideal", "ideal_gas": "ideal", "real_gas": "real"}  # other names of an option
_CALLED |= {word: name for name, kind in MACHINES.items() for word in kind.called}


def imported(name: str, look: Callable[[], Any]) -> Any:
    """Return what `look` finds in a user-defined module; raise Refused, in one line, where the module is faulty."""
    if "." in name and not {"", os.getcwd()} & set(sys.path):
        sys.path.append(os.getcwd())  # last, so that it cannot hide an installed package
    try:
        return look()
    except KeyError as error:
        if "." not in name:  # no such name in the package
            raise
        raise Refused(f"fails on import (KeyError: {error}); fix that module") from None
    except ModuleNotFoundError as error:
        raise Refused(f"cannot be imported ({error}); tried PYTHONPATH and the working folder (is it there?)") from None
    except ImportError as error:
        raise Refused(f"cannot be imported ({error}); fix that module") from None
    except Exception as error:  # noqa: BLE001 - a user's module may raise anything
        raise Refused(f"fails on import ({type(error).__name__}: {error}); fix that module") from None


# functions that find a user-defined choice, by the variable that its module must define
_OWN = {"INTEGRATOR": find_integrator, "GAS": find_gas_model}


def _choice(leaf: Leaf, raw: Any, folder: str) -> str:
    options = leaf.limits["options"]
    if isinstance(raw, str) and raw in options:
        return raw
    if isinstance(raw, str) and "." in raw and "own" in leaf.limits:
        try:
            imported(raw, lambda: _OWN[leaf.limits["own"]](raw))
        except Refused as refusal:
            raise Refused(f"{shown(raw)} {refusal}") from None
        return raw
    called = _CALLED.get(raw.lower().replace(" ", "_")) if isinstance(raw, str) else None
    near = called if called in options else nearest(raw, options) if isinstance(raw, str) else None
    hint = f"; did you mean '{near}'?" if near else ""
    own = ", or the dotted name of a module of your own" if "own" in leaf.limits and not near else ""
    raise Refused(f"{shown(raw)} is not an option{hint} (choose from: {', '.join(options)}{own})")


def _word(leaf: Leaf, raw: Any, folder: str) -> str:
    if not isinstance(raw, str):
        raise Refused(f"{shown(raw)} is not text (write it in quotes)")
    return raw


def _names(leaf: Leaf, raw: Any, folder: str) -> str | tuple[str, ...]:
    if isinstance(raw, dict):
        what = f"{shown(raw)} is not a fluid outside a sweep"
        raise Refused(f"{what} (write fluid: NAME, or for a blend fluid: [NAME, NAME] and mass_fractions)")
    if not isinstance(raw, list):
        return _word(leaf, raw, folder)
    return tuple(_word(leaf, node.value, folder) for node in raw)


def _numbers(leaf: Leaf, raw: Any, folder: str) -> tuple[float, ...]:
    if not isinstance(raw, list):
        raise Refused(f"{shown(raw)} is not a list of numbers (write e.g. [0.6, 0.4])")
    return tuple(_number(leaf, node.value, folder) for node in raw)


def _file(leaf: Leaf, raw: Any, folder: str) -> str:
    if not isinstance(raw, str) or not raw.strip() or "\0" in raw:
        raise Refused(f"{shown(raw)} is not the name of a file (write e.g. volume.csv)")
    return os.path.abspath(os.path.join(folder, raw))


_READERS = {
    "number": _number,
    "numbers": _numbers,
    "count": _count,
    "choice": _choice,
    "word": _word,
    "fluid": _names,
    "file": _file,
}
_WORDS = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}
_HOLDS = {
    "gt": lambda value, limit: value > limit,
    "ge": lambda value, limit: value >= limit,
    "lt": lambda value, limit: value < limit,
    "le": lambda value, limit: value <= limit * (1.0 + 1e-12) if limit > 0.0 else value <= limit,  # 720 deg is 4 pi
}


def within(leaf: Leaf, value: float) -> bool:
    """Tell whether a value [SI] lies within the limits of a leaf."""
    kind, limits = leaf.dimension, leaf.limits.items()
    return all(_HOLDS[name](value, limit) for name, limit in limits if name in _HOLDS) and (
        kind is None or (kind.least <= value and abs(value) <= kind.most)
    )


def _limited(leaf: Leaf, value: Any, raw: Any) -> Any:
    if not all(_HOLDS[name](value, limit) for name, limit in leaf.limits.items()):
        share = leaf.kind == "number" and leaf.limits.get("le", leaf.limits.get("lt")) == 1 and 2 <= value <= 100
        hint = f"; {value:g} % is {value / 100:g}" if share else f"; {leaf.remedy}" if leaf.remedy else ""
        raise Refused(f"{shown(raw)} is out of range (it must be {limits_text(leaf)}{hint})")
    kind = leaf.dimension
    if kind is not None and not (kind.least <= value and abs(value) <= kind.most):
        word, end = ("least", kind.least) if value < kind.least else ("most", kind.most)
        raise Refused(f"{shown(raw)} is beyond any machine (at {word} {text_of(leaf, end)}; is the unit right?)")
    return value


def limits_text(leaf: Leaf) -> str:
    """Return the limits of a leaf in customary units: 'greater than 0 mm'."""
    known = [f"{_WORDS[name]} {text_of(leaf, limit)}" for name, limit in leaf.limits.items() if name in _WORDS]
    return " and ".join(known)


def text_of(leaf: Leaf, value: Any) -> str:
    """Return an SI value as YAML text that reads back to the same value (words are quoted by the caller)."""
    if leaf.auto and isinstance(value, FoundWithCycle):
        return AUTO
    if leaf.dimension is not None:
        return format_quantity(leaf.dimension, value)
    if isinstance(value, tuple):
        return f"[{', '.join(repr(each) for each in value)}]"
    if leaf.kind in ("number", "numbers"):
        return repr(float(value)) if not float(value).is_integer() or abs(value) >= 1e15 else str(int(value))
    return str(value)
