"""Kernels: scalar functions that run as plain Python and are pasted into one flat compiled module.

A kernel takes and returns floats (or small tuples, or arrays that its caller owns), allocates nothing and keeps no
state. `flatten` collects kernels with everything that they call or read, gives each a unique name (`file__function`)
and returns the source text. A `Slot` is a function that the generated module must define itself, a `Structure` a number
of the composition that becomes a constant. `written` makes a kernel from generated text, such as the equation of state
of one fluid.
"""

import ast
import hashlib
import inspect
import linecache
import math
import re
import textwrap
import threading
import types
from collections.abc import Callable, Iterable, Mapping
from copy import copy
from functools import cache, cached_property, lru_cache
from typing import Any

import numpy as np

from screwsim.numerics.loops import bounded

HEADER = "import math\nimport numpy as np\n"


class Kernel:
    """A function that can be called as it is, and whose source can be pasted into a compiled module."""

    def __init__(self, function: Callable[..., Any], source: str | None = None) -> None:
        self.function = function
        self.__doc__ = function.__doc__
        self.__name__ = function.__name__
        code = function.__code__
        self.arguments = code.co_varnames[: code.co_argcount]
        self.plain = self  # with the names of its own text (`asking`)
        # read now, since the file may be edited while this process runs
        self.source = source or source_of(function)
        if "while" in self.source and flat_module(function).startswith("user_"):
            self.function, self.source = bounded(function, self.source, self._calls_one)

    def __call__(self, *arguments: Any) -> Any:
        return self.function(*arguments)

    def asking(self, **names: str) -> "Kernel":
        """Return the kernel with other names of arguments, by which a part of an effect asks for numbers."""
        found = copy(self)
        found.arguments = tuple(names.get(name, name) for name in self.arguments)
        return found

    def _calls_one(self, name: str) -> bool:
        """Tell whether a called function returns a single number: a built-in one, or a kernel without a tuple."""
        called = self.function.__globals__.get(name)
        if called is None:
            return name in ("abs", "min", "max", "float")
        return isinstance(called, Kernel) and not any(
            isinstance(node, ast.Tuple) for node in nodes(parsed(called.source))
        )

    @cached_property
    def flat_name(self) -> str:
        """Name in the flat module: its module's (for our own, the last part), two underscores, the function's."""
        return f"{flat_module(self.function)}__{self.__name__}"


def flat_module(function: Callable[..., Any]) -> str:
    """Return a module's name as part of a flat name; a user's module never shares one with this package's."""
    name = function.__module__
    return name.rpartition(".")[2] if name.startswith("screwsim.") else "user_" + re.sub(r"\W", "_", name)


def source_of(function: Callable[..., Any]) -> str:
    """Return the text of a function, decorators included.

    `inspect.getsource` reads it token by token, which for all kernels takes a tenth of a second at each start. Here the
    text ends before a line that is indented less; where that is earlier than the code object says, `inspect` is used.
    """
    code = function.__code__
    linecache.checkcache(code.co_filename)
    lines = linecache.getlines(code.co_filename, function.__globals__)[code.co_firstlineno - 1 :]
    head = next((n for n, line in enumerate(lines) if line.lstrip().startswith("def ")), len(lines))
    edge = len(lines[0]) - len(lines[0].lstrip()) if lines else 0
    last = head
    for number, line in enumerate(lines[head + 1 :], head + 1):
        text = line.lstrip()
        if text and len(line) - len(text) <= edge and text[0] not in ")#":
            break
        last = number if text and (len(line) - len(text) > edge or text[0] == ")") else last
    if not lines or last < _last_line(code) - code.co_firstlineno:
        return textwrap.dedent(inspect.getsource(function))
    return textwrap.dedent("".join(lines[: last + 1]))


def _last_line(code: types.CodeType) -> int:
    inner = (_last_line(each) for each in code.co_consts if isinstance(each, types.CodeType))
    return max(max(end for _, end, _, _ in code.co_positions() if end is not None), *inner, 0)


