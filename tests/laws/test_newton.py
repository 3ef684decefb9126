"""Newton's correction: its tangents are the cycle's own response, it closes in few turns, and changes no result."""

from dataclasses import replace

import numpy as np
import pytest
from folders import CONFIGS
from scenes import make

from screwsim.cycle import newton, tangents
from screwsim.cycle.close import close
from screwsim.cycle.feedback import image, set_unknowns, unknowns
from screwsim.cycle.guess import lease_for
from screwsim.cycle.newton import Corrections, Residual, corrected
from screwsim.cycle.problem import ClosingTask, problem_of
from screwsim.cycle.tangents import linearised, shifted, slopes_of_image
from screwsim.figures.errors import relative_errors, worst
from screwsim.scene import loads
from screwsim.simulate import simulate

SLOW = {"operation.speed": "250 rpm", "oil.transport": "carried"}  # leaks rule, and gas goes to and from the line
REAL = {
    **SLOW,
    "gas.model": "real",
    "oil_supply.temperature": "328 K",
    "operation.suction": {"pressure": "3.1462 bar", "superheat": "10 K"},
    "operation.discharge": {"pressure": "11.6 bar"},
}
STEP = 2e-3  # of a coordinate of an unknown
FINE = 1e-6  # tolerance of a step, so that what a change makes is not lost in its error


@pytest.fixture
def standing():
    """Return a problem, a machinery that stands on its closed cycle, and that cycle."""
    problem = problem_of(make(SLOW))
    machinery = lease_for(problem)
    cycle = close(ClosingTask(problem, machinery, replace(problem.criteria, rtol=FINE)))
    assert cycle.status == "ok"
    return problem, machinery, cycle


def settled(problem, machinery, cycle, coordinates):
    """Return work and image of the waveforms that settle by themselves around unknowns held at these coordinates."""
    y, met = cycle.y.copy(), unknowns(problem, machinery)
    machinery.put(cycle.trajectory)
    set_unknowns(problem, machinery, problem.entries.values(coordinates, met))
    work = 0.0
    for _ in range(60):
        *_, q = machinery.turn(y, FINE)
        machinery.lives.swap()
        if abs(q[0] - work) <= 1e-9 * abs(work):
            break
        work = q[0]
    return q[0], problem.entries.coordinates(image(problem, machinery.trajectory, q))


def test_tangents_tell_what_a_change_of_an_unknown_makes_of_the_cycle(standing):
    problem, machinery, cycle = standing
    met = unknowns(problem, machinery)
    here = problem.entries.coordinates(met)
    temperature = problem.entries.names.index("discharge_oil_temperature")
    ways = [here.copy(), here.copy()]
    ways[0][temperature] += STEP
    ways[1][temperature] -= STEP
    (work, made), (other_work, other_made) = (settled(problem, machinery, cycle, way) for way in ways)
    machinery.put(cycle.trajectory)
    set_unknowns(problem, machinery, met)
    found = linearised(problem, machinery, met)
    start = np.zeros((len(found.around), len(met)))
    ends = found.along(start, found.by_unknowns)[-1]
    along = found.along(found.around @ shifted(ends, machinery.composition.chambers), found.by_unknowns)
    given = found.sums_along(along, found.by_unknowns) + found.sums_by_unknowns
    assert given[:, 0, temperature].sum() == pytest.approx((work - other_work) / (2 * STEP), rel=0.15)
    made_here = image(problem, machinery.trajectory, cycle.q)
    told = slopes_of_image(problem, machinery, found, given, cycle.q, met, made_here)[:, temperature]
    np.testing.assert_allclose(told, (made - other_made) / (2 * STEP), rtol=0.15, atol=0.01)


PLENUMS = {
    "oil.transport": "carried",
    "operation.speed": "1000 rpm",
    "effects.plenums": {"discharge_volume": "3 l", "discharge_area": "15 cm^2"},
}


