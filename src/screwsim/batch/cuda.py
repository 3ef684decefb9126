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
from screwsim.numerics.rodas import TOO_MANY_STEPS

Array = np.ndarray
THREADS = 32  # of a block: points go ways of their own, and one warp a multiprocessor is soonest done
STEPS = 512  # of a turn that find room on the device, at first
MOST_STEPS = 8192  # and at most
NEEDS = "points on a GPU need numba-cuda (pip install 'screwsim[gpu]')"
HEADER = "import math\nimport numpy as np\nfrom numba import cuda\n"
MOST_CONSTANTS = (
    32  # numbers of an array in a device's memory for constants: small, and each function that uses one has its own
)
SMALL = ("y", "q", "counts", "P", "R", "kept", "hints", "state", "own")  # go there and come back: a column a point
HISTORIES = ("t_old", "d_old", "t_new", "d_new", "quads")  # a row a step, in it an entry a point
GIVEN = ("breakpoints", "numbers", "whole", "tables", *SMALL, *HISTORIES, "out")
KERNEL = """
def turns({given}):
    i = cuda.grid(1)
    if i < out.shape[1]:
        context = ChamberContext({context})
        status, phi, step = {turn}(
            breakpoints[:, i], whole[0, i], y[:, i], q[:, i], context, numbers[0, i], numbers[1, i], {n_E},
            t_new[:, i], d_new[:, i], quads[:, i], kept[:, i], counts[:, i])
        out[0, i] = status
        out[1, i] = phi
        out[2, i] = step
"""


def text_of(text: str, n_E: int) -> str:
    """Return a composition's text as a module for numba-cuda: what a turn calls, and the kernel `turns`.

    Arrays of a function's own become local memory, which needs their sizes as numbers.
    """
    program = read(text)
    reached = _reached(program, TURN)
    constants = [f"{name} = {_constant(value)}" for name, value in program.constants.items() if name in reached]
    functions = []
    for name in program.functions:
        if name in reached:
            node = _with_local_memory(program, program.functions[name], {"n_e": n_E})
            functions.append(f"@cuda.jit(device=True)\n{unparsed(node)}")
    context = ", ".join("tables[whole[1, i]]" if name == "TAB" else f"{name}[:, i]" for name in ChamberContext._fields)
    kernel = KERNEL.format(given=", ".join(GIVEN), context=context, turn=TURN, n_E=n_E)
    return "\n\n".join([HEADER, *constants, *functions, f"@cuda.jit{kernel}"])


def _constant(value: Any) -> str | None:
    text = constant_text(value)
    return f"cuda.to_device({text})" if np.size(value) > MOST_CONSTANTS else text


