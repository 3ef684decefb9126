"""Errors of the figures because the surroundings found with a cycle are not exact (`solve.circuit`).

Balances of the surroundings that a cycle leaves open, and the errors of the figures that enter them, shift the unknowns
(by the inverse of the balances' response), and shifted unknowns change the figures (by their slopes). Response and
slopes are learnt from the cycles of the search; the slopes of figures that state an unknown are known.
Source: ours; docs/explanation/errors.md, errors of an oil circuit.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from screwsim.evaluate.evaluation import Evaluation
from screwsim.evaluate.separator import Circuit
from screwsim.figures.errors import error_of, relative_errors
from screwsim.numerics import broyden
from screwsim.outputs import Figures
from screwsim.solve.surroundings import KPA
from screwsim.solve.surroundings_steps import learnt, trusted_share

Array = np.ndarray
Slopes = Mapping[str, Array]  # of figures [SI] with each unknown [1/K, 1/kPa]
LEAST_DISTANCE = 0.05  # [K, kPa], smallest distance of two cycles from which sensitivities are taken
ENERGY_ERROR_SHARE = 0.6  # share of the mixture's temperature change by the cycle's energy residual, taken as an error
DUTY = "oil_cooler_duty"  # figure: heat flow to the oil cooler
SUPPLY, SEPARATOR, BEFORE, BEHIND = range(4)  # unknowns: temperatures [K], lost pressures [kPa]; then others [K]
STATED = {  # figures that state an unknown: which, and its unit
    "oil_supply_temperature": (SUPPLY, 1.0),
    "intake_pressure_loss": (BEFORE, KPA),
    "discharge_pressure": (BEHIND, KPA),
    "package_pressure_loss": (BEHIND, KPA),
}


class Seen(NamedTuple):
    """What a cycle of a search showed: unknowns, what they are `off` by and the error of that [K, kPa], and figures."""

    x: Array
    off: Array
    wrong: float
    figures: Figures


@dataclass
class LearntResponse:
    """How residuals and figures respond to the unknowns, by the cycles of a search at least `LEAST_DISTANCE` apart."""

    seen: list[Seen] = field(default_factory=list)
    _response: Array | None = None

    @property
    def response(self) -> Array:
        """The response of the residuals to the unknowns, once a cycle was added."""
        assert self._response is not None
        return self._response

    def add(self, of: Evaluation, now: Seen, started: Array, slopes: Slopes) -> Slopes:
        """Record a cycle, and what it shows beside the last one that is far enough; return the slopes of the figures.

        The response begins as `started`.
        """
        if self._response is None:
            self._response = started
        for before in reversed(self.seen):
            moved = now.x - before.x
            if float(np.max(np.abs(moved))) > LEAST_DISTANCE:
                weight = trusted_share(moved, now.wrong, before.wrong)
                slopes = learnt_slopes(slopes, of, before.figures, moved, weight)
                self._response = learnt(self._response, now.off - before.off, moved, weight)
                break
        self.seen.append(now)
        return slopes


def learnt_slopes(known: Slopes, of: Evaluation, before: Figures, moved: Array, weight: float) -> dict[str, Array]:
    """Return the slopes of figures that also give their change to an evaluation, over a move of the unknowns.

    What they missed of the change is learnt by its `weight`, see `numerics.broyden`.
    """
    unknowns, found = len(moved), of.figures
    slopes = {name: slope for name, slope in known.items() if len(slope) == unknowns}
    for name, value in found.items():
        old = before.get(name)
        if value is None or old is None:
            continue
        slope = slopes.get(name)
        if slope is None:
            slope = _stated_slope(of, name, unknowns)
        slopes[name] = broyden.updated(slope, value - old, moved, weight)
    return slopes


def _stated_slope(of: Evaluation, name: str, unknowns: int) -> Array:
    """Return the slope of a figure that states an unknown; zero for others."""
    number, unit = STATED.get(name, (SUPPLY, 0.0))
    slope = np.zeros(unknowns)
    if number < BEFORE or of.problem.scene.losses is not None:
        slope[number] = unit
    return slope


def errors_with_unknowns(of: Evaluation, errors: Figures, off: Array, response: Array, slopes: Slopes) -> Figures:
    """Return the errors of the figures, with those due to the errors of the unknowns.

    `off` [K, kPa] is what the cycle asks to change of the unknowns, `response` how that changes with them. A figure
    of exactly zero, as a flow that does not come about, stays zero.
    """
    grown, inverse, found = Figures(errors), np.linalg.inv(response), of.figures
    for asked in (off, *_errors_of_balances(of, len(off), errors)):
        u = inverse @ asked
        moved = {name: value + float(slopes[name] @ u) for name, value in found.items() if value and name in slopes}
        for name, size in relative_errors(found, Figures(moved), *of.least).items():
            if size is not None and grown.get(name) is not None:
                grown[name] += size
    circuit = of.circuit
    if isinstance(circuit, Circuit) and grown.get(DUTY):  # not stated in the scene
        watts = ENERGY_ERROR_SHARE * circuit.unclosed * circuit.outflow.oil_capacity
        grown[DUTY] = (grown[DUTY] or 0.0) + error_of(DUTY, watts, found)
    return grown


def _errors_of_balances(of: Evaluation, unknowns: int, errors: Figures) -> Iterator[Array]:
    """Yield the errors [K, kPa] of what a cycle's balances ask to change of the unknowns, one for each cause.

    Causes are the errors of the separator's temperature, and of the flow, with the square of which pressures are lost.
    """
    losses, circuit, of_separator = of.problem.scene.losses, of.circuit, errors.get("separator_temperature")
    if isinstance(circuit, Circuit) and of_separator is not None:
        found = np.zeros(unknowns)
        found[SEPARATOR] = of_separator * circuit.parted.T_separator + ENERGY_ERROR_SHARE * circuit.unclosed
        found[SUPPLY] = circuit.parted.gain * found[SEPARATOR]
        yield found
    of_flow = errors.get("gas_mass_flow")
    if losses is not None and of_flow:
        found = np.zeros(unknowns)
        found[BEFORE : BEHIND + 1] = [2.0 * of_flow * lost / KPA for lost in losses]
        yield found
