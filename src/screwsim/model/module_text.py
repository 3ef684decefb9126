"""The text of the flat module: kernels pasted with all they use, and what a composition writes itself."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from screwsim.model import (
    chamber,
    chamber_steps,
    coupled,
    coupled_steps,
    landing,
    ledger,
    line_flow,
    places,
    trace,
)
from screwsim.numerics import history, rodas
from screwsim.numerics.kernel import HEADER, Kernel, flatten

# what the integrator calls of both drivers: by its slot (rodas.py)
ONE = {
    "surroundings": chamber.surroundings,
    "rates": "chamber__rates",
    "jacobian": "chamber__jacobian",
    "error_size": chamber_steps.error_size,
    "share_in_phase": chamber_steps.share_in_phase,
    "conserve": chamber_steps.conserve,
    "at_knot": chamber_steps.at_knot,
    "keep_places": places.keep_places,
    "lands": landing.lands,
}
ALL = {
    "surroundings": coupled.all_surroundings,
    "rates": "chambers__rates",
    "jacobian": "chambers__jacobian",
    "error_size": coupled_steps.all_error_size,
    "share_in_phase": coupled_steps.all_share_in_phase,
    "conserve": coupled_steps.all_conserve,
    "at_knot": coupled_steps.no_knot,
    "keep_places": coupled_steps.no_places,
    "lands": landing.all_lands,
}

# what a composition writes itself (slots.py)
OWN = {name: name for name in (
    *("gas_state", "gas_phase", "phased_state", "gas_entropy", "volume_at", "volume_slope_at", "plenum_area"),
    *("gap_area", "line_pulse", "injected_oil", "oil_inflow", "path_opening"),
    *("stop_push", "restitution", "solution_entropy"),
)}  # fmt: skip
OWN |= {name: f"chamber__{name}" for name in ("path_flows", "film_flows", "given_off")}
OWN["add_moment"] = "ledger__add_moment"


@lru_cache(maxsize=64)
def module_text(
    own_functions: tuple[str, ...],
    kernels: tuple[Kernel, ...],
    named: tuple[tuple[str, Any], ...],
    structure: tuple[tuple[str, int], ...],
    together: bool = False,
) -> str:
    """Return a flat module: constants, pasted kernels, the composition's functions, the driver.

    That of one chamber holds all that a closed cycle is read with; that of all chambers `together` the driver alone.
    """
    constants, numbers = dict(named), dict(structure)
    own = {name: name for name in constants} | OWN
    filling = ALL if together else ONE
    rooms = [each for each in filling.values() if not isinstance(each, str)]
    if not together:
        rooms += _read_with(constants, numbers)
    blocks = flatten(kernels, own, numbers=numbers)
    blocks |= {f"own {i}": text for i, text in enumerate(own_functions)}
    slots = {name: filler if isinstance(filler, str) else filler.flat_name for name, filler in filling.items()}
    jumps = int(numbers["STOPS"] > 0 and not together)
    if jumps:
        rooms.append(chamber_steps.jump)
        slots["jump"] = chamber_steps.jump.flat_name
    quadratures = numbers["Q_STREAMS"] + numbers["CATEGORIES"] * numbers["WIDTH"] + together
    sizes = {"STATES": (constants["CHAMBERS"] if together else 1) * constants["N"], "QUADRATURES": quadratures}
    driver = flatten((rodas.integrate,), slots, "_all" if together else "_one", {"JUMPS": jumps, **sizes})
    for more in (flatten(rooms, own, numbers=numbers), driver):
        blocks |= {name: text for name, text in more.items() if name not in blocks}
    lines = [HEADER, *(f"{name} = {value}" for name, value in named)]
    return "\n\n".join(["\n".join(lines), *blocks.values()]) + "\n"


def _read_with(constants: Mapping[str, Any], numbers: Mapping[str, int]) -> list[Kernel]:
    """Return what histories are put in place with, and what closed cycles are read with."""
    found = [chamber_steps.inject, places.places_along, history.add_history, history.states_at, ledger.account]
    found += [trace.peak_pressure, trace.volumes, trace.sample, trace.work_along]
    found += [ledger.arriving, ledger.oil_arriving, ledger.pressed_oil_arriving]
    asked = {
        ledger.held_arriving: numbers["DISSOLVES"],
        trace.oil_with_outflow: constants["HEATED"] and not constants["CARRIED"],
        line_flow.into_lines: numbers["PULSATING"],
        trace.oil_films: numbers["FILMED"],
        trace.port_oil: numbers["PORTED"],
    }
    return [*found, *(each for each, wanted in asked.items() if wanted)]
