"""Rules of the JSON Schema: it says what the reader accepts, from the same declarations."""

import json
import re

import pytest

from screwsim.effects import catalogue
from screwsim.machine.kinds import MACHINES
from screwsim.scene import loads, schema
from screwsim.scene.fields import FIXED, SWEEPABLE, leaf_paths
from screwsim.scene.yaml_tree import LocatedFaults, Node, Position, compose


def objects(part, path=""):
    """Yield (path, schema) of every object that has properties."""
    if isinstance(part, dict):
        if "properties" in part and "description" in part:
            yield path, part
        for name, inner in part.items():
            yield from objects(inner, f"{path}/{name}")


def plain(node: Node):
    """Return a YAML tree as plain Python."""
    if isinstance(node.value, dict):
        return {name: plain(child) for name, child in node.value.items()}
    return [plain(item) for item in node.value] if isinstance(node.value, list) else node.value


def accepts(part, value) -> bool:
    """Return whether a value fits the keywords of a schema that a scene without lists uses."""
    if "anyOf" in part and "properties" not in part:
        return any(accepts(each, value) for each in part["anyOf"])
    if value is None:
        return "null" in part.get("type", ()) or None in part.get("enum", ())
    if "enum" in part:
        return value in part["enum"]
    if isinstance(value, dict):
        patterns = part.get("patternProperties", {})
        return all(
            accepts(part["properties"][name], inner)
            if name in part["properties"]
            else any(re.search(pattern, name) for pattern in patterns)
            for name, inner in value.items()
        )
    if isinstance(value, str):
        return "string" in part["type"] and bool(re.search(part.get("pattern", ""), value))
    return bool({"number", "integer"} & set([part["type"]] if isinstance(part["type"], str) else part["type"]))


@pytest.mark.parametrize("word", ["off", "no", "No", "FALSE"])
def test_an_effect_may_be_off(word, example):
    effect = schema()["properties"]["effects"]["properties"]["blow_hole"]
    assert re.search(effect["pattern"], word)
    assert not re.search(effect["pattern"], "on")
    assert effect["not"] == {"const": True}
    assert "blow_hole" not in loads(example.replace("blow_hole: {area: 6 mm^2}", f"blow_hole: {word}")).effects


def test_it_is_plain_json():
    assert json.loads(json.dumps(schema())) == schema()
    assert schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_every_object_is_closed_and_described():
    found = list(objects(schema()))
    assert len(found) > 15
    assert [path for path, part in found if part["additionalProperties"] is not False or not part["description"]] == []


def test_every_effect_is_there_with_its_parameters():
    effects = schema()["properties"]["effects"]["properties"]
    assert list(effects) == list(catalogue())
    assert effects["oil_heat"]["properties"]["equation_12"]["enum"] == ["corrected", "printed", None]
    assert effects["blow_hole"]["properties"]["closes"]["default"] == "693 deg"


def test_what_must_be_there_is_demanded_unless_a_base_gives_it():
    assert schema()["anyOf"] == [{"required": ["base"]}, {"$ref": "#/$defs/complete"}]
    complete = schema()["$defs"]["complete"]
    assert complete["required"] == ["machine", "gas", "operation"]
    either = [{"required": ["speed"]}, {"required": ["tip_speed"]}]
    assert complete["properties"]["operation"]["allOf"] == [{"anyOf": either}]
    assert complete["properties"]["effects"]["properties"]["tip_leakage"]["required"] == ["gap"]


def test_every_path_that_can_vary_is_an_axis():
    parameters = {name: effect.parameters for name, effect in catalogue().items()}
    leaves = {path: leaf for kind in MACHINES for path, leaf in leaf_paths(parameters, kind).items()}
    expected = [path for path, leaf in leaves.items() if leaf.kind in SWEEPABLE and path not in FIXED]
    found = schema()["properties"]["sweep"]["properties"]
    assert list(found) == [*expected, "zip", "sample"]
    assert list(found["zip"]["items"]["properties"]) == expected
    assert list(found["sample"]["properties"]["over"]["properties"]) == expected
    references = {part["$ref"].rpartition("/")[2] for part in found.values() if "$ref" in part}
    assert references <= set(schema()["$defs"])


@pytest.mark.parametrize("canonical", [False, True])
def test_it_accepts_a_scene(example, canonical):
    tree = compose(loads(example).text if canonical else example, Position(0, "x"), LocatedFaults())
    assert tree is not None
    assert accepts(schema(), plain(tree))


@pytest.mark.parametrize(
    ("path", "value"), [("speed", "3000"), ("speed", 3000), ("speeed", "1 rpm"), ("speed", "1,5 rpm")]
)
def test_it_refuses_what_the_reader_refuses(path, value):
    operation = schema()["properties"]["operation"]
    assert not accepts(operation, {path: value})
