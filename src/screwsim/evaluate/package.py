"""Whether a package's pressure losses are those at its flow, and which figures it has none of while unloaded.

Source: docs/model.md M343.
"""

from typing import NamedTuple

from screwsim.build import package_of
from screwsim.cycle.problem import Problem
from screwsim.effects.base import Given
from screwsim.effects.parts.lines import BLOWN_OFF

OVER_DELIVERY = (
    *("isothermal_efficiency", "ideal_isothermal_efficiency", "isentropic_efficiency", "specific_power"),
    *("electrical_isothermal_efficiency", "electrical_isentropic_efficiency"),
)


class Package(NamedTuple):
    """The difference between the losses with which a cycle was integrated and those at its flow.

    `before` and `behind` [Pa] are the changes needed, `open` is the larger one over its line's pressure.
    """

    before: float
    behind: float
    open: float


def package_residual(problem: Problem, flow: float | None) -> Package | None:
    """Return the difference between a problem's losses and those at a mass flow [kg/s]; None without a package."""
    package, posed = package_of(problem.scene), problem.scene.losses
    if package is None or posed is None:
        return None
    outlet = problem.lines.p_d - posed.behind
    found = package.losses(max(flow or 0.0, 0.0) / problem.inlet.density, problem.lines.p_s, outlet)
    before, behind = found.before - posed.before, found.behind - posed.behind
    return Package(before, behind, max(abs(before) / problem.lines.p_s, abs(behind) / outlet))


def without_delivery(problem: Problem) -> Given:
    """Return why figures that judge the gas that is delivered have no value; nothing of a package that delivers."""
    package = package_of(problem.scene)
    return {} if package is None or package.delivers else dict.fromkeys(OVER_DELIVERY, BLOWN_OFF)
