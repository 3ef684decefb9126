"""Flows through openings and the streams that they carry, each stated once and used by every text.

Source: docs/model.md M10–M13, M184–M186, M252, M256. A flow [kg/s] is positive into the chamber. Its stream has the
port state of its source: mass, enthalpy, oil, oil times temperature, dissolved gas. Which streams an opening has, and
how their fluxes follow from the port states, says its kind (`effects.parts.flow_kinds`).
"""

from dataclasses import dataclass

from screwsim.fluid.nozzle import flow
from screwsim.model.network.network import Gap, Network, Port
from screwsim.model.network.statements import Statements
from screwsim.numerics.path_stream import PathStream

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


@dataclass(frozen=True)
class Around:
    """What a stream's text may name, for a chamber with a port state beyond an opening."""

    own: PortState
    beyond: PortState
    width: str  # of the regularisation [Pa]
    leading: PortState  # that of the chamber ahead, or of the line
    slow: bool = False  # whether the speed varies over the pitch

    def lines(self, stream: PathStream) -> list[str]:
        """Return the statements before a stream's flux."""
        return [self._filled(line) for line in stream.before]

    def flux(self, stream: PathStream) -> str:
        """Return a stream's flux [kg/(m² s)]."""
        return self._filled(stream.flux)

    def _filled(self, text: str) -> str:
        if "{" not in text:
            return text
        return text.format(
            own=self.own,
            beyond=self.beyond,
            leading=self.leading,
            width=self.width,
            nozzle=f"{FLOW}(1.0, {self.own.nozzle}, {self.beyond.nozzle}, {self.width})",
            per_slow=" / slow" if self.slow else "",
        )


def around_port(network: Network, port: Port, own: PortState, beyond: PortState) -> Around:
    """Return what the text of a port's streams may name."""
    return Around(own, beyond, port.width, beyond, bool(network.slow))


def around_gap(network: Network, own: PortState, beyond: PortState, way: str) -> Around:
    """Return what the text of a gap's streams may name; beyond it lies the chamber ahead or behind."""
    width = f"0.5 * P[P_GAP_WIDTH] * ({own.p} + {beyond.p})"
    return Around(own, beyond, width, beyond if way == "ahead" else own, bool(network.slow))


def gas_flux(to: Statements, opening: Port | Gap, around: Around, label: str = "") -> None:
    """Set `flux` [kg/(m² s)] of the gas through an opening (M12).

    Of a port whose open share depends on the state it is times that share; `label` names its switch.
    """
    to.add(*around.lines(opening.gas))
    flux = around.flux(opening.gas)
    if isinstance(opening, Gap) or not opening.opening:
        to.add(f"flux = {flux}")
        return
    to.add(f"drop = {around.beyond.p} - {around.own.p}", f"width = {opening.width}", f"held = switch_{label}")
    to.add(f"opened = {opening.opening}")
    to.add(f"flux = opened * {flux}")
