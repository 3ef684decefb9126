"""Laws read from tables: a shape-preserving C1 spline, volume and its slope from the same polynomial (M14)."""

from screwsim.numerics.kernel import kernel
from screwsim.numerics.spline import table_slope, table_value


@kernel
def volume(phi, TAB, volume_curve, V_min):
    """Return the chamber volume [m³]: dead volume plus the table's."""
    return V_min + table_value(phi, TAB, volume_curve)


@kernel
def volume_slope(phi, TAB, volume_curve):
    """Return dV/dφ [m³/rad], the derivative of the same spline."""
    return table_slope(phi, TAB, volume_curve)


@kernel
def area(phi, TAB, curve):
    """Return a port area [m²]."""
    return table_value(phi, TAB, curve)