def _reached(program: Program, first: str) -> set[str]:
    """Return the names of the functions and constants that one function uses."""
    found, left = set(), [first]
    while left:
        name = left.pop()
        if name not in found:
            found.add(name)
            if name in program.functions:
                used = {node.id for node in nodes(program.functions[name]) if isinstance(node, ast.Name)}
                left += used & (program.functions.keys() | program.constants.keys())
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

    def __init__(self, like: Machinery) -> None:
        self.steps = STEPS  # of a turn: as much room as it finds on the device
        self._kernel = kernel_of(like.composition.text, like.composition.n_E)

    def turns(self, asked: Sequence[Asked]) -> list[Answer]:
        """Integrate a life of each; what a turn leaves behind is put where `Machinery.turn` leaves it.

        A turn of more steps than there is room for is integrated by the processor; the next call makes more room.
        """
        found = self._on_device(asked)
        answers = []
        for i, each in enumerate(asked):
            status, phi, h = (float(number) for number in found["out"][:, i])
            if int(status) == TOO_MANY_STEPS and self.steps < each.machinery.max_steps:
                answers.append(each.machinery.own_turn(each.y, each.rtol, each.h))
            else:
                answers.append((int(status), phi, h, self._put(each, found, i)))
        most = max(int(each.machinery.kept[0]) for each in asked)
        if most > self.steps:
            self.steps = min(MOST_STEPS, 2 * most)
        return answers

    def _on_device(self, asked: Sequence[Asked]) -> dict[str, Array]:
        """Return what the device makes of turns: arrays whose last axis, or second one of histories, is the points."""
        sizes = _new(asked[0].machinery, self.steps)
        on_device = self._integrate(self._given(asked), sizes)
        found = {name: on_device[name].copy_to_host() for name in (*SMALL, "out")}
        most = int(found["kept"][0].max())
        for name in sizes:
            found[name] = on_device[name][: most + (name == "t_new")].copy_to_host()
        return found

    def _integrate(self, given: dict[str, Array], sizes: dict[str, tuple[int, ...]]) -> dict[str, Any]:
        """Return all arrays of a call on the device, once it has ended."""
        from numba import cuda  # pyright: ignore[reportMissingImports] - an extra

        n = given["y"].shape[-1]
        on_device = {name: cuda.to_device(table) for name, table in given.items()}
        for name, (steps, *others) in sizes.items():
            on_device[name] = cuda.device_array((steps, n, *others))
        on_device["out"] = cuda.device_array((3, n))
        self._kernel[-(-n // THREADS), THREADS](*(on_device[name] for name in GIVEN))
        cuda.synchronize()
        return on_device

    def _given(self, asked: Sequence[Asked]) -> dict[str, Array]:
        small = [_small(each) for each in asked]
        given = {name: np.stack([columns[name] for columns in small], axis=-1) for name in SMALL}
        breakpoints = [each.machinery.composition.breakpoints for each in asked]
        tables = {id(each.machinery.composition.TAB): each.machinery.composition.TAB for each in asked}
        rows = {key: row for row, key in enumerate(tables)}
        which = [rows[id(each.machinery.composition.TAB)] for each in asked]
        given["breakpoints"] = _rows(breakpoints).T.copy()
        given["tables"] = _rows(list(tables.values()))
        given["whole"] = np.array([[len(angles) for angles in breakpoints], which])
        given["numbers"] = np.array([[each.rtol for each in asked], [each.h for each in asked]])
        old = [each.machinery.last() for each in asked]
        most = max(1, *(steps for *_, steps in old))
        given["t_old"] = np.zeros((most + 1, len(asked)))
        given["d_old"] = np.zeros((most, len(asked), *old[0][1].shape[1:]))
        for i, (times, dense, _, steps) in enumerate(old):
            given["t_old"][: steps + 1, i], given["d_old"][:steps, i] = times[: steps + 1], dense[:steps]
        return given

    def _put(self, each: Asked, found: dict[str, Array], i: int) -> Array:
        """Put a point's numbers and history where its machinery has them; return its quadratures."""
        columns, steps = _small(each), int(found["kept"][0, i])
        for name, column in columns.items():
            column[:] = found[name][:, i]
        times, dense, quads = each.machinery.histories[1]
        times[: steps + 1], dense[:steps] = found["t_new"][: steps + 1, i], found["d_new"][:steps, i]
        quads[:steps] = found["quads"][:steps, i]
        return columns["q"]


def _small(each: Asked) -> dict[str, Array]:
    machinery = each.machinery
    columns = (np.zeros(machinery.nq), machinery.counts, machinery.composition.P, machinery.R, machinery.kept)
    return dict(zip(SMALL, (each.y, *columns, machinery.hints, *machinery.spaces), strict=True))


def _rows(tables: Sequence[Array]) -> Array:
    """Return tables of numbers as rows; those that are shorter are filled up."""
    found = np.zeros((len(tables), max(map(len, tables))))
    for row, table in zip(found, tables, strict=True):
        row[: len(table)] = table
    return found


def _new(like: Machinery, steps: int) -> dict[str, tuple[int, ...]]:
    """Return the sizes of a history that is written, of one point."""
    _, dense, quads = like.histories[1]
    return {"t_new": (steps + 1,), "d_new": (steps, *dense.shape[1:]), "quads": (steps, *quads.shape[1:])}
