"""Motion between a seat and a stop, as text: each pair of position and speed by its name (`model.impacts`).

Source: docs/reference/slider-crank.md S26, S32, S33.
"""

from screwsim.model import impacts
from screwsim.model.network.network import Network, Stop
from screwsim.model.network.statements import Statements, writes
from screwsim.numerics.kernel import Kernel

AROUND = "R, P, TAB"
OF_EACH = (impacts.begin, impacts.share_before_event, impacts.take_event)  # pasted for every pair, with its push


def stop_kernels(network: Network) -> list[Kernel]:
    """Return the kernels that the texts call for every pair alike."""
    alike = [impacts.keep_at_rest, impacts.keep_rows_at_rest, impacts.put_within, impacts.share_before_meeting]
    return alike if network.stops else []


def stop_texts(network: Network) -> list[str]:
    """Return the functions for everything that moves between a seat and a stop."""
    if not network.stops:
        return []
    return [_begin(network), _share_before_event(network), _put_within(network), _take_event(network)]


def _of(stop: Stop) -> str:
    """Return the arguments with the indices of a pair's position, speed, mode and due event."""
    return f"S_{stop.position}, S_{stop.speed}, MODE_{stop.position}, DUE_{stop.position}"


def at_rest(network: Network, by: Kernel, array: str) -> list[str]:
    """Return calls of a kernel that zeroes what belongs to resting pairs in an array: rates, or rows of a Jacobian."""
    return [
        f"{by.flat_name}(own, MODE_{each.position}, S_{each.position}, S_{each.speed}, {array})"
        for each in network.stops
    ]


@writes(f"chamber__begin_modes(y, own, {AROUND})")
def _begin(to: Statements, network: Network) -> None:
    """Set the modes at the start of a turn, whose state may be a mixture of others (S26)."""
    to.add("own[IMPACTS] = 0.0")
    for stop in network.stops:
        to.add(f"{impacts.begin.flat_name}_{stop.position}(y, own, {_of(stop)}, {AROUND})")


@writes(f"chamber__share_before_event(y, y1, u, rtol, own, {AROUND})")
def _share_before_event(to: Statements, network: Network) -> None:
    """Return the share of a step after which the first pair meets seat or stop, or leaves it (S32)."""
    to.add("step = own[STEP_END] - own[STEP_BEGIN]", "share = 1.0")
    for stop in network.stops:
        call = f"{impacts.share_before_event.flat_name}_{stop.position}"
        to.add(f"share = min(share, {call}(y, y1, u, rtol, step, own, {_of(stop)}, {AROUND}))")
    to.add("return share")


@writes("chamber__put_within(y1, own)")
def _put_within(to: Statements, network: Network) -> None:
    """Put positions at the end of an accepted step where they were met, and none beyond seat or stop."""
    put = impacts.put_within.flat_name
    to.add(*(f"{put}(y1, own, S_{stop.position}, DUE_{stop.position})" for stop in network.stops))


@writes(f"chamber__take_event(y, rtol, own, {AROUND})")
def _take_event(to: Statements, network: Network) -> None:
    """Apply what is due between two steps (S26, S33); tell whether there were not too many impacts."""
    for stop in network.stops:
        where = f"S_{stop.speed}, MODE_{stop.position}, DUE_{stop.position}, {stop.seat}, {stop.stop}"
        to.add(f"own[IMPACTS] += {impacts.take_event.flat_name}_{stop.position}(y, rtol, own, {where}, {AROUND})")
    to.add(f"return own[IMPACTS] <= {impacts.MOST_IMPACTS!r}")
