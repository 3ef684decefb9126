"""The command that rates: a scene's data sheet, in the form customary in its trade."""

from typing import Annotated

from screwsim.cli import options
from screwsim.cli.declare import File, Text, Texts, option, switch
from screwsim.cli.options import NOT_ALL_OK, OK, AsJson, Jobs, Overrides, SceneFile, Without
from screwsim.screen import say


def datasheet(
    scene_file: SceneFile,
    output: Annotated[File, option("OUT.html|.pdf", "Write the sheet as an HTML page or a PDF.", "-o")] = None,
    evaporating: Annotated[
        Text, option("LOW..HIGH", "Evaporating temperatures of the table (refrigeration machine).")
    ] = None,
    condensing: Annotated[Text, option("LOW..HIGH", "Its condensing temperatures, or gas-cooler pressures.")] = None,
    suction: Annotated[
        Text, option("LOW..HIGH", "Suction pressures of the table (gas compressor), or inlet pressures of an expander.")
    ] = None,
    discharge: Annotated[
        Text, option("LOW..HIGH", "Its discharge pressures, or outlet pressures of an expander.")
    ] = None,
    limits: Annotated[
        Texts, option("FIGURE<VALUE", "A limit, e.g. 'discharge_temperature<110 degC'; repeatable.", "--limit")
    ] = None,
    heating: Annotated[
        bool, switch("--heating", "Add tables of heating capacity and heating COP (heat pump).")
    ] = False,
    profile: Annotated[
        str | None,
        option("LOADS.csv", "Flows and hours of an air package; adds its energy use over them.", "--profile"),
    ] = None,
    overrides: Overrides = None,
    without: Without = None,
    jobs: Jobs = None,
    as_json: AsJson = False,
) -> int:
    """Rate a machine over its operating states, at part load and within limits; an air package by ISO 1217."""
    scene = options.loaded_scene(scene_file, overrides, without)
    if output is not None:
        from screwsim.report.datasheet import check_sheet

        check_sheet(output)
    from screwsim.cli.interruption import counted_progress
    from screwsim.printing.datasheet import print_sheet
    from screwsim.study.datasheet import sheet_of

    with counted_progress("datasheet", "parts") as shown:
        sheet = sheet_of(
            scene,
            evaporating=evaporating,
            condensing=condensing,
            suction=suction,
            discharge=discharge,
            limits=limits or (),
            heating=heating,
            profile=profile,
            jobs=jobs,
            progress=shown,
        )
    options.print_document_or_text(as_json, lambda found: found.document, print_sheet, sheet)
    if output is not None:
        from screwsim.report.datasheet import write_sheet

        say(write_sheet(sheet, output), err=as_json)
    return OK if sheet.ok else NOT_ALL_OK
