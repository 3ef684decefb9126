"""Part of the compiled code of a scene: the functions that state an equation, or that have a name."""

import ast
import re
from collections.abc import Iterable, Iterator, Mapping

from screwsim.inputs.faults import UsageError
from screwsim.inputs.suggestions import did_you_mean

NUMBER = re.compile(r"\b[MS]\d+\b")
_RANGE = re.compile(r"\b([MS])(\d+)–[MS]?(\d+)")


def code_of(text: str, names: Iterable[str]) -> str:
    """Return the functions of a scene's code that state one of the equations, or have one of the names.

    A function states the equations that its docstring numbers. Its name is that in the code, in full ('nozzle__flow')
    or from the underscores on ('flow'). Raise UsageError for a name that the code does not have.
    """
    functions = _functions(text)
    lines = text.splitlines()
    found: dict[str, ast.FunctionDef] = {}
    for given in names:
        name = given.upper() if NUMBER.fullmatch(given.upper()) else given
        own = {each: node for each, node in functions.items() if _has(node, name)}
        if not own:
            raise UsageError(f"{name}: {_absent(functions, name)}")
        found |= own
    return "\n\n".join("\n".join(lines[node.lineno - 1 : node.end_lineno]) for node in found.values())


def _functions(text: str) -> dict[str, ast.FunctionDef]:
    """Return the functions of the text by name; of two that are the same, as for all chambers together, the first."""
    found: dict[str, ast.FunctionDef] = {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef):
            found.setdefault(node.name, node)
    return found


def _has(node: ast.FunctionDef, name: str) -> bool:
    return name in (node.name, node.name.partition("__")[2]) or name in set(_numbers(node))


def _numbers(node: ast.FunctionDef) -> Iterator[str]:
    """Yield the numbers of the equations that a function's docstring has, those of a range one by one."""
    told = ast.get_docstring(node) or ""
    yield from NUMBER.findall(told)
    for letter, first, last in _RANGE.findall(told):
        yield from (f"{letter}{number}" for number in range(int(first), int(last) + 1))


def _absent(functions: Mapping[str, ast.FunctionDef], name: str) -> str:
    """Return that the code has no function of that name, and what there is instead."""
    if NUMBER.fullmatch(name):
        there = sorted({each for node in functions.values() for each in _numbers(node)}, key=lambda it: int(it[1:]))
        what = "no function of this scene's code names it"
        return f"{what} (use one of {', '.join(there)}; docs/reference/equations.md names the source of all)"
    own = [each.partition("__")[2] or each for each in functions if not each.startswith("slopes_of_")]
    of_effect = [each for each in functions if each.startswith(f"{name}__")]
    remedy = did_you_mean(name, own) or " (use the number of an equation, such as M12)"
    remedy = f" (write {' or '.join(of_effect)})" if of_effect else remedy
    return f"is neither an equation nor a function of this scene's code{remedy}"
