"""The variables of a results file: their names, their meanings, and the source of their values."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from screwsim import outputs
from screwsim.figures import merged, packed, trace_variable
from screwsim.outputs import CYCLE, NUMERICS_TEXT, STATUSES, Figures, Variable, shown
from screwsim.outputs.derivatives import METHOD_CODES, ComputedDerivatives
from screwsim.results import table as tables
from screwsim.results.netcdf import Layout, flag_attributes, flag_type, number_attributes, set_attributes, text_lines
from screwsim.results.schema import RELATIVE_TO, Axis, Subject, root_attributes, variable_name
from screwsim.results.table import FIGURE_GROUPS, NOT_COMPUTED, TEXT_NAMES, Names, Table

_CASE_TEXTS = {
    "message": "why the case failed or did not close, and the remedy",
    "warnings": "warnings, one per line",
    "notes": "why a figure of a simulated effect has no value, one per line",
}

UNCERTAINTY, CONTRIBUTIONS, CONTRIBUTOR = "uncertainty", "contributions", "contributor"  # groups, and their dimension
DERIVATIVES, NUMBER, UNITS = "derivatives", "number", "number_units"  # group, its dimension, and units of the numbers
VALUE_ATTRIBUTES = number_attributes(Variable("1", f"value of the number, in the unit that {UNITS} says"))
EXACT_ATTRIBUTES = {
    "units": "1",
    "long_name": "0: differences of closed cycles; 1: exact derivatives; 2: quick ones, mostly accurate to 1e-3",
}

Attributes = dict[str, Any]
# in every file, even one of failed cases only
_ALWAYS = tuple(each for each in outputs.PERFORMANCE.values() if not each.needs)
_ALWAYS_OF_STAGES = tuple(  # the same of two stages: those that any gas and any machines have
    outputs.STAGES[name]
    for name in (
        *("intermediate_pressure", "second_suction_temperature", "gas_mass_flow"),
        *("first_shaft_power", "second_shaft_power", "shaft_power", "first_pressure_ratio", "second_pressure_ratio"),
        *("first_discharge_temperature", "discharge_temperature", "isothermal_efficiency", "isentropic_efficiency"),
        "flow_mismatch",
    )
)


@dataclass(frozen=True)
class Column:
    """A variable of the file that is written in pieces; `values` takes its values (cases, …) from a table."""

    data: Any
    values: Callable[[Table], np.ndarray]


def names_of(heads: Iterable[Table], alone: bool = True) -> tuple[Names, dict[str, tuple[str, ...]]]:
    """Return the names of tables, and the distinct words of each of their texts; `alone`: they are of one machine."""
    names, words = Names(), {name: set[str]() for name in TEXT_NAMES}
    for head in heads:
        names = names.joined(head)
        for name in TEXT_NAMES:
            words[name].update(map(text_lines, head.texts[name].words))
    about = merged(names.about, _ALWAYS if alone else _ALWAYS_OF_STAGES)
    changes, sloped = (tuple(each.name for each in about if each.name in of) for of in (names.changes, names.slopes))
    names = replace(names, about=about, changes=changes, slopes=sloped)
    return names, {name: tuple(sorted(several)) for name, several in words.items()}


class Plan:
    """The variables of an open file, created in two steps: all but the texts, whose words are known last."""

    def __init__(self, layout: Layout, subject: Subject, axes: Sequence[Axis], command: str, names: Names) -> None:
        stated = {"effects": ", ".join(names.effects), "states": ", ".join(names.states)}
        set_attributes(layout.file, root_attributes(subject, command) | stated)
        self.layout = layout
        self.names = names
        self._alone = subject.alone
        self.shape = tuple(len(axis.values) for axis in axes)
        self._axes = axes
        self._dimensions = [axis.name for axis in axes]
        self._along = {inner.name for axis in axes for inner in (axis, *axis.joined)}  # in every group
        # coordinates other than the dimensions' own (CF, section 5)
        joined = " ".join(inner.name for axis in axes for inner in axis.joined)
        self._beside = {"coordinates": joined} if joined else {}
        self._groups: dict[str, Any] = {}
        group, there = self._group("inputs"), set(self._along)
        for path, variable, value in subject.inputs:
            name = variable_name(path)
            if name not in there:
                there.add(name)
                about = number_attributes(variable) | {"path": path}
                self.layout.variable(group, name, np.array(value), (), about)
        self.columns = [column for group in FIGURE_GROUPS for column in self._figures(group)]
        self.traces = list(self._cycle()) if names.traces else []
        self.columns += list(self._ledger()) if names.ledger else []
        self.columns += list(self._uncertainty()) if names.inputs else []
        self.changes = list(self._changes()) if names.inputs else []
        self.slopes = list(self._slopes()) if names.numbers else []

    def texts(self, words: Mapping[str, Sequence[str]]) -> list[Column]:
        """Create the variables of texts, `words` being the distinct ones; return those to be given values later."""
        found = []
        own = {"numerics": NUMERICS_TEXT} if self._alone else {}
        for group, texts in ({"performance": _CASE_TEXTS} | own).items():
            for text, long_name in texts.items():
                about = words[text], self.shape, self._dimensions, long_name
                data = self.layout.texts(self._groups[group], text, *about)
                if data is not None:
                    set_attributes(data, self._beside)
                    found.append(Column(data, _numbers(text, words[text])))
        return found

    def _group(self, name: str) -> Any:
        """Create a group with its own copy of the axes."""
        group = self._groups[name] = self.layout.group(name)
        for axis in self._axes:
            values, about = _coordinate(axis)
            self.layout.coordinate(group, axis.name, values, about)
        for axis in self._axes:
            for inner in axis.joined:
                values, about = _coordinate(inner)
                self.layout.variable(group, inner.name, values, (axis.name,), about)
        return group

    def _created(
        self, group: Any, told: Iterable[tuple[str, Attributes]], values: Callable[[Table, str], np.ndarray], **own: int
    ) -> Iterator[Column]:
        """Create variables with the attributes `told`, over the cases and over dimensions of the group's `own`.

        A variable with the name of an axis is that axis, as oil_supply_temperature where oil_supply.temperature varies.
        """
        shape, dimensions = (*self.shape, *own.values()), (*self._dimensions, *own)
        for name, about in told:
            if name not in self._along:
                data = self.layout.empty(group, name, shape, float, dimensions, about | self._beside)
                yield Column(data, lambda table, name=name: values(table, name))

    def _figures(self, name: str) -> Iterator[Column]:
        """Create the variables of a group of figures."""
        group = self._group(name)
        if name == "performance":
            about = flag_attributes(STATUSES, "how the case ended", NOT_COMPUTED) | self._beside
            data = self.layout.empty(group, "status", self.shape, np.int8, self._dimensions, about)
            yield Column(data, lambda table: table.status)
        yield from self._created(group, self._about(name), lambda table, figure: table.column(name, figure))

    def _about(self, group: str) -> Iterator[tuple[str, Attributes]]:
        """Yield the figures of a group with their attributes; for an error these include its scale."""
        if group == "error":
            for each in self.names.about:
                about = Variable("1", f"estimated relative numerical error of {each.name}")
                yield each.name, number_attributes(about) | {RELATIVE_TO: packed(each.scale)}
            return
        performance = {each.name: Variable(each.units, each.long_name) for each in self.names.about}
        groups = {"performance": performance, "balance": outputs.BALANCE, "numerics": outputs.NUMERICS}
        for name, about in groups[group].items() if group == "performance" or self._alone else ():
            yield name, number_attributes(about)

    def _cycle(self) -> Iterator[Column]:
        """Create the variables of the traces."""
        group, points = self._group("cycle"), len(self.names.angle)
        self.layout.coordinate(group, "angle", np.array(self.names.angle), CYCLE["angle"]._asdict())
        told = ((name, number_attributes(trace_variable(name))) for name in self.names.traces)
        return self._created(group, told, lambda table, name: table.part("traces", name, points), angle=points)

    def _ledger(self) -> Iterator[Column]:
        told = ((name, number_attributes(outputs.ledger_variable(name))) for name in self.names.ledger)
        return self._created(self._group("ledger"), told, lambda table, name: table.part("ledger", name))

    def _uncertainty(self) -> Iterator[Column]:
        """Create the standard uncertainty of each figure due to the tolerances of the inputs."""
        told = self._uncertain("standard uncertainty of {} by the tolerances of the inputs")
        group = self._group(UNCERTAINTY)
        return self._created(group, told, lambda table, name: tables.standard_of(self._changed(table, name)))

    def _changes(self) -> Iterator[Column]:
        """Create the change of these figures by each input, over the inputs."""
        group, labels = self._group(CONTRIBUTIONS), self.names.inputs
        self.layout.labelled(group, CONTRIBUTOR, labels, "input with a tolerance, or inputs that err together")
        told = self._uncertain("change of {} by one standard uncertainty of the input")
        return self._created(group, told, self._changed, **{CONTRIBUTOR: len(labels)})

    def _slopes(self) -> Iterator[Column]:
        """Create the derivatives of the figures over the numbers; values and methods may differ between cases."""
        group, units = self._group(DERIVATIVES), dict(self.names.numbers)
        paths, along = list(units), (*self._dimensions, NUMBER)
        data, numbers = _numbered(self.layout, group, units, (*self.shape, len(units)), along)
        yield Column(data, lambda table: np.tile(numbers, (len(table), 1)))
        units_of = {each.name: each.units for each in self.names.about}
        told = {tables.VALUE: VALUE_ATTRIBUTES, tables.EXACT: EXACT_ATTRIBUTES}
        told |= {name: _slope_attributes(name, units_of[name]) for name in self.names.slopes}
        own = {NUMBER: len(units)}
        yield from self._created(group, told.items(), partial(tables.slopes_of, numbers=paths), **own)

    def _uncertain(self, meaning: str) -> Iterator[tuple[str, Attributes]]:
        """Yield the figures that have an uncertainty, with the attributes of a variable of this `meaning` of them."""
        for each in self.names.about:
            if each.name in self.names.changes:
                yield each.name, number_attributes(Variable(each.units, meaning.format(each.name)))

    def _changed(self, table: Table, name: str) -> np.ndarray:
        return table.part("changes", name, len(self.names.inputs))


def _coordinate(axis: Axis) -> tuple[np.ndarray, dict[str, Any]]:
    """Return the coordinate of an axis; texts are stored as indices, with their words in the attributes."""
    if axis.values.dtype.kind != "U":
        return axis.values, axis.about
    words = [str(word) for word in axis.values]
    different = list(dict.fromkeys(words))
    about = axis.about | flag_attributes(different, axis.long_name) | {"labels": "\n".join(different)}
    return np.array([different.index(word) for word in words], flag_type(len(different))), about


def _numbers(name: str, words: Sequence[str]) -> Callable[[Table], np.ndarray]:
    """Return a function that gives the indices of a table's texts in `words`."""
    place = {word: index for index, word in enumerate(words)}

    def numbers(table: Table) -> np.ndarray:
        texts = table.texts[name]
        return tables.renumbered(texts._replace(words=tuple(map(text_lines, texts.words))), place)

    return numbers


