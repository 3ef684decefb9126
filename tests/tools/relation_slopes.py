"""A law of exact derivatives: a figure's, by all numbers of a scene, add up as its dimension asks for.

Where all lengths and times grow by a share and all masses by three times that share, a figure changes by its own
dimension's multiple of it (Euler's theorem of homogeneous functions); so with the masses alone, of an ideal gas. No run
of another scene is needed. `relations.py` asks it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from relating import Case, NotAsked, Pair, law
from relation_similar import factor, has_sizes

from screwsim.derivatives.solving import scene_derivatives
from screwsim.figures.errors import error_scale, zeros_for_none
from screwsim.inputs.faults import ImpossibleValue
from screwsim.scene.fields import leaves_of
from screwsim.study.uncertainty.slopes import numeric_paths

E = math.e
SIZE, MASS = {"kg": E**3, "m": E, "s": E}, {"kg": E, "m": 1.0, "s": 1.0}
APART = 1e-3  # of the sum of what is added up
LEAST = 1e-2  # percent per percent: what counts for less is compared with that, as in `derivatives.py`
VISCOUS = "droplets", "wall_heat", "cylinder_heat"  # by CoolProp's conductivity, which no number of a scene scales


@law
def slopes_add(case: Case) -> Iterator[Pair]:
    """Derivatives by all numbers add up by dimensions."""
    result, scene = case.result, case.scene
    if has_sizes(scene) or (scene.oil is not None and scene.oil.name) or set(VISCOUS) & scene.effects.keys():
        raise NotAsked("laws with sizes of their own")
    if {"refrigerant_solubility", "thermal_clearances"} & scene.effects.keys():
        raise NotAsked("laws with sizes of their own")
    models = {getattr(each.parameters, "model", None) for each in scene.effects.values()}
    if case.value("machine.volume.law") == "table" or models & {"oil_sealed", "nozzle_friction"}:
        raise NotAsked("tables have sizes of their own, gaps CoolProp's viscosity of the gas")
    values = {path: value for path, value in numeric_paths(scene)[0].items() if value}
    leaves, about = leaves_of(scene), result.performance.about
    values = {path: value for path, value in values.items() if leaves[path].dimension is not None}
    try:
        found = scene_derivatives(scene, values)
    except ImpossibleValue:
        raise NotAsked("a number at its bound") from None
    if found.why or values.keys() - found.derivatives.keys():
        raise NotAsked("not all derivatives are exact")
    groups = {"sizes": SIZE}
    if scene.gas.model == "ideal" and scene.gas.relative_humidity is None and "bearings" not in scene.effects:
        groups["masses"] = MASS
    for what, group in groups.items():
        powers = {path: math.log(factor(leaves[path].dimension.si, group)) for path in values}
        for name, value in result.performance.items():
            terms = [powers[path] * x * found.derivatives[path].get(name, math.nan) for path, x in values.items()]
            if value is None or any(math.isnan(term) for term in terms):
                continue
            own = math.log(factor(about[name].units, group)) * value
            size = sum(map(abs, terms)) + abs(own)
            least = LEAST * error_scale(name, about[name].scale, zeros_for_none(result.performance))
            off = abs(sum(terms) - own) / max(size, least, 1e-300)
            words = f"{what}: {name} {value:.6g}, slopes add up to {sum(terms):.6g}, not {own:.6g}"
            yield Pair(words, result, result, broken=off / APART)
