"""Two new stages in series, sized together: what is asked for is delivered, and the pressure ratio divided equally.

Delivery is nearly proportional to the size of the first stage, and the pressure between both to the ratio of the first
size to the second, so that a few solutions find both.
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from screwsim.figures.engineering import figure_text
from screwsim.inputs.faults import SceneError, UsageError
from screwsim.outputs.customary import ZERO_CELSIUS, in_bar
from screwsim.scene import Scene, loads
from screwsim.study.sizing import motor_load
from screwsim.study.stages import ChainResult, run_stages
from screwsim.study.stages.axes import STAGE_NAMES, Intercooler
from screwsim.study.stages.chain import StageChain
from screwsim.study.stages.read import apart
from screwsim.template import two_stages
from screwsim.template.request import SceneRequest
from screwsim.template.sizes import rounded_flow
from screwsim.template.two_stages import AIR, COOLING, HEATING, Ends, Found

DELIVERED, COOLS, HEATS = "free_air_delivered", "cooling_capacity", "heating_capacity"
STATED = {AIR: DELIVERED, COOLING: COOLS, HEATING: HEATS}
NEAR, TRIES = 1e-3, 8  # relative tolerance of what is delivered, and number of pairs of sizes tried
FIRM, ROUNDED = 3, 5e-3  # numbers of scenes are rounded, so that sizes jump: the tolerance after so many tries
EQUAL, NEARLY = 0.02, 0.05  # relative tolerance of the pressure between both, and that after FIRM tries
WIDER, TIMES = 1.3, 2  # by how much the second stage grows where it cannot take the first one's gas, and how often


class SizedStages(NamedTuple):
    """The texts of both new scenes and the ends they were made for, the chain, and its result."""

    texts: tuple[str, str]
    ends: Ends
    chain: StageChain
    result: ChainResult


def sized_stages(kind: str, asked: SceneRequest) -> SizedStages:
    """Return two new stages that deliver what is asked for; raise UsageError, in one line, where none do."""
    ends = two_stages.ends_of(kind, asked)
    figure, wanted = STATED[kind], asked.free_air if kind == AIR else asked.capacity
    found = two_stages.first_found(kind, asked, ends)
    wider = TIMES
    for count in range(TRIES):
        both = _solved(kind, asked, ends, found, warm=True)
        p = both.result.performance
        value = p.get(figure) if both.result.status == "ok" else None
        if both.result.status == "failed" and wider:
            found, wider = found._replace(second=rounded_flow(WIDER * found.second)), wider - 1
            continue
        if not value or value <= 0.0:
            why = both.result.message or f"no {figure.replace('_', ' ')}"
            what = f"the machines tried for {ends.low}/{ends.high} do not run: {why}"
            raise UsageError(f"{two_stages.OPTION}: {what} (choose another --condition, --speed or size)")
        share, between = 1.0 if wanted is None else wanted / value, p["intermediate_pressure"]
        near, equal = (NEAR, EQUAL) if count < FIRM else (ROUNDED, NEARLY)
        settled = Found(found.first, found.second, between, p["second_suction_temperature"])
        if abs(share - 1.0) <= near and abs(between / ends.between - 1.0) <= equal:
            powers = (p["first_shaft_power"], p["second_shaft_power"])
            return _solved(kind, asked, ends, settled._replace(loads=powers))
        flows = found.first * share, found.second * share * between / ends.between
        found = settled._replace(
            first=found.first if wanted is None else rounded_flow(flows[0]),
            second=rounded_flow(flows[1]),
            between=ends.between,
        )
    what = "no sizes were found that deliver that with an equal pressure ratio in both stages"
    raise UsageError(f"{two_stages.OPTION}: {what} (state the first one's with --displacement)")


def _solved(kind: str, asked: SceneRequest, ends: Ends, found: Found, warm: bool = False) -> SizedStages:
    """Return two stages of given sizes with their result; `warm` cycles start from one another."""
    try:
        texts = two_stages.scenes_of(kind, asked, ends, found)
        low, high = (loads(text, f"new {kind}") for text in texts)
    except UsageError as error:
        stated = "--flow" if asked.free_air is not None else "--capacity" if asked.capacity is not None else ""
        what = str(error)
        displaced = what.removeprefix("--displacement ")
        raise UsageError(
            what if not stated or displaced == what else f"{stated}: a displacement of {displaced}"
        ) from None
    except SceneError as error:
        _, _, what = error.lines[0].partition(": ")
        raise UsageError(f"{two_stages.OPTION}: such stages are not possible: {what}") from None
    kind_between, outlet, drop = two_stages.between_of(kind, asked, ends)
    between = Intercooler(kind=kind_between, outlet_temperature=outlet, pressure_drop=drop)
    for _, what in apart(low, high, between):  # the file that joins them would be refused
        raise UsageError(f"{two_stages.OPTION}: such stages are not possible: {what}")
    chain = StageChain("", low, high, between)
    return SizedStages(texts, ends, chain, run_stages(chain, warm))


def performance_lines(kind: str, found: SizedStages) -> Iterator[str]:
    """Yield what two stages do together, how the pressure divides, and their warnings, a line each."""
    p = found.result.performance
    if found.result.status != "ok":
        yield f"warning: the machines do not run: {found.result.message} (choose another --condition or size)"
        return
    does = _air_in_words(p) if kind == AIR else _plant_in_words(p, kind == HEATING)
    loads_in_words = (_load(p, name, scene) for name, scene in found.chain.by_stage.items())
    yield f"computed: {does}; {', '.join(loads_in_words)}"
    first, second = (f"{p[f'{name}_pressure_ratio']:.3g}" for name in STAGE_NAMES)
    between = in_bar(float(f"{p['intermediate_pressure']:.4g}"))
    warm = f"{p['second_suction_temperature'] - ZERO_CELSIUS:.1f} °C"
    yield f"pressure ratios {first} and {second}, {between} between both, where the second stage draws in gas of {warm}"
    ratios = (f"{scene.machine.built_in_volume_ratio:g}" for scene in found.chain.by_stage.values())
    cooler = "" if found.ends.cooled is None else ", the intercooler's outlet by the dew point of saturated air"
    yield f"assumed: built-in volume ratios {' and '.join(ratios)} from the pressure ratios{cooler}"
    yield from (f"warning: {warning}" for warning in found.result.as_result().warnings)


def _load(p: Mapping[str, Any], name: str, scene: Scene) -> str:
    """Return what a stage takes, and the load of its motor, in words."""
    power = p[f"{name}_shaft_power"]
    return f"the {name} stage takes {figure_text('shaft_power', power)} ({motor_load(power, scene)})"


def _air_in_words(p: Mapping[str, Any]) -> str:
    delivers, takes, per_flow = (
        figure_text(name, p[name]) for name in (DELIVERED, "package_input_power", "package_specific_power")
    )
    return f"delivers {delivers}, takes {takes} with motors and fan, {per_flow}"


def _plant_in_words(p: Mapping[str, Any], heats: bool) -> str:
    does, of = ("heats", "heating") if heats else ("cools", "cooling")
    gives, takes = (figure_text(name, p[name]) for name in (HEATS if heats else COOLS, "electrical_power"))
    cop = p["electrical_heating_cop" if heats else "electrical_cop"]
    return f"{does} {gives}, takes {takes} with its motors, COP {cop:.3g} of {of}"
