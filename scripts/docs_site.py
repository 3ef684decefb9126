"""The documentation as a site: pages of docs/, the API as the code has it, and a gallery whose pictures are made here.

    python scripts/docs_site.py [FOLDER]     (default: results/site; needs the extra `docs`; a warning is an error)

Equations are MathML, so that the site needs nothing from elsewhere. Links to files outside of docs/ become their names;
one to what is not there fails.
"""

from __future__ import annotations

import inspect
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import screwsim

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)")
PIECE = re.compile(r"^```python\n(.*?)^```$", re.M | re.S)
SECTIONS = {
    "Start here": "start",
    "Notebooks": "notebooks",
    "How to": "how-to",
    "Reference": "reference",
    "Explanation": "explanation",
}
CONF = """\
import re

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

project, author = "screwsim", "the screwsim developers"
version = release = {version!r}
extensions = ["myst_nb"]
nb_execution_mode = "off"  # scripts/notebooks.py runs them, and stores what they show
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # pages of one table begin with small headings
html_theme = "furo"
html_title = f"screwsim {{version}}"
html_show_sourcelink = html_copy_source = False
highlight_language = "none"
html_math_renderer = "mathml"
KNOWN = ((r"\\dots", r"\\ldots"), (r"\\texttt", r"\\mathtt"), (r"\\mathrel", ""), (r"\\biggr", r"\\right"),
         (r"\\biggl", r"\\left"), (r"\\bigg", ""))


def mathml(text, block):
    for ours, theirs in KNOWN:
        text = text.replace(ours, theirs)
    try:
        return tex2mathml(text, as_block=block)
    except MathError as error:
        logging.getLogger(__name__).warning("equation %r: %s", text, error)
        return text


def inline(self, node):
    self.body.append(mathml(node.astext(), False))
    raise nodes.SkipNode


def block(self, node):
    self.body.append(mathml(node.astext(), True))
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    app.config.html_static_path.append("notebooks/files")
    app.config.exclude_patterns.append("notebooks/files")
    app.add_css_file("notebooks.css")
"""
NOTEBOOKS_CSS = """\
.cell_output { overflow-x: auto; }
.cell_output table { border: 0; border-collapse: collapse; font-size: var(--font-size--small); }
.cell_output th, .cell_output td { border: 0; padding: 0.25rem 0.7rem; vertical-align: top; }
.cell_output tbody tr { border-top: 1px solid var(--color-table-border); }
.cell_output table.dataframe { font-variant-numeric: tabular-nums; }
.cell_output table.dataframe td { white-space: nowrap; }
.cell_output table.dataframe td, .cell_output table.dataframe th { text-align: right; }
.cell_output table.dataframe tbody th { text-align: left; font-weight: normal; }
"""


def main(folder: str = "results/site") -> int:
    site = Path(folder)
    source = site / "source"
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    (source / "conf.py").write_text(CONF.format(version=screwsim.__version__), encoding="utf-8")
    copy_pages(source)
    copy_notebooks(source / "notebooks")
    (source / "reference" / "api.md").write_text(api_page(), encoding="utf-8")
    (source / "gallery.md").write_text(gallery(DOCS / "gallery.md", source), encoding="utf-8")
    (source / "index.md").write_text(index(source), encoding="utf-8")
    code = build(source, site / "html")
    print(site / "html" / "index.html" if code == 0 else "the site has warnings, see above")
    return code


def build(source: Path, html: Path) -> int:
    """Make pages of a folder with a conf.py; return Sphinx's exit status, which one warning makes 1."""
    options = ["-q", "-W", "--keep-going", "-b", "html"]
    return subprocess.run([sys.executable, "-m", "sphinx", *options, str(source), str(html)], check=False).returncode


def copy_pages(source: Path) -> None:
    """Copy pages and pictures; a link whose target is not among them becomes its words."""
    for path in sorted(DOCS.rglob("*")):
        target = source / path.relative_to(DOCS)
        target.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md" and path.name not in ("README.md", "gallery.md"):
            text = path.read_text(encoding="utf-8").replace("```csv", "```text")  # no lexer knows it
            target.write_text(local_links(text, path.parent), encoding="utf-8")
        elif path.suffix in (".png", ".svg"):
            shutil.copy(path, target)


