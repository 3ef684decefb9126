"""Ask `screwsim new` for random machines, and simulate what it writes.

Run: fuzz_new.py [--seed 1] [--count 100] [--freezers | --odd]. A request that is possible should give a scene that
runs without a warning, and one that is not a refusal in one line. Fluids are those used in such machines, sometimes
any of CoolProp's, conditions between their triple and critical points. `--freezers` asks for the usual refrigerants
from -40 to 0 °C, in two sizes each, instead; `--odd` for what hardly anyone builds: tips of 3 to 150 m/s, rotors of
50 to 550 mm, built-in ratios of 1.1 to 6, pressure ratios of 1.01 to 30, ends near the triple and critical point.
Figures of pure gases are compared with CoolProp: mass and energy of the machine with its separator, efficiencies, the
second law. Prints a line for each scene that does not run, or runs with warnings, and for each refusal; then their
numbers. With `--errors` each scene is solved much tighter, too, and an account of the true errors of all follows.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import CoolProp.CoolProp as coolprop
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from true_error import Kept, account, kept

from screwsim.inputs.faults import UsageError
from screwsim.outputs import Result
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate
from screwsim.study.sizing import sized_machine, stated_machine
from screwsim.template import new_scene, request_of

HALOGENATED = ("R134a", "R1234yf", "R22", "R404A", "R507A", "R407C", "R448A", "R449A", "R454B", "R513A")
NATURAL = ("Ammonia", "R290", "R600a")
WARM = ("R1234ze(E)", "R245fa", "R1233zd(E)", "R1336mzz(Z)", "R600", "n-Pentane", "Cyclopentane", "Ammonia")
USED = {
    "refrigeration": HALOGENATED + NATURAL,
    "heat_pump": WARM,
    "booster": ("Methane", "Nitrogen", "CO2", "Hydrogen", "Helium", "R290", "Air", "Argon", "Water"),
    "expander": ("R134a", "R245fa", "R1233zd(E)", "Water", "Isopentane", "Ammonia"),
    "reciprocating": ("R134a", "CO2", "R404A", "R1234yf", "R1233zd(E)", *NATURAL[1:]),
}
FREEZERS = (
    "R404A",
    "R507A",
    "R407C",
    "R407F",
    "R448A",
    "R449A",
    "R454B",
    "R454C",
    "R22",
    "R134a",
    *NATURAL[:2],
    "R1270",
)
COLD = "-40/35", "-35/40", "-30/45", "-10/50", "0/60"
TIPS, ROTORS = (3.0, 150.0), (0.05, 0.55)  # [m/s], [m] of odd machines
RATIOS, BUILT_IN = (1.01, 1.1, 1.5, 2.0, 4.0, 8.0, 15.0, 30.0), (1.1, 1.3, 1.8, 2.5, 4.0, 6.0)
AWAY = 0.02, 0.1, 0.3, 0.6, 0.85, 0.97  # of the way from triple to critical point
SAME = 2e-3  # relative difference of a figure from CoolProp's that is told: several times the wanted accuracy
ANY_FLUID = 0.3  # share of requests for any fluid
ZERO = 273.15

Request = tuple[str, dict[str, Any]]


def freezers() -> Iterator[Request]:
    """Yield requests for the usual refrigerants at low temperatures."""
    for fluid in FREEZERS:
        for ends in COLD:
            for size in ("100 m^3/h", "600 m^3/h"):
                yield "refrigeration", {"fluid": fluid, "condition": f"{ends} degC", "displacement": size}


def drawn(random: np.random.Generator) -> Request:
    """Return a random request: kind and options."""
    kind = str(random.choice(["air", *USED]))
    stated: dict[str, Any] = {}
    if kind == "air":
        stated["condition"] = f"0 bar(g)/{random.choice([3, 5, 7.5, 10, 13])} bar(g)"
    else:
        every = coolprop.get_global_param_string("FluidsList").split(",")
        fluid = stated["fluid"] = str(random.choice(every if random.random() < ANY_FLUID else USED[kind]))
        if kind in ("booster", "expander"):
            low = 10.0 ** random.uniform(-0.6, 1.0)
            high = low * random.uniform(1.5, 6.0)
            stated["condition"] = f"{high:.3g}/{low:.3g} bar" if kind == "expander" else f"{low:.3g}/{high:.3g} bar"
        else:
            stated["condition"] = _temperatures(fluid, random)
    size = random.random()
    if size < 0.5:
        stated["displacement"] = f"{10.0 ** random.uniform(1.7, 3.4):.3g} m^3/h"
        stated["displacement"] = "15 m^3/h" if kind == "reciprocating" else stated["displacement"]
    elif size < 0.7 and kind in ("refrigeration", "heat_pump"):
        stated["capacity"] = f"{10.0 ** random.uniform(1.5, 3.0):.3g} kW"
    if kind in ("refrigeration", "heat_pump"):
        stated["economizer"], stated["slide"] = (bool(each < 0.25) for each in random.random(2))
    return kind, stated


def _temperatures(fluid: str, random: np.random.Generator) -> str:
    try:
        triple, critical = (coolprop.PropsSI(name, fluid) for name in ("Ttriple", "Tcrit"))
    except ValueError:  # a blend
        triple, critical = 200.0, 350.0
    low = max(triple + (critical - triple) * random.uniform(0.15, 0.8), random.uniform(230.0, 300.0))
    ends = f"{low - ZERO:.0f}/{low - ZERO + random.uniform(20.0, 60.0):.0f} degC"
    return f"{ends}, {random.choice([0, 3, 10, 25])} K" if random.random() < 0.3 else ends


def odd(random: np.random.Generator) -> Request:
    """Return a random request for a machine that hardly anyone builds."""
    kind, stated = drawn(random)
    stated = {name: stated[name] for name in ("fluid", "economizer", "slide") if stated.get(name)}
    ratio = float(random.choice(RATIOS))
    low = 10.0 ** random.uniform(-1.7, 1.5)
    if kind == "air":
        stated["condition"] = f"{max(low, 0.3):.4g}/{max(low, 0.3) * ratio:.4g} bar"
    elif kind in ("booster", "expander"):
        ends = (low * ratio, low) if kind == "expander" else (low, low * ratio)
        stated["condition"] = "{:.5g}/{:.5g} bar".format(*ends)
    else:
        try:
            triple, critical = (coolprop.PropsSI(name, stated["fluid"]) for name in ("Ttriple", "Tcrit"))
        except ValueError:  # a blend
            triple, critical = 200.0, 350.0
        T = triple + (critical - triple) * float(random.choice(AWAY)) - ZERO
        stated["condition"] = f"{T:.1f}/{min(T + random.choice([1, 5, 20, 60]), critical - ZERO - 1.0):.1f} degC"
    if kind == "reciprocating":
        return kind, {**stated, "speed": f"{10.0 ** random.uniform(2.0, 3.6):.0f} rpm"}
    diameter, tip = (np.exp(random.uniform(*np.log(ends))) for ends in (ROTORS, TIPS))
    stated |= {"diameter": f"{1e3 * diameter:.0f} mm", "speed": f"{60.0 * tip / (np.pi * diameter):.0f} rpm"}
    return kind, stated | ({"vi": float(random.choice(BUILT_IN))} if random.random() < 0.4 else {})


def contradicted(scene: Scene, result: Result) -> Iterator[str]:
    """Yield what contradicts CoolProp's properties of a pure, real gas."""
    p, fluid = result.performance, scene.gas.fluid
    if scene.gas.model != "real" or not isinstance(fluid, str) or "economizer" in scene.effects:
        return
    try:
        state = coolprop.AbstractState("HEOS", fluid)
        state.update(coolprop.PT_INPUTS, p.suction_pressure, p.suction_temperature)
        h, s, density = state.hmass(), state.smass(), state.rhomass()
        state.update(coolprop.PSmass_INPUTS, p.discharge_pressure, s)
        lossless, flow, power = p.gas_mass_flow * (state.hmass() - h), p.gas_mass_flow, p.shaft_power
        pairs = [("volumetric_efficiency", flow / (density * p.displacement_flow))]
        pairs += [("isentropic_efficiency", power / lossless if power < 0.0 else lossless / power)]
        for name, own in pairs:
            if p.get(name) is not None and abs(own - p[name]) > SAME * abs(own):
                yield f"{name} {p[name]:.6g}, by CoolProp {own:.6g}"
        T = p.get("separator_temperature")
        if T is None or flow <= 0.0:
            return
        state.update(coolprop.PT_INPUTS, p.discharge_pressure, T)
        heated = getattr(scene.effects["motor"].parameters, "cooling", None) == "suction_gas"
        supplied, cooled = power + (p.motor_loss if heated else 0.0), p.oil_cooler_duty
        if abs(supplied - flow * (state.hmass() - h) - cooled) > SAME * supplied:
            yield f"energy: {supplied:.6g} W in, {flow * (state.hmass() - h) + cooled:.6g} W out"
        if flow * (state.smass() - s) + cooled / min(p.oil_supply_temperature, T) < -SAME * supplied / T:
            yield "entropy falls"
    except ValueError:  # CoolProp has no such state of one phase
        return


