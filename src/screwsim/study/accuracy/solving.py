"""One scene solved in a stated way: integrator, closing, tolerances, regularisation and breakpoints, set separately.

`simulate` derives all of these from the wanted accuracy. A study of that accuracy has to set them one by one: each of
its cases is a scene and a way of solving it.
"""

import math
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from screwsim.build import WIDTH
from screwsim.cycle.close import close
from screwsim.cycle.guess import compile_start
from screwsim.cycle.problem import ClosingTask, Series, problem_of
from screwsim.cycle.simultaneous import chambers_at_pitches, close_together
from screwsim.cycle.solution import ClosingCriteria, CycleSolution
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.fluid.models import find_gas_model
from screwsim.machine.kinds import kind_of
from screwsim.machine.protocol import ROTORS
from screwsim.model import leases
from screwsim.model.composition import Composition
from screwsim.model.run import Machinery
from screwsim.model.slots import P_INJECTION, P_LIFE, P_PITCH
from screwsim.numerics.compiling import seconds_again
from screwsim.numerics.integrators import CHECKS, DEFAULT, check_of
from screwsim.numerics.rodas import TAKEN
from screwsim.scene import Scene, with_values
from screwsim.solve.accurately import CostMeter
from screwsim.solve.circuit import steady_state
from screwsim.solve.drive import close_with_drive
from screwsim.study.accuracy.coolprop_back_end import is_replaceable

START_ACCURACY = 1e-2  # accuracy of the cycle from which scipy's integrators start
LEAST_REGULARISATION = 1e-12  # of a pressure: used for a regularisation of zero, where the model would divide 0 by 0
TIGHT_ACCURACY = 1e-7  # accuracy of everything except the one choice under study


class WorkLimit(Exception):
    """The allowed time is used up."""


@dataclass(frozen=True)
class Method:
    """Way of solving a scene. `regularised` times the pressure of a line is the width ε of the regularisation there."""

    integrator: str = DEFAULT
    closing: str = "histories"
    rtol: float = 1e-4
    tolerance: float = 1e-4
    bound: float = 1e-3
    regularised: float = 1.5e-4
    landing: bool = True  # whether steps end on the breakpoints of the laws


def method_of(accuracy: float, integrator: str = DEFAULT, closing: str = "coupled", **others: Any) -> Method:
    """Return the way that follows from a wanted accuracy (docs/explanation/errors.md), with `others` changed."""
    known: dict[str, Any] = {"rtol": 0.3 * accuracy, "tolerance": 0.2 * accuracy}
    known |= {"bound": accuracy, "regularised": WIDTH * accuracy}
    return Method(integrator, closing, **(known | others))


@dataclass(frozen=True)
class SolvedCase:
    """A solution with its cost: wall time [s] of the closing and evaluations of one chamber's right-hand side."""

    cycle: CycleSolution
    evaluation: Evaluation
    time: float
    evaluations: int
    steps: int


@contextmanager
def work_limit(machinery: Machinery, seconds: float) -> Iterator[None]:
    """Raise WorkLimit inside this block when the processor time [s] is used up; compilation does not count."""
    end = time.process_time() + seconds - machinery.compile_time - seconds_again()

    def watch() -> None:
        if time.process_time() > end + machinery.compile_time + seconds_again():
            raise WorkLimit(f"not closed within its limit of {seconds:g} s of processor time")

    machinery.watch = watch
    try:
        yield
    finally:
        machinery.watch = lambda: None


