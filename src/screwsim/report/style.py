"""Appearance of the figures: sizes, fonts, colours and line styles as in a printed journal; and writing them.

No global state of matplotlib is used or left changed, and a reader's own matplotlibrc has no effect.
"""

import re
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from screwsim.outputs.customary import with_printed_units
from screwsim.report.quantities import short
from screwsim.results.atomic import make_folder, replacing

MM = 1.0 / 25.4  # [inch]
SINGLE, DOUBLE = 88.0, 180.0  # [mm] width of one and of two columns
SMALL = 7.0  # [pt] notes and direct labels
DPI = 200.0
LONGEST_LABEL = 32  # letters of a label that fits beside a panel of a figure with several
GREY = "#6e6e6e"  # guides: lines that are not data
WHITE_BOX = {"frameon": True, "facecolor": "white", "edgecolor": "none", "framealpha": 1.0}  # of a legend over curves

# Colours by descending contrast, distinguishable in black-and-white print and with any colour vision.
COLOURS = ("#000000", "#3b2a8c", "#a01f62", "#c2561a", "#3f9e72", "#62b0dc")
_GAPS = ((5, 1.6), (5, 1.5, 1.2, 1.5), (1.2, 1.3), (9, 2), (3, 1, 1, 1, 1, 1))
DASHES: tuple[Any, ...] = ("-", *((0, gaps) for gaps in _GAPS))

_TICKS = {
    "labelsize": 7.5,
    "direction": "in",
    "major.size": 3.0,
    "minor.size": 1.6,
    "major.width": 0.6,
    "minor.width": 0.4,
}
_RC = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with matplotlib: the same figure on each machine
    "mathtext.fontset": "dejavusans",
    "font.size": 8.0,
    "axes.labelsize": 8.0,
    "axes.titlesize": 8.0,
    "legend.fontsize": SMALL,
    "figure.titlesize": SMALL,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 4.0,
    "patch.linewidth": 0.6,
    "xtick.top": True,
    "ytick.right": True,
    "legend.frameon": False,
    "legend.handlelength": 2.4,
    "legend.borderaxespad": 0.3,
    "legend.borderpad": 0.1,
    "axes.formatter.useoffset": False,
    "axes.unicode_minus": True,
    "savefig.dpi": DPI,
    "pdf.fonttype": 42,
    "figure.constrained_layout.h_pad": 0.03,
    "figure.constrained_layout.w_pad": 0.03,
    **{f"{axis}tick.{name}": value for axis in "xy" for name, value in _TICKS.items()},
}
_FORMATS: dict[str, dict[str, Any]] = {  # no time of writing: the same data give the same bytes
    "png": {"Software": None},
    "pdf": {"Creator": "screwsim", "Producer": None, "CreationDate": None},
}


@contextmanager
def journal() -> Iterator[None]:
    """Draw and write inside this context; the caller's settings are restored after it."""
    from matplotlib import style

    with style.context(["default", _RC]):
        yield


def new_figure(width: float, height: float, layout: Any = "constrained") -> Any:
    """Return an empty figure of a given size [mm] on its own canvas; with the layout "none" all places are given."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width * MM, height * MM), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def write(figure: Any, folder: Path, name: str) -> list[str]:
    """Write a figure as PNG and PDF and return the paths; raise UsageError in one line when the system refuses."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_pdf import FigureCanvasPdf

    written = []
    figure.set_dpi(DPI)
    layout = figure.get_layout_engine()
    if layout is not None:
        layout.execute(figure)  # once, so that all formats look alike; `savefig` would draw the figure twice for each
        figure.set_layout_engine("none")
    for form, metadata in _FORMATS.items():
        path = folder / f"{name}.{form}"
        with replacing(path) as temporary, temporary.open("wb") as file:
            if form == "png":
                FigureCanvasAgg(figure).print_png(file, metadata=metadata)
            else:
                FigureCanvasPdf(figure).print_pdf(file, metadata=metadata)
        written.append(str(path))
    return written


def write_all(plans: Mapping[str, Callable[[], Any]], folder: str | Path) -> list[str]:
    """Draw figures and write each under its name into a folder, which is created if missing; return the paths."""
    target, written = Path(folder), []
    make_folder(target)
    for name, draw in plans.items():
        with journal():
            written += write(draw(), target, name)
    return written


def subplots(width: float, height: float, *places: int, **options: Any) -> tuple[Any, Any]:
    """Return a figure of a given size [mm] and its axes, as `pyplot.subplots` does for a number of rows and columns."""
    figure = new_figure(width, height)
    return figure, figure.subplots(*places, **options)


