"""Mutated results files: bytes turned, cut, filled; members, types, shapes, links and values that no results have."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np

SECRET = "CANARY-" * 8  # in a file that no results file may lead to
ODD_NUMBERS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e308, -1e308, 5e-324, 1e30, -1e-30)
ODD_TEXTS = (
    "",
    "\x1b[31mred",
    "\x1b]0;title\x07",
    "a\nb",
    "\u202eright to left",
    "😀" * 9,
    "x" * 70_000,
    "nan",
    "<b>&",
)
ODD_TEXTS += ("$\\frac{", "$_^", "{{ 7*7 }}", "</script>", "%s%n", "'\"", "\u0000x")


def bytes_turned(raw: bytes, random: np.random.Generator) -> bytes:
    """Return a file with some of its bytes changed, cut out, repeated or left out at the end."""
    data = bytearray(raw)
    kind = int(random.integers(6))
    at = int(random.integers(len(data)))
    size = int(random.integers(1, 65))
    if kind == 0:  # anywhere
        for place in random.integers(len(data), size=int(random.integers(1, 20))):
            data[place] ^= 1 << int(random.integers(8))
    elif kind == 1:  # among what describes the file
        for place in random.integers(min(len(data), 4096), size=int(random.integers(1, 6))):
            data[place] = int(random.integers(256))
    elif kind == 2:
        data[at : at + size] = bytes([int(random.choice([0, 255, 127]))]) * len(data[at : at + size])
    elif kind == 3:
        del data[at:]
    elif kind == 4:
        del data[at : at + size]
    else:
        data[at:at] = data[at : at + size]
    return bytes(data)


def _every(file: h5py.File, kind: type) -> list[str]:
    found: list[str] = []
    file.visititems(lambda name, item: found.append(name) if isinstance(item, kind) else None)
    return sorted(found)


def _one(names: list[str], random: np.random.Generator) -> str:
    return names[int(random.integers(len(names)))]


def _dataset(file: h5py.File, random: np.random.Generator) -> str:
    """Return the name of a dataset, often one that much depends on."""
    every = _every(file, h5py.Dataset)
    known = [name for name in every if name.rpartition("/")[2] in _CENTRAL or "path" in file[name].attrs]
    return _one(known if known and random.random() < 0.5 else every, random)


_CENTRAL = {"status", "message", "message_text", "warnings", "angle", "effect", "pressure", "volume", "shaft_power"}
_CENTRAL |= {"isothermal_efficiency", "isentropic_efficiency", "oil_ratio", "gas_mass_flow", "bound", "mass", "residue"}


def _replaced(file: h5py.File, name: str, make: Callable[[h5py.Group, str], Any]) -> None:
    """Put something else at the place of a dataset, its attributes with it as far as it takes them."""
    old = {key: file[name].attrs[key] for key in ("units", "long_name", "path", "labels") if key in file[name].attrs}
    scale = file[name].is_scale
    parent, _, leaf = name.rpartition("/")
    group = file[parent] if parent else file
    del group[leaf]
    make(group, leaf)
    made = group.get(leaf, getlink=True)
    if isinstance(made, h5py.HardLink):
        for key, value in old.items():
            group[leaf].attrs[key] = value
        if scale and isinstance(group[leaf], h5py.Dataset) and group[leaf].shape is not None:
            group[leaf].make_scale(leaf)


def removed(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    del file[_one(_every(file, h5py.Dataset) + _every(file, h5py.Group), random)]


def renamed(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    name = _one(_every(file, h5py.Dataset) + _every(file, h5py.Group), random)
    other = str(random.choice(["other", "status", "status_text", "angle", "a/b", "message_text", "😀", "\x1b[2J"]))
    where = f"{name.rpartition('/')[0]}/{other}"
    if where.strip("/") not in file:
        file.move(name, where)


def other_kind(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    """Put a group, a type, or a dataset of another type in place of one."""
    name = _dataset(file, random)
    shape = file[name].shape
    compound, enum = np.dtype([("a", "f8"), ("b", "i4")]), h5py.enum_dtype({"a": 0, "b": 1}, "i1")
    kinds: list[Any] = ["i1", "u8", "f2", "f4", "S7", "S1", "V5", compound, enum, h5py.string_dtype(), h5py.ref_dtype]
    kinds += ["c16", "?", np.dtype(("f8", (3,))), h5py.vlen_dtype(np.int32)]
    number = int(random.integers(len(kinds) + 2))

    def make(group: h5py.Group, leaf: str) -> None:
        if number == len(kinds):
            group.create_group(leaf)
        elif number == len(kinds) + 1:
            group[leaf] = np.dtype("f8")
        else:
            group.create_dataset(leaf, shape, kinds[number])

    _replaced(file, name, make)


def other_shape(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    """Give a dataset another shape: none, empty, transposed, more dimensions, or one that no memory holds."""
    name = _dataset(file, random)
    shape, kind = file[name].shape, file[name].dtype
    huge = (1 << 40,) if len(shape) < 2 else (1 << 20,) * len(shape)
    shapes: list[Any] = [(), (0,), (1,), (*shape, 2), shape[::-1], (2, *shape), (7,), huge, None, shape[:-1]]
    chosen = shapes[int(random.integers(len(shapes)))]

    def make(group: h5py.Group, leaf: str) -> None:
        if chosen is None:
            group[leaf] = h5py.Empty(kind)
        elif chosen == huge:
            packed = {"chunks": (4096,) * len(huge) if len(huge) == 1 else (64,) * len(huge), "compression": "gzip"}
            group.create_dataset(leaf, huge, kind, **(packed if random.random() < 0.5 else {}))
        else:
            group.create_dataset(leaf, chosen, kind)

    _replaced(file, name, make)


def leads_away(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    """Put a link, external storage or a virtual dataset, which lead to other files, in place of something."""
    secret = folder / "secret"
    name = _dataset(file, random)
    shape, dtype = file[name].shape, file[name].dtype
    number = int(random.integers(7))
    if number == 6:  # a whole group, and the file itself again
        name = _one(_every(file, h5py.Group), random)
        del file[name]
        file[name] = h5py.ExternalLink(f"{secret}.h5", "/") if random.random() < 0.5 else h5py.SoftLink("/")
        return

    def make(group: h5py.Group, leaf: str) -> None:
        if number == 0:
            group[leaf] = h5py.ExternalLink(f"{secret}.h5", "/text")
        elif number == 1:
            group[leaf] = h5py.SoftLink(str(random.choice(["/", "/nowhere", f"/{name}", "/performance/status"])))
        elif number == 2:
            group[leaf] = file  # a circle
        elif number == 3:
            size = max(1, int(np.prod(shape))) * dtype.itemsize
            group.create_dataset(leaf, shape or (1,), dtype, external=[(f"{secret}.txt", 0, size)])
        elif number == 4:
            group.create_dataset(leaf, (len(SECRET),), "S1", external=[(f"{secret}.txt", 0, len(SECRET))])
        else:
            layout = h5py.VirtualLayout((len(SECRET),), "S1")
            layout[:] = h5py.VirtualSource(f"{secret}.h5", "text", (len(SECRET),))
            group.create_virtual_dataset(leaf, layout)

    _replaced(file, name, make)


def other_filter(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    """Pack a dataset by a filter that would be loaded as a program, or by one that nobody has."""
    name = _dataset(file, random)
    shape, dtype = file[name].shape, file[name].dtype
    values = file[name][()]

    def make(group: h5py.Group, leaf: str) -> None:
        how = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        how.set_chunk(shape or (1,))
        if random.random() < 0.5:
            group.create_dataset(leaf, data=np.atleast_1d(values), compression="lzf")
            return
        how.set_filter(int(random.choice([32015, 4000, 305])), h5py.h5z.FLAG_OPTIONAL, (1, 2))
        kind = h5py.h5t.py_create(dtype, logical=True)
        h5py.h5d.create(group.id, leaf.encode(), kind, h5py.h5s.create_simple(shape or (1,)), how)

    _replaced(file, name, make)


def attribute(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    """Remove an attribute, or give it another kind, size or text."""
    name = _dataset(file, random) if random.random() < 0.5 else "/"
    item = file[name]
    keys = [key for key in item.attrs if key not in ("DIMENSION_LIST", "REFERENCE_LIST")]
    key = _one(sorted(keys), random)
    number = int(random.integers(8))
    if number == 0:
        del item.attrs[key]
    elif number == 1:
        item.attrs[key] = _one(list(ODD_TEXTS[:-1]), random)
    elif number == 2:
        item.attrs[key] = np.bytes_(b"\xff\xfe\x00\xd8")
    elif number == 3:
        item.attrs[key] = ODD_NUMBERS[int(random.integers(len(ODD_NUMBERS)))]
    elif number == 4:
        item.attrs[key] = int(random.choice([-1, 0, 2**40]))
    elif number == 5:
        item.attrs[key] = np.zeros((20, 20))
    elif number == 6:
        item.attrs[key] = h5py.Empty("f8")
    else:
        item.attrs[key] = file.ref if random.random() < 0.5 else ["a", "b"]


def attribute_huge(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    """Give an attribute megabytes, or the scene of the file a text that is none."""
    if random.random() < 0.3:
        file.attrs["title"] = "x" * 5_000_000
        return
    levels = "".join(f"a{i}: &a{i} [{', '.join(f'*a{i - 1}' for _ in range(9)) if i else 'x'}]\n" for i in range(40))
    texts = [levels, "[" * 5000, "a: &a [*a]\n", "{" * 400 + "}" * 400, "\x00", "- x\n", "machine: 7\nsweep: 3\n", ""]
    del file.attrs["scene_yaml"]
    file.attrs.create("scene_yaml", np.bytes_(_one(texts, random).encode() or b"\0"))


def odd_values(file: h5py.File, random: np.random.Generator, folder: Path) -> None:
    """Write values into a dataset that no results have."""
    data = file[_dataset(file, random)]
    values = data[()]
    flat = np.atleast_1d(values).ravel()
    if not flat.size:
        return
    places = random.integers(flat.size, size=int(random.integers(1, 4))) if random.random() < 0.6 else slice(None)
    if flat.dtype.kind == "f":
        flat[places] = ODD_NUMBERS[int(random.integers(len(ODD_NUMBERS)))]
    elif flat.dtype.kind == "S":
        flat[places] = _one([b"\xff", b"\x1b", b"\n", b"\x80", b"A"], random)
    else:
        low, high = np.iinfo(flat.dtype).min, np.iinfo(flat.dtype).max
        flat[places] = int(random.choice([low, high, -2 if low else 0, 3, 7, 100]))
    data[...] = flat.reshape(np.shape(values))


STRUCTURAL = (
    removed,
    renamed,
    other_kind,
    other_shape,
    leads_away,
    other_filter,
    attribute,
    attribute_huge,
    odd_values,
)


def mutated(source: Path, target: Path, random: np.random.Generator) -> str:
    """Write a mutant of a results file and return how it was made."""
    raw = source.read_bytes()
    if random.random() < 0.35:
        target.write_bytes(bytes_turned(raw, random))
        return "bytes"
    change = STRUCTURAL[int(random.integers(len(STRUCTURAL)))]
    target.write_bytes(raw)
    with h5py.File(target, "r+") as file:
        for _ in range(1 + (random.random() < 0.2)):
            # what HDF5 itself would not write ends the change: what it wrote so far is the mutant
            with suppress(OSError, RuntimeError, KeyError, ValueError, TypeError, OverflowError):
                change(file, random, source.parent)
    return change.__name__
