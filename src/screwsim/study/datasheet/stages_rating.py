"""Rating of two stages in series: points over two axes, part load, and what the intermediate pressure does.

The axes are the suction of the first stage (evaporating temperature or pressure) and the discharge of the second
(condensing temperature, gas-cooler pressure or discharge pressure), as the scenes state them; every point solves the
intermediate pressure anew (M200). A two-stage file that sweeps these is rated at its values, another one at steps
around its own. The capacity is controlled by the speeds of both stages in proportion. Beside that the speed of the
second stage alone is varied, which moves the intermediate pressure and so shows how far it is from the best. A point
without a solution keeps its status and the reason. Columns of the table, the control and that variation run on all
cores.

A rating is one of those in `rated`: tables, envelope, part load, drawings and documents are those of single machines.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene, with_values, without_sweep
from screwsim.scene.lines import condensate_enthalpy
from screwsim.scene.operation import CONDENSING, EVAPORATING, GAS_COOLER_P, P_D, P_S
from screwsim.study.datasheet import gas_sheet, refrigeration_sheet
from screwsim.study.datasheet.bounds import Limit
from screwsim.study.datasheet.rated import DEAD, Axis, Part, Rating, RatingRequest, rating_around, swept_values
from screwsim.study.datasheet.units import METRIC, Units
from screwsim.study.part_load import (
    GAS,
    HEATING,
    LOADS,
    REFRIGERATION,
    SETTING_COUNT,
    SLOWEST_SPEED,
    SPEED,
    Control,
    PartLoad,
    curve_and_steps,
)
from screwsim.study.pool.progress import Progress
from screwsim.study.stages import ChainResult, run_stages
from screwsim.study.stages.axes import STAGE_NAMES
from screwsim.study.stages.chain import StageChain
from screwsim.study.sweep.stages import solved_with

FIRST, SECOND = (f"{stage}." for stage in STAGE_NAMES)
BOTH = "speed of both stages"
SECOND_SHARES = (0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3)  # of the second stage's speed


@dataclass(frozen=True, kw_only=True)
class ChainRequest(RatingRequest):
    """What is rated of two stages: the axis across is one of the first stage, that down one of the second."""

    chain: StageChain

    def shown(self, path: str, value: float, digits: int = 5) -> str:
        """Return a setting of the control in words: a share of both speeds."""
        return f"{100.0 * value:.{digits}g} %"

    def column(self, across: float) -> list[Result | None]:
        """Return the results at a value across the table; None where no point is computed."""
        first, second = FIRST + self.across.path, SECOND + self.down.path
        return [
            None if self.is_small(across, down) else solved_with(self.chain, {first: across, second: down}).as_result()
            for down in self.down.values
        ]

    def part_load(self, control: Control, full: float) -> PartLoad:
        """Return the results of both speeds in proportion; `full` is the capacity [SI] of load 1."""
        return curve_and_steps(partial(_at_share, self.chain, STAGE_NAMES), control, full, LOADS, self.aim)


@dataclass(frozen=True)
class ChainRating(Rating[ChainRequest]):
    """The rating of two stages, with both at their own point, and results at shares of the second stage's speed."""

    both: ChainResult
    by_second: Sequence[tuple[float, Result]]


def refrigerates(chain: StageChain) -> bool:
    """Return whether the second stage feeds a condenser, or a gas cooler."""
    return condensate_enthalpy(chain.second) is not None


def axis_options(chain: StageChain) -> dict[str, str]:
    """Return the options that state the range of each axis, the first stage's before the second's: option -> path."""
    cold, hot = chain.first.operation, chain.second.operation
    across = ("--evaporating", EVAPORATING) if cold.evaporating_temperature is not None else ("--suction", P_S)
    down = ("--discharge", P_D)
    if hot.gas_cooler is not None or hot.condensing_temperature is not None:
        down = ("--condensing", CONDENSING if hot.gas_cooler is None else GAS_COOLER_P)
    return dict((across, down))


