"""Results of two stages in one HDF5 file: the figures of both together, and the whole result of each stage.

The file is one of `screwsim.results`, with one more group for each stage:

- `inputs`, `performance`, `error` (and `uncertainty`, `contributions` where the scenes state tolerances) are those of
  both stages together, under the names of `outputs.STAGES`; inputs have their stage before the path.
- `first` and `second` are each laid out as the file of a single machine: its figures, errors, balances, numerics, for
  one point also curves and ledger; its inputs without those of the line between both, which is solved for. Axes of a
  stage have their paths there without it.
- The scene of the file is the two-stage file, that of a group the scene of that stage as it was read.

A point that has no result keeps its reason, in the stages as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result, Variable
from screwsim.results.atomic import HDF5_SIGNATURE, has_content, protect_others
from screwsim.results.identity import unpacked
from screwsim.results.read import SCENE_AT_POINT, read_attributes
from screwsim.results.schema import Axis, Subject, axes_along, digest, identity_of, numeric_inputs, subject_of
from screwsim.results.table import InMemory, table_of
from screwsim.results.write import StageTables, write_tables
from screwsim.scene.grid import without_sweep
from screwsim.scene.tolerances import tolerance_text
from screwsim.scene.types import Scene
from screwsim.scene.values import text_of
from screwsim.scene.write import quoted, scene_text, sweep_lines
from screwsim.study.stages.axes import BETWEEN, LEAVES, SOLVED, STAGE_NAMES, leaf_in_chain
from screwsim.study.stages.tolerances import tolerance_lines

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain
    from screwsim.study.stages.result import ChainResult

OWN_IDENTITY = ("file ", "values of the scene")  # beginnings of what an identity says of one scene
FAILED_TOGETHER = "both stages together have no result: "


class ChainPoint(NamedTuple):
    """A point of a sweep: values [SI] of its paths, the result of both stages together, and that of each."""

    values: Mapping[str, Any]
    result: Result
    stages: tuple[Result, ...]


def chain_point(found: ChainResult, keep: Callable[[Scene, Result], Result]) -> ChainPoint:
    """Return the results of a chain as they are stored, those of the stages as `keep` returns them.

    Without a result of both together the stages have none either: what they were last tried with is no solution.
    """
    whole = found.as_result()
    if not found.scenes:
        none = Result("failed", f"{FAILED_TOGETHER}{whole.message}")
        return ChainPoint({}, whole, (none,) * len(STAGE_NAMES))
    return ChainPoint({}, whole, tuple(map(keep, found.scenes, found.stages)))


def save_chain(
    path: Path, chain: StageChain, results: Sequence[ChainPoint], command: str, solved: Sequence[Scene] = ()
) -> None:
    """Write the results of all points of a chain's sweep, the last axis fastest, or that of one without a sweep.

    Of one point the curves and ledgers of the stages are written, and with the scenes `solved`, which have the line
    between both as it was found, their texts. Raise UsageError when the system refuses.
    """
    one = not chain.sweep
    axes = axes_along(chain, lambda name: leaf_in_chain(chain, name))
    parts = []
    for number, (stage, scene) in enumerate(chain.by_stage.items()):
        own = [each.stages[number] for each in results]
        table = table_of(own, keep_cycle=one, keep_slopes=one and scene.output.keeps_slopes)
        known = tuple(each for each in subject_of(scene).inputs if _is_input(chain, stage, each[0]))
        more = {SCENE_AT_POINT: scene_text(solved[number])} if solved else {}
        subject = replace(subject_of(scene), inputs=known, more=more)
        parts.append(StageTables(stage, subject, [_own_axis(stage, axis) for axis in axes], InMemory(table)))
    whole = InMemory(table_of([each.result for each in results], keep_cycle=False))
    write_tables(path, subject_of_chain(chain), axes, whole, command, parts)


def check_place_of_points(path: Path, chain: StageChain) -> None:
    """Raise UsageError where the points of a chain would replace anything but points of the same chain."""
    protect_others(path, HDF5_SIGNATURE)
    if not has_content(path):
        return
    stored, own = unpacked(read_attributes(path).get("screwsim_identity")) or {}, identity_of_chain(chain)
    if any(stored.get(name) != text for name, text in own.items() if "values " in name):
        raise UsageError(f"{path}: holds results of another scene or sweep (choose another -o, or remove it)")


def subject_of_chain(chain: StageChain) -> Subject:
    """Return two stages as the subject of the figures of both together."""
    inputs = (
        (f"{stage}.{path}", variable, value)
        for stage, scene in chain.by_stage.items()
        for path, variable, value in numeric_inputs(scene)
        if _is_input(chain, stage, path)
    )
    between = ((name, about, value) for name, about, value in _between(chain) if name not in chain.sweep)
    return Subject(chain.title, chain_text(chain), identity_of_chain(chain), (*inputs, *between), alone=False)


def identity_of_chain(chain: StageChain) -> dict[str, str]:
    """Return what distinguishes the results of one chain from those of another (`results.identity`)."""
    own = (chain.intercooler, dict(chain.sweep), chain.joints)
    if chain.uncertain or chain.correlated:
        own = (*own, dict(chain.uncertain), chain.correlated)
    found = {"values of both stages": digest(repr(own))}
    for stage, scene in chain.by_stage.items():
        for name, text in identity_of(without_sweep(scene)).items():
            found[f"{stage} {name}" if name.startswith(OWN_IDENTITY) else name] = text
    return found


def chain_text(chain: StageChain, before: str = "") -> str:
    """Return the YAML text of a chain, for files of its scenes named after their stages, with `before` in front."""
    named = ", ".join(quoted(f"{before}{stage}.yaml") if before else f"{stage}.yaml" for stage in STAGE_NAMES)
    lines = [f"title: {quoted(chain.title)}"] if chain.title else []
    lines += [f"stages: [{named}]", f"{BETWEEN}:"]
    for name, leaf in LEAVES.items():
        value = getattr(chain.intercooler, name)
        if value is not None:
            tolerance = chain.uncertain.get(f"{BETWEEN}.{name}")
            spread = "" if tolerance is None else tolerance_text(leaf, tolerance)
            lines.append(f"  {name}: {text_of(leaf, value)}{spread}")
    lines += tolerance_lines(chain.correlated)
    lines += sweep_lines(chain, lambda name: leaf_in_chain(chain, name))
    return "\n".join(lines) + "\n"


def _is_input(chain: StageChain, stage: str, path: str) -> bool:
    """Tell whether a stage's input has one value in all points: neither varied nor found by the chain."""
    return f"{stage}.{path}" not in chain.sweep and not path.startswith(SOLVED[stage])


def _own_axis(stage: str, axis: Axis) -> Axis:
    """Return an axis as a stage has it: with its own paths without the stage before them."""
    joined = tuple(_own_axis(stage, each) for each in axis.joined)
    return axis._replace(path=axis.path.removeprefix(f"{stage}."), joined=joined)


def _between(chain: StageChain) -> Iterator[tuple[str, Variable, float]]:
    """Yield the numbers of what lies between both stages, with unit and meaning."""
    for name, leaf in LEAVES.items():
        value = getattr(chain.intercooler, name)
        if leaf.kind in KINDS and value is not None:
            yield f"{BETWEEN}.{name}", Variable(KINDS[leaf.kind].si, leaf.doc), float(value)
