"""The gas of one chamber between two steps, as text: its mass, and its change along a step.

Source: docs/model.md M3, M106; docs/explanation/numerics.md.
"""

from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, function
from screwsim.model.oil_displacement import gas_mass, gas_mass_slope
from screwsim.numerics.rodas import dense_slope


def between_texts(network: Network) -> list[str]:
    """Return the functions of a chamber between two steps."""
    return [_gas(network), _mass_rate(network)]


def _gas(network: Network) -> str:
    """Return the text of the gas [kg] in a chamber of a volume, whose states begin at y[at] (M106)."""
    mass = f"{gas_mass.flat_name}(V, y[at + S_rho], y[at + S_x_oil], P)" if network.roomed else "y[at + S_rho] * V"
    text = '"""Return the gas [kg] in a chamber of volume V [m³], whose states begin at y[at] (M1, M106)."""'
    return function("chamber__gas(V, y, at, P)", [text, f"return {mass}"])


def _mass_rate(network: Network) -> str:
    """Return the text of the change of a chamber's gas over the angle, along the dense output of a step."""
    to, slope = Statements(), dense_slope.flat_name
    to.add("h = times[step + 1] - times[step]")
    for name, column in (("rho", "S_rho"), ("x", "S_x_oil")) if network.roomed else (("rho", "S_rho"),):
        pieces = ", ".join(f"dense[step, {k}, {column}]" for k in range(4))
        to.add(f"d{name} = {slope}(theta, {pieces}) / h")
    if network.roomed:
        to.add(f"return {gas_mass_slope.flat_name}(E[E_VOLUME], E[E_SLOPE], y[S_rho], drho, y[S_x_oil], dx, P)")
    else:
        to.add("return E[E_VOLUME] * drho + E[E_SLOPE] * y[S_rho]")
    return function(
        "chamber__mass_rate(theta, step, times, dense, E, y, P)",
        ['"""Return dm/dphi [kg/rad] of the gas at the share theta of a step, where the state is y."""'],
        to.lines,
    )
