"""Write docs/reference: scene.md (all keys of a scene), figures.md (all results), equations.md, from the code.

    python docs/tools/reference_pages.py

A test holds the pages to what this writes.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from screwsim import outputs
from screwsim.effects import catalogue
from screwsim.explain.parameters import ABSENT, REQUIRED, SECTIONS, Key, effect_keys_of, section_keys
from screwsim.figures import known, needs_of
from screwsim.machine.kinds import MACHINES, TWIN_SCREW
from screwsim.scene import schema

sys.path.insert(0, str(Path(__file__).resolve().parent))  # a test takes this file by its path
from equations_page import equations_page

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "reference"
SCENE_HEAD = """\
# All keys of a scene

Made by `docs/tools/reference_pages.py` from the declarations that read a scene; `screwsim schema` prints the same as
JSON Schema for editors, and `screwsim explain SCENE.yaml --parameters [EFFECT]` adds the values of a scene. Every
quantity is written with its unit (`128 mm`, `20 degC`), of which the table shows one; a bare number is refused.
The number is read as it stands, then scaled: `0.11 MPa` and `1.1 bar` may differ in the last of their sixteen digits.
A key with a default, or a dash in its place, may be left out; *required* is what its section must have where it is
named. A value outside *range* is refused, one outside what is *usual* gives a warning. M… are equations of
[model.md](../model.md), S… of [slider-crank.md](slider-crank.md).

Gauge pressures are read where absolute ones are (`7 bar(g)`, `7 barg`, `100 psig`): over `operation.ambient_pressure`,
which is the standard atmosphere, 1.01325 bar, unless the scene states it.

A quantity or a number may have a tolerance: `27 um ± 5 um`, `3 ± 10 %`, `50 um ×/÷ 2`, in ASCII `+/-` and `*/`,
with `(k=1)` behind a standard uncertainty; the key `uncertainty` says which of them are fully correlated, and of which
validation the model error is reported,
`{correlated: [[PATH, PATH], …], model: NAME}` ([uncertainty.md](../how-to/uncertainty.md)).

Besides the sections below a scene may have `base: other.yaml`, whose paths it changes, a `title`, and a `sweep`, whose
keys are paths of these tables ([sweeps.md](../how-to/sweeps.md)). `--set operation.speed="1000 rpm"` overrides one.
`screwsim explain SCENE.yaml` says what a scene uses of all this.
"""
EFFECTS_HEAD = """\
## effects

Effects named in a scene are simulated, with the keys under them; all others are not simulated at all. `off` in place
of the keys leaves out an effect of the base. An effect of your own is named by the dotted name of its module
([adding-an-effect.md](../how-to/adding-an-effect.md)).
"""
FIGURES_HEAD = """\
# All results

