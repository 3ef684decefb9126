"""A map as a table: what it is made of, and its values at other points, by the names of its inputs."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from screwsim.export.hermite import Array, Grid, evaluate
from screwsim.export.inputs import Input, range_text, unit_after_number
from screwsim.inputs.arguments import shown
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import counted
from screwsim.outputs import Figure
from screwsim.outputs.display import About, Brief
from screwsim.scene.fields import unknown_key


@dataclass(frozen=True, eq=False, repr=False)
class MapTable(Brief):
    """A map: `grid` over the inputs' coordinates; relative `errors` of the outputs, and how they were found.

    `cases` is the number of cases simulated; `why` says what became of the first node or check point without a closed
    cycle. `warnings` are those of the simulated cases, each with their number. `met` tells whether the requested error
    is kept.
    """

    title: str
    inputs: tuple[Input, ...]
    outputs: tuple[Figure, ...]
    grid: Grid
    wanted: float | None
    scene_yaml: str
    errors: tuple[float, ...] = (math.inf,)
    checked: int = 0
    how: str = ""
    cases: int = 0
    why: str = ""
    warnings: tuple[tuple[int, str], ...] = ()
    about: dict[str, Any] = field(default_factory=dict)

    @property
    def nodes(self) -> tuple[Array, ...]:
        """The values [SI] of each input at the nodes."""
        return tuple(one.at(u) for one, u in zip(self.inputs, self.grid.nodes, strict=True))

    @property
    def not_ok(self) -> int:
        """The number of nodes without a closed cycle."""
        return int((~self.grid.sound).sum())

    @property
    def error(self) -> float:
        """The largest error."""
        return max(self.errors)

    @property
    def error_in_words(self) -> str:
        """The largest error and how it was found; if it is unknown, why."""
        return f"{self.error:.2g}, {self.how}" if math.isfinite(self.error) else self.how

    @property
    def met(self) -> bool:
        return self.wanted is None or self.error <= self.wanted

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """Return the outputs [SI] at inputs (n, inputs) [SI], and whether each point is inside."""
        x = np.atleast_2d(np.asarray(x, float))
        clipped = np.column_stack([np.clip(x[:, i], one.low, one.high) for i, one in enumerate(self.inputs)])
        outside = np.any(np.abs(x - clipped) > 1e-9 * np.abs(clipped), axis=1)
        u = np.column_stack([variable.coordinate(clipped[:, i]) for i, variable in enumerate(self.inputs)])
        values, inside = evaluate(self.grid, u)
        return values, inside & ~outside

    def evaluate(self, **inputs: Any) -> dict[str, np.ma.MaskedArray]:
        """Return each figure [SI] at inputs [SI], numbers or arrays that broadcast; masked where it is not valid.

            table.evaluate(evaporating_temperature=273.15, condensing_temperature=T_c, slide_position=0.2)

        Not valid is outside the ranges, and in cells of which a corner did not close. Raise UsageError unless each
        input of the map is given, by its name.
        """
        columns = [_numbers(name, value) for name, value in self._given(inputs).items()]
        try:
            spread = np.broadcast_arrays(*columns)
        except ValueError:
            sizes = ", ".join(f"{one.name} {column.shape}" for one, column in zip(self.inputs, columns, strict=True))
            what = f"the shapes of the inputs differ: {sizes}"
            raise UsageError(f"{what} (pass arrays of one shape, or numbers)") from None
        values, inside = self(np.column_stack([column.ravel() for column in spread]))
        shape = spread[0].shape
        named, hidden = zip(self.outputs, values.T, strict=True), ~inside.reshape(shape)
        return {output.name: np.ma.array(column.reshape(shape), mask=hidden) for output, column in named}

    def _given(self, inputs: Mapping[str, Any]) -> dict[str, Any]:
        """Return the given inputs in the order of the map's; raise UsageError for an unknown or a missing one."""
        names = [one.name for one in self.inputs]
        one_of = f"one of {', '.join(names)}"
        for name in inputs:
            if name not in names:
                raise UsageError(f"{name} {unknown_key(name, names, one_of)}")
        missing = [one for one in self.inputs if one.name not in inputs]
        if missing:
            ranges = ", ".join(f"{one.name} between {range_text(one)}" for one in missing)
            raise UsageError(f"the map needs every input of it, and lacks {ranges} (pass it by its name)")
        return {name: inputs[name] for name in names}

    def where_open(self) -> str:
        """Return the inputs' ranges in which the nodes without a closed cycle lie; empty where that is everywhere."""
        found = []
        for axis, (one, nodes) in enumerate(zip(self.inputs, self.nodes, strict=True)):
            others = tuple(other for other in range(len(self.inputs)) if other != axis)
            open_ = np.flatnonzero(~self.grid.sound.all(axis=others))
            if 0 < len(open_) < len(nodes):
                low, high = (float(nodes[each]) for each in (open_[0], open_[-1]))
                ends = f"{low:.6g} … {high:.6g}" if high > low else f"{low:.6g}"
                found.append(f"{one.name} {ends}{unit_after_number(one.units)}")
        return ", ".join(found)

    def warnings_told(self) -> list[str]:
        """Return the warnings of the simulated cases as sentences, each with their number."""
        return [f"warning in {counted(count, 'case')} of the map: {text}" for count, text in self.warnings]

    def _about(self) -> About:
        notes = [f"{one.name} {range_text(one)}: {one.long_name}" for one in self.inputs]
        rows = [
            [output.name, unit_after_number(output.units).strip(), f"{error:.2g}", output.long_name]
            for output, error in zip(self.outputs, self.errors, strict=True)
        ]
        notes += [f"errors: {self.how}", *self.warnings_told()]
        return About(f"Map: {self.title or 'compressor'}", notes, ["figure", "unit", "error", "meaning"], rows)


def _numbers(name: str, value: Any) -> Array:
    """Return an input's values as an array of floats; raise UsageError where they are none."""
    try:
        return np.asarray(np.ma.filled(np.ma.asarray(value, float), np.nan))
    except (TypeError, ValueError):
        what = f"{shown(value)} is neither a number nor an array of them"
        raise UsageError(f"{name}: {what} (pass values in SI)") from None
