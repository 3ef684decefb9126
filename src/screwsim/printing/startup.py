"""Output of `screwsim startup`, printed and written."""

import math
from pathlib import Path

from screwsim.outputs.customary import with_printed_units
from screwsim.printing.tables import print_wrapped, wrapped
from screwsim.results.atomic import protect_others, write_csv
from screwsim.screen import say
from screwsim.solve.start_up import StartUp

TRACES = "startup.csv"
RPM = 30.0 / math.pi
FIGURE_ROWS = (
    ("time", "s", 1.0),
    ("turns", "", 1.0),
    ("end_speed", "rpm", RPM),
    ("steady_speed", "rpm", RPM),
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


def print_startup(title: str, found: StartUp) -> None:
    """Print the figures of a start-up."""
    if title:
        say(with_printed_units(title))
    say(wrapped(f"status: {found.status}{f', {found.message}' if found.message else ''}"))
    print_wrapped(f"warning: {warning}" for warning in found.warnings)
    if found.figures:
        say()
    for name, unit, factor in FIGURE_ROWS:
        value = found.figures.get(name)
        if value is not None:
            say(f"{name.replace('_', ' '):<28}{factor * value:>10.5g}  {unit}".rstrip())


def protect_other_traces(path: Path) -> None:
    """Raise UsageError where a file at `path` does not hold such traces, as it would be lost."""
    protect_others(path, b"time,angle,speed,")


def write_traces(path: Path, found: StartUp) -> str:
    """Write the traces as CSV, in SI units; return the path."""
    return write_csv(path, found.traces, zip(*(trace.tolist() for trace in found.traces.values()), strict=True))
