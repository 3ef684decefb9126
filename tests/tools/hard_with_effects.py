"""Solve the hard cases with each effect alone added, and store what became of them (docs/reference/effects.md).

Run: hard_with_effects.py [EFFECT …] solves them with the effects named (default: those not stored yet) and stores the
outcome in tests/hard/with_effects.json; hard_with_effects.py --table prints the table of what is stored.

The numbers of the effects are those of docs/tools/effects.py, docs/tools/each_effect.py and configs/everything.yaml. Of
the cases of tests/hard/hard_cases.py are taken those that deserve `ok`, keep the base's laws and ideal gas, so that all
share the structure of an effect, and may take at most a million evaluations; `effect` is added to the case's own
changes, and oil is carried along (a case for which that is said as well as `paper` is taken once). `EFFECT, real gas`
are the cases of a real gas whose lines are stated by pressures (each other fluid would be another structure), and those
of `ON_REAL` on R134a between lines of 2 and 45 °C. Each outcome is stored as it
comes: a run that was ended goes on where it was.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "tests" / "hard" / "with_effects.json"
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "hard", "laws")]
from hard_cases import CASES  # noqa: E402
from judging import Stopped, finite, limited  # noqa: E402
from records import by_records  # noqa: E402
from scenes import CARRIED, DROP, FILMS, HELD_GAPS, make  # noqa: E402

from screwsim.inputs.faults import SceneError  # noqa: E402
from screwsim.simulate import simulate, warm_up  # noqa: E402

DEAREST = 1_000_000  # evaluations that a case may take without the effects
LIMIT = 90  # processor seconds per case
REAL = ", real gas"
BY_DEW_POINTS = {"gas.two_phase", "operation.evaporating_temperature"}
ON_REAL = (  # cases of an ideal gas that R134a's equation of state covers, too
    "paper, 50 rpm",
    "paper, d = 0.01",
    "paper, d = 10",
    "ports times 100",
    "gaps 1 mm",
    "dead volume 1e-09",
    "dead volume 0.1",
    "phi_B = 0.1 deg",
)
LINES_OF_REAL = {
    "gas.model": "real",
    "oil_supply.temperature": "328 K",
    "operation": {
        "speed": "3000 rpm",
        "evaporating_temperature": "2 degC",
        "condensing_temperature": "45 degC",
        "superheat": "10 K",
    },
}
PORT = {"effects.oil_injection": {"opens": "365 deg", "closes": "455 deg"}}
WALLS = {
    "effects.wall_heat": {
        "rotor_area": "400 cm^2",
        "housing_area": "150 cm^2",
        "characteristic_length": "58 mm",
    }
}
LINES = {"discharge_volume": "3 l", "suction_volume": "8 l", "discharge_area": "15 cm^2", "suction_area": "40 cm^2"}
VALVES = {"discharge_valve": {"area": "12 cm^2", "pressure": "0.1 bar"}, "suction_valve": {"area": "40 cm^2"}}
EFFECTS: dict[str, dict[str, Any]] = {
    "none": {},
    "economizer": {
        "effects.economizer": {"temperature": "20 degC", "opens": "385 deg", "closes": "485 deg", "area": "1 cm^2"}
    },
    "oil_injection": PORT,
    "oil_volume": {"effects.oil_volume": {}},
    "gap models": HELD_GAPS,
    "gaps full of oil": FILMS,
    "refrigerant_solubility": {
        **PORT,
        "oil_supply.temperature": "325 K",
        "effects.refrigerant_solubility": {"separator_temperature": "70 degC"},
    },
    "refrigerant_solubility, rate": {
        **PORT,
        "oil_supply.temperature": "325 K",
        "effects.refrigerant_solubility": {
            "separator_temperature": "70 degC",
            "flash_time": "5 ms",
            "absorption_time": "50 ms",
        },
    },
    "wall_heat": WALLS,
    "thermal_clearances": {**WALLS, "effects.thermal_clearances": {"axis_distance": "125 mm"}},
    "plenums": {"effects.plenums": LINES},
    "plenums, discharge valve": {"effects.plenums": {**LINES, "discharge_valve": VALVES["discharge_valve"]}},
    "plenums, suction valve": {"effects.plenums": {**LINES, "suction_valve": VALVES["suction_valve"]}},
    "plenums, both valves": {"effects.plenums": {**LINES, **VALVES}},
    "droplets": {"effects.oil_heat": DROP, "effects.droplets": {"diameter": "60 um", "slip": 0.02}},
    "droplets, two phases": {
        "gas.two_phase": "equilibrium",
        "effects.oil_heat": DROP,
        "effects.droplets": {"diameter": "60 um", "slip": 0.02},
    },
    "slide_valve": {"effects.slide_valve": {"slot_area": "60 cm^2", "closes": "640 deg", "position": 0.5}},
    "bypass, share": {"effects.bypass": {"share": 0.3}},
    "bypass, chamber": {
        "effects.bypass": {"source": "chamber", "area": "5 cm^2", "opens": "400 deg", "passage": "90 deg"}
    },
    "suction_line, shaft_leakage": {"effects.suction_line": {}, "effects.shaft_leakage": {"area": "3 mm^2"}},
    "suction_throttle": {"effects.suction_throttle": {"pressure_ratio": 0.7}},
    "oil_drag": {
        "effects.oil_drag": {"tip_gap": "0.1 mm", "tip_land": "3 mm", "end_gap": "0.1 mm", "end_solidity": 0.6}
    },
    "bearings": {
        "effects.bearings": {
            "load": "gas",
            "radial_area": "60 cm^2",
            "axial_area": "30 cm^2",
            "friction_coefficient": 0.0018,
            "bore": "60 mm",
        }
    },
    "separator": {"effects.separator": {}},
    "separator, no cooler": {"effects.separator": {}, "oil_supply.temperature": DROP},
    "motor": {"effects.motor": {"rated_power": "1 MW", "efficiency": 0.921}},  # sized for the most demanding case
    "air_package": {
        "effects.motor": {"rated_power": "1 MW"},
        "effects.air_package": {
            "rated_flow": "3 m^3/min",
            "inlet_filter": {"pressure_loss": "30 mbar"},
            "separator_element": {"pressure_loss": "0.2 bar"},
            "minimum_pressure_valve": {"pressure_loss": "0.1 bar", "pressure": "5 bar"},
        },
    },
    "gas_torque": {"effects.gas_torque": {"male_share": 0.9}},
    "drive": {
        "effects.drive": {
            "motor_inertia": "0.8 kg m^2",
            "rotor_inertia": "0.12 kg m^2",
            "coupling": {"linear": {"spring": "20000 N m/rad", "largest_twist": "12 deg"}, "damping": "6 N m s/rad"},
            "motor": {"law": "line", "slope": "30 N m s/rad", "torque_limit": "700 N m"},
        }
    },
    "liquid_injection": {
        "gas.two_phase": "equilibrium",
        "effects.liquid_injection": {"opens": "500 deg", "closes": "600 deg", "area": "4 mm^2"},
    },
}
NEEDS_REAL = {"liquid_injection", "droplets, two phases"}
LIMITS = (  # parts of the messages of runs that end at a limit of the machine or of the gas's equation
    "hydraulic lock",
    "warm rotors touch",
    "the motor stalls",
    "above the equation's highest temperature",
    "below the equation's lowest temperature",
    "condenses",
    "both check valves of effects.plenums stay shut",
    "would swing by more than its mean",
    "no net gas is delivered to leave the separator",
    "the oil circuit leads to an impossible state",
)
KEEP = ("gas.", "numerics.closing", "machine.volume.law", "machine.male_lobes")
SECTIONS = {"effects", "oil", "gas", "machine.volume", "machine.suction_port", "machine.discharge_port"}


def chosen(name: str = "none") -> list[Any]:
    """Return the cases for an effect, one for each set of changes apart from the oil's transport."""
    if name.endswith(REAL):
        return [*_with_real_gas()]
    found: dict[str, Any] = {}
    for case in CASES:
        structural = any(path in SECTIONS or path.startswith(KEEP) for path in case.changes)
        if case.status == "ok" and not structural and case.guess is None and case.most <= DEAREST:
            text = json.dumps({**case.changes, **CARRIED}, sort_keys=True)
            found.setdefault(text, case)
    return list(found.values())


