"""The claims A1–A7 of the source paper on the machine chosen for them, measured as docs/explanation/paper.md says."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from math import log
from pathlib import Path

import numpy as np

from screwsim.build import build_gas
from screwsim.outputs.customary import RPM
from screwsim.scene import load
from screwsim.study.claims import Claim, DisplacementCurve, PumpCurves, claims, read_displacement, read_pump
from screwsim.study.sweep import run_sweep
from screwsim.study.validation import Comparison, Panel, Row, Series, equal, read_table, sibling, solved, trend

TITLE = "Chernov et al. 2015: claims A1–A7"
CITATION = "G. I. Chernov et al., Omsk Scientific Bulletin, 2015 (in Russian), text; its figures were not at hand"
ABOUT = (
    "The paper gives no machine. Ours lies inside stated bounds and was chosen so that A1–A4 hold and A5 is met: a "
    "shape that holds here shows that the model can have it, no more. What a claim is worth as a prediction is how "
    "many of the 256 machines of scripts/admissible.py have it. Other machines that fit A5, A6 and the orderings as "
    "well (fits.csv, scripts/fit_paper.py) are the bands of the figure."
)
WORDS = {"holds": "holds", "calibrated": "holds", "in part": "fails", "fails": "fails"}
POINTS = ((1000.0, 3.0), (3000.0, 1.0), (250.0, 3.0), (1000.0, 0.3))  # rpm, d
A6, A6_UNCERTAINTY, D = 0.44, 0.02, 3.0


def claim_row(claim: Claim) -> Row:
    """Return the row of a claim; fitted ones are marked so."""
    kind = "calibrated" if claim.name in ("A5", "A6") else "published"
    note = f"{claim.measure}{'; in part' if claim.verdict == 'in part' else ''}"
    return Row(f"{claim.name}: {claim.says}", claim.found, claim.says, kind, WORDS[claim.verdict], note=note)


def every_rows(here: Path) -> list[Row]:
    """Return how many of the sampled admissible machines have each claim."""
    sample = read_table(here / "admissible.csv")
    held = {name: [row[name.lower()] == "True" for row in sample] for name in ("A1", "A2", "A3", "A4")}
    held["A1–A4 together"] = [all(each) for each in zip(*held.values(), strict=True)]
    rows = []
    for name, which in held.items():
        count, of = sum(which), len(sample)
        rows.append(
            trend(
                f"every admissible machine has {name}",
                f"{count} of {of} have it",
                "all, if the model alone predicted it",
                count == of,
                note="validation/paper/admissible.csv, made by scripts/admissible.py sample 256",
            )
        )
    return rows


def misprint_rows(scene_file: Path) -> list[Row]:
    """Return by how much the printed (12) changes the isothermal efficiency."""
    rows = []
    for speed, ratio in POINTS:
        values = {"operation.speed": speed * RPM, "oil_supply.ratio": ratio}
        right = solved(scene_file, values=values).performance.isothermal_efficiency
        printed = solved(scene_file, ("effects.oil_heat.equation_12=printed", "numerics.error=none"), values)
        change = 100.0 * (printed.performance.isothermal_efficiency - right)
        rows.append(
            Row(
                f"printed (12) less corrected: isothermal efficiency at {speed:.0f} rpm, d = {ratio:g}",
                change,
                None,
                "estimate",
                "no verdict",
                "points",
                note="the oil's temperature moves d times too fast" if ratio > 1 else "",
            )
        )
    return rows


def bore_of(scene_file: Path, values: dict[str, float]) -> float:
    """Return the bore [m] with which displacement gives d = 3: d grows nearly as its square."""
    bore = 4e-3
    for _ in range(8):
        found = solved(scene_file, values={**values, "oil_supply.orifice_diameter": bore}).performance.oil_ratio
        if abs(found / D - 1.0) < 1e-3:
            break
        bore *= (D / found) ** 0.5
    return bore


def reading_rows(here: Path, pump_file: Path) -> list[Row]:
    """Return the second reading of A6, 44 % at 1000 rpm: what our machine does there, and what it would take.

    The last row holds what the readings over all admissible machines rest on: displacement is the pump scheme at the
    same oil ratio without pump work.
    """
    file = here / "displacement.yaml"
    scene, values = load(file), {"operation.speed": 1000.0 * RPM}
    bore = bore_of(file, values)
    found = solved(file, values={**values, "oil_supply.orifice_diameter": bore}).performance
    ratio, gas = scene.operation.discharge.pressure / scene.operation.suction.pressure, build_gas(scene)
    ideal = gas.R * scene.operation.suction.temperature * log(ratio)
    missing = ideal / A6 - found.shaft_power / found.gas_mass_flow
    lift = missing / found.oil_flow_ratio * scene.oil.density
    free = {**values, "oil_supply.ratio": found.oil_ratio, "effects.oil_pump.pressure_loss": 0.0}
    same = solved(pump_file, values=free).performance.isothermal_efficiency
    return [
        equal(
            "A6 read at 1000 rpm: displacement, d = 3",
            100.0 * found.isothermal_efficiency,
            100.0 * A6,
            100.0 * A6_UNCERTAINTY,
            "published",
            unit="%",
            basis="the paper gives two digits; 2 points as in docs/explanation/paper.md",
            note=f"bore {1e3 * bore:.2f} mm",
        ),
        Row(
            "work that 44 % at 1000 rpm would need beyond ours",
            missing / 1e3,
            None,
            "estimate",
            "no verdict",
            "kJ/kg",
            note=f"as if the oil were lifted by {lift / 1e5:.0f} bar more; the machine lifts it by "
            f"{(scene.operation.discharge.pressure - found.injection_pressure) / 1e5:.1f} bar",
        ),
        equal(
            "displacement less pump without line loss at the same oil ratio: isothermal efficiency",
            100.0 * (found.isothermal_efficiency - same),
            0.0,
            0.06,
            "exact",
            unit="points",
            basis="two solutions of accuracy 3e-4",
            note="so the readings over all admissible machines take the pump scheme",
        ),
    ]


def panels(
    pump: PumpCurves, lines: Sequence[DisplacementCurve], first: Sequence[Series], second: Sequence[Series]
) -> tuple[Panel, ...]:
    """Return Fig. 1 and Fig. 2 with the spread of the equally good fits."""
    curves = [
        Series(f"{speed:.0f} rpm", pump.ratios.tolist(), (100 * row).tolist())
        for speed, row in zip(pump.speeds, pump.efficiency, strict=True)
    ]
    displaced = []
    for line in lines:
        order = np.argsort(line.ratio)
        displaced.append(
            Series(f"bore {1e3 * line.bore:g} mm", line.ratio[order].tolist(), (100 * line.efficiency[order]).tolist())
        )
    labels = ("oil ratio d", "isothermal efficiency / %")
    return (
        Panel(*labels, (*first, *curves, Series("A5 (fitted)", [3.0], [68.0], theirs=True)), log_x=True),
        Panel(*labels, (*second, *displaced, Series("A6 (fitted)", [3.0], [44.0], theirs=True)), log_x=True),
    )


def compare(here: Path) -> Comparison:
    """Sweep both figures and judge the claims."""
    configs = here.parents[1] / "configs" / "paper"
    with tempfile.TemporaryDirectory(prefix="screwsim-") as folder:
        files = []
        for name in ("fig1", "fig2"):
            files.append(str(Path(folder) / f"{name}.h5"))
            run_sweep(load(configs / f"{name}.yaml"), files[-1], jobs=1)
        found = claims(*files)
        pump, lines = read_pump(files[0]), read_displacement(files[1])
    fits = sibling(here / "fits.py")
    fitted = fits.fitted(here)
    rows = [claim_row(claim) for claim in found]
    rows += [*every_rows(here), *fits.fit_rows(fitted), *fits.reading_rows(here)]
    rows += reading_rows(here, configs / "point.yaml")
    rows += misprint_rows(configs / "point.yaml")
    return Comparison(TITLE, CITATION, ABOUT, rows, panels(pump, lines, *fits.bands(fits.good(fitted))))
