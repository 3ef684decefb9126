"""The balances of one chamber as text: from the sums of its streams to the rates of its states; its gas between steps.

Source: docs/model.md M1–M9, M104–M110, M170, M230, M253, M257. Used by `network.chamber` and `network.chambers`.
"""

from collections.abc import Sequence

from screwsim.model.balance import held_slope, oil_temperature_slope, temperature_slope
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import Network, line_pressures
from screwsim.model.network.statements import Statements, writes
from screwsim.model.oil_displacement import gas_mass, gas_mass_slope
from screwsim.numerics.kernel import Kernel
from screwsim.numerics.rodas import dense_slope


def balance_kernels(network: Network) -> list[Kernel]:
    """Return the kernels that the balances call."""
    asked = {oil_temperature_slope: network.heated, held_slope: network.dissolves, gas_mass: network.roomed}
    return [temperature_slope, *(each for each, wanted in asked.items() if wanted)]


def gas_state(to: Statements, network: Network) -> None:
    """Set the state of the gas (M5, M6, M10)."""
    to.add("# state of the gas (M5, M6, M10)", f"p, h, c_v, TpT, exponent, choke, choked = {network.gas}")


def oil_room(to: Statements, network: Network, of: str = "") -> None:
    """Set the numbers that flows use of a chamber where oil takes room (M107, M108).

    `of` is the suffix of their names.
    """
    if network.roomed:
        where = " of the chamber ahead" if of else ""
        to.add(f"# what flows feel{where} where oil takes room (M107, M108)")
        to.add(f"share{of} = 1.0 / (1.0 + x_oil{of} * rho{of} * P[P_ROOM])")
        to.add(f"rho_felt{of} = rho{of} * share{of} * share{of}")
        to.add(f"T_felt{of} = T_oil{of} + p{of} * P[P_ROOM] / P[P_C_OIL]")


def gas_inside(to: Statements, network: Network) -> None:
    """Set the mass of the gas and of the oil (M1, M106), and the factor on quantities per time (M217)."""
    to.add(f"# mass of the gas{' and of the oil' if network.heated else ''} (M1{', M106' if network.roomed else ''})")
    if network.slow:
        to.add(f"slow = {network.slow}  # mean speed over the speed here (M217)")
    to.add(f"m = {gas_mass.flat_name}(V, rho, x_oil, P)" if network.roomed else "m = rho * V")
    if network.heated:
        to.add("m_oil = x_oil * m" if network.carried else "m_oil = oiled * R[R_RATIO] * m")


def totals(to: Statements, network: Network, sums: Sequence[str]) -> None:
    """Set the totals of streams from the sums, which are given in order."""
    to.add("# totals of all streams (M1, M2)")
    for quantity in network.quantities:
        to.add(f"{quantity} = {' + '.join(f'{quantity}_{each}' for each in sums)}")


def port_oil_enthalpy(network: Network) -> str:
    """Return the enthalpy over heat capacity [K] of oil through ports into a chamber at pressure p (M108).

    A pump presses it into the chamber, whatever the pressure of its source (M255).
    """
    if network.roomed and network.inflow is not None and network.inflow.pumped:
        return "(P[P_H_PORT] + max(0.0, p - P[P_P_SOURCE]) * P[P_ROOM] / P[P_C_OIL])"
    return "P[P_H_PORT]"


def oil_through_ports(to: Statements, network: Network) -> None:
    """Add the oil that enters through ports, and the gas that oil releases (M104, M196, M231)."""
    inflow, flash, solution = network.inflow, network.flash, network.solution
    if inflow is not None:
        to.add(f"# oil through ports (M104{', M255' if network.roomed and inflow.pumped else ''})")
        to.add("width = P[P_DISCHARGE_WIDTH]", f"inflow = {inflow.call}")
        to.add("oil_port = inflow", f"oil_energy_port = inflow * {port_oil_enthalpy(network)}")
        if solution is not None:
            to.add(f"held_port = inflow * {solution.in_supply}")
    if flash is not None:
        to.add("# gas that flashes out of it (M196)")
        to.add(f"gas = inflow * max(0.0, {flash.share})", f"mass_{flash.cell}_in += gas")
        to.add(f"energy_{flash.cell}_in += gas * {flash.enthalpy}", f"oil_energy_port -= gas * {flash.heat}")
    if solution is not None:
        to.add("# gas that the oil gives off or takes up (M231)")
        to.add(f"s = {network.entropy}", f"gas, enthalpy, warmth = {solution.release}")
        to.add(f"mass_{solution.cell}_in += gas", f"energy_{solution.cell}_in += enthalpy")
        to.add("oil_energy_port -= warmth", "held_port -= gas")


