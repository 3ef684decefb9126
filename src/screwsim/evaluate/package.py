"""What a package around the machine loses of its pressures, and how far a cycle is from that (docs/model.md M343)."""

from typing import NamedTuple

from screwsim.build import package_of
from screwsim.cycle.problem import Problem


class Package(NamedTuple):
    """How far the losses with which a cycle was integrated are from those of its flow.

    `before` and `behind` [Pa] are by how much both should change, `open` the larger over its line's pressure.
    """

    before: float
    behind: float
    open: float


def package_off(problem: Problem, flow: float | None) -> Package | None:
    """Return how far the losses of a problem are from those of a mass flow [kg/s]; None where there is no package."""
    package, posed = package_of(problem.scene), problem.scene.losses
    if package is None or posed is None:
        return None
    outlet = problem.lines.p_d - posed.behind
    found = package.losses(max(flow or 0.0, 0.0) / problem.inlet.density, problem.lines.p_s, outlet)
    before, behind = found.before - posed.before, found.behind - posed.behind
    return Package(before, behind, max(abs(before) / problem.lines.p_s, abs(behind) / outlet))
