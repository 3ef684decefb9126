"""Two stages as text: the figures of the whole chain, then those of each stage."""

from __future__ import annotations

from typing import TYPE_CHECKING

from screwsim.figures.engineering import engineering, shown_name
from screwsim.outputs import EFFICIENCY, STAGES
from screwsim.outputs.customary import engineering_temperature, quantity, small_number_text
from screwsim.printing.tables import absent_figures, print_scene_title, print_text, print_wrapped
from screwsim.printing.uncertain import print_uncertainty
from screwsim.screen import say
from screwsim.study.stages.axes import STAGE_NAMES

if TYPE_CHECKING:
    from screwsim.study.stages import ChainResult

STAGE_FIGURES = (
    "gas_mass_flow",
    "shaft_power",
    "volumetric_efficiency",
    "isentropic_efficiency",
    "discharge_temperature",
)


def print_stages(title: str, found: ChainResult) -> None:
    """Print the figures of a chain, and some figures of both stages."""
    print_scene_title(title)
    print_text(f"status: {found.status}" + (f"; {found.message}" if found.message else ""))
    print_wrapped(f"warning: {warning}" for warning in found.as_result().warnings)
    if found.error:
        say(" " * 54 + "error")
    for name, value in found.performance.items():
        if value is not None:
            error = small_number_text(found.error.get(name)) if found.error else ""
            say(f"{shown_name(name):<32}{_figure_cell(name, value):<22}{error}".rstrip())
    for reason, names in absent_figures(found.performance, found.notes).items():
        print_text(f"no {', '.join(names)}: {reason}")
    for which, result in zip(STAGE_NAMES, found.stages, strict=False):
        if result.performance:
            figures = ((name, result.performance[name]) for name in STAGE_FIGURES)
            told = ((name, " ".join(engineering(name, value))) for name, value in figures if value is not None)
            words = [f"{shown_name(name)} {text}".rstrip() for name, text in told]
            print_text(f"{which} stage: {', '.join(words)}")
    if found.uncertainty:
        print_uncertainty(found.as_result())


def _figure_cell(name: str, value: float) -> str:
    about = STAGES[name]
    if about.units == "K":
        return engineering_temperature(value)
    if about.units != "1":
        return quantity(about.shown or about.units, value)
    return f"{100.0 * value:.4g} %" if about.scale == EFFICIENCY else f"{value:.4g}"