Made by `docs/tools/reference_pages.py` from the tables that name them: in the JSON of `screwsim run --json`, in
`screwsim.simulate(scene)` and in HDF5 files, in SI units. A result contains the figures that its scene calls for (the
fourth column says what does); one without a value is null, and `notes` says why. `error` contains the estimated error
of each figure, relative to what the last column names and not always to the figure itself: a small difference of large
flows, or one power of several, has the error of those ([model.md](../model.md), M41; λ is the volumetric efficiency).
`status` is one of {statuses}.
"""
TABLES = (
    ("balance", "Residuals of the balances, and the `bound` that they must meet.", outputs.BALANCE),
    ("numerics", "Effort of the solution.", outputs.NUMERICS),
    (
        "cycle",
        "Traces over the angle; `mass_flow_<effect>` for each flow path, `heat_<effect>` [W] of oil to the gas.",
        outputs.CYCLE,
    ),
    ("ledger", "Where the shaft power goes.", outputs.LEDGER),
    ("ledger, of each effect", "`<name>_<effect>`.", outputs.LEDGER_ENTRY),
    ("knock-out", "Of `run --knock-out`, for each effect.", outputs.KNOCK_OUT),
    ("stages", "Of `screwsim run` of two stages.", outputs.STAGES),
)


def cell(text: Any) -> str:
    """Return a text that a Markdown table takes."""
    return str(text).replace("|", "\\|")


def table(keys: Sequence[Key]) -> str:
    """Return keys as a table, or that there are none."""
    rows = [
        f"| `{key.path}` | {cell(key.unit)} | {_code(key.default)} | {cell(key.range)} | {cell(key.meaning)} |"
        for key in keys
    ]
    heads = ["| key | unit | default | range | what |", "|---|---|---|---|---|"]
    return "\n".join([*heads, *rows]) if rows else "No keys."


def _code(default: str) -> str:
    return default if default == ABSENT or default.startswith(REQUIRED) else f"`{default}`"


def effect_text(name: str) -> str:
    """Return one effect: what it is, its equations, for which machines, its keys."""
    effect = catalogue()[name]
    kinds = [kind for kind, machine in MACHINES.items() if effect.fits(machine)]
    told = f"{effect.title[0].upper()}{effect.title[1:]}. {', '.join(effect.equations)}; {', '.join(kinds)}."
    return f"### {name}\n\n{told}\n\n{table(effect_keys_of(name, effect, kinds[0]))}\n"


def scene_page() -> str:
    """Return the page of all keys."""
    found = schema()["properties"]
    parts = [SCENE_HEAD]
    for kind, machine in zip(MACHINES, found["machine"]["anyOf"], strict=False):  # behind them: one's own
        parts.append(
            f"## machine, kind: {kind}\n\n{machine['description']}\n\n{table(section_keys('machine', kind))}\n"
        )
    for name in SECTIONS[1:]:
        parts.append(f"## {name}\n\n{found[name]['description']}\n\n{table(section_keys(name, TWIN_SCREW))}\n")
    parts.append(EFFECTS_HEAD)
    parts += [effect_text(name) for name in found["effects"]["properties"]]
    return "\n".join(parts)


def relative_to(scale: outputs.Scale) -> str:
    """Return in words what the estimated error of a figure is relative to (M41); λ is the volumetric efficiency."""
    if scale.unasked:
        return "not estimated"
    of = [f"`{each}`" for each in scale.of]
    least = " × ".join([*([f"{scale.least:g}"] if scale.least != 1.0 or not of else []), *of])
    least += f", where there is `{scale.where}`" if scale.where else ""
    found = {"ideal": ", × `ideal_isothermal_efficiency` where that is above 1", "filling": "", "": ""}[scale.times]
    if scale.alone:
        return least + found
    itself = "itself, at λ below 0.1 × 0.1/λ" if scale.times == "filling" else "itself"
    return (f"{itself}; {least} at least" if scale.least else itself) + found


def figures_page() -> str:
    """Return the page of all results."""
    parts = [FIGURES_HEAD.format(statuses=", ".join(f"`{each}`" for each in outputs.STATUSES))]
    parts.append("## performance\n\nFigures of the closed cycle.\n")
    lines = []
    for key, each in known().items():
        lines.append(
            f"| `{key}` | {each.units} | {cell(each.long_name)} | {cell(needs_of(key) or 'every scene')} "
            f"| {cell(relative_to(each.scale))} |"
        )
    head = ["| name | unit | what | called for by | its error is relative to |", "|---|---|---|---|---|"]
    parts.append("\n".join([*head, *lines, ""]))
    for name, told, variables in TABLES:
        lines = [f"| `{key}` | {each.units} | {cell(each.long_name)} |" for key, each in variables.items()]
        parts.append("\n".join([f"## {name}\n\n{told}\n", "| name | unit | what |", "|---|---|---|", *lines, ""]))
    return "\n".join(parts)


PAGES = {"scene.md": scene_page, "figures.md": figures_page, "equations.md": equations_page}

if __name__ == "__main__":
    for file, page in PAGES.items():
        (FOLDER / file).write_text(page(), encoding="utf-8")
        print(FOLDER / file)
