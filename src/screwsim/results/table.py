"""Results of many cases as columns: a compact form to send between processes, to store and to write."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, reduce
from typing import Any, NamedTuple, Protocol

import numpy as np

from screwsim.figures import declared, known, known_traces, merged
from screwsim.inputs.faults import UsageError
from screwsim.outputs import BALANCE, LEDGER, NUMERICS, NUMERICS_TEXT, STATUSES, Figure, Result, names_of
from screwsim.outputs.derivatives import METHOD_CODES

FIGURE_GROUPS = ("performance", "balance", "error", "numerics")
Columns = Mapping[tuple[str, str], int]  # column of (group, figure)
TEXT_NAMES = ("message", "warnings", "notes", *NUMERICS_TEXT)
NOT_COMPUTED = -1  # status of a case without a result
MAPPING_FIELDS = ("traces", "ledger", "changes", "slopes")  # mappings of a table from names to arrays, one row per case
VALUE, EXACT = "number_value", "number_exact"  # variables beside the derivatives: the number, its method
TOGETHER = " + "  # between the paths of inputs that err together, in the name that they share


@lru_cache(maxsize=64)
def columns_of(names: tuple[str, ...]) -> Columns:
    """Return the column of each figure of each group; `names` are the figures of performance and of its errors."""
    groups = zip(FIGURE_GROUPS, (names, tuple(BALANCE), names, tuple(NUMERICS)), strict=True)
    return {figure: i for i, figure in enumerate((group, name) for group, names in groups for name in names)}


class CaseTexts(NamedTuple):
    """One text per case: its index `number` into `words`, int32 (cases,); most cases share their texts."""

    words: tuple[str, ...]
    number: np.ndarray


@dataclass(frozen=True)
class Table:
    """Results of consecutive cases, one row per case, in SI units.

    `status` is int8 (cases,). `about` has the performance figures that any of the cases calls for; `figures` is float64
    (cases, `columns_of` these), NaN where a figure is None or not called for; `texts` is {name: Texts}.

    `angle` [degree] (points,) is empty without traces; `traces` {name: float64 (cases, points)}, NaN for a case without
    a cycle; `ledger` {name: float64 (cases,)}, present with the traces, NaN for a case without one.

    `inputs` names the inputs with a tolerance; `changes` {figure: float64 (cases, inputs)} is the change by one
    standard uncertainty of each, NaN for a case without figures and for an input without a derivative.

    `numbers` {path: SI unit} are those that figures have derivatives by; `slopes` {figure: float64 (cases, numbers)}
    are these derivatives, NaN where there is none, with the numbers themselves (`VALUE`) and the methods (`EXACT`).
    """

    status: np.ndarray
    figures: np.ndarray
    texts: Mapping[str, CaseTexts]
    effects: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    angle: np.ndarray = field(default_factory=lambda: np.empty(0))
    traces: Mapping[str, np.ndarray] = field(default_factory=dict)
    ledger: Mapping[str, np.ndarray] = field(default_factory=dict)
    about: tuple[Figure, ...] = ()
    inputs: tuple[str, ...] = ()
    changes: Mapping[str, np.ndarray] = field(default_factory=dict)
    numbers: Mapping[str, str] = field(default_factory=dict)
    slopes: Mapping[str, np.ndarray] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.status)

    @property
    def size(self) -> int:
        """Size of the numeric arrays [byte]."""
        arrays = [self.status, self.figures, self.angle, *(texts.number for texts in self.texts.values())]
        arrays += [array for part in MAPPING_FIELDS for array in getattr(self, part).values()]
        return sum(array.nbytes for array in arrays)

    def column(self, group: str, name: str) -> np.ndarray:
        """Return one figure of all cases (cases,); NaN where no case calls for it."""
        place = columns_of(names_of(self.about)).get((group, name))
        return np.full(len(self), np.nan) if place is None else self.figures[:, place]

    def rows(self, chosen: slice | np.ndarray) -> Table:
        """Return a table of some of the cases."""
        texts = {name: CaseTexts(text.words, text.number[chosen]) for name, text in self.texts.items()}
        by_name = {part: {name: v[chosen] for name, v in getattr(self, part).items()} for part in MAPPING_FIELDS}
        return replace(self, status=self.status[chosen], figures=self.figures[chosen], texts=texts, **by_name)

    def part(self, part: str, name: str, *width: int) -> np.ndarray:
        """Return an array of one of the mappings `MAPPING_FIELDS` (cases, width); NaN if it lacks that name."""
        found = getattr(self, part)
        return found[name] if name in found else np.full((len(self), *width), np.nan)


class Tables(Protocol):
    """All cases of a sweep as consecutive tables, read one after another."""

    cases: int

    def heads(self) -> Iterator[Table]:
        """Yield the tables in order, without figures and traces: only the names and texts that they contain."""
        ...

    def tables(self, traces: bool) -> Iterator[Table]:
        """Yield the tables in order, with or without traces."""
        ...


class InMemory:
    """A single table as the source of all cases."""

    def __init__(self, table: Table) -> None:
        self.cases = len(table)
        self._table = table

    def heads(self) -> Iterator[Table]:
        """Yield the table."""
        yield self._table

    def tables(self, traces: bool) -> Iterator[Table]:
        """Yield the table."""
        yield self._table


def table_of(results: Sequence[Result], *, keep_cycle: bool, keep_slopes: bool = False) -> Table:
    """Return the columns of results; raise ValueError for a figure of another group that `outputs` does not declare.

    `keep_slopes` stores the derivatives that are known already; none are computed.
    """
    about = reduce(merged, {tuple(each): each.values() for each in map(_about, results)}.values(), ())
    names = names_of(about)
    figures = np.full((len(results), len(columns_of(names))), np.nan)
    for row, result in enumerate(results):
        for group in FIGURE_GROUPS:
            own = getattr(result, group)
            numbers, columns = _columns(group, tuple(own), names)
            figures[row, columns] = np.array([own[name] for name in numbers], float)  # None becomes NaN
    with_cycle = [row for row, result in enumerate(results) if keep_cycle and len(result.cycle)]
    angle = np.asarray(results[with_cycle[0]].cycle["angle"], float) if with_cycle else np.empty(0)
    return Table(
        status=np.array([STATUSES.index(result.status) for result in results], np.int8),
        figures=figures,
        texts={name: numbered(_text(result, name) for result in results) for name in TEXT_NAMES},
        effects=next((result.effects for result in results if result.effects), ()),
        states=next((result.states for result in results if result.states), ()),
        angle=angle,
        traces=_traces(results, with_cycle, angle),
        ledger=_ledgers(results) if keep_cycle else {},
        about=about,
        **_uncertainties(results),
        **(_slopes(results) if keep_slopes else {}),
    )


def _about(result: Result) -> Mapping[str, Figure]:
    """Return the declarations of a result's figures: those that its scene calls for if known, else those it has."""
    called = getattr(result.performance, "about", {})
    names = result.performance | result.error
    return called or {name: declared(name) for name in (*(each for each in known() if each in names), *names)}


