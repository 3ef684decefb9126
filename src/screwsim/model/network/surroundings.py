"""The surroundings of chambers, as text: volume and areas at an angle, port states of neighbours and pulsating lines.

Source: docs/model.md M1–M13, M24, M184–M186. Neighbours are read from histories. Of all chambers together, over one
lobe pitch, chamber j is at s + j pitch. A context is one of `model.trajectory`.
"""

from screwsim.model.network.flows import NUMBERS, needed
from screwsim.model.network.layout import Layout
from screwsim.model.network.network import Network
from screwsim.model.network.statements import Statements, function, writes
from screwsim.model.port_states import read_ahead, read_behind
from screwsim.model.pulsation import pulsed
from screwsim.numerics.kernel import Kernel

DISCHARGE = 1  # number of the line that lies ahead of the last chamber
PULSED = ("p", "rho", "h")  # numbers that pulsate with a line


def surroundings_kernels(network: Network) -> list[Kernel]:
    """Return the kernels that the texts call."""
    asked = {read_ahead: bool(network.gaps), read_behind: bool(network.gaps), pulsed: network.pulsating}
    return [each for each, wanted in asked.items() if wanted]


@writes("chamber__surroundings(phi, middle, context, E)", "P, TAB, R = context.P, context.TAB, context.R")
def surroundings_text(to: Statements, network: Network) -> None:
    """Fill E for a chamber at phi [rad]: volume, areas of openings, port states of neighbours (M1, M24)."""
    layout = Layout(network)
    _of_angle(to, network, "middle")
    for port in network.ports:
        to.add(f"E[{layout.area(port)}] = {layout.area_at(port, 'phi')}")
    if network.pulsating:
        to.add("chamber__lines(phi, P, R, E)")
    for side, offset in enumerate(network.offsets):
        to.add(f"shift = {offset} * P[P_PITCH]")
        gaps = [gap for gap in network.gaps if gap.side == side]
        for gap in gaps:
            to.add(f"E[{layout.area(gap, 'ahead')}] = {layout.area_at(gap, 'phi')}")
            behind = layout.area_at(gap, "phi - shift")
            to.add(f"E[{layout.area(gap, 'behind')}] = {behind} if middle > shift else 0.0")
        for way in ("ahead", "behind"):
            there, opened = layout.neighbour(side, way), " + ".join(f"E[{layout.area(gap, way)}]" for gap in gaps)
            with to.within(f"if {opened} > 0.0"):
                asked = f"phi, middle, shift, HINT_{there}, context, E, E_{there}"
                if way == "behind":
                    to.add(f"{read_behind.flat_name}({asked})")
                    continue
                with to.within("if middle + shift > P[P_LIFE]"):
                    to.add(f"chamber__beyond_last(R, E, E_{there})")
                with to.within("else"):
                    to.add(f"{read_ahead.flat_name}({asked})")


@writes("chambers__surroundings(s, middle, context, E)", "P, TAB, R = context.P, context.TAB, context.R")
def surroundings_together_text(to: Statements, network: Network) -> None:
    """Fill E for all chambers, the first at s [rad]: volume, areas of its openings (M1, M24)."""
    layout = Layout(network)
    with to.within("for j in range(CHAMBERS)"):
        to.add("e = j * E_CHAMBER", "phi = s + j * P[P_PITCH]")
        _of_angle(to, network, "middle + j * P[P_PITCH]", "e + ")
        for each in (*network.ports, *network.gaps):
            to.add(f"E[e + {layout.area(each)}] = {layout.area_at(each, 'phi')}")
    if network.pulsating:
        to.add("chambers__lines(s, P, R, E)")


def _of_angle(to: Statements, network: Network, middle: str, e: str = "") -> None:
    """Set what depends on the angle `phi` alone; oil is present after the injection angle."""
    to.add(f"E[{e}E_ANGLE] = phi")
    to.add(f"E[{e}E_VOLUME] = volume_at(phi, P, TAB)", f"E[{e}E_SLOPE] = volume_slope_at(phi, P, TAB)")
    if network.heated and not network.carried:
        to.add(f"E[{e}E_OILED] = 1.0 if {middle} > P[P_INJECTION] else 0.0")


@writes("chamber__beyond_last(R, E, at)")
def beyond_last_text(to: Statements, network: Network) -> None:
    """Fill the port state of the discharge line, ahead of the last chamber, at E[at]."""
    array, line = Layout(network).line(network.cells[DISCHARGE])
    to.add(*(f"E[at + {number}] = {array}[{line} + {number}]" for number in needed(network).values()))
    to.add("E[at + BEYOND] = 1.0")


def lines_texts(network: Network, whose: str) -> list[str]:
    """Return the text that fills the port states of lines and plenums into E, where lines pulsate (M186).

    `whose` is "chamber" for one of them, "chambers" for all together.
    """
    if not network.pulsating:
        return []
    layout, to = Layout(network), Statements()
    for cell in filter(None, network.cells):
        _, at = layout.line(cell, whose == "chambers")
        pulsates = cell in network.pulses
        if pulsates:
            p, rho, h, inverse = (f"R[R_{cell} + {NUMBERS[name]}]" for name in (*PULSED, "exponent"))
            to.add(f"offset, pulse = pulse__{cell}(phi, P)  # {cell}")
            to.add(f"p, rho, h = {pulsed.flat_name}({p}, {rho}, {h}, {inverse}, offset, pulse)")
        for name, number in needed(network).items():
            found = name if pulsates and name in PULSED else f"R[R_{cell} + {number}]"
            to.add(f"E[{at} + {number}] = {found}")
    text = '"""Fill the port states of lines and plenums, those of lines as they pulsate at phi [rad] (M186)."""'
    return [function(f"{whose}__lines(phi, P, R, E)", [text], to.lines)]
