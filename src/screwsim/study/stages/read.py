"""Read STAGES.yaml: both scenes and what lies between, with faults by line."""

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, replace
from functools import partial
from typing import Any

from screwsim.build import build_parts, package_of
from screwsim.effects.base import CoolsOil, Plenum
from screwsim.fluid import constants
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.inputs.textfiles import shipped_name
from screwsim.scene import Scene, load, scene_of
from screwsim.scene.fields import section_of
from screwsim.scene.file_kinds import STAGES, is_stages, mapping_of
from screwsim.scene.lines import condensate_enthalpy
from screwsim.scene.model_errors import BLOCK
from screwsim.scene.sections import read_section
from screwsim.scene.sweep import read_sweep_of
from screwsim.scene.tolerances import split_tolerances
from screwsim.scene.types import parameters_of_type
from screwsim.scene.units import gauge_pressures_over
from screwsim.scene.values import shown
from screwsim.scene.yaml_tree import LocatedFaults, Node
from screwsim.study.stages.axes import (
    BETWEEN,
    LEAVES,
    STAGE_NAMES,
    UNLOADED_STAGE,
    Intercooler,
    leaf_in_chain,
    override_meant,
)
from screwsim.study.stages.chain import StageChain
from screwsim.study.stages.tolerances import read_between, read_correlated

KEYS = ("title", STAGES, "intercooler", "sweep", BLOCK)
KIND_BETWEEN = f"{BETWEEN}.kind"
_REMEDY = "write stages: [first.yaml, second.yaml]"
COOLED_BETWEEN = (
    "the first scene names an aftercooler, whose cooling the line to the other stage states (write aftercooler: null "
    "there, and intercooler: {kind: cooler, outlet_temperature: …, pressure_drop: …})"
)
WARM_COOLANT = (
    "the second scene's {what} would have the warm suction of that stage for its coolant (state its "
    "coolant_temperature there)"
)


def scene_or_stages(given: Any) -> Scene | StageChain:
    """Return two stages as they are or from the path of their file, else the scene that `scene_of` makes of it.

    Raise `UsageError` for two stages as a dict or as text, besides what the readers of files raise.
    """
    if isinstance(given, StageChain):
        return given
    if isinstance(given, str | os.PathLike) and "\n" not in os.fspath(given):
        return read_stages(given) if is_stages(given) else scene_of(given)
    lines = given.splitlines() if isinstance(given, str) else ()
    keys = given if isinstance(given, Mapping) else {line.partition(":")[0] for line in lines}
    if STAGES in keys:
        what = f"{STAGES}: two stages are given by the path of their file"
        raise UsageError(f"{what} (write one that names the files of both scenes, and pass its path)")
    return scene_of(given)


