"""The oil's circuit: temperatures of its supply and of the separator that follow from the cycle (docs/model.md M284).

A cycle is closed with temperatures as they stand; what it gives the separator tells others (`evaluate.separator`).
Broyden's method finds those that agree, from the Jacobian of the circuit's own heat capacities: what the chambers
change by them is left to learn. Every cycle begins from the one before. The last one is solved as accurately as the
scene asks, and once more where its circuit is more open than that.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from screwsim.build import Temperatures, filled, open_temperatures, temperature_faults
from screwsim.cycle.close import close
from screwsim.cycle.continuation import Course
from screwsim.cycle.guess import leased
from screwsim.cycle.problem import Problem, Series, problem_of
from screwsim.effects.base import InSeparator
from screwsim.errors import relative_errors, worst
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.evaluate.separator import Circuit
from screwsim.model import leases
from screwsim.model.run import Machinery
from screwsim.outputs import Figures
from screwsim.solve.accurately import AIM, TIGHTEST, Accurate, Watch, note, solve
from screwsim.solve.drive import at_its_speed, settled

Array = np.ndarray
MOST = 20  # cycles closed for the temperatures
AGAIN = 8  # times that the last of them is solved once more
OPEN = 0.1  # of the wanted accuracy: what the circuit may leave open of the shaft's power
LEAST = 0.05  # of what a temperature is expected to give back, for what is learnt of it to be believed
LARGEST = 40.0  # [K] of a step
HALVINGS = 6  # of a step to where oil or effects cannot be, or where no cycle closes
WARMER = (15.0, 30.0, 50.0)  # [K] than the first guess, where no cycle closes with that
APART = 0.05  # [K] between two cycles from which sensitivities are taken


@dataclass
class Search:
    """Where the search stands, on a course of its own: Jacobian, last step, what the cycles took."""

    series: Series
    stated: float  # [rad/s], the speed that the scene states
    course: Course = field(default_factory=Course)
    counts: Array | None = None  # of closing the cycles
    time: float = 0.0
    why: str = ""  # it ended at no solution
    jacobian: Array | None = None
    last: tuple[Array, Array] | None = None
    seen: list[tuple[Array, Figures]] = field(default_factory=list)  # temperatures and figures of the cycles

    def step(self, x: Array, circuit: Circuit, both: bool) -> Array:
        """Return the next change of the temperatures [K] from x, where the cycle says the circuit's.

        `both` are found, or one of them. What would turn the search away from where its circuit leads is not learnt.
        """
        off = np.array([circuit.supply, circuit.separator])
        if self.jacobian is None:
            self.jacobian = np.array([[-1.0, 0.0], [circuit.parted.share if both else 0.0, -1.0]])
        elif self.last is not None:
            dx = x - self.last[0]
            if dx @ dx > 0.0:
                learnt = self.jacobian + np.outer(off - self.last[1] - self.jacobian @ dx, dx) / (dx @ dx)
                if np.all(np.linalg.eigvals(learnt).real < -LEAST):
                    self.jacobian = learnt
        self.last = x, off
        found = -np.linalg.solve(self.jacobian, off)
        largest = float(np.max(np.abs(found)))
        return found * min(1.0, LARGEST / largest) if largest > 0.0 else found

    def learn(self, of: Evaluation, x: Array) -> None:
        """Note by how much the figures change with the temperatures: from the last cycle that was not as near."""
        for other, figures in reversed(self.seen):
            apart = float(np.max(np.abs(x - other)))
            if apart > APART:
                changes = relative_errors(of.figures, figures, *of.least)
                self.series.per_kelvin = {name: size / apart for name, size in changes.items() if size is not None}
                break
        self.seen.append((x, of.figures))

    def closed(self, problem: Problem, course: Course) -> Evaluation | None:
        """Return a problem's closed cycle, begun from a course; None where it does not close."""
        machinery = leased(problem)
        watch, wanted = Watch(machinery), problem.wanted
        cycle = settled(problem, machinery, wanted, close(problem, machinery, wanted, course))
        watch.lap("closing")
        self.counts = watch.counts["closing"] + (0 if self.counts is None else self.counts)
        self.time += watch.times["closing"]
        leases.give_back(machinery)
        of = evaluate(problem, cycle)
        if cycle.status != "ok":
            return None
        note(self.course, of, cycle, wanted, self.course.tightness)
        return of

    def posed(self, problem: Problem, x: Array) -> Problem | None:
        """Return a problem at other temperatures; None, with the reason noted, where oil or effects cannot be there."""
        at = Temperatures(*x.tolist())
        scene = filled(problem.scene, at)
        faults = temperature_faults(scene)
        if faults:
            self.why = f"the oil's circuit leads to where {faults[0]}"
            return None
        self.series.temperatures = at
        part = problem.parts.shaft
        held = part is None or part.train(self.stated).holds_mean
        return at_its_speed(problem_of(scene, self.series, None if held else self.stated), self.series)

    def next(self, of: Evaluation, circuit: Circuit) -> Evaluation | None:
        """Return the cycle at the next temperatures; None, with the reason noted, where none is found."""
        x = temperatures_of(of.problem)
        self.learn(of, x)
        step = self.step(x, circuit, all(open_temperatures(of.problem.scene)))
        for _ in range(HALVINGS):
            problem = self.posed(of.problem, x + step)
            found = None if problem is None else self.closed(problem, self.course)
            if found is not None:
                self.why = ""
                return found
            step = 0.5 * step
        return None


