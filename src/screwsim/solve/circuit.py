"""What lies around the machine and follows from its cycle: the oil's circuit (M284), a package's losses (M343).

A cycle is closed with temperatures of the oil's supply and of the separator, and with lost pressures, as they stand;
what it gives the separator (`evaluate.separator`), and its flow (`evaluate.separator`), tell others. Broyden's method
finds those that agree, from the Jacobian of the circuit's own heat capacities, or from that of the point before: what
the chambers change by them is left to learn. Every cycle begins from the one before, and is closed no better than the
step after it needs. The last one is closed as accurately as the scene asks, and its errors are estimated; once more
where its surroundings are more open than that.
"""

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from screwsim.build import Temperatures, filled, open_temperatures, package_of, sought, temperature_faults
from screwsim.cycle.close import close
from screwsim.cycle.continuation import Course
from screwsim.cycle.guess import leased
from screwsim.cycle.problem import Problem, Series, problem_of
from screwsim.cycle.solution import CycleSolution, Wanted
from screwsim.effects.base import InSeparator, PressureLosses
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.evaluate.separator import Circuit
from screwsim.figures.errors import error_of, relative_errors, worst
from screwsim.model import leases
from screwsim.model.run import Machinery
from screwsim.outputs import Figures
from screwsim.solve.accurately import AIM, TIGHTEST, Accurate, Watch, asked_for, note, solve
from screwsim.solve.drive import at_its_speed, settled

Array = np.ndarray
MOST = 20  # cycles closed for what lies around
AGAIN = 8  # times that the last of them is solved once more
OPEN = 0.2  # of the wanted accuracy: what may be left open of the shaft's power, or of a pressure
LEAST = 0.05  # of what an unknown is expected to give back, for what is learnt of it to be believed
KPA = 1e3  # [Pa] of a lost pressure that count as a kelvin
LARGEST = 40.0  # [K, kPa] of a step
HALVINGS = 6  # of a step to where oil or effects cannot be, or where no cycle closes
WARMER = (15.0, 30.0, 50.0)  # [K] than the first guess, where no cycle closes with that
CONTRACTS = 0.1  # what a step is expected to leave of what is open ...
LEARNT = 0.01  # ... the same with a Jacobian of the point before ...
ROUGH = 0.05  # ... and the changes over that, with which the cycle after it is closed
ROUGHEST = 1e-3  # tolerance of a step of such a cycle, at most: looser ones may go astray
UNCLOSED = 0.6  # of what the energy that a cycle leaves open makes of the mixture's temperature, by which that errs
APART = 0.05  # [K, kPa] between two cycles from which sensitivities are taken
DUTY = "oil_cooler_duty"  # the figure of what the oil cooler takes
ALL = 0.98  # of the suction pressure, beyond which nothing would be left to suck


class Asked(NamedTuple):
    """What a cycle asks of its surroundings.

    `off` [K, kPa] is by how much the unknowns should change, `share` by how much the separator follows the supply,
    `open` what is left open, of the shaft's power or of a pressure.
    """

    off: Array
    share: float
    open: float


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
    seen: list[tuple[Array, Figures]] = field(default_factory=list)  # unknowns and figures of the cycles
    expected: float = 1.0  # what the next cycle will leave open
    contracts: float = CONTRACTS  # what a step is expected to leave of that
    cycle: CycleSolution | None = None  # the last one; None where it was closed less tightly than the scene asks

    def step(self, x: Array, asked: Asked) -> Array:
        """Return the next change of the unknowns [K, kPa] from x, where the cycle asks for others.

        What would turn the search away from where its circuit leads is not learnt.
        """
        off = asked.off
        if self.jacobian is None:
            self.jacobian = -np.eye(len(off))
            self.jacobian[1, 0] = asked.share
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
        """Note by how much the figures change with the unknowns: from the last cycle that was not as near."""
        for other, figures in reversed(self.seen):
            apart = float(np.max(np.abs(x - other)))
            if apart > APART:
                changes = relative_errors(of.figures, figures, *of.least)
                self.series.per_step = {name: size / apart for name, size in changes.items() if size is not None}
                break
        self.seen.append((x, of.figures))

    def closed(self, problem: Problem, course: Course) -> Evaluation | None:
        """Return a problem's closed cycle, begun from a course; None where it does not close."""
        machinery = leased(problem)
        watch, asked = Watch(machinery), asked_for(problem, self.course.tightness)
        wanted = _rough(asked, self.expected)
        cycle = settled(problem, machinery, wanted, close(problem, machinery, wanted, course))
        watch.lap("closing")
        self.counts = watch.counts["closing"] + (0 if self.counts is None else self.counts)
        self.time += watch.times["closing"]
        leases.give_back(machinery)
        of = evaluate(problem, cycle)
        if not cycle.closed:
            return None
        self.cycle = cycle if wanted is asked else None
        note(self.course, of, cycle, wanted, self.course.tightness)
        return of

    def posed(self, problem: Problem, x: Array) -> Problem | None:
        """Return a problem at other unknowns; None, with the reason noted, where oil or effects cannot be there."""
        scene = problem.scene
        if any(open_temperatures(scene)):
            self.series.temperatures = Temperatures(*x[:2].tolist())
            scene = filled(scene, self.series.temperatures)
            faults = temperature_faults(scene)
            if faults:
                self.why = f"the oil's circuit leads to where {faults[0]}"
                return None
        lost, others = (2 if scene.losses is not None else 0), x[2:].tolist()
        if len(others) > lost:
            self.series.sought = open_numbers = others[lost:]
            scene = sought.placed(scene, open_numbers)
        if lost:
            before, behind = (KPA * each for each in others[:lost])
            if not before < ALL * problem.lines.p_s:
                self.why = "what the package loses before the machine leaves nothing to suck (smaller losses)"
                return None
            self.series.losses = PressureLosses(max(before, 0.0), behind)
            scene = replace(scene, losses=self.series.losses)
        part = problem.parts.shaft
        held = part is None or part.train(self.stated).holds_mean
        return at_its_speed(problem_of(scene, self.series, None if held else self.stated), self.series)

    def next(self, of: Evaluation, asked: Asked) -> Evaluation | None:
        """Return the cycle at the next unknowns; None, with the reason noted, where none is found."""
        x = unknowns_of(of.problem)
        self.learn(of, x)
        step = self.step(x, asked)
        for _ in range(HALVINGS):
            problem = self.posed(of.problem, x + step)
            found = None if problem is None else self.closed(problem, self.course)
            if found is not None:
                self.why = ""
                return found
            step = 0.5 * step
        return None