def read_stages(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> StageChain:
    """Return the chain of a YAML file, its scenes changed by `first.PATH=VALUE` and `second.PATH=VALUE`.

    Raises `SceneError` with one line per fault, `UsageError` for an override that makes no sense.
    """
    name = shipped_name(path)
    problems = LocatedFaults()
    root = mapping_of(name, problems)
    chain = None if root is None else _typed(root, _overrides_by_stage(root, overrides), problems)
    if problems or chain is None:
        raise problems.error()
    return chain


def _overrides_by_stage(root: Node, overrides: Iterable[str]) -> dict[str, list[str]]:
    """Return the overrides of each stage without its name; raise UsageError for one that names no stage."""
    found: dict[str, list[str]] = {name: [] for name in STAGE_NAMES}
    for override in overrides:
        head, _, rest = override.partition(".")
        if (key := head.partition("=")[0]) in KEYS or key in LEAVES:
            raise UsageError(f"--set {override}: belongs to the two-stage file (write it there)")
        if head not in found or not rest:
            what = "starts with neither first. nor second., which name the stage"
            raise UsageError(f"--set {override}: {what} ({override_meant(_unchanged(root), override)})")
        if rest.startswith(("sweep.", "sweep=")):
            what = "is left aside, as two stages have one sweep"
            raise UsageError(f"--set {override}: {what} (write sweep: {{{head}.PATH: […]}} in the two-stage file)")
        found[head].append(rest)
    return found


def _unchanged(root: Node) -> StageChain | None:
    """Return the chain as it is in its files; None where they have faults."""
    try:
        return _typed(root, {name: [] for name in STAGE_NAMES}, LocatedFaults())
    except SceneError:
        return None


def _typed(root: Node, overrides: dict[str, list[str]], problems: LocatedFaults) -> StageChain | None:
    content: dict[str, Any] = dict(root.value)
    for extra in (name for name in content if name not in KEYS):
        what = f"is not known in a two-stage file (known: {', '.join(KEYS)})"
        problems.add(content[extra].heading, extra, what)
    between, written = Intercooler(), {}
    if BETWEEN in content:
        plain, written = split_tolerances(content[BETWEEN], BETWEEN)
        between = read_section(section_of(Intercooler), plain, BETWEEN, problems)
    files = _files(root, content[STAGES], problems)
    if problems or files is None:
        return None
    if between.cools != (between.outlet_temperature is not None):
        missing = between.cools
        what = "is missing (kind: cooler needs it, e.g. 35 degC)" if missing else "belongs to kind: cooler (remove it)"
        problems.add(content["intercooler"].place, "intercooler.outlet_temperature", what)
        return None
    first, second = _scenes(files, overrides)
    _check(first, second, between, content, problems)
    title = content["title"].value if "title" in content else ""
    chain = StageChain(str(title or ""), first, second, between)
    chain = replace(chain, uncertain=read_between(written, between, problems))
    if BLOCK in content:
        changed = [f"{stage}.{each.partition('=')[0]}" for stage, own in overrides.items() for each in own]
        chain = replace(chain, correlated=read_correlated(content[BLOCK], chain, changed, problems))
    leaf = partial(leaf_in_chain, chain)
    with gauge_pressures_over(chain.ambient_pressure):
        sweep, joints = read_sweep_of(content.get("sweep"), leaf, problems, "first.operation.speed")
    return replace(chain, sweep=sweep, joints=joints)


def _scenes(files: list[str], overrides: dict[str, list[str]]) -> list[Scene]:
    """Return both scenes; raise `SceneError` with the faults of both."""
    found, lines = [], []
    for name, file in zip(STAGE_NAMES, files, strict=True):
        try:
            found.append(load(file, overrides[name], stage=f"{name}."))
        except SceneError as error:
            lines += [line for line in error.lines if line not in lines]
    if lines:
        raise SceneError(lines)
    return found


def _files(root: Node, node: Node, problems: LocatedFaults) -> list[str] | None:
    names = [item.value for item in node.value] if isinstance(node.value, list) else None
    if names is None or len(names) != len(STAGE_NAMES) or not all(isinstance(name, str) for name in names):
        what = f"is {shown(names or node.value)}, not the files of two scenes"
        problems.add(node.place, STAGES, f"{what} ({_REMEDY})")
        return None
    files = [os.path.join(root.place.folder, name) for name in names]
    for item, file in zip(node.value, files, strict=True):
        if not os.path.isfile(file):
            what = f"{shown(item.value)} is not a file (name an existing scene, relative to this file)"
            problems.add(item.place, STAGES, what)
    return files


def _check(first: Scene, second: Scene, between: Intercooler, content: dict[str, Any], problems: LocatedFaults) -> None:
    """Add faults of what does not go together, at the key of the file that each is told at."""
    for key, what in apart(first, second, between):
        problems.add(content[key.partition(".")[0]].place, key, what)


def apart(first: Scene, second: Scene, between: Intercooler) -> Iterator[tuple[str, str]]:
    """Yield what does not go together in two stages, each with the key of their file at which it is told.

    These are different gases, expanders, drawn gas, and a flash tank without a condenser or of a blend.
    """
    for name, scene in zip(STAGE_NAMES, (first, second), strict=True):
        for effect, part in build_parts(scene).all(Plenum):
            if part.product:
                drawn = "which draws gas that the balance between the stages does not include"
                yield STAGES, f"the {name} scene names {effect}, {drawn} (leave it out there)"
    coolers = [getattr(package_of(scene), "aftercooler", None) for scene in (first, second)]
    if coolers[0] is not None:
        yield STAGES, COOLED_BETWEEN
    if coolers[1] is not None and coolers[1].coolant_temperature is None:
        yield STAGES, WARM_COOLANT.format(what="aftercooler")
    for name, scene in zip(STAGE_NAMES, (first, second), strict=True):
        if not getattr(package_of(scene), "delivers", True):
            yield STAGES, f"the {name} scene {UNLOADED_STAGE} (write state: loaded there)"
    if any(each.cooled_by_inlet for each in parameters_of_type(second.effects, CoolsOil).values()):
        yield STAGES, WARM_COOLANT.format(what="oil cooler")
    if first.gas != second.gas:
        names = (each.name for each in fields(first.gas))
        others = (f"gas.{name}" for name in names if getattr(first.gas, name) != getattr(second.gas, name))
        yield STAGES, f"have different gases: {', '.join(others)} (write the same gas: section in both)"
    if first.machine.expands or second.machine.expands:
        yield STAGES, "must be compressors, not machine.mode: expander (choose compressors)"
    if second.gas.relative_humidity is not None:
        what = "states a relative_humidity, but the water that condenses between the stages is not modelled"
        yield STAGES, f"{what} (remove it from both scenes, or run them one by one)"
    if between.flashes and constants.parts_on_boiling(second.gas.name):
        what = f"vapour boiling off {second.gas.name}, a blend, differs from it in composition"
        yield KIND_BETWEEN, f"{what} (write kind: cooler, or name a pure fluid)"
    if between.flashes and condensate_enthalpy(second) is None:
        what = f"{between.kind} needs operation.condensing_temperature or gas_cooler in the second scene"
        yield KIND_BETWEEN, f"{what}: its liquid feeds the tank (state it there)"
