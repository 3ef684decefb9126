"""The highest speeds of two stages of air that both motors carry, where the highest of a sweep overload one of them.

Both speeds are taken between the lowest and the highest of the sweep, at the same share of the way, and to whole
revolutions per minute.
"""

import math
from collections.abc import Mapping
from typing import Any

from screwsim.figures import rotor_speed
from screwsim.outputs.customary import RPM
from screwsim.scene.operation import SPEED
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.carried import STEPS, fully_loaded
from screwsim.study.stages import ChainResult
from screwsim.study.stages.axes import STAGE_NAMES
from screwsim.study.stages.chain import StageChain
from screwsim.study.sweep.stages import solved_with

SPEEDS = tuple(f"{stage}.{SPEED}" for stage in STAGE_NAMES)
NEAR = 1e-4  # share of the way between both ends to which the speeds are sought
Pair = tuple[float, float]


def carried_stages(
    chain: StageChain, at: Mapping[str, Any], ends: tuple[Pair, Pair], found: tuple[ChainResult, ChainResult]
) -> tuple[Pair, ChainResult] | None:
    """Return the highest speeds [rad/s] of both stages that their motors carry, and the result there.

    `ends` are the highest and the lowest speeds, `found` the results there; `at` has other values [SI] that hold. None
    where both motors carry the highest speeds, or not even the lowest, and where a point does not close.
    """
    fast, slow = ends
    if any(each.status != "ok" for each in found):
        return None
    known = {1.0: load(chain, fast, found[0]), 0.0: load(chain, slow, found[1])}
    if known[1.0] <= 1.0 or known[0.0] >= 1.0:
        return None

    def load_at(share: float) -> float:
        if share not in known:
            both = _between(slow, fast, share)
            known[share] = load(chain, both, _solved(chain, at, both))
        return known[share]

    share = fully_loaded(load_at, (0.0, 1.0), NEAR)
    if share is None:
        return None
    for lower in range(STEPS):
        whole = (RPM * (math.floor(speed / RPM) - lower) for speed in _between(slow, fast, share))
        first, second = (max(speed, least) for speed, least in zip(whole, slow, strict=True))
        result = _solved(chain, at, (first, second))
        if result.status == "ok" and load(chain, (first, second), result) <= 1.0:
            return (first, second), result
    return None


def load(chain: StageChain, speeds: Pair, found: ChainResult) -> float:
    """Return the larger load of both motors over what they carry at their speeds; infinite without a result."""
    if found.status != "ok":
        return math.inf
    loads = []
    for scene, speed, each in zip(chain.by_stage.values(), speeds, found.stages, strict=True):
        carried = motor_of(scene).carried(rotor_speed(each.performance, speed))
        loads.append(float(each.performance["shaft_power"]) / float(carried))
    return max(loads)


def _between(slow: Pair, fast: Pair, share: float) -> Pair:
    first, second = (low + share * (high - low) for low, high in zip(slow, fast, strict=True))
    return first, second


def _solved(chain: StageChain, at: Mapping[str, Any], speeds: Pair) -> ChainResult:
    return solved_with(chain, {**dict(zip(SPEEDS, speeds, strict=True)), **at})
