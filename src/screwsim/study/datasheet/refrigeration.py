"""What a refrigeration machine is rated over: evaporating temperature and condenser, and its part load.

A scene that sweeps these temperatures is rated at their values, one that does not at steps around its own point. Where
a gas cooler takes the condenser's place, its pressure takes that of the condensing temperature.
"""

from collections.abc import Sequence
from dataclasses import replace

from screwsim.inputs.faults import UsageError
from screwsim.scene import Scene, value_at
from screwsim.scene.operation import CONDENSING, EVAPORATING, GAS_COOLER_P
from screwsim.scene.units import ZERO_CELSIUS
from screwsim.study.datasheet.bounds import Bound
from screwsim.study.datasheet.rated import Asked, Axis, faults_of, read_range, spread
from screwsim.study.part_load import ENDS, RATIO, controls, ratios

STEP = 5.0  # [K] between temperatures of a table
BELOW, ABOVE = 15.0, 10.0  # [K] of the scene's own temperatures, over which a table goes by itself
SHARES = (0.85, 0.9, 0.95, 1.0, 1.05, 1.1)  # of a gas cooler's pressure
MOST = 12  # values on an axis of a table


def asked_of(scene: Scene, evaporating: str | None, condensing: str | None, bounds: Sequence[Bound]) -> Asked:
    """Return what of a scene is to be rated; raise UsageError where it varies something else, or a range is none."""
    base = replace(scene, sweep={}, joints=())
    second = GAS_COOLER_P if base.operation.gas_cooler is not None else CONDENSING
    known = {EVAPORATING, second, RATIO, *ENDS}
    others = [path for path in scene.sweep if path not in known]
    if others or scene.joints:
        path = others[0] if others else scene.joints[0].paths[0]
        raise UsageError(
            f"datasheet: a sheet goes over {EVAPORATING}, {second} and controls of the capacity, and the scene varies "
            f"{path} otherwise (rate one value after the other: a scene without that axis, with --set {path}=VALUE)"
        )
    axes = (
        _axis(scene, base, EVAPORATING, evaporating, "--evaporating"),
        _axis(scene, base, second, condensing, "--condensing"),
    )
    return Asked(base, *axes, tuple(bounds), tuple(controls(scene)), ratios(scene))


def _axis(scene: Scene, base: Scene, path: str, text: str | None, option: str) -> Axis:
    if text is not None:
        return Axis(path, _range(base, path, text, option))
    if path in scene.sweep:
        return Axis(path, tuple(sorted(map(float, scene.sweep[path]))))
    own = float(value_at(base, path))
    if path == GAS_COOLER_P:
        return Axis(path, tuple(own * share for share in SHARES))
    middle = STEP * round((own - ZERO_CELSIUS) / STEP) + ZERO_CELSIUS
    values = [middle + STEP * i for i in range(-round(BELOW / STEP), round(ABOVE / STEP) + 1)]
    return Axis(path, tuple(value for value in values if not faults_of(base, {path: value})) or (own,))


def _range(base: Scene, path: str, text: str, option: str) -> tuple[float, ...]:
    example = "-10 degC..10 degC" if path != GAS_COOLER_P else "80 bar..110 bar"
    first, last = read_range(base, path, text, option, example)
    count = len(SHARES) if path == GAS_COOLER_P else min(max(round((last - first) / STEP) + 1, 2), MOST)
    return spread(first, last, count)
