"""A scene solved, and the derivatives of its figures."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from screwsim.build.sought import is_sought
from screwsim.codegen.program import CannotCompile
from screwsim.cycle.guess import leased
from screwsim.cycle.problem import Problem, leave, one_alone, problem_of
from screwsim.derivatives.around import derivatives
from screwsim.derivatives.closed import FINE, Fineness, NotClosed, collocated
from screwsim.inputs.faults import Impossible
from screwsim.model import leases
from screwsim.numerics.garbage import no_search
from screwsim.scene import Scene
from screwsim.solve.circuit import solved, steady

ONE_CHAMBER = "one chamber at a time is integrated, whose valves and seats have events of their own"
DRIVEN = "the speed follows from the drive"
SOUGHT = "the oil flow, an economizer or a valve is found with the cycle"


class Found(NamedTuple):
    """Derivatives [SI] by path and figure; why paths have none; why there are none at all, '' where there are."""

    derivatives: Mapping[str, Mapping[str, float]]
    refused: Mapping[str, str]
    why: str = ""


def found(scene: Scene, values: Mapping[str, float], fineness: Fineness = FINE) -> Found:
    """Return the derivatives of a scene's figures by numbers [SI] at paths of it."""
    try:
        with no_search():  # scenes composed and figures read are many objects, hardly any of them in a ring
            return _found(scene, values, fineness)
    except NotClosed as error:
        return Found({}, {}, str(error))
    except (Impossible, CannotCompile) as error:
        return Found({}, {}, f"the cycle cannot be linearised: {error}")


def _found(scene: Scene, values: Mapping[str, float], fineness: Fineness) -> Found:
    series = one_alone()
    if not fineness.estimated:
        scene = replace(scene, numerics=replace(scene.numerics, error="none"))
    problem, search = steady(problem_of(scene, series), series)
    why = _refused(problem)
    if why:
        return Found({}, {}, why)
    machinery = leased(problem)
    accurate = solved(problem, machinery, None, search)
    if not accurate.cycle.closed:
        return Found({}, {}, "the cycle does not close")
    cycle = collocated(accurate.evaluation.problem, machinery, accurate.evaluation.life, fineness)
    slopes, refused = derivatives(cycle, values, (series.stock.lent(), series.composer.lent()))
    leases.give_back(machinery)
    leave(series)
    return Found(slopes, refused)


def _refused(problem: Problem) -> str:
    """Return why a problem's derivatives cannot be had so; empty where they can."""
    if problem.parts.shaft is not None:
        return DRIVEN
    if is_sought(problem.scene):
        return SOUGHT
    return ONE_CHAMBER if problem.composition.chambers == 1 else ""
