"""Flows through openings and the streams that they carry, each stated once and used by every text.

Source: docs/model.md M10–M13, M184–M186, M190, M250–M252, M256. A flow [kg/s] is positive into the chamber. Its stream
has the port state of its source: mass, enthalpy, oil, oil times temperature, dissolved gas.
"""

from dataclasses import dataclass

from screwsim.fluid.nozzle import flow
from screwsim.model.network.network import Gap, Law, Network, Port
from screwsim.model.network.statements import Statements

FLOW = flow.flat_name
NUMBERS = {  # of a port state: their indices (slots.PRESSURE …) by local name
    "p": "PRESSURE",
    "rho": "DENSITY",
    "h": "ENTHALPY",
    "exponent": "EXPONENT",
    "choke": "CHOKE",
    "choked": "CHOKED",
    "oil_ratio": "OIL_RATIO",
    "T_oil": "OIL_TEMPERATURE",
    "held": "DISSOLVED",
}


@dataclass(frozen=True)
class PortState:
    """Names of the numbers of a port state: of the chamber itself, or of what lies beyond an opening."""

    p: str
    rho: str  # as used by flows (M107)
    h: str
    exponent: str
    choke: str
    choked: str
    oil_ratio: str
    T_oil: str  # enthalpy over heat capacity of the oil (M108)
    held: str

    @property
    def nozzle(self) -> str:
        """The arguments of a nozzle from a port state."""
        return f"{self.p}, {self.rho}, {self.exponent}, {self.choke}, {self.choked}"


def needed(network: Network) -> dict[str, str]:
    """Return the numbers of a port state that flows and streams use, with their indices."""
    skipped = () if network.carried else ("oil_ratio", "T_oil")
    skipped += () if network.dissolves else ("held",)
    return {name: at for name, at in NUMBERS.items() if name not in skipped}


def port_state_of(network: Network, cell: str) -> PortState:
    """Return the names of a port state's numbers: `p_suction` …; 0.0 for those that do not exist."""
    asked = needed(network)
    return PortState(*(f"{name}_{cell}" if name in asked else "0.0" for name in NUMBERS))


def read_port_state(
    to: Statements, network: Network, cell: str, array: str, at: str, instead: tuple[str, str] = ("", "")
) -> None:
    """Read the numbers of a port state from an array, or from another array where a test holds."""
    test, other = instead
    for name, number in needed(network).items():
        found = f"{array}[{at} + {number}]"
        to.add(f"{name}_{cell} = " + (f"{other}[{at} + {number}] if {test} else {found}" if test else found))


def stream_terms(to: Statements, network: Network, stream: str, source: PortState) -> dict[str, str]:
    """Return the addition of a stream to the sum of each quantity."""
    terms = {"mass": stream, "energy": f"{stream} * {source.h}"}
    if network.carried:
        to.add(f"oil = {stream} * {source.oil_ratio}")
        terms |= {"oil": "oil", "oil_energy": f"oil * {source.T_oil}"}
        if network.dissolves:
            terms["held"] = f"oil * {source.held}"
    return terms


def add_flow(to: Statements, network: Network, sums: str, source: PortState) -> None:
    """Add a stream, `flow` [kg/s], of a port state to sums."""
    for quantity, term in stream_terms(to, network, "flow", source).items():
        to.add(f"{quantity}_{sums} += {term}")


def add_film(to: Statements, network: Network, sums: str, source: PortState) -> None:
    """Add an oil film, `film` [kg/s], of a port state to sums (M252)."""
    to.add(f"oil_{sums} += film", f"oil_energy_{sums} += film * {source.T_oil}")
    if network.dissolves:
        to.add(f"held_{sums} += film * {source.held}")


def _flux(to: Statements, law: Law | None, own: PortState, beyond: PortState, width: str) -> str:
    """Return a call for the flux [kg/(m² s)] into the chamber: a nozzle's (M12), or the path's own law."""
    if law is None:
        return f"{FLOW}(1.0, {own.nozzle}, {beyond.nozzle}, {width})"
    port_states = {"1": own, "2": beyond}
    for name in law.asks:
        number, _, side = name.rpartition("_")
        to.add(f"{name} = {getattr(port_states[side], number)}" if side in port_states else f"{name} = {width}")
    return law.call


def port_flux(to: Statements, port: Port, label: str, own: PortState, beyond: PortState) -> None:
    """Set `flux` [kg/(m² s)] through a port (M12), times its open share where that depends on the state."""
    flux = _flux(to, port.law, own, beyond, port.width)
    if not port.opening:
        to.add(f"flux = {flux}")
        return
    to.add(f"drop = {beyond.p} - {own.p}", f"width = {port.width}", f"held = switch_{label}")
    to.add(f"opened = {port.opening}")
    to.add(f"flux = opened * {flux}")


def gap_flux(to: Statements, gap: Gap, own: PortState, beyond: PortState) -> None:
    """Set `flux` [kg/(m² s)] through a gap, reduced by its resistance (M190)."""
    nozzle = _flux(to, gap.law, own, beyond, f"0.5 * P[P_GAP_WIDTH] * ({own.p} + {beyond.p})")
    if not gap.share:
        to.add(f"flux = {nozzle}")
        return
    to.add(f"nozzle = {nozzle}")
    for head, source in (("if nozzle >= 0.0", beyond), ("else", own)):
        with to.within(head):
            to.add(f"density = {source.rho}", f"oil_ratio = {source.oil_ratio}")
    to.add("flux = abs(nozzle)", f"flux = nozzle * {gap.share}")


def film_flux(to: Statements, gap: Gap, own: PortState, beyond: PortState) -> None:
    """Set the oil `film` [kg/(m² s)] through a gap, driven by the pressure difference (M252)."""
    to.add(f"drop = {beyond.p} - {own.p}")
    for head, sign, source in (("if drop >= 0.0", "", beyond), ("else", "-", own)):
        with to.within(head):
            to.add(f"oil_ratio = {source.oil_ratio}")
            if sign:
                to.add("drop = -drop")
            to.add(f"film = {sign}{gap.film}")


def drag_flux(to: Statements, network: Network, gap: Gap, ahead: PortState) -> None:
    """Set the oil `drag` [kg/(m² s)] that a wall drags from the port state ahead, independent of pressures (M256)."""
    to.add(f"oil_ratio = {ahead.oil_ratio}", f"drag = {gap.drag}{' / slow' if network.slow else ''}")
