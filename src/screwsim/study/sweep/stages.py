"""Points of two stages over the sweep of their file: solved on all cores, kept as they finish, resumed.

Every point is a solution of its own, with its status; one that has none keeps the reason. Finished points lie in
OUT.part, a line of JSON each below a line that identifies files, program and sweep, until the output is written. The
same command continues from them, and tries those again whose worker has died; with another scene or program they are
refused.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Figures, Result
from screwsim.outputs.display import picked
from screwsim.results.atomic import refused
from screwsim.scene import Scene, grid
from screwsim.study.pool.parallel import parallel_map
from screwsim.study.pool.progress import Progress
from screwsim.study.pool.workers import WORKER_DIED
from screwsim.study.stages.chain import StageChain
from screwsim.study.stages.result import ChainResult, figures_of_both
from screwsim.study.stages.solve import run_stages
from screwsim.study.stages.store import ChainPoint, chain_point, identity_of_chain
from screwsim.study.uncertainty.stages import with_uncertainty

# fields of a result that are kept
FIELDS = ("status", "message", "warnings", "performance", "error", "notes", "uncertainty")
STAGE_FIELDS = (*FIELDS, "effects", "states", "balance", "numerics")
STAGES = "stages"


def solved_with(chain: StageChain, values: Mapping[str, Any], warm: bool = False) -> ChainResult:
    """Return the result of both stages with other values [SI] at their paths; a failed one where these do not fit.

    `warm` is as in `run_stages`.
    """
    try:
        return run_stages(chain.with_values(values), warm)
    except UsageError as error:
        return ChainResult("failed", str(error))


class KeptPoints:
    """The points of a chain that are finished, in a file beside the output."""

    def __init__(self, chain: StageChain, output: Path) -> None:
        self.path = output.with_name(f"{output.name}.part")
        self.reused = 0  # points that the last `read` has found
        self._identity = identity_of_chain(chain)

    def read(self, restart: bool = False) -> dict[int, ChainPoint]:
        """Return the finished points by their numbers; raise UsageError where they belong to something else."""
        self.reused = 0
        if restart:
            self.discard()
        if not self.path.exists():
            return {}
        lines = self._lines()
        if not lines or lines[0] != self._identity:
            raise UsageError(
                f"{self.path}: holds points of other scenes, of another sweep or of another version of the program "
                f"(start over with --restart, or choose another -o)"
            )
        found = {line["case"]: _point(line) for line in lines[1:]}
        self.reused = len(found)
        return found

    def add(self, found: Mapping[int, ChainPoint]) -> None:
        """Append finished points; raise UsageError when the system refuses."""
        texts = [json.dumps({"case": number, **_line(point)}) for number, point in found.items()]
        with refused(self.path):
            begun = self.path.exists()
            if not begun:
                self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as stream:
                stream.write("".join(f"{text}\n" for text in ([] if begun else [json.dumps(self._identity)]) + texts))

    def discard(self) -> None:
        """Remove the file."""
        with refused(self.path):
            self.path.unlink(missing_ok=True)

    def _lines(self) -> list[Any]:
        """Return the lines of the file, and remove from it what an interruption has cut off."""
        with refused(self.path):
            whole = self.path.read_text(encoding="utf-8", errors="replace")
        text, _, cut = whole.rpartition("\n")
        try:
            lines = [json.loads(line) for line in text.splitlines()]
        except ValueError:
            return []
        if cut and lines and lines[0] == self._identity:
            with refused(self.path):
                self.path.write_text(f"{text}\n", encoding="utf-8")
        return lines


def _line(point: ChainPoint) -> dict[str, Any]:
    """Return what is kept of a point, as JSON takes it."""
    return picked(point.result, *FIELDS) | {STAGES: [picked(each, *STAGE_FIELDS) for each in point.stages]}


def _point(line: Mapping[str, Any]) -> ChainPoint:
    whole = _result(line, FIELDS)
    stages = tuple(_result(each, STAGE_FIELDS) for each in line[STAGES])
    return ChainPoint({}, replace(whole, performance=figures_of_both(whole.performance)), stages)


def _result(line: Mapping[str, Any], names: Sequence[str]) -> Result:
    found: dict[str, Any] = {name: tuple(of) if isinstance(of := line[name], list) else of for name in names}
    found["performance"] = Figures(found["performance"])
    return Result(**found)


def sweep_stages(
    chain: StageChain,
    kept: KeptPoints | None = None,
    *,
    jobs: int | None = None,
    restart: bool = False,
    progress: Progress | None = None,
    warm: bool = False,
) -> list[ChainPoint]:
    """Return the points of a chain's sweep, the last axis fastest; those that are kept are not solved again.

    `warm` is as in `run_stages`. Raises UsageError where the kept points belong to something else.
    """
    values = [grid.case_values(chain, number) for number in range(grid.case_count(chain))]
    found = {} if kept is None else kept.read(restart)
    missing = [number for number in range(len(values)) if number not in found]

    def keep(answers: Mapping[int, ChainPoint]) -> None:
        new = {missing[place]: point for place, point in answers.items()}
        found.update(new)
        lasting = {number: each for number, each in new.items() if each.result.message != WORKER_DIED}  # others: again
        if kept is not None and lasting:
            kept.add(lasting)

    base = grid.without_sweep(chain)
    parallel_map(
        partial(_solved, base, [values[number] for number in missing], warm),
        len(missing),
        died=lambda number: chain_point(ChainResult("failed", WORKER_DIED), _without_curves),
        jobs=jobs,
        progress=progress,
        kept=keep,
    )
    return [found[number]._replace(values=each) for number, each in enumerate(values)]


def _solved(base: StageChain, values: Sequence[Mapping[str, Any]], warm: bool, number: int) -> ChainPoint:
    found = solved_with(base, values[number], warm)
    return chain_point(with_uncertainty(base.with_values(values[number]), found), _without_curves)


def _without_curves(_: Scene, result: Result) -> Result:
    return replace(result, cycle={}, ledger=Figures())
