"""What a chamber meets of its neighbours within a step is no less than what they sum of the same flow."""

import numpy as np
from scenes import closed, make

from screwsim.evaluate.evaluation import evaluate
from screwsim.outputs import Figures
from screwsim.solve.missed_neighbours import PEAK, departures, missed_neighbour_errors
from screwsim.solve.sums_met_twice import sums_met_twice

NARROW = {
    "machine.discharge_port.area": "20 cm^2",  # the last gas of each chamber is squeezed to 8 times the line's pressure
    "operation.speed": "6000 rpm",
    **{f"effects.{gap}_leakage.gap": "60 um" for gap in ("tip", "interlobe")},
}
ACCURACY, TRUE = 3e-4, 1e-6


def life_of(accuracy):
    """Return that machine's problem and life."""
    problem, _, cycle = closed(make(NARROW | {"numerics": {"accuracy": accuracy}}))
    return problem, cycle.trajectory


def test_a_step_that_misses_the_end_of_a_neighbours_life_leaves_its_pressure_as_far_off_as_told():
    problem, life = life_of(ACCURACY)
    _, true = life_of(TRUE)
    found = departures(problem, life, sums_met_twice(problem, life))
    assert found is not None
    jumps = np.abs(np.diff(found.of_pressure))[found.angles[1:] < np.radians(600.0)]  # the discharge port is shut
    last = int(jumps.argmax()) + 1
    ends = found.angles[last - 1 : last + 1]
    before, after = (each.states_at(ends)[:, -1] for each in (life, true))
    off, told = (float(np.diff(each)[0]) for each in (before / after, found.of_pressure[last - 1 : last + 1]))
    assert abs(off) > 0.1 * ACCURACY
    assert 0.5 < told / off < 2.0  # GAIN is taken as one number


def test_short_steps_miss_nothing():
    problem, life = life_of(TRUE)
    assert departures(problem, life, sums_met_twice(problem, life)) is None


def test_a_figure_of_unknown_error_keeps_it():
    problem, _, cycle = closed(make(NARROW | {"numerics": {"accuracy": ACCURACY}}))
    of, known = evaluate(problem, cycle), {"indicated_power": 1e-5, PEAK: 1e-5}
    unknown = Figures(dict.fromkeys(of.figures)) | known
    met = sums_met_twice(problem, cycle.trajectory)
    assert missed_neighbour_errors(of, cycle.trajectory, met, unknown).keys() == known.keys()
