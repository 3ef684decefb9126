"""The core knows no effect by its name: what it asks of effects these declare (`effects.base`, `effects.parts.usual`).

Names in words of a source outside `screwsim.effects` are listed here, each file with its reason. A text that sends a
reader to `effects.NAME.key` has to be true.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import is_dataclass
from functools import cache
from pathlib import Path

from screwsim.effects import catalogue
from screwsim.scene.fields import Section, section_of

PACKAGE = Path(__file__).parents[2] / "src" / "screwsim"
SOURCES = [path for path in sorted(PACKAGE.rglob("*.py")) if path.relative_to(PACKAGE).parts[0] != "effects"]
HELPERS = {"base", "parts"}  # modules of effects that are no effect
PATH = re.compile(r"\beffects\.([a-z_]+)((?:\.[a-z_]+)*)")

SECTIONS = "sections of a scene's machine that have the names of their effects"
FIGURES = "a figure, a curve or an entry of results, which keeps its name"
REMEDY = "sends the reader of a message to the effect by name"
STUDY = "a study, page or export of this effect, above the simulation"
WORDS = "a word of its own that an effect is called by as well"
WRITES = "it writes scenes with effects"
ALLOWED = {
    "cli/export/loads.py": ({"bearings"}, "the help of an option says from where its default is"),
    "evaluate/cautions.py": ({"wall_heat"}, FIGURES),
    "evaluate/figures.py": ({"wall_heat"}, FIGURES),
    "evaluate/ledger/book.py": ({"oil_injection", "suction_line"}, FIGURES),
    "explain/__init__.py": ({"suction_port", "discharge_port"}, SECTIONS),
    "export/loads.py": ({"suction_port", "discharge_port"}, REMEDY),
    "export/rotor_loads.py": ({"gas_torque"}, FIGURES),
    "machine/profile_law.py": ({"blow_hole"}, WORDS),
    "machine/rotors/curves.py": ({"blow_hole"}, WORDS),
    "machine/settings.py": ({"suction_port", "discharge_port"}, SECTIONS),
    "machine/derived_sizes.py": ({"slide_valve"}, REMEDY),
    "outputs/core.py": ({"wall_heat"}, FIGURES),
    "outputs/variables.py": ({"drive"}, FIGURES),
    "report/drive.py": ({"motor", "gas_torque"}, STUDY),
    "report/rotors.py": ({"blow_hole", "slide_valve"}, STUDY),
    "report/rotors_scene.py": ({"slide_valve", "suction_port", "discharge_port"}, STUDY),
    "report/cycle.py": ({"gas_torque"}, STUDY),
    "scene/types.py": ({"air_package", "separator"}, REMEDY),
    "simulate.py": ({"drive"}, FIGURES),
    "solve/start_up.py": ({"drive"}, "a start-up is the study of the drive"),
    "solve/start_up_reading.py": ({"gas_torque"}, "one of its curves"),
    "study/calibration/read.py": ({"tip_leakage"}, REMEDY),
    "study/datasheet/air_rating.py": ({"air_package"}, STUDY),
    "study/datasheet/air_sheet.py": ({"air_package", "motor"}, STUDY),
    "study/datasheet/bearing_lives.py": ({"bearings"}, STUDY),
    "study/datasheet/bounds.py": ({"motor"}, STUDY),
    "study/datasheet/load_unload.py": ({"air_package"}, STUDY),
    "study/datasheet/gas_sheet.py": ({"air_package"}, STUDY),
    "study/datasheet/hottest_room.py": ({"separator"}, STUDY),
    "study/datasheet/machine_lines.py": ({"motor", "separator"}, STUDY),
    "study/datasheet/refrigeration_sheet.py": ({"economizer"}, STUDY),
    "study/datasheet/tables.py": ({"motor"}, STUDY),
    "study/part_load.py": ({"slide_valve", "suction_throttle", "bypass"}, STUDY),
    "study/stages/axes.py": ({"economizer"}, STUDY),
    "template/economizer.py": ({"economizer"}, WRITES),
    "template/two_stages.py": ({"economizer"}, WORDS),
    "template/refrigeration.py": ({"separator", "drive", "motor"}, WRITES),
}
IMPORTS = {  # of what an effect's file has
    "export/rotor_supports.py": {"bearings"},
    "solve/start_up.py": {"gas_torque"},
    "study/datasheet/air_points.py": {"air_package"},
    "study/datasheet/air_rating.py": {"air_package"},
    "study/datasheet/load_unload.py": {"air_package"},
    "study/datasheet/air_sheet.py": {"air_package"},
    "study/datasheet/machine_lines.py": {"motor"},
    "study/sizing.py": {"motor"},
    "study/stages/figures.py": {"air_package"},
    "template/gas.py": {"oil_drag"},
}


def named(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


@cache
def nodes(path: Path) -> list[ast.AST]:
    return list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))


@cache
def texts(path: Path) -> frozenset[str]:
    """Return the strings of a source, docstrings apart."""
    owners = (node for node in nodes(path) if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef))
    docs = {id(node.body[0].value) for node in owners if node.body and isinstance(node.body[0], ast.Expr)}
    strings = (node for node in nodes(path) if isinstance(node, ast.Constant) and isinstance(node.value, str))
    return frozenset(node.value for node in strings if id(node) not in docs)


def named_in(path: Path) -> set[str]:
    """Return the effects that strings of a source name: alone, or as effects.NAME."""
    effects, every = catalogue().keys(), texts(path)
    return (effects & every) | {name for text in every for name, _ in PATH.findall(text) if name in effects}


def imported(path: Path) -> set[str]:
    """Return the effects whose files a source imports from."""
    modules = [(node.module or "").split(".") for node in nodes(path) if isinstance(node, ast.ImportFrom)]
    return {each[2] for each in modules if each[:2] == ["screwsim", "effects"] and len(each) > 2} - HELPERS


def test_a_source_outside_of_the_effects_names_none_but_for_a_reason():
    found = {named(path): named_in(path) for path in SOURCES}
    assert {name: effects for name, effects in found.items() if effects} == {
        name: effects for name, (effects, _) in ALLOWED.items()
    }
    found = {named(path): imported(path) for path in SOURCES}
    assert {name: effects for name, effects in found.items() if effects} == IMPORTS


def test_every_text_that_sends_to_an_effect_or_its_key_tells_one_that_is_there():
    told = [(named(path), *found) for path in SOURCES for text in texts(path) for found in PATH.findall(text)]
    assert len(told) > 10
    assert [each for each in told if not exists(each[1], each[2])] == []


def exists(name: str, keys: str) -> bool:
    """Tell whether there is an effect of that name, with a key at that path."""
    if name not in catalogue():
        return False
    section = catalogue()[name].parameters
    assert is_dataclass(section)
    found = section_of(section)
    for key in keys.split(".")[1:]:
        if not isinstance(found, Section) or key not in found.fields:
            return False
        found = found.fields[key]
    return True


CHOICES = {  # choices of a scene that decide on more than one place: who holds them against a word
    ".how": set(),  # cycle.ways
    ".closing": set(),  # numerics.settings
    ".mode": {"machine/protocol.py"},
    ".transport": {"fluid/settings.py"},
    ".two_phase": {"fluid/settings.py", "fluid/real_gas.py"},
    ".law": {"machine/drive/train.py"},  # of the motor; a machine's laws are a registry (machine.laws)
    "gas.model": set(),  # fluid.models
    "parameters.model": set(),  # of gaps: effects.parts.gap_flow
    "numerics.error": set(),
    "self.error": set(),  # numerics.estimates
    "output.keep": set(),
    "output.derivatives": set(),
    "cycle.status": {"cycle/search.py", "evaluate/verdict.py"},  # else `closed` or `failed`
    "path.to": {  # a line's name
        "cycle/problem.py",
        "model/compose.py",
        "evaluate/cautions.py",
        "evaluate/late_valves.py",
        "export/loads.py",
        "evaluate/traces.py",
        "explain/__init__.py",
    },
    "profile.kind": set(),  # machine.rotors.rotors.CHAINS
    "parameters.kind": set(),
    "supply.kind": set(),
    "supply.source": set(),
}


def compared(path: Path) -> Iterator[str]:
    """Yield what a source holds against a word, or against the name of one."""
    for node in nodes(path):
        if isinstance(node, ast.Compare) and isinstance(node.left, ast.Attribute):
            words = node.comparators[0]
            if isinstance(words, ast.Tuple) and words.elts:
                words = words.elts[0]
            if (isinstance(words, ast.Constant) and isinstance(words.value, str)) or isinstance(words, ast.Name):
                yield ast.unparse(node.left)


def test_a_choice_is_held_against_its_words_in_one_place():
    """Elsewhere the answer is asked of what the choice selects: a property, or the entry of a registry."""
    every = [(named(path), left) for path in sorted(PACKAGE.rglob("*.py")) for left in compared(path)]
    for choice, allowed in CHOICES.items():
        assert {name for name, left in every if left.endswith(choice)} == allowed, choice
