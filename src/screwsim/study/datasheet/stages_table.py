"""What the sheets of two stages of any kind share: a table of each stage's figures, the line between them, motors."""

from collections.abc import Iterator, Sequence
from math import sqrt
from typing import Any

from screwsim.figures.engineering import quantity
from screwsim.outputs import Result
from screwsim.scene import Scene
from screwsim.scene.lines import lines
from screwsim.study.datasheet.bounds import motor_of
from screwsim.study.datasheet.rated import celsius
from screwsim.study.datasheet.sheet import Table
from screwsim.study.datasheet.tables import BLANK, DUTY, HOUR, KW, NONE, PERCENT, Column, Lines, document_figures
from screwsim.study.stages import ChainResult
from screwsim.study.stages.axes import STAGE_NAMES
from screwsim.study.stages.read import COOLS, FLASHES, NOTHING, StageChain

BAR, MINUTE, RPM = 1e-5, 6e4, 9.549296585513721  # from Pa, m³/s to L/min, rad/s
EACH_STAGE = (  # figures of a stage, a row each
    Column("displacement_flow", "swept volume [m³/h]", HOUR, 1),
    Column("suction_pressure", "suction pressure [bar]", BAR, 3),
    Column("suction_temperature", "suction temperature [°C]", 1.0, 1, celsius=True),
    Column("discharge_pressure", "discharge pressure [bar]", BAR, 3),
    Column("pressure_ratio", "pressure ratio", 1.0, 2),
    Column("gas_mass_flow", "mass flow [kg/h]", HOUR, 0),
    Column("shaft_power", "shaft power [kW]", KW, 2),
    Column("electrical_power", "electrical power [kW]", KW, 2),
    Column("volumetric_efficiency", "volumetric efficiency [%]", PERCENT, 1),
    Column("isentropic_efficiency", "isentropic efficiency [%]", PERCENT, 1),
    Column("discharge_temperature", "discharge temperature [°C]", 1.0, 1, celsius=True),
    Column("separator_temperature", "separator temperature [°C]", 1.0, 1, celsius=True),
    Column("oil_flow_volume", "oil [L/min]", MINUTE, 1),
    Column("oil_supply_temperature", "oil temperature [°C]", 1.0, 1, celsius=True),
    Column(DUTY, "oil cooler duty [kW]", KW, 2),
)
BETWEEN = {NOTHING: "no cooler", COOLS: "a cooler", FLASHES: "a flash tank, whose vapour mixes in"}
DOCUMENT_FIGURES = tuple(column.figure for column in EACH_STAGE)


def each_stage_table(found: ChainResult, title: str) -> Iterator[Table]:
    """Yield the table of both stages beside each other; nothing where they have no results."""
    if found.status != "ok":
        return
    figures = [each.performance for each in found.stages]
    loads = [_motor_load(scene, each) for scene, each in zip(found.scenes, found.stages, strict=True)]
    rows = [["speed [rpm]", *(f"{RPM * scene.operation.speed:.0f}" for scene in found.scenes)]]
    for column in EACH_STAGE:
        if any(column.figure in each for each in figures):
            rows.append([column.title, *(column.cell(each) for each in figures)])
        if column.figure == "electrical_power" and any(loads):
            rows.append(["load of its motor [%]", *(load or NONE for load in loads)])
    yield Table(title, (BLANK, *(f"{name} stage" for name in STAGE_NAMES)), rows, left=1)


def _motor_load(scene: Scene, found: Result) -> str:
    motor = motor_of(scene)
    return "" if motor is None else f"{PERCENT * found.performance.shaft_power / motor.rated_power:.0f}"


def between_line(chain: StageChain, found: Result) -> Lines:
    """Yield what lies between both stages, and the pressure there beside the geometric mean of both ends."""
    between, p = chain.intercooler, found.performance.get("intermediate_pressure")
    words = BETWEEN[between.kind]
    if between.outlet_temperature is not None:
        words += f" to {celsius(between.outlet_temperature):.4g} °C"
    if between.pressure_drop > 0.0:
        words += f", pressure drop {quantity('Pa', between.pressure_drop)}"
    if p is not None:
        T = found.performance.get("intermediate_temperature")
        at = "" if T is None else f" ({celsius(T):.1f} °C)"
        mean = sqrt(lines(chain.first).p_s * lines(chain.second).p_d)
        words += f"; {quantity('Pa', p)}{at}, geometric mean of both ends {quantity('Pa', mean)}"
        heat = found.performance.get("intercooler_heat")
        words += f"; the cooler takes {KW * heat:.1f} kW" if between.cools and heat is not None else ""
    yield "between", words


def motor_lines(chain: StageChain, found: ChainResult) -> Lines:
    """Yield the rating of each motor, and its load at the own point."""
    loads = [f", {_motor_load(*each)} % of it at the point" for each in zip(found.scenes, found.stages, strict=False)]
    parts = []
    for number, (name, scene) in enumerate(chain.by_stage.items()):
        motor = motor_of(scene)
        if motor is not None:
            load = loads[number] if number < len(loads) else ""
            parts.append(f"{name} stage {quantity('W', motor.rated_power)} rated at the shaft{load}")
    if parts:
        yield "motors", "; ".join(parts)


def swept_line(found: ChainResult) -> Lines:
    """Yield the swept volume and the speed of each stage."""
    if len(found.scenes) == len(found.stages) and found.stages:
        swept = (quantity("m3 s-1", each.performance["displacement_flow"]) for each in found.stages)
        speeds = (f"{RPM * scene.operation.speed:.4g} rpm" for scene in found.scenes)
        parts = zip(STAGE_NAMES, swept, speeds, strict=True)
        yield "stages", ", ".join(f"{name} {volume} swept at {speed}" for name, volume, speed in parts)


def stage_documents(found: ChainResult) -> list[dict[str, Any]]:
    """Return the figures of each stage [SI] for programs, with their estimated errors."""
    return [_with_errors(document_figures(each, DOCUMENT_FIGURES), each, DOCUMENT_FIGURES) for each in found.stages]


def _with_errors(document: dict[str, Any], found: Result, names: Sequence[str]) -> dict[str, Any]:
    return document | {"error": {name: found.error[name] for name in names if found.error.get(name) is not None}}


def own_document(found: Result, names: Sequence[str]) -> dict[str, Any]:
    """Return figures of the whole [SI] at its own point for programs, with their estimated errors."""
    return _with_errors(document_figures(found, names), found, names)


def ignored_model_errors(chain: StageChain) -> Iterator[str]:
    """Yield a note where a scene names the validation of its model, which does not hold for two stages together."""
    for name, scene in chain.by_stage.items():
        if scene.model_error:
            yield f"the model error of the {name} scene is ignored (screwsim run of that scene shows it)"
