"""Results to HDF5: one file, written under a temporary name and renamed, so that it is complete or absent."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import KNOCK_OUT, KNOCK_OUT_STATUSES, Figures, Result
from screwsim.outputs.derivatives import ComputedDerivatives
from screwsim.results import atomic
from screwsim.results.guarded import GuardedFile
from screwsim.results.netcdf import Layout, Selection, chunks_of, flag_attributes, number_attributes, text_lines
from screwsim.results.schema import Axis, Subject, axes_of, subject_of
from screwsim.results.table import InMemory, Names, Table, Tables, regrouped, table_of
from screwsim.results.variables import Column, Plan, names_of, write_slopes
from screwsim.scene.types import Scene

# the format of HDF5 1.8 allows attributes (the scene) beyond 64 KiB; netCDF-4 keeps the order of creation
_FORMAT: dict[str, Any] = {"libver": ("v108", "v108"), "track_order": True}
# each chunk is written once and completely; HDF5 would cache 8 MiB per variable
_NO_CACHE: dict[str, Any] = {"rdcc_nbytes": 0}
EFFECT = "effect"  # dimension of a knock-out


def save(
    path: str | Path,
    scene: Scene,
    results: Result | Sequence[Result],
    command: str = "run",
    derivatives: ComputedDerivatives | None = None,
) -> None:
    """Write one result, or those of all cases of the scene's sweep (last axis fastest), to an HDF5 file.

    With one result its knock-out, if any, and the given derivatives are written too. With several, the derivatives that
    are known are written if the scene has `output.derivatives: all`. The cycle is kept for one result, and for a sweep
    with `output.keep: cycle`. An existing file is replaced. Raise UsageError in one line when the system refuses; the
    old file then stays.
    """
    if isinstance(results, Result):
        one = InMemory(table_of([results], keep_cycle=True))
        beside = partial(write_slopes, found=derivatives, performance=results.performance) if derivatives else None
        with Draft(Path(path), scene, (), command) as draft:
            draft.complete(one, results.knock_out, beside)
    else:
        table = table_of(results, keep_cycle=scene.output.keeps_cycle, keep_slopes=scene.output.keeps_slopes)
        write_tables(Path(path), scene, axes_of(scene), InMemory(table), command)


class StageTables(NamedTuple):
    """Results of one of two stages: its name, which is that of its group, its scene, axes and results."""

    name: str
    subject: Subject
    axes: Sequence[Axis]
    source: Tables


def write_tables(
    path: Path,
    subject: Scene | Subject,
    axes: Sequence[Axis],
    source: Tables,
    command: str,
    stages: Sequence[StageTables] = (),
) -> None:
    """Write the results of all cases on the axes (`Draft.complete`), and those of stages in a group of each."""

    def write_stages(layout: Layout) -> None:
        for stage in stages:
            names, words = names_of(stage.source.heads())
            plan = Plan(layout.within(stage.name), stage.subject, stage.axes, command, names)
            _write(plan, stage.source, words)

    with Draft(path, subject, axes, command) as draft:
        draft.complete(source, beside=write_stages)


class Draft:
    """A results file of all cases on the axes, laid out at any time, filled once all values exist, then renamed.

    The temporary file lies in `folder` (default: that of `path`). A draft that is left before completion is removed.
    With a `folder`, which keeps the results itself, a file that has appeared at `path` meanwhile is not replaced.
    """

    def __init__(
        self, path: Path, subject: Scene | Subject, axes: Sequence[Axis], command: str, folder: Path | None = None
    ) -> None:
        path = atomic.link_target(path)
        self._path = path
        self._subject = subject if isinstance(subject, Subject) else subject_of(subject)
        self._axes, self._command = axes, command
        self._temporary = atomic.temporary_name(path, folder)
        self._folder = folder
        self._before = atomic.stamp_of(path)
        self._target: GuardedFile | None = None
        self._file: Any = None
        self._plan: Plan | None = None

    def __enter__(self) -> Self:
        """Return the draft."""
        return self

    def __exit__(self, *error: object) -> None:
        """Remove an incomplete file."""
        self._drop()

    def lay_out(self, head: Table) -> None:
        """Create the variables in advance, if not yet done, as needed by `head`, one of the tables to come.

        An error of the system is ignored here: it occurs again at the end and is reported then.
        """
        if self._plan is None:
            with suppress(OSError):
                self._lay_out(names_of([head], self._subject.alone)[0])

    def complete(
        self, source: Tables, knock_out: Sequence[Figures] = (), beside: Callable[[Layout], None] | None = None
    ) -> None:
        """Write all results chunk by chunk, with no more than one chunk of each variable in memory.

        `beside` writes a group of its own. Raise UsageError in one line when the system refuses; the old file then
        stays.
        """
        cases = math.prod(len(axis.values) for axis in self._axes)
        if cases != source.cases:
            raise ValueError(f"{source.cases} results for {cases} cases")
        atomic.make_folder(self._path.parent)
        atomic.check_target_kind(self._path)
        with atomic.refused(self._path):
            names, words = names_of(source.heads(), self._subject.alone)
            plan = self._plan
            if plan is None or plan.names != names:
                plan = self._lay_out(names)
            _write(plan, source, words, self._check)
            if knock_out:
                write_knock_out(plan.layout, knock_out)
            if beside is not None:
                beside(plan.layout)
            self._close()
            self._put()

    def _put(self) -> None:
        if self._folder is None:
            atomic.put_file(self._temporary, self._path)
            return
        try:
            atomic.put_new_file(self._temporary, self._path, self._before)
        except FileExistsError:
            raise UsageError(
                f"{self._path}: another file was put there meanwhile, and is kept; all cases are finished, in "
                f"{self._folder} (move that file away and start the sweep again, which then only writes its file)"
            ) from None

    def _lay_out(self, names: Names) -> Plan:
        import h5py

        self._drop()
        self._target = GuardedFile(self._temporary)
        self._file = h5py.File(self._target, "w", **_FORMAT, **_NO_CACHE)
        plan = Plan(Layout(self._file), self._subject, self._axes, self._command, names)
        self._check()
        self._plan = plan
        return plan

    def _check(self) -> None:
        if self._target is not None:
            self._target.check()

    def _close(self) -> None:
        """Close the file; raise the OSError that stopped its writing, if any."""
        file, target, self._file, self._target, self._plan = self._file, self._target, None, None, None
        if file is not None:
            file.close()
        if target is not None:
            target.close()
            target.check()

    def _drop(self) -> None:
        with suppress(OSError):
            self._close()
        atomic.remove(self._temporary)


def _write(
    plan: Plan, source: Tables, words: Mapping[str, Sequence[str]], check: Callable[[], None] = lambda: None
) -> None:
    """Write all columns of a plan over the cases, and over further dimensions where they have some."""
    names = plan.names
    own = [(plan.traces, [len(names.angle)]), (plan.slopes, [len(names.numbers)]), (plan.changes, [len(names.inputs)])]
    for columns, further in [(plan.columns + plan.texts(words), list[int]()), *own]:
        if columns:
            pieces = source.tables(traces=columns is plan.traces)
            for _ in _fill(columns, plan.shape, (*plan.shape, *further), pieces):
                check()


def _fill(
    columns: Sequence[Column], shape: tuple[int, ...], full: tuple[int, ...], tables: Iterator[Table]
) -> Iterator[None]:
    """Write columns chunk by chunk over cases of `shape`; the variables have the shape `full`."""
    places = list(_chunks(shape, chunks_of(full)[: len(shape)]))
    pieces = regrouped(tables, (size for _, size, _ in places))
    for (first, _, part), table in zip(places, pieces, strict=True):
        selection = Selection(full, first, part)
        for column in columns:
            selection.write(column.data, column.values(table))
        yield


def _chunks(shape: tuple[int, ...], chunk: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], int, tuple[int, ...]]]:
    """Yield (index of its first case, number of cases, shape) of each chunk, in the order of the cases."""
    split = next((index for index, size in enumerate(chunk) if size > 1), len(shape) - 1)
    if not shape:
        yield (), 1, ()
        return
    inner = shape[split + 1 :]
    for outer in np.ndindex(*shape[:split]):
        for start in range(0, shape[split], chunk[split]):
            size = min(chunk[split], shape[split] - start)
            part = (*(1 for _ in outer), size, *inner)
            yield (*outer, start, *(0 for _ in inner)), size * math.prod(inner), part


def write_knock_out(layout: Layout, costs: Sequence[Figures]) -> None:
    """Write the group `knock_out`; its coordinate `effect` numbers the names, listed in its attribute `labels`."""
    group = layout.group("knock_out")
    layout.labelled(group, EFFECT, [cost.effect for cost in costs], "effect that is left out")
    status = np.array([KNOCK_OUT_STATUSES.index(cost.status) for cost in costs], np.int8)
    layout.variable(group, "status", status, (EFFECT,), flag_attributes(KNOCK_OUT_STATUSES, "how it ended"))
    for name, variable in KNOCK_OUT.items():
        if name not in costs[0]:
            continue
        values = np.array([cost[name] for cost in costs], float)  # None becomes NaN
        layout.variable(group, name, values, (EFFECT,), number_attributes(variable))
    messages = [text_lines(cost.message) for cost in costs]
    words, meaning = sorted(set(messages)), "why there are no figures, or what is doubtful"
    data = layout.texts(group, "message", words, (len(costs),), (EFFECT,), meaning)
    data.write([words.index(message) for message in messages])
