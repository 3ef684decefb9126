"""A map's nodes as a comma-separated table: one row per node, inputs before outputs, units in the heads."""

import itertools

from screwsim.export.inputs import plain
from screwsim.export.table import MapTable

TITLE_SEPARATOR = "; SI units; error between the nodes "  # in the first line of a table


def csv_table(table: MapTable) -> str:
    """Return the rows of all nodes, the last input fastest; `closed` is 0 where a cycle did not close."""
    heads = [f"{each.name} [{plain(each.units)}]" for each in (*table.inputs, *table.outputs)]
    lines = [f"# {table.title}{TITLE_SEPARATOR}{table.error_in_words}"]
    lines.append(",".join([*heads, "closed"]))
    nodes = [one.at(u) for one, u in zip(table.inputs, table.grid.nodes, strict=True)]
    values = table.grid.data[(0,) * len(nodes)]
    for place in itertools.product(*(range(len(x)) for x in nodes)):
        closed = bool(table.grid.sound[place])
        at = [f"{x[i]:.12g}" for x, i in zip(nodes, place, strict=True)]
        figures = [f"{value:.12g}" if closed else "" for value in values[place]]
        lines.append(",".join([*at, *figures, str(int(closed))]))
    return "\n".join(lines) + "\n"
