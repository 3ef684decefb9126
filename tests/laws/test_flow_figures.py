"""What changes with the net gas flow errs with it."""

import effects_space
import pytest
from scenes import closed

from screwsim.evaluate import evaluation
from screwsim.evaluate.evaluation import Evaluation, evaluate
from screwsim.evaluate.performance import NONE_DELIVERED
from screwsim.figures.errors import flow_errors, relative_errors
from screwsim.model.slots import SUCTION_IN

MORE = 1e-5  # of the net flow, through the suction port
FOLLOWS = 0.5  # share of that from which on a figure follows the flow
SCENES = {"expander": 6, "plenums, carried": 0, "solubility": 0, "economizer and liquid": 2, "air package": 2}


@pytest.mark.parametrize("structure", SCENES)
def test_figures_that_follow_the_net_flow_err_as_it_does(structure):
    problem, _, cycle = closed(effects_space.scene_of(structure, 703, SCENES[structure]))
    of, c, q = evaluate(problem, cycle), problem.composition, cycle.q.copy()
    assert of.figures.gas_mass_flow > 0.0
    q[c.stream(SUCTION_IN)] += MORE * of.figures.gas_mass_flow / problem.rate
    moved = relative_errors(of.figures, Evaluation(problem, of.life, q).figures, *of.least)
    told = flow_errors(of.figures, moved["gas_mass_flow"])
    assert moved["gas_mass_flow"] == pytest.approx(MORE, rel=1e-3)
    for name, size in moved.items():
        if size is not None and size > FOLLOWS * MORE:
            assert told.get(name, 0.0) > 0.9 * size, name


def test_no_ratio_refers_to_the_rounding_that_a_shut_valve_lets_in(monkeypatch):
    problem, _, cycle = closed(effects_space.scene_of("economizer and liquid", 703, SCENES["economizer and liquid"]))
    ratio = evaluate(problem, cycle).figures.economizer_flow_ratio
    monkeypatch.setattr(evaluation, "_shut", lambda problem, turn: True)
    figures, reasons = evaluate(problem, cycle).read
    assert ratio is not None and figures.gas_mass_flow == 0.0
    assert figures.economizer_flow_ratio is None and reasons["economizer_flow_ratio"] == NONE_DELIVERED
