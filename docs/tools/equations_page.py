"""The page of equations: each number of the model, its formula, where the code states it, whose it is, what tests it.

Titles and formulas are those of docs/model.md and docs/reference/slider-crank.md. What states an equation is what of
src/screwsim has its number: the functions and classes in whose docstring or comments it stands, else the module. A test
of it has the number, or takes a function that states it. `docs/tools/reference_pages.py` writes the page.
"""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from functools import cache
from pathlib import Path
from typing import NamedTuple

from screwsim.effects import catalogue

ROOT = Path(__file__).resolve().parents[2]
SOURCES, TESTS = ROOT / "src" / "screwsim", ROOT / "tests"
STATED = {"M": ROOT / "docs" / "model.md", "S": ROOT / "docs" / "reference" / "slider-crank.md"}
SECTION = re.compile(r"^#### (?P<number>[MS]\d+) (?P<title>.+?)\n(?P<text>.*?)(?=^#{2,4} |\Z)", re.M | re.S)
FORMULA = re.compile(r"^\$\$.*?\$\$[ \t]*$", re.M | re.S)
HEAD = """\
# All equations

Made by `docs/tools/reference_pages.py`: number, title and first formula are those of [model.md](../model.md) (M…) and
[slider-crank.md](slider-crank.md) (S…), where symbols, further formulas and the source stand. *Code* is what of the
package has the number in its text, *effects* are those that own it, as `screwsim explain` says. *Tests* are the files
that have the number or import what states it; where there are none, those of effects and laws that name such an effect,
else those that import anything of the code. What has none of its own is tested by whole results (`tests/laws`).
"""
# equations whose number no code has, and why
WITHOUT_CODE = {
    "M153": "a limit of the expander that tests hold",
    "M157": "a figure for judging droplets, which the model does not use",
    "S21": "a limit of the cylinder that tests hold",
    "S23": "a limit of the cylinder that tests hold",
}


class Equation(NamedTuple):
    """A number with its title, its first formula in Markdown, and the page that states it."""

    number: str
    title: str
    formula: str
    page: Path


def cited(text: str) -> set[str]:
    """Return the numbers in a text, ranges such as M20–M22 included."""
    found = set(re.findall(r"\b[MS]\d+\b", text))
    for letter, first, last in re.findall(r"\b([MS])(\d+)[–-]\1(\d+)\b", text):
        found |= {f"{letter}{number}" for number in range(int(first), int(last) + 1)}
    return found


@cache
def equations() -> dict[str, Equation]:
    """Return {number: equation} in the order of the pages."""
    found = {}
    for page in STATED.values():
        for each in SECTION.finditer(page.read_text(encoding="utf-8")):
            formula = FORMULA.search(each["text"])
            found[each["number"]] = Equation(each["number"], each["title"], formula[0] if formula else "", page)
    return found


def _first_line(node: ast.FunctionDef | ast.ClassDef, lines: list[str]) -> int:
    """Return the index of the line with which a function begins, with decorators and the comments above them."""
    first = min([node.lineno, *(each.lineno for each in node.decorator_list)]) - 1
    while first and lines[first - 1].startswith("#"):
        first -= 1
    return first


@cache
def places() -> dict[str, dict[str, set[str]]]:
    """Return {number: {module: functions and classes with the number}}; none where the module alone has it."""
    found: dict[str, dict[str, set[str]]] = defaultdict(dict)
    for file in sorted(SOURCES.rglob("*.py")):
        module, text = file.relative_to(SOURCES).as_posix(), file.read_text(encoding="utf-8")
        for number in cited(text):
            found[number][module] = set()
        lines = text.splitlines()
        for node in ast.parse(text).body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                for number in cited("\n".join(lines[_first_line(node, lines) : node.end_lineno])):
                    found[number][module].add(node.name)
    return found


@cache
def taken() -> dict[tuple[str, str], set[str]]:
    """Return {(module, name): files of tests that import it}."""
    found: dict[tuple[str, str], set[str]] = defaultdict(set)
    for file in sorted(TESTS.rglob("test_*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (taken_from := node.module or "").startswith("screwsim."):
                module = f"{taken_from.removeprefix('screwsim.').replace('.', '/')}.py"
                for each in node.names:
                    found[module, each.name].add(file.relative_to(TESTS).as_posix())
    return found


@cache
def naming(effect: str) -> set[str]:
    """Return the files of tests of effects and of laws that name an effect."""
    files = [*(TESTS / "effects").glob("test_*.py"), *(TESTS / "laws").glob("test_*.py")]
    return {
        file.relative_to(TESTS).as_posix()
        for file in files
        if re.search(rf"\b{effect}\b", file.read_text(encoding="utf-8"))
    }


@cache
def citing() -> dict[str, set[str]]:
    """Return {number: files of tests that have it}."""
    found: dict[str, set[str]] = defaultdict(set)
    for file in sorted(TESTS.rglob("test_*.py")):
        for number in cited(file.read_text(encoding="utf-8")):
            found[number].add(file.relative_to(TESTS).as_posix())
    return found


def tests_of(number: str) -> list[str]:
    """Return the files of tests of an equation."""
    found = set(citing().get(number, ()))
    for module, names in places().get(number, {}).items():
        for name in names:
            found |= taken().get((module, name), set())
    for effect in () if found else effects_of(number):
        found |= naming(effect)
    for module in () if found else places().get(number, {}):
        found |= {file for (where, _), files in taken().items() if where == module for file in files}
    return sorted(found)


def effects_of(number: str) -> list[str]:
    """Return the effects that own an equation."""
    return [name for name, effect in catalogue().items() if number in effect.equations]


def code_of(number: str) -> str:
    """Return where the code has a number, as Markdown; what states it by name comes first."""
    found = sorted(places().get(number, {}).items(), key=lambda each: (not each[1], each[0]))
    named = [(f"`src/screwsim/{module}`", ", ".join(sorted(names))) for module, names in found]
    return ", ".join(f"{file} ({names})" if names else file for file, names in named)


def section(each: Equation) -> str:
    """Return the section of one equation."""
    name = each.page.name if each.page.parent.name == "reference" else f"../{each.page.name}"
    rows = [("code", code_of(each.number) or f"none: {WITHOUT_CODE.get(each.number, '')}")]
    rows += [("effects", ", ".join(f"`{one}`" for one in effects_of(each.number)))]
    rows += [("tests", ", ".join(f"`tests/{one}`" for one in tests_of(each.number)) or "none of its own")]
    told = "\n".join(f"- {what}: {text}" for what, text in rows if text)
    return f"## {each.number} {each.title}\n\n{each.formula}\n\n{told}\n\nStated in [{each.page.name}]({name}).\n"


def equations_page() -> str:
    """Return the page of all equations."""
    return "\n".join([HEAD, *map(section, equations().values())])
