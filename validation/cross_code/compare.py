"""The package against other programs: scipy's integrators, and CoolProp's own answers for R134a."""

from __future__ import annotations

from pathlib import Path

import CoolProp.CoolProp as coolprop

from screwsim.figures.errors import relative_errors
from screwsim.fluid.real_gas import RealGas
from screwsim.study.validation import Comparison, Row, equal, read_table, solved

TITLE = "Package against scipy's integrators and CoolProp"
CITATION = "scipy.integrate (Radau, BDF, LSODA); CoolProp, HEOS: Tillner-Roth & Baehr 1994"
ABOUT = (
    "scipy's integrators share the package's right-hand side, not its method, its steps or its closing. CoolProp is "
    "asked for the same states by its high-level interface: spot checks of R134a. The independently written equations "
    "are the source plain."
)
ACCURACY = 1e-6
# tolerance of a step where that of the accuracy does not close the balances
INTEGRATORS = {"scipy-radau": None, "scipy-bdf": None, "scipy-lsoda": 1e-9}
PROPERTIES = (("pressure", "P"), ("enthalpy", "H"), ("entropy", "S"))


def integrator_row(scene_file: Path, name: str, integrator: str) -> Row:
    """Return the largest difference of a figure between Rodas4 and one of scipy's integrators."""
    own = solved(scene_file, (f"numerics.accuracy={ACCURACY}",)).performance
    asked = (f"numerics.accuracy={ACCURACY}", "numerics.error=none", f"numerics.integrator={integrator}")
    rtol = INTEGRATORS[integrator]
    other = solved(scene_file, asked if rtol is None else (*asked, f"numerics.rtol={rtol}")).performance
    errors = {figure: size for figure, size in relative_errors(own, other).items() if size is not None}
    worst = max(errors, key=lambda figure: errors[figure])
    return equal(
        f"{name}, {integrator}: largest difference of a figure",
        errors[worst],
        0.0,
        10.0 * ACCURACY,
        "cross-code",
        basis=f"each is asked for {ACCURACY:g}; local errors add up over the steps",
        note=f"of {worst}",
    )


def property_rows(here: Path) -> list[Row]:
    """Return the largest relative difference of each property over the spot checks."""
    gas = RealGas("R134a")
    found: dict[str, list[float]] = {name: [] for name, _ in PROPERTIES}
    for row in read_table(here / "states.csv"):
        T, p = float(row["temperature_K"]), float(row["pressure_Pa"])
        rho = coolprop.PropsSI("D", "T", T, "P", p, "R134a")
        ours = dict(zip(found, (gas.state(T, rho)[0], gas.state(T, rho)[1], gas.specific_entropy(T, rho)), strict=True))
        for name, key in PROPERTIES:
            theirs = coolprop.PropsSI(key, "T", T, "D", rho, "R134a")
            found[name].append(abs(ours[name] / theirs - 1.0))
    rows = []
    for name, sizes in found.items():
        rows.append(
            equal(
                f"R134a, {name}: largest relative difference of {len(sizes)} states",
                max(sizes),
                0.0,
                1e-8,
                "cross-code",
                basis="one equation, two programs: rounding",
            )
        )
    return rows


def saturation_row() -> Row:
    """Return saturation temperatures against CoolProp's."""
    gas = RealGas("R134a")
    sizes = []
    for p in (1.5e5, 3e5, 6e5, 12e5, 25e5):
        ours = gas.saturation_temperature(p)
        assert ours is not None
        sizes.append(abs(ours / coolprop.PropsSI("T", "P", p, "Q", 1, "R134a") - 1.0))
    return equal(
        "R134a, saturation temperature: largest relative difference of 5 pressures",
        max(sizes),
        0.0,
        1e-7,
        "cross-code",
        basis="both solve for equal Gibbs energies by iteration",
    )


def compare(here: Path) -> Comparison:
    """Return integrators on the paper's point and on a plain real-gas machine, and properties."""
    root = here.parents[1]
    points = (
        ("paper's point", root / "configs" / "paper" / "point.yaml"),
        ("R134a, 2/45 °C", root / "tests" / "plain" / "r134a.yaml"),
    )
    rows = [integrator_row(file, name, integrator) for name, file in points for integrator in INTEGRATORS]
    return Comparison(TITLE, CITATION, ABOUT, [*rows, *property_rows(here), saturation_row()])
