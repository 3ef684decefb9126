"""Write docs/explanation/validation.md and its figures from the stored results of `screwsim validate`.

    screwsim validate [NAME]... -o results/validation
    python docs/tools/validation_page.py results/validation     keeps those in validation/results.json, then as below
    python docs/tools/validation_page.py                        the page from what is kept

Sources that were not run stay as they are kept.

Every number of the page comes from validation/results.json; a test holds the page to it.
"""

from __future__ import annotations

import json
import shutil
import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from screwsim.printing import write_json
from screwsim.study.validation import VERDICTS, value_text
from screwsim.study.validation.record import KINDS, summary

ROOT = Path(__file__).resolve().parents[2]
KEPT, DOCS = ROOT / "validation" / "results.json", ROOT / "docs"
PAGE, FIGURES = DOCS / "explanation" / "validation.md", DOCS / "figures"
_MACHINES = ("paper", "bitzer", "hsk", "giuffrida", "he2018", "cagi", "energyplus", "varispeed", "co2")
_OIL = ("droplets", "solubility", "solubility_beyond", "solution_viscosity")
ORDER = ("exact", "plain", "cross_code", *_MACHINES, *_OIL, "limits")
HEAD = """\
# Validation: how far from real machines

    screwsim validate [NAME]... [-o DIR] [--jobs N] [--json]     # each reference: ours, theirs, uncertainty, verdict

This page is for judging how far to trust the results. It compares the simulator with every source available: first the
counts, then the comparisons that fail, what the scenes leave out, and a section for each source.
`docs/tools/validation_page.py` makes this page from `validation/results.json`, which the command above made: no number
is typed.

{summary}.

{counts}

The kinds are kept apart, and only the first three are evidence:

{kinds}

`±` is the source's uncertainty; of exact and cross-code rows it is the tolerance. Calibrated rows and estimates say
nothing about whether the model is right.

**What holds** are closed forms, and the equations as an independent program solves them. **What does not hold** is
listed first.

**A failed verdict is a finding, not an error**: the command ends with exit code 0 when every comparison ran, with 4
when one could not. The sources are in `validation/` of the checkout, and in built packages. `--folder` names another
folder, whose programs are run; the working folder is not searched for one. `solubility` has no verdict without its
measured points, which are not part of the checkout: `SCREWSIM_SOLUBILITY_POINTS` names their file.

## Where it fails

{fails}

## Limits of validity

The table lists what the scenes leave out or assume, with the size of each effect on R134a at 2/45 °C and 2950 rpm.
These are estimates by `validation/limits`; its table below says how they were made and what can be simulated instead.

{limits}
"""
OWN = """\

## A source of your own

A source is a folder `validation/<name>/` with its data (CSV; lines that begin with `#` state source and uncertainty),
its scenes, and a file `compare.py` with one function `compare(here: Path) -> Comparison`. `screwsim.study.validation`
provides what that function needs:

- `solved`: a scene that must close;
- `read_table`: the data;
- `equal` and `trend`: rows that judge themselves;
- `Panel` and `Series`: the picture;
- `NotRun`: raise it with one line where no comparison is possible.
"""


def cell(text: str) -> str:
    """Return a text that a Markdown table takes."""
    return text.replace("|", "\\|").replace("*", "\\*")


def number(value: Any, unit: str, digits: int = 4) -> str:
    """Return a value with its unit."""
    text = cell(value_text(value, digits))
    return text if isinstance(value, str) or value is None or not unit else f"{text} {unit}"


def row_line(row: Mapping[str, Any]) -> str:
    """Return one row of a table."""
    unit, verdict = row["unit"], f"**{row['verdict']}**" if row["verdict"] == "fails" else row["verdict"]
    told = "; ".join(part for part in (row["basis"], row["note"]) if part)
    numbers = (number(row["ours"], unit), number(row["theirs"], unit), number(row["uncertainty"], unit, 2))
    cells = (cell(row["quantity"]), *numbers, row["kind"], verdict, cell(told))
    return "| " + " | ".join(cells) + " |"


