"""Output of `screwsim tolerance`."""

from typing import Any

from screwsim.figures import declared
from screwsim.outputs.customary import printed_celsius
from screwsim.outputs.display import picked
from screwsim.printing import engineering, shown_name
from screwsim.printing.tables import plain_table, print_scene_title, print_table, wrapped
from screwsim.scene import Scene
from screwsim.screen import say
from screwsim.study.tolerance import ToleranceStudy


def tolerance_document(scene: Scene, found: ToleranceStudy) -> dict[str, Any]:
    """Return what `tolerance --json` prints."""
    return {
        "title": scene.title,
        **picked(found, "grades", "widths"),
        "law_of_motion": [row._asdict() for row in found.table],
        **picked(found, "count", "seed", "hits", "failed", "message"),
        "figures": {each.figure: each._asdict() for each in found.spreads},
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
    say("\n".join(_spreads(found)))
    say(wrapped("sd: standard deviation over the nominal value; last columns: share of the variance (r²)"))
    if found.hits:
        say(wrapped(f"{found.hits} of {found.count} machines: the piston hits the head (not simulated)"))
    if found.failed:
        say(wrapped(f"{found.failed} of {found.count} machines: {found.message}"))


def _spreads(found: ToleranceStudy) -> list[str]:
    rows = []
    for each in found.spreads:
        values = (each.nominal, each.low, each.high)
        (nominal, unit), (low, _), (high, _) = (_in_unit(each.figure, value) for value in values)
        spread = f"{100.0 * each.deviation / abs(each.nominal):.4f}"
        shares = (f"{100.0 * share:.0f}" for share in each.shares.values())
        rows.append((shown_name(each.figure), nominal, unit, spread, low, high, *shares))
    shares = (f"{name.replace('_', ' ')} %" for name in found.grades)
    return plain_table(("figure", "nominal", "", "sd %", "lowest", "highest", *shares), rows, left=1)


def _in_unit(name: str, value: float) -> tuple[str, str]:
    """Return a figure as number and unit, a temperature in °C."""
    number, unit = engineering(name, value)
    return (printed_celsius(value), "°C") if declared(name).units == "K" else (number, unit)
