"""Faults that a person can fix: each says where it is, what is wrong, and the remedy."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

MOST_LINES = 100  # faults of a file, a line each: more of them are counted


@dataclass(frozen=True)
class Fault:
    """One fault of a scene: `path` is dotted (`machine.volume.phi_A`), `what` ends with the remedy."""

    path: str
    what: str

    def __str__(self) -> str:
        return f"{self.path}: {self.what}"


def given_twice(path: str, other: str) -> Fault:
    """Return the fault of an input that is given as well as another one, which states the same."""
    return Fault(path, f"is given as well as {other} (remove one of the two; null drops a base's value)")


def incomplete(path: str, names: Sequence[str], stated: Collection[str]) -> Fault:
    """Return the fault of inputs below `path` that are stated together, of which `stated` are only some."""
    missing = next(name for name in names if name not in stated)
    return Fault(f"{path}.{missing}", f"is missing (these are stated together: {', '.join(names)})")


class SceneError(Exception):
    """Report the faults of a scene; `lines` are all of them, ready to print (`FILE:LINE:COLUMN: PATH: what`).

    As text it has the first MOST_LINES of them, and how many more there are.
    """

    def __init__(self, lines: list[str]) -> None:
        more = len(lines) - MOST_LINES
        told = [*lines[:MOST_LINES], f"… and {more} more fault{'s' * (more > 1)} (fix these first)"]
        super().__init__("\n".join(told if more > 0 else lines))
        self.lines = lines


def in_one_line(error: BaseException) -> str:
    """Return the class and the text of an error."""
    return " ".join(f"{type(error).__name__}: {error}".split())


class UsageError(Exception):
    """Report a wrong use of a command, or of a function, in one line."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a study that has something to show for it; `found` is its answer so far."""

    def __init__(self, found: Any) -> None:
        super().__init__(getattr(found, "message", ""))
        self.found = found


class ImpossibleValue(UsageError):
    """Report, in one line, that a user's effect returned an impossible value: the case has failed."""

    def __init__(self, effect: str, what: str) -> None:
        super().__init__(f"effects.{effect}: {what}, which is impossible; fix that module")


class QuantityNotFound(ImpossibleValue):
    """Report, in one line, that a quantity determined by the cycle cannot be found: the case has failed."""

    def __init__(self, what: str) -> None:
        UsageError.__init__(self, what)


def checked_own_number(effect: str, what: str, value: Any, least: float = -math.inf) -> None:
    """Raise ImpossibleValue where a user's effect gives no finite number, or one below `least`."""
    if "." not in effect:
        return
    size = float(value) if isinstance(value, Real) and not isinstance(value, bool) else None
    if size is None or not (math.isfinite(size) and size >= least):
        raise ImpossibleValue(effect, f"{what} is {repr(value)[:40] if size is None else f'{size:.6g}'}")
