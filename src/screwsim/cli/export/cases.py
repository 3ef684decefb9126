"""Export of the cases of a results file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from screwsim.cli import options
from screwsim.cli.declare import argument, option
from screwsim.cli.export.shared import app
from screwsim.cli.options import AS_JSON, OK
from screwsim.screen import say

if TYPE_CHECKING:
    pass


@app.command()
def cases(
    source: Path = argument("OUT.h5", "The results file of a sweep or a run."),
    output: Path = option("OUT.csv|.xlsx", "File to write the table to.", "-o", default=..., show_default=False),
    units: Literal["si", "metric", "us"] = option(
        "si|metric|us", "Units: SI; kW, bar, degC, Nm3/h; or hp, psia, degF, acfm, MMSCFD.", "--units", default="si"
    ),
    as_json: bool = AS_JSON,
) -> int:
    """Write every case of a results file as a row: varied paths, status, all figures."""
    options.check_target(output, *options.TABLES)
    from screwsim.export.cases import case_columns, protect_other_cases, write_cases
    from screwsim.printing import print_json
    from screwsim.results import open_results

    protect_other_cases(output)
    columns = case_columns(open_results(source), units)
    file = write_cases(output, columns)
    if as_json:
        heads = [{"name": each.name, "unit": each.unit, "coverage": each.coverage} for each in columns]
        print_json({"file": file, "cases": len(columns[0].values), "columns": heads})
    else:
        say(file)
    return OK
