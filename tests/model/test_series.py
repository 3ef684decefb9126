"""What the scenes of a series share: built and composed once, with the numbers of each scene for itself."""

import dataclasses
import math
from typing import get_args

import numpy as np
import pytest
from each_row import each_row
from folders import CONFIGS
from scenes import DROP, ECONOMIZER, FRICTION, HELD_GAPS, OIL_PORT, OIL_VOLUME, PUMPED_PORT, SOLUBLE, SOLUBLE_RATE, make

from screwsim.build import PartsCache, build_parts
from screwsim.effects.base import ChamberState, FlowPath, HeatRate, OilPort, Part, Wall
from screwsim.model import series
from screwsim.model.compose import compose
from screwsim.model.renumbering import OUTSIDE_TEXT, STRUCTURE, renumbered
from screwsim.model.series import Composer
from screwsim.scene import load, with_values
from screwsim.study.uncertainty.slopes import numeric_paths

SCENES = {
    "plain": {},
    "carried": {"oil.transport": "carried"},
    "economizer": ECONOMIZER,
    "orifice": OIL_PORT,
    "pumped": PUMPED_PORT,
    "soluble": SOLUBLE,
    "soluble over time": SOLUBLE_RATE,
    "room": OIL_VOLUME,
    "gaps": HELD_GAPS,
    "gas": {"gas": {"fluid": "R134a", "model": "ideal", "isentropic_exponent": 1.12}},
    "walls": {
        "oil.transport": "carried",
        "effects.wall_heat": {"rotor_area": "400 cm^2", "housing_area": "150 cm^2", "characteristic_length": "58 mm"},
    },
}
FRICTION_GAP = {"gap": "40 um", "length": "150 mm", "friction_fit": "flank", **FRICTION}
NUMBERS = {  # fields that only give numbers, places of breakpoints, or what is compared by itself
    FlowPath: {"values", "breakpoints", "own_breakpoints", "corners", "flow_coefficient", "tables", "mirror", "flow"},
    HeatRate: {"values"},
    Wall: {"values", "temperature"},
    ChamberState: {"values", "start"},
    OilPort: {"values", "breakpoints", "closes", "pressure", "pressure_loss"},
}
OPERATION = {  # of which the structure knows nothing
    "operation.speed": 290.0,
    "operation.discharge.pressure": 11e5,
    "oil_supply.temperature": 297.0,
    "oil.density": 970.0,
    "oil.heat_capacity": 2100.0,
}
BUILT = {"machine.volume.max": 5.9e-4, "machine.male_lobes": 5, "effects.tip_leakage.gap": 4.4e-5}


@each_row("kind", STRUCTURE)
def test_each_field_of_a_part_is_compared_or_is_a_number(kind):
    """A field in neither would let a series keep the text of another structure."""
    fields = {field.name for field in dataclasses.fields(kind)}
    assert fields == set(STRUCTURE[kind]) | NUMBERS[kind] and not NUMBERS[kind] & set(STRUCTURE[kind])


def test_parts_of_any_other_kind_must_be_equal():
    assert set(OUTSIDE_TEXT) < set(get_args(Part)) and not set(OUTSIDE_TEXT) & set(STRUCTURE)

    @dataclasses.dataclass(frozen=True)
    class Another:
        number: float

    scene = make()
    parts = [build_parts(scene) for _ in range(2)]
    for each, number in zip(parts, (1.0, 2.0), strict=True):
        each.effects["tip_leakage"] = (*each.effects["tip_leakage"], Another(number))
    composition = compose(parts[0])
    assert renumbered(parts[0], composition, parts[0]) is not None
    assert renumbered(parts[0], composition, parts[1]) is None


class Shared:
    """One series of scenes."""

    def __init__(self):
        self.parts_cache, self.composer = PartsCache(), Composer()

    def __call__(self, scene):
        return self.composer.compose(build_parts(scene, self.parts_cache))


def assert_same(one, other):
    for field in dataclasses.fields(one):
        if field.name != "recipe":
            left, right = getattr(one, field.name), getattr(other, field.name)
            if field.name == "together":
                left, right = left(), right()
            same = np.array_equal(left, right) if isinstance(left, np.ndarray) else left == right
            assert same, field.name


@pytest.mark.parametrize("name", SCENES)
def test_a_series_composes_each_scene_as_if_it_were_alone(name):
    scene, shared = make(SCENES[name]), Shared()
    for path, value in ({"operation.speed": 300.0} | OPERATION | BUILT).items():
        changed = with_values(scene, {path: value})
        found = shared(changed)
        assert_same(found, compose(build_parts(changed)))
        found.P[:] = np.nan  # what a solution does to its numbers is of no matter to the next


@each_row("path", OPERATION)
@each_row("name", ["plain", "carried", "room", "gas"])
def test_another_operation_is_not_composed_anew(name, path):
    scene, shared = make(SCENES[name]), Shared()
    first, other = shared(scene), shared(with_values(scene, {path: OPERATION[path]}))
    assert first.recipe is other.recipe
    assert not np.shares_memory(first.P, other.P)  # two solutions may live side by side


@pytest.mark.parametrize("path", BUILT)
def test_another_machine_or_effect_is_composed_anew(path):
    scene, shared = make(), Shared()
    assert shared(scene).recipe is not shared(with_values(scene, {path: BUILT[path]})).recipe


