"""Print errors of the tables of two-phase blends with respect to direct flashes, and the tables' cost.

Run: python benchmarks/blend_domes.py [-o PAGE.md] [NAME ...]. Without names: all predefined refrigerants, and air, for
which CoolProp has data. Errors are the largest at random states over the table's whole range, 5 to 95 % of the volume
from bubble to dew point: p of the table against that of a flash at the same T and v; s, c_v and T ∂p/∂T against
fourth-order differences in T of the flashes' Helmholtz energies and pressures.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from screwsim.codegen.modules import load
from screwsim.fluid.blend_dome import surface_kernel
from screwsim.fluid.blend_flash import Flashes, dome, references
from screwsim.fluid.composition import composition, predefined
from screwsim.fluid.description import describe
from screwsim.fluid.helmholtz import entropy_kernel, potentials_kernel, vectorised
from screwsim.fluid.saturation import saturation
from screwsim.inputs.faults import UsageError
from screwsim.numerics.kernel import HEADER, flatten

Array = np.ndarray
STATES, STEP = 200, 0.05  # random states of a blend; [K] of the differences
SMOOTH = 1e-5  # fourth difference of p over p, above which one of five flashes is another solution
ENDS = 0.3  # [K] distance of the states from the ends of the table
HEAD = """\
# Blends in two phases

Made by `python benchmarks/blend_domes.py -o docs/reference/blend-domes.md`: the table of f(T, v) by which
`gas.two_phase: equilibrium` follows a blend (M351), beside direct flashes (M350) at {states} random states each; the
predefined refrigerants, and air. From, to: where the table reaches; a cycle that is wet beyond is refused. p, c_v and
T ∂p/∂T: largest relative error; s: over R (h errs by T times that, and by p v). Differences stand in for the flashes'
own s, c_v and T ∂p/∂T, but where p of those five shows that one is another solution.
Dew: by how much p (relative) and s (over R) jump where the table meets the equation of the
vapour. Time: CPU seconds to make the table, once, with those of following the dew and bubble lines again; on a shared
machine.

| blend | from | to | p | s | c_v | T ∂p/∂T | dew: p | dew: s | time |
|---|---|---|---|---|---|---|---|---|---|
"""


def surface(name: str, T: Array, v: Array) -> Array:
    """Return the table's f and its derivatives [6, m]."""
    kernel = surface_kernel(name)
    module = load("\n\n".join([HEADER, *flatten((kernel,)).values()]) + "\n", "fluid")
    return np.array([getattr(module, kernel.flat_name)(*state) for state in zip(T, v, strict=True)]).T


def direct(flashes: Flashes, T: Array, v: Array) -> tuple[Array, Array]:
    """Return f [J/kg] and p [Pa] of flashes at T [K] and v [m³/kg]."""
    known = flashes.known
    found, (_, vapour) = flashes(T, v * known.molar_mass), flashes.borders(T)[2]
    return (found.f + references(known, flashes.f, T, 1.0 / vapour)) / known.molar_mass, found.p


def errors(name: str) -> list[float]:
    """Return the largest errors of p, s, c_v, T ∂p/∂T, and the jumps of p and s at the dew point."""
    known, edges, flashes = describe(name), dome(name).edges, Flashes(describe(name))
    random = np.random.default_rng(1)
    T = random.uniform(edges[0] + ENDS, edges[-1] - ENDS, STATES)
    liquid, vapour = flashes.borders(T)[2] / known.molar_mass
    v = liquid + random.uniform(0.05, 0.95, STATES) * (vapour - liquid)
    f, p = np.array([direct(flashes, T + k * STEP, v) for k in range(-2, 3)]).transpose(1, 0, 2)
    first, second = np.array([1, -8, 0, 8, -1]) / 12 / STEP, np.array([-1, 16, -30, 16, -1]) / 12 / STEP**2
    _, f_T, f_v, f_TT, f_Tv, _ = surface(name, T, v)
    smooth = np.abs(p[0] - 4.0 * p[1] + 6.0 * p[2] - 4.0 * p[3] + p[4]) < SMOOTH * p[2]
    off = [(f_T - first @ f) / known.R, f_TT / (second @ f) - 1.0, -f_Tv / (first @ p) - 1.0]
    worst = [-f_v / p[2] - 1.0, *(one[smooth] for one in off)]
    T = np.linspace(edges[0], edges[-1] * (1.0 - 1e-9), STATES)
    v = flashes.borders(T)[2][1] / known.molar_mass
    _, f_T, f_v, *_ = surface(name, T, v)
    worst.append(-f_v / vectorised(potentials_kernel(name))(T, 1.0 / v)[0] - 1.0)
    worst.append((-f_T - vectorised(entropy_kernel(name))(T, 1.0 / v)) / known.R)
    return [float(np.abs(one).max()) for one in worst]


def row(name: str) -> str:
    """Return the table row of a blend."""
    saturation(name)
    started = time.process_time()
    dome.__wrapped__(name)
    took, edges = time.process_time() - started, dome(name).edges
    found = " | ".join(f"{one:.0e}" for one in errors(name))
    return f"| {name} | {edges[0]:.1f} K | {edges[-1]:.1f} K | {found} | {took:.1f} s |"


def main() -> None:
    """Print the table, or write it to a page."""
    words = sys.argv[1:]
    page = Path(words[words.index("-o") + 1]) if "-o" in words else None
    names = [word for word in words if word != "-o" and (page is None or word != str(page))] or [
        name for name in sorted(predefined()) if name.startswith(("R", "Air"))
    ]
    rows, without = [], []
    for name in names:
        try:
            composition(name)
            saturation(name)
        except UsageError:  # no data: reference/blends.md says why
            continue
        try:
            rows.append(row(name))
            print(rows[-1], flush=True)
        except UsageError as error:
            without.append(name)
            print(name, error, flush=True)
    if page is not None:
        refused = f"Refused in one line, by `equilibrium` only: {', '.join(without) or 'none of these'}.\n"
        page.write_text(f"{HEAD.format(states=STATES)}" + "\n".join(rows) + f"\n\n{refused}", encoding="utf-8")


if __name__ == "__main__":
    main()
