"""What the machines that `screwsim new` writes do: their efficiencies over kinds, sizes, fluids and volume ratios.

    python docs/tools/templates.py      the table of docs/how-to/new-machine.md

Beside each refrigeration machine stands the mean volumetric efficiency of validation/bitzer at its pressure ratio,
beside each air package what 10 CFR 431.345 asks for, beside reciprocating compressors on R404A the isentropic
efficiencies of the electrical power by the ratings of semi-hermetic ones (validation/energyplus).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from screwsim.effects.parts.rating import STANDARDS
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate
from screwsim.study.validation import sibling
from screwsim.template import new_scene, request_of

_ratings = sibling(Path(__file__).resolve().parents[2] / "validation" / "templates" / "ratings.py")
RATED, ratings = _ratings.POINTS, _ratings.ratings
CASES: tuple[tuple[str, Mapping[str, object]], ...] = (
    *(("refrigeration", {"displacement": f"{flow} m^3/h"}) for flow in (100, 250, 600, 1500, 3000)),
    *(("refrigeration", {"vi": vi}) for vi in (2.2, 3.5, 4.5)),
    *(("refrigeration", {"condition": each}) for each in ("-20/40 degC", "10/40 degC")),
    *(("refrigeration", {"fluid": fluid}) for fluid in ("R1234ze(E)", "Propane")),
    ("refrigeration", {"fluid": "Ammonia", "condition": "-10/35 degC"}),
    ("heat_pump", {}),
    *(("air", {"displacement": f"{flow} m^3/h"}) for flow in (200, 600, 1200, 3000)),
    ("air", {"condition": "0 bar(g)/10 bar(g)"}),
    ("booster", {}),
    ("booster", {"condition": "10/25 bar", "displacement": "200 m^3/h"}),
    *(("expander", {"displacement": f"{flow} m^3/h"}) for flow in (100, 375, 1200)),
    ("expander", {"displacement": "375 m^3/h", "oil": "POE_68"}),
    *(("reciprocating", {"displacement": f"{flow} m^3/h"}) for flow in (10, 60)),
    *(("reciprocating", {"fluid": "R404A", "condition": f"{each} degC, {superheat} K"}) for each, superheat in RATED),
)


def row(kind: str, stated: Mapping[str, object]) -> str:
    """Return what one machine does, as a row."""
    asked = request_of(**stated)  # type: ignore[arg-type]
    scene = loads(new_scene(kind, asked))
    result = simulate(scene, trace=False)
    found = result.performance
    options = ", ".join(f"{name} {value}" for name, value in stated.items()) or "as it is"
    diameter = getattr(scene.machine, "rotor_diameter", None)
    size = f"{1e3 * (diameter or scene.machine.bore):.0f}"
    filled = found.get("volumetric_efficiency") if diameter is None or scene.machine.mode == "compressor" else None
    shown = [f"{100.0 * value:.1f}" if value is not None else "–" for value in (filled, found.isentropic_efficiency)]
    ratio = getattr(scene.machine, "built_in_volume_ratio", None)
    cells = [kind, options, size, f"{found.pressure_ratio:.2f}", "–" if ratio is None else f"{ratio:g}", *shown]
    source = rated(scene, found) if stated.get("fluid") == "R404A" else beside(kind, found)
    cells += [f"{1e-3 * abs(found.shaft_power):.1f}", source, result.status]
    return f"| {' | '.join(cells)} |"


def beside(kind: str, found: Mapping[str, float]) -> str:
    """Return what a source says of such a machine."""
    if kind in ("refrigeration", "heat_pump"):
        return f"λ {100.0 * (0.995712787 - 0.021768086 * found['pressure_ratio']):.1f}"
    if kind == "air":
        asked = STANDARDS["fixed", "air"].least(found["free_air_delivered"])
        return f"package {100.0 * found['package_isentropic_efficiency']:.1f}, asked {100.0 * asked:.1f}"
    return ""


def rated(scene: Scene, found: Mapping[str, float]) -> str:
    """Return what the ratings say beside the electrical efficiency of a reciprocating compressor on R404A."""
    operation = scene.operation
    assert operation.evaporating_temperature is not None and operation.condensing_temperature is not None
    every = ratings(operation.evaporating_temperature, operation.condensing_temperature)
    own = 100.0 * found["electrical_isentropic_efficiency"]
    return f"electrical {own:.1f}, rated {100.0 * min(every):.1f} to {100.0 * max(every):.1f}"


if __name__ == "__main__":
    print("| kind | options | D mm | π | Vi | λ % | η_s % | shaft kW | sources | status |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for kind, stated in CASES:
        print(row(kind, stated), flush=True)
