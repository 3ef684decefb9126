"""The command for a new scene: complete, commented and realistic, to be edited by hand."""

from pathlib import Path
from typing import Annotated

from screwsim.cli.declare import File, Text, argument, option, switch
from screwsim.inputs.faults import UsageError
from screwsim.screen import say


def new(
    kind: Annotated[
        Text, argument("KIND", "refrigeration, heat_pump, air, booster (sucks at pressure), expander or reciprocating.")
    ] = None,
    fluid: Annotated[Text, option("NAME", "What is compressed (default: the kind's).")] = None,
    displacement: Annotated[
        Text, option("FLOW", "Displaced volume at the speed, e.g. '600 m^3/h' (default: the kind's).")
    ] = None,
    diameter: Annotated[Text, option("LENGTH", "Of the male rotor, in place of --displacement, e.g. '204 mm'.")] = None,
    vi: Annotated[float | None, option("RATIO", "Built-in volume ratio (default: what the pressures ask for).")] = None,
    speed: Annotated[Text, option("SPEED", "Of the male rotor, or the crank (default: 2950 rpm).")] = None,
    oil: Annotated[Text, option("NAME", "A stored oil, e.g. POE_68, mineral_46 (default: the fluid's).")] = None,
    condition: Annotated[
        Text,
        option(
            "LOW/HIGH",
            "Both lines, e.g. '0/40 degC, 10 K' (superheat), '1 bar/7.5 bar(g)', '20/7 bar, 100 degC' (inlet).",
        ),
    ] = None,
    motor: Annotated[
        Text, option("POWER", "Rated power of the motor; without another size one is sought that loads it in full.")
    ] = None,
    capacity: Annotated[
        Text,
        option("POWER", "What a refrigeration machine cools, a heat pump heats, e.g. '300 kW': its size is sought."),
    ] = None,
    flow: Annotated[
        Text, option("FLOW", "Free air that a package delivers, e.g. '7.5 m^3/min': its size is sought.")
    ] = None,
    pressure: Annotated[
        Text, option("PRESSURE", "At an air package's outlet, in place of --condition, e.g. '7.5 bar(g)'.")
    ] = None,
    economizer: Annotated[
        bool, switch("--economizer", "With an economizer's port, of refrigeration and heat_pump.")
    ] = False,
    slide: Annotated[
        bool, switch("--slide", "With a slide valve for part load, of refrigeration and heat_pump.")
    ] = False,
    variable_speed: Annotated[
        bool, switch("--variable-speed", "An air package with an inverter, and the speeds of its sheet.")
    ] = False,
    output: Annotated[File, option("SCENE.yaml", "Where it goes (default: the screen).", "-o")] = None,
) -> None:
    """Write a complete, commented scene of a realistic machine: leaks, oil, losses, scaled with its size."""
    if output is not None:
        _free(output)
    from screwsim.results.atomic import write_text
    from screwsim.template import KINDS, asked_of, kind_of, new_scene

    if kind is None:
        raise UsageError(f"KIND: is missing (there are: {', '.join(KINDS)}; write e.g. screwsim new refrigeration)")
    sheet = {"--motor": motor, "--capacity": capacity, "--flow": flow, "--pressure": pressure}
    chosen = {"--economizer": economizer, "--slide": slide, "--variable-speed": variable_speed}
    stated = [name for name, value in sheet.items() if value is not None]
    kind_of(kind, [*stated, *(name for name, is_so in chosen.items() if is_so)])
    asked = asked_of(
        fluid,
        displacement,
        vi,
        speed,
        oil,
        condition,
        diameter,
        motor=motor,
        free_air=flow,
        pressure=pressure,
        capacity=capacity,
        economizer=economizer,
        slide=slide,
        variable=variable_speed,
    )
    if asked.by_sheet:
        from screwsim.printing.tables import wrapped
        from screwsim.study.sized import sized, told

        found = sized(kind, asked)
        text = found.text
        for line in told(asked, found):
            say(wrapped(line), err=output is None)  # to stderr where the scene itself goes to the screen
    else:
        text = new_scene(kind, asked)
        if asked.economizer:
            from screwsim.study.sized import with_steady_port

            text = with_steady_port(text)
    if output is None:
        say(text.rstrip("\n"))
        return
    _free(output)  # again: a file that has appeared meanwhile is kept
    say(write_text(output, text))


def _free(output: Path) -> None:
    """Raise UsageError unless a scene can be written there without replacing anything."""
    if output.suffix.lower() not in (".yaml", ".yml"):
        good = output.with_suffix(".yaml")
        raise UsageError(f"-o {output}: a scene is written, which ends in .yaml (write -o {good})")
    if output.name.endswith((".fit.yaml", ".stages.yaml")):
        raise UsageError(f"-o {output}: ends as a fit or a plant of two stages does (write another name)")
    if output.exists():
        raise UsageError(f"-o {output}: is there already, and is not overwritten (choose another name, or remove it)")
