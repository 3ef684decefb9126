"""A closed chamber with every blend: the change of its entropy over a turn. Run: closed_blends.py [NAME ...].

The chamber of `tests/laws/test_blends.py` with all openings shut, dry (`two_phase: refuse`) and wet (`equilibrium`),
from vapour into the dome and back. Writes `tests/laws/closed_blends.json`, one row per blend and kind, as they come: an
interrupted run continues where it was; named blends are done again. Entropy is given over R.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "tests" / "laws" / "closed_blends.json"
sys.path[:0] = [str(ROOT / "tests" / name) for name in ("tools", "laws")]
from scenes import make  # noqa: E402

from screwsim.build import build_gas  # noqa: E402
from screwsim.cycle.guess import install_first_guess, lease_for  # noqa: E402
from screwsim.cycle.problem import problem_of  # noqa: E402
from screwsim.fluid import constants  # noqa: E402
from screwsim.fluid.blend_border import blend_border  # noqa: E402
from screwsim.fluid.composition import composition, predefined  # noqa: E402
from screwsim.fluid.saturation import saturation  # noqa: E402
from screwsim.inputs.faults import SceneError, UsageError  # noqa: E402
from screwsim.numerics.store import write_atomically  # noqa: E402
from screwsim.simulate import simulate  # noqa: E402

# dead volume of half the swept one: the chamber expands by three only, and stays within the equation's temperatures
SHUT = {"effects": {}, "machine.volume.min": "300 cm^3", "numerics": {"accuracy": 1e-4, "rtol": 1e-10}}
KINDS = {"dry": ("refuse", 0.75, (10.0, 30.0, 60.0, 100.0)), "wet": ("equilibrium", 0.85, (1.0, 5.0, 15.0, 30.0))}
DENSER = 1.2  # than the dew point: a wet start for blends whose isentropes do not cross their dew line from outside
LEAST_SHARE = 0.02  # share of the turn that a wet chamber must spend on each side of its dew line, or in the dome


def changes(fluid: str, two_phase: str, p: float, state: dict[str, Any]) -> dict[str, Any]:
    """Return the changes of the base scene: a shut chamber at p [Pa], in a state by superheat or quality."""
    return {
        "gas": {"fluid": fluid, "model": "real", "two_phase": two_phase},
        "oil.transport": "carried",
        "operation.suction": {"pressure": f"{p:.8g} Pa", **state},
        "operation.discharge": {"pressure": f"{1.3 * p:.8g} Pa"},
        **SHUT,
    }


def turn(fluid: str, kind: str) -> dict[str, Any]:
    """Return the entropy change of the chamber over a turn, from the first initial state that works."""
    two_phase, reduced, superheats = KINDS[kind]
    lines, told = saturation(fluid), ""
    p = constants.dew_pressure(fluid, max(reduced * lines.T_c, 1.02 * lines.T_low))
    states = [{"superheat": f"{superheat:g} K"} for superheat in superheats]
    for state in states:
        asked = changes(fluid, two_phase, p, state)
        try:
            scene = make(asked)
        except SceneError as fault:
            return {"refused": str(fault)}
        result = simulate(scene)
        if result.status != "ok":
            told = result.message
            continue
        gas, cycle = build_gas(scene), result.cycle
        course = list(zip(cycle["gas_temperature"], cycle["gas_mass"] / cycle["volume"], strict=True))
        wet = float(np.mean([gas.phased_state[0](T, rho) for T, rho in course])) if kind == "wet" else 0.0
        if kind == "wet" and not LEAST_SHARE < wet < 1.0 - LEAST_SHARE:
            told = f"{wet:.2f} of the turn is wet"
            continue
        change = float(np.ptp([gas.specific_entropy(T, rho) for T, rho in course]) / gas.R)
        return {"from": state, "p": [float(f(cycle["pressure"])) for f in (min, max)], "wet": wet, "s": change}
    return wet_turn(fluid, p) if kind == "wet" else {"none": told}


def wet_turn(fluid: str, p: float) -> dict[str, Any]:
    """Return the same for a turn that begins wet."""
    border = blend_border(fluid)
    assert border is not None
    problem = problem_of(make(changes(fluid, "equilibrium", p, {"superheat": "1 K"})))
    machinery, gas = lease_for(problem), problem.parts.gas
    y = install_first_guess(problem, machinery)
    T = border.dew_temperature(p)
    y[:2] = T, DENSER / border.saturated_volumes(T)[1]
    status, *_ = machinery.turn(y, 1e-10)
    machinery.lives.swap()
    course = machinery.lives.states_at(np.radians(np.arange(0.0, 720.0, 5.0)))[:, :2]
    if status != 0:
        return {"none": f"the turn ended with {status}"}
    wet = float(np.mean([gas.phased_state[0](T, rho) for T, rho in course]))
    pressures = [gas.state(T, rho)[0] for T, rho in course]
    change = float(np.ptp([gas.specific_entropy(T, rho) for T, rho in course]) / gas.R)
    start = {"T": float(T), "denser": DENSER}
    return {"from": start, "p": [float(f(pressures)) for f in (min, max)], "wet": wet, "s": change}


def known() -> list[str]:
    """Return the blends that CoolProp has data for."""
    found = []
    for name in sorted(predefined()):
        try:
            composition(name)
            saturation(name)
        except UsageError:  # docs/reference/blends.md says why
            continue
        found.append(name)
    return found


def main() -> None:
    """Run the chambers that are not stored yet, or those of the blends named."""
    rows = json.loads(STORED.read_text(encoding="utf-8")) if STORED.exists() else {}
    for name in sys.argv[1:] or known():
        if name in rows and not sys.argv[1:]:
            continue
        rows[name] = {kind: turn(name, kind) for kind in KINDS}
        print(name, rows[name], flush=True)
        text = ",\n".join(f" {json.dumps(each)}: {json.dumps(rows[each])}" for each in sorted(rows))
        write_atomically(STORED, f"{{\n{text}\n}}\n".encode())


if __name__ == "__main__":
    main()