def written(kind: str, stated: dict[str, Any]) -> str:
    """Return the scene that a request gives; raise UsageError where it is refused."""
    asked = request_of(**stated)
    if "capacity" in stated:
        return sized_machine(kind, asked).text
    return stated_machine(kind, asked).text if stated.get("economizer") else new_scene(kind, asked)


def judged(kind: str, stated: dict[str, Any]) -> tuple[str, str]:
    """Return what became of a request, with the reason: ok, warned, refused, or the status of a failed run."""
    try:
        text = written(kind, stated)
    except UsageError as refusal:
        return "refused", str(refusal)
    scene = loads(text)
    result = simulate(scene, trace=False)
    if result.status != "ok":
        return result.status, result.message
    wrong = "; ".join(contradicted(scene, result))
    if wrong:
        return "contradicted", wrong
    return ("warned", "; ".join(result.warnings)) if result.warnings else ("ok", "")


def main() -> None:
    """Print what became of each request that did not simply run, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    asked = parser.add_mutually_exclusive_group()
    asked.add_argument("--freezers", action="store_true")
    asked.add_argument("--odd", action="store_true")
    parser.add_argument("--errors", action="store_true")
    given = parser.parse_args()
    random = np.random.default_rng(given.seed)
    requests = freezers() if given.freezers else ((odd if given.odd else drawn)(random) for _ in range(given.count))
    sums: Counter[str] = Counter()
    errors: list[Kept] = []
    for number, (kind, stated) in enumerate(requests):
        found, why = judged(kind, stated)
        sums[found] += 1
        if found != "ok":
            print(f"{number} {kind} {stated}: {found}: {why}", flush=True)
        if given.errors and found in ("ok", "warned"):
            errors.append(kept(loads(written(kind, stated)), {}))
    if given.errors:
        print(account(errors))
    print(", ".join(f"{count} {what}" for what, count in sums.most_common()))


if __name__ == "__main__":
    main()
