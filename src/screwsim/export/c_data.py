"""The numbers of a map as a C header, with the C sources that read it."""

import hashlib
import uuid
from importlib import resources

import numpy as np

from screwsim.export.table import MapTable

SOURCES = {"2": ("map.c", "model.c", "fmi2.c"), "3": ("map.c", "model.c", "fmi3.c")}
HEADERS = ("map.h", "model.h", "fmi.h")
DATA = "map_data.h"
_NUMBERS_PER_LINE = 6  # numbers per line


def data_header(table: MapTable, version: str = "2") -> str:
    """Return the header with a map's numbers; its token is a hash of them, of the names and of the FMI version."""
    grid = table.grid
    count = len(grid.nodes)
    orders = [grid.data[tuple(order >> axis & 1 for axis in range(count))] for order in range(2**count)]
    data = np.stack(orders, axis=-2)  # nodes …, orders, outputs
    first = np.cumsum([0, *(len(x) for x in grid.nodes[:-1])])
    body = "\n".join(
        (
            f"#define MAP_INPUTS {count}",
            f"#define MAP_OUTPUTS {len(table.outputs)}",
            f"#define MAP_ERROR {_number(table.error)} /* relative, {table.how} */",
            "",
            _ints("map_count", [len(x) for x in grid.nodes]),
            _ints("map_first", first.tolist()),
            _ints("map_logarithmic", [int(one.log) for one in table.inputs]),
            _doubles("map_low", [one.low for one in table.inputs]),
            _doubles("map_high", [one.high for one in table.inputs]),
            _doubles("map_start", [one.value for one in table.inputs]),
            _doubles("map_nodes", np.concatenate(grid.nodes).tolist()),
            _ints("map_sound", grid.sound.astype(int).ravel().tolist(), "unsigned char"),
            _doubles("map_data", data.ravel().tolist()),
        )
    )
    names = " ".join(each.name for each in (*table.inputs, *table.outputs))
    token = uuid.UUID(bytes=hashlib.sha256(f"{version} {names} {body}".encode()).digest()[:16])
    return (
        f'/* Made by screwsim: values and derivatives at the nodes of a grid. */\n#define MAP_TOKEN "{token}"\n{body}\n'
    )


def token_of(header: str) -> str:
    """Return the token in a header."""
    return header.split('"')[1]


def source(name: str) -> str:
    """Return the text of a C file that is the same for all maps."""
    return (resources.files("screwsim.export") / "c" / name).read_text(encoding="utf-8")


def source_files(table: MapTable, version: str) -> dict[str, str]:
    """Return {name: text} of all files to be compiled for a version of FMI, and of those that they include."""
    names = (*SOURCES[version], *HEADERS)
    return {name: source(name) for name in names} | {DATA: data_header(table, version)}


def _number(value: float) -> str:
    return repr(float(value)) if np.isfinite(value) else "1.0"


def _doubles(name: str, values: list[float]) -> str:
    return _array("double", name, [_number(value) for value in values])


def _ints(name: str, values: list[int], kind: str = "int") -> str:
    return _array(kind, name, [str(value) for value in values])


def _array(kind: str, name: str, words: list[str]) -> str:
    step = _NUMBERS_PER_LINE if kind == "double" else 20
    rows = [", ".join(words[i : i + step]) for i in range(0, len(words), step)]
    inner = ",\n    ".join(rows)
    return f"static const {kind} {name}[{len(words)}] = {{\n    {inner}}};"
