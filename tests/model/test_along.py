"""The change of the rates along one of all they take against differences: each parameter, port state, state."""

import re
from pathlib import Path

import numpy as np
import pytest
from scenes import OF_ALL_STREAMS, closed, make

from screwsim.model import compiled
from screwsim.model.contexts import Changes, CoupledContext, ShiftedArguments
from screwsim.model.run import Context
from screwsim.model.slots import FREE, PORT_STATE
from screwsim.scene import load

ANGLES = np.radians((5.3, 41.2, 71.6))  # of the first chamber, off the knots of curves
STEP = 1e-6  # relative, of the surroundings' differences
STEPS = 1e-7, 1e-8  # of those that are compared: the roots near equal pressures ask for one, rounding for the other
AGREE = 1e-4
SMALL = {"y": 1.0, "P": 1e-3, "R": 1.0}  # below which a number is moved as if it were that: harmonics are next to none
CONFIGS = Path(__file__).parents[2] / "configs"
SCENES = {"real gas": "r134a/point.yaml", "everything": "everything.yaml", "rotor profiles": "rotors/b.yaml"}


class Rates:
    """The rates of all chambers of a closed cycle at `ANGLES`, and their changes."""

    def __init__(self, scene):
        _, self.machinery, cycle = closed(scene)
        assert cycle.status == "ok"
        c = self.c = self.machinery.composition
        self.module = compiled.load(c.along())
        starts = self.machinery.composition.P[1] * np.arange(c.chambers)
        y = np.array([self.machinery.states_at(phi + starts).ravel() for phi in ANGLES])
        self.base = {"y": y, "angles": ANGLES, "P": c.P.copy(), "TAB": c.TAB.copy(), "R": self.machinery.R.copy()}

    def context(self, P, TAB, R):
        c = self.c
        port_states = np.append(np.zeros((c.chambers + 1) * PORT_STATE), np.full(c.chambers, FREE))
        return Context(CoupledContext(P.copy(), TAB.copy(), R.copy(), port_states, np.zeros(c.n_work_all)))

    def empty(self):
        return [np.empty((len(ANGLES), n)) for n in (self.base["y"].shape[1], self.machinery.nq + 1)]

    def at(self, y, angles, **numbers):
        found = self.empty()
        self.machinery.together.slices__rates_at_all(angles, ANGLES, y, self.context(**numbers), self.c.n_E_all, *found)
        return np.hstack(found)

    def along(self, change):
        """Return the rates, and their change along that of all they take."""
        f, g, f_along, g_along = *self.empty(), *self.empty()
        names = ShiftedArguments._fields
        rows = [[self.base[n] + sign * STEP * change[n] for sign in (1.0, -1.0, 0.0)] for n in names]
        sides, changes = Context(ShiftedArguments(*map(np.array, rows))), Context(Changes(**change))
        context = self.context(*(self.base[name] for name in names))
        asked = ANGLES, ANGLES, self.base["y"], context, self.c.n_E_all, sides, STEP, changes
        self.module.slices__rates_along_all(*asked, f, g, f_along, g_along)
        return np.hstack([f, g]), np.hstack([f_along, g_along])

    def nothing(self):
        return {name: np.zeros_like(each) for name, each in self.base.items()}

    def error(self, change, found, step):
        """Return by how much the `found` change of the rates differs from differences, over the largest of it."""
        sides = [
            self.at(**{name: self.base[name] + sign * step * change[name] for name in change}) for sign in (1.0, -1.0)
        ]
        expected = (sides[0] - sides[1]) / (2.0 * step)
        least = 1e-4 * np.abs(sides[0]).max()
        return np.abs(found - expected).max() / max(np.abs(expected).max(), least)


@pytest.fixture(scope="module", params=[*OF_ALL_STREAMS, *SCENES])
def rates(request):
    if request.param in SCENES:
        return Rates(load(CONFIGS / SCENES[request.param]))
    return Rates(make({"operation.speed": "1000 rpm", "numerics.accuracy": 6e-4, **OF_ALL_STREAMS[request.param]}))


def indices(text):
    """Return where in P no number of the scene stands but where a curve begins."""
    return {int(at) for _, at in re.findall(r"^(P_\w*curve\w*) = (\d+)$", text, re.MULTILINE)}


def worst(rates, name, at):
    """Return the error by a number: of the first step by which it is small enough, else the better one of two."""
    change = rates.nothing()
    size = max(np.max(np.abs(rates.base[name][..., at])), SMALL[name])
    change[name][..., at] = size
    found, errors = rates.along(change)[1], []
    for step in STEPS:
        errors.append(rates.error(change, found, step))
        if errors[-1] <= AGREE:
            break
    return min(errors)


def test_nothing_that_changes_changes_nothing(rates):
    values, changes = rates.along(rates.nothing())
    np.testing.assert_array_equal(values, rates.at(**rates.base))
    assert not changes.any()


@pytest.mark.parametrize("name", ["y", "P", "R"])
def test_the_change_along_each_number_is_that_of_the_rates(rates, name):
    left_out = indices(rates.c.along()) if name == "P" else set()
    found = {at: worst(rates, name, at) for at in range(rates.base[name].shape[-1]) if at not in left_out}
    assert {at: error for at, error in found.items() if not error <= AGREE} == {}


def test_changes_of_all_at_once_add_up(rates):
    parts = [rates.nothing() for _ in range(3)]
    for change, name in zip(parts, ("y", "P", "R"), strict=True):
        change[name][...] = rates.base[name] * np.linspace(-1e-3, 1e-3, rates.base[name].shape[-1])
    together = {name: sum(change[name] for change in parts) for name in parts[0]}
    changes = [rates.along(each)[1] for each in (*parts, together)]
    size = np.abs(changes[:3]).max()
    np.testing.assert_allclose(sum(changes[:3]), changes[3], rtol=0.0, atol=1e-7 * size)
