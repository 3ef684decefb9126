"""Effects declare their figures: a scene that names one has them, with unit, meaning and scale, and no other has."""

import json
import math
import pickle
import sys
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from each_row import each_row
from scenes import make, scene_dict

from screwsim import simulate
from screwsim.build import build_parts
from screwsim.cycle.powers import power_losses
from screwsim.effects import catalogue
from screwsim.effects.base import PowerLoss
from screwsim.explain import explain
from screwsim.figures import Performance, called_for, declared, known, merged, packed, unpacked
from screwsim.figures.engineering import engineering
from screwsim.figures.errors import error_scale
from screwsim.inputs.faults import UsageError
from screwsim.model.parts import Effects
from screwsim.outputs import EFFICIENCY, ITSELF, PERFORMANCE, Figure, Figures, Result, Scale, over
from screwsim.report.page import tables
from screwsim.results import open_results, save
from screwsim.results.schema import axes_of
from screwsim.results.table import InMemory, join, table_of
from screwsim.results.write import write_tables
from screwsim.scene import load, loads
from screwsim.study.compare import compare
from screwsim.study.sweep.part_files import is_whole, read_part, write_part
from screwsim.study.validation import sibling

ROOT = Path(__file__).parents[2]
each = sibling(ROOT / "docs" / "tools" / "each_effect.py")
PISTON = ROOT / "configs" / "slider_crank" / "r134a.yaml"
ROTORS = ROOT / "configs" / "rotors" / "b.yaml"
ENDS = "suction: {distance: 40 mm, rating: 90 kN}, discharge: {distance: 40 mm, rating: 90 kN}, axial: {rating: 90 kN}"
LOADED = (
    "effects.bearings={load: rotors, friction_coefficient: 0.0018, bore: 60 mm, shaft_diameter: 50 mm, "
    "life_of_set: weibull, "
    f"male: {{{ENDS}}}, female: {{{ENDS}}}}}"
)
CHECKED = "effects.check_valves={suction_area: 50 mm^2, discharge_area: 28 mm^2}"
FULL = {  # what of an effect's parameters calls for the rest of its figures
    "plenums": ("effects.plenums.suction_volume=5 l",),
    "gas_torque": tuple(
        f"effects.gas_torque.{key}" for key in ("male_share=0.9", "axial_area=30 cm^2", "radial_area=60 cm^2")
    ),
    "motor": (*each.CONDENSER, "effects.oil_heat=off", "effects.oil_pump=off"),
}
FULL["oil_pump"] = ("effects.oil_pump.line={length: 3 m, diameter: 20 mm}",)
FULL["liquid_injection"] = ("effects.liquid_injection.discharge_temperature=60 degC",)
POINTS = Path(__file__).with_name("r134a_in_ester.csv")
THIN = ("films_at=suction", "oil_molar_mass=590 g/mol")
FULL["refrigerant_solubility"] = tuple(
    f"effects.refrigerant_solubility.{key}" for key in (f"points_file={POINTS}", *THIN)
)
FULL["separator"] = (
    "oil_supply.temperature=null",
    "effects.separator={cooler: {conductance: 1 kW/K, coolant_temperature: 300 K}}",
)
FULL["air_package"] = (
    *each.CARRIED,
    "oil_supply.temperature=null",
    "effects.separator={cooler: {discharge_temperature: 350 K}}",
    "effects.air_package.aftercooler={pressure_loss: 0.1 bar, approach: 10 K}",
    "effects.air_package.fan={power: 1 kW}",
    "effects.air_package.coolant={medium: water, temperature_rise: 15 K}",
    *("gas.fluid=Air", "gas.relative_humidity=0.6"),
)
INSTEAD = {"separator": ("oil_supply.temperature=325 K",)}  # what a scene without the effect needs
GIVE = sorted(name for name, effect in catalogue().items() if effect.figures)


def scene_with(name: str):
    """Return a scene that calls for all figures of an effect, and how to leave that out."""
    if name == "bearings":
        return load(ROTORS, (LOADED,))
    if name in each.ROWS:
        return each.with_it(name, FULL.get(name, ()))
    return load(PISTON, (CHECKED, "effects.reed_valves=off") if name == "check_valves" else ())


