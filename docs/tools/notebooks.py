"""Run the notebooks of docs/notebooks and store what they show, or hold that against what they give now.

    python docs/tools/notebooks.py [NOTEBOOK.ipynb …]           each in a kernel of its own (extra `dev`)
    python docs/tools/notebooks.py --check [NOTEBOOK.ipynb …]   without a kernel; a cell that gives another is told

What is said on stderr, that something is compiled, is not stored: only the first run says it.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import io
import os
import re
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import nbformat

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "notebooks"
ABOUT = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python", "file_extension": ".py", "mimetype": "text/x-python"},
}
PICTURE = "(a picture)"
NUMBER = re.compile(r"(?<![A-Za-z_])\d+(?:\.\d+)?(?:e[+-]?\d+)?")
SHARE = 5e-4  # by which a number may differ, or by one of its last digit: another machine takes other steps


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("notebooks", nargs="*", type=Path, help="default: all of docs/notebooks")
    parser.add_argument("--check", action="store_true", help="store nothing, and tell what differs")
    asked = parser.parse_args(arguments)
    told = []
    for path in asked.notebooks or sorted(FOLDER.glob("*.ipynb")):
        if asked.check:
            told += [f"{path.name}: {text}" for text in check(path)]
        else:
            notebook = nbformat.read(path, as_version=4)
            run(notebook)
            nbformat.write(notebook, path)
            print(path)
    print("\n".join(told) if told else "", end="\n" if told else "")
    return 1 if told else 0


def run(notebook: Any) -> None:
    """Execute a notebook in a kernel and an empty folder, and leave in it what does not change from run to run."""
    from nbclient import NotebookClient

    with tempfile.TemporaryDirectory() as folder:
        resources = {"metadata": {"path": folder}}
        client = NotebookClient(notebook, timeout=600, record_timing=False, resources=resources)
        client.extra_arguments = ["--IPKernelApp.log_level=ERROR"]
        client.execute()
    notebook.metadata = nbformat.from_dict(ABOUT)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = [each for each in cell.outputs if each.get("name") != "stderr"]


def check(path: Path) -> list[str]:
    """Return what the cells of a notebook give otherwise than it has stored, a text for each that does."""
    cells = [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    told = []
    for number, (cell, now) in enumerate(zip(cells, replay([cell.source for cell in cells]), strict=True), 1):
        stored = [text for output in cell.outputs if (text := shown(output))]
        if cell.execution_count != number:
            told.append(f"cell {number} was not run in its turn")
        if len(stored) != len(now):
            told.append(f"cell {number} shows {len(now)} things, {len(stored)} are stored")
        told += [f"cell {number}: {what}" for a, b in zip(stored, now, strict=False) for what in differences(a, b)]
    return told


def shown(output: Any) -> str:
    """Return what an output shows, as text; of a bar of progress nothing, which is there only in a notebook."""
    if output.output_type == "stream":
        return output.text
    if output.output_type == "error":
        return f"{output.ename}: {output.evalue}"
    if output.metadata.get("screwsim") == "progress":
        return ""
    return PICTURE if "image/png" in output.data else output.data.get("text/html", output.data["text/plain"])


def replay(sources: Sequence[str]) -> Iterator[list[str]]:
    """Run cells one after another in one module and an empty folder; yield what each shows, in a notebook's order."""
    from matplotlib import pyplot

    names: dict[str, Any] = {"__name__": "__main__"}
    home = os.getcwd()
    pyplot.close("all")
    with tempfile.TemporaryDirectory() as folder, pyplot.rc_context():
        os.chdir(folder)
        try:
            for source in sources:
                printed = io.StringIO()
                with contextlib.redirect_stdout(printed):
                    value = value_of(source, names)
                texts = [printed.getvalue()] if printed.getvalue() else []
                if value is not None:
                    texts.append(value._repr_html_() if hasattr(value, "_repr_html_") else repr(value))
                yield texts + [PICTURE] * len(pyplot.get_fignums())
                pyplot.close("all")
        finally:
            os.chdir(home)


def value_of(source: str, names: dict[str, Any]) -> Any:
    """Run a cell; return the value of its last line, if that is an expression and no semicolon ends it."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) and not source.rstrip().endswith(";") else None
    exec(compile(tree, "<cell>", "exec"), names)
    return None if last is None else eval(compile(ast.Expression(last.value), "<cell>", "eval"), names)


def differences(stored: str, now: str) -> list[str]:
    """Return how two texts differ: words, or numbers by more than their rounding; spaces do not count."""
    ours, theirs = (" ".join(text.split()) for text in (stored, now))
    if NUMBER.sub("#", ours) != NUMBER.sub("#", theirs):
        return [f"says {theirs[:200]!r}, stored is {ours[:200]!r}"]
    pairs = zip(NUMBER.findall(ours), NUMBER.findall(theirs), strict=True)
    return [f"gives {b}, stored is {a}" for a, b in pairs if abs(float(a) - float(b)) > _rounding(a)]


def _rounding(number: str) -> float:
    digits, _, power = number.partition("e")
    last = 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))
    return max(1.01 * last if "." in number or power else 0.0, SHARE * float(number))


if __name__ == "__main__":
    sys.exit(main())
