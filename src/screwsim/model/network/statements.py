"""Straight-line text: statements with named locals, and the same statements with their derivatives.

Only what a scene calls for is written. Derivatives are made from the statements (`numerics.derivative`), those of
kernels from the kernels' source, branch by branch.
"""

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from inspect import getdoc
from typing import Concatenate, ParamSpec

from screwsim.numerics.derivative import Forward
from screwsim.numerics.kernel import Kernel, parsed, unparsed

P = ParamSpec("P")


class Statements:
    """Lines of text at an indentation."""

    def __init__(self, depth: int = 0) -> None:
        self.lines: list[str] = []
        self._depth = depth

    def add(self, *lines: str) -> None:
        """Add lines as they are."""
        self.lines += [f"{'    ' * self._depth}{line}" for line in lines]

    @contextmanager
    def within(self, head: str) -> Iterator[None]:
        """Indent what is added inside below a head: `if …`, `else`, `for …`."""
        self.add(f"{head}:")
        before, self._depth = len(self.lines), self._depth + 1
        yield
        if len(self.lines) == before:
            self.add("pass")
        self._depth -= 1


class Tangent:
    """Statements with their derivatives by seeds: names that are set elsewhere, or have derivatives in `given`.

    `given` maps variable and seed to the text of a derivative: for a variable that the statements set, in place of
    its own; for one set elsewhere, the name that is set with it (`slope_name`). `held` variables are constant.
    """

    def __init__(
        self,
        lines: Sequence[str],
        seeds: tuple[str, ...],
        kernels: Mapping[str, Kernel],
        given: Mapping[tuple[str, str], str],
        held: Collection[str] = (),
    ) -> None:
        body = parsed("\n".join(lines)).body
        texts = {key: parsed(text).body[0].value for key, text in given.items()}  # type: ignore[attr-defined]
        self._forward = Forward("network", body, seeds, kernels, texts, held)
        if self._forward.whole:
            names = ", ".join(sorted(self._forward.whole))
            raise TypeError(f"a state cannot be called {names}: the text of every chamber has a variable of that name")
        found = self._forward.statements(body)
        self.kernels = list(self._forward.uses.values())
        flat = {alias: item.flat_name for alias, item in self._forward.uses.items()}
        called = re.compile(rf"\b({'|'.join(flat) or '$.'})\(")
        lines = [line for node in found for line in unparsed(node).splitlines()]
        self.lines = [called.sub(lambda one: f"{flat[one[1]]}(", line) if "(" in line else line for line in lines]

    def slope(self, name: str, seed: str) -> str:
        """Return the text of a variable's derivative after the statements; 0.0 where there is none."""
        found = self._forward.slope(name, seed)
        return "0.0" if found is None else unparsed(found)


def function(head: str, *parts: Sequence[str]) -> str:
    """Return the text of a function."""
    return "\n".join([f"def {head}:", *(f"    {line}".rstrip() for part in parts for line in part)])


def writes(head: str, *first: str) -> Callable[[Callable[Concatenate[Statements, P], None]], Callable[P, str]]:
    """Return a decorator by which a function that adds statements returns the text of a function of this head.

    That has the docstring of the decorated function, the lines `first`, and the statements.
    """

    def around(add: Callable[Concatenate[Statements, P], None]) -> Callable[P, str]:
        @wraps(add)
        def text(*args: P.args, **kwargs: P.kwargs) -> str:
            to, (about, *more) = Statements(), (getdoc(add) or "").split("\n")
            add(to, *args, **kwargs)
            told = [f'"""{about}', *more, '"""'] if more else [f'"""{about}"""']
            return function(head, told, first, to.lines)

        return text

    return around