class Slot:
    """A function that the generated module defines, under a name of its own; calling it outside raises RuntimeError."""

    def __init__(self, name: str, filled_by: str = "") -> None:
        self.name, self.filled_by = name, filled_by or name

    def __call__(self, *_: Any) -> Any:
        raise RuntimeError(f"{self.name} exists only inside a generated module")


class Structure:
    """A number of the composition, which becomes a constant of the text."""

    def __init__(self, name: str) -> None:
        self.name = name


def kernel(function: Callable[..., Any]) -> Kernel:
    """Mark a function as a kernel."""
    return Kernel(function)


_written: dict[str, Kernel] = {}


def written(source: str, of: str, uses: Mapping[str, Any] | None = None) -> Kernel:
    """Return the kernel of a generated function's text; the same text always gives the same kernel object.

    `uses` holds the kernels and constants that the text names. The flat name consists of `of` (a fluid, say), a digest
    of the text and of everything that it uses, and the function's name, so that different texts never share a name.
    """
    uses = dict(uses or {})
    spelled = [
        f"{name} = {item.flat_name if isinstance(item, Kernel) else constant_text(item)}" for name, item in uses.items()
    ]
    digest = hashlib.sha256("\n".join([source, *spelled]).encode()).hexdigest()[:10]
    stem = re.sub("[^a-z0-9]+", "_", of.lower()).strip("_")
    stem = f"of_{stem}" if stem[:1].isdigit() else stem  # 1-Butene: no name begins with a digit
    module = f"screwsim.written.{stem}_{digest}"
    name = source[: source.index("(")].removeprefix("def ").strip()
    key = f"{module}.{name}"
    if key not in _written:
        space: dict[str, Any] = {"math": math, "np": np, "__name__": module, **uses}
        exec(compile(source, f"<{key}>", "exec"), space)
        _written.setdefault(key, Kernel(space[name], source))  # if two threads write it, the first one counts
    return _written[key]


_parsing = threading.RLock()  # Python 3.11 adds up the nesting depth of all threads' texts, and may raise an error


def parsed(source: str) -> ast.Module:
    """Return the syntax tree of a text, one thread at a time."""
    with _parsing:
        return ast.parse(source)


_NO_PARTS = {"ctx", "op", "ops", "id", "attr", "name", "arg", "kind", "type_comment", "n", "s"}


@cache
def _parts(kind: type[ast.AST]) -> tuple[str, ...]:
    """Return the fields of a node class that can contain other nodes."""
    fields = () if kind is ast.Constant else getattr(kind, "_fields", ())  # names in lists have no fields
    return tuple(name for name in fields if name not in _NO_PARTS)


def nodes(*trees: ast.AST) -> list[Any]:
    """Return the nodes of trees without operators and contexts, each before its parts; faster than `ast.walk`."""
    found: list[Any] = list(trees)
    for node in found:  # grows
        for name in _parts(type(node)):
            part = getattr(node, name, None)
            if type(part) is list:
                found += part
            elif part is not None:
                found.append(part)
    return found


def unparsed(node: ast.AST) -> str:
    """Return the text of a tree that was built here, whose statements have no line numbers."""
    for each in nodes(node):
        if isinstance(each, ast.stmt):
            each.lineno = 0  # the only position that `ast.unparse` needs
    return ast.unparse(node)


def constant_text(value: Any) -> str | None:
    if isinstance(value, bool | int | float):
        return repr(value)
    if type(value).__name__ == "ndarray":  # becomes a constant of the compiled code
        return f"np.array({value.tolist()!r})"
    return None


