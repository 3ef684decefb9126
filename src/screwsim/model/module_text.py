"""The text of the flat module: kernels pasted with all they use, and what a composition writes itself."""

from __future__ import annotations

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
    *("flash_terms", "stop_push", "restitution", "release_terms", "solution_entropy"),
)}  # fmt: skip
OWN |= {"path_flows": "chamber__path_flows", "film_flows": "chamber__film_flows", "add_moment": "ledger__add_moment"}


@lru_cache(maxsize=64)
def module_text(
    own_functions: tuple[str, ...],
    kernels: tuple[Kernel, ...],
    named: tuple[tuple[str, Any], ...],
    structure: tuple[tuple[str, int], ...],
) -> str:
    """Return the flat module: constants, pasted kernels, the composition's functions, the drivers."""
    constants, numbers = dict(named), dict(structure)
    quadratures = numbers["Q_STREAMS"] + numbers["CATEGORIES"] * numbers["WIDTH"]
    lines = [HEADER, *(f"{name} = {value}" for name, value in named)]
    own = {name: name for name in constants} | OWN
    fillers = (each for each in (*ONE.values(), *ALL.values()) if not isinstance(each, str))
    rooms = *fillers, chamber_steps.inject, places.places_along
    model = flatten(rooms, own, numbers=numbers)
    model |= flatten((history.add_history, history.states_at))
    model |= flatten((trace.peak_pressure, trace.volumes, trace.sample, trace.work_along), own, numbers=numbers)
    moments = ledger.account, ledger.arriving, ledger.oil_arriving, ledger.pressed_oil_arriving
    moments += (ledger.held_arriving,) if numbers["DISSOLVES"] else ()
    model |= flatten(moments, own, numbers=numbers)
    if constants["HEATED"] and not constants["CARRIED"]:
        model |= flatten((trace.oil_with_outflow,), own, numbers=numbers)
    if numbers["PULSATING"]:
        model |= flatten((line_flow.into_lines,), own, numbers=numbers)
    if numbers["FILMED"]:
        model |= flatten((trace.oil_films,), own, numbers=numbers)
    if numbers["PORTED"]:
        model |= flatten((trace.port_oil,), own, numbers=numbers)
    if numbers["STOPS"]:
        model |= flatten((chamber_steps.jump,), own, numbers=numbers)
    blocks = flatten(kernels, own, numbers=numbers)
    blocks |= {f"own {i}": text for i, text in enumerate(own_functions)}
    blocks |= {name: text for name, text in model.items() if name not in blocks}
    drivers = ("_one", ONE, 1, 0), ("_all", ALL, constants["CHAMBERS"], 1)
    for kind, filling, chambers, more in drivers[: 1 + (constants["CHAMBERS"] > 1)]:
        slots = {name: filler if isinstance(filler, str) else filler.flat_name for name, filler in filling.items()}
        jumps = int(numbers["STOPS"] > 0 and filling is ONE)
        if jumps:
            slots["jump"] = chamber_steps.jump.flat_name
        sizes = {"STATES": chambers * constants["N"], "QUADRATURES": quadratures + more}
        driver = flatten((rodas.integrate,), slots, kind, {"JUMPS": jumps, **sizes})
        blocks |= {name: text for name, text in driver.items() if name not in blocks}
    return "\n\n".join(["\n".join(lines), *blocks.values()]) + "\n"
