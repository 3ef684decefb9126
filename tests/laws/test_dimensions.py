"""Every figure goes by its dimensions: a scene with other units of mass, length and time is the same machine.

Lengths and times × s with masses × s³ keep speeds of sound, densities and temperatures: a similar machine at the same
tip speed (Buckingham's theorem). Masses × k alone are an ideal gas at k times the pressure. A constant of its own
dimension anywhere in the equations, in steps or in thresholds shows as a figure that does not follow.
"""

import re

import numpy as np
import pytest
from folders import CONFIGS

from screwsim.figures import Performance
from screwsim.figures.errors import relative_errors
from screwsim.fluid import transport
from screwsim.inputs.declare import is_derived
from screwsim.scene import load, value_at, with_values
from screwsim.scene.fields import leaves_of
from screwsim.simulate import simulate

SI = {  # exponents of kg, m, s
    "1": (0, 0, 0),
    "rad": (0, 0, 0),
    "K": (0, 0, 0),
    "kelvin": (0, 0, 0),
    "kg": (1, 0, 0),
    "mol": (0, 0, 0),
    "m": (0, 1, 0),
    "s": (0, 0, 1),
    "Hz": (0, 0, -1),
    "N": (1, 1, -2),
    "Pa": (1, -1, -2),
    "J": (1, 2, -2),
    "W": (1, 2, -3),
}
SIZE, PRESSURE = (3, 1, 1), (1, 0, 0)  # exponents of the factor in kg, m, s
BOTH = 2.0  # of two results within the accuracy
ECONOMIZER = "effects.economizer={temperature: auto, opens: 400 deg, closes: 500 deg, area: 1 cm^2}"
COOLER = (
    "effects.separator={cooler: {discharge_temperature: null, conductance: 0.4 kW/K, coolant_temperature: 30 degC}}"
)
CASES = {
    "paper": ("paper/point", SIZE, ()),
    "paper, pressure": ("paper/point", PRESSURE, ()),
    "economizer that is found": ("r134a/point", SIZE, (ECONOMIZER,)),
    "separator, dissolved gas": ("r134a/separator", SIZE, (COOLER,)),
    "air package": ("air/fixed_speed_7", SIZE, ()),
    "lives of bearings": ("air/bearing_life", SIZE, ()),
    "expander": ("expander/point", SIZE, ()),
    "expander with oil": ("expander/oil", SIZE, ()),
    "drive": ("drive/point", SIZE, ()),
    "drive, pressure": ("drive/point", PRESSURE, ()),
    "reeds": ("slider_crank/r134a", SIZE, ()),
    "reeds, pressure": ("slider_crank/air", PRESSURE, ()),
}


def power(unit, group):
    """Return the exponent with which a quantity of an SI unit goes with the factor."""
    over, _, under = unit.partition("/")
    found = 0
    for part, sign in ((over, 1), (under.strip("()"), -1)):
        for name, exponent in re.findall(r"([A-Za-z]+|1)\^?(-?\d+)?", part):
            found += sign * int(exponent or 1) * int(np.dot(SI[name], group))
    return found


def in_other_units(scene, group, factor):
    """Return a scene with all its stated quantities multiplied as their dimensions ask for."""
    found = {}
    for path, leaf in leaves_of(scene).items():
        value = None if leaf.dimension is None else value_at(scene, path)
        exponent = 0 if leaf.dimension is None else power(leaf.dimension.si, group)
        if value and exponent and not is_derived(value):
            found[path] = value * factor**exponent
    return with_values(scene, found)


def scale_transport(monkeypatch, group, factor):
    """Make CoolProp's conductivity and viscosity of a gas those of the same gas in other units."""
    pressure, conducts, viscous = (factor ** power(unit, group) for unit in ("Pa", "W/(m K)", "Pa s"))
    of_both, of_one = transport.transport, transport.viscosity

    def both(fluid, p, T):
        conductivity, viscosity, prandtl = of_both(fluid, p / pressure, T)
        return conducts * conductivity, viscous * viscosity, prandtl

    for module in ("parts.gas_transport", "cylinder_heat"):
        monkeypatch.setattr(f"screwsim.effects.{module}.transport", both)
    one = "screwsim.effects.parts.gap_flow.vapour_viscosity"
    monkeypatch.setattr(one, lambda fluid, p, T: viscous * of_one(fluid, p / pressure, T))


@pytest.mark.parametrize("case", CASES)
def test_figures_go_by_their_dimensions(case, monkeypatch):
    file, group, changes = CASES[case]
    scene, factor = load(CONFIGS / f"{file}.yaml", ("numerics.accuracy=1e-4", *changes)), 1.7
    here = simulate(scene, trace=False)
    scale_transport(monkeypatch, group, factor)
    there = simulate(in_other_units(scene, group, factor), trace=False)
    assert here.status == there.status == "ok"
    about = here.performance.about
    back = {
        name: value if value is None else value * factor ** -power(about[name].units, group)
        for name, value in there.performance.items()
    }
    off = relative_errors(Performance(back, about), here.performance)
    bound = BOTH * scene.numerics.accuracy
    assert {name: error for name, error in off.items() if error is not None and error > bound} == {}
    assert {name for name in off if (back[name] is None) != (here.performance[name] is None)} == set()
    assert sum(error is not None for error in off.values()) > 20


def test_powers_of_units():
    units = {"W/(m^2 K)": 0, "Pa s": 1, "kg s-1": 2, "W s m-3": 0, "N m s/rad": 4, "m3": 3, "J/(kg K)": 0}
    assert {unit: power(unit, SIZE) for unit in units} == units
