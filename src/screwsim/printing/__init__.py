"""Output of the commands: results as JSON documents, and as text in engineering units."""

import json
import math
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from screwsim.figures import declared
from screwsim.figures.engineering import engineering, shown_name
from screwsim.inputs.suggestions import counted
from screwsim.outputs import Result, sorted_entries, words_of_effects
from screwsim.outputs.customary import engineering_temperature, scale, small_number_text
from screwsim.outputs.display import grouped
from screwsim.printing.tables import WIDTH, absent_figures, heading, print_table, print_text, print_wrapped
from screwsim.screen import json_safe, printable, say

COPS, ELECTRICAL = ("cop", "heating_cop"), "electrical_"
MOTOR_HEAT = 1e-3  # by which a heating COP exceeds that of cooling plus one where the motor's heat is in it
LEAST_SHOWN_LOSS = 5e-5  # of the shaft power: smaller losses would be shown as 0.00 %


def plain(value: Any) -> Any:
    """Return a value in JSON types: numpy's become Python's, NaN and infinities None."""
    if isinstance(value, Mapping):
        return {str(name): plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)


def print_json(document: Any) -> None:
    """Print one JSON document on stdout; characters that its encoding may lack are escaped."""
    few = not (sys.stdout.encoding or "utf").lower().startswith("utf")
    print(json_safe(json.dumps(plain(document), indent=2, allow_nan=False, ensure_ascii=few)))


def write_json(document: Any, path: Path) -> str:
    """Write one JSON document and return its path; raise UsageError in one line when the system refuses."""
    from screwsim.results.atomic import write_text  # imports HDF5's modules, which printing does not need

    text = json.dumps(plain(document), indent=1, allow_nan=False, ensure_ascii=False)
    return write_text(path, json_safe(text) + "\n")


def print_result(
    title: str,
    result: Result,
    left_out: Iterable[str] = (),
    changed: Sequence[str] = (),
    idle: Mapping[str, float] = MappingProxyType({}),
) -> None:
    """Print a result: warnings, the table of figures and the ledger, then notes, balances and numerics.

    `left_out` has lines on what its scene shifts or does not simulate; `changed` lists the changes by the command line
    to the scene named in the title; figures with the value that they have in `idle` are left out.
    """
    from rich.console import Console

    console = Console(highlight=False, markup=False, emoji=False)
    console.width = max(console.width, WIDTH)  # a narrower terminal breaks lines, where a table would cut its numbers
    doubted = impossible_figures(result)
    if title or doubted:
        first = ": ".join(filter(None, (heading(title, changed), doubted)))
        console.print(printable(first), style="bold", soft_wrap=bool(doubted))  # always in the first line, however long
    if changed:
        print_text(", ".join(changed))
    print_text(f"status: {_status_line(result)}")
    print_wrapped(f"warning: {warning}" for warning in result.warnings)
    if result.performance:
        say()
        console.print(_table(result, idle))
    if result.ledger:
        say()
        console.print(_ledger(result.ledger))
    if result.knock_out:
        say()
        _print_knock_out(result.knock_out)
    say()
    print_wrapped((*_remarks(result), *left_out))


def impossible_figures(result: Result) -> str:
    """Return the figures of a result that no machine can have; empty if all are possible."""
    names = dict.fromkeys(result.impossible)
    if (result.performance.get("volumetric_efficiency") or 0.0) < 0.0:
        names = {"volumetric_efficiency": None} | names
    values = ((name, engineering(declared(name, result.performance), result.performance[name])) for name in names)
    told = ", ".join(" ".join((shown_name(name), *value)).strip() for name, value in values)
    return f"physically impossible: {told}" if told else ""


def _status_line(result: Result) -> str:
    """Return the status with the number of warnings and the message, if any."""
    count = len(result.warnings)
    warned = f", with {counted(count, 'warning')}" if count else ""
    filled = result.performance.get("volumetric_efficiency") or 0.0
    back = f"; the volumetric efficiency is {filled:.4g}: more gas flows back than is drawn in" if filled < 0.0 else ""
    return f"{result.status}{warned}{back}" + (f"; {result.message}" if result.message else "")


def _table(result: Result, idle: Mapping[str, float]) -> Any:
    table = _right_table("figure", "value")
    table.add_column("unit", no_wrap=True)
    if result.error:
        table.add_column("error", justify="right", no_wrap=True)
    for name in _in_order(result.performance):
        value = result.performance[name]
        if value is not None and value != idle.get(name):
            error = [small_number_text(result.error.get(name))] if result.error else []
            words = f"{shown_name(name)}, shaft power" if _beside_electrical(result, name) else shown_name(name)
            table.add_row(words, *engineering(declared(name, result.performance), value), *error)
    return table


def _beside_electrical(result: Result, name: str) -> bool:
    """Whether a figure is a COP of the shaft power beside that of the electrical power, which catalogues state."""
    return name in COPS and result.performance.get(ELECTRICAL + name) is not None


def _in_order(figures: Mapping[str, Any]) -> list[str]:
    """Return the names of figures, each COP of the electrical power before that of the shaft power."""
    electrical = {name: ELECTRICAL + name for name in COPS if name in figures and ELECTRICAL + name in figures}
    others = (name for name in figures if name not in electrical.values())
    return [each for name in others for each in ((electrical[name], name) if name in electrical else (name,))]


