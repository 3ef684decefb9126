"""Derivatives of one result's figures with respect to the numbers of its scene, as a group of the results file."""

import numpy as np

from screwsim.outputs import Figures, Variable, shown
from screwsim.outputs.derivatives import METHOD_CODES, ComputedDerivatives
from screwsim.results.netcdf import Layout, flag_attributes, flag_type, number_attributes
from screwsim.results.table import EXACT, VALUE

DERIVATIVES, NUMBER = "derivatives", "number"  # names of the group and its dimension
UNITS = "number_units"
IS_EXACT = {
    "units": "1",
    "long_name": "0: differences of closed cycles; 1: exact derivatives; 2: quick ones, mostly accurate to 1e-3",
}


def write_slopes(layout: Layout, found: ComputedDerivatives, performance: Figures) -> None:
    """Write the group `derivatives`; its coordinate `number` counts the paths, listed in its attribute `labels`."""
    group, paths = layout.group(DERIVATIVES), list(found.values)
    about = flag_attributes(paths, "number of the scene")
    counted = np.arange(len(paths), dtype=flag_type(len(paths)))
    layout.coordinate(group, NUMBER, counted, about | {"labels": "\n".join(paths)})
    words = sorted(set(found.units.values()))
    data = layout.texts(group, UNITS, words, (len(paths),), (NUMBER,), "SI unit of the number")
    data.write([words.index(found.units[path]) for path in paths])
    layout.variable(group, VALUE, np.array([found.values[path] for path in paths], float), (NUMBER,), about_value())
    exact = np.array([METHOD_CODES[found.method[path]] for path in paths], np.int8)
    layout.variable(group, EXACT, exact, (NUMBER,), IS_EXACT)
    units = {each.name: each.units for each in shown(performance)}
    for figure, slopes in found.derivatives.items():
        values = np.array([slopes.get(path, np.nan) for path in paths], float)
        layout.variable(group, figure, values, (NUMBER,), about_slope(figure, units[figure]))


def about_slope(figure: str, units: str) -> dict[str, object]:
    """Return the attributes of a figure's derivatives; `units` are those of the figure."""
    return number_attributes(Variable(units, f"derivative of {figure} by the number, per unit of it ({UNITS})"))


def about_value() -> dict[str, object]:
    """Return the attributes of the scene's numbers."""
    return number_attributes(Variable("1", f"value of the number, in the unit that {UNITS} says"))