def copy_notebooks(target: Path) -> None:
    """Copy notebooks as pages, and beside them as files; where a page names its own, that is to be had."""
    (target / "files").mkdir(parents=True)
    (target / "files" / "notebooks.css").write_text(NOTEBOOKS_CSS, encoding="utf-8")
    for path in sorted((DOCS / "notebooks").glob("*.ipynb")):
        shutil.copy(path, target / "files")
        offered = f"{{download}}`{path.name} <files/{path.name}>`"
        text = path.read_text(encoding="utf-8").replace(f"`docs/notebooks/{path.name}`", offered)
        (target / path.name).write_text(text, encoding="utf-8")


def local_links(text: str, folder: Path) -> str:
    """Return a page whose links to files outside of docs/ are words; those to what is not there stay, to be told."""

    def replaced(found: re.Match[str]) -> str:
        file = folder / found[2].partition("#")[0]
        outside = file.exists() and not file.resolve().is_relative_to(DOCS)
        return found[1] if outside or file.name == "README.md" else found[0]

    return LINK.sub(replaced, text)


def index(source: Path) -> str:
    """Return the first page: that of the repository's docs, with the pages in its order."""
    text = local_links((DOCS / "README.md").read_text(encoding="utf-8"), DOCS)
    text = LINK.sub(lambda found: f"[{heading(found[2])}]({found[2]})", text).replace(
        "# The pages, and for whom they are", "# screwsim", 1
    )
    named = [target for _, target in LINK.findall(text)]
    trees = []
    for caption, folder in SECTIONS.items():
        pages = [name for name in dict.fromkeys(named) if name.startswith(f"{folder}/")]
        pages += [] if folder != "reference" else ["model.md", "reference/api.md"]
        listed = "\n".join(name.rpartition(".")[0] for name in pages if (source / name).is_file())
        trees.append(f"```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{listed}\n```\n")
    return text.rstrip() + "\n\n" + "\n".join(trees) + "\n```{toctree}\n:hidden:\n\ngallery\n```\n"


def heading(page: str) -> str:
    """Return the heading of a page or notebook of docs/; of what is not there its name."""
    if not (DOCS / page).is_file():
        return page
    text = (DOCS / page).read_text(encoding="utf-8")
    if page.endswith(".ipynb"):
        text = "".join(json.loads(text)["cells"][0]["source"])
    return next((line[2:] for line in text.splitlines() if line.startswith("# ")), page)


def api_page() -> str:
    """Return all public names of the package with their signatures and docstrings."""
    parts = [
        "# Python\n\nAll public names of `screwsim`, as the code has them; [how to use them](../how-to/python.md).\n"
    ]
    for name in screwsim.__all__:
        thing = getattr(screwsim, name)
        if name.startswith("__"):
            continue
        members = {name: thing}
        if inspect.ismodule(thing):
            members = {f"{name}.{each}": getattr(thing, each) for each in thing.__all__}
        parts += [_entry(f"screwsim.{each}", value) for each, value in members.items()]
    return "\n".join(parts)


def _entry(name: str, thing: object) -> str:
    try:
        signature = str(inspect.signature(thing)) if callable(thing) else ""  # type: ignore[arg-type]
    except ValueError:
        signature = ""
    words = inspect.cleandoc(inspect.getdoc(thing) or "").replace("```", "'''")
    return f"## {name}\n\n```text\n{name}{signature}\n\n{words}\n```\n"


def gallery(page: Path, source: Path) -> str:
    """Return the page with the picture that each piece makes below it; pieces run in one module, in its order."""
    os.environ.setdefault("MPLBACKEND", "Agg")
    from matplotlib import pyplot

    names: dict[str, object] = {}
    pictures = source / "gallery"
    pictures.mkdir()

    def drawn(found: re.Match[str]) -> str:
        pyplot.close("all")
        exec(found[1], names)
        number = len(list(pictures.glob("*.png"))) + 1
        pyplot.gcf().savefig(pictures / f"{number}.png", dpi=130, bbox_inches="tight")
        return f"{found[0]}\n\n![what the lines above draw](gallery/{number}.png)"

    return PIECE.sub(drawn, page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
