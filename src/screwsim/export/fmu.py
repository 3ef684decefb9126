"""A functional mock-up unit of a map, for co-simulation by FMI 2.0 or 3.0: C code that needs no Python.

The archive holds the description, the C sources, their compiled library for this machine, a page and the map's own
data. The same map gives the same bytes (except for the compiler's).
"""

import hashlib
import json
import math
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import uuid
import zipfile
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from screwsim.export.inputs import BASE, DISPLAYS, Input, exponents, plain, range_text
from screwsim.export.map_table import MapTable
from screwsim.inputs.faults import UsageError
from screwsim.results.atomic import FOREIGN_FILE, check_target_kind, replacing

ERROR, VALID = "error_estimate", "valid"
_ERROR_MEANS = "largest relative error of the map at points inside; 1 outside, where it is unknown"
_VALID_MEANS = "inside the ranges, among points whose cycles closed"
_FLAGS = ((ERROR, _ERROR_MEANS, ""), (VALID, _VALID_MEANS, "Boolean"))  # with their types, '' for numbers
_BITS = {"x86_64": "x86_64", "amd64": "x86_64", "arm64": "aarch64", "aarch64": "aarch64"}
_SYSTEMS = {"linux": ("linux", "so"), "darwin": ("darwin", "dylib"), "win32": ("windows", "dll")}
_OLD = {("linux", "x86_64"): "linux64", ("darwin", "x86_64"): "darwin64", ("windows", "x86_64"): "win64"}
GENERATED = 'generationTool="screwsim"'
_ARCHIVE_TIME = (1980, 1, 1, 0, 0, 0)  # of each file in the archive: the same map gives the same archive
SOURCES = {"2": ("map.c", "model.c", "fmi2.c"), "3": ("map.c", "model.c", "fmi3.c")}
HEADERS = ("map.h", "model.h", "fmi.h")
DATA = "map_data.h"
_NUMBERS_PER_LINE = 6  # numbers per line


def write_fmu(table: MapTable, path: Path, version: str = "2", *, compiled: bool = True) -> list[str]:
    """Write the unit of a map; return the files in it. Raise UsageError if no C compiler is found, or if it fails."""
    name = identifier(path)
    sources = source_files(table, version)
    token = sources[DATA].split('"')[1]  # that of its header
    held: dict[str, bytes] = {f"sources/{file}": text.encode() for file, text in sources.items()}
    if version == "3":
        held["sources/buildDescription.xml"] = build_description(name).encode()
    if compiled:
        folder, ending = binary_place(version)
        held[f"binaries/{folder}/{name}.{ending}"] = compile_shared(sources, SOURCES[version], ending)
    held["modelDescription.xml"] = description(table, name, token, version).encode()
    held["documentation/index.html"] = documentation_page(table, name).encode()
    held["resources/map.json"] = (json.dumps(map_description(table), indent=1, allow_nan=False) + "\n").encode()
    with replacing(path) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
        for file, content in held.items():
            archive.writestr(zipfile.ZipInfo(file, _ARCHIVE_TIME), content, zipfile.ZIP_DEFLATED)
    return list(held)


def protect_other_units(path: Path) -> None:
    """Raise UsageError where a file at `path` is not a unit of a map, as it would be lost."""
    check_target_kind(path)
    try:
        with zipfile.ZipFile(path) as archive:
            ours = GENERATED.encode() in archive.read("modelDescription.xml")
    except FileNotFoundError:
        return
    except (OSError, zipfile.BadZipFile, KeyError, RuntimeError):  # RuntimeError: an archive with a password
        ours = False
    if not ours:
        raise UsageError(FOREIGN_FILE.format(path))


def identifier(path: Path) -> str:
    """Return a valid C identifier made from the file's name."""
    name = re.sub(r"\W", "_", path.stem, flags=re.ASCII)
    return name if name[:1].isalpha() else f"map_{name}"


def binary_place(version: str) -> tuple[str, str]:
    """Return the folder below binaries/ for this machine, and the file extension of a shared library there."""
    system, ending = _SYSTEMS.get(sys.platform, (sys.platform, "so"))
    machine = platform.machine().lower()
    bits = _BITS.get(machine, machine)
    if version == "2":
        return _OLD.get((system, bits), f"{bits}-{system}"), ending
    return f"{bits}-{system}", ending