def called(scene):
    return called_for(scene, build_parts(scene))


def stored(scene, figures, path):
    """Return the JSON and the file of a result that has a value of every figure."""
    result = Result("ok", performance=Performance(dict.fromkeys(figures, 1.0), figures), error=Figures())
    save(path, scene, result)
    return result.as_json()["performance"], open_results(path)


@pytest.mark.parametrize("name", GIVE)
def test_a_scene_has_the_figures_of_an_effect_with_it_and_not_without_it(name, tmp_path):
    scene = scene_with(name)
    own = {figure.name: figure for figure in catalogue()[name].figures}
    document, results = stored(scene, called(scene), tmp_path / "with.h5")
    assert set(own) <= set(document)
    for figure, about in own.items():
        assert results.performance.about[figure] == (about.units, about.long_name) and about.units and about.long_name
        assert results.figure(figure).scale == about.scale
    without = loads(scene.text, folder=scene.folder, overrides=[f"effects.{name}=off", *INSTEAD.get(name, ())])
    document, results = stored(without, called(without), tmp_path / "without.h5")
    assert not set(own) & {*document, *results.performance, *results.error}


def test_every_figure_that_the_core_gives_on_a_condition_is_called_for_by_it():
    expander = load(ROOT / "configs" / "expander" / "point.yaml")
    everything = load(ROOT / "configs" / "everything.yaml")
    throttled = load(ROOT / "configs" / "control" / "throttle.yaml")
    over_time = each.with_it("refrigerant_solubility", ("effects.refrigerant_solubility.flash_time=5 ms",))
    moist = load(ROOT / "configs" / "air" / "humid_package.yaml")
    blend = load(ROOT / "configs" / "r454b" / "point.yaml")
    wet = load(ROOT / "configs" / "r134a" / "point.yaml", ["gas.two_phase=equilibrium"])
    scenes = expander, everything, throttled, over_time, moist, blend, wet, load(PISTON)
    every = [set(called(scene)) & set(PERFORMANCE) for scene in scenes]
    assert set.union(*every) == set(PERFORMANCE)
    assert {name for name, figure in PERFORMANCE.items() if not figure.needs} == set.intersection(*every)


CONTRACT = """
    isothermal_efficiency ideal_isothermal_efficiency isentropic_efficiency volumetric_efficiency gas_mass_flow
    oil_mass_flow oil_ratio oil_flow_ratio indicated_power oil_lift_power oil_pump_power hydromechanical_power
    mechanical_power shaft_power discharge_temperature oil_discharge_temperature peak_pressure work_per_cycle
    trapped_mass
"""


@pytest.mark.parametrize("machine", ["paper", "r134a"])
def test_what_others_rely_on_is_called_for_at_both_points(machine):
    figures = called(load(ROOT / "configs" / machine / "point.yaml"))
    assert [name for name in CONTRACT.split() if name not in figures] == []
    assert ({"cooling_capacity", "cop"} <= set(figures)) == (machine == "r134a")


def test_a_case_that_failed_says_so_of_its_figures():
    none = Performance({}, called(make({})))
    assert dict(none) == {} and none.copy().about == none.about
    with pytest.raises(AttributeError, match=r"^no figure 'shaft_power' here: the case failed \(see its message"):
        _ = none.shaft_power
    with pytest.raises(AttributeError, match=r"^no figure 'electrical_power' here: it needs effects\.motor$"):
        _ = none.electrical_power
    again = pickle.loads(pickle.dumps(Performance({"shaft_power": 1.0}, none.about)))
    assert again.shaft_power == 1.0 and again.about == none.about


def test_no_figure_has_two_declarations():
    told = [figure for effect in catalogue().values() for figure in effect.figures]
    for figure in told:
        assert known()[figure.name] == figure and figure.name not in PERFORMANCE
    assert [name for name in known() if not known()[name].units or not known()[name].long_name] == []


