"""Derivatives of the figures of two stages together, linear around their solution.

At the solution each stage's figures have derivatives by its own inputs and by the states of its lines, exact wherever
those of a scene are; no cycle is solved anew. What passes between the stages follows from them: the pressure p is the
unknown, and its residual r = ln of the flow that arrives over the flow taken (M200), so that an input x moves it by
dp/dx = −(∂r/∂x)/(∂r/∂p), the implicit function; temperature and vapour behind the first stage follow from its figures
and p (M201, M202). Figures of both together are algebra of the stages' figures, lines and p: their derivative is a
central difference of that algebra along (x, p(x)).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from screwsim.inputs.faults import UsageError
from screwsim.outputs import STAGES, Result
from screwsim.scene import Scene, lines, value_at
from screwsim.scene.lines import Lines
from screwsim.scene.operation import P_D, P_S, QUALITY, T_S
from screwsim.study.stages.axes import STAGE_NAMES
from screwsim.study.stages.figures import StagePair, chain_figures, delivery_temperature
from screwsim.study.stages.solve import ChainSolver
from screwsim.study.uncertainty.slopes import Sensitivities, scene_sensitivities, size_of, within_limits
from screwsim.study.uncertainty.spreads import Tolerances, Uncertainty, groups_of, spreads_of

if TYPE_CHECKING:
    from screwsim.study.stages.chain import StageChain
    from screwsim.study.stages.result import ChainResult

LINE_PATHS = (P_S, T_S, QUALITY, P_D)  # of a stage at the solution, which states its lines by these alone
INPUT_STEP = 1e-4  # of an input's size
PRESSURE_STEP = 1e-4  # of the pressure between the stages
Slopes = dict[str, dict[str, float]]  # derivative [SI] of each figure by each input


@dataclass(frozen=True)
class LinearChain:
    """Both stages at the solution, and the derivatives of each one's figures."""

    chain: StageChain
    pair: StagePair
    slopes: tuple[Sensitivities, Sensitivities]

    @property
    def lost(self) -> dict[str, str]:
        """The inputs that have no derivative, and why."""
        every = zip(STAGE_NAMES, self.slopes, strict=True)
        return {f"{stage}.{path}": why for stage, own in every for path, why in own.left_out.items()}

    def at(self, name: str, value: float, dp: float) -> tuple[ChainSolver, StagePair]:
        """Return both stages with another value [SI] of an input ('' for none), and the pressure moved by dp [Pa]."""
        solver = ChainSolver(self.chain.with_values({name: value}) if name else self.chain)
        here, drop = self.pair, solver.chain.intercooler.pressure_drop
        p, low, high = here.p + dp, lines(self.chain.first), lines(self.chain.second)
        own = self._own(name, value)
        changes = _line_changes(low, solver.low) | {P_D: dp} | own[0]
        first = _changed(here.results[0], self.slopes[0], changes)
        vapour, T = solver.between(p, delivery_temperature(first))
        suction = {P_S: dp - (drop - self.chain.intercooler.pressure_drop), T_S: T - here.T}
        second = _changed(here.results[1], self.slopes[1], {P_D: solver.high.p_d - high.p_d} | suction | own[1])
        return solver, here._replace(p=p, results=(first, second), vapour=vapour, T=T)

    def _own(self, name: str, value: float) -> list[dict[str, float]]:
        """Return the change of an input of the machine of a stage, by stage; none for one of a line."""
        stage, _, path = name.partition(".")
        found = []
        for each, scene in zip(STAGE_NAMES, self.pair.scenes, strict=True):
            mine = stage == each and _is_own(scene, path)
            found.append({path: value - float(value_at(scene, path))} if mine else {})
        return found