def _rough(wanted: Wanted, open_: float) -> Wanted:
    """Return what is wanted of a cycle that leaves so much open anyway; the same where that is all it may."""
    tolerance, bound = ROUGH * open_, CONTRACTS * open_
    if wanted.check or tolerance <= wanted.tolerance:
        return wanted
    rtol = min(tolerance * wanted.rtol / wanted.tolerance, max(ROUGHEST, wanted.rtol))
    return replace(wanted, rtol=rtol, tolerance=tolerance, bound=max(bound, wanted.bound), of_histories=1.0)


def unknowns_of(problem: Problem) -> Array:
    """Return what a problem is posed with: temperatures [K] of supply and separator, and lost pressures [kPa]."""
    T = _oil_temperature(problem)
    every = (one.parameters for one in problem.scene.effects.values())
    asked = (one.separator_temperature for one in every if isinstance(one, InSeparator))
    lost = () if problem.scene.losses is None else (each / KPA for each in problem.scene.losses)
    stands = (each for each in sought.standing(problem.scene) if each is not None)
    return np.array([T, next((at for at in asked if at is not None), T), *lost, *stands], float)


def asked_of(of: Evaluation) -> Asked | None:
    """Return what a cycle asks for; None where gas and oil do not part, which leaves nothing to ask."""
    circuit, package, both = of.circuit, of.package, all(open_temperatures(of.problem.scene))
    if isinstance(circuit, str):
        return None
    off, share, open_ = [0.0, 0.0], 0.0, 0.0
    if circuit is not None:
        off, share, open_ = [circuit.supply, circuit.separator], circuit.parted.share if both else 0.0, circuit.open
    if package is not None:
        off, open_ = [*off, package.before / KPA, package.behind / KPA], max(open_, package.open)
    if sought.is_sought(of.problem.scene):
        others = _of_sought(of)
        if others is None:
            return None
        off, open_ = [*off, *(each.off for each in others)], max(open_, *(each.open for each in others))
    return Asked(np.array(off), share, open_)


def _of_sought(of: Evaluation) -> list[sought.Asked] | None:
    scene = of.problem.scene
    return sought.asked(scene, of.figures, _oil_temperature(of.problem), open_temperatures(scene)[0])


def _oil_temperature(problem: Problem) -> float:
    return 0.0 if problem.parts.oil is None else problem.parts.oil.temperature


def sought_open(of: Evaluation) -> float:
    """Return what a scene's open numbers leave open, relative; nothing where it has none."""
    asked = _of_sought(of) if sought.is_sought(of.problem.scene) else None
    return max((each.open for each in asked or ()), default=0.0)


def follows(problem: Problem) -> bool:
    """Tell whether something around the machine follows from its cycle."""
    scene = problem.scene
    return any(open_temperatures(scene)) or package_of(scene) is not None or sought.is_sought(scene)


def steady(problem: Problem, series: Series) -> tuple[Problem, Search | None]:
    """Return the problem at the mean speed, and at what else follows from its cycle, and how that was found."""
    if not follows(problem):
        return at_its_speed(problem, series), None
    search = Search(series, problem.scene.operation.speed)
    search.course.tightness = series.course.tightness
    problem = at_its_speed(problem, series)
    search.jacobian, search.expected = series.around
    search.contracts = CONTRACTS if search.jacobian is None else LEARNT
    of, guess = search.closed(problem, series.course), unknowns_of(problem)
    for warmer in WARMER if any(open_temperatures(problem.scene)) else ():
        if of is not None:
            break
        other = search.posed(problem, guess + warmer * (np.arange(len(guess)) < 2))
        of = None if other is None else search.closed(other, series.course)
    if of is None:
        return problem, search
    first = asked_of(of)
    for _ in range(MOST):
        asked = asked_of(of)
        if asked is None:
            break
        enough = asked.open <= OPEN * of.problem.scene.numerics.accuracy
        if enough and search.cycle is not None:
            break
        search.expected = 0.0 if enough else search.contracts * asked.open
        after = search.next(of, asked)
        if after is None:
            break
        of = after
    if first is not None:
        series.around = search.jacobian, first.open
    return of.problem, search


