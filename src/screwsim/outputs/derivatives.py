"""Derivatives of a result's figures by the numbers of its scene, computed on first use."""

from collections.abc import Callable, Collection, Iterator, Mapping
from functools import cached_property
from typing import Any, Protocol, Self

from screwsim.inputs.suggestions import nearest
from screwsim.outputs import display
from screwsim.outputs.display import si_unit
from screwsim.outputs.figures import Figures, shown

EXACT, ROUGH, DIFFERENCES = "exact", "quick", "differences"  # methods
METHOD_CODES = {DIFFERENCES: 0, EXACT: 1, ROUGH: 2}  # codes of the methods in files
PACKAGE_FIGURES = ("package_specific_power", "free_air_delivered", "package_input_power")  # in texts, if all present
USUAL_FIGURES = ("isothermal_efficiency", "isentropic_efficiency", "gas_mass_flow", "shaft_power")  # else, if present
MOST_PATHS = 15  # largest number of paths in a text, the most influential first


def usual_figures(there: Collection[str]) -> list[str]:
    """Return those of the figures there that a text shows by default: of an air package its own."""
    package = set(PACKAGE_FIGURES) <= set(there)
    return [name for name in (PACKAGE_FIGURES if package else USUAL_FIGURES) if name in there]


class ComputedDerivatives(Protocol):
    """Computed derivatives [SI] by figure and path, with the numbers [SI] at the paths and their SI units.

    `method` gives 'exact', 'quick' (usually good to 1e-3) or 'differences' by path; `left_out` says why paths have
    none.
    """

    @property
    def values(self) -> Mapping[str, float]: ...
    @property
    def units(self) -> Mapping[str, str]: ...
    @property
    def derivatives(self) -> Mapping[str, Mapping[str, float]]: ...
    @property
    def method(self) -> Mapping[str, str]: ...
    @property
    def left_out(self) -> Mapping[str, str]: ...


