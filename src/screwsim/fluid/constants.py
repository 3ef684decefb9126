"""Constants of a fluid from CoolProp, kept in the user's cache folder: importing CoolProp costs seconds.

The cache is keyed by CoolProp's version, so that a new version is asked again.
"""

from __future__ import annotations

import importlib.metadata
import json
from functools import cache
from pathlib import Path
from typing import Any

from screwsim.faults import UsageError
from screwsim.numerics.store import cache_folder, write_atomically


def _file() -> Path:
    return cache_folder() / f"coolprop-{importlib.metadata.version('CoolProp')}.json"


@cache
def _known() -> dict[str, float]:
    try:
        return json.loads(_file().read_text())
    except (OSError, ValueError):
        return {}


def _ask(key: str, question: Any) -> float:
    known = _known()
    if key not in known:
        known[key] = float(question())
        write_atomically(_file(), json.dumps(known, indent=0, sort_keys=True).encode())
    return known[key]


@cache
def _abstract_state(fluid: str) -> Any:
    import CoolProp.CoolProp as coolprop

    try:
        return coolprop.AbstractState("HEOS", fluid), coolprop
    except ValueError as error:
        reason = str(error).splitlines()[0][:120]
        raise UsageError(
            f"gas.fluid: CoolProp has no pure fluid {fluid!r} ({reason}); name one such as R134a"
        ) from None


def gas_constant(fluid: str) -> float:
    """Return the specific gas constant R [J/(kg K)]."""

    def question() -> float:
        state, _ = _abstract_state(fluid)
        return state.gas_constant() / state.molar_mass()

    return _ask(f"{fluid} R", question)


def ideal_heat_capacity(fluid: str, T: float) -> float:
    """Return cp0 [J/(kg K)], the ideal-gas heat capacity at temperature T [K]."""

    def question() -> float:
        state, coolprop = _abstract_state(fluid)
        state.specify_phase(coolprop.iphase_gas)
        state.update(coolprop.DmassT_INPUTS, 1e-6, T)
        value = state.cp0mass()
        state.unspecify_phase()
        return value

    return _ask(f"{fluid} cp0 {T!r}", question)


def saturation_temperature(fluid: str, p: float) -> float:
    """Return the saturation temperature [K] of vapour at pressure p [Pa]."""

    def question() -> float:
        state, coolprop = _abstract_state(fluid)
        try:
            state.update(coolprop.PQ_INPUTS, p, 1.0)
        except ValueError:
            critical = state.p_critical()
            raise UsageError(
                f"operation.suction.superheat: {fluid} has no saturation at {p:.6g} Pa (critical {critical:.6g} Pa); "
                "give operation.suction.temperature"
            ) from None
        return state.T()

    return _ask(f"{fluid} Tsat {p!r}", question)


def isentropic_exponent(fluid: str, T: float) -> float:
    """Return k = cp0/(cp0 − R) at temperature T [K] (docs/model.md M6)."""
    c_p, R = ideal_heat_capacity(fluid, T), gas_constant(fluid)
    return c_p / (c_p - R)