def test_what_a_scale_asks_for_is_there_wherever_its_figure_is():
    for scene in (load(ROOT / "configs" / "everything.yaml"), *(scene_with(name) for name in GIVE)):
        figures = called(scene)
        for figure in figures.values():
            assert set(figure.scale.of) <= set(figures), figure.name


TRACED = {"gas_torque": FULL["gas_torque"], "drive": (), "plenums": FULL["plenums"]}


@pytest.mark.slow
@pytest.mark.parametrize("name", TRACED)
def test_a_scene_has_the_curves_that_an_effect_declares(name, tmp_path):
    result = simulate(scene_with(name))
    assert {each.name for each in catalogue()[name].traces} <= set(result.cycle), result.message
    save(tmp_path / "x.h5", scene_with(name), result)
    stored = open_results(tmp_path / "x.h5").cycle
    for each in catalogue()[name].traces:
        assert stored.about[each.name] == (each.units, each.long_name)
    assert all(about.units != "1" for about in stored.about.values())


def test_losses_stand_before_the_power_that_they_are_part_of():
    names = list(called(make({})))
    at = names.index("shaft_power")
    assert names[at - 3 : at] == ["oil_pump_power", "hydromechanical_power", "mechanical_power"]


# ---- an effect of one's own ----------------------------------------------------------------------------------------

OWN = '''\
"""Share: what of the shaft power is lost, a figure of a user's own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from screwsim.inputs.declare import number
from screwsim.effects.base import Effect, PowerLoss, Reading
from screwsim.outputs import Figure, Scale, Trace, power_figure


@dataclass(frozen=True)
class Parameters:
    """Loss [W], and how often it counts."""

    loss: float = number("lost", 100.0)
    twice: float | None = number("ask for it twice", None)


def build(parameters, machine):
    def read(figures):
        share = parameters.loss / figures.shaft_power
        return {"lost_share": share, "lost_twice": 2.0 * share, "found_efficiency": WHY}

    def curves(known):
        return {"own_curve": np.ones(8)}

    return [PowerLoss("own_power", lambda known: parameters.loss), Reading(NAMES, read, curves)]


WHY = "nobody measured it"
NAMES = ("lost_share", "lost_twice", "found_efficiency")
EFFECT = Effect(
    name="share",
    title="share of a loss",
    equations=(),
    source="a test",
    parameters=Parameters,
    build=build,
    figures=(
        power_figure("own_power", "loss of one's own"),
        Figure("lost_share", "1", "share of the shaft power that is lost", Scale(0.25)),
        Figure("lost_twice", "1", "the same twice", needs=(".twice",)),
        Figure("found_efficiency", "1", "efficiency that somebody finds", Scale(0.5)),
    ),
    traces=(Trace("own_curve", "N m", "curve of one's own"),),
)
'''