def _with_real_gas() -> Iterator[Any]:
    """Yield the cases of one real gas phase, and those of `ON_REAL` with it."""
    for case in CASES:
        real = case.changes.get("gas.model") == "real" and not BY_DEW_POINTS & case.changes.keys()
        if (
            real
            and case.status == "ok"
            and case.guess is None
            and case.most <= DEAREST
            and "effects" not in case.changes
        ):
            yield case
        elif case.name in ON_REAL:
            yield replace(
                case, name=f"real, {case.name.removeprefix('paper, ')}", changes={**LINES_OF_REAL, **case.changes}
            )


def rows() -> list[str]:
    """Return the names of all rows: effects with the ideal and with a real gas."""
    ideal = [name for name in EFFECTS if name not in NEEDS_REAL]
    return [*ideal, *(name + REAL for name in EFFECTS)]


def solved(case: Any, effect: dict[str, Any]) -> dict[str, Any]:
    """Return the outcome of a case with an effect: status and, if ok, largest balance over its bound, evaluations."""
    changes = {**CARRIED, **{path: value for path, value in effect.items() if path not in case.changes}}
    changes |= {path: value for path, value in case.changes.items() if path != "oil.transport"}
    if effect.get("effects.oil_heat") is DROP and any(path.startswith("effects.oil_heat") for path in case.changes):
        return {"status": "left out"}
    try:
        scene = make(changes)
    except SceneError as error:
        return {"status": "refused", "message": str(error).replace("\n", " ")[:300]}
    try:
        with limited(LIMIT):
            result = simulate(scene)
    except Stopped:
        return {"status": "stopped", "message": f"after {LIMIT} s"}
    found: dict[str, Any] = {"status": result.status, "message": result.message[:300]}
    if result.status == "ok" and not finite(result):
        return {"status": "not finite", "message": ""}
    if result.status == "ok":
        b = result.balance
        # with little oil relative to the trapped gas, which decides on the status (M39); without oil to nothing
        ratio = result.performance.get("oil_ratio") or 1.0
        oil = b.oil_mass * min(1.0, ratio) if result.performance.get("oil_mass_flow") else 0.0
        found["balance"] = float(f"{max(b.mass, b.energy, b.entropy, oil) / b.bound:.3g}")
        found["evaluations"] = result.numerics.rhs_evaluations
    return found