def solved(problem: Problem, machinery: Machinery, course: Course | None, search: Search | None) -> Accurate:
    """Return the cycle solved as accurately as it asks, what lies around no more open than that.

    What the search took counts as closing. The errors that the unknowns have add to those of the figures.
    """
    if search is None:
        return solve(problem, machinery, course)
    counts, spent, estimating = search.counts, search.time, 0.0
    accurate = solve(problem, machinery, search.course, search.cycle)
    errors, tightness = _with_unknowns(accurate, search), 1.0
    for _ in range(AGAIN):
        asked = asked_of(accurate.evaluation)
        at_rest, size = _left(accurate, asked, errors)
        if at_rest or asked is None:
            break
        x = unknowns_of(accurate.evaluation.problem)
        tightness = min(tightness, accurate.tightness * min(1.0, AIM / size))  # looser balances would lead astray
        note(search.course, accurate.evaluation, accurate.cycle, accurate.wanted, max(tightness, TIGHTEST))
        search.learn(accurate.evaluation, x)
        other = search.posed(accurate.evaluation.problem, x + search.step(x, asked))
        if other is None:
            break
        counts, spent = _sum(counts, accurate.counts), spent + accurate.closing_time
        estimating += accurate.estimating_time
        machinery.begin(other.composition)
        accurate = solve(other, machinery, search.course)
        errors = _with_unknowns(accurate, search)
    return accurate._replace(
        errors=errors,
        counts=_sum(counts, accurate.counts),
        closing_time=spent + accurate.closing_time,
        estimating_time=estimating + accurate.estimating_time,
    )


def _left(accurate: Accurate, asked: Asked | None, errors: Figures) -> tuple[bool, float]:
    """Tell whether a cycle needs no other unknowns; return the largest error over the wanted accuracy."""
    accuracy = accurate.evaluation.problem.scene.numerics.accuracy
    size = worst(errors)[1] / accuracy
    if asked is None or not accurate.cycle.closed:
        return True, size
    fixed = accurate.evaluation.problem.scene.numerics.rtol is not None
    return asked.open <= OPEN * accuracy and (size <= 1.0 or fixed), max(size, AIM)


def _with_unknowns(accurate: Accurate, search: Search) -> Figures:
    """Return the errors of the figures with those that the unknowns have: of what is open, and of the cycle's.

    A search of one step has learnt nothing of its last cycle yet; where little oil flows, temperatures that leave next
    to nothing of the shaft's power open may be far off.
    """
    errors, asked = Figures(accurate.errors), asked_of(accurate.evaluation)
    if asked is None or search.why or not errors:
        return errors
    if not search.series.per_step:
        search.learn(accurate.evaluation, unknowns_of(accurate.evaluation.problem))
    others = abs(asked.off[2 + 2 * (accurate.evaluation.problem.scene.losses is not None) :]).tolist()
    off = max(_of_circuit(accurate, errors), _of_package(accurate, asked, errors), *others)
    for name, size in errors.items():
        if size is not None:
            errors[name] = size + off * search.series.per_step.get(name, 0.0)
    circuit = accurate.evaluation.circuit
    if isinstance(circuit, Circuit) and errors.get(DUTY):  # one that is not stated
        watts = UNCLOSED * circuit.unclosed * circuit.outflow.oil_capacity
        errors[DUTY] = (errors[DUTY] or 0.0) + error_of(DUTY, watts, accurate.evaluation.figures)
    return errors


def _of_circuit(accurate: Accurate, errors: Figures) -> float:
    """Return by how much [K] the circuit's temperatures may be off."""
    circuit, of_separator = accurate.evaluation.circuit, errors.get("separator_temperature")
    if not isinstance(circuit, Circuit) or of_separator is None:
        return 0.0
    off = of_separator * circuit.parted.T_separator + UNCLOSED * circuit.unclosed
    return max(abs(circuit.supply) + circuit.parted.gain * off, abs(circuit.separator) + off)


def _of_package(accurate: Accurate, asked: Asked, errors: Figures) -> float:
    """Return by how much [kPa] the lost pressures may be off: they go with the square of the flow."""
    losses, of_flow = accurate.evaluation.problem.scene.losses, errors.get("gas_mass_flow") or 0.0
    if losses is None:
        return 0.0
    offs = asked.off[2 : 2 + len(losses)].tolist()
    return max(abs(off) + 2.0 * of_flow * lost / KPA for off, lost in zip(offs, losses, strict=True))


def _sum(counts: Array | None, more: Array) -> Array:
    return more if counts is None else counts + more