def write_slopes(layout: Layout, found: ComputedDerivatives, performance: Figures) -> None:
    """Write the group `derivatives` of one result: its figures by the numbers of its scene."""
    group, units = layout.group(DERIVATIVES), {path: found.units[path] for path in found.values}
    data, numbers = _numbered(layout, group, units, (len(units),), (NUMBER,))
    data.write(numbers)
    values = np.array(list(found.values.values()), float)
    layout.variable(group, tables.VALUE, values, (NUMBER,), VALUE_ATTRIBUTES)
    exact = np.array([METHOD_CODES[found.method[path]] for path in units], np.int8)
    layout.variable(group, tables.EXACT, exact, (NUMBER,), EXACT_ATTRIBUTES)
    units_of = {each.name: each.units for each in shown(performance)}
    for figure, slopes in found.derivatives.items():
        values = np.array([slopes.get(path, np.nan) for path in units], float)
        layout.variable(group, figure, values, (NUMBER,), _slope_attributes(figure, units_of[figure]))


def _numbered(
    layout: Layout, group: Any, units: Mapping[str, str], shape: tuple[int, ...], dimensions: Sequence[str]
) -> tuple[Any, np.ndarray]:
    """Create the coordinate of numbers {path: SI unit}, and the variable of their units; return it with its values."""
    layout.labelled(group, NUMBER, list(units), "number of the scene")
    words = sorted(set(units.values()))
    data = layout.texts(group, UNITS, words, shape, dimensions, "SI unit of the number")
    return data, np.array([words.index(unit) for unit in units.values()], np.int32)


def _slope_attributes(figure: str, units: str) -> dict[str, object]:
    """Return the attributes of a figure's derivatives; `units` are those of the figure."""
    return number_attributes(Variable(units, f"derivative of {figure} by the number, per unit of it ({UNITS})"))