def solve(scene: Scene, how: Method, limit: float = math.inf, machinery: Machinery | None = None) -> SolvedCase:
    """Return the scene solved in that way. Raises WorkLimit after `limit` seconds.

    scipy's integrators start from a loose cycle (`START_ACCURACY`) of our own method, whose cost is counted; our own
    method starts in that way by itself for `closing: coupled`. `machinery` must be one of the scene's; without it one
    is leased.
    """
    series = Series()
    scene = replace(scene, numerics=replace(scene.numerics, integrator=how.integrator))
    problem, _ = steady_state(problem_of(scene, series), series)
    composition = replace(problem.composition, breakpoints=_breakpoints(problem.composition, how.landing))
    at, check = problem.lines, check_of(how.integrator)
    own = max(at.p_s, at.p_d)  # for ports to plenums of effects; the width of gaps follows the pressures at their ends
    pressures = np.array([at.p_s, at.p_d, 1.0, *(own for _ in range(composition.n_widths - 3))])
    widths = tuple((max(how.regularised, LEAST_REGULARISATION) * pressures).tolist())
    wanted = ClosingCriteria(how.rtol, how.tolerance, how.bound, how.closing, widths, check=check)
    begun = tuple((START_ACCURACY * pressures).tolist())
    loose = ClosingCriteria(0.3 * START_ACCURACY, 0.2 * START_ACCURACY, START_ACCURACY, "auto", begun)
    problem = replace(problem, composition=composition, criteria=wanted)
    lent = machinery is None
    machinery = machinery or leases.lease(composition)
    machinery.begin(composition)
    machinery.warm_up(lambda: compile_start(problem, machinery))
    watch = CostMeter(machinery)
    with work_limit(machinery, limit), warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # explicit methods overflow before they shorten a step
        first = wanted if check is None else loose
        task = ClosingTask(problem, machinery, first)
        cycle = close_with_drive(task, close(task))
        if check is not None and not cycle.failed:
            task = ClosingTask(problem, machinery, wanted)
            cycle = close_with_drive(task, close_together(task, chambers_at_pitches(machinery)))
    watch.lap()
    cost, evaluations = watch.cost, machinery.evaluations_of(watch.cost.counts)
    if lent:
        leases.give_back(machinery)
    return SolvedCase(cycle, evaluate(problem, cycle), cost.closing, evaluations, int(cost.counts[TAKEN]))


def _breakpoints(composition: Composition, landing: bool) -> np.ndarray:
    """Return the angles at which steps end: all, or only those where chambers begin and end, and oil enters."""
    if landing:
        return composition.breakpoints
    P = composition.P
    jumps = np.append(np.arange(0.0, P[P_LIFE], P[P_PITCH]), (P[P_INJECTION], P[P_LIFE]))
    near = np.abs(composition.breakpoints[:, None] - jumps[None, :]).min(axis=1) < 1e-6
    return composition.breakpoints[near]


@dataclass(frozen=True)
class Scope:
    """Scope of a study: the accuracies and sizes that are tried, and limits of time."""

    asked: tuple[float, ...] = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)  # of our own method
    scipy_asked: tuple[float, ...] = (1e-2, 1e-4, 1e-6)
    back_end_asked: tuple[float, ...] = (1e-2, 1e-3, 1e-4)
    widths: tuple[float, ...] = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)  # over those of the scene's accuracy
    closures: tuple[float, ...] = (0.01, 0.1, 1.0, 10.0, 100.0)
    dead_volumes: tuple[float, ...] = (0.1, 10.0)
    reference: float = 1e-10
    check: float = 1e-10  # step tolerance of the second method
    check_limit: float = 60.0  # [s]
    limit: float = 5.0  # [s] per case
    seconds: float = 0.5  # [s] in which a case is repeated
    runs: int = 9  # at most
    points: tuple[int, ...] = (1, 10, 100, 1000)
    lobes: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 7, 8)
    pairs: int = 31  # paired runs for the cost of an effect


QUICK_SCOPE = Scope(
    asked=(1e-2, 1e-3, 1e-4),
    scipy_asked=(1e-3,),
    back_end_asked=(1e-3,),
    widths=(0.0, 1.0, 100.0),
    closures=(1.0, 100.0),
    dead_volumes=(10.0,),
    reference=1e-7,
    check=1e-8,
    check_limit=20.0,
    limit=1.0,
    seconds=0.05,
    runs=3,
    points=(1, 4),
    lobes=(),
    pairs=3,
)


@dataclass(frozen=True)
class Case:
    """One solution to compute: its part of the study, the requested accuracy, the way, and the property back end."""

    part: str
    label: str
    asked: float
    way: Method
    scene: Scene
    back_end: str  # 'ideal' | 'compiled' | 'coolprop' | 'own'
    factor: float | None = None  # factor on the choice under study
    own_reference: bool = False  # whether it is another model, with a reference of its own


def own_back_end(scene: Scene) -> str:
    """Return the property back end of a scene's gas."""
    return find_gas_model(scene.gas.model).back_end


def integrators(scene: Scene, extent: Scope) -> Iterator[Case]:
    """Yield every integrator on the scene's own gas: ours of orders 4 and 3, scipy's."""
    gas = own_back_end(scene)
    for closing in ("histories", "coupled"):
        for asked in extent.asked:
            yield Case("integrators", f"rodas4 {closing}", asked, method_of(asked, closing=closing), scene, gas)
    for asked in extent.asked:
        yield Case("integrators", "rodas3 histories", asked, method_of(asked, "rodas3", "histories"), scene, gas)
    for name in CHECKS:
        for asked in extent.scipy_asked:
            yield Case("integrators", name, asked, method_of(asked, name), scene, gas)


