"""Exchange of a chamber of a stored cycle with the lines, as text: port flows from the mass balance, flows to lines.

Source: docs/model.md M1, M106, M184; docs/explanation/errors.md. A wide port is held at its line by a tiny Δp, which
between the ends of a step carries the whole error of the pressure; the change of the chamber's gas does not. So the
mass balance determines the flow through one port: for the ledger the widest, if near its line's pressure; for pulsating
lines, which receive flow at any pressure, the only port that is open to a line.
"""

from screwsim.model.network.cell import Cell
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import Network, Port
from screwsim.model.network.statements import Statements, writes
from screwsim.model.slots import FIRST_OWN

NEAR = 100.0  # widths ε of a port within which the mass balance gives its flow more accurately than its Δp


def line_flow_texts(network: Network) -> list[str]:
    """Return the functions for flows to lines that a network needs."""
    texts = [_balanced_flow(network), _balanced(network)]
    if network.pulsating:
        texts += [_faces_line(network), _balanced_alone(network), _add_to_lines(network)]
    if network.heated and not network.carried:
        texts += [_lets_out(network), _add_outflow(network)]
    return texts


def _to_lines(network: Network) -> list[Port]:
    return [port for port in network.ports if port.number < FIRST_OWN]


@writes("chamber__told(flows, port, mass_rate)")
def _balanced_flow(to: Statements, network: Network) -> None:
    """Let the mass balance tell the flow [kg/s] through a port (M1)."""
    to.add("flows[port] = 0.0", "others = 0.0", *(f"others += flows[{flow}]" for flow in Layout(network).flows))
    to.add("flows[port] = mass_rate - others")


@writes("chamber__balanced(flows, mass_rate, E, own, R, P)")
def _balanced(to: Statements, network: Network) -> None:
    """Let the mass balance tell the flow [kg/s] through the widest port, at nearly equal pressures (M1)."""
    cell, layout = Cell(network), Layout(network)
    wide = [port for port in network.ports if port.wide]
    if wide:
        to.add("widest = 0.0", "port = 0", "drop = 0.0", "width = 0.0")
        for port in wide:
            array, at = cell.line(port.cell)
            opened = f" * {layout.share(port, 'OPENED')}" if port.opening else ""
            to.add(f"area = E[{layout.area(port)}]{opened}")
            with to.within("if area > widest"):
                to.add("widest = area", f"port = {layout.flow(port)}", f"width = {port.width}")
                to.add(f"drop = {array}[{at} + PRESSURE] - own[PRESSURE]")
        with to.within(f"if widest > 0.0 and abs(drop) < {NEAR!r} * width"):
            to.add("chamber__told(flows, port, mass_rate)")


@writes("chamber__balanced_alone(flows, mass_rate)")
def _balanced_alone(to: Statements, network: Network) -> None:
    """Let the mass balance tell the flow [kg/s] of a port, where no other is open to a line (M1)."""
    layout, ports = Layout(network), _to_lines(network)
    to.add("opened = 0", "port = 0")
    for port in ports:
        with to.within(f"if flows[{layout.flow(port)}] != 0.0"):
            to.add("opened += 1", f"port = {layout.flow(port)}")
    with to.within("if opened == 1"):
        to.add("chamber__told(flows, port, mass_rate)")


def _beyond(offset: int, phi: str = "phi") -> str:
    """Return the test for the discharge line being some lobe pitches ahead of a chamber at phi."""
    return f"{phi} + {offset} * P[P_PITCH] > P[P_LIFE]"


@writes("chamber__faces_line(phi, P, TAB)")
def _faces_line(to: Statements, network: Network) -> None:
    """Tell whether a chamber at phi [rad] is open to a line, by a port or by a gap beyond the last chamber."""
    layout = Layout(network)
    for port in _to_lines(network):
        with to.within(f"if {layout.area_at(port, 'phi')} > 0.0"):
            to.add("return True")
    to.add(f"return {' or '.join(map(_beyond, network.offsets)) or 'False'}")


@writes("chamber__add_to_lines(flows, phi, V, share, k, points, P, into, volume)")
def _add_to_lines(to: Statements, network: Network) -> None:
    """Add a share of the flows of a chamber of volume V [m³] at phi [rad] to those into both lines (M184)."""
    layout = Layout(network)
    for number, line in enumerate(network.lines):
        ports = [port for port in network.ports if port.number == number]
        flows = [f"flows[{layout.flow(port)}]" for port in ports]
        to.add(*(f"into[LINE_{line}, k] -= share * {flow}" for flow in flows))
        if flows:
            with to.within(f"if {' or '.join(f'{flow} != 0.0' for flow in flows)}"):
                to.add(f"volume[LINE_{line}] += share * V / points")
    for gap in network.gaps:
        with to.within(f"if {_beyond(network.offsets[gap.side])}"):
            to.add(f"into[LINE_{network.lines[1]}, k] -= share * flows[{layout.flow(gap, 'ahead')}]")


@writes("chamber__lets_out(phi, middle, P, TAB)")
def _lets_out(to: Statements, network: Network) -> None:
    """Tell whether a chamber at phi [rad] is open to the discharge line; `middle` tells what lies ahead."""
    layout = Layout(network)
    for port in network.ports:
        if port.cell == network.lines[1]:
            with to.within(f"if {layout.area_at(port, 'phi')} > 0.0"):
                to.add("return True")
    for gap in network.gaps:
        beyond = _beyond(network.offsets[gap.side], "middle")
        with to.within(f"if {beyond} and {layout.area_at(gap, 'phi')} > 0.0"):
            to.add("return True")
    to.add("return False")


@writes("chamber__add_outflow(heat, mass, flows, T_oil, weight, E)")
def _add_outflow(to: Statements, network: Network) -> None:
    """Return heat + Σ weight ṁ T_oil and mass + Σ weight ṁ of what flows out to the discharge line."""
    layout = Layout(network)
    for port in network.ports:
        if port.cell == network.lines[1]:
            _leaving(to, f"flows[{layout.flow(port)}]", f"if flows[{layout.flow(port)}] < 0.0")
    for gap, way in layout.sides:
        flow, port_state = f"flows[{layout.flow(gap, way)}]", f"E[E_{layout.neighbour(gap.side, way)} + BEYOND]"
        if way == "ahead":
            _leaving(to, flow, f"if {flow} < 0.0 and {port_state} > 0.0")
    to.add("return heat, mass")


def _leaving(to: Statements, flow: str, test: str) -> None:
    with to.within(test):
        to.add(f"heat += weight * {flow} * T_oil", f"mass += weight * {flow}")
