"""Output of `screwsim sensitivity`, printed and written: indices over ranges, or with `--local` derivatives."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from screwsim.figures import declared
from screwsim.figures.engineering import difference_unit, figure_text, shown_name
from screwsim.inputs.suggestions import counted
from screwsim.inputs.workbooks import TABLES
from screwsim.outputs.derivatives import DIFFERENCES, PACKAGE_FIGURES
from screwsim.outputs.display import grouped, picked
from screwsim.printing.tables import print_scene_title, print_table, print_text, print_wrapped
from screwsim.results.write import save
from screwsim.scene import Scene
from screwsim.screen import say
from screwsim.study.asked.inputs import WITHOUT_ZERO, shown_range, shown_value, unit_of_change, usual_efficiency
from screwsim.study.asked.varied import Varied, leaf_of
from screwsim.study.columns import Column, write_columns
from screwsim.study.uncertainty.slopes import Sensitivities
from screwsim.study.uncertainty.sobol import CONFIDENCE, LARGEST_NOISE_SHARE, FigureIndices, Sensitivity

USUAL_FIGURES = ("gas_mass_flow", "shaft_power")  # beside the efficiency, of a machine that is no air package
MOST_NUMBERS = 15  # most numbers in the table, in order of importance
LEAST_SENSITIVITY = 5e-5  # per cent per per cent, below which a figure is independent of a number
ROUND_CHANGES = (1.0, 2.0, 5.0)  # of a power of ten: changes of a number in sentences


def sensitivity_document(scene: Varied, found: Sensitivity) -> dict[str, Any]:
    """Return what `sensitivity --json` prints."""
    return {
        "title": scene.title,
        "ranges": {each.path: [each.low, each.high] for each in found.ranges},
        **picked(found, "samples", "seed", "solutions", "failed", "message"),
        "warnings": [{"solutions": count, "warning": text} for count, text in found.warnings],
        "confidence": CONFIDENCE,
        "figures": {
            share.figure: {
                **picked(share, "mean", standard_deviation="deviation"),
                **picked(share, "noise", "message"),
                "indices": {index.path: index._asdict() for index in share.indices},
            }
            for share in found.shares
        },
    }


def print_sensitivity(scene: Varied, found: Sensitivity, changed: Sequence[str] = ()) -> None:
    """Print one table per figure, with inputs of the largest total index first."""
    print_scene_title(scene.title, changed)
    samples = f"{found.samples} samples of {counted(len(found.ranges), 'input')}, seed {found.seed}"
    print_text(f"{found.solutions} solutions: {samples}")
    if found.message:
        print_text(found.message)
    print_wrapped(f"warning in {count} of {found.solutions} solutions: {text}" for count, text in found.warnings)
    spans = {each.path: each for each in found.ranges}
    for shares in found.shares:
        say()
        print_text(_head(shares))
        if not shares.indices:
            continue
        rows = []
        for index in sorted(shares.indices, key=lambda index: -index.total):
            span = spans[index.path]
            first = f"{index.first:.3f} ± {index.first_confidence:.3f}"
            total = f"{index.total:.3f} ± {index.total_confidence:.3f}"
            rows.append([index.path, shown_range(scene, index.path, span.low, span.high, digits=4), first, total])
        print_table(["", "range", "first order", "total"], rows, 1)
    if any(shares.indices for shares in found.shares):
        say()
        text = f"shares of the variance, ± half the {CONFIDENCE:.0%} confidence interval; total less first order: "
        print_text(text + "the effect of an input jointly with others")


def _head(shares: FigureIndices) -> str:
    name = shown_name(shares.figure)
    if shares.mean is None or shares.deviation is None:
        return f"{name}: {shares.message}"
    mean = figure_text(shares.figure, shares.mean)
    if shares.message:
        return f"{name}: {mean}, {shares.message}"
    factor, unit = difference_unit(declared(shares.figure), shares.mean)
    deviation = f"{factor * shares.deviation:.2g} {unit}".rstrip()
    text = f"{name}: mean {mean}, standard deviation {deviation}"
    if shares.noise is not None and shares.noise > LARGEST_NOISE_SHARE:
        text += f"; numerical errors may cause {shares.noise:.0%} of the variance (tighten numerics.accuracy)"
    return text


def write_sensitivity(path: Path, found: Sensitivity) -> None:
    """Write one row per figure and input, as CSV or HDF5."""
    rows = [(shares, index) for shares in found.shares for index in shares.indices]
    columns = {
        "figure": Column([shares.figure for shares, _ in rows], "", "figure"),
        "path": Column([index.path for _, index in rows], "", "input"),
        "first_order": Column([index.first for _, index in rows], "1", "Sobol index of first order"),
        "first_order_confidence": Column([index.first_confidence for _, index in rows], "1", "half its interval"),
        "total": Column([index.total for _, index in rows], "1", "total Sobol index"),
        "total_confidence": Column([index.total_confidence for _, index in rows], "1", "half its interval"),
    }
    write_columns(path, "Sobol indices", columns)


def local_document(scene: Varied, found: Sensitivities) -> dict[str, Any]:
    """Return what `sensitivity --local --json` prints."""
    return {
        "title": scene.title,
        **picked(found.result, "status", "message", "warnings"),
        "values": dict(found.values),
        "performance": {name: found.result.performance[name] for name in found.derivatives},
        **picked(found, "method", "why", "left_out"),
        "derivatives": {name: dict(slopes) for name, slopes in found.derivatives.items()},
        "relative": {name: {path: found.relative(name, path) for path in by} for name, by in found.derivatives.items()},
    }


def print_local(scene: Varied, found: Sensitivities, chosen: Sequence[str] = (), changed: Sequence[str] = ()) -> None:
    """Print a table of numbers by figures [%/%, or % per K or degree], the most important first, some in words."""
    print_scene_title(scene.title, changed)
    if found.result.status != "ok":
        print_text(f"status: {found.result.status}; {found.result.message}")
    print_wrapped(f"warning: {warning}" for warning in found.result.warnings)
    if found.result.status != "ok":
        return
    package = set(PACKAGE_FIGURES) <= set(found.derivatives)
    wanted = chosen or (PACKAGE_FIGURES if package else (usual_efficiency(scene), *USUAL_FIGURES))
    figures = [name for name in wanted if name in found.derivatives]
    steps = {path: _step(scene, path, value) for path, value in found.values.items()}
    sizes = {path: [_percent_by(found, name, path, step) for name in figures] for path, (step, _) in steps.items()}
    ranked = sorted(found.values, key=lambda path: -max((abs(each) for each in sizes[path] if each), default=0.0))
    felt = [path for path in ranked if any(each is not None and abs(each) >= LEAST_SENSITIVITY for each in sizes[path])]
    rows = [
        [
            f"{path} *" if found.method[path] == DIFFERENCES else path,
            shown_value(scene, path, found.values[path], 4),
            steps[path][1],
            *map(_percent, sizes[path]),
        ]
        for path in felt[:MOST_NUMBERS]
    ]
    say("change of a figure, in percent per percent of a number, K or degree")
    print_table(["", "value", "per", *map(shown_name, figures)], rows, 1)
    if len(felt) > MOST_NUMBERS:
        print_text(f"and {len(felt) - MOST_NUMBERS} more with less effect (--json lists all)")
    zero = [path for path, (step, _) in steps.items() if step == 0.0]
    if zero:
        print_text(f"no percentage of a number that is 0 (--json lists its derivatives): {', '.join(zero)}")
    if idle := len(found.values) - len(felt) - len(zero):
        print_text(f"{idle} of {len(found.values)} numbers change none of these figures")
    say()
    print_wrapped(effect_sentence(scene, found, figures[0], path) for path in felt[:3])
    _print_methods(found)


def _step(scene: Varied, path: str, value: float) -> tuple[float, str]:
    """Return the change [SI] of a number that the table is for, and its text: 1 %, 1 K of temperatures, 1 degree."""
    kind = leaf_of(scene, path).dimension
    if kind is None or kind.name not in WITHOUT_ZERO:
        return 0.01 * value, "1 %"
    per, unit = unit_of_change(scene, path, value)
    return 1.0 / per, f"1 {unit}"


def _percent_by(found: Sensitivities, figure: str, path: str, step: float) -> float | None:
    """Return the change [%] of a figure by a step [SI] of a number; None where either is zero or missing."""
    slope, value = found.derivatives[figure].get(path), found.result.performance.get(figure)
    return None if slope is None or not value or not step else 100.0 * slope * step / value


def _print_methods(found: Sensitivities) -> None:
    """Print the method of derivatives that are not exact, and what was left out."""
    for why, paths in grouped((why, path) for path, why in found.why.items()).items():
        which = "all" if len(paths) == len(found.values) else ", ".join(paths)
        print_text(f"* {which}: from differences of closed cycles, because {why}")
    if found.left_out:
        by_why = grouped((why, path) for path, why in found.left_out.items())
        told = "; ".join(f"{', '.join(paths)} ({why})" for why, paths in by_why.items())
        print_text(f"left out: {told}")


def effect_sentence(scene: Varied, found: Sensitivities, figure: str, path: str) -> str:
    """Return in words the effect of a round change of a number on a figure: '1 um … = -0.14 points of …'."""
    change, shown = _round_change(scene, path, found.values[path])
    slope, value = found.derivatives[figure][path], found.result.performance[figure]
    factor, unit = difference_unit(declared(figure, found.result.performance), value or 0.0)
    return f"{shown} of {path} = {factor * slope * change:+.2g} {unit} of {shown_name(figure)}".replace("  ", " ")


def _round_change(scene: Varied, path: str, value: float) -> tuple[float, str]:
    """Return a round change [SI] of about a twentieth of a number, and its text."""
    kind = leaf_of(scene, path).dimension
    per, unit = unit_of_change(scene, path, value)
    if kind is not None and kind.name in WITHOUT_ZERO:
        return 1.0 / per, f"1 {unit}"
    about = abs(value * per) / 20.0 or 1.0
    power = 10.0 ** int(f"{about:e}".partition("e")[2])
    size = max((each * power for each in ROUND_CHANGES if each * power <= about * 1.0001), default=power)
    return size / per, f"{size:g} {unit}".strip()


def _percent(value: float | None) -> str:
    return "" if value is None else "0" if abs(value) < LEAST_SENSITIVITY else f"{value:+.3g}"


def write_local(path: Path, scene: Varied, found: Sensitivities) -> None:
    """Write one row per figure and number as a table; of a scene as HDF5 the results, with a group of derivatives."""
    if path.suffix.lower() not in TABLES and isinstance(scene, Scene):
        save(path, scene, found.result, "sensitivity --local", found)
        return
    rows = [(figure, number, slope) for figure, slopes in found.derivatives.items() for number, slope in slopes.items()]
    performance = found.result.performance
    meaning = "derivative of the figure by the number, SI unit over SI unit"
    columns = {
        "figure": Column([figure for figure, _, _ in rows], "", "figure"),
        "path": Column([number for _, number, _ in rows], "", "number of the scene"),
        "value": Column([performance[figure] for figure, _, _ in rows], "1", "the figure, SI unit"),
        "number": Column([found.values[number] for _, number, _ in rows], "1", "the number, SI unit"),
        "derivative": Column([slope for _, _, slope in rows], "1", meaning),
        "relative": Column([found.relative(figure, number) for figure, number, _ in rows], "1", "percent per percent"),
        "method": Column([found.method[number] for _, number, _ in rows], "", "exact, quick, or differences"),
    }
    write_columns(path, "local sensitivities", columns)
