"""How large an economizer's port should be: the table of docs/how-to/new-machine.md.

    python docs/tools/economizer_port.py

Machines as `screwsim new refrigeration --economizer` writes them, and with ports of other sizes: what share of the
vapour the chambers push back, and by how much the COP rises above that without an economizer.
"""

from __future__ import annotations

import math

from screwsim.fluid import constants
from screwsim.outputs import Result
from screwsim.scene import Scene, loads
from screwsim.simulate import simulate
from screwsim.template import new_scene, request_of

CASES = (
    ("R134a", "0/40 degC"),
    ("R1234ze(E)", "0/45 degC"),
    ("R290", "-5/40 degC"),
    ("R404A", "-30/40 degC"),
    ("R717", "-10/35 degC"),
    ("R717", "-35/35 degC"),
)
SIZES = (0.6, 1.0, 1.6, 2.5)  # of the area over the template's


def machine(fluid: str, condition: str, economizer: bool) -> Scene:
    """Return a machine as it is written."""
    return loads(new_scene("refrigeration", request_of(fluid=fluid, condition=condition, economizer=economizer)))


def row(scene: Scene, without: float) -> str:
    """Return what a machine does with ports of the sizes, as a row; `without` is its COP without economizer."""
    fluid, condition = scene.gas.fluid, scene.title.split(", ")[2]
    port = scene.effects["economizer"].parameters.area
    results = [
        simulate(loads(scene.text, overrides=[f"effects.economizer.area={size * port!r} m^2"])) for size in SIZES
    ]
    found = results[SIZES.index(1.0)].performance
    T, R = found.economizer_temperature, constants.gas_constant(fluid)
    k = constants.isentropic_exponent(fluid, T)
    mach = found.economizer_mass_flow / (port * found.economizer_pressure * math.sqrt(k / (R * T)))
    cells = [fluid, condition, f"{1e6 * port:.0f}", f"{mach:.2f}", f"{T - 273.15:.1f}"]
    return f"| {' | '.join([*cells, *(compared(result, without) for result in results)])} |"


def compared(result: Result, without: float) -> str:
    """Return the share of the vapour that is pushed back and the gain in COP [%]."""
    net, moved = result.performance.economizer_mass_flow, result.ledger["gas_moved_economizer"]
    back = 100.0 * (moved - net) / (moved + net)
    told = f"{abs(back):.1f}, {100.0 * (result.performance.electrical_cop / without - 1.0):.1f}"
    return told if result.status == "ok" else f"{told} ({result.status})"


if __name__ == "__main__":
    sizes = " | ".join(f"{size:g} × area" for size in SIZES)
    print(f"| fluid | condition | area mm² | Mach | economizer °C | {sizes} |")
    print(f"|---|---|---|---|---|{'---|' * len(SIZES)}")
    for fluid, condition in CASES:
        without = simulate(machine(fluid, condition, False), trace=False).performance.electrical_cop
        print(row(machine(fluid, condition, True), without), flush=True)