@lru_cache(maxsize=64)
def _columns(group: str, names: tuple[str, ...], about: tuple[str, ...]) -> tuple[list[str], np.ndarray]:
    """Return the names of a group's numeric figures, and their columns."""
    numbers, columns = [name for name in names if name not in NUMERICS_TEXT], columns_of(about)
    for name in numbers:
        if (group, name) not in columns:
            raise ValueError(f"{group}.{name} has no entry in screwsim.outputs (add its unit and meaning there)")
    return numbers, np.array([columns[group, name] for name in numbers], np.intp)


def warnings_at(table: Table, row: int) -> list[str]:
    """Return the warnings of the case in a row."""
    texts = table.texts["warnings"]
    return [text for text in texts.words[texts.number[row]].split("\n") if text]


def numbered(texts: Iterable[str]) -> CaseTexts:
    """Return texts as indices into their distinct ones, in order of first appearance."""
    found: dict[str, int] = {}
    number = np.array([found.setdefault(text, len(found)) for text in texts], np.int32)
    return CaseTexts(tuple(found), number)


def _text(result: Result, name: str) -> str:
    if name == "message":
        return result.message
    if name == "warnings":
        return "\n".join(result.warnings)
    if name == "notes":
        return "\n".join(f"{figure}: {why}" for figure, why in result.notes.items())
    return str(result.numerics.get(name) or "")