@pytest.fixture
def own(tmp_path, monkeypatch):
    """Return a function that loads a scene with the effect, whose one file lies in the working folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    home = f"own_figures_{tmp_path.name.strip('_')}".lower().replace("-", "_")
    (tmp_path / home).mkdir()
    (tmp_path / home / "share.py").write_text(OWN)

    def scene(parameters=None, **changes):
        text = scene_dict({})
        dry = {name: text["effects"][name] for name in ("suction_port", "discharge_port", "tip_leakage")}
        effects = {**dry, f"{home}.share": parameters or {}}
        text = {name: section for name, section in text.items() if name not in ("oil", "oil_supply")}
        return loads(json.dumps({**text, "effects": effects, **changes}), folder=str(tmp_path))

    yield scene
    for name in [name for name in sys.modules if name.startswith(home)]:
        del sys.modules[name]


def test_a_figure_of_ones_own_goes_everywhere_by_its_one_file(own, tmp_path):
    from screwsim import simulate

    scene = own()
    result = simulate(scene)
    assert result.status == "ok", result.message
    power = result.performance.shaft_power
    assert result.performance.lost_share == 100.0 / power
    assert list(result.performance)[-2:] == ["lost_share", "found_efficiency"]
    document = result.as_json()
    assert document["performance"]["found_efficiency"] is None
    assert document["notes"]["found_efficiency"] == "nobody measured it"
    assert "lost_twice" not in document["performance"]
    assert result.error.lost_share == pytest.approx(result.error.shaft_power * (100.0 / power) / 0.25, rel=1e-3)
    assert "figure own_power, figure lost_share, figure found_efficiency" in " ".join(str(explain(scene)).split())
    save(tmp_path / "own.h5", scene, result)
    results = open_results(tmp_path / "own.h5")
    assert float(results.performance["lost_share"]) == result.performance.lost_share
    assert math.isnan(results.performance["found_efficiency"]) and "lost_twice" not in results.performance
    assert results.figure("lost_share").scale == Scale(0.25)
    assert results.cycle.about["own_curve"] == ("N m", "curve of one's own") and np.all(results.cycle["own_curve"] == 1)
    rows = {row[0]: row for row in tables.figures(results, ())}
    assert rows["lost share"][1:3] == (f"{100.0 / power:.5g}", "") and "found efficiency" not in rows
    same = compare(results, results)
    assert next(each for each in same.figures if each.figure == "lost_share").error == pytest.approx(
        2.0 * 0.25 * result.error.lost_share, rel=1e-9
    )


def test_a_figure_of_ones_own_says_what_would_give_it(own):
    scene = own()
    name = next(effect for effect in scene.effects if "." in effect)
    found = simulate(scene, trace=False).performance
    with pytest.raises(AttributeError, match=rf"^no figure 'lost_twice' here: it needs .*\b{name}\.twice\b"):
        _ = found.lost_twice
    assert simulate(own({"twice": 1}), trace=False).performance.lost_twice > 0.0


def test_a_figure_that_nobody_declares_is_a_fault_of_its_effect(own, tmp_path):
    (path,) = tmp_path.glob("own_figures_*/share.py")
    path.write_text(OWN.replace('"lost_share", "lost_twice"', '"lost_shape", "lost_twice"'))
    scene = own()
    with pytest.raises(
        UsageError, match=r"^effects\.\S+share: its figure lost_shape is declared nowhere \(write figures="
    ):
        called(scene)


def test_a_figure_of_ones_own_cannot_have_the_name_of_another(own, tmp_path):
    (path,) = tmp_path.glob("own_figures_*/share.py")
    path.write_text(OWN.replace("lost_share", "shaft_power"))
    scene = own()
    with pytest.raises(
        UsageError, match=r"^effects\.\S+share: the program has a different figure shaft_power \(rename"
    ):
        called(scene)


def test_losses_of_one_name_add_up():
    """Two effects may give one figure, declared once: neither is lost in the shaft power."""
    parts = Effects({"a.b": [PowerLoss("mechanical_power", lambda known: 2.0)],
                     "mechanical": [PowerLoss("mechanical_power", lambda known: 3.0)]})  # fmt: skip
    assert power_losses(parts, SimpleNamespace(indicated_power=1.0)) == {"mechanical_power": 5.0}


# ---- scales are declared -------------------------------------------------------------------------------------------


def test_a_scale_is_what_is_declared_whatever_the_name():
    known_figures = {"x_power": -3.0, "x_efficiency": 0.02, "gas_torque": 0.5, "swing": 8.0}
    for name in known_figures:
        assert error_scale(name, ITSELF, known_figures) == abs(known_figures[name])
        assert error_scale(name, over("swing"), known_figures) == 8.0
    assert error_scale("gas_torque", EFFICIENCY, known_figures) == 0.5
    assert error_scale("x_efficiency", EFFICIENCY, known_figures) == 0.1
    assert error_scale("swing", over("gas_torque", alone=True), known_figures) == 0.5
    assert engineering(Figure("x_efficiency", "1", "plain"), 0.5) == ("0.5", "")
    assert engineering(Figure("sly", "1", "efficient", EFFICIENCY), 0.5) == ("50", "%")


@each_row("scale", dict.fromkeys(figure.scale for figure in known().values()))
def test_a_scale_survives_its_text(scale):
    assert unpacked(packed(scale)) == scale


@each_row("text", ["", "3", "[]", '{"least": "x"}', '{"of": [1]}', '{"times": "x"}', '{"more": 1}', "{"])
def test_a_text_that_is_no_scale_is_none(text):
    assert unpacked(text) is None


# ---- files with cases of different effects, and older ones -------------------------------------------------------


def performance(name: str, **values: float) -> Performance:
    return Performance(values, called_for(make({}), build_parts(make({}))) if name == "oiled" else DRY)


DRY = {name: PERFORMANCE[name] for name in ("shaft_power", "discharge_temperature")} | {
    "motor_loss": declared("motor_loss")
}


def cases() -> list[Result]:
    return [
        Result("ok", performance=performance("oiled", shaft_power=1.0, oil_ratio=3.0)),
        Result("failed", performance=performance("dry")),
        Result("ok", performance=performance("dry", shaft_power=2.0, motor_loss=4.0)),
    ]


def test_a_file_holds_the_figures_of_all_of_its_cases(tmp_path):
    grid = loads(json.dumps({**scene_dict({}), "sweep": {"oil_supply.ratio": [1, 2, 3]}}))
    save(tmp_path / "x.h5", grid, cases())
    results = open_results(tmp_path / "x.h5")
    assert results.performance["oil_ratio"].tolist()[0] == 3.0
    assert [math.isnan(value) for value in results.performance["oil_ratio"]] == [False, True, True]
    assert [math.isnan(value) for value in results.performance["motor_loss"]] == [True, True, False]
    names = list(results.performance)
    assert names.index("motor_loss") > names.index("discharge_temperature") > names.index("shaft_power")
    assert "bearing_power" not in names


def test_parts_of_a_sweep_with_other_figures_join(tmp_path):
    whole = table_of(cases(), keep_cycle=False)
    parts = [table_of([result], keep_cycle=False) for result in cases()]
    for number, part in enumerate(parts):
        write_part(tmp_path / str(number), part)
        assert is_whole(tmp_path / str(number), 1)
    joined = join([read_part(tmp_path / str(number)) for number in range(3)])
    assert joined.about == whole.about
    for figure in whole.about:
        assert joined.column("performance", figure.name).tolist() == pytest.approx(
            whole.column("performance", figure.name).tolist(), nan_ok=True
        )
    grid = loads(json.dumps({**scene_dict({}), "sweep": {"oil_supply.ratio": [1, 2, 3]}}))
    write_tables(tmp_path / "x.h5", grid, axes_of(grid), InMemory(joined), "sweep")
    assert open_results(tmp_path / "x.h5").performance["motor_loss"].tolist()[2] == 4.0


def test_figures_of_two_cases_keep_the_order_of_each():
    a, b, c, d = (Figure(name, "1", name) for name in "abcd")
    assert merged((a, c), (a, b, c, d)) == (a, b, c, d)
    assert merged((), (b, a)) == (b, a) and merged((a, b), ()) == (a, b)


def test_an_older_file_with_all_figures_is_read_as_ever(tmp_path):
    """It has every figure, NaN where its scene called for none, and does not say what errors are relative to."""
    figures = called(make({}))
    values = dict.fromkeys(figures, 1.0)
    save(tmp_path / "new.h5", make({}), Result("ok", performance=Performance(values, figures), error=Figures(values)))
    save(tmp_path / "old.h5", make({}), Result("ok", performance=Performance(values, known()), error=Figures(values)))
    with h5py.File(tmp_path / "old.h5", "r+") as file:
        for data_set in file["error"].values():
            data_set.attrs.pop("relative_to", None)
    old, new = open_results(tmp_path / "old.h5"), open_results(tmp_path / "new.h5")
    assert math.isnan(old.performance["bearing_power"]) and "bearing_power" not in new.performance
    assert compare(old, new).equal
    for name in figures:
        assert old.figure(name).scale == new.figure(name).scale, name
    rows = [tables.figures(each, ()) for each in (old, new)]
    assert sorted(rows[0]) == sorted(rows[1]) and len(rows[1]) == len(figures)
