"""Derivatives of the figures of two stages together by the numbers of both scenes and of the line between both.

Each stage has exact derivatives wherever its scene has, and the pressure between both moves with each number so that
the flows stay equal (`study.stages.uncertain`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from screwsim.inputs.faults import UsageError
from screwsim.outputs import STAGES
from screwsim.scene.fields import FIXED
from screwsim.study.figures import figure_of
from screwsim.study.local import Sensitivities, numeric_paths, requested_numbers
from screwsim.study.stages.axes import BETWEEN, COMMON, LEAVES, SOLVED
from screwsim.study.stages.solve import Stop, run_stages
from screwsim.study.stages.uncertain import ChainDerivatives, linear_chain

if TYPE_CHECKING:
    from screwsim.study.stages.read import StageChain
    from screwsim.study.stages.result import ChainResult


def chain_sensitivities(
    chain: StageChain,
    paths: Sequence[str] = (),
    figures: Sequence[str] = (),
    fine: bool = True,
    found: ChainResult | None = None,
) -> Sensitivities:
    """Return the derivatives of figures of both together (default: all) by numbers (default: all of both scenes).

    `found` is the solution, where it is known. Raises UsageError for a path or a figure that does not exist, and where
    a stage has no derivatives by its lines.
    """
    names = [figure_of(chain, name) for name in figures]
    values = requested_numbers(chain, paths, dict(_numbers(chain)))
    found = found or run_stages(chain)
    result = found.as_result()
    if found.status != "ok":
        return Sensitivities(result)
    wanted = STAGES.keys() & (names or STAGES)
    try:
        linear = linear_chain(chain, found, values, fine)
        slopes = ChainDerivatives(linear, values)
    except Stop as stop:
        raise UsageError(f"no derivatives: {stop}") from None
    return Sensitivities(
        result,
        values=slopes.values,
        units={name: getattr(chain.leaf_of(name).dimension, "si", "1") for name in slopes.values},
        derivatives={name: by for name, by in slopes.whole.items() if name in wanted},
        method=slopes.methods,
        why={
            f"{stage}.{path}": why
            for stage, own in zip(chain.by_stage, linear.slopes, strict=True)
            for path, why in own.why.items()
            if f"{stage}.{path}" in slopes.values
        },
        left_out=linear.lost,
    )


def _numbers(chain: StageChain) -> Iterator[tuple[str, float]]:
    """Yield the numbers [SI] of both scenes and of the line between them, without what the chain solves for."""
    for stage, scene in chain.by_stage.items():
        for path, value in numeric_paths(scene)[0].items():
            if path not in FIXED and not path.startswith((*COMMON, *SOLVED[stage])):
                yield f"{stage}.{path}", value
    for path in LEAVES:
        value = getattr(chain.intercooler, path)
        if isinstance(value, float):
            yield f"{BETWEEN}.{path}", value