class ChainDerivatives:
    """Derivatives of the figures of both together (`whole`) and of each stage, by the inputs at `values` [SI].

    They are differences over steps of the inputs `names`, but for those that are lost.
    """

    def __init__(self, linear: LinearChain, names: Iterable[str]) -> None:
        self._linear = linear
        self.values: dict[str, float] = {}
        self.whole: Slopes = {}
        self.stages: tuple[Slopes, Slopes] = ({}, {})
        step = PRESSURE_STEP * linear.pair.p
        above, below = (linear.at("", 0.0, by)[1].excess for by in (step, -step))
        by_pressure = (above - below) / (2.0 * step)
        for name in (name for name in names if name not in linear.lost):
            self._add(name, by_pressure)

    def _add(self, name: str, by_pressure: float) -> None:
        """Add the derivatives by one input; `by_pressure` is that of the residual [1/Pa]."""
        value = self.values[name] = float(self._linear.chain.value_at(name))
        leaf = self._linear.chain.leaf_of(name)
        steps = within_limits(leaf, value, INPUT_STEP * size_of(leaf, value))  # at an end of its range to one side only
        width = steps[0] - steps[1]
        above, below = (self._linear.at(name, value + by, 0.0)[1].excess for by in steps)
        slope = -(above - below) / (width * by_pressure)  # of the pressure
        (up, high), (down, low) = (self._linear.at(name, value + by, slope * by) for by in steps)
        figures = [chain_figures(solver, pair)[0] for solver, pair in ((up, high), (down, low))]
        asked = {figure: value for figure, value in figures[0].items() if not STAGES[figure].scale.unasked}
        _add_slopes(self.whole, name, (asked, figures[1]), width)
        for number, into in enumerate(self.stages):
            there = self._linear.slopes[number].derivatives
            one = {figure: value for figure, value in high.results[number].performance.items() if figure in there}
            _add_slopes(into, name, (one, low.results[number].performance), width)

    def uncertainty(self, result: Result, slopes: Slopes, tolerances: Tolerances) -> Uncertainty:
        """Return the uncertainties of a result's figures with these derivatives."""
        spreads = spreads_of(tolerances, self.values, slopes)
        known = Sensitivities(result, values=self.values, derivatives=slopes, method=self.methods)
        return Uncertainty(spreads, known, groups_of(tolerances), self._linear.lost)

    @property
    def methods(self) -> dict[str, str]:
        """How derivatives by each input were found; by one of a line, those by the state of that line."""
        first, second = self._linear.slopes
        return {name: _method(second if name.startswith(STAGE_NAMES[1]) else first, name) for name in self.values}


def linear_chain(chain: StageChain, found: ChainResult, names: Iterable[str], fine: bool = False) -> LinearChain:
    """Return the chain at a solution with the derivatives of its stages by the inputs named, and by their lines.

    Raise UsageError where a stage has none by its lines. `fine` is as in `point.sensitivities`.
    """
    names = list(names)
    (one, other), (first, second) = found.scenes, found.stages
    solver, p = ChainSolver(chain), float(found.performance.intermediate_pressure)
    vapour, T = solver.between(p, delivery_temperature(first))
    pair = StagePair(p, (one, other), (first, second), vapour, T, found.notes.get("second_separator_temperature", ""))
    slopes = []
    for number, (stage, scene, result) in enumerate(zip(STAGE_NAMES, pair.scenes, pair.results, strict=True)):
        paths = [name.partition(".")[2] for name in names if name.startswith(f"{stage}.")]
        own = [path for path in paths if _is_own(scene, path)]
        always = (P_D,) if number == 0 else (P_S, T_S)
        line = [path for path in LINE_PATHS if value_at(scene, path) is not None]
        needed = [path for path in line if path in always or len(own) < len(paths)]
        these = scene_sensitivities(scene, [*own, *needed], result=result, fine=fine)
        if missing := [path for path in needed if path not in these.values]:
            why = these.left_out.get(missing[0], "it has no derivative")
            raise UsageError(f"the {stage} stage by {missing[0]}: {why}")
        slopes.append(these)
    return LinearChain(chain, pair, (slopes[0], slopes[1]))


def _method(own: Sensitivities, name: str) -> str:
    of_line = next((own.method[path] for path in LINE_PATHS if path in own.method), "")
    return own.method.get(name.partition(".")[2], of_line)


def _is_own(scene: Scene, path: str) -> bool:
    """Tell whether an input is one of a stage's machine, not of its lines, which the scene at the solution restates."""
    return path not in LINE_PATHS and value_at(scene, path) is not None


def _line_changes(here: Lines, there: Lines) -> dict[str, float]:
    """Return how the suction line differs [SI], by the paths by which a stage at the solution states it."""
    found = {P_S: there.p_s - here.p_s}
    if here.quality is None or there.quality is None:
        return found | {T_S: there.T_s - here.T_s}
    return found | {QUALITY: there.quality - here.quality}


def _changed(result: Result, slopes: Sensitivities, changes: Mapping[str, float]) -> Result:
    """Return a result with its figures moved along their derivatives by changes [SI] of inputs."""
    moved = {path: by for path, by in changes.items() if by}
    performance = result.performance.copy()
    for name, by_path in slopes.derivatives.items():
        performance[name] += sum(by_path[path] * by for path, by in moved.items() if path in by_path)
    return replace(result, performance=performance)


def _add_slopes(into: Slopes, name: str, ends: tuple[Mapping[str, Any], Mapping[str, Any]], width: float) -> None:
    """Add the derivative of each figure by an input, from the figures at both ends of a step of this width [SI]."""
    above, below = ends
    for figure, value in above.items():
        other = below.get(figure)
        if value is not None and other is not None:
            into.setdefault(figure, {})[name] = (value - other) / width
