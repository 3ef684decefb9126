"""Write the functions of a composition's oil: its supply, the ports through which it enters, the gas that it releases.

Source: docs/model.md M9, M30, M104, M196, M230–M233, M392.
"""

import numpy as np

from screwsim.effects.base import OilGas, OilPort, OilSolution
from screwsim.fluid import solubility
from screwsim.fluid.orifice import orifice_flow, orifice_flow_behind_line
from screwsim.model.network.network import Flash, OilInflow, Solution, identifier
from screwsim.model.numbers import SPAN, SUPPLY
from screwsim.model.parts import OilPart, Parts
from screwsim.model.writing import ModelWriter
from screwsim.numerics.kernel import kernel
from screwsim.numerics.spline import table_value

BEGINS = "flash_begins"  # the pressure [Pa] below which gas flashes out of oil that enters


def write_supply(writer: ModelWriter, oil: OilPart | None, pitch: float, omega: float) -> None:
    """Write the oil [kg] injected at one angle, in a ratio to the gas or through an orifice during a pitch."""
    if oil is None:
        body = ["return 0.0"]
    elif "ratio" in oil.supply:
        ratio = writer.numbers.add(oil.supply["ratio"], "oil_supply_ratio", SUPPLY + "ratio")
        body = [f"return {ratio} * m"]
    else:
        name = "separator_pressure"
        separator = writer.numbers.add(oil.supply[name], name, SUPPLY + name)
        writer.text.append("")
        law = orifice_flow_behind_line if "line_loss" in oil.supply else orifice_flow
        call = writer.call(law, oil.supply, {}, ("dp",), SUPPLY)
        span = "P[P_PITCH] / P[P_OMEGA]"
        if not writer.network.slow:
            span = writer.numbers.add(pitch / omega, "pitch_over_omega", SPAN)
        body = [f"dp = {separator} - p", f"return {call} * {span}"]
    writer.function("injected_oil(p, m, P)", body)


def write_ports(writer: ModelWriter, parts: Parts, port: OilPort) -> None:
    """Write the oil [kg/s] that enters through a port, driven by pressures or dosed by a pump."""
    if parts.pumped:
        assert port.pumped is not None and parts.oil is not None
        ratio = writer.numbers.add(parts.oil.supply["ratio"], "oil_supply_ratio", SUPPLY + "ratio")
        flow, before = f"P[P_TRAPPED] * {ratio} * {writer.call(port.pumped, port.values, {}, ('phi', 'TAB'))}", []
    else:
        flow, before = writer.call(port.flow, port.values, {}, ("phi", "p", "width")), ["width = P[P_DISCHARGE_WIDTH]"]
    inflow = writer.in_time(flow)
    writer.network.inflow = OilInflow(inflow, parts.pumped)
    if writer.network.slow:
        before = [*before, f"slow = {writer.network.slow}"]
    writer.function("oil_inflow(phi, p, P, TAB)", [*before, f"return {inflow}"])


def write_flash(writer: ModelWriter, parts: Parts, oil: OilPart, part: OilGas) -> None:
    """Write the gas that flashes out of entering oil at once, or that oil releases over time where it dissolves gas."""
    content, state, cell = parts.oil_content, parts.plenums[part.plenum], identifier(part.plenum)
    assert content is not None
    if isinstance(content, OilSolution):
        write_solution(writer, content, cell)
        return
    curve = {"curve": (content.pressure, content.flashed)}
    call = writer.call(table_content, {}, curve, ("p", "TAB"), of="flash")
    enthalpy = writer.numbers.add(state.h, "flash_enthalpy")
    latent = writer.numbers.add(content.latent / oil.heat_capacity, "flash_latent")
    begins = writer.numbers.add(content.begins, BEGINS)
    writer.network.flash = Flash(cell, call, enthalpy, latent, begins)


def write_solution(writer: ModelWriter, content: OilSolution, cell: str) -> None:
    """Write the gas that a chamber's oil releases over time, and its entropy (M230–M233)."""
    z, s, rise = content.log_held, content.entropy, content.slope
    values = {"enthalpy": content.enthalpy, "release": content.release, "uptake": content.uptake}
    back = slice(None, None, -1)  # entropy falls as more is dissolved
    curve = {"curve": (s[back], z[back], _ends(1.0 / rise[back]))}
    free = ("m_oil", "w", "s", "h", "T_oil", "TAB")
    call = writer.call(solubility.given_off, values, curve, free, of="solution")
    head, _, given = call.partition("(")
    assert given.startswith("m_oil, w, ")
    inside = "slow * m_oil, w_gas, " if writer.network.slow else "m_oil, w_gas, "
    release = f"{head}({inside}{given.removeprefix('m_oil, w, ')}"
    writer.network.solution = Solution(cell, release, writer.numbers.add(content.supply, "dissolved_in_supply"))
    tables = {"curve": (z, s, _ends(rise)), "rest": (z, content.rest, _ends(-rise - content.rest))}
    call = writer.call(solubility.entropies, {}, tables, ("w", "TAB"), of="solution")
    writer.function("solution_entropy(w, P, TAB)", [f"return {call}"])


def _ends(slope: np.ndarray) -> np.ndarray:
    """Return the slopes at both ends of each interval, shape (n - 1, 2), from those at the rows."""
    return np.column_stack([slope[:-1], slope[1:]])


@kernel
def table_content(p, TAB, curve):
    """Return the gas that flashes out of a kilogram of oil at pressure p, from the table at TAB[curve] (M196)."""
    return table_value(p, TAB, curve)
