"""The same text on a GPU: a turn of each point in a thread of its own, in double precision, through numba-cuda.

An optional extra (`pip install 'screwsim[gpu]'`). Untested on a device: tests run it in numba's simulator, which runs
the kernels as Python. What is done between turns stays on the processor, as with lanes (`batch.tasks`).
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from screwsim.codegen.program import Program, read
from screwsim.inputs.faults import UsageError
from screwsim.model.contexts import ChamberContext
from screwsim.model.run import Machinery
from screwsim.model.side_by_side import TURN, Answer, Asked
from screwsim.numerics.kernel import constant_text, nodes, unparsed

Array = np.ndarray
THREADS = 64  # of a block
MOST_STEPS = 4000  # of a turn: each takes room on the device
NEEDS = "points on a GPU need numba-cuda (pip install 'screwsim[gpu]')"
HEADER = "import math\nimport numpy as np\nfrom numba import cuda\n"
GIVEN = ("breakpoints", "n_breakpoints", "y", "q", "rtol", "h", "counts", "quads", *ChamberContext._fields, "out")
KERNEL = """
def turns({given}):
    i = cuda.grid(1)
    if i < y.shape[0]:
        context = ChamberContext({context})
        status, phi, step = {turn}(
            breakpoints[i], n_breakpoints[i], y[i], q[i], context, rtol[i], h[i], {n_E},
            t_new[i], d_new[i], quads[i], kept[i], counts[i])
        out[i, 0] = status
        out[i, 1] = phi
        out[i, 2] = step
"""


def text_of(text: str, n_E: int) -> str:
    """Return a composition's text as a module for numba-cuda: what a turn calls, and the kernel `turns`.

    Arrays of a function's own become local memory, which needs their sizes as numbers.
    """
    program = read(text)
    reached = _reached(program, TURN)
    constants = [f"{name} = {constant_text(value)}" for name, value in program.constants.items()]
    functions = []
    for name in program.functions:
        if name in reached:
            node = _with_local_memory(program, program.functions[name], {"n_e": n_E})
            functions.append(f"@cuda.jit(device=True)\n{unparsed(node)}")
    context = ", ".join(f"{name}[i]" for name in ChamberContext._fields)
    kernel = KERNEL.format(given=", ".join(GIVEN), context=context, turn=TURN, n_E=n_E)
    return "\n\n".join([HEADER, *constants, *functions, f"@cuda.jit{kernel}"])


def _reached(program: Program, first: str) -> set[str]:
    found, left = set(), [first]
    while left:
        name = left.pop()
        if name not in found:
            found.add(name)
            used = {node.id for node in nodes(program.functions[name]) if isinstance(node, ast.Name)}
            left += used & program.functions.keys()
    return found


class _Local(ast.NodeTransformer):
    """Puts local memory in the place of arrays of a function's own."""

    def __init__(self, names: dict[str, Any]) -> None:
        self.names = names

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if ast.unparse(node.func) != "np.empty":
            return node
        shape = eval(ast.unparse(node.args[0]), {}, self.names)  # of our own text
        of = "np.int64" if len(node.args) > 1 else "np.float64"
        return ast.parse(f"cuda.local.array({shape}, {of})", mode="eval").body


def _with_local_memory(program: Program, node: ast.FunctionDef, known: dict[str, int]) -> ast.FunctionDef:
    names: dict[str, Any] = dict(program.constants) | known
    for each in node.body:  # n = STATES
        if isinstance(each, ast.Assign) and isinstance(each.targets[0], ast.Name) and isinstance(each.value, ast.Name):
            names[each.targets[0].id] = names.get(each.value.id)
    copied = ast.parse(ast.unparse(node)).body[0]
    found = _Local(names).visit(copied)
    assert isinstance(found, ast.FunctionDef)
    return found


