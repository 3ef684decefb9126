"""The record that carries the results of one simulation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from screwsim.outputs import display
from screwsim.outputs.declared import Variable
from screwsim.outputs.derivatives import Derivatives
from screwsim.outputs.display import ANGLE, table_html, table_text
from screwsim.outputs.figures import Balance, Error, Figures, Ledger, Numerics, shown
from screwsim.outputs.variables import cycle_variable


class NoUncertainty(dict[str, Any]):
    """An empty mapping that says how to find uncertainties, which `simulate` does not."""

    remedy = "simulate finds no uncertainties by tolerances (screwsim.uncertainty(scene) does)"

    def __missing__(self, key: str) -> Any:
        """Raise KeyError with the remedy."""
        raise KeyError(f"{key}: {self.remedy}")

    def __repr__(self) -> str:
        return f"none: {self.remedy}"


@dataclass(frozen=True, eq=False)
class Result:
    """One simulated operating point, all in SI units; what `simulate` returns.

    - `status` is ok, not_closed or failed; `message` says why, `warnings` what to doubt.
    - `performance` holds the figures by name, also as attributes; `notes` say why one is None.
    - `error` is the estimated relative numerical error of each figure; `balance` holds the residuals of mass, energy
      and entropy with their bound; `numerics` the effort of the solution.
    - `cycle` holds arrays of one length over `angle` [degree]; empty when the run failed before a complete life.
    - `ledger` accounts for the shaft power; empty without the cycle. `effects` and `states` name what was simulated.
    - `impossible` names figures of `performance` with values that no machine has; `warnings` say what is wrong with
      them.
    - `derivatives` of the figures by the numbers of the scene are computed on first use.
    """

    status: str
    message: str = ""
    warnings: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    performance: Figures = field(default_factory=Figures)
    balance: Figures = field(default_factory=Figures)
    error: Figures = field(default_factory=Figures)
    numerics: Figures = field(default_factory=Figures)
    notes: Mapping[str, str] = field(default_factory=dict)
    cycle: Mapping[str, np.ndarray] = field(default_factory=dict)
    ledger: Figures = field(default_factory=Figures)  # empty without the cycle
    knock_out: tuple[Figures, ...] = ()  # changes by leaving out each effect, where requested
    uncertainty: Mapping[str, Any] = field(default_factory=NoUncertainty)  # from the inputs, where they are asked for
    impossible: tuple[str, ...] = ()
    derivatives: Derivatives = field(default_factory=Derivatives, compare=False, repr=False)

    def __post_init__(self) -> None:
        """Convert the other mappings to types that know their units, too."""
        for name, kind in (("balance", Balance), ("error", Error), ("numerics", Numerics), ("ledger", Ledger)):
            if type(own := getattr(self, name)) is not kind:
                object.__setattr__(self, name, kind(own))

    def __eq__(self, other: object) -> bool:
        """Return whether all values of another result are equal, times included; NaN equals NaN."""
        if not isinstance(other, Result):
            return NotImplemented
        compared = [each.name for each in fields(self) if each.compare]
        return all(_equal(getattr(self, name), getattr(other, name)) for name in compared)

    @property
    def told(self) -> str:
        """How the run ended, in words: `not closed: …`."""
        return f"{self.status.replace('_', ' ')}: {self.message}"

    def lacks(self, names: Iterable[str]) -> list[str]:
        """Return the reason for each of these figures that the result does not have."""
        none = (name for name in names if self.performance.get(name) is None)
        return [f"no {name}: {self.notes.get(name, 'it is not simulated')}" for name in none]

    def why_not(self, names: Iterable[str]) -> str:
        """Return how the run ended unless ok, else why it lacks some of these figures; '' where it has them all."""
        return self.told if self.status != "ok" else "; ".join(self.lacks(names))

    def __repr__(self) -> str:
        return f"Result: {self.told if self.message else self.status}\n{table_text(shown(self.performance))}".rstrip()

    def _repr_html_(self) -> str:
        """Return the display in notebooks: how the run ended, warnings, and all figures with units and meanings."""
        heading = self.told if self.message else self.status
        return table_html(heading, [f"warning: {text}" for text in self.warnings], shown(self.performance))

    def to_pandas(self) -> Any:
        """Return the cycle as a pandas.DataFrame over the angle [degree], SI units.

        Its `attrs` have the figures by name, and the `units` of the columns.
        """
        pandas = display.library("pandas")
        columns = {name: values for name, values in self.cycle.items() if name != ANGLE}
        made = pandas.DataFrame(columns, index=pandas.Index(self.cycle.get(ANGLE, np.zeros(0)), name=ANGLE))
        made.attrs.update(self.performance, units={name: cycle_variable(name).units for name in self.cycle})
        return made

    def to_xarray(self) -> Any:
        """Return figures and cycle as an xarray.Dataset, units and meanings as attributes."""
        curves = {name: (ANGLE, column, cycle_variable(name)._asdict()) for name, column in self.cycle.items()}
        coordinates = {ANGLE: curves.pop(ANGLE)} if ANGLE in curves else {}
        about = {each.name: Variable(each.units, each.long_name)._asdict() for each in shown(self.performance)}
        values = {
            name: ((), np.nan if value is None else value, about[name]) for name, value in self.performance.items()
        }
        return display.library("xarray").Dataset(values | curves, coordinates)

    def as_json(self) -> dict[str, Any]:
        """Return the content of `run --json` (the cycle is only in the HDF5 file)."""
        asked: dict[str, Any] = {"knock_out": [dict(cost) for cost in self.knock_out]} if self.knock_out else {}
        asked |= {"uncertainty": dict(self.uncertainty)} if self.uncertainty else {}
        own = ("status", "message", "warnings", "effects", "states", "performance", "balance", "error", "ledger")
        return display.picked(self, *own, "numerics", "notes") | asked


def _equal(one: Any, other: Any) -> bool:
    """Return whether two values, or all within two mappings, sequences or arrays, are equal; NaN equals NaN."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        numbers = all(np.issubdtype(np.asarray(each).dtype, np.number) for each in (one, other))
        return np.array_equal(one, other, equal_nan=numbers)
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_equal(value, other[name]) for name, value in one.items())
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(_equal, one, other))
    return one == other or (one != one and other != other)