def back_ends(scene: Scene, extent: Scope) -> Iterator[Case]:
    """Yield our method and one of scipy's on the other property back ends."""
    other = "compiled" if own_back_end(scene) == "ideal" else "ideal"
    model = "real" if other == "compiled" else "ideal"
    k = None if model == "real" else scene.gas.isentropic_exponent
    changed = replace(scene, gas=replace(scene.gas, model=model, isentropic_exponent=k), text="")
    tries: list[tuple[str, Scene]] = [(other, changed)]
    if is_replaceable(scene):
        tries.append(("coolprop", scene))
    for gas, base in tries:
        for name, closing in ((DEFAULT, "histories"), ("scipy-lsoda", "coupled")):
            label = f"{name} {closing}" if name == DEFAULT else name
            asks = extent.back_end_asked if name == DEFAULT else extent.back_end_asked[-1:]
            if gas == "coolprop" and name != DEFAULT:
                continue  # see `omitted_methods`
            for asked in asks:
                how = method_of(asked, name, closing)
                yield Case("back ends", f"{label}, {gas}", asked, how, base, gas, own_reference=gas == other)


def numerical_choices(scene: Scene, extent: Scope) -> Iterator[Case]:
    """Yield the numerical choices of the model itself, varied one at a time."""
    gas, asked = own_back_end(scene), scene.numerics.accuracy
    for closing in ("histories", "coupled"):
        for landing in (True, False):
            how = method_of(asked, closing=closing, landing=landing)
            text = f"{closing}, {'on breakpoints' if landing else 'not on breakpoints'}"
            yield Case("breakpoints", text, asked, how, scene, gas, factor=float(landing))
    for factor in extent.widths:
        how = method_of(asked, closing="histories", regularised=factor * WIDTH * asked)
        yield Case("regularisation", f"histories, {_times(factor)}", asked, how, scene, gas, factor)
    for factor in extent.widths:
        how = method_of(TIGHT_ACCURACY, regularised=factor * WIDTH * asked)
        yield Case("regularisation alone", f"all else 1e-7, {_times(factor)}", asked, how, scene, gas, factor)
    for factor in extent.closures:
        how = method_of(asked, closing="histories", tolerance=0.2 * asked * factor, bound=asked * max(factor, 1.0))
        yield Case("closure", f"histories, {_times(factor)}", asked, how, scene, gas, factor)
    path, dead = kind_of(scene.machine).dead_volume(scene.machine)
    for factor in extent.dead_volumes if path else ():
        changed = with_values(scene, {path: factor * dead})
        how = method_of(asked, closing="histories")
        yield Case("dead volume", f"histories, {_times(factor)}", asked, how, changed, gas, factor, own_reference=True)


def _times(factor: float) -> str:
    return f"x {factor:g}"


def omitted_methods(scene: Scene) -> Iterator[tuple[str, str]]:
    """Yield what is not tried at all, and why."""
    yield "start and end angle", "not in the model: the whole life of a chamber is integrated"
    yield "regularisation x 0", "set to 1e-12 of the pressure: at zero the model would divide 0 by 0 at equal pressures"
    if not find_gas_model(scene.gas.model).by_coolprop:
        yield "CoolProp called directly", "the scene's gas is ideal, which CoolProp does not offer"
    elif scene.gas.relative_humidity:
        yield "CoolProp called directly", "its equations of moist air do not cover liquid water"
    else:
        yield "scipy on CoolProp", "thousands of calls back into Python, each for eight chambers: minutes per cycle"
    kind = kind_of(scene.machine)
    if not kind.dead_volume(scene.machine)[0]:
        tabled = ROTORS in kind.offers
        what = "part of the table of machine.volume.law: table" if tabled else "not a path of this scene"
        yield "dead volume", f"is {what}"
    if ROTORS not in kind.offers:
        yield "male lobes", f"{kind.chamber} has none"


def all_cases(scene: Scene, extent: Scope) -> list[Case]:
    """Return all cases of a scene."""
    makers: tuple[Any, ...] = (integrators, back_ends, numerical_choices)
    return [case for make in makers for case in make(scene, extent)]