def trace_names(names: Iterable[str]) -> tuple[str, ...]:
    """Return the names of traces except the angle in a fixed order: the program's own first."""
    found = set(names) - {"angle"}
    known = [name for name in known_traces() if name in found]
    return (*known, *sorted(found.difference(known)))


def _traces(results: Sequence[Result], rows: Sequence[int], angle: np.ndarray) -> dict[str, np.ndarray]:
    names = trace_names(name for row in rows for name in results[row].cycle)
    traces = {name: np.full((len(results), len(angle)), np.nan) for name in names}
    for row in rows:
        same_angles(angle, np.asarray(results[row].cycle["angle"], float))
        for name in trace_names(results[row].cycle):
            traces[name][row] = results[row].cycle[name]
    return traces


def ledger_names(names: Iterable[str]) -> tuple[str, ...]:
    """Return the names of a ledger: totals first, then the entries in order of appearance."""
    found = dict.fromkeys(names)
    return (*(name for name in LEDGER if name in found), *(name for name in found if name not in LEDGER))


def _ledgers(results: Sequence[Result]) -> dict[str, np.ndarray]:
    names = ledger_names(name for result in results for name in result.ledger)
    rows = [[result.ledger.get(name) for result in results] for name in names]
    return {name: np.array(row, float) for name, row in zip(names, rows, strict=True)}  # None becomes NaN


def _uncertainties(results: Sequence[Result]) -> dict[str, Any]:
    """Return the inputs with tolerances and the change by each, where results have them."""
    told = {row: result.uncertainty for row, result in enumerate(results) if "figures" in result.uncertainty}
    if not told:
        return {}
    inputs = tuple(TOGETHER.join(group) for group in next(iter(told.values()))["groups"])
    changes: dict[str, np.ndarray] = {}
    for row, each in told.items():
        places = {tuple(group): place for place, group in enumerate(each["groups"])}
        lost = [place for group, place in places.items() if not set(group) - each["left_out"].keys()]
        for name, spread in each["figures"].items():
            there = changes.setdefault(name, np.full((len(results), len(inputs)), np.nan))[row]
            there[:] = 0.0
            there[lost] = np.nan
            for one in spread["contributors"]:
                place = next(at for group, at in places.items() if set(one["paths"]) <= set(group))
                there[place] = one["change"] / each["coverage_factor"]
    return {"inputs": inputs, "changes": changes}


def _slopes(results: Sequence[Result]) -> dict[str, Any]:
    """Return the numbers and the derivatives by them, where results have some."""
    told = {row: found for row, result in enumerate(results) if (found := result.derivatives.known) is not None}
    numbers = {path: unit for found in told.values() for path, unit in found.units.items()}
    slopes: dict[str, np.ndarray] = {}
    for row, found in told.items():
        about = {VALUE: found.values, EXACT: {path: float(METHOD_CODES[way]) for path, way in found.method.items()}}
        for name, by_path in {**about, **found.derivatives}.items():
            there = slopes.setdefault(name, np.full((len(results), len(numbers)), np.nan))
            there[row] = [by_path.get(path, np.nan) for path in numbers]
    return {"numbers": numbers, "slopes": slopes}


def slopes_of(table: Table, name: str, numbers: Iterable[str]) -> np.ndarray:
    """Return the derivatives of a figure by the given numbers (cases, numbers); NaN where the table has none."""
    wanted, there = list(numbers), list(table.numbers)
    found = np.full((len(table), len(wanted)), np.nan)
    if name in table.slopes:
        for place, path in enumerate(wanted):
            if path in table.numbers:
                found[:, place] = table.slopes[name][:, there.index(path)]
    return found


def standard_of(changes: np.ndarray) -> np.ndarray:
    """Return the standard uncertainty (…) from the changes by independent inputs (…, inputs): their squares add."""
    some = np.isfinite(changes).any(axis=-1)
    return np.where(some, np.sqrt(np.nansum(np.square(changes), axis=-1)), np.nan)