@cache
def kernel_of(text: str, n_E: int) -> Any:
    """Return the kernel of a composition's text; raise UsageError without numba-cuda or a device."""
    try:
        from numba import cuda  # pyright: ignore[reportMissingImports] - an extra
    except ImportError:
        raise UsageError(NEEDS) from None
    if not cuda.is_available():
        raise UsageError("points on a GPU need one that CUDA finds; leave them to the processor's lanes")
    names: dict[str, Any] = {"ChamberContext": ChamberContext, "__name__": "screwsim.written.cuda"}
    exec(compile(text_of(text, n_E), "<turns on a GPU>", "exec"), names)
    return names["turns"]


class Cuda:
    """Turns of one structure on a GPU, as many as are asked for at once."""

    def __init__(self, like: Machinery, most_steps: int = MOST_STEPS) -> None:
        self.most_steps = most_steps
        self._kernel = kernel_of(like.composition.text, like.composition.n_E)

    def turns(self, asked: Sequence[Asked]) -> list[Answer]:
        """Integrate a life of each; what a turn leaves behind is put where `Machinery.turn` leaves it."""
        from numba import cuda  # pyright: ignore[reportMissingImports] - an extra

        rows = [self._rows(each) for each in asked]
        held = {name: _stacked([row[name] for row in rows]) for name in GIVEN if name != "out"}
        held["out"] = np.zeros((len(asked), 3))
        on_device = [cuda.to_device(held[name]) for name in GIVEN]
        blocks = -(-len(asked) // THREADS)
        self._kernel[blocks, min(THREADS, len(asked))](*on_device)
        found = dict(zip(GIVEN, (each.copy_to_host() for each in on_device), strict=True))
        return [self._put(each, {name: table[i] for name, table in found.items()}) for i, each in enumerate(asked)]

    def _rows(self, each: Asked) -> dict[str, Any]:
        machinery = each.machinery
        c, (old, new), (state, own) = machinery.composition, machinery.histories, machinery.spaces
        steps = min(self.most_steps, machinery.max_steps)
        return {
            "breakpoints": c.breakpoints,
            "n_breakpoints": np.int64(len(c.breakpoints)),
            "y": each.y,
            "q": np.zeros(machinery.nq),
            "rtol": np.float64(each.rtol),
            "h": np.float64(each.h),
            "counts": machinery.counts,
            "quads": new[2][:steps],
            "P": c.P,
            "TAB": c.TAB,
            "R": machinery.R,
            "t_old": old[0][: steps + 1],
            "d_old": old[1][:steps],
            "t_new": new[0][: steps + 1],
            "d_new": new[1][:steps],
            "kept": machinery.kept,
            "hints": machinery.hints,
            "state": state,
            "own": own,
        }

    def _put(self, each: Asked, found: dict[str, Any]) -> Answer:
        machinery, steps = each.machinery, int(found["kept"][0])
        _, new = machinery.histories
        new[0][: steps + 1], new[1][:steps], new[2][:steps] = (
            *(found["t_new"][: steps + 1], found["d_new"][:steps]),
            found["quads"][:steps],
        )
        each.y[:], machinery.R[:], machinery.counts[:] = found["y"], found["R"], found["counts"]
        machinery.composition.P[:], machinery.kept[:], machinery.hints[:] = found["P"], found["kept"], found["hints"]
        for space, name in zip(machinery.spaces, ("state", "own"), strict=True):
            space[:] = found[name]
        status, phi, h = found["out"]
        return int(status), float(phi), float(h), found["q"].copy()


def _stacked(tables: Sequence[Any]) -> Any:
    """Return tables of all points in one array; those that are shorter are filled up."""
    shapes = {np.shape(table) for table in tables}
    if len(shapes) == 1:
        return np.ascontiguousarray(np.stack(tables))
    found: Any = np.zeros((len(tables), *(max(sizes) for sizes in zip(*shapes, strict=True))), tables[0].dtype)
    for row, table in zip(found, tables, strict=True):
        row[tuple(slice(size) for size in table.shape)] = table
    return found
