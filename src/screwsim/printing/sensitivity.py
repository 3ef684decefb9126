"""What `screwsim sensitivity` prints and writes."""

from pathlib import Path
from typing import Any

from screwsim.figures import declared
from screwsim.printing import engineering, shown_name
from screwsim.printing.tables import plain_table, say_title, wrapped
from screwsim.scene import Scene
from screwsim.screen import say
from screwsim.study.columns import Column, write_columns
from screwsim.study.inputs import shown_value
from screwsim.study.sensitivity import CONFIDENCE, NOISY, Sensitivity, Shares


def sensitivity_document(scene: Scene, found: Sensitivity) -> dict[str, Any]:
    """Return what `sensitivity --json` prints."""
    return {
        "title": scene.title,
        "ranges": {each.path: [each.low, each.high] for each in found.ranges},
        "samples": found.samples,
        "seed": found.seed,
        "solutions": found.solutions,
        "failed": found.failed,
        "message": found.message,
        "warnings": [{"solutions": count, "warning": text} for count, text in found.warnings],
        "confidence": CONFIDENCE,
        "figures": {
            each.figure: {
                "mean": each.mean,
                "standard_deviation": each.deviation,
                "noise": each.noise,
                "message": each.message,
                "indices": {index.path: index._asdict() for index in each.indices},
            }
            for each in found.shares
        },
    }


def print_sensitivity(scene: Scene, found: Sensitivity) -> None:
    """Print a table a figure: the inputs with the largest total index first."""
    say_title(scene.title)
    samples = f"{found.samples} samples of {len(found.ranges)} inputs, seed {found.seed}"
    say(wrapped(f"{found.solutions} solutions: {samples}"))
    if found.message:
        say(wrapped(found.message))
    for count, text in found.warnings:
        say(wrapped(f"warning in {count} of {found.solutions} solutions: {text}"))
    spans = {each.path: each for each in found.ranges}
    for shares in found.shares:
        say()
        say(wrapped(_head(shares)))
        if not shares.indices:
            continue
        rows = []
        for index in sorted(shares.indices, key=lambda index: -index.total):
            low, high = (shown_value(scene, index.path, end, 4) for end in spans[index.path][1:])
            first = f"{index.first:.3f} ± {index.first_confidence:.3f}"
            total = f"{index.total:.3f} ± {index.total_confidence:.3f}"
            rows.append([index.path, f"{low} … {high}", first, total])
        say("\n".join(plain_table(["", "range", "first order", "total"], rows, 1)))
    if any(shares.indices for shares in found.shares):
        say()
        text = f"shares of the variance, ± half the {CONFIDENCE:.0%} confidence interval; total less first order: "
        say(wrapped(text + "what an input does together with others"))


def _head(shares: Shares) -> str:
    name = shown_name(shares.figure)
    if shares.mean is None or shares.deviation is None:
        return f"{name}: {shares.message}"
    mean, unit = engineering(shares.figure, shares.mean)
    if shares.message:
        return f"{name}: {mean} {unit}, {shares.message}"
    factor = float(mean) / shares.mean if shares.mean and declared(shares.figure).units != "K" else 1.0
    text = f"{name}: mean {mean} {unit}, standard deviation {factor * shares.deviation:.2g} {unit.partition(' ')[0]}"
    if shares.noise is not None and shares.noise > NOISY:
        text += f"; numerical errors may make {shares.noise:.0%} of the variance (tighten numerics.accuracy)"
    return text


def write_sensitivity(path: Path, found: Sensitivity) -> None:
    """Write a row a figure and input: CSV or HDF5."""
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