def same_angles(angle: np.ndarray, other: np.ndarray) -> None:
    """Raise UsageError unless both grids agree (to 1e-9 degree): the traces of a sweep share one coordinate."""
    if angle.shape != other.shape or not np.allclose(angle, other, rtol=0.0, atol=1e-9):
        lives = f"{angle[-1]:g} and {other[-1]:g} deg"
        what = f"chambers live {lives} in these cases, so their traces share no angles"
        raise UsageError(f"output.keep: {what} (write output.keep: performance)")


@dataclass(frozen=True)
class Names:
    """Combined contents of several tables: figures, effects, states, angles, and the names in a `Table`'s mappings."""

    about: tuple[Figure, ...] = ()
    effects: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    angle: tuple[float, ...] = ()
    traces: tuple[str, ...] = ()
    ledger: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()  # with tolerances
    changes: tuple[str, ...] = ()  # figures whose uncertainty they determine
    numbers: tuple[tuple[str, str], ...] = ()  # paths of the derivatives' numbers, and their SI units
    slopes: tuple[str, ...] = ()  # figures that have derivatives

    def joined(self, table: Table) -> Names:
        """Return these names with those of one more table; raise UsageError if its traces have other angles."""
        if self.angle and table.angle.size:
            same_angles(np.array(self.angle), table.angle)
        return Names(
            self.about if table.about == self.about else merged(self.about, table.about),
            self.effects or table.effects,
            self.states or table.states,
            self.angle or tuple(table.angle.tolist()),
            trace_names((*self.traces, *table.traces)),
            ledger_names((*self.ledger, *table.ledger)),
            self.inputs or table.inputs,
            tuple(dict.fromkeys((*self.changes, *table.changes))),
            tuple({**dict(self.numbers), **table.numbers}.items()),
            tuple(dict.fromkeys((*self.slopes, *table.slopes))),
        )


def join(tables: Sequence[Table]) -> Table:
    """Return consecutive tables as one table."""
    names = reduce(Names.joined, tables, Names())

    def whole(part: str, *width: int) -> dict[str, np.ndarray]:
        every = getattr(names, part)
        return {name: np.concatenate([table.part(part, name, *width) for table in tables]) for name in every}

    paths = [path for path, _ in names.numbers]
    return Table(
        status=np.concatenate([table.status for table in tables]),
        figures=np.concatenate([_figures_of(table, names.about) for table in tables]),
        texts={name: _joined_texts([table.texts[name] for table in tables]) for name in TEXT_NAMES},
        effects=names.effects,
        states=names.states,
        angle=np.array(names.angle, float),
        traces=whole("traces", len(names.angle)),
        ledger=whole("ledger"),
        about=names.about,
        inputs=names.inputs,
        changes=whole("changes", len(names.inputs)),
        numbers=dict(names.numbers),
        slopes={name: np.concatenate([slopes_of(table, name, paths) for table in tables]) for name in names.slopes},
    )


def _figures_of(table: Table, about: tuple[Figure, ...]) -> np.ndarray:
    """Return a table's figures in the columns of all figures `about`, of which it has some."""
    if table.about == about:
        return table.figures
    return np.column_stack([table.column(*figure) for figure in columns_of(names_of(about))])


def _joined_texts(parts: Sequence[CaseTexts]) -> CaseTexts:
    place = {word: i for i, word in enumerate(dict.fromkeys(word for part in parts for word in part.words))}
    return CaseTexts(tuple(place), np.concatenate([renumbered(part, place) for part in parts]))


def renumbered(texts: CaseTexts, place: Mapping[str, int]) -> np.ndarray:
    """Return the indices of texts in another list of words; `place` is the new index of each word."""
    return np.array([place[word] for word in texts.words], np.int32)[texts.number]


def regrouped(tables: Iterable[Table], sizes: Iterable[int]) -> Iterator[Table]:
    """Yield the cases of consecutive tables again, in tables of the given sizes."""
    source = iter(tables)
    held: list[Table] = []
    for size in sizes:
        while sum(map(len, held)) < size:
            held.append(next(source))
        whole = join(held) if len(held) > 1 else held[0]
        yield whole if len(whole) == size else whole.rows(slice(0, size))
        held = [whole.rows(slice(size, None))] if len(whole) > size else []