def test_what_decides_on_the_structure_is_composed_anew():
    """An oil that is carried or not, pumped or pushed through a bore, and effects that are there or not."""
    shared = Shared()
    for changes in ({}, {"oil.transport": "carried"}, OIL_PORT, PUMPED_PORT, SOLUBLE, {}):
        scene = make(changes)
        assert_same(shared(scene), compose(build_parts(scene)))


def test_what_is_lent_knows_the_same_and_keeps_nothing_for_its_lender():
    scene, shared = make(), Shared()
    first, lent = shared(scene), Shared()
    lent.parts_cache, lent.composer = shared.parts_cache.lent(), shared.composer.lent()
    assert lent(scene).recipe is first.recipe
    for volume in np.linspace(5e-4, 7e-4, 20).tolist():  # more than are kept
        lent(with_values(scene, {"machine.volume.max": volume}))
    assert shared(scene).recipe is first.recipe


SHIPPED = ("paper/point", "r134a/point", "r454b/point", "expander/point", "air/moist", "drive/point")


@pytest.mark.parametrize("name", SHIPPED)
def test_another_number_of_a_scene_needs_no_text_and_gives_what_composing_does(name):
    """Of its gas, too: a temperature of suction is one of an ideal gas's constants."""
    scene, stock = load(CONFIGS / f"{name}.yaml"), PartsCache()
    before = build_parts(scene, stock)
    composition = compose(before)
    for path, value in numeric_paths(scene)[0].items():
        parts = build_parts(with_values(scene, {path: value * (1.0 + 1e-6)}), stock)
        found, anew = renumbered(before, composition, parts), compose(parts)
        assert found is not None, path
        assert_same(found, anew)
        assert np.array_equal(found.recipe.P, anew.recipe.P)
        assert (found.recipe.held, found.recipe.angles) == (anew.recipe.held, anew.recipe.angles)


@pytest.mark.parametrize("name", ["air/fixed_speed_7", "r134a/compact"])
def test_another_number_of_a_scene_with_a_profile_is_written_only_where_tables_change(name):
    """Parts without any number may share one empty mapping."""
    scene, stock = load(CONFIGS / f"{name}.yaml"), PartsCache()
    before = build_parts(scene, stock)
    composition, written = compose(before), 0
    for path, value in numeric_paths(scene)[0].items():
        parts = build_parts(with_values(scene, {path: value * (1.0 + 1e-6)}), stock)
        found, anew = renumbered(before, composition, parts), compose(parts)
        if found is None:
            assert not np.array_equal(composition.TAB, anew.TAB), path
            written += 1
        else:
            assert_same(found, anew)
    assert 0 < written < 0.4 * len(numeric_paths(scene)[0])


def test_a_table_that_changes_and_changes_back_is_not_written_twice(monkeypatch):
    scene, stock, composer, written = load(CONFIGS / "r134a" / "compact.yaml"), PartsCache(), Composer(), []
    monkeypatch.setattr(series, "compose", lambda parts: written.append(parts) or compose(parts))
    length, speed = scene.machine.rotor_length, scene.operation.speed
    for changed in ({}, {"machine.rotor_length": 1.01 * length}, {"effects.tip_leakage.gap": 3e-5}, {}):
        found = with_values(scene, {"operation.speed": speed * (1.0 + 1e-3 * len(written)), **changed})
        parts = build_parts(found, stock)
        assert_same(composer.compose(parts), compose(parts))
    assert len(written) == 2


@pytest.mark.parametrize("model", ["real", "ideal"])
def test_a_gas_of_other_kernels_is_composed_anew(model):
    scenes = [make({"gas": {"fluid": "R134a", "model": each}}) for each in ("real", "ideal")]
    before, parts = map(build_parts, scenes if model == "ideal" else scenes[::-1])
    assert renumbered(before, compose(before), parts) is None


@pytest.mark.parametrize("name", SCENES)
def test_what_is_renumbered_is_of_the_same_structure(name):
    """Machine and effects of one scene are never taken for those of another."""
    more = {"no tips": {"effects.tip_leakage": DROP}, "reading": {"effects.tip_leakage.reading": "chamber"}}
    more |= {"lobes": {"machine.male_lobes": 5}, "friction": {"effects.interlobe_leakage": FRICTION_GAP}}
    before = build_parts(make(SCENES[name]))
    composition = compose(before)
    for changes in (SCENES | more).values():
        parts = build_parts(make(changes))
        found = renumbered(before, composition, parts)
        if found is not None:
            assert_same(found, compose(parts))
    assert renumbered(before, composition, build_parts(make({**SCENES[name], **more["no tips"]}))) is None


def test_a_table_of_the_volume_is_read_for_its_own_scene_alone(tmp_path):
    """The file of the scene before may be another by now, or gone."""
    file, shared, found = tmp_path / "v.csv", Shared(), []
    for power in (1.0, 1.5):
        rows = (f"{2 * i},{6e-4 * math.sin(math.pi * i / 360) ** (2 * power):.9e}\n" for i in range(361))
        file.write_text("angle_deg,volume_m3\n" + "".join(rows), encoding="utf-8")
        tabled = make({"machine.volume": {"law": "table", "max": "600 cm^3", "phi_A": None, "file": str(file)}})
        found.append(shared(tabled))
        assert_same(found[-1], compose(build_parts(tabled)))
    assert not np.array_equal(found[0].TAB, found[1].TAB)
    file.unlink()
    assert_same(shared(make()), compose(build_parts(make())))
