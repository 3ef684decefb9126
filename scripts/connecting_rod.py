"""Compare the reference design of the flexible connecting rod with its source, and draw its figures.

Run: .venv/bin/python scripts/connecting_rod.py [FOLDER]   (default: results/rod). The last part is the same rod under
the cylinder pressure that our simulation gives for a compressor with it (configs/slider_crank/flexible_rod.yaml).

Sizes and load are the source's (validation/slider_crank/rod.csv); material and friction are not stated there and are
assumptions, marked in the output. Equations and findings: docs/reference/slider-crank.md.
"""

import math
import sys
from pathlib import Path

import numpy as np

from screwsim.machine.slider_crank import rod as rods
from screwsim.report.slider_crank import draw_rod
from screwsim.scene import load as load_scene
from screwsim.simulate import simulate
from screwsim.study.validation import read_table

ROOT = Path(__file__).resolve().parent.parent
SCENE = ROOT / "configs" / "slider_crank" / "flexible_rod.yaml"
ALPHA = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
MODULUS = 206e9  # [Pa], assumed: spring steel
LIMITS = (400e6, 500e6, 600e6, 700e6)  # [Pa], assumed: fatigue limits of spring steels
FACTORS = (1.0, 1.25, 1.5, 2.0)  # assumed: notch, surface and size at the clamp
FRICTION = (0.1, 0.2, 0.5, 1.0)  # assumed: dry bearing materials, and far beyond


def read_design() -> dict[str, float]:
    """Return the printed data of the reference design in SI units."""
    table = read_table(ROOT / "validation" / "slider_crank" / "rod.csv")
    return {row["name"]: float(row["value"]) for row in table}


def rod_of(design: dict[str, float], modulus: float = MODULUS) -> rods.FlexibleRod:
    """Return the rod of the design."""
    names = ("width", "thickness", "flexible", "length", "crank_radius")
    return rods.FlexibleRod(**{name: design[name] for name in names}, modulus=modulus)


def loads(load: rods.SchmidtLoad, rod: rods.FlexibleRod) -> rods.Bending:
    """Print the load and the stability, and return the bending over one revolution."""
    bending = rods.bend(rod, ALPHA, load.load(ALPHA))
    low, high = float(bending.load.min()), float(bending.load.max())
    print(
        f"load of the rod: {low:.1f} N (compression) to {high:.1f} N; as printed: {load.printed_force(ALPHA).max():.0f}"
    )
    print(f"gamma {rod.gamma(low):.3f} against {rods.critical_gamma(rod.beta):.3f} at beta {rod.beta:.4f} (1: ", end="")
    buckles = rods.buckling_load(rod)
    print(f"{rods.critical_gamma(1.0):.4f}); buckling at {buckles:.1f} N, {-buckles / low:.2f} times")
    print(f"largest moment at z_M = {1e3 * rods.largest_moment_place(rod, low):.2f} mm of {1e3 * rod.flexible:.0f} mm")
    faults = [fault.what for fault in rods.check_rod(rod, -low)]
    print("faults:", "; ".join(faults) or "none")
    return bending


def strength(bending: rods.Bending, rod: rods.FlexibleRod, printed: float) -> None:
    """Print stress, and the fatigue safety factor over assumed materials."""
    found = rods.safety(bending, rods.Fatigue(concentration=1.0))
    plain = rods.bend(rod, ALPHA, np.zeros_like(ALPHA))
    deflection = 1e3 * np.abs(bending.deflection).max()
    print(f"\nE = {1e-9 * rod.modulus:.0f} GPa (assumed). Deflection of the beam up to {deflection:.3f} mm")
    print(f"stress {1e-6 * found.lowest:.1f} to {1e-6 * found.highest:.1f} MPa; ", end="")
    print(f"without axial load up to {1e-6 * plain.stress.max():.1f} MPa")
    print(f"worst: z = {1e3 * found.z:.1f} mm, {1e-6 * found.amplitude:.1f} about {1e-6 * found.mean:.1f} MPa")
    print(f"safety factor by fatigue limit and factor at the clamp (both assumed); the source: {printed}")
    print(f"{'':>10}" + "".join(f"{factor:>8g}" for factor in FACTORS))
    for limit in LIMITS:
        values = [rods.safety(bending, rods.Fatigue(limit=limit, concentration=factor)).factor for factor in FACTORS]
        print(f"{1e-6 * limit:>6.0f} MPa" + "".join(f"{value:>8.2f}" for value in values))
    needed = [
        printed / rods.safety(bending, rods.Fatigue(limit=1.0, concentration=factor)).factor for factor in FACTORS
    ]
    print("limit for it" + "".join(f"{1e-6 * value:>7.0f} " for value in needed) + "MPa")


