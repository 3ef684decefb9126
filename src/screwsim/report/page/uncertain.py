"""The page's part on the tolerances of the inputs: the interval of each figure, and the inputs that contribute most."""

import json
from typing import Any

import numpy as np

from screwsim.figures.engineering import shown_name
from screwsim.report.page.pack import bytes_of, floats
from screwsim.results import Results
from screwsim.results.left_out import left_out_words, parts_left_out, short_label
from screwsim.results.schema import MODEL_ERROR
from screwsim.scene.model_errors import range_text
from screwsim.scene.types import COVERAGE

# shown with inputs
FIGURES_WITH_INPUTS = ("isothermal_efficiency", "isentropic_efficiency", "gas_mass_flow", "shaft_power", "cop")
NEGLIGIBLE = 1e-6  # of a figure: smaller intervals are ignored
MOST, LEAST = 3, 0.01  # number of inputs listed for a figure, their least share of its variance


def half_of(results: Results, name: str) -> np.ndarray:
    """Return half of the 95 % interval [SI] of a figure on the axes; NaN where it is unknown or negligible."""
    if name not in results.uncertainty:
        return np.full(results.shape, np.nan)
    half, size = COVERAGE * results.uncertainty[name], np.abs(results.performance[name])
    return np.where(half > NEGLIGIBLE * size, half, np.nan)


def half_text(half: float, value: float, written: tuple[str, str]) -> str:
    """Return half an interval in the unit in which the value is written; empty where there is none."""
    if not np.isfinite(half):
        return ""
    number, unit = written
    factor = 1.0 if unit.startswith("K") or not value else float(number) / value
    return f"± {half * factor:.2g}"


def _shares(results: Results, name: str) -> np.ndarray:
    """Return the share of each input in a figure's variance (cases, inputs); 0 for an input whose part is unknown."""
    square = np.square(np.nan_to_num(results.contributions[name]))
    total = square.sum(axis=-1, keepdims=True)
    return np.divide(square, total, out=np.zeros_like(square), where=total > 0.0)


def inputs_document(results: Results, part: tuple[slice, ...]) -> dict[str, Any] | None:
    """Return the names of the inputs, and their shares in some figures of the shown cases; None without any.

    `lost` says which inputs (cases, inputs) the sums of these cases leave out.
    """
    if "contributor" not in results.contributions:
        return None
    names = [name for name in FIGURES_WITH_INPUTS if name in results.contributions]
    labels = [short_label(label) for label in results.contributions["contributor"].tolist()]
    shares = [
        {"words": shown_name(name), "name": name, "shares": floats(_shares(results, name)[part].reshape(-1))}
        for name in names
        if np.isfinite(half_of(results, name)).any()
    ]
    lost = parts_left_out(results)[part].reshape(-1)
    return {"names": labels, "figures": shares, "lost": bytes_of(lost) if lost.any() else None}


def inputs_lines(results: Results, index: tuple[int, ...]) -> list[str]:
    """Return for one case which inputs contribute most to some figures, one line per figure; then those left out."""
    if "contributor" not in results.contributions:
        return []
    lines, labels = [], [short_label(label) for label in results.contributions["contributor"].tolist()]
    for name in FIGURES_WITH_INPUTS:
        if name not in results.contributions or not np.isfinite(half_of(results, name)[index]):
            continue
        shares = _shares(results, name)[index]
        ranked = [place for place in np.argsort(-shares, kind="stable")[:MOST] if shares[place] >= LEAST]
        lines.append(f"{shown_name(name)}: {', '.join(f'{labels[i]} {shares[i]:.0%}' for i in ranked)}")
    lost = left_out_words([labels[i] for i in np.flatnonzero(parts_left_out(results)[index])])
    return [*lines, f"All {lost}: the intervals are too small."] if lost else lines


def model_lines(results: Results) -> list[str]:
    """Return the model's error as found by the validation that the scene names; empty where it names none."""
    text = results.attributes.get(MODEL_ERROR)
    if not isinstance(text, str):
        return []
    told = json.loads(text)
    parts = []
    for name, each in told["figures"].items():
        held = each["held_out"]
        if name in results.performance and held is not None:
            kelvin = results.figure(name).units == "K"
            factor, unit = (1.0, "K") if kelvin else (100.0, "%" if each["relative"] else "points")
            parts.append(f"{shown_name(name)} {factor * held['low']:+.2g} … {factor * held['high']:+.2g} {unit}")
    where = f"({told['of']}: {told['citation']}), at {range_text(told['range'])}"
    return [
        f"Error of the model, computed minus measured: {', '.join(parts) or 'known for none of these figures'}.",
        f"By screwsim validate {where}; it is not added to anything.",
    ]
