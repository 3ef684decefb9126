"""The report: one HTML file that shows a results file to a reader without a network and without this program."""

from collections.abc import Mapping, Sequence
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from screwsim.inputs.faults import UsageError
from screwsim.version import version

_NEEDED = ("jinja2", "plotly")
_SCRIPTS = ("dom", "numbers", "theme", "unpack", "drawing", "overview", "ledger", "case", "start")
_POLICY = "style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:; default-src 'none'"


def pages(path: str | Path, output: str | Path, claims: Sequence[Any] = ()) -> list[str]:
    """Write the page of a results file, of two stages also one of each beside it, and return the paths.

    `claims` (with says, measure, found, verdict) are shown as a table. Raise UsageError in one line when the extra is
    not installed, the file is not a results file, or the page cannot be written.
    """
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise UsageError(f"the page needs {' and '.join(missing)}: pip install 'screwsim[report]'")
    from screwsim.results import open_results
    from screwsim.results.atomic import make_folder, write_text
    from screwsim.results.protection import PAGE, protect_unmarked

    target, results = Path(output), open_results(path)
    places = {stage: target.with_stem(f"{target.stem}_{stage}") for stage in results.stages}
    for place in (target, *places.values()):
        protect_unmarked(place, PAGE)
    texts = {target: page_of(results, claims, {stage: place.name for stage, place in places.items()})}
    texts |= {place: page_of(results.stages[stage]) for stage, place in places.items()}
    make_folder(target.parent)
    return [write_text(place, text) for place, text in texts.items()]


def page_of(results: Any, claims: Sequence[Any] = (), stages: Mapping[str, str] | None = None) -> str:
    """Return the page as HTML text; `stages` are the names of the pages of two stages."""
    from plotly.offline import get_plotlyjs

    from screwsim.outputs.customary import with_printed_units
    from screwsim.report.front import objective_names
    from screwsim.report.page import data, tables
    from screwsim.report.page.pack import compressed
    from screwsim.report.page.uncertain import inputs_lines, model_lines
    from screwsim.results.read import stored_scenes
    from screwsim.results.schema import quantities_along

    shown, sought = data.selection(results), objective_names(results)
    document = data.document(results, shown)
    first = shown.place(document["start"]["case"])
    return rendered(
        __name__,
        _SCRIPTS,
        policy=_POLICY,
        title=with_printed_units(results.attributes["title"]),
        library=compressed(get_plotlyjs()),
        document=compressed(document),
        sweep=bool(results.axis_list),
        solved=bool(document["figures"]),
        counts=tables.counts(results),
        quantities=sum(1 for _ in quantities_along(results.axis_list)),
        axes=tables.axes(results),
        headline="" if sought else tables.headline_efficiency(results),
        best=tables.best_table(results) if sought else None,
        warnings=tables.warnings(results),
        notes=tables.notes(results, shown),
        figures=tables.figures(results, first),
        model=model_lines(results),
        inputs=inputs_lines(results, first),
        uncertain=document["inputs"] is not None,
        ranges=tables.ranges(results) if results.axis_list else [],
        checks=list(tables.checks(results)),
        claims=claims,
        scenes=[*stored_scenes(results).values()] if results.stages else [results.scene_yaml],
        stage=results.stage,
        pages=stages or {},
        provenance=tables.provenance(results),
        traces=document["cycle"] is not None,
        ledger=document["ledger"] is not None,
    )


def rendered(package: str, scripts: Sequence[str], **parts: Any) -> str:
    """Return the HTML text of a package's page, with style and scripts of its own or, by their names, of this one."""
    import jinja2

    def text(name: str) -> str:
        own = resources.files(package).joinpath(name)
        return (own if own.is_file() else resources.files(__name__).joinpath(name)).read_text(encoding="utf-8")

    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    style, script = text("theme.css") + text("page.css"), "\n".join(text(f"{each}.js") for each in scripts)
    return environment.from_string(text("page.html")).render(style=style, script=script, version=version(), **parts)
