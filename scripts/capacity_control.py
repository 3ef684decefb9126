"""Compare four ways of capacity control on one machine: slide valve, speed, bypass, suction throttle.

Each way is a sweep of configs/control; oil comes from a pump, or (files `…_displaced.yaml`) is displaced through an
orifice that gives about the pump's ratio at full load. Figures are interpolated at equal loads (cooling capacity over
that at full load).

    scripts/capacity_control.py [-o FOLDER]      writes capacity_control.csv and .png, .pdf (default: results/control)
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

import numpy as np

from screwsim import load
from screwsim.report.style import COLOURS, DASHES, DOUBLE, SMALL, new_figure, plain_ticks, write_all
from screwsim.results.atomic import make_folder, write_csv
from screwsim.scene.grid import case, case_count
from screwsim.simulate import simulate_many

CONFIGS = Path(__file__).parents[1] / "configs" / "control"
WAYS = {"speed": "speed", "slide_valve": "slide valve", "throttle": "suction throttle", "bypass": "bypass"}
SUPPLIES = {"pump": "", "displacement": "_displaced"}
FIGURES = {
    "isentropic_efficiency": ("isentropic efficiency (%)", 100.0, 0.0),
    "cop": ("COP", 1.0, 0.0),
    "discharge_temperature": ("discharge temperature (°C)", 1.0, -273.15),
    "oil_ratio": ("oil ratio $d$ (kg/kg)", 1.0, 0.0),
}
LOADS = np.array([1.0, 0.75, 0.5, 0.25])


def curves(way: str, supply: str) -> dict[str, np.ndarray]:
    """Return the figures of one way over the load, falling from 1."""
    scene = load(CONFIGS / f"{way}{SUPPLIES[supply]}.yaml")
    results = list(simulate_many([case(scene, i) for i in range(case_count(scene))], trace=False))
    bad = [result.message for result in results if result.status != "ok"]
    if bad:
        raise SystemExit(f"{way}, {supply}: {bad[0]}")
    names = ("cooling_capacity", *FIGURES)
    found = {name: np.array([result.performance[name] for result in results], float) for name in names}
    found["load"] = found["cooling_capacity"] / found["cooling_capacity"][0]
    return found


def at_loads(curve: dict[str, np.ndarray], name: str) -> np.ndarray:
    """Return a figure at `LOADS`; NaN below the least load of the sweep."""
    order = np.argsort(curve["load"])
    return np.interp(LOADS, curve["load"][order], curve[name][order], left=np.nan)


def table(found: dict[tuple[str, str], dict[str, np.ndarray]], path: Path) -> None:
    """Write and print the figures at equal loads."""
    rows = []
    for (way, supply), curve in found.items():
        values = {name: at_loads(curve, name) for name in FIGURES}
        rows += [[way, supply, f"{x:g}", *(f"{values[name][i]:.4g}" for name in FIGURES)] for i, x in enumerate(LOADS)]
    write_csv(path, ["way", "oil_supply", "load", *FIGURES], rows)
    pages(found)


def pages(found: dict[tuple[str, str], dict[str, np.ndarray]]) -> None:
    """Print a table of each figure at equal loads, as docs/reference/effects-loads.md has them."""
    for name, (title, factor, offset) in FIGURES.items():
        print(f"| {title.replace('$', '')} at a load of | {' | '.join(f'{x:.0%}'.replace('%', ' %') for x in LOADS)} |")
        print(f"|{'---|' * (1 + len(LOADS))}")
        for (way, supply), curve in found.items():
            values = " | ".join(f"{value:.4g}" for value in factor * at_loads(curve, name) + offset)
            print(f"| {WAYS[way]}, {'pump' if supply == 'pump' else 'oil displaced'} | {values} |")
        print()


def figure(found: dict[tuple[str, str], dict[str, np.ndarray]]):
    """Draw all figures over the load: a colour a way, dashed for displaced oil."""
    drawing = new_figure(DOUBLE, 130.0)
    panels = drawing.subplots(2, 2, sharex=True).ravel()
    for axes, (name, (label, factor, offset)) in zip(panels, FIGURES.items(), strict=True):
        for (way, supply), curve in found.items():
            i = list(WAYS).index(way)
            dashes = DASHES[0] if supply == "pump" else DASHES[1]
            words = f"{WAYS[way]}" if supply == "pump" else None
            y = factor * curve[name] + offset
            axes.plot(100.0 * curve["load"], y, color=COLOURS[(0, 2, 3, 5)[i]], linestyle=dashes, label=words)
        axes.set(xlim=(20.0, 100.0), ylabel=label)
        plain_ticks(axes.yaxis, most=6)
        plain_ticks(axes.xaxis)
        if name != "discharge_temperature":
            axes.set_ylim(bottom=0.0)
    handles, labels = panels[0].get_legend_handles_labels()
    dashed = panels[0].plot([], [], color="black", linestyle=DASHES[1])[0]
    drawing.legend([*handles, dashed], [*labels, "oil displaced"], loc="outside upper center", ncols=5, fontsize=SMALL)
    drawing.supxlabel("load: cooling capacity over that at full load (%)", fontsize=8.0)
    return drawing


def main() -> None:
    """Run the sweeps, write the table and the figure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("-o", dest="folder", type=Path, default=Path("results/control"))
    folder = parser.parse_args().folder
    make_folder(folder)
    found = {(way, supply): curves(way, supply) for supply in SUPPLIES for way in WAYS}
    table(found, folder / "capacity_control.csv")
    print(*write_all({"capacity_control": partial(figure, found)}, folder), sep="\n")


if __name__ == "__main__":
    main()
