"""The page on adding a machine names all that the protocol asks, and every effect under what it needs."""

import dataclasses
import re
from pathlib import Path

from screwsim.effects import catalogue
from screwsim.machine import protocol

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "adding-a-machine.md").read_text(encoding="utf-8")
ROWS = dict(re.findall(r"^\| `([A-Z_]+)` \|.*\| ([a-z_, ]+) \|$", PAGE, flags=re.MULTILINE))


def test_every_effect_stands_beside_what_it_needs():
    needed = {name: effect.needs for name, effect in catalogue().items() if effect.needs}
    found = {effect: frozenset({getattr(protocol, row)}) for row, names in ROWS.items() for effect in names.split(", ")}
    assert found == needed


def test_every_part_of_the_protocol_is_named():
    named = set(re.findall(r"`(\w+)", PAGE))
    assert {field.name for field in dataclasses.fields(protocol.MachineKind)} <= named
    for part in (protocol.MachineSettings, protocol.MachineGeometry):
        public = {name for name in (*vars(part), *part.__annotations__) if not name.startswith("_")}
        assert public <= named