def rates(to: Statements, network: Network) -> None:
    """Set the rates of the states: f_… of each, and those of work, heat and walls.

    Uses the chamber's states T, rho …, V, dV, phi, the state of its gas, m, m_oil and the totals of its streams.
    """
    to.add("omega = P[P_OMEGA]", "warmth = 0.0")
    if network.heated:
        to.add("# heat from the oil (M3), its temperature (M4)", "lost = 0.0", "d = R[R_RATIO]")
        for each in network.heats:
            to.add(f"heat = {each.call}", "warmth += heat", f"lost += {each.factor}heat")
        if network.pushes:  # work of the oil on the walls that drag it along (M257)
            to.add("lost += pushed")
        oil, energy, felt = ("oil", "oil_energy", "T_felt" if network.roomed else "T_oil")
        if not network.carried:
            oil = energy = "0.0"
        to.add(
            f"f_T_oil = {oil_temperature_slope.flat_name}({felt}, m_oil, m, P[P_C_OIL], {oil}, {energy}, lost, omega)"
        )
    if network.carried:
        to.add("# oil and gas in it (M8)" if network.dissolves else "# oil (M8)")
        to.add("f_x_oil = (oil - x_oil * mass) / (m * omega)")
    if network.dissolves:
        to.add(f"f_w_gas = {held_slope.flat_name}(w_gas, m_oil, m, oil, held, omega)")
    to.add("q_heat = warmth / omega")
    for label, wall in zip(Layout(network).walls, network.walls, strict=True):
        to.add(
            f"# heat from a wall (M170): {label}",
            f"conductance = {wall.call}",
            f"heat = conductance * ({wall.temperature} - T)",
            "warmth += heat",
        )
        to.add(f"q_wall_{label} = heat / omega", f"q_conductance_{label} = conductance / omega")
    if network.own_states:
        to.add(*(f"{name} = {value}" for name, value in line_pressures(network).items()))
        to.add("# states of effects")
    for name, rate in zip(network.own_states, network.rates, strict=True):
        to.add(f"f_{name} = {rate} / omega")
    to.add("# density and temperature of the gas (M1, M2)")
    if network.roomed:
        to.add("slope = dV - oil * P[P_ROOM] / omega", "f_rho = (mass / omega - rho * slope) * rho / m")
    else:
        to.add("slope = dV", "f_rho = (mass / omega - rho * dV) / V")
    to.add(f"f_T = {temperature_slope.flat_name}(T, m, rho, h, c_v, TpT, mass, energy, warmth, slope, omega)")
    to.add("# work of the volume on the gas (M7)", "q_work = -p * dV")
    if network.pushes:
        to.add("q_pushed = pushed / omega")


def between_texts(network: Network) -> list[str]:
    """Return the functions for a chamber between two steps."""
    return [_gas(network), _mass_rate(network)]


@writes("chamber__gas(V, y, at, P)")
def _gas(to: Statements, network: Network) -> None:
    """Return the gas [kg] in a chamber of volume V [m³], whose states begin at y[at] (M1, M106)."""
    mass = f"{gas_mass.flat_name}(V, y[at + S_rho], y[at + S_x_oil], P)" if network.roomed else "y[at + S_rho] * V"
    to.add(f"return {mass}")


@writes("chamber__mass_rate(theta, step, times, dense, E, y, P)")
def _mass_rate(to: Statements, network: Network) -> None:
    """Return dm/dphi [kg/rad] of the gas at the share theta of a step, where the state is y."""
    slope = dense_slope.flat_name
    to.add("h = times[step + 1] - times[step]")
    for name, column in (("rho", "S_rho"), ("x", "S_x_oil")) if network.roomed else (("rho", "S_rho"),):
        pieces = ", ".join(f"dense[step, {k}, {column}]" for k in range(4))
        to.add(f"d{name} = {slope}(theta, {pieces}) / h")
    if network.roomed:
        to.add(f"return {gas_mass_slope.flat_name}(E[E_VOLUME], E[E_SLOPE], y[S_rho], drho, y[S_x_oil], dx, P)")
    else:
        to.add("return E[E_VOLUME] * drho + E[E_SLOPE] * y[S_rho]")
