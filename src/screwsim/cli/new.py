"""The command for a new scene: complete, commented and realistic, to be edited by hand."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from screwsim.cli.declare import File, Text, argument, option, switch
from screwsim.cli.options import check_new
from screwsim.inputs.faults import UsageError
from screwsim.screen import say

if TYPE_CHECKING:
    from screwsim.template import SceneRequest


def new(
    kind: Text = argument("KIND", "refrigeration, heat_pump, air, booster (any gas), expander or reciprocating.", None),
    fluid: Text = option("NAME", "Working fluid (default: that of the kind)."),
    displacement: Text = option(
        "FLOW", "Swept volume flow at the speed, e.g. '600 m^3/h' (default: that of the kind)."
    ),
    diameter: Text = option("LENGTH", "Male rotor diameter, instead of --displacement, e.g. '204 mm'."),
    vi: float | None = option("RATIO", "Built-in volume ratio (default: by the pressure ratio)."),
    speed: Text = option("SPEED", "Speed of the male rotor or crank (default: 2950 rpm)."),
    oil: Text = option("NAME", "A stored oil, e.g. POE_68, mineral_46 (default: the fluid's)."),
    condition: Text = option(
        "LOW/HIGH",
        "Operating condition, e.g. '0/40 degC, 10 K' (superheat), '1 bar/7.5 bar(g)', '20/7 bar, 100 degC' (inlet).",
    ),
    motor: Text = option("POWER", "Rated motor power; if no other size is given, one is sought that loads it fully."),
    capacity: Text = option(
        "POWER", "Cooling capacity, or heating capacity of a heat pump, e.g. '300 kW'; the size is sought."
    ),
    flow: Text = option(
        "FLOW",
        "Free air of an air package, e.g. '7.5 m^3/min'; flow of a booster at its inlet or '2000 Nm^3/h'; the size is "
        "sought.",
    ),
    pressure: Text = option(
        "PRESSURE", "Outlet pressure of an air package, instead of --condition, e.g. '7.5 bar(g)'."
    ),
    economizer: bool = switch("--economizer", "Add an economizer port (refrigeration, heat_pump)."),
    slide: bool = switch("--slide", "Add a slide valve for part load (refrigeration, heat_pump)."),
    variable_speed: bool = switch(
        "--variable-speed", "Air package with an inverter, swept over the speeds of its sheet."
    ),
    two_stage: bool = switch(
        "--two-stage",
        "Two stages in series (air, refrigeration, heat_pump): two scenes beside -o NAME.stages.yaml, joining them.",
    ),
    output: File = option("SCENE.yaml", "File to write it to (default: the screen).", "-o"),
) -> None:
    """Write a complete, commented scene of a realistic machine, with leaks, oil and losses scaled to its size."""
    if output is not None and not two_stage:
        _check_free(output)
    from screwsim.template import KINDS, kind_of, note_on_pressure, request_of

    if kind is None:
        raise UsageError(f"KIND: is missing (there are: {', '.join(KINDS)}; write e.g. screwsim new refrigeration)")
    sheet = {"--motor": motor, "--capacity": capacity, "--flow": flow, "--pressure": pressure}
    chosen = {"--economizer": economizer, "--slide": slide, "--variable-speed": variable_speed}
    stated = [name for name, value in sheet.items() if value is not None]
    kind_of(kind, [*stated, *(name for name, is_so in chosen.items() if is_so)])
    asked = request_of(
        fluid=fluid,
        displacement=displacement,
        diameter=diameter,
        vi=vi,
        speed=speed,
        oil=oil,
        condition=condition,
        motor=motor,
        free_air=flow,
        pressure=pressure,
        capacity=capacity,
        economizer=economizer,
        slide=slide,
        variable=variable_speed,
    )
    from screwsim.printing.tables import print_text

    if told := note_on_pressure(pressure):
        print_text(told, err=True)
    if two_stage:
        _write_two_stages(kind, asked, {**sheet, **chosen, "--vi": vi}, output)
        return
    from screwsim.study.sizing import performance_lines, sized_machine, stated_machine

    found = (sized_machine if asked.by_sheet else stated_machine)(kind, asked)
    for line in performance_lines(asked, found):
        print_text(line, err=output is None)  # to stderr where the scene itself goes to the screen
    if output is None:
        say(found.text.rstrip("\n"))
        return
    from screwsim.results.atomic import write_text

    _check_free(output)  # again: a file that has appeared meanwhile is kept
    say(write_text(output, found.text))


def _write_two_stages(kind: str, asked: "SceneRequest", stated: Mapping[str, Any], output: Path | None) -> None:
    """Write the scenes of two stages, and the file that joins them."""
    from screwsim.printing.tables import print_text
    from screwsim.results.atomic import write_text
    from screwsim.template import two_stages

    two_stages.check_options(kind, stated)
    ending, option = two_stages.ENDING, two_stages.OPTION
    if output is None:
        raise UsageError(f"{option}: writes three files (write e.g. -o plant{ending})")
    if not output.name.endswith(ending) or output.name == ending:
        named = output.name.removesuffix(output.suffix) or "plant"
        what = f"the file that joins two stages must end in {ending}"
        raise UsageError(f"-o {output}: {what} (write -o {output.with_name(named + ending)})")
    names = two_stages.names_from(output.name)
    files = [output.with_name(name) for name in names]
    for file in files:
        _check_new_file(file)
    from screwsim.study.sizing_of_two import performance_lines, sized_stages

    found = sized_stages(kind, asked)
    for line in performance_lines(kind, found):
        print_text(line)
    for file in files:
        _check_new_file(file)  # again: a file that has appeared meanwhile is kept
    texts = (*found.texts, two_stages.stages_text(kind, asked, found.ends, names))
    for file, text in zip(files, texts, strict=True):
        say(write_text(file, text))


def _check_free(output: Path) -> None:
    """Raise UsageError unless a scene can be written there without replacing anything."""
    if output.suffix.lower() not in (".yaml", ".yml"):
        good = output.with_suffix(".yaml")
        raise UsageError(f"-o {output}: a scene file must end in .yaml (write -o {good})")
    if output.name.endswith((".fit.yaml", ".stages.yaml")):
        what = "is named like a fit or a two-stage file"
        raise UsageError(f"-o {output}: {what} (choose another name; --two-stage writes two stages)")
    _check_new_file(output)


def _check_new_file(output: Path) -> None:
    """Raise UsageError where a file exists already, or cannot be written."""
    check_new(output)
    from screwsim.results.atomic import check_writable

    check_writable(output)
