"""Figure of the ledger: from the shaft power down to the useful exergy of the gas, or the reverse for an expander."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from screwsim.outputs import ledger_entries, words_of_effects
from screwsim.report.quantities import TEMPERATURE
from screwsim.report.style import COLOURS, DOUBLE, GREY, SMALL, note, plain_ticks, subplots
from screwsim.report.trace import best_case, case_title
from screwsim.results import Results

_LEAST = 1e-3  # of the shaft power: smaller entries are combined
_SHAFT, _LOSS, _GAIN, _OIL, _GAS = COLOURS[0], COLOURS[2], COLOURS[4], COLOURS[3], COLOURS[1]


class WaterfallBar(NamedTuple):
    """One bar of the waterfall: words, power [W] (positive: consumed), colour; `total` bars begin at zero."""

    words: str
    power: float
    colour: str
    total: bool = False


def plans(results: Results) -> Iterator[tuple[str, Any]]:
    """Yield the waterfall of the stored ledger, in a sweep that of its best case."""
    if "shaft_power" not in results.ledger or (index := best_case(results)) is None:
        return
    ledger = {name: float(results.ledger[name][index]) for name in results.ledger}
    if np.isfinite(whole := exergy_supplied(ledger)) and whole > 0.0:
        yield "shaft_power", partial(_draw, ledger, case_title(results, index))


def exergy_supplied(ledger: Mapping[str, float]) -> float:
    """Return the exergy supplied [W]: the shaft power, or for an expander the exergy given up by the gas."""
    return ledger["shaft_power"] if ledger["shaft_power"] > 0.0 else -ledger["gas_exergy_rise"]


def waterfall_bars(ledger: Mapping[str, float]) -> list[WaterfallBar]:
    """Return the bars from the shaft power to the gas: losses by size, small ones combined, then the oil's share.

    For an expander they lead from the gas to the shaft.
    """
    whole, shaft, gas = exergy_supplied(ledger), ledger["shaft_power"], ledger["gas_exergy_rise"]
    ends = (WaterfallBar("shaft power", shaft, _SHAFT, True), WaterfallBar("exergy rise of the gas", gas, _GAS, True))
    if shaft <= 0.0:
        ends = (
            WaterfallBar("exergy given by the gas", -gas, _GAS, True),
            WaterfallBar("power at the shaft", -shaft, _SHAFT, True),
        )
    losses = {name: entry["exergy_destroyed"] for name, entry in ledger_entries(ledger).items()}
    losses = {name: power for name, power in losses.items() if np.isfinite(power)}
    large = {name: power for name, power in losses.items() if abs(power) >= _LEAST * whole}
    small = [power for name, power in losses.items() if name not in large]
    found, words = [ends[0]], words_of_effects(losses)
    found += [_loss(words[name], large[name]) for name in sorted(large, key=lambda name: -large[name])]
    if abs(sum(small)) >= _LEAST * whole:
        found.append(_loss(f"others ({len(small)})", sum(small)))
    oil = ledger.get("oil_exergy_rise", np.nan)
    if np.isfinite(oil) and abs(oil) >= _LEAST * whole:
        found.append(WaterfallBar("exergy rise of the oil", oil, _OIL))
    return [*found, ends[1]]


def _loss(words: str, power: float) -> WaterfallBar:
    return WaterfallBar(words, power, _LOSS if power >= 0.0 else _GAIN)


def _draw(ledger: Mapping[str, float], title: str) -> Any:
    """Draw the waterfall: each bar begins where the one above ends; power and share are to the right."""
    bars = waterfall_bars(ledger)
    whole = exergy_supplied(ledger)
    factor, unit = (1e-3, "kW") if whole >= 1e3 else (1.0, "W")
    decimals = max(0, 3 - int(np.log10(whole * factor)))
    figure, axes = subplots(DOUBLE, 16.0 + 4.6 * len(bars))
    left = 0.0
    for row, bar in enumerate(bars):
        start = 0.0 if bar.total else left - bar.power
        axes.barh(row, bar.power * factor, left=start * factor, height=0.62, color=bar.colour, linewidth=0.0)
        end = bar.power if bar.total else start
        if row + 1 < len(bars):
            axes.plot([end * factor] * 2, [row + 0.31, row + 0.69], color=GREY, linewidth=0.5)
        left = end
        _cells(axes, row, f"{bar.power * factor:.{decimals}f}", f"{100.0 * bar.power / whole:.1f}")
    _cells(axes, -1.0, unit, "%")
    axes.set_yticks(range(len(bars)), [bar.words for bar in bars])
    axes.tick_params(axis="y", which="both", length=0.0)
    axes.set_ylim(len(bars) - 0.4, -0.6)
    axes.set_xlim(min(0.0, 1.05 * factor * min(bar.power for bar in bars if bar.total)), 1.02 * whole * factor)
    plain_ticks(axes.xaxis)
    axes.set_xlabel(f"exergy ({unit})")
    what = "the shaft power" if ledger["shaft_power"] > 0.0 else "the exergy given by the gas"
    ambient = f"what is left of {what}, exergy at {TEMPERATURE.of(ledger['ambient_temperature']):.2f} °C"
    green = "green: recovers what other entries count as lost" if any(bar.colour == _GAIN for bar in bars) else ""
    note(figure, title, ambient, f"residual {100.0 * ledger['residue'] / whole:.1g} %".replace("-", "−"), green)
    return figure


def _cells(axes: Any, row: float, *texts: str) -> None:
    """Write texts in columns to the right of the axes, at the height of a row."""
    for place, text in zip((1.075, 1.14), texts, strict=True):
        at = {"xycoords": ("axes fraction", "data"), "ha": "right", "va": "center", "fontsize": SMALL}
        axes.annotate(text.replace("-", "−"), (place, row), **at)
