"""Compare four ways of capacity control on one machine: slide valve, speed, bypass, suction throttle.

Each way is a sweep of configs/control; oil comes from a pump, or (files `…_displaced.yaml`) is displaced through an
orifice that gives about the pump's ratio at full load. Figures are those at equal loads (cooling capacity over that at
full load), as `screwsim datasheet` finds them (`study.part_load`).

    scripts/capacity_control.py [-o FOLDER]      writes capacity_control.csv and .png, .pdf (default: results/control)
"""

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path

from screwsim import load
from screwsim.report.style import COLOURS, DASHES, SMALL, panels, plain_ticks, write_all
from screwsim.results.atomic import make_folder, write_csv
from screwsim.study.part_load import LOADS, NEAR, PartLoad, controls, part_load

CONFIGS = Path(__file__).parents[1] / "configs" / "control"
WAYS = {"speed": "speed", "slide_valve": "slide valve", "throttle": "suction throttle", "bypass": "bypass"}
SUPPLIES = {"pump": "", "displacement": "_displaced"}
FIGURES = {
    "isentropic_efficiency": ("isentropic efficiency (%)", 100.0, 0.0),
    "cop": ("COP", 1.0, 0.0),
    "discharge_temperature": ("discharge temperature (°C)", 1.0, -273.15),
    "oil_ratio": ("oil ratio $d$ (kg/kg)", 1.0, 0.0),
}
Found = dict[tuple[str, str], PartLoad]


def solved(way: str, supply: str) -> PartLoad:
    """Return the part-load results of one way."""
    scene = load(CONFIGS / f"{way}{SUPPLIES[supply]}.yaml")
    (control,) = (each for each in controls(scene) if each.path in scene.sweep)
    found = part_load(replace(scene, sweep={}), control)
    if found.why:
        raise SystemExit(f"{way}, {supply}: {found.why}")
    return found


def at_loads(found: PartLoad, name: str) -> list[float]:
    """Return a figure at `LOADS`; NaN below the least load of the way."""
    near = {load: [step for step in found.steps if abs(step.load - load) <= NEAR] for load in LOADS}
    return [steps[0].result.performance[name] if steps else float("nan") for steps in near.values()]


def table(found: Found, path: Path) -> None:
    """Write and print the figures at equal loads."""
    rows = []
    for (way, supply), each in found.items():
        values = {name: at_loads(each, name) for name in FIGURES}
        rows += [[way, supply, f"{x:g}", *(f"{values[name][i]:.4g}" for name in FIGURES)] for i, x in enumerate(LOADS)]
    write_csv(path, ["way", "oil_supply", "load", *FIGURES], rows)
    pages(found)


def pages(found: Found) -> None:
    """Print a table of each figure at equal loads, as in docs/reference/effects-loads.md."""
    for name, (title, factor, offset) in FIGURES.items():
        print(f"| {title.replace('$', '')} at a load of | {' | '.join(f'{x:.0%}'.replace('%', ' %') for x in LOADS)} |")
        print(f"|{'---|' * (1 + len(LOADS))}")
        for (way, supply), each in found.items():
            values = " | ".join(f"{factor * value + offset:.4g}" for value in at_loads(each, name))
            print(f"| {WAYS[way]}, {'pump' if supply == 'pump' else 'oil displaced'} | {values} |")
        print()


def figure(found: Found):
    """Draw all figures over the load: one colour per way, dashed lines for displaced oil."""
    drawing, places = panels(len(FIGURES), 0.0, 65.0, sharex=True)
    for axes, (name, (label, factor, offset)) in zip(places, FIGURES.items(), strict=True):
        for (way, supply), each in found.items():
            colour = COLOURS[(0, 2, 3, 5)[list(WAYS).index(way)]]
            dashes = DASHES[0] if supply == "pump" else DASHES[1]
            words = f"{WAYS[way]}" if supply == "pump" else None
            x = [100.0 * step.load for step in each.curve]
            y = [factor * step.result.performance[name] + offset for step in each.curve]
            axes.plot(x, y, color=colour, linestyle=dashes, label=words)
        axes.set(xlim=(20.0, 100.0), ylabel=label)
        plain_ticks(axes.yaxis, most=6)
        plain_ticks(axes.xaxis)
        if name != "discharge_temperature":
            axes.set_ylim(bottom=0.0)
    handles, labels = places[0].get_legend_handles_labels()
    dashed = places[0].plot([], [], color="black", linestyle=DASHES[1])[0]
    drawing.legend([*handles, dashed], [*labels, "oil displaced"], loc="outside upper center", ncols=5, fontsize=SMALL)
    drawing.supxlabel("load: cooling capacity over that at full load (%)", fontsize=8.0)
    return drawing


def main() -> None:
    """Solve all ways, write the table and the figure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("-o", dest="folder", type=Path, default=Path("results/control"))
    folder = parser.parse_args().folder
    make_folder(folder)
    found = {(way, supply): solved(way, supply) for supply in SUPPLIES for way in WAYS}
    table(found, folder / "capacity_control.csv")
    print(*write_all({"capacity_control": partial(figure, found)}, folder), sep="\n")


if __name__ == "__main__":
    main()
