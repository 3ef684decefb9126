"""The gas of one chamber between two steps, as text: its mass, its change along a step, the flow that closes it.

Source: docs/model.md M3, M106; docs/explanation/numerics.md.
"""

from __future__ import annotations

from screwsim.model.network.cell import Cell
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, function
from screwsim.model.oil_displacement import gas_mass, gas_mass_slope
from screwsim.model.slots import S_RHO, S_X_OIL
from screwsim.numerics.rodas import dense_slope

NEAR = 100.0  # widths ε of a port within which the chamber's balance tells its flow better than its Δp does


def between_texts(network: Network) -> list[str]:
    """Return the functions of a chamber between two steps."""
    return [_gas(network), _mass_rate(network), _balanced(network)]


def _gas(network: Network) -> str:
    """Return the text of the gas [kg] in a chamber of a volume, whose states begin at y[at] (M106)."""
    mass = f"{gas_mass.flat_name}(V, y[at + 1], y[at + 3], P)" if network.roomed else "y[at + 1] * V"
    return function("chamber__gas(V, y, at, P)", [f"return {mass}"])


def _mass_rate(network: Network) -> str:
    """Return the text of the change of a chamber's gas over the angle, along the dense output of a step."""
    to, slope = Statements(), dense_slope.flat_name
    to.add("h = times[step + 1] - times[step]")
    for name, column in (("rho", S_RHO), ("x", S_X_OIL)) if network.roomed else (("rho", S_RHO),):
        pieces = ", ".join(f"dense[step, {k}, {column}]" for k in range(4))
        to.add(f"d{name} = {slope}(theta, {pieces}) / h")
    if network.roomed:
        to.add(f"return {gas_mass_slope.flat_name}(E[E_VOLUME], E[E_SLOPE], y[{S_RHO}], drho, y[{S_X_OIL}], dx, P)")
    else:
        to.add(f"return E[E_VOLUME] * drho + E[E_SLOPE] * y[{S_RHO}]")
    return function(
        "chamber__mass_rate(theta, step, times, dense, E, y, P)",
        ['"""Return dm/dphi [kg/rad] of the gas at the share theta of a step, where the state is y."""'],
        to.lines,
    )


def _balanced(network: Network) -> str:
    """Return the text that lets the balance tell the flow through the widest port to a line.

    Such a port is held there by a tiny Δp, which between the ends of a step carries the whole error of the pressure.
    """
    to, cell = Statements(), Cell(network)
    to.add("widest = 0.0", "total = 0.0")
    to.add(*(f"total += flows[{i}]" for i in range(len(network.ports))))
    wide = [port for port in network.ports if port.wide]
    if wide:
        to.add("port = 0", "drop = 0.0", "width = 0.0")
    for port in wide:
        array, at = cell.line(port.number)
        opened = f" * own[OPENING + {port.index}]" if port.opening else ""
        to.add(f"area = E[E_AREAS + {port.index}]{opened}")
        with to.within("if area > widest"):
            to.add("widest = area", f"port = {port.index}", f"width = {port.width}")
            to.add(f"drop = {array}[{at} + PRESSURE] - own[PRESSURE]")
    first = len(network.ports)
    to.add(*(f"total += flows[{first + i}]" for i in range(2 * len(network.gaps))))
    if wide:
        with to.within(f"if widest > 0.0 and abs(drop) < {NEAR!r} * width"):
            to.add("flows[port] += mass_rate - total")
    return function(
        "chamber__balanced(flows, mass_rate, E, own, R, P)",
        ['"""Let the mass balance tell the flow [kg/s] through the widest open port, at nearly equal pressures."""'],
        to.lines,
    )
