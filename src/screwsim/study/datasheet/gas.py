"""Axes of a rating: suction and discharge pressure for a gas compressor, speed and outlet pressure for an expander.

A scene that sweeps these is rated at its values, another one at fixed shares of its own. An expander is rated over its
inlet instead of the speed where the scene sweeps that, or a range of it is requested.
"""

from collections.abc import Mapping, Sequence

from screwsim.scene import Scene, value_at, with_values
from screwsim.scene.operation import CONDENSING, EVAPORATING, P_D, P_S
from screwsim.study.datasheet.bounds import Bound
from screwsim.study.datasheet.rated import (
    Axis,
    RatingRequest,
    evenly_spaced,
    faults_of,
    pressure_ratio,
    read_range,
    without_sweep,
)
from screwsim.study.part_load import CONTROL_ENDS, GAS, RATIO_PATH, SPEED_PATH, controls, ratios

PRESSURE_SHARES = (0.8, 0.9, 1.0, 1.1, 1.2)  # of a compressor's own pressures
SPEED_SHARES = (0.4, 0.6, 0.8, 1.0, 1.2)  # of an expander's own speed
OUTLET_SHARES = (0.7, 0.85, 1.0, 1.2, 1.4)  # of its outlet pressure
INLET_SHARES = (0.7, 0.85, 1.0, 1.15)  # of its inlet pressure, where both pressures vary
EXAMPLES = {
    P_S: "4 bar..6 bar",
    P_D: "15 bar..25 bar",
    EVAPORATING: "80 degC..100 degC",
    CONDENSING: "30 degC..50 degC",
}
VALUES_PER_RANGE = 5  # values per range


def options_of(scene: Scene) -> dict[str, str]:
    """Return the options that state the range of a line's pressure or saturation temperature: option -> path."""
    if scene.operation.evaporating_temperature is not None:
        return {"--evaporating": EVAPORATING, "--condensing": CONDENSING}
    return {"--suction": P_S, "--discharge": P_D}


def rating_request(scene: Scene, ranges: Mapping[str, str | None], bounds: Sequence[Bound]) -> RatingRequest:
    """Return what is rated of a scene, given ranges of its lines' options; raise UsageError."""
    (first, inlet), (second, outlet) = options_of(scene).items()
    expands = scene.machine.expands
    beside = {SPEED_PATH, RATIO_PATH} if expands else {RATIO_PATH, *CONTROL_ENDS}
    over = f"{SPEED_PATH}, {inlet} and {outlet}" if expands else f"{inlet}, {outlet} and controls of the flow"
    base = without_sweep(scene, {inlet, outlet, *beside}, over)
    if expands and ranges.get(first) is None and inlet not in scene.sweep:
        across = Axis(
            SPEED_PATH,
            _swept_values(scene, SPEED_PATH) or tuple(share * base.operation.speed for share in SPEED_SHARES),
        )
    else:
        across = _line(scene, base, inlet, ranges.get(first), first)
    down = _line(scene, base, outlet, ranges.get(second), second)
    if expands:
        return RatingRequest(base, across, down, tuple(bounds), (), aim=GAS)
    return RatingRequest(base, across, down, tuple(bounds), tuple(controls(scene)), ratios(scene), GAS)


def _line(scene: Scene, base: Scene, path: str, text: str | None, option: str) -> Axis:
    if text is not None:
        return Axis(path, evenly_spaced(*read_range(base, path, text, option, EXAMPLES[path]), VALUES_PER_RANGE))
    return Axis(path, _swept_values(scene, path) or _values_around_own(base, path))


def _swept_values(scene: Scene, path: str) -> tuple[float, ...]:
    return tuple(sorted(map(float, scene.sweep.get(path, ()))))


def _values_around_own(base: Scene, path: str) -> tuple[float, ...]:
    """Return values around the scene's own."""
    own = float(value_at(base, path))
    shares = PRESSURE_SHARES if not base.machine.expands else INLET_SHARES if path == P_S else OUTLET_SHARES
    every = [share * own for share in shares]
    if path in (EVAPORATING, CONDENSING):
        every = [own + 5.0 * step for step in (-2, -1, 0, 1, 2)]
    kept = tuple(value for value in every if not faults_of(base, {path: value}))
    return kept or (own,)


def ratio_at(asked: RatingRequest, across: float, down: float) -> float:
    """Return the pressure ratio of a point of the table."""
    return pressure_ratio(with_values(asked.scene, {asked.across.path: across, asked.down.path: down}))
