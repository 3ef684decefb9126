"""Figure of the gas torque over two lobe pitches, and of its harmonics of the lobe frequency."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from screwsim.report.quantities import ANGLE
from screwsim.report.style import COLOURS, GREY, SINGLE, SMALL, new_figure, note, plain_ticks
from screwsim.report.trace import Trace, chosen_trace
from screwsim.results import Results

_HARMONICS = 10
_FINE = 720  # points of a pitch for the spectrum


def plans(results: Results) -> Iterator[tuple[str, Any]]:
    """Yield the torque of the stored cycle, in a sweep that of its best case."""
    trace = chosen_trace(results)
    if trace is None or "machine_male_lobes" not in results.inputs:
        return
    torque = trace.values.get("gas_torque")
    if torque is not None and np.isfinite(torque).all():
        yield "gas_torque", partial(_draw, trace, 360.0 / float(results.inputs["machine_male_lobes"]))


def spectrum(angle: np.ndarray, torque: np.ndarray, pitch: float) -> np.ndarray:
    """Return the amplitudes [N m] of the harmonics 0 (the mean), 1, 2 … of a torque over the angle [degree] (M147)."""
    curve = np.interp(np.arange(_FINE) * pitch / _FINE, angle, torque)
    amplitudes = np.abs(np.fft.rfft(curve))[: _HARMONICS + 1] / _FINE
    return np.concatenate([amplitudes[:1], 2.0 * amplitudes[1:]])


def _draw(trace: Trace, pitch: float) -> Any:
    from matplotlib.ticker import MultipleLocator

    figure = new_figure(SINGLE, 96.0)
    upper, lower = figure.subplots(2, 1)
    torque = trace.values["gas_torque"]
    shown = trace.angle <= 2.0 * pitch + 1e-9
    amplitudes = spectrum(trace.angle, torque, pitch)
    mean = float(amplitudes[0])
    upper.plot(trace.angle[shown], torque[shown], color=COLOURS[0])
    upper.axhline(mean, color=GREY, linewidth=0.5, linestyle=(0, (6, 3)), zorder=1)
    upper.annotate("mean", (1.02, mean), xycoords=("axes fraction", "data"), va="center", fontsize=SMALL)
    upper.set_xlim(0.0, 2.0 * pitch)
    upper.xaxis.set_major_locator(MultipleLocator(30.0))
    upper.set_ylim(min(0.0, 1.06 * float(torque.min())), max(0.0, 1.06 * float(torque.max())))
    upper.set(xlabel=ANGLE.label, ylabel="gas torque $M$ (N m)")
    order = np.arange(1, _HARMONICS + 1)
    lower.bar(order, amplitudes[1:], width=0.5, color=COLOURS[1], linewidth=0.0)
    lower.set_xticks(order)
    lower.tick_params(axis="x", which="both", length=0.0)
    lower.set(xlabel="multiple of the lobe frequency", ylabel="amplitude $M_k$ (N m)")
    plain_ticks(upper.yaxis, lower.yaxis, most=6)
    note(figure, trace.title)
    return figure