def solve(name: str, anew: bool) -> None:
    """Solve all cases with one effect, or those not stored yet, and store each outcome by the case's name."""
    started = time.process_time()
    known = {} if anew else stored().get(name, {})
    effect = EFFECTS[name.removesuffix(REAL)]
    warm_up(make({**CARRIED, **(LINES_OF_REAL if name.endswith(REAL) else {}), **effect}))
    for case in chosen(name):
        if case.name not in known:
            known[case.name] = solved(case, effect)
            STORED.write_text(by_records(stored() | {name: known}, 2) + "\n", encoding="utf-8")
    print(f"{name}: {time.process_time() - started:.0f} s of the processor", file=sys.stderr, flush=True)


def stored() -> dict[str, dict[str, Any]]:
    """Return the stored outcomes, by effect and case."""
    return json.loads(STORED.read_text(encoding="utf-8")) if STORED.exists() else {}


def at_a_limit(outcome: dict[str, Any]) -> bool:
    """Return whether a run failed at one of the `LIMITS`, and says so."""
    return outcome["status"] == "failed" and any(words in outcome["message"] for words in LIMITS)


def row(name: str, outcomes: dict[str, dict[str, Any]]) -> str:
    """Return an effect's row of the table."""
    counts = dict.fromkeys(("ok", "refused", "limit"), 0)
    others: list[str] = []
    for case, each in outcomes.items():
        status = "limit" if at_a_limit(each) else each["status"]
        if status in counts:
            counts[status] += 1
        elif each["status"] != "left out":
            others.append(f"{case}: {each['status']}")
    fine = {case: each for case, each in outcomes.items() if each["status"] == "ok"}
    balance = max(each["balance"] for each in fine.values())
    dearest = max(fine, key=lambda case: fine[case]["evaluations"])
    most = f"{fine[dearest]['evaluations']} ({dearest})"
    cells = [name, *map(str, counts.values()), "; ".join(others) or "–", f"{balance:.2f}", most]
    return f"| {' | '.join(cells)} |"


def table() -> str:
    """Return the table of the stored outcomes."""
    known = stored()
    head = (
        "effect",
        "ok",
        "refused",
        "at a limit",
        "none of these",
        "worst balance over its bound",
        "most evaluations",
    )
    lines = (f"| {' | '.join(head)} |", "|---" * len(head) + "|")
    return "\n".join([*lines, *(row(name, known[name]) for name in rows() if name in known)])


def main() -> None:
    """Solve and store, or print what is stored."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("effects", nargs="*", metavar="EFFECT", help=f"{', '.join(EFFECTS)}; each with '{REAL}', too")
    parser.add_argument("--table", action="store_true", help="print the table of what is stored")
    asked = parser.parse_args()
    unknown = sorted(set(asked.effects) - set(rows()))
    if unknown:
        parser.error(f"no effect {', '.join(unknown)}; known: {', '.join(rows())}")
    if not asked.table:
        for name in asked.effects or rows():
            solve(name, bool(asked.effects))
    print(table())


if __name__ == "__main__":
    main()