def compiler() -> str:
    """Return the C compiler: that of the variable CC, else cc, gcc or clang; raise UsageError if there is none."""
    wanted = os.environ.get("CC", "")
    found = next((shutil.which(name) for name in (wanted, "cc", "gcc", "clang") if name and shutil.which(name)), None)
    if found is None:
        raise UsageError(
            "no C compiler is found (install one, name one in the variable CC, or write --sources-only: the unit then "
            "ships C for the importing tool)"
        )
    return found


def compile_shared(sources: dict[str, str], names: tuple[str, ...], ending: str) -> bytes:
    """Return the shared library of C sources; raise UsageError with the compiler's first error message."""
    command = compiler()
    with tempfile.TemporaryDirectory(prefix="screwsim-") as folder:
        for file, text in sources.items():
            Path(folder, file).write_text(text, encoding="utf-8")
        options = ["-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden"]
        target = f"unit.{ending}"
        call = [command, *options, "-o", target, *names, "-lm"]
        done = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            said = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr.strip()[:200])
            raise UsageError(f"{command} cannot compile the map: {said} (name another compiler in the variable CC)")
        return Path(folder, target).read_bytes()


def map_description(table: MapTable) -> dict[str, object]:
    """Return the description of a map, for people and programs."""
    return {
        "title": table.title,
        "inputs": [
            {
                "name": one.name,
                "path": one.path,
                "units": one.units,
                "from": one.low,
                "to": one.high,
                "meaning": one.long_name,
                "follows": [{"path": path, "at": [*at], "values": [*values]} for path, at, values in one.follows],
            }
            for one in table.inputs
        ],
        "outputs": [
            {"name": each.name, "units": plain(each.units), "meaning": each.long_name, "error": known_error(error)}
            for each, error in zip(table.outputs, table.errors, strict=True)
        ],
        "nodes": [list(map(float, each)) for each in table.nodes],
        "nodes_without_closed_cycle": table.not_ok,
        "without_closed_cycle": {"where": table.where_open(), "why": table.why},
        "warnings": [{"cases": count, "text": text} for count, text in table.warnings],
        "error_is": table.how,
        "scene": table.scene_yaml,
    }


def known_error(error: float) -> float | None:
    """Return an error; None if it is unknown."""
    return error if math.isfinite(error) else None


def error_text(error: float) -> str:
    """Return an error as text."""
    return f"{error:.2g}" if math.isfinite(error) else "not known"


def description(table: MapTable, name: str, token: str, version: str) -> str:
    """Return modelDescription.xml."""
    named, simulation, variables, structure = (_parts2 if version == "2" else _parts3)(table)
    ranges = "; ".join(f"{one.name} {range_text(one)}" for one in table.inputs)
    about = quoteattr(f"{table.title or 'compressor map'}: map over {ranges}; error {table.error_in_words}")
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="{version}.0" modelName="{name}" {named}="{token}" description={about}
    {GENERATED} variableNamingConvention="flat">
  <CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true" {simulation}
  <UnitDefinitions>
{_units(table)}
  </UnitDefinitions>
  <ModelVariables>
{chr(10).join(variables)}
  </ModelVariables>
  <ModelStructure>
{structure}
  </ModelStructure>
</fmiModelDescription>
"""


def _units(table: MapTable) -> str:
    lines = []
    for text in dict.fromkeys(plain(each.units) for each in (*table.inputs, *table.outputs)):
        powers = exponents(text)
        base = "".join(f' {unit}="{powers[unit]}"' for unit in BASE if unit in powers)
        shown = "".join(
            f'<DisplayUnit name="{each.name}" factor="{each.factor!r}" offset="{each.offset!r}"/>'
            for each in DISPLAYS.get(text, ())
        )
        lines.append(f"    <Unit name={quoteattr(text)}><BaseUnit{base}/>{shown}</Unit>")
    return "\n".join(lines)


def _variables(table: MapTable) -> Iterator[tuple[str, str, str]]:
    """Yield the type of each variable ('' for numbers), its attributes, and those of its number, as XML."""
    for i, each in enumerate((*table.inputs, *table.outputs)):
        way, means, start = "output", each.long_name, ""
        if isinstance(each, Input):
            way, means, start = "input", f"{means}; {range_text(each)}", f' start="{each.value!r}"'
        unit = plain(each.units)
        shown = "".join(f' displayUnit="{usual.name}"' for usual in DISPLAYS.get(unit, ())[:1])
        yield "", f'{_named(each.name, i, means)} causality="{way}"', f"{start} unit={quoteattr(unit)}{shown}"
    for i, (flag, means, kind) in enumerate(_FLAGS, len(table.inputs) + len(table.outputs)):
        yield kind, f'{_named(flag, i, means)} causality="output" variability="discrete"', ""


def _named(name: str, number: int, means: str) -> str:
    return f'name="{name}" valueReference="{number}" description={quoteattr(means)}'


def _parts2(table: MapTable) -> tuple[str, str, list[str], str]:
    """Return the name of the token, the end of the simulation's element, variables and structure for FMI 2.0."""
    count, outputs = len(table.inputs), len(table.outputs)
    variables = []
    for kind, head, number in _variables(table):
        head += ' variability="continuous"' if number else ""
        variables.append(f"    <ScalarVariable {head}><{kind or 'Real'}{number}/></ScalarVariable>")
    places, of = " ".join(str(i) for i in range(1, count + 1)), range(count + 1, count + outputs + 3)
    unknowns = "\n".join(f'      <Unknown index="{i}" dependencies="{places}"/>' for i in of)
    files = "".join(f'<File name="{file}"/>' for file in SOURCES["2"])
    simulation = f"""canGetAndSetFMUstate="true"
      canSerializeFMUstate="true" canNotUseMemoryManagementFunctions="true" providesDirectionalDerivative="true">
    <SourceFiles>{files}</SourceFiles>
  </CoSimulation>"""
    parts = ("Outputs", "InitialUnknowns")
    return "guid", simulation, variables, "\n".join(f"    <{part}>\n{unknowns}\n    </{part}>" for part in parts)


