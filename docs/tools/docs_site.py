"""The documentation as a site: pages of docs/, the API as the code has it, and a gallery whose pictures are made here.

    python docs/tools/docs_site.py [FOLDER]     (default: results/site; needs the extra `docs`; a warning is an error)

Equations are MathML, so that the site needs nothing from elsewhere. Links to files outside of docs/ become their names;
one to what is not there fails.
"""

from __future__ import annotations

import argparse
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import screwsim

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)")
PIECE = re.compile(r"^```python\n(.*?)^```$", re.M | re.S)
WIDTH = 96  # of a line of code
SECTIONS = {
    "Start here": "start",
    "Notebooks": "notebooks",
    "How to": "how-to",
    "Reference": "reference",
    "Explanation": "explanation",
}
CONF = """\
import re
from html import unescape
from xml.etree import ElementTree

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

project, author = "screwsim", "the screwsim developers"
version = release = {version!r}
extensions = ["myst_nb"]
nb_execution_mode = "off"  # docs/tools/notebooks.py runs them, and stores what they show
myst_enable_extensions = ["colon_fence", "dollarmath", "amsmath"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # pages of one table begin with small headings
html_theme = "furo"
html_title = f"screwsim {{version}}"
html_static_path, html_css_files = ["_static"], ["docs_site.css"]
html_show_sourcelink = html_copy_source = False
highlight_language = "none"
html_math_renderer = "mathml"
MATHML, ACCENTS = "{{http://www.w3.org/1998/Math/MathML}}", "˙¨ˉ¯~˜^ˆ→"
ENTITY = re.compile(r"&(?!(?:amp|lt|gt);)\\w+;")  # of HTML, which are none of XML
ElementTree.register_namespace("", MATHML[1:-1])
DIGITS = re.compile(r"\\\\([td]?frac)(\\d)(\\d)")  # of a fraction, which docutils reads as one number
KNOWN = ((r"\\dots", r"\\ldots"), (r"\\texttt", r"\\mathtt"), (r"\\mathrel", ""), (r"\\biggr", r"\\right"),
         (r"\\biggl", r"\\left"), (r"\\bigg", ""))


def mathml(text, block):
    for ours, theirs in KNOWN:
        text = text.replace(ours, theirs)
    text = DIGITS.sub(r"\\\\\\1{{\\2}}{{\\3}}", text)
    try:
        return accents(tex2mathml(text, as_block=block))
    except MathError as error:
        logging.getLogger(__name__).warning("equation %r: %s", text, error)
        return text


def accents(text):  # an index beside a letter with an accent, where docutils sets it below the letter
    root = ElementTree.fromstring(ENTITY.sub(lambda found: unescape(found[0]), text))
    for each in root.iter(MATHML + "munderover"):
        letter, index, accent = each
        if accent.tag == MATHML + "mo" and accent.text in ACCENTS:
            each.tag, each[:] = MATHML + "msub", [ElementTree.Element(MATHML + "mover", accent="true"), index]
            each[0][:] = [letter, accent]
    return ElementTree.tostring(root, encoding="unicode")


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
    """Make pages of a folder with a conf.py, in our style; return Sphinx's exit status, which one warning makes 1."""
    (source / "_static").mkdir(exist_ok=True)
    shutil.copy(Path(__file__).with_suffix(".css"), source / "_static")
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
        target = found[2].partition("#")[0]
        file = folder / target if target else None
        outside = file is not None and file.exists() and not file.resolve().is_relative_to(DOCS)
        if outside or target.endswith("README.md"):
            return found[1]
        named = file is not None and file.is_file() and file.suffix == ".md" and found[1].endswith(".md")
        return f"[{heading(file) if named and file else found[1]}]({found[2]})"  # no name of a file as words

    return LINK.sub(replaced, text)


def index(source: Path) -> str:
    """Return the first page: what it is and how it begins, then the pages of docs/ in its order, as cards."""
    text = local_links((DOCS / "README.md").read_text(encoding="utf-8"), DOCS)
    named = [target for _, target in LINK.findall(text)]
    pages = text.partition("\n\n")[2].rstrip()
    pages = re.sub(r"^\*\*(.+?)\*\*(?:: (.+))?$", _section, pages, flags=re.M)
    pages = re.sub(r"^- .*?(?=\n\n|\Z)", r":::{container} cards\n\g<0>\n:::", pages, flags=re.M | re.S)
    trees = []
    for caption, folder in SECTIONS.items():
        listed = [name for name in dict.fromkeys(named) if name.startswith(f"{folder}/")]
        listed += {"reference": ["model.md", "reference/api.md"], "start": ["gallery.md"]}.get(folder, [])
        there = (name for name in listed if (source / name).is_file() or "gallery" in name)
        lines = "\n".join(name.rpartition(".")[0] for name in there)
        trees.append(f"```{{toctree}}\n:hidden:\n:caption: {caption}\n\n{lines}\n```\n")
    return "\n\n".join([_beginning(), pages, *trees])


