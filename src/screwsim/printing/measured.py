"""Output on measured figures beside a scene's own, and on what would explain their differences."""

from collections.abc import Iterator

from screwsim.figures import declared
from screwsim.figures.engineering import difference_unit, reading_unit, shown_name
from screwsim.outputs import Result
from screwsim.printing.tables import plain_table, print_table, print_text, print_wrapped
from screwsim.scene import Scene
from screwsim.scene.types import COVERAGE
from screwsim.screen import say
from screwsim.study.asked.inputs import shown_number, shown_value, unit_of_change
from screwsim.study.asked.varied import Varied
from screwsim.study.uncertainty.measured import AGREEMENT_LIMIT, ComparedFigure, Comparison, Explanation
from screwsim.study.uncertainty.spreads import tolerances_of


def print_measured(scene: Varied, result: Result, found: Comparison) -> None:
    """Print figures, measured values and differences, with the uncertainties of ours below each; then explanations."""
    say()
    if found.rows:
        heads = ("figure", "ours", "measured", "unit", "difference", "sigma")
        table, count = plain_table(heads, [_row(result, row) for row in found.rows], 1), len(found.rows)
        say("\n".join(table[:-count]))
        for line, row in zip(table[-count:], found.rows, strict=True):
            say(line)
            print_text(f"    {_uncertainty_parts(scene, result, row)}")
    for name, why in found.none.items():
        print_text(f"no {shown_name(name)} to compare: {why}")
    if found.rows:
        print_wrapped(_verdict(scene, found))
    if found.why and found.why != "nothing to explain":
        print_text(found.why)
    if found.explanations:
        say()
        _print_explanations(scene, found)
    print_wrapped(f"no explanation: {path} {why}" for path, why in found.dismissed.items())


def _row(result: Result, row: ComparedFigure) -> list[str]:
    factor, unit, zero = reading_unit(declared(row.figure, result.performance), row.value)
    value = row.measured.value
    measured = f"{factor * value - zero:.5g}"
    if row.measured.standard is not None:
        measured += f" ± {factor * COVERAGE * row.measured.standard:.2g}"
    share = f" ({100.0 * row.off / value:+.2g} %)" if value and unit not in ("%", "°C") else ""
    sigma = "–" if row.sigma is None else f"{row.sigma:+.1f}"
    ours = f"{factor * row.value - zero:.5g}"
    return [shown_name(row.figure), ours, measured, unit, f"{factor * row.off:+.3g}{share}", sigma]


def _uncertainty_parts(scene: Varied, result: Result, row: ComparedFigure) -> str:
    """Return the three uncertainties of the scene's own figure, separately."""
    factor, unit = difference_unit(declared(row.figure, result.performance), row.value)
    inputs = f"inputs ± {factor * COVERAGE * row.inputs:.2g}" if tolerances_of(scene).uncertain else "inputs not stated"
    model = "model not stated"
    if row.model is not None:
        model = "model " + " … ".join(f"{factor * end:+.2g}" for end in row.model)
    return f"ours: numerical ± {factor * COVERAGE * row.numerical:.1g}, {inputs}, {model} {unit}".rstrip()


def _verdict(scene: Varied, found: Comparison) -> Iterator[str]:
    """Yield what the differences show, and which missing information would show more."""
    far = [row for row in found.rows if row.sigma is not None and abs(row.sigma) > AGREEMENT_LIMIT]
    bare = [row for row in found.rows if row.sigma is None]
    if far:
        told = (shown_name(row.figure) + (" (within the model's error)" if row.within_model else "") for row in far)
        yield f"differ by more than {AGREEMENT_LIMIT:g} sigma: {', '.join(told)}"
    elif not bare:
        yield f"agree: no difference beyond {AGREEMENT_LIMIT:g} sigma"
    if bare:
        names = ", ".join(shown_name(row.figure) for row in bare)
        yield (
            f"no sigma for {names}: state the uncertainty of the measurement as half of the 95 % interval ('132 kW "
            f"± 2 kW') or as one standard uncertainty ('132 kW ± 1 kW (k=1)')"
        )
    if far or not bare:
        yield (
            "sigma: difference over the combined standard uncertainty of measurement, inputs and numerics; each ± is "
            "two standard uncertainties (k=2), half of a 95 % interval"
        )
    missing = [] if tolerances_of(scene).uncertain else ["tolerances of inputs (gap: 27 um ± 5 um)"]
    if isinstance(scene, Scene) and any(row.model is None for row in found.rows):  # two stages have none
        missing.append("a validation that gives the model's error (uncertainty: {model: NAME})")
    if missing:
        yield f"not stated in the scene: {', '.join(missing)}"


def _print_explanations(scene: Varied, found: Comparison) -> None:
    shown = {each.path: each.solved for each in found.explanations if each.solved is not None}
    tolerant = any(each.tolerances is not None for each in found.explanations)
    heads = ["alone would explain it", "is", "would be", "change", *["of tolerance"] * tolerant, "leaves"]
    rows = []
    for each in found.explanations[: len(shown)]:
        now = shown_number(scene, each.path, each.value)
        cells = [each.path, now, shown_value(scene, each.path, each.wanted, 4), _change(scene, each)]
        if tolerant:
            cells.append("" if each.tolerances is None else f"{each.tolerances:+.2g}")
        rows.append([*cells, f"{100.0 * shown[each.path]:.0f} %"])
    if not rows:  # those that were solved are all dismissed
        print_text(f"{len(found.explanations)} would explain it alone by derivatives, not solved (--json)")
        return
    print_table(heads, rows, 1)
    more = len(found.explanations) - len(shown)
    lines = [f"and {more} more by derivatives alone (--json)"] if more > 0 else []
    by = "their standard uncertainties" if found.weighted else "what was measured"
    lines.append(f"leaves: share of the squared differences over {by} that remains when the scene is solved there")
    print_text("; ".join(lines))


def _change(scene: Varied, each: Explanation) -> str:
    """Return by how much a number would have to change: in per cent, for temperatures in kelvin."""
    if unit_of_change(scene, each.path, each.value)[1] == "K":
        return f"{each.wanted - each.value:+.2g} K"
    return f"{100.0 * (each.wanted / each.value - 1.0):+.2g} %"