def _parts3(table: MapTable) -> tuple[str, str, list[str], str]:
    """Return the same for FMI 3.0."""
    count, outputs = len(table.inputs), len(table.outputs)
    variables = [
        f'    <Float64 name="time" valueReference="{count + outputs + 2}" causality="independent" '
        'variability="continuous" description="time [s]"/>'
    ]
    variables += [f"    <{kind or 'Float64'} {head}{number}/>" for kind, head, number in _variables(table)]
    places, unknowns = " ".join(str(i) for i in range(count)), range(count, count + outputs + 2)
    structure = [
        f'    <{part} valueReference="{i}" dependencies="{places}"/>'
        for part in ("Output", "InitialUnknown")
        for i in unknowns
    ]
    simulation = """canGetAndSetFMUState="true"
      canSerializeFMUState="true" providesDirectionalDerivatives="true" providesAdjointDerivatives="true"/>"""
    return "instantiationToken", simulation, variables, "\n".join(structure)


def build_description(name: str) -> str:
    """Return sources/buildDescription.xml of FMI 3.0."""
    files = "".join(f'<SourceFile name="{file}"/>' for file in SOURCES["3"])
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{name}">
    <SourceFileSet language="C99">{files}</SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"""


def documentation_page(table: MapTable, name: str) -> str:
    """Return the page shown by an importing tool: inputs with their ranges, outputs with their errors."""
    inputs = "".join(
        f"<tr><td>{one.name}</td><td>{escape(range_text(one))}</td><td>{escape(one.long_name)}</td></tr>"
        for one in table.inputs
    )
    outputs = "".join(
        f"<tr><td>{output.name}</td><td>{escape(plain(output.units))}, error {error_text(error)}</td>"
        f"<td>{escape(output.long_name)}</td></tr>"
        for output, error in zip(table.outputs, table.errors, strict=True)
    )
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{escape(name)}</title></head><body>
<h1>{escape(table.title or name)}</h1>
<p>A map with continuous gradients, in SI units. Errors are relative ({escape(table.how)}; of temperatures, over
100 K; of other figures, over their size or a tenth of their largest). Outside the ranges, and among points without
a closed cycle, <code>{VALID}</code> is false, and the outputs are the values at the border.</p>
<table>{inputs}{outputs}
<tr><td>{ERROR}</td><td>1</td><td>{_ERROR_MEANS}</td></tr>
<tr><td>{VALID}</td><td>Boolean</td><td>{_VALID_MEANS}</td></tr>
</table></body></html>
"""


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
    head = "/* Made by screwsim: values and derivatives at the nodes of a grid. */"
    return f'{head}\n#define MAP_TOKEN "{token}"\n{body}\n'


def source_files(table: MapTable, version: str) -> dict[str, str]:
    """Return {name: text} of all files to be compiled for a version of FMI, and of those that they include."""
    folder = resources.files("screwsim.export") / "c"
    texts = {name: (folder / name).read_text(encoding="utf-8") for name in (*SOURCES[version], *HEADERS)}
    return texts | {DATA: data_header(table, version)}


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