def _ledger(ledger: Mapping[str, Any]) -> Any:
    """Return the table of the ledger: useful exergy, then what each effect destroys, the largest first."""
    shaft, gas = ledger["shaft_power"], ledger["gas_exergy_rise"]
    given = shaft <= 0.0  # an expander's gas supplies the power at its shaft
    whole = -gas if given else shaft
    factor, unit = scale("W", abs(whole))
    heads = (unit, "%", "W/K", f"moved {unit}", "kg/s")
    words = words_of_effects(name for name, _ in sorted_entries(ledger))
    table = _right_table("where the shaft power goes", *heads)

    def row(name: str, exergy: float | None, entry: Mapping[str, Any]) -> None:
        if exergy is None:
            return
        share = f"{100.0 * exergy / whole:.2f}" if whole else ""
        entropy, energy, gas = (entry.get(key) for key in ("entropy_generated", "energy_moved", "gas_moved"))
        shown = (factor * exergy, None, entropy, None if energy is None else factor * energy, gas)
        cells = ["" if value is None else f"{value:.3g}" for value in shown]
        cells[0], cells[1] = f"{factor * exergy:.4g}", share
        table.add_row(words.get(name, name), *cells)

    row("total given by the gas" if given else "total at the shaft", whole, {})
    row(*(("power at the shaft", -shaft) if given else ("exergy rise of the gas", gas)), {})
    row("exergy rise of the oil", ledger["oil_exergy_rise"], {})
    for name, entry in sorted_entries(ledger):
        row(name, entry["exergy_destroyed"], entry)
    row("residual", ledger["residue"], {})
    table.caption = f"W/K: entropy generated; exergy at {engineering_temperature(ledger['ambient_temperature'])}"
    if any(entry["exergy_destroyed"] < -LEAST_SHOWN_LOSS * abs(whole) for _, entry in sorted_entries(ledger)):
        table.caption += "\nbelow zero: recovers exergy that other entries count as lost (M54, M286)"
    table.caption_justify = "left"
    return table


def _right_table(first: str, *others: str) -> Any:
    """Return an empty table: a column of names, then right-aligned columns of numbers."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column(first, overflow="fold")  # is narrowed before columns of numbers are
    for name in others:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def _print_knock_out(costs: Iterable[Mapping[str, Any]]) -> None:
    """Print the changes by leaving out each effect; these changes need not add up."""
    costs = list(costs)
    cooled = any(cost.get("cop") is not None for cost in costs)
    factor, unit = scale("W", max((abs(cost["shaft_power"] or 0.0) for cost in costs), default=0.0))
    columns = [("shaft_power", f"shaft power {unit}", factor), ("specific_work", "specific work kJ/kg", 1e-3)]
    columns += [("cop", "COP", 1.0)] * cooled
    rows, words = [], words_of_effects(cost["effect"] for cost in costs)
    for cost in costs:
        cells = [words[cost["effect"]]]
        for name, _, factor in columns:
            value, change = cost[name], cost[f"change_of_{name}"]
            cells += ["" if value is None else f"{factor * value:.4g}"]
            cells += ["" if change is None else f"{factor * change:+.3g}"]
        if cost["shaft_power"] is None:
            cells[1] = cost["status"].replace("_", " ")
        rows.append(cells)
    heads = ["left out", *(head for _, shown, _ in columns for head in (shown, "change"))]
    print_table(heads, rows, left=1)


def _knock_out_remarks(costs: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield one line on the effects without which there is no solution, and one on each other that leaves a doubt."""
    unsolved = grouped((cost["status"], cost["effect"]) for cost in costs if cost["shaft_power"] is None)
    if unsolved:
        told = "; ".join(f"{', '.join(names)} ({status.replace('_', ' ')})" for status, names in unsolved.items())
        yield f"no solution without {told}: run with --without NAME says why"
    for cost in costs:
        if cost["message"] and cost["shaft_power"] is not None:
            yield f"without {cost['effect']}: {cost['message']}"


def _remarks(result: Result) -> Iterable[str]:
    """Yield the lines below the figures, one subject each."""
    for reason, names in absent_figures(result.performance, result.notes).items():
        yield f"no {', '.join(names)}: {reason}"
    cooling, heating = (result.performance.get(name) for name in COPS)
    if cooling and heating and heating > cooling + 1.0 + MOTOR_HEAT:
        yield "heating COP, shaft power: the capacity has heat that is not in the shaft power, such as the motor's loss"
    yield from _knock_out_remarks(result.knock_out)
    if result.balance:
        balance = result.balance
        parts = [f"{name.replace('_', ' ')} {balance[name]:.1e}" for name in ("mass", "energy") if name in balance]
        text = f"balance: {', '.join(parts)} (bound {balance['bound']:.1e})"
        if balance.get("oil_mass") is not None:
            text += f", oil mass {balance['oil_mass']:.1e}"
        if balance.get("oil_residue") is not None:
            text += f"; oil residual {balance['oil_residue']:.3g} W (paper's transport of oil)"
        yield text
    if result.numerics:
        yield _numerics(result.numerics)
    if result.performance and not result.error:
        yield "error: not estimated, because the finer solution it needs did not close"


def _numerics(numerics: Mapping[str, Any]) -> str:
    words = [f"{numerics[name]}" for name in ("integrator", "closing") if name in numerics]
    words += [f"rtol {numerics['rtol']:.1e}"] if "rtol" in numerics else []
    counts = {"turns": "turns", "steps": "steps", "rhs_evaluations": "RHS evaluations", "jacobians": "Jacobians"}
    numbers = {text: round(numerics[name], 2) for name, text in counts.items() if name in numerics}
    words += [f"{number:.12g} {text if number != 1 else text.removesuffix('s')}" for text, number in numbers.items()]
    words += [f"{1e3 * numerics['wall_time']:.1f} ms"] if "wall_time" in numerics else []
    return f"numerics: {', '.join(words)}"
