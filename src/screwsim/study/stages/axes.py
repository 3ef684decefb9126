"""Inputs of two stages that may vary, `first.PATH`, `second.PATH` and `intercooler.KEY`; what lies between both stages.

What the chain solves for cannot be varied: the discharge line of the first stage and the suction line of the second.
"""

from __future__ import annotations

import shlex
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from screwsim.inputs.declare import choice, quantity
from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import paths_ending_in
from screwsim.outputs import STAGES
from screwsim.scene.fields import Leaf, leaves_of, section_of, unknown_key
from screwsim.scene.grid import leaf_of
from screwsim.scene.operation import line_axis_faults
from screwsim.scene.units import Refused

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain

STAGE_NAMES = ("first", "second")
BETWEEN = "intercooler"
STAGES_KEY = "stages"  # of the files of both scenes
COMMON = ("gas.", "machine.mode", "machine.kind")  # beginnings of paths that both scenes state alike
SOLVED = {  # beginnings of paths that the chain replaces by what it finds
    "first": (
        "operation.discharge.",
        "operation.condensing_temperature",
        "operation.subcooling",
        "operation.gas_cooler",
        "operation.aftercooler_temperature",
    ),
    "second": ("operation.suction.", "operation.evaporating_temperature", "operation.superheat"),
}
UNLOADED_STAGE = "is unloaded and blows off what it moves, so that the pair delivers nothing"
MOST_MEANT = 4  # paths that are offered for one without a stage
NOTHING, COOLS, FLASHES, BATHES = "none", "cooler", "economizer", "flash_intercooler"
INTERCOOLER_KINDS = {  # what lies between both stages, in words
    NOTHING: "The second stage draws in the gas as the first one delivers it (M201).",
    COOLS: "A cooler cools the gas to {T} if it is warmer (M201).",
    FLASHES: "Vapour from a flash tank between condenser and evaporator mixes with the gas (M202).",
    BATHES: "The gas passes through a flash tank between condenser and evaporator and leaves saturated (M202).",
}


@dataclass(frozen=True)
class Intercooler:
    """What lies between the discharge line of the first stage and the suction line of the second."""

    kind: str = choice(
        "none; cooler: the gas is cooled; economizer: vapour of a flash tank mixes in (two-stage expansion); "
        "flash_intercooler: the gas passes through the tank's liquid, which evaporates until the gas is saturated",
        tuple(INTERCOOLER_KINDS),
        "none",
    )
    outlet_temperature: float | None = quantity(
        "temperature", "of the gas after the cooler (if it arrives warmer)", None, gt=0.0
    )
    pressure_drop: float = quantity("pressure_difference", "between both lines", 0.0, ge=0.0)

    @property
    def cools(self) -> bool:
        """Whether the gas is cooled."""
        return self.kind == COOLS

    @property
    def flashes(self) -> bool:
        """Whether vapour of a flash tank mixes in."""
        return self.kind in (FLASHES, BATHES)

    @property
    def bathes(self) -> bool:
        """Whether the gas passes through the liquid of that tank."""
        return self.kind == BATHES


LEAVES = {name: leaf for name, leaf in section_of(Intercooler).fields.items() if isinstance(leaf, Leaf)}


def names_of(path: str, two: bool) -> tuple[str, ...]:
    """Return the names under which an input of a scene varies, alone or of `two` in series."""
    return names_in_chain(path) if two else (path,)


def names_in_chain(path: str) -> tuple[str, ...]:
    """Return the names of a scene's path in a sweep of two stages: of each stage where it may vary."""
    return tuple(f"{stage}.{path}" for stage in STAGE_NAMES if not path.startswith((*COMMON, *SOLVED[stage])))


def leaf_in_chain(chain: StageChain, name: str) -> Leaf:
    """Return the description of an input of a chain that may vary; raise `Refused` for any other."""
    stage, _, path = name.partition(".")
    if stage == BETWEEN:
        return _leaf_between(chain, path)
    if stage in STAGE_NAMES and not path:
        raise Refused(f"names a stage, not an input of it (write e.g. {stage}.operation.speed)")
    if (path if stage in STAGE_NAMES else name).startswith(COMMON):
        raise Refused("is the same in both stages (vary it by two files, or with --set in both)")
    if stage not in STAGE_NAMES:
        meant, usual = _meant(chain, name), f"{STAGE_NAMES[0]}.operation.speed"
        if name in STAGES and not meant:
            raise Refused(f"is a figure, which follows from the inputs (vary e.g. {usual})")
        raise Refused(f"starts with none of first., second., {BETWEEN}. (write e.g. {meant or usual})")
    if path.startswith(SOLVED[stage]):
        line = "discharge line" if stage == STAGE_NAMES[0] else "suction line"
        raise Refused(f"belongs to the {line}, which follows from the other stage (leave it out)")
    scene = chain.by_stage[stage]
    for fault in line_axis_faults(scene, (path,)):
        raise Refused(fault.what.replace("(vary operation.", f"(vary {stage}.operation."))
    try:
        return leaf_of(scene, path, f"{stage}.", (*COMMON, *SOLVED[stage]))
    except UsageError as error:
        what = str(error).removeprefix(f"{path}: ")
        raise Refused(what.replace("of the scene)", f"of that scene after {stage}.)")) from None


def _meant(chain: StageChain, name: str) -> str:
    """Return the inputs that may vary and end in a name without a stage; empty where there is none.

    The name may have another word for a stage before it, as that of a file.
    """
    names = (name, name.partition(".")[2])
    for each in filter(None, names):
        if each in LEAVES and _may_vary(chain, f"{BETWEEN}.{each}"):
            return f"{BETWEEN}.{each}"
        ends = {stage: (each, *paths_ending_in(each, leaves_of(scene))) for stage, scene in chain.by_stage.items()}
        options = ([f"{stage}.{path}" for path in paths] for stage, paths in ends.items())
        found = [next((path for path in paths if _may_vary(chain, path)), None) for paths in options]
        if any(found):
            return " or ".join(path for path in found if path)
    return ""


def _may_vary(chain: StageChain, name: str) -> bool:
    with suppress(Refused):
        leaf_in_chain(chain, name)
        return True
    return False


def override_meant(chain: StageChain | None, override: str) -> str:
    """Return what to write instead of an override PATH=VALUE without a stage: of one stage, of either, or of both.

    Without a chain, whose scenes have faults, no path is known.
    """
    name, equals, value = override.partition("=")
    found = []
    for stage, scene in ({} if chain is None else chain.by_stage).items():
        known = [*leaves_of(scene), *(f"effects.{effect}" for effect in scene.effects)]
        paths = [name] if name in known else paths_ending_in(name, known)
        found += [f"{stage}.{path}" for path in paths if not path.startswith(SOLVED[stage])]
    if not 0 < len(found) <= MOST_MEANT:
        return f"write the whole path, e.g. --set '{STAGE_NAMES[0]}.operation.speed=3000 rpm'"
    options = [f"--set {shlex.quote(f'{path}{equals}{value}')}" for path in found]
    own = {path.partition(".")[2] for path in found}
    if all(path.startswith(COMMON) for path in own):
        return f"write {' '.join(options)}"
    return f"write {' or '.join(options)}{', or both' if len(own) < len(found) else ''}"


def _leaf_between(chain: StageChain, key: str) -> Leaf:
    known = [name for name in LEAVES if name != "kind"]
    if key not in known:
        raise Refused(unknown_key(key, known))
    if getattr(chain.intercooler, key) is None:
        raise Refused("is not stated (it belongs to kind: cooler; write it first)")
    return LEAVES[key]
