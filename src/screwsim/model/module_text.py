"""The text of the flat module: pasted kernels with all they use, and functions that a composition writes itself."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

from screwsim.model import ledger, port_states, slices, slots, trace
from screwsim.model.network.chamber import chamber_texts
from screwsim.model.network.chamber_alone import chamber_alone_texts
from screwsim.model.network.chambers import chambers_texts
from screwsim.model.network.layout import Layout
from screwsim.model.network.moments import moment_text
from screwsim.model.network.network import Network
from screwsim.model.network.stops import OF_EACH
from screwsim.numerics import history, rodas
from screwsim.numerics.kept_text import kept_text
from screwsim.numerics.kernel import HEADER, Kernel, Slot, flatten

# functions that the integrator calls in both drivers, by its slots (rodas.py)
ASKED = ("surroundings", "rates", "jacobian", "error_size", "share_in_phase", "conserve", "lands")
ASKED += ("at_breakpoint", "jump", "keep_port_states")

# kernels for installing histories and reading closed cycles
READ_WITH = (port_states.port_states_along, history.add_history, history.states_at, ledger.account, ledger.arriving)
READ_WITH += (trace.peak_pressure, trace.volumes, trace.volume_slopes, trace.sample, trace.work_along)
READ_WITH += (trace.areas_along, trace.pressures)

# kernels for linearising a pitch
AT_NODES = (slices.rates_at, slices.derivatives_at)
OF_A_PITCH = (*AT_NODES, slices.derivatives)

# functions that a composition writes itself, by the slots that they fill
OWN = {each.name: each.filled_by for each in vars(slots).values() if isinstance(each, Slot)}


@lru_cache(maxsize=64)
def module_text(
    key: tuple[Any, ...],
    own_functions: tuple[str, ...],
    named: tuple[tuple[str, Any], ...],
    structure: tuple[tuple[str, int], ...],
    read_with: tuple[Kernel, ...] = (),
    together: bool = False,
) -> str:
    """Return the text of a flat module: constants, pasted kernels, the composition's functions, the driver.

    `key` is that of the network; `own_functions` have been written already. The module of one
    chamber includes all kernels for reading a closed cycle, and `read_with`; that of all chambers `together` only
    the driver; without neighbours, only its rates at many angles. A text that was written before is read from the cache
    folder, where its key is everything it is made of.
    """
    *network, called = key
    drivers = (rodas.integrate, *OF_A_PITCH, *READ_WITH, *OF_EACH)
    alone = together and Network(*key).chambers == 1
    stops = () if alone else Layout(Network(*key)).stops

    def write() -> str:
        """Return the text, written now."""
        texts, kernels = (chamber_alone_texts if alone else chambers_texts if together else chamber_texts)(key)
        moments = () if together else (moment_text(key),)
        own = (*own_functions, *texts, *moments)
        return _written(own, kernels, named, structure, read_with, stops, together)

    made_of = (network, own_functions, named, structure, together)
    return kept_text(("model", "numerics"), (*dict(called).values(), *drivers, *read_with), made_of, write)


def _written(
    own_functions: tuple[str, ...],
    kernels: tuple[Kernel, ...],
    named: tuple[tuple[str, Any], ...],
    structure: tuple[tuple[str, int], ...],
    read_with: tuple[Kernel, ...],
    stops: Sequence[str],
    together: bool,
) -> str:
    """Return the text of a module: constants, kernels, the composition's own functions, drivers, each once."""
    constants, numbers = dict(named), dict(structure)
    own = {name: name for name in constants} | OWN
    blocks = flatten(kernels, own, numbers=numbers)
    for label in stops:
        blocks |= flatten(OF_EACH, own | {"push_on": f"push_on__{label}"}, f"_{label}", numbers)
    blocks |= {f"own {i}": text for i, text in enumerate(own_functions)}
    coupled = together and constants["CHAMBERS"] > 1
    many, whose = (constants["CHAMBERS"], "chambers") if coupled else (1, "chamber")
    sizes = {"STATES": many * constants["N"], "QUADRATURES": numbers["QUADRATURES"] + coupled}
    slots = {name: f"{whose}__{name}" for name in ASKED} | {"exact_jacobian": "chamber__exact_jacobian"}
    if coupled:  # derivatives by numbers of a scene must be exact; for an ideal, dry gas the integrator's are
        exact = any(text.startswith("def chambers__exact_jacobian(") for text in own_functions)
        slots["exact_jacobian"] = "chambers__exact_jacobian" if exact else slots["jacobian"]
    drivers = (rodas.integrate, *(OF_A_PITCH if coupled else ())) if coupled or not together else AT_NODES
    driver = flatten(drivers, slots, "_all" if together else "_one", sizes)
    rest = () if together else (*READ_WITH, *read_with)
    for more in (flatten(rest, own, numbers=numbers), driver):
        blocks |= {name: text for name, text in more.items() if name not in blocks}
    lines = [HEADER, *(f"{name} = {value}" for name, value in named)]
    return "\n\n".join(["\n".join(lines), *blocks.values()]) + "\n"
