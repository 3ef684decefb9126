"""What more oil costs and gains in machines that `screwsim new` writes: figure and table of docs/how-to/new-machine.md.

    python docs/tools/oil_ratio.py [FOLDER]      (the figure goes to docs/figures unless a folder is named)

Each machine as it is written, and with what such a scene does not name: oil that takes room in the chambers (M106) and
gas that takes it along through the discharge port (M430). Nothing is fitted.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import screwsim
from screwsim.outputs import Result
from screwsim.report import style
from screwsim.template import new_scene, request_of

ROOT = Path(__file__).resolve().parents[2]
MORE = ("effects.oil_volume={}", "effects.discharge_port.chisholm_exponent=0.25")
ROW = 60.0  # [mm] height of a row of the figure
RATIOS = (0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0)
BORES = (7.0, 7.5, 8.0, 8.5, 9.0, 9.5, 10.0, 10.5, 11.0, 12.0, 13.0, 14.0)  # [mm]
SPECIFIC, MINUTE = "package_specific_power", 6e4  # kW/(m³/min) from W s/m³
KINDS = (  # of the table: what costs more with oil, and what it is for
    ("oil brought to speed", ("hydromechanical",)),
    ("oil lifted to discharge", ("oil_supply", "oil_injection")),
    ("heat between oil and gas", ("oil_heat", "droplets")),
    ("warmed suction", ("suction_line",)),
    ("discharge port", ("discharge_port",)),
    ("films, bearings, seals", ("oil_drag", "bearings", "mechanical")),
    ("leaks", ("tip_leakage", "interlobe_leakage", "blow_hole", "end_face_leakage", "shaft_leakage")),
    ("cooler of the oil", ("oil_cooler",)),
)


class Machine(NamedTuple):
    """A machine of the figure: its options and changes, what it is called, and the figure by which it is judged."""

    name: str
    kind: str
    stated: dict[str, str]
    figure: str = "isentropic_efficiency"
    sets: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The scene as `screwsim new` writes it."""
        return new_scene(self.kind, request_of(**self.stated))  # type: ignore[arg-type]


MACHINES = (
    Machine("air package, 7.5 bar gauge", "air", {}, SPECIFIC),
    Machine(
        "ammonia, −10/35 °C, oil cooled to 45 °C",
        "refrigeration",
        {"fluid": "Ammonia", "condition": "-10/35 degC"},
        sets=("effects.separator.cooler={discharge_temperature: null, outlet_temperature: 45 degC}",),
    ),
    Machine("R134a, 0/40 °C, oil not cooled", "refrigeration", {}),
    Machine("R134a, −20/40 °C, oil not cooled", "refrigeration", {"condition": "-20/40 degC"}),
)


class Point(NamedTuple):
    """A point of a curve: oil over gas as it is sucked, and what was found."""

    ratio: float
    result: Result


def points(machine: Machine, more: tuple[str, ...] = ()) -> Iterator[Point]:
    """Yield the points of a machine that are closed, by rising oil; of the package its bore is varied."""
    air = machine.figure == SPECIFIC
    paths = [f"oil_supply.orifice_diameter={bore} mm" for bore in BORES] if air else []
    pump = "oil_supply={{kind: pump, ratio: {}, orifice_diameter: null, orifice_count: null}}"  # of pressed oil, too
    paths = paths or [pump.format(ratio) for ratio in RATIOS]
    for path in paths:
        result = screwsim.simulate(screwsim.loads(machine.text, overrides=[path, *machine.sets, *more]))
        if result.status == "ok":
            p = result.performance
            yield Point(p.oil_mass_flow / p.gas_mass_flow, result)


def value(machine: Machine, point: Point) -> float:
    """Return the judged figure in the unit in which it is drawn."""
    found = float(point.result.performance[machine.figure])
    return found / MINUTE if machine.figure == SPECIFIC else 100.0 * found


def best(machine: Machine, curve: list[Point]) -> int:
    """Return the place of the best point of a curve."""
    values = [value(machine, each) for each in curve]
    return values.index((min if machine.figure == SPECIFIC else max)(values))


def table(machine: Machine, curve: list[Point]) -> Iterator[str]:
    """Yield a table in Markdown: exergy destroyed by kinds of loss, in percent of the shaft power, over the oil."""
    shown = [curve[0], curve[best(machine, curve)], curve[-1]] if 0 < best(machine, curve) else [curve[0], curve[-1]]
    yield f"\n{machine.name}: of the shaft power, %, at kg of oil per kg of gas\n"
    yield f"| | {' | '.join(f'{each.ratio:.2g}' for each in shown)} |"
    yield f"|---|{'---|' * len(shown)}"
    for name, effects in KINDS:
        shares = [_share(each.result, effects) for each in shown]
        if any(abs(share) > 0.05 for share in shares):
            yield f"| {name} | {' | '.join(f'{share:.1f}' for share in shares)} |"
    unit = "kW/(m³/min)" if machine.figure == SPECIFIC else "η_s %"
    yield f"| **{unit}** | {' | '.join(f'{value(machine, each):.4g}' for each in shown)} |"


def _share(result: Result, effects: tuple[str, ...]) -> float:
    destroyed = (result.ledger.get(f"exergy_destroyed_{name}", 0.0) for name in effects)
    return 100.0 * float(sum(destroyed)) / float(result.ledger["shaft_power"])


def figure(curves: list[tuple[Machine, list[Point], list[Point]]]) -> Any:
    """Draw all machines: as they are written, and with what they do not name."""
    drawn, places = style.panels(len(curves), 0.0, ROW)
    for axes, (machine, plain, more) in zip(places, curves, strict=True):
        for curve, colour, dash, name in (
            (plain, style.COLOURS[0], "-", "as written"),
            (more, style.COLOURS[3], style.DASHES[1], "with the room and inertia of oil"),
        ):
            values = [value(machine, each) for each in curve]
            axes.plot([each.ratio for each in curve], values, linestyle=dash, color=colour, label=name)
            top = best(machine, curve)
            if 0 < top < len(curve) - 1:
                axes.plot(curve[top].ratio, values[top], "o", color=colour)
        axes.set_title(machine.name)
        axes.set_xlabel("Oil over gas (kg/kg)")
        axes.set_ylabel("Specific power (kW/(m³/min))" if machine.figure == SPECIFIC else "Isentropic efficiency (%)")
        style.plain_ticks(axes.xaxis, axes.yaxis)
        if machine is curves[-1][0]:
            axes.legend(loc="lower left")
    return drawn


def main() -> None:
    """Draw the figure and print the tables."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    curves: list[tuple[Machine, list[Point], list[Point]]] = []
    for machine in MACHINES:
        plain = list(points(machine))
        curves.append((machine, plain, list(points(machine, MORE))))
        print("\n".join(table(machine, plain)), flush=True)
        for name, curve in zip(("as written", "with both"), curves[-1][1:], strict=True):
            top = curve[best(machine, curve)]
            ends = [f"{value(machine, each):.4g} at {each.ratio:.3g}" for each in (curve[0], top, curve[-1])]
            print(f"{name}: first {ends[0]}, best {ends[1]}, last {ends[2]}", flush=True)
    with tempfile.TemporaryDirectory() as written:
        style.write_all({"oil_ratio": lambda: figure(curves)}, written)
        print(shutil.copy(Path(written) / "oil_ratio.png", folder))


if __name__ == "__main__":
    main()