def friction(bending: rods.Bending, rod: rods.FlexibleRod, design: dict[str, float]) -> None:
    """Print the friction power of the piston over assumed coefficients."""
    omega, guide = 2.0 * math.pi * design["turns"], design["guide"]
    unit = rods.friction_power(bending, guide, rod.crank_radius, omega, 1.0)
    rigid = np.abs(bending.load * rod.crank_radius / rod.length * np.sin(ALPHA))
    bare = float(np.mean(rigid * rod.crank_radius * omega * np.abs(np.sin(ALPHA))))
    print(f"\nfriction power of the piston; the source: about {design['friction_power']:g} W")
    print(", ".join(f"{value:g}: {value * unit:.3f} W" for value in FRICTION), "(coefficients assumed)")
    print(f"of a rod with a pin: {bare / unit:.2f} times that; coefficient for the source's: ", end="")
    print(f"{design['friction_power'] / unit:.2f}")


def computed(rod: rods.FlexibleRod, schmidt: rods.Bending) -> None:
    """Print the effect of our cylinder pressure on the rod, beside the Schmidt-type load."""
    scene = load_scene(SCENE)
    result = simulate(scene)
    cycle, p_s = result.cycle, float(result.performance.suction_pressure)
    pressure = np.interp(np.degrees(ALPHA), cycle["angle"], cycle["pressure"])
    print(f"\npressure of {scene.title!r} ({result.status}): {1e-5 * pressure.min():.2f} to ", end="")
    print(f"{1e-5 * pressure.max():.2f} bar, mean {1e-5 * pressure.mean():.2f}")
    print(f"{'':>20}{'load N':>16}{'gamma':>8}{'stress MPa':>16}{'amplitude, mean MPa':>22}{'safety factor':>15}")
    behind = {"mean behind": float(pressure.mean()), "suction behind": p_s}
    loads = {name: rods.pressure_load(pressure, value, scene.machine.bore) for name, value in behind.items()}
    for name, load in ({"Schmidt-type": schmidt.load} | loads).items():
        bending = rods.bend(rod, ALPHA, load)
        found = rods.safety(bending, rods.Fatigue())
        shown = f"{load.min():.0f} to {load.max():.0f}"
        stress = f"{1e-6 * found.lowest:.0f} to {1e-6 * found.highest:.0f}"
        swing = f"{1e-6 * found.amplitude:.1f}, {1e-6 * found.mean:.1f}"
        gamma = rod.gamma(float(load.min()))
        print(f"{name:>20}{shown:>16}{gamma:>8.2f}{stress:>16}{swing:>22}{found.factor:>15.2f}")
    print(f"gamma at which it buckles: {rods.critical_gamma(rod.beta):.2f}")


def main() -> None:
    """Print the reference design and draw its figures."""
    design = read_design()
    rod = rod_of(design)
    load = rods.SchmidtLoad(bore=design["bore"], p_min=design["p_min"], delta=design["delta"], theta=design["theta"])
    bending = loads(load, rod)
    strength(bending, rod, design["safety_factor"])
    for modulus in (130e9, 206e9):
        found = rods.safety(rods.bend(rod_of(design, modulus), ALPHA, load.load(ALPHA)), rods.Fatigue())
        print(f"E = {1e-9 * modulus:.0f} GPa: amplitude {1e-6 * found.amplitude:.1f} MPa, mean {1e-6 * found.mean:.1f}")
    friction(bending, rod, design)
    computed(rod, bending)
    folder = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "results" / "rod")
    for path in draw_rod(rod, bending, folder):
        print(path, file=sys.stderr)


if __name__ == "__main__":
    main()