@lru_cache(maxsize=2048)
def _renamed(source: str, renames: tuple[tuple[str, str], ...]) -> str:
    """Rename the names that the one function of a text uses, and the function; drop decorators and annotations."""
    tree, names = parsed(source), dict(renames)
    for node in nodes(tree):
        if type(node) is ast.Name:
            node.id = names.get(node.id, node.id)
    for function in tree.body:
        assert isinstance(function, ast.FunctionDef)
        function.name = names.get(function.name, function.name)
        function.decorator_list = []
        function.returns = None
        for argument in function.args.args:
            argument.annotation = None
    return ast.unparse(tree)


def kernels_digest(kernels: Iterable[Kernel]) -> str:
    """Return the digest of kernels and everything that they use; kernels that differ anywhere give other texts."""
    found, seen = hashlib.sha256(), set[int]()
    left = list(kernels)
    for item in left:  # grows
        found.update(f"{item.flat_name}\0{item.source}\0".encode())
        if id(item) in seen:
            continue
        seen.add(id(item))
        for used in item.function.__code__.co_names:
            value = item.function.__globals__.get(used)
            if isinstance(value, Kernel):
                left.append(value)
                spelling = value.flat_name
            elif isinstance(value, Slot | Structure):
                spelling = f"{type(value).__name__} {value.name}"
            else:
                spelling = str(constant_text(value))
            found.update(f"{used} {spelling}\0".encode())
    return found.hexdigest()


def math_spelling(value: Any) -> str:
    """Return a remedy for a function that was imported from `math` by its own name; empty for anything else."""
    name = getattr(value, "__name__", "")
    known = isinstance(name, str) and value is not None and getattr(math, name, None) is value
    return f" (import math, and write math.{name})" if known else ""


def flatten(
    kernels: Iterable[Kernel],
    slots: Mapping[str, str] | None = None,
    instance: str = "",
    numbers: Mapping[str, int] | None = None,
) -> dict[str, str]:
    """Return {flat name: source} of kernels and everything that they use, callees first.

    `slots` maps a slot's name to the function that fills it; `instance` is appended to the names of kernels that use a
    slot, so that one method can be compiled for several models in one module. `numbers` are the values of `Structure`s.
    """
    found: dict[str, str] = {}
    seen: dict[str, Kernel] = {}
    slots = slots or {}
    numbers = numbers or {}

    def uses_slot(item: Kernel) -> bool:
        names = item.function.__globals__
        return any(
            isinstance(names.get(name), Slot) or (isinstance(names.get(name), Kernel) and uses_slot(names[name]))
            for name in item.function.__code__.co_names
        )

    def emitted_name(item: Kernel) -> str:
        return item.flat_name + (instance if uses_slot(item) else "")

    def visit(item: Kernel) -> None:
        name = emitted_name(item)
        if name in found:
            if seen[name] is not item:
                raise TypeError(f"two kernels are called {name}; rename one of them")
            return
        seen[name] = item
        found[name] = ""  # placeholder, deleted below, so that callees come first
        renames = {item.__name__: name}
        for used in item.function.__code__.co_names:
            value = item.function.__globals__.get(used)
            own = ""
            if isinstance(value, Structure):
                value, own = numbers[value.name], instance if uses_slot(item) else ""
            if isinstance(value, Kernel):
                visit(value)
                renames[used] = emitted_name(value)
            elif isinstance(value, Slot):
                renames[used] = slots[value.name]
            elif value is None or isinstance(value, types.ModuleType):
                if isinstance(value, types.ModuleType) and value is not math and value.__name__ != "numpy":
                    raise TypeError(f"kernel {item.__name__} uses module {value.__name__}; only math and numpy compile")
            else:
                text = constant_text(value)
                if text is None:
                    what = f"which is neither kernel, number nor array{math_spelling(value)}"
                    raise TypeError(f"kernel {item.__name__} uses {used}, {what}")
                constant = f"{flat_module(item.function)}__{used}{own}"
                found[constant] = f"{constant} = {text}"
                renames[used] = constant
        del found[name]
        found[name] = _renamed(item.source, tuple(renames.items()))

    for each in kernels:
        visit(each)
    return found
