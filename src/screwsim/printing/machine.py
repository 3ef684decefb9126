"""Output of the commands `datasheet`, `startup` and `tolerance`."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

from screwsim.figures.engineering import figure_text, shown_name
from screwsim.outputs.customary import RPM
from screwsim.outputs.display import picked
from screwsim.printing.tables import WIDTH, print_scene_title, print_table, print_text, print_wrapped, wrapped
from screwsim.results.atomic import protect_others, write_csv
from screwsim.screen import say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from screwsim.scene import Scene
    from screwsim.solve.start_up import StartUp
    from screwsim.study.datasheet import Sheet
    from screwsim.study.tolerance import ToleranceStudy

TRACES = "startup.csv"
UNITS = {"time": "s", "angle": "rad", "speed": "rad/s", "motor_speed": "rad/s", "twist": "rad"}  # else torques
FIGURE_ROWS = (
    ("time", "s", 1.0),
    ("turns", "", 1.0),
    ("end_speed", "rpm", 1.0 / RPM),
    ("steady_speed", "rpm", 1.0 / RPM),
    ("coupling_torque_peak", "N m", 1.0),
    ("coupling_torque_peak_time", "s", 1.0),
    ("coupling_torque_lowest", "N m", 1.0),
    ("coupling_torque_steady", "N m", 1.0),
    ("peak_over_steady", "", 1.0),
    ("twist_peak", "deg", 180.0 / math.pi),
    ("motor_torque_peak", "N m", 1.0),
    ("motor_work", "kJ", 1e-3),
    ("gas_work", "kJ", 1e-3),
    ("loss_work", "kJ", 1e-3),
    ("coupling_work", "kJ", 1e-3),
    ("stored", "kJ", 1e-3),
    ("residue", "", 1.0),
)


def print_startup(title: str, found: StartUp, changed: Sequence[str] = ()) -> None:
    """Print the figures of a start-up; `changed` has what the command line changes in the scene."""
    print_scene_title(title, changed)
    print_text(f"status: {found.status}{f', {found.message}' if found.message else ''}")
    print_wrapped(f"warning: {warning}" for warning in found.warnings)
    if found.figures:
        say()
    for name, unit, factor in FIGURE_ROWS:
        value = found.figures.get(name)
        if value is not None:
            say(f"{name.replace('_', ' '):<28}{factor * value:>10.5g}  {unit}".rstrip())


def protect_other_traces(path: Path) -> None:
    """Raise UsageError where a file at `path` does not hold such traces, as it would be lost."""
    protect_others(path, b"time [s],angle [rad],speed ", b"time,angle,speed,")  # and those of before


def write_traces(path: Path, found: StartUp) -> str:
    """Write the traces as CSV, in SI units; return the path."""
    heads = [f"{name} [{UNITS.get(name, 'N m')}]" for name in found.traces]
    return write_csv(path, heads, zip(*(trace.tolist() for trace in found.traces.values()), strict=True))


def print_sheet(sheet: Sheet) -> None:
    """Print a data sheet: its lines, its tables, the verdict, notes."""
    print_wrapped(filter(None, (sheet.title, sheet.heading)))
    say()
    width = max((len(name) for name, _ in sheet.lines), default=0) + 2
    for name, text in sheet.lines:
        say(textwrap.fill(text, WIDTH - 1, initial_indent=name.ljust(width), subsequent_indent=" " * width))
    for table in sheet.tables:
        say()
        if len(sheet.tables) > 1:
            print_text(table.title)
        print_table(table.heads, table.rows, table.left)
        if table.note:
            print_text(table.note)
    if sheet.verdict is not None:
        what, text, _ = sheet.verdict
        say()
        print_text(f"{what}: {text}")
    say()
    print_wrapped(sheet.notes)


def tolerance_document(scene: Scene, found: ToleranceStudy) -> dict[str, Any]:
    """Return what `tolerance --json` prints."""
    return {
        "title": scene.title,
        **picked(found, "grades", "widths"),
        "law_of_motion": [row._asdict() for row in found.table],
        **picked(found, "count", "seed", "hits", "failed", "message", "chance_share"),
        "figures": {spread.figure: spread._asdict() for spread in found.spreads},
    }


def print_tolerance(scene: Scene, found: ToleranceStudy) -> None:
    """Print the kinematic table by grades, and the scatter of the figures over the sampled machines."""
    print_scene_title(scene.title)
    say("\nlaw of motion, worst corner of crank and rod")
    rows = []
    for row in found.table:
        numbers = (1e3 * row.crank_width, 1e3 * row.rod_width, 100.0 * row.error, 1e3 * row.head)
        rows.append((f"IT{row.crank}", *(f"{number:.3f}" for number in numbers)))
    print_table(("grade", "crank mm", "rod mm", "error of the law %", "dead centre +- mm"), rows)
    grades = ", ".join(f"{name.replace('_', ' ')} IT{number}" for name, number in found.grades.items())
    drawn = f"{found.count} machines, lengths uniform over their tolerances ({grades}), seed {found.seed}"
    say("\n" + wrapped(drawn))
    rows = []
    for each in found.spreads:
        texts = (figure_text(each.figure, value) for value in (each.nominal, each.low, each.high))
        (nominal, unit), (low, _), (high, _) = (text.partition(" ")[::2] for text in texts)
        spread = f"{100.0 * each.deviation / abs(each.nominal):.4f}"
        shares = (f"{100.0 * share:.0f}" for share in each.shares.values())
        rows.append((shown_name(each.figure), nominal, unit, spread, low, high, *shares))
    shares = (f"{name.replace('_', ' ')} %" for name in found.grades)
    print_table(("figure", "nominal", "", "sd %", "lowest", "highest", *shares), rows, left=1)
    print_text("sd: standard deviation over the nominal value; last columns: share of the variance (r²)")
    chance = f"a share below {100.0 * found.chance_share:.0f} % may be chance"
    print_text(f"of {len(found.shifts)} machines {chance}: one length in twenty without influence has more")
    if found.hits:
        print_text(f"{found.hits} of {found.count} machines: the piston hits the head (not simulated)")
    if found.failed:
        print_text(f"{found.failed} of {found.count} machines: {found.message}")