def temperatures_of(problem: Problem) -> Array:
    """Return the temperatures [K] of supply and separator with which a problem is posed."""
    assert problem.parts.oil is not None
    T = problem.parts.oil.temperature
    every = (one.parameters for one in problem.scene.effects.values())
    asked = (one.separator_temperature for one in every if isinstance(one, InSeparator))
    return np.array([T, next((at for at in asked if at is not None), T)], float)


def steady(problem: Problem, series: Series) -> tuple[Problem, Search | None]:
    """Return the problem at the mean speed and the temperatures that follow from its cycle, and how they were found."""
    if not any(open_temperatures(problem.scene)):
        return at_its_speed(problem, series), None
    search = Search(series, problem.scene.operation.speed)
    search.course.tightness = series.course.tightness
    problem = at_its_speed(problem, series)
    of, guess = search.closed(problem, series.course), temperatures_of(problem)
    for warmer in WARMER:
        if of is not None:
            break
        other = search.posed(problem, guess + warmer)
        of = None if other is None else search.closed(other, series.course)
    if of is None:
        return problem, search
    for _ in range(MOST):
        circuit = of.circuit
        if not isinstance(circuit, Circuit) or circuit.open <= OPEN * of.problem.scene.numerics.accuracy:
            break
        after = search.next(of, circuit)
        if after is None:
            break
        of = after
    return of.problem, search


def solved(problem: Problem, machinery: Machinery, course: Course | None, search: Search | None) -> Accurate:
    """Return the cycle solved as accurately as it asks, its circuit no more open than that.

    What the search took counts as closing. The errors that the temperatures have add to those of the figures.
    """
    if search is None:
        return solve(problem, machinery, course)
    counts, spent, estimating = search.counts, search.time, 0.0
    accurate = solve(problem, machinery, search.course)
    errors = _with_temperatures(accurate, search)
    for _ in range(AGAIN):
        circuit = accurate.evaluation.circuit
        at_rest, size = _left(accurate, circuit, errors)
        if at_rest or not isinstance(circuit, Circuit):
            break
        x, tightness = temperatures_of(accurate.evaluation.problem), accurate.tightness * min(1.0, AIM / size)
        note(search.course, accurate.evaluation, accurate.cycle, accurate.wanted, max(tightness, TIGHTEST))
        search.learn(accurate.evaluation, x)
        both = all(open_temperatures(problem.scene))
        other = search.posed(accurate.evaluation.problem, x + search.step(x, circuit, both))
        if other is None:
            break
        counts, spent = _sum(counts, accurate.counts), spent + accurate.closing_time
        estimating += accurate.estimating_time
        machinery.begin(other.composition)
        accurate = solve(other, machinery, search.course)
        errors = _with_temperatures(accurate, search)
    return accurate._replace(
        errors=errors,
        counts=_sum(counts, accurate.counts),
        closing_time=spent + accurate.closing_time,
        estimating_time=estimating + accurate.estimating_time,
    )


def _left(accurate: Accurate, circuit: Circuit | str | None, errors: Figures) -> tuple[bool, float]:
    """Tell whether a cycle needs no other temperatures; return the largest error over the wanted accuracy."""
    accuracy = accurate.evaluation.problem.scene.numerics.accuracy
    size = worst(errors)[1] / accuracy
    if not isinstance(circuit, Circuit) or accurate.cycle.status != "ok":
        return True, size
    fixed = accurate.evaluation.problem.scene.numerics.rtol is not None
    return circuit.open <= OPEN * accuracy and (size <= 1.0 or fixed), max(size, AIM)


def _with_temperatures(accurate: Accurate, search: Search) -> Figures:
    """Return the errors of the figures with those that the temperatures have: of what is open, and of the cycle's."""
    circuit, errors = accurate.evaluation.circuit, Figures(accurate.errors)
    of_separator = errors.get("separator_temperature")
    if not isinstance(circuit, Circuit) or of_separator is None or search.why:
        return errors
    off = of_separator * circuit.parted.T_separator
    off = max(abs(circuit.supply) + circuit.parted.gain * off, abs(circuit.separator) + off)
    for name, size in errors.items():
        if size is not None:
            errors[name] = size + off * search.series.per_kelvin.get(name, 0.0)
    return errors


def _sum(counts: Array | None, more: Array) -> Array:
    return more if counts is None else counts + more
