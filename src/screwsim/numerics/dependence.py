"""What depends on what in a body of statements: the variables that a derivative must follow."""

import ast
from collections.abc import Collection, Mapping, Sequence

from screwsim.numerics.expressions import FLAT, Expression, name_of

Active = dict[str, tuple[str, ...]]  # the seeds on which each variable depends, in their order


def find_active(
    active: Active,
    pairs: Sequence[tuple[list[str], Expression]],
    by: tuple[str, ...],
    given: Collection[tuple[str, str]],
    held: Collection[str],
) -> None:
    """Let every variable depend on what any assignment to it depends on, until nothing is added."""
    while True:
        before = dict(active)
        for names, value in pairs:
            found_in = seeds_of(value, active)
            for name in names:
                if name in held:
                    continue
                seeds = found_in | {seed for seed in by if (name, seed) in given}
                have = active.get(name, ())
                found = tuple(seed for seed in by if seed in have or seed in seeds)
                if found:
                    active[name] = found
        if active == before:
            return


def seeds_of(node: ast.AST, active: Mapping[str, tuple[str, ...]]) -> set[str]:
    """Return the seeds on which an expression depends; what decides a branch or an index does not count."""
    if isinstance(node, ast.Name):
        return set(active.get(node.id, ()))
    if isinstance(node, ast.Compare | ast.BoolOp):
        return set()
    if isinstance(node, ast.Subscript):
        return seeds_of(node.value, active)
    if isinstance(node, ast.IfExp):
        return seeds_of(node.body, active) | seeds_of(node.orelse, active)
    if isinstance(node, ast.Call) and name_of(node) in FLAT | {"int", "len", "range"}:
        return set()
    parts = node.args if isinstance(node, ast.Call) else ast.iter_child_nodes(node)
    return set().union(*(seeds_of(part, active) for part in parts))
