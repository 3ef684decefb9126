"""What a publication that uses a scene should cite: the program, its source paper, the gas, each effect's source."""

import importlib.metadata
import re
import sys
from collections.abc import Iterator

from screwsim.effects.base import Effect
from screwsim.explain.parameters import row
from screwsim.fluid.description import describe
from screwsim.outputs.customary import with_printed_units
from screwsim.scene.types import Scene
from screwsim.version import version

TITLE = (
    "Theoretical analysis of the efficiency of an oil-flooded screw compressor under frequency control of its "
    "refrigerating capacity"
)
PAPER = (
    "Chernov et al. 2015: G. I. Chernov, A. A. Panyutich, V. L. Yusha, V. K. Vasiliev, A. V. Zinovieva, "
    f"S. N. Mikhailets: {TITLE}. Omsk Scientific Bulletin, 2015 (in Russian)"
)
COOLPROP = "I. H. Bell, J. Wronski, S. Quoilin, V. Lemort, Ind. Eng. Chem. Res. 53 (2014) 2498, doi:10.1021/ie4033999"
_SOURCE = re.compile(r"^Source: (.*?)(?=^[A-Z]\w+: |^$|\Z)", re.M | re.S)


def sources(scene: Scene) -> str:
    """Return as text what to cite for a scene.

    An effect's source is that of its module's docstring, where it is written out; without one, that of its declaration.
    """
    rows = [row("screwsim", f"version {version()}; CITATION.cff has its authors and licence"), row("balances", PAPER)]
    rows += _of_gas(scene)
    rows += [row(name, source_of(active.effect)) for name, active in scene.effects.items()]
    title = [scene.title, ""] if scene.title else []
    last = "ours: of this program; M numbers: equations of docs/model.md"
    return with_printed_units("\n".join([*title, "To be cited", *rows, "", last]))


def source_of(effect: Effect) -> str:
    """Return in one line where the laws of an effect come from."""
    text = getattr(sys.modules.get(effect.build.__module__), "__doc__", None) or ""
    found = _SOURCE.search(text)
    return " ".join(found[1].split()) if found else effect.source


def _of_gas(scene: Scene) -> Iterator[str]:
    """Yield what is to be cited for the gas: its module, or CoolProp with the key of each fluid's equation there."""
    if "." in scene.gas.model:
        yield row("gas", f"{scene.gas.name} by {scene.gas.model}, a module of one's own; saturation by CoolProp")
    about = describe(scene.gas.name)
    keys = {name: describe(name).source for name in about.components or (scene.gas.name,)}
    told = ", ".join(f"{key} ({name})" for name, key in keys.items() if key)
    equation = f"; equation of state: {told} in CoolProp's bibliography" if told else ""
    yield row("CoolProp", f"version {importlib.metadata.version('CoolProp')}: {COOLPROP}{equation}")