class Derivatives(Mapping[tuple[str, str], float]):
    """Derivatives [SI] by (figure, path of the scene): `result.derivatives["shaft_power", "operation.speed"]`.

    The end of a path is enough where it is unambiguous: "tip_leakage.gap". All are computed when the first is asked
    for; a KeyError says which exist, and why the requested one does not. `scene` is that of the result; None where the
    result does not know it.
    """

    def __init__(
        self,
        find: Callable[[], ComputedDerivatives] | None = None,
        performance: Figures | None = None,
        scene: Any = None,
    ) -> None:
        self._find, self.scene = find, scene
        self._performance = Figures() if performance is None else performance

    @classmethod
    def of(cls, found: ComputedDerivatives, performance: Figures, scene: Any = None) -> Self:
        """Return derivatives that have already been computed."""
        known = cls(lambda: found, performance, scene)
        known.__dict__["found"] = found
        return known

    @property
    def known(self) -> ComputedDerivatives | None:
        """What has already been computed; None where it would have to be computed."""
        return self.__dict__.get("found")

    @cached_property
    def found(self) -> ComputedDerivatives:
        """All results: the derivatives, the numbers themselves, and the method for each."""
        if self._find is None:
            raise KeyError(
                "this result is not linked to its scene (screwsim.sensitivities(scene) finds derivatives; a result of "
                "screwsim.simulate has them)"
            )
        return self._find()

    def __getitem__(self, key: tuple[str, str]) -> float:
        figure, path = self._key(key)
        return self.found.derivatives[figure][path]

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return ((figure, path) for figure, slopes in self.found.derivatives.items() for path in slopes)

    def __len__(self) -> int:
        return sum(map(len, self.found.derivatives.values()))

    def units(self, figure: str, path: str) -> str:
        """Return the unit of a derivative as people write it: 'W/m' for a power by a length."""
        figure, path = self._key((figure, path))
        return unit_of_ratio(self._units()[figure], self.found.units[path])

    def relative(self, figure: str, path: str) -> float | None:
        """Return a derivative in percent per percent; None where the figure or the number is zero or missing."""
        figure, path = self._key((figure, path))
        value, number = self._performance.get(figure), self.found.values[path]
        return self.found.derivatives[figure][path] * number / value if value and number else None

    def to_pandas(self) -> Any:
        """Return the derivatives as a pandas.DataFrame, figures × paths [SI]; `attrs` has the SI units of both."""
        found = self.found
        frame = display.library("pandas").DataFrame.from_dict(dict(found.derivatives), orient="index")
        frame = frame.reindex(columns=list(found.values))
        frame.index.name, frame.columns.name = "figure", "path"
        units = self._units()
        frame.attrs.update(
            figure_units={name: units[name] for name in frame.index}, path_units=dict(found.units), values=found.values
        )
        return frame

    def __repr__(self) -> str:
        if self._find is None:
            return "Derivatives: none (the result is not linked to its scene)"
        found = self.found
        figures = usual_figures(found.derivatives) or list(found.derivatives)[:3]
        size = f"{len(found.derivatives)} figures by {len(found.values)} numbers"
        if not figures:
            return f"Derivatives: none ({size})"
        paths = sorted(found.values, key=lambda path: -self._weight(figures[0], path))[:MOST_PATHS]
        rows = [["", *figures], *([path, *(self._told(figure, path) for figure in figures)] for path in paths)]
        return "\n".join([f"Derivatives: {size}, SI units", *display.aligned(rows)])

    def __reduce__(self) -> tuple[Any, ...]:
        own = self._performance, self.scene
        return (Derivatives, (self._find, *own)) if self.known is None else (Derivatives.of, (self.known, *own))

    def _weight(self, figure: str, path: str) -> float:
        return abs(self.relative(figure, path) or 0.0) if path in self.found.derivatives[figure] else 0.0

    def _told(self, figure: str, path: str) -> str:
        slope = self.found.derivatives[figure].get(path)
        return "" if slope is None else f"{slope:.4g} {self.units(figure, path)}".rstrip()

    def _units(self) -> dict[str, str]:
        return {each.name: each.units for each in shown(self._performance)}

    def _key(self, key: tuple[str, str]) -> tuple[str, str]:
        """Return figure and full path; raise KeyError that says what exists."""
        if not isinstance(key, tuple) or len(key) != 2:
            raise KeyError(f'{key!r} is not a figure with a path (write ["shaft_power", "operation.speed"])')
        figure, path = key
        found = self.found
        if not found.derivatives:
            raise KeyError("no derivatives: the point has no figures (result.status, result.message say why)")
        if figure not in found.derivatives:
            raise KeyError(_unknown_key(f"no derivatives of {figure!r}", figure, list(found.derivatives)))
        same = [known for known in found.values if known == path or known.endswith(f".{path}")]
        whole = path if path in same else same[0] if len(same) == 1 else None
        if whole is None and same:
            raise KeyError(f"{path!r} may be {', '.join(same)} (write the whole path)")
        if whole is None or whole not in found.derivatives[figure]:
            why = found.left_out.get(path, "")
            nothing = f"no derivative by {path!r}"
            raise KeyError(f"{nothing}: {why}" if why else _unknown_key(nothing, path, list(found.values)))
        return figure, whole


def unit_of_ratio(above: str, below: str) -> str:
    """Return the unit of one quantity over another, as people write it."""
    if below == "1":
        return si_unit(above)
    under = si_unit(below)
    under = f"({under})" if " " in under or "/" in under else under
    over = si_unit(above) or "1"
    return f"{over}/{under}" if "/" not in over else f"({over})/{under}"


def _unknown_key(what: str, name: str, known: list[str]) -> str:
    offer = nearest(name, known)
    return f"{what}; {f'did you mean {offer!r}?' if offer else 'there are: ' + ', '.join(known)}"
