"""The scenes of these tests: one complete machine, and small changes of it that share compiled models.

Its tips have the area of (19) at every interface (M19), as when the hard cases were found: with a discharge port as
narrow as its, the last of the volume leaves through them.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from screwsim.cycle.close import close
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import ClosingTask, Problem, problem_of
from screwsim.cycle.solution import CycleSolution
from screwsim.inputs.faults import SceneError
from screwsim.model.run import Machinery
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.load import _finish
from screwsim.scene.yaml_tree import LocatedFaults, Node, Position
from screwsim.simulate import simulate

BASE: dict[str, Any] = {
    "machine": {
        "male_lobes": 4,
        "female_lobes": 6,
        "rotor_diameter": "160 mm",
        "rotor_length": "176 mm",
        "volume": {"law": "paper", "max": "600 cm^3", "phi_A": "60 deg"},
        "suction_port": {"law": "paper", "area": "40 cm^2", "phi_B": "60 deg"},
        "discharge_port": {"law": "paper", "area": "12 cm^2", "opens": "600 deg", "phi_C": "640 deg"},
    },
    "gas": {"fluid": "R134a", "model": "ideal"},
    "oil": {
        "density": "1000 kg/m^3",
        "heat_capacity": "2 kJ/(kg K)",
        "viscosity": "20 mPa s",
        "transport": "paper",
    },
    "operation": {
        "speed": "3000 rpm",
        "suction": {"pressure": "1.5 bar", "temperature": "283 K"},
        "discharge": {"pressure": "12 bar"},
    },
    "oil_supply": {"kind": "pump", "ratio": 3, "temperature": "293 K"},
    "effects": {
        "suction_port": {},
        "discharge_port": {},
        "tip_leakage": {"gap": "50 um", "reading": "interface"},
        "interlobe_leakage": {"gap": "40 um", "length": "150 mm"},
        "blow_hole": {"area": "6 mm^2"},
        "end_face_leakage": {"gap": "50 um", "length": "80 mm"},
        "oil_heat": {"droplet_radius": "100 um", "heat_transfer_coefficient": "500 W/(m^2 K)"},
        "oil_pump": {"efficiency": 0.6},
        "hydromechanical": {},
        "mechanical": {"fraction": 0.05},
    },
}
ECONOMIZER = {
    "oil.transport": "carried",
    "effects.economizer": {"temperature": "278 K", "opens": "380 deg", "closes": "480 deg", "area": "1 cm^2"},
}
OIL_PORT = {
    "oil.transport": "carried",
    "oil_supply": {"kind": "displacement", "temperature": "293 K", "orifice_diameter": "6 mm"},
    "effects.oil_injection": {"opens": "365 deg", "closes": "455 deg"},
}
PUMPED_PORT: dict[str, Any] = {
    "oil.transport": "carried",
    "effects.oil_injection": {"opens": "365 deg", "closes": "455 deg"},
}
SOLUBLE: dict[str, Any] = {
    **PUMPED_PORT,
    "oil_supply.ratio": 1,
    "oil_supply.temperature": "325 K",
    "effects.refrigerant_solubility": {"separator_temperature": "345 K"},
}
SOLUBLE_RATE: dict[str, Any] = {
    **SOLUBLE,
    "effects.refrigerant_solubility": {
        "separator_temperature": "345 K",
        "flash_time": "5 ms",
        "absorption_time": "50 ms",
    },
}
OIL_VOLUME: dict[str, Any] = {"oil.transport": "carried", "effects.oil_volume": {}}
FRICTION = {"model": "nozzle_friction", "passage": "2 mm", "flow_coefficient": 1}
HELD_GAPS: dict[str, Any] = {  # one gap of each flow model
    "oil.transport": "carried",
    "effects.tip_leakage": {
        "gap": "50 um",
        "reading": "interface",
        "model": "oil_sealed",
        "mixture_viscosity": "cicchitti",
        "passage": "2 mm",
    },
    "effects.interlobe_leakage": {"gap": "40 um", "length": "150 mm", "friction_fit": "flank", **FRICTION},
    "effects.end_face_leakage": {"gap": "50 um", "length": "80 mm", "friction_fit": "radial", **FRICTION},
}
FILM: dict[str, Any] = {"model": "oil_film", "passage": "2 mm", "filled_from": 0.2}
FILMS: dict[str, Any] = {  # all gaps full of oil where the upstream chamber has it
    "oil.transport": "carried",
    "effects.tip_leakage": {"gap": "50 um", "reading": "interface", **FILM},
    "effects.interlobe_leakage": {"gap": "40 um", "length": "150 mm", **FILM},
    "effects.end_face_leakage": {"gap": "50 um", "length": "80 mm", **FILM},
}
SPEEDS = (5000, 3000, 1000, 500, 250)
RATED: dict[str, Any] = {  # saturation temperatures in place of pressures
    "operation": {
        "speed": "3000 rpm",
        "evaporating_temperature": "2 degC",
        "condensing_temperature": "45 degC",
        "superheat": "10 K",
    },
    "oil_supply.temperature": "330 K",
}
RADAU = {"integrator": "scipy-radau", "error": "none"}  # as numerics: what others are held against
DROP = object()  # as a value: the field is left out
CARRIED = {"oil.transport": "carried"}
OIL_PORT["effects.oil_pump"] = DROP
TOGETHER = {**ECONOMIZER, **OIL_PORT, **OIL_VOLUME}
PLENUMS = {"suction_volume": "8 l", "discharge_volume": "3 l", "suction_area": "40 cm^2", "discharge_area": "15 cm^2"}
OF_ALL_STREAMS = {  # scenes that have every kind of stream between them
    "paper": {"oil.transport": "paper"},
    "carried": {"oil.transport": "carried"},
    "ports and room": TOGETHER,
    "gaps held back": HELD_GAPS,
    "oil films": FILMS,
    "oil films that take room": {**FILMS, **OIL_VOLUME},
    "oil films, lines that pulsate": {**SOLUBLE_RATE, **FILMS, "effects.plenums": PLENUMS},
    "oil that flashes": SOLUBLE,
    "oil that flashes over time": SOLUBLE_RATE,
}


SEEN = ("gas_mass_flow", "indicated_power", "shaft_power", "discharge_temperature", "trapped_mass", "peak_pressure")
GAS_FIGURES = (
    "gas_mass_flow",
    "work_per_cycle",
    "trapped_mass",
    "peak_pressure",
    "discharge_temperature",
    "volumetric_efficiency",
)


def change(one: Result, other: Result, names: Sequence[str] = SEEN) -> float:
    """Return the largest relative change of figures."""
    return max(abs(one.performance[name] / other.performance[name] - 1.0) for name in names)


def scene_dict(changes: dict[str, Any] | None = None) -> dict[str, Any]:
    """Return the base scene with changes by dotted path; the value DROP removes a field."""
    scene = copy.deepcopy(BASE)
    for path, value in (changes or {}).items():
        *parents, last = path.split(".")
        place = scene
        for name in parents:
            place = place.setdefault(name, {})
        if value is DROP:
            place.pop(last, None)
        else:
            place[last] = copy.deepcopy(value)  # later changes go below it
    return scene


def two_stages(folder, **content):
    """Write two stages into a folder, low.yaml and the slower high.yaml; return the path of their file."""
    (folder / "low.yaml").write_text(json.dumps(scene_dict({})))
    (folder / "high.yaml").write_text(json.dumps(scene_dict({"operation.speed": "1300 rpm"})))
    path = folder / "plant.stages.yaml"
    path.write_text(json.dumps({"stages": ["low.yaml", "high.yaml"], **content}))
    return path


def make(changes: dict[str, Any] | None = None) -> Scene:
    """Return the scene of `scene_dict`."""
    return _read(json.dumps(scene_dict(changes)))


def balanced(result: Result, *more: str) -> Result:
    """Return a result that must be ok, with mass, energy, entropy and `more` of its balances within their bound."""
    assert result.status == "ok", result.message
    found = {name: abs(result.balance[name]) for name in ("mass", "energy", "entropy", *more)}
    assert max(found.values()) <= result.balance.bound, (found, result.balance.bound)
    return result


def refusal(changes: dict[str, Any]) -> str:
    """Return why a scene with changes is refused."""
    with pytest.raises(SceneError) as caught:
        make(changes)
    return str(caught.value)


def closed(scene: Scene) -> tuple[Problem, Machinery, CycleSolution]:
    """Return a scene's problem, its machinery, and the cycle on which it stands, closed once."""
    problem = problem_of(scene)
    machinery = lease_for(problem)
    return problem, machinery, close(ClosingTask(problem, machinery, problem.criteria))


def run(changes: dict[str, Any] | None = None) -> Result:
    """Simulate, once for each set of changes: results are never written to."""
    return _run(json.dumps(scene_dict(changes)))


@cache
def _run(text: str) -> Result:
    return simulate(_read(text))


@cache  # scenes are never written to
def _read(text: str) -> Scene:
    """Return the scene of a JSON text, which is YAML, too: `loads` takes three times as long for it, most in ruamel."""
    start = Position(0, "<text>", folder=str(Path.cwd()))
    return _finish(_node(json.loads(text), start), start, (), (), LocatedFaults())


def _node(value: Any, place: Position) -> Node:
    """Return the tree of a text, all of it in one place."""
    if isinstance(value, dict):
        return Node({name: _node(inner, place) for name, inner in value.items()}, place, place)
    return Node([_node(inner, place) for inner in value] if isinstance(value, list) else value, place, place)