def panels(
    count: int, above: float, row: float, columns: int = 2, width: float = DOUBLE, **options: Any
) -> tuple[Any, list[Any]]:
    """Return a figure and its `count` axes in rows of `columns`, each `row` [mm] high, and `above` [mm] more."""
    rows = -(-count // columns)
    figure, places = subplots(width, above + row * rows, rows, columns, squeeze=False, **options)
    for axes in places.flat[count:]:
        axes.remove()
    return figure, list(places.flat[:count])


def upright(label: str) -> str:
    """Return the label of a vertical axis, its unit on a second line where one line would be longer than the axis."""
    words, _, unit = label.partition(" (")
    long = len(re.sub(r"\$.*?\$", "xx", label)) > LONGEST_LABEL
    return f"{words}\n({unit}" if unit and long else label


def angle_axis(axes: Any, first: float, last: float, marks: Iterable[float] = (), major: float = 120.0) -> None:
    """Give an axis of angles [degree] its ends and ticks, and draw dotted lines at the marked angles."""
    from matplotlib.ticker import AutoMinorLocator, MultipleLocator

    axes.set_xlim(first, last)
    axes.xaxis.set_major_locator(MultipleLocator(major))
    axes.xaxis.set_minor_locator(AutoMinorLocator(4))
    for angle in marks:
        axes.axvline(angle, color=GREY, linewidth=0.5, linestyle=(0, (1, 2)), zorder=1)


def name_above(axes: Any, at: float, text: str, side: str = "center") -> None:
    """Write the name of a place on the x axis above the axes."""
    axes.annotate(text, (at, 1.02), xycoords=("data", "axes fraction"), ha=side, va="bottom", fontsize=SMALL)


def level(axes: Any, height: float, text: str) -> None:
    """Draw a dashed line across the axes at a height, with its name to the right; once, whoever asks again."""
    if any(there.get_text() == text and there.xy == (1.02, height) for there in axes.texts if hasattr(there, "xy")):
        return
    axes.axhline(height, color=GREY, linewidth=0.5, linestyle=(0, (6, 3)), zorder=1)
    axes.annotate(text, (1.02, height), xycoords=("axes fraction", "data"), va="center", fontsize=SMALL)


def look_in_space(axes: Any, most: int) -> None:
    """Give three-dimensional axes ticks at round numbers and a pale grid."""
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        plain_ticks(axis, most=most)
        axis._axinfo["grid"].update(color="#dddddd", linewidth=0.4)  # matplotlib has no public way for a single figure


def note(figure: Any, *parts: str, share: float = 1.0) -> None:
    """Write the non-empty parts above the figure, in lines that fit a share of its width."""
    text = "; ".join(part for part in parts if part)
    if not text:
        return
    columns = int(share * figure.get_figwidth() * 72.0 / (0.56 * SMALL)) - 2  # 0.56 em: mean width of a letter
    figure.suptitle("\n".join(textwrap.wrap(with_printed_units(text), columns)), x=0.01, ha="left", linespacing=1.25)


def plain_ticks(*axes: Any, most: int = 7) -> None:
    """Put ticks of linear axes at round numbers (1, 2, 5), with minor ticks between."""
    from matplotlib.ticker import AutoMinorLocator, MaxNLocator

    for axis in axes:
        axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 5, 10]))
        axis.set_minor_locator(AutoMinorLocator())


def log_scale(axes: Any, ratio: float, which: str = "x") -> None:
    """Make x or y logarithmic with plain numbers at 1, 2, 5, or at powers of ten if the range is wide."""
    import numpy as np
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis = getattr(axes, f"{which}axis")
    getattr(axes, f"set_{which}scale")("log")
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if ratio < 300.0 else (1.0,), numticks=20))
    axis.set_major_formatter(FuncFormatter(lambda value, _: short(value)))
    axis.set_minor_locator(LogLocator(subs=tuple(np.arange(1.0, 10.0)), numticks=20))
    axis.set_minor_formatter(NullFormatter())


def line_style(index: int, count: int) -> dict[str, Any]:
    """Return colour and dashes of one of several ordered curves, the first being the darkest."""
    from matplotlib import colormaps

    if count <= len(COLOURS):
        return {"color": COLOURS[index], "linestyle": DASHES[index]}
    colour = colormaps["inferno"](0.05 + 0.75 * index / (count - 1))  # even steps of luminance; the end is too pale
    return {"color": colour, "linestyle": DASHES[index % len(DASHES)]}
