"""Derivatives and uncertainties of the figures of two stages together, by the inputs of both and of the line between.

Each stage has exact derivatives wherever its scene has, and the pressure between both moves with each number so that
the flows stay equal (`stages_linear`). Inputs of different scenes are independent of each other, but for groups that
the file of both names; what the line between both replaces in the scenes has no part in it.

Source: JCGM 100:2008 (GUM), section 5, for the propagation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from screwsim.inputs.faults import UsageError
from screwsim.outputs import STAGES, Result
from screwsim.scene.fields import FIXED
from screwsim.study.asked.figures import figure_of
from screwsim.study.stages.axes import BETWEEN, COMMON, LEAVES, SOLVED
from screwsim.study.stages.solve import Stop, run_stages
from screwsim.study.uncertainty.slopes import Sensitivities, numeric_paths, requested_numbers
from screwsim.study.uncertainty.spreads import NO_TOLERANCE, Uncertainty, not_included, tolerances_of
from screwsim.study.uncertainty.stages_linear import ChainDerivatives, linear_chain

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain
    from screwsim.study.stages.result import ChainResult


def chain_sensitivities(
    chain: StageChain,
    paths: Sequence[str],
    figures: Sequence[str] = (),
    fine: bool = True,
    found: ChainResult | None = None,
) -> Sensitivities:
    """Return the derivatives of figures of both together (none: all) by numbers (none: all of both scenes).

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


def with_uncertainty(chain: StageChain, found: ChainResult) -> ChainResult:
    """Return a chain's result with the uncertainties by the tolerances of both scenes, of the stages' figures as well.

    It is unchanged where it has no figures, or the scenes state no tolerance. An input without a derivative is in none
    of the uncertainties, and a warning says so; a warning tells why there are none at all.
    """
    tolerances = tolerances_of(chain)
    if found.status != "ok" or not tolerances.uncertain:
        return found
    try:
        told, slopes = chain_uncertainty(chain, found)
    except UsageError as error:
        return replace(found, warnings=(*found.warnings, f"no uncertainty from the inputs: {error}"))
    stages = tuple(
        replace(each, uncertainty=slopes.uncertainty(each, own, tolerances).as_json())
        for each, own in zip(found.stages, slopes.stages, strict=True)
    )
    warnings = (*found.warnings, *not_included(told.left_out))
    return replace(found, uncertainty=told.as_json(), stages=stages, warnings=warnings)


def chain_uncertainty(chain: StageChain, found: ChainResult) -> tuple[Uncertainty, ChainDerivatives]:
    """Return the uncertainties of the figures of both together, and the derivatives by the inputs with a tolerance.

    Raise UsageError where a stage has no derivatives by its lines, or no input has a tolerance.
    """
    tolerances = tolerances_of(chain)
    if not tolerances.uncertain:
        raise UsageError(NO_TOLERANCE)
    try:
        slopes = ChainDerivatives(linear_chain(chain, found, tolerances.uncertain), tolerances.uncertain)
    except Stop as stop:
        raise UsageError(str(stop)) from None
    return slopes.uncertainty(Result("ok", performance=found.performance), slopes.whole, tolerances), slopes
