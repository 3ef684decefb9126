"""Figures by name and as attributes, which know their units and meanings."""

from collections.abc import Mapping
from typing import Any, Self

from screwsim.inputs.suggestions import nearest
from screwsim.outputs.core import PERFORMANCE
from screwsim.outputs.declared import EFFICIENCY, Figure, Variable
from screwsim.outputs.display import ShownFigure, Value, library, table_html, table_text
from screwsim.outputs.variables import (
    BALANCE,
    LEDGER,
    LEDGER_ENTRY,
    NUMERICS,
    NUMERICS_TEXT,
    ledger_variable,
    sorted_entries,
)


class Figures(dict[str, Any]):
    """A mapping whose names are also attributes: `result.performance.isothermal_efficiency`.

    Attribute access returns a number as a `display.Value` with its unit and meaning, where these are known.
    """

    def __getattr__(self, name: str) -> Any:
        if name not in self:
            raise AttributeError(self.lacks(name))
        value = self[name]
        if isinstance(value, float) and (about := self.described(name)):
            return Value(value, about)
        return value

    def __missing__(self, name: str) -> Any:
        raise KeyError(self.lacks(name))

    def lacks(self, name: str) -> str:
        """Return in words that there is no such figure, with the nearest one or all."""
        offer = nearest(name, self)
        hint = f"did you mean {offer!r}?" if offer else f"known: {', '.join(self)}"
        return f"no figure {name!r}; {hint}"

    def copy(self) -> Self:
        """Return the same figures in a mapping of this kind."""
        return type(self)(self)

    def described(self, name: str) -> ShownFigure | None:
        """Return unit and meaning of a figure; None where they are not known."""
        return None

    def __dir__(self) -> list[str]:
        """Return the figures beside the methods, for completion in editors."""
        return sorted({*super().__dir__(), *self})


class ListedFigures(Figures):
    """Figures that display as one line each, with unit and meaning."""

    def __repr__(self) -> str:
        return table_text(self._rows())

    def _repr_html_(self) -> str:
        return table_html(type(self).__name__.lower(), (), self._rows())

    def _rows(self) -> list[ShownFigure]:
        rows = ((name, self.described(name) or ShownFigure(name, None, "1", "")) for name in self)
        return [about._replace(value=self[name]) for name, about in rows]


class Balance(ListedFigures):
    """Residuals of the balances, and their bound."""

    def described(self, name: str) -> ShownFigure | None:
        """Return unit and meaning of a residual."""
        return ShownFigure(name, None, *BALANCE[name]) if name in BALANCE else None


class Error(ListedFigures):
    """Estimated numerical errors of the figures, each relative to its scale."""

    def described(self, name: str) -> ShownFigure | None:
        """Return unit and meaning of an error."""
        return ShownFigure(name, None, "1", f"relative numerical error of {name.replace('_', ' ')}")


class Numerics(ListedFigures):
    """Effort of the solution: steps, evaluations, times."""

    def described(self, name: str) -> ShownFigure | None:
        """Return unit and meaning of a number."""
        return ShownFigure(name, None, *(NUMERICS.get(name) or Variable("1", NUMERICS_TEXT.get(name, ""))))


class Ledger(ListedFigures):
    """Ledger of the shaft power: totals, and `<quantity>_<effect>` of each effect."""

    def described(self, name: str) -> ShownFigure | None:
        """Return unit and meaning of a total or an entry."""
        return ShownFigure(name, None, *ledger_variable(name))

    def to_pandas(self) -> Any:
        """Return a pandas.DataFrame [SI] with a row an effect, that which destroys most exergy first.

        Its `attrs` have the totals by name, and the `units` of the columns.
        """
        rows = dict(sorted_entries(self))
        made = library("pandas").DataFrame.from_dict(rows, orient="index", columns=list(LEDGER_ENTRY), dtype=float)
        made.index.name = "effect"
        totals = {name: self[name] for name in LEDGER if name in self}
        made.attrs.update(totals, units={name: about.units for name, about in LEDGER_ENTRY.items()})
        return made


def shown(figures: Mapping[str, Any]) -> list[ShownFigure]:
    """Return figures with their values, units and meanings, where these are declared."""
    about: Mapping[str, Figure] = getattr(figures, "about", PERFORMANCE)
    found = []
    for name, value in figures.items():
        found.append(shown_of(about.get(name) or PERFORMANCE.get(name) or Figure(name, "1", ""), value))
    return found


def shown_of(about: Figure, value: Any) -> ShownFigure:
    """Return a value of a figure with the figure's unit and meaning."""
    return ShownFigure(about.name, value, about.units, about.long_name, about.shown, about.scale == EFFICIENCY)