def test_tangents_tell_what_a_pressure_of_a_plenum_makes_of_itself():
    """Of a line that pulsates, its harmonics: what the slices give the line over the pitch makes them."""
    problem = problem_of(make(PLENUMS))
    machinery = lease_for(problem)
    cycle = close(ClosingTask(problem, machinery, replace(problem.criteria, rtol=FINE)))
    assert cycle.status == "ok"
    met = unknowns(problem, machinery)
    here, names = problem.entries.coordinates(met), problem.entries.names
    lines = [names.index(f"discharge_{wave}_{k}") for k in (1, 2, 3) for wave in ("cos", "sin")]
    found = linearised(problem, machinery, met)
    start = np.zeros((len(found.around), len(met)))
    ends = found.along(start, found.by_unknowns)[-1]
    along = found.along(found.around @ shifted(ends, machinery.composition.chambers), found.by_unknowns)
    given = found.sums_along(along, found.by_unknowns) + found.sums_by_unknowns
    told = slopes_of_image(
        problem, machinery, found, given, cycle.q, met, image(problem, machinery.trajectory, cycle.q)
    )
    for which in lines[:2]:
        ways = [here.copy(), here.copy()]
        ways[0][which] += STEP
        ways[1][which] -= STEP
        (_, made), (_, other) = (settled(problem, machinery, cycle, way) for way in ways)
        np.testing.assert_allclose(told[lines, which], ((made - other) / (2 * STEP))[lines], rtol=0.2, atol=0.02)


def test_a_correction_takes_back_what_an_unknown_was_off_by(standing):
    """A turn that met another enthalpy of the line is led back to the cycle, at once, within a tenth."""
    problem, machinery, cycle = standing
    met = unknowns(problem, machinery)
    here = problem.entries.coordinates(met)
    off = here + STEP * (np.arange(len(here)) == 0)
    set_unknowns(problem, machinery, problem.entries.values(off, met))
    met = unknowns(problem, machinery)
    y, steps = cycle.y.copy(), int(machinery.lives.kept[1])
    before = np.log(y)
    *_, q = machinery.turn(y, FINE)
    machinery.lives.swap()
    made = image(problem, machinery.trajectory, q)
    found = Corrections(problem, machinery).of_turn(steps, np.log(y) - before, q, met, made)
    assert found is not None and found.share == 1.0
    left = problem.entries.coordinates(made) + found.unknowns - here
    assert np.max(np.abs(left)) < 0.1 * STEP


@pytest.mark.parametrize("closing", ["histories", "coupled"])
@pytest.mark.parametrize("changes", [SLOW, REAL], ids=["ideal", "real"])
def test_corrections_spare_turns_and_change_no_figure(monkeypatch, closing, changes):
    scene = make({**changes, "operation.speed": "400 rpm", "numerics": {"closing": closing, "error": "none"}})
    found = simulate(scene)
    monkeypatch.setattr(Corrections, "due", lambda self, slow, moved, near=False: False)
    plain = simulate(scene)
    assert found.status == plain.status == "ok"
    assert found.numerics["turns"] < plain.numerics["turns"]
    assert worst(relative_errors(found.performance, plain.performance))[1] < 2 * scene.numerics.accuracy


def test_where_any_state_is_as_good_as_another_no_correction_is_made(standing):
    """With a map that gives back what it takes a residual asks for a change without end."""
    problem, machinery, cycle = standing
    met = unknowns(problem, machinery)
    found = linearised(problem, machinery, met)
    around = found._replace(around=1e6 * np.eye(len(found.around)))
    made = image(problem, machinery.trajectory, cycle.q)
    N = len(around.around)
    residual = Residual(np.zeros((len(found.step), N)), np.full(N, 1e-6), cycle.q, met, made)
    assert corrected(problem, machinery, found, residual) is not None
    assert corrected(problem, machinery, around, residual) is None


def test_slices_lie_where_the_steps_do(standing):
    """A pitch is divided as the integrator divided it, and not left to its even parts."""
    _, machinery, _ = standing
    edges = tangents.edges_of(machinery)
    assert edges[0] == 0.0 and edges[-1] == pytest.approx(machinery.composition.P[1])
    widths = np.diff(edges)
    assert len(widths) == tangents.SLICES and widths.min() > 0.0
    assert widths.max() > 2.0 * widths.min()


def test_a_scene_that_closes_in_few_turns_is_not_linearised(monkeypatch):
    """At full speed nothing is compiled or asked for that would not be without corrections."""
    monkeypatch.setattr(newton, "linearised", None)  # would be an error
    scene = loads((CONFIGS / "paper" / "point.yaml").read_text(encoding="utf-8"))
    assert simulate(scene).status == "ok"