def _section(found: re.Match[str]) -> str:
    return f"## {found[1]}\n" + (f"\n{found[2][0].upper()}{found[2][1:]}.\n" if found[2] else "")


def _beginning() -> str:
    """Return the head of the first page: the README's first words and picture, and the tutorial's first commands."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    words, picture = readme.split("\n\n")[1], re.findall(r"^!\[.+$", readme, re.M)[0]
    tutorial = (DOCS / "start" / "tutorial.md").read_text(encoding="utf-8")
    commands = "\n".join(re.findall(r"^    \$ (screwsim (?:new|run|sweep|report) .+)$", tutorial, re.M)[:2])
    commands = commands.replace(" --displacement", " \\\n    --displacement")
    shown = picture.replace("](docs/", "](")
    return f"# screwsim\n\n{words}\n\n```text\n{commands}\n```\n\n{shown}\n"


def heading(page: Path) -> str:
    """Return the heading of a page or notebook; of what is not there its name."""
    if not page.is_file():
        return page.name
    text = page.read_text(encoding="utf-8")
    if page.suffix == ".ipynb":
        text = "".join(json.loads(text)["cells"][0]["source"])
    return next((line[2:] for line in text.splitlines() if line.startswith("# ")), page.name)


def api_page() -> str:
    """Return all public names of the package: a table of them, then each with its signature and docstring."""
    found: dict[str, object] = {}
    for name in screwsim.__all__:
        thing = getattr(screwsim, name)
        if inspect.ismodule(thing):
            found |= {f"{name}.{each}": getattr(thing, each) for each in thing.__all__}
        elif not name.startswith("__"):
            found[name] = thing
    kinds = {
        "Functions": {name: thing for name, thing in found.items() if not isinstance(thing, type) and "." not in name},
        "Pictures": {name: thing for name, thing in found.items() if "." in name},
        "Classes": {name: thing for name, thing in found.items() if isinstance(thing, type)},
    }
    parts = [
        "# Python\n\nAll public names of `screwsim`, as the code has them; [how to use them](../how-to/python.md).\n",
    ]
    for kind, members in kinds.items():
        firsts = {name: _words(thing).partition("\n")[0] for name, thing in members.items()}
        rows = [f"| [`{name}`](#{_anchor(name)}) | {words} |" for name, words in firsts.items()]
        parts += [f"## {kind}\n\n| name | what |\n|---|---|\n" + "\n".join(rows) + "\n"]
        parts += [_entry(name, thing) for name, thing in members.items()]
    return "\n".join(parts)


def _anchor(name: str) -> str:
    return "screwsim-" + re.sub(r"\W", "-", name).lower()


def _words(thing: object) -> str:
    return inspect.cleandoc(inspect.getdoc(thing) or "")


def _entry(name: str, thing: object) -> str:
    """Return the part of the page about a name: signature, and the docstring as the Markdown that it is."""
    words = re.sub(r"(?<=\S)\n(?=[-*] )", "\n\n", _words(thing))
    signature = _signature(f"screwsim.{name}", thing)
    shown = f"```python\n{signature}\n```\n\n" if signature else ""
    return f"({_anchor(name)})=\n### screwsim.{name}\n\n{shown}{words}\n"


class _Bare(str):
    """An annotation as it stands in the source."""

    __slots__ = ()
    __repr__ = str.__str__


def _signature(name: str, thing: object) -> str:
    """Return the call of a name, a parameter a line where it is long; nothing where there is none to tell."""
    try:
        signature = inspect.signature(thing)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return ""
    listed: list[str] = []
    for each in signature.parameters.values():
        if each.kind is each.KEYWORD_ONLY and not any(other.startswith("*") for other in listed):
            listed.append("*")
        typed = isinstance(each.annotation, str)
        listed.append(str(each.replace(annotation=_Bare(each.annotation)) if typed else each))
    back = signature.return_annotation
    end = f" -> {back}" if isinstance(back, str) and not isinstance(thing, type) else ""
    line = f"{name}({', '.join(listed)}){end}"
    return line if len(line) <= WIDTH else f"{name}(\n    " + ",\n    ".join(listed) + f",\n){end}"


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
        if not any(figure.axes for figure in map(pyplot.figure, pyplot.get_fignums())):
            raise SystemExit(f"{page.name}: these lines draw nothing:\n{found[1]}")
        number = len(list(pictures.glob("*.png"))) + 1
        pyplot.gcf().savefig(pictures / f"{number}.png", dpi=130, bbox_inches="tight")
        return f"{found[0]}\n\n![what the lines above draw](gallery/{number}.png)"

    return PIECE.sub(drawn, page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", default="results/site", help="where the site is made (results/site)")
    sys.exit(main(parser.parse_args().folder))