def rating_request(
    chain: StageChain,
    ranges: Mapping[str, str | None],
    bounds: Mapping[Limit, str],
    units: Units = METRIC,
    heating: bool = False,
) -> ChainRequest:
    """Return what is rated, given ranges of the axes' options; raise UsageError in one line.

    Part loads of a plant are shares of the cooling capacity, with `heating` of the heating capacity.
    """
    (first, inlet), (second, outlet) = axis_options(chain).items()
    names = FIRST + inlet, SECOND + outlet
    others = [name for name in chain.sweep if name not in names]
    if others or chain.joints:
        name = others[0] if others else chain.joints[0].paths[0]
        raise UsageError(
            f"datasheet: a sheet of these two stages covers {names[0]} and {names[1]}, but the file varies {name} in "
            f"another way (remove that axis, or compute its points with screwsim sweep)"
        )
    base = without_sweep(chain)
    low, high = _over_both(base)
    settings = np.linspace(1.0, SLOWEST_SPEED, SETTING_COUNT).tolist()
    return ChainRequest(
        chain=base,
        scenes=tuple(base.by_stage.values()),
        across=_axis(chain, low, (FIRST, inlet), ranges.get(first), first),
        down=_axis(chain, high, (SECOND, outlet), ranges.get(second), second),
        bounds=bounds,
        controls=(Control(BOTH, SPEED, tuple(settings)),),
        units=units,
        aim=(HEATING if heating else REFRIGERATION) if refrigerates(chain) else GAS,
    )


def _over_both(chain: StageChain) -> tuple[Scene, Scene]:
    """Return both scenes with the line towards each other at the far end, so that it bounds no axis."""
    cold, hot = chain.first.operation, chain.second.operation
    first, second = chain.first, chain.second
    if cold.condensing_temperature is not None and hot.condensing_temperature is not None:
        first = with_values(first, {CONDENSING: hot.condensing_temperature})
    if cold.evaporating_temperature is not None and hot.evaporating_temperature is not None:
        second = with_values(second, {EVAPORATING: cold.evaporating_temperature})
    return first, second


def _axis(chain: StageChain, scene: Scene, name: tuple[str, str], text: str | None, option: str) -> Axis:
    stage, path = name
    sheet = gas_sheet if path in (P_S, P_D) else refrigeration_sheet
    return sheet.axis_values(scene, path, text, option, swept_values(chain, stage + path))


def rating(asked: ChainRequest, jobs: int | None = None, progress: Progress | None = None) -> ChainRating:
    """Return the rating; raise UsageError, in one line, where no point of the table can be computed."""
    if all(asked.is_small(*case) for case in itertools.product(asked.across.values, asked.down.values)):
        low = "pressures" if asked.aim == GAS else "temperatures"
        raise UsageError(
            f"datasheet: no point of the table can be computed: the {low} of both ends are too near to each other "
            f"(state other ranges with {' and '.join(axis_options(asked.chain))})"
        )
    both = run_stages(asked.chain)
    own = both.as_result()
    strange = [bound.figure for bound in asked.bounds if own.performance and bound.figure not in own.performance]
    if strange:
        known = ", ".join(own.performance)
        raise UsageError(f"--limit {strange[0]}: is not a figure of these two stages (use one of {known})")
    more = [Part(partial(_by_second, asked.chain), [(share, DEAD) for share in SECOND_SHARES])]
    found, further = rating_around(asked, own, more, jobs, progress)
    return ChainRating(asked, own, found.points, found.loads, found.reach, both, further[0] if further else ())


def _by_second(chain: StageChain) -> list[tuple[float, Result]]:
    """Return the results at shares of the second stage's speed, which move the intermediate pressure."""
    return [(share, _at_share(chain, STAGE_NAMES[1:], share)) for share in SECOND_SHARES]


def _at_share(chain: StageChain, stages: Sequence[str], share: float) -> Result:
    """Return the result at a share of the speeds of stages."""
    speeds = {name: getattr(chain, name).operation.speed for name in stages}
    return solved_with(chain, {f"{name}.{SPEED}": share * speed for name, speed in speeds.items()}).as_result()
