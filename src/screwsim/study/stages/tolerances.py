"""Tolerances in a file of two stages: of the intercooler's values, and groups of inputs that err together across both.

A group of one of the scenes and one of the file that share an input are one group.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from screwsim.inputs.suggestions import did_you_mean
from screwsim.scene.model_errors import BLOCK
from screwsim.scene.tolerances import CORRELATED_KEY, WrittenTolerance, checked_tolerance
from screwsim.scene.types import Tolerance
from screwsim.scene.values import shown
from screwsim.scene.yaml_tree import LocatedFaults, Node
from screwsim.study.stages.axes import BETWEEN, LEAVES, SOLVED

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain

_REMEDY = f"write {BLOCK}: {{{CORRELATED_KEY}: [[first.PATH, second.PATH], …]}}"


def stage_tolerances(chain: StageChain) -> tuple[dict[str, Tolerance], tuple[tuple[str, ...], ...]]:
    """Return the tolerances of both scenes and of the intercooler by path, and the groups that err together.

    The line between both is solved for: its tolerances have no part.
    """
    uncertain: dict[str, Tolerance] = {}
    groups: list[tuple[str, ...]] = []
    for stage, scene in chain.by_stage.items():
        uncertain |= {
            f"{stage}.{path}": each for path, each in scene.uncertain.items() if not path.startswith(SOLVED[stage])
        }
        groups += [tuple(f"{stage}.{path}" for path in group) for group in scene.correlated]
    uncertain |= chain.uncertain
    own = (tuple(path for path in group if path in uncertain) for group in (*groups, *chain.correlated))
    return uncertain, _joined(group for group in own if group)


def _joined(groups: Iterable[tuple[str, ...]]) -> tuple[tuple[str, ...], ...]:
    """Return groups of which no two share a member."""
    found: list[tuple[str, ...]] = []
    for group in groups:
        shared = [each for each in found if set(each) & set(group)]
        members = dict.fromkeys(path for each in (*shared, group) for path in each)
        found = [each for each in found if each not in shared] + [tuple(members)]
    return tuple(found)


def read_between(given: Mapping[str, WrittenTolerance], values: Any, problems: LocatedFaults) -> dict[str, Tolerance]:
    """Return the tolerances of the intercooler's values by path; faults are added at their places."""
    found = {}
    for path, written in given.items():
        leaf = LEAVES.get(path.removeprefix(f"{BETWEEN}."))
        value = getattr(values, path.removeprefix(f"{BETWEEN}."), None)
        with problems.at(written.place, path):
            found[path] = checked_tolerance(leaf, written, value)
    return found


def read_correlated(
    block: Node, chain: StageChain, changed: Sequence[str], problems: LocatedFaults
) -> tuple[tuple[str, ...], ...]:
    """Return the groups across both stages of the key `uncertainty`; faults are added at their places.

    A member that an override has `changed` to a value without a tolerance leaves its group.
    """
    path = f"{BLOCK}.{CORRELATED_KEY}"
    if not isinstance(block.value, dict) or set(block.value) != {CORRELATED_KEY}:
        problems.add(block.place, BLOCK, f"lists no correlated groups ({_REMEDY}; a model is named in the scenes)")
        return ()
    listed = block.value[CORRELATED_KEY]
    known, groups = stage_tolerances(chain)[0], []
    for group in listed.value if isinstance(listed.value, list) else [listed]:
        members = group.value if isinstance(group.value, list) else []
        if len(members) < 2:
            problems.add(group.place, path, f"is not a list of groups of paths ({_REMEDY})")
        kept = [each for each in members if _is_known(each.value, known) or not _is_changed(each.value, changed)]
        for each in (each for each in kept if not _is_known(each.value, known)):
            near = did_you_mean(each.value, known) if isinstance(each.value, str) else ""
            problems.add(each.place, path, f"{shown(each.value)} has no tolerance{near} (write it there first)")
        groups.append(tuple(str(each.value) for each in kept))
    return tuple(group for group in groups if len(group) > 1)


def _is_known(path: Any, known: Mapping[str, Tolerance]) -> bool:
    return isinstance(path, str) and path in known


def _is_changed(path: Any, changed: Sequence[str]) -> bool:
    """Tell whether an override names a path, or a section that contains it."""
    return isinstance(path, str) and any(f"{path}.".startswith(f"{each}.") for each in changed)


def tolerance_lines(groups: Sequence[Sequence[str]]) -> Iterator[str]:
    """Yield the YAML line of the groups across both stages."""
    if groups:
        listed = ", ".join(f"[{', '.join(group)}]" for group in groups)
        yield f"{BLOCK}: {{{CORRELATED_KEY}: [{listed}]}}"
