"""Checks of the arguments of public functions: a wrong kind is reported in one line before anything begins."""

import functools
import inspect
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from numbers import Integral, Real
from typing import Any, NamedTuple, ParamSpec, TypeVar

from screwsim.inputs.faults import UsageError

T = TypeVar("T")
P = ParamSpec("P")
R = TypeVar("R")


class Kind(NamedTuple):
    """Kind of an argument: a test whether a value is of that kind, and words for one that is not, with the remedy."""

    holds: Callable[[Any], bool]
    words: str


def checked_arguments(**own: Kind) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Return a decorator that checks the kinds of arguments and raises UsageError; None passes where it is the default.

    Arguments not stated here have the kind of their name in `KIND_BY_NAME`. Of a mapping only the type is checked: the
    function checks its values itself. The function runs with numpy's default treatment of rounding errors.
    """

    def around(function: Callable[P, R]) -> Callable[P, R]:
        parameters = inspect.signature(function).parameters
        kinds = {name: KIND_BY_NAME[name] for name in parameters if name in KIND_BY_NAME} | own
        names = tuple(parameters)
        open_to_none = {name for name, each in parameters.items() if each.default is None}
        assert kinds.keys() <= parameters.keys()

        @functools.wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            for name, value in (*zip(names, args, strict=False), *kwargs.items()):
                kind = kinds.get(name)
                if kind is not None and not (value is None and name in open_to_none) and not kind.holds(value):
                    raise UsageError(f"{name}: {shown(value)} is {kind.words}")
            import numpy as np  # here because the command's help does without it

            # whatever a caller has set by `np.seterr`
            with np.errstate(divide="warn", over="warn", under="ignore", invalid="warn"):
                return function(*args, **kwargs)

        return checked

    return around


def shown(value: Any) -> str:
    """Return a value as messages show it: its repr where that is short, else the name of its type."""
    text = repr(value)
    return text if len(text) <= 40 and " object at " not in text else f"of type {type(value).__name__}"


def one_of(*values: Any) -> Kind:
    """Return the kind that consists of these values, numpy's included; True does not count as 1."""
    words = f"none of {', '.join(map(repr, values))}"
    return Kind(lambda given: any(_is(given, value) for value in values), words)


def _is(given: Any, value: Any) -> bool:
    if isinstance(value, bool):
        return _flag(given) and bool(given) == value
    return isinstance(given, type(value)) and given == value


def _flag(given: Any) -> bool:
    return type(given).__name__ in ("bool", "bool_")


def instance(kind: type, remedy: str) -> Kind:
    """Return the kind of the instances of a class; `remedy` says what to pass."""
    return Kind(lambda given: isinstance(given, kind), f"not a {kind.__name__} (pass {remedy})")


def whole(least: int, words: str) -> Kind:
    """Return the kind of whole numbers of at least `least`."""
    return Kind(lambda given: _whole(given) and given >= least, words)


def ends_of(path: str, given: Any) -> tuple[float, float]:
    """Return the two ends of a range; raise UsageError unless they are two numbers, the lower one first."""
    ends = () if not isinstance(given, Iterable) or isinstance(given, str | bytes | Mapping) else tuple(given)
    if len(ends) != 2 or not all(map(_number, ends)) or not ends[0] < ends[1]:
        raise UsageError(f"{path}: {shown(given)} is not a range (pass two numbers [SI], the lower one first)")
    return float(ends[0]), float(ends[1])


def _whole(given: Any) -> bool:
    return isinstance(given, Integral) and not isinstance(given, bool)


def _real(given: Any) -> bool:
    return isinstance(given, Real) and not isinstance(given, bool)


def _number(given: Any) -> bool:
    return _real(given) and math.isfinite(given)


def _text(given: Any) -> bool:
    return isinstance(given, str) and bool(given.strip())


def _file(given: Any) -> bool:
    return isinstance(given, str | os.PathLike) and _text(os.fspath(given))


def _texts(given: Any) -> bool:
    """Tell whether a value is a text or a collection of texts; an iterator is not consumed to check its items."""
    if isinstance(given, str):
        return _text(given)
    if isinstance(given, list | tuple | set | frozenset | Mapping):
        return all(isinstance(each, str) for each in given)
    return isinstance(given, Iterable) and not isinstance(given, bytes | bytearray)


def _numbers(given: Any) -> bool:
    """Tell whether a value is a text or an iterable of numbers; an iterator is not consumed to check its items."""
    if isinstance(given, str | bytes):
        return isinstance(given, str) and _text(given)
    return isinstance(given, Iterable) and (isinstance(given, Iterator) or all(map(_number, given)))


def _progress(given: Any) -> bool:
    return isinstance(given, bool) or all(hasattr(given, name) for name in ("start", "advance", "stop"))


_WRONG_JOBS = "not a number of workers (pass 1 or more, or None for all cores)"
JOBS = Kind(lambda given: given is None or (_whole(given) and given >= 1), _WRONG_JOBS)
SEED = whole(0, "not a seed (pass a whole number, 0 or more)")
FLAG = Kind(_flag, "neither True nor False")
REAL = Kind(_real, "no number")  # NaN passes: the function reports it itself
NUMBER = Kind(_number, "no number")
QUANTITY = Kind(lambda given: _number(given) or _text(given), "neither a number nor a text such as '3000 rpm'")
TEXT = Kind(lambda given: isinstance(given, str), "no text")
TEXTS = Kind(_texts, "neither a text nor a list of texts")
OVERRIDES = Kind(
    lambda given: _texts(given) and not isinstance(given, Mapping),
    "neither a text nor a list of texts (pass 'PATH=VALUE'; of a loaded scene, .with_ takes a dict)",
)
FILE = Kind(_file, "not the path of a file")
CALLABLE = Kind(callable, "not a function")
PROGRESS = Kind(_progress, "not a setting of progress (pass True, False or None)")
NUMBERS = Kind(_numbers, "neither a text such as '140, 163 mm' nor a list of numbers")
MAPPING = Kind(lambda given: isinstance(given, Mapping), "no dict")
# arguments that mean the same in every function
KIND_BY_NAME: dict[str, Kind] = {
    "figure": TEXT,
    "jobs": JOBS,
    "output": FILE,
    "overrides": OVERRIDES,
    "progress": PROGRESS,
    "seed": SEED,
    **dict.fromkeys(("figures", "without"), TEXTS),
    **dict.fromkeys(("restart", "minimum"), FLAG),
    **dict.fromkeys(("simulate", "simulate_many", "warm_up"), CALLABLE),
}


def as_list(given: str | Iterable[T] | None) -> list[str] | list[T]:
    """Return an argument as a list: a single text, though iterable, becomes a list of that text."""
    return [] if given is None else [given] if isinstance(given, str) else list(given)