def table(rows: list[Mapping[str, Any]]) -> str:
    """Return rows as a table."""
    head = "| quantity | ours | theirs | ± | kind | verdict | basis, note |\n|---|---|---|---|---|---|---|"
    return "\n".join([head, *(row_line(row) for row in rows)])


def counts(sources: Mapping[str, Any]) -> str:
    """Return how many rows of each kind have which verdict."""
    lines = ["| kind | holds | fails | no verdict |", "|---|---|---|---|"]
    rows = [row for source in sources.values() for row in source["rows"]]
    for kind in KINDS:
        of = [row["verdict"] for row in rows if row["kind"] == kind]
        lines.append(f"| {kind} | " + " | ".join(str(of.count(v)) for v in ("holds", "fails", "no verdict")) + " |")
    return "\n".join(lines)


def fails(sources: Mapping[str, Any]) -> str:
    """Return every row that fails, as a table."""
    lines = []
    for name, source in sources.items():
        for row in source["rows"]:
            if row["verdict"] == "fails":
                ours, theirs = (number(row[which], row["unit"]) for which in ("ours", "theirs"))
                lines.append(f"| {name} | {cell(row['quantity'])} | {ours} | {theirs} |")
    head = ["| source | quantity | ours | theirs |", "|---|---|---|---|"]
    return "\n".join([*head, *lines]) if lines else "Nowhere."


def limits(sources: Mapping[str, Any]) -> str:
    """Return the size of each thing that the model leaves out, as a table."""
    rows = [row for row in sources.get("limits", {"rows": []})["rows"] if row["kind"] == "estimate"]
    sizes = [number(row["ours"], row["unit"], 3) for row in rows]
    lines = (
        f"| {cell(row['quantity'])} | {size} | {cell(row['note'])} |" for row, size in zip(rows, sizes, strict=True)
    )
    return "\n".join(["| what | size | note |", "|---|---|---|", *lines])


def section(name: str, source: Mapping[str, Any]) -> str:
    """Return the section of one source."""
    parts = [f"## {source['title']}" if source["status"] == "ok" else f"## {name}"]
    if source["status"] != "ok":
        return "\n\n".join([*parts, f"Not run: {source['reason']}."])
    parts += [f"`validation/{name}`. Source: {cell(source['citation'])}.", cell(source["about"])]
    if source["panels"]:
        parts.append(f"![{source['title']}](../figures/validation_{name}.png)")
    return "\n\n".join([*parts, table(source["rows"])])


def page(document: Mapping[str, Any]) -> str:
    """Return the whole page."""
    found = document["sources"]
    sources = {name: found[name] for name in (*(n for n in ORDER if n in found), *(n for n in found if n not in ORDER))}
    kinds = "\n".join(f"- *{name}*: {about}" for name, about in KINDS.items())
    summed = summary(document)
    parts = {"counts": counts(sources), "kinds": kinds, "fails": fails(sources), "limits": limits(sources)}
    head = HEAD.format(summary=summed[0].upper() + summed[1:], **parts)
    return head + "\n" + "\n\n".join(section(name, source) for name, source in sources.items()) + "\n" + OWN


def merged(kept: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """Return the kept document with the sources of a new one in place of their own, and its verdicts counted again."""
    sources = dict(sorted({**kept["sources"], **new["sources"]}.items()))
    verdicts = Counter(row["verdict"] for source in sources.values() for row in source["rows"])
    return {"version": new["version"], "verdicts": {name: verdicts[name] for name in VERDICTS}, "sources": sources}


def keep(folder: Path) -> None:
    """Keep the results and figures that the command wrote to a folder."""
    kept, new = (json.loads(path.read_text(encoding="utf-8")) for path in (KEPT, folder / "validation.json"))
    write_json(merged(kept, new), KEPT)
    for picture in folder.glob("*.png"):
        shutil.copyfile(picture, FIGURES / f"validation_{picture.name}")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        keep(Path(sys.argv[1]))
    PAGE.write_text(page(json.loads(KEPT.read_text(encoding="utf-8"))), encoding="utf-8")
    print(PAGE)
