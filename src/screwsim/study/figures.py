"""Figures as a person names them: in any case or by symbols (docs/reference/nomenclature.md); else those there are."""

from __future__ import annotations

from collections.abc import Iterable

from screwsim.build import build_parts
from screwsim.effects.base import PowerLoss, Reading
from screwsim.faults import UsageError
from screwsim.outputs import PERFORMANCE
from screwsim.performance import COOLING, PER_VOLUME
from screwsim.scene import Scene
from screwsim.scene.fields import unknown

# Small letters, without blanks, underscores and hyphens; what may mean two figures ('eta', 'power', 'w') is not here
_SHORT = {
    "λ": "volumetric_efficiency",
    "lambda": "volumetric_efficiency",
    "ηv": "volumetric_efficiency",
    "etav": "volumetric_efficiency",
    "etavol": "volumetric_efficiency",
    "ηs": "isentropic_efficiency",
    "etas": "isentropic_efficiency",
    "etais": "isentropic_efficiency",
    "ηis": "isentropic_efficiency",
    "ηiso": "isothermal_efficiency",
    "etaiso": "isothermal_efficiency",
    "ηt": "isothermal_efficiency",
    "etat": "isothermal_efficiency",
    "mdot": "gas_mass_flow",
    "ṁ": "gas_mass_flow",
    "massflow": "gas_mass_flow",
    "pshaft": "shaft_power",
    "pind": "indicated_power",
    "pel": "electrical_power",
    "td": "discharge_temperature",
    "q0": "cooling_capacity",
    "qdot0": "cooling_capacity",
    "q̇0": "cooling_capacity",
    "qv": "volumetric_cooling_capacity",
}
_ALWAYS = (
    "isothermal_efficiency",
    "ideal_isothermal_efficiency",
    "isentropic_efficiency",
    "volumetric_efficiency",
    "gas_mass_flow",
    "indicated_power",
    "shaft_power",
    "discharge_temperature",
    "peak_pressure",
    "work_per_cycle",
    "trapped_mass",
    "pressure_ratio",
    "shaft_torque",
    "displacement",
    "displacement_flow",
)
_OILED = ("oil_mass_flow", "oil_ratio", "oil_flow_ratio", "oil_lift_power", "oil_discharge_temperature")
_OTHERWISE = "a name of performance in `run --json`"


def figure_named(text: str, here: Iterable[str] = ()) -> str:
    """Return the figure that a text names; raise UsageError with the nearest, or with those there are `here`."""
    bare = "".join(letter for letter in text.lower() if letter not in " _-")
    same = [name for name in PERFORMANCE if name.replace("_", "") == bare]
    if same or bare in _SHORT:
        return same[0] if same else _SHORT[bare]
    there = ", ".join(here)
    raise UsageError(f"--figure {text}: {unknown(text, PERFORMANCE, f'one of {there}' if there else _OTHERWISE)}")


def figure_of(scene: Scene, text: str) -> str:
    """Return the figure of a scene that a text names; raise UsageError where there is none, with those that it has."""
    here = figures_of(scene)
    name = figure_named(text, here)
    if name in COOLING and name not in here:
        what = "is known only of a compressor in a scene that states evaporating and condensing temperature"
        raise UsageError(f"--figure {text}: {what} (use one of {', '.join(here)})")
    return name


def figures_of(scene: Scene) -> tuple[str, ...]:
    """Return the figures that a scene is sure to call for: those of every machine, its lines, its oil, its losses."""
    parts = build_parts(scene)
    found = [*_ALWAYS, *PER_VOLUME]
    if scene.operation.evaporating_temperature is not None and scene.machine.mode == "compressor":
        found += COOLING
    found += _OILED if scene.oil is not None else ()
    found += [part.figure for _, part in parts.all(PowerLoss)]
    found += [name for _, part in parts.all(Reading) for name in part.figures]
    return tuple(dict.fromkeys(found))
