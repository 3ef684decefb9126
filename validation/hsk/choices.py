"""What other numbers of new machines make of them beside the ratings up to 50 Hz, and beside the mean curves."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import sqrt
from pathlib import Path
from typing import Any

from screwsim.scene import Scene, value_at, with_values
from screwsim.simulate import simulate
from screwsim.study.validation import NotRun, Row, read_table, sibling

physics = sibling(Path(__file__).parents[1] / "cagi/physics.py")

FITS = Path(__file__).parents[1] / "bitzer"
SHAFTS, NOZZLE = "effects.shaft_leakage", 9.6e-6  # m² at 160 mm, of the fit to the mean curves
HOLE = "effects.blow_hole"
SEALED = ("shaft_diameter", "clearance", "mixture_viscosity", "passage")
GAPS = tuple(f"effects.{name}.gap" for name in ("tip_leakage", "interlobe_leakage", "end_face_leakage"))
FITTED_GAP, FITTED_DIAMETER = 26e-6, 0.160  # m
FRICTION, OIL = "effects.mechanical.fraction", "oil_supply.ratio"
SOLUBILITY = "refrigerant_solubility"
SUCTION, CLOSED = "{opens: 365 deg, closes: 455 deg}", "{opens: 480 deg, closes: 570 deg}"  # a lobe pitch each
MEAN_SIZES = ("100", "250", "600")  # m³/h of the machines that are put beside the mean curves
MEAN_MOTOR = 0.92  # that the mean curves' source takes
ZERO = 273.15
LAND, SHAFT, BEARING = 2.0, 70.0, 98.0  # mm at 160 mm, of a lobe's tip and of bearings, as in validation/cagi
BY_FILMS = "friction by films and bearings"
AS_TIPS = "the same, end faces as far as tips"
LADEN = f"{BY_FILMS} of oil that holds gas as at suction, which flashes in closed chambers"
SLOW, FULL, FAST, AT = 25.0, 50.0, 75.0, "-5/40"  # Hz, °C: of the change of the efficiency with the speed
Built = Callable[..., Scene]


def as_nozzle(area: float) -> list[str]:
    """Return the overrides that let shafts leak as a nozzle of an area [m²]."""
    away = [f"{SHAFTS}.{name}=null" for name in SEALED]
    return [*away, f"{SHAFTS}.model=nozzle", f"{SHAFTS}.area={1e6 * area:.9g} mm^2"]


def dissolved(where: str, stated: str = "") -> list[str]:
    """Return the overrides that inject oil in a range of angles, from which dissolved gas flashes there.

    `stated` are entries of that effect.
    """
    return [f"effects.oil_injection={where}", f"effects.{SOLUBILITY}={{{stated}}}"]


def tighter(scene: Scene, factor: float, values: Mapping[str, float] | None = None) -> Scene:
    """Return a scene with all clearances times a factor, those of the shafts included, and with other values."""
    return with_values(scaled(scene, (*GAPS, f"{SHAFTS}.clearance"), factor), dict(values or {}))


def scaled(scene: Scene, paths: Sequence[str], factor: float) -> Scene:
    """Return a scene with some values times a factor."""
    return with_values(scene, {path: factor * value_at(scene, path) for path in paths})


def nozzle(built: Built, flow: str) -> Scene:
    """Return a machine whose shafts leak as a nozzle, as its size squared."""
    size = value_at(built(flow), GAPS[0]) / FITTED_GAP
    return built(flow, as_nozzle(NOZZLE * size**2))


def by_films(built: Built, flow: str, as_tips: bool = False, films_at: str = "") -> Scene:
    """Return a machine whose friction follows the laws and rules of validation/cagi/machine.yaml, not a share.

    Its end faces are as far from the housing as a maker sets them, or as the tips are. Its oil is pure, or holds gas,
    which flashes in closed chambers; films then hold as much as in equilibrium with the line `films_at` (M199).
    """
    gap = value_at(built(flow), GAPS[0])
    big = gap / FITTED_GAP
    end = gap if as_tips else physics.end_clearance(FITTED_DIAMETER * big)
    drag = f"tip_gap: {1e6 * gap:.6g} um, tip_land: {LAND * big:.4g} mm, end_gap: {1e6 * end:.6g} um"
    bearings = f"load: rotors, shaft_diameter: {SHAFT * big:.4g} mm, mean_diameter: {BEARING * big:.4g} mm"
    overrides = [
        "effects.mechanical=off",
        f"effects.oil_drag={{{drag}, end_solidity: 0.63}}",
        f"effects.bearings={{friction: two_term, {bearings}, f_0: 2, f_1: 0.0004, count: 4}}",
        f"{GAPS[2]}={1e6 * end:.6g} um",
    ]
    return built(flow, [*overrides, *(dissolved(CLOSED, f"films_at: {films_at}") if films_at else ())])


def fitted_again(built: Built, flow: str) -> Scene:
    """Return a machine with what was fitted with end faces as a maker sets them (validation/bitzer/ends.fit.yaml).

    Gas and oil pass the blow-holes at one speed. Its shafts stay sealed by oil: what leaked past those of that fit is
    within 2 % of what it had been. Its built-in ratio and ports stay as written, too.
    """
    told = json.loads((FITS / "ends_fitted" / "fit.json").read_text(encoding="utf-8"))["parameters"]
    scene = built(flow, [f"{HOLE}.model=homogeneous"])
    big = value_at(scene, GAPS[0]) / FITTED_GAP
    gap, friction = (told[path]["value"] for path in (GAPS[0], FRICTION))
    end = physics.end_clearance(FITTED_DIAMETER * big)
    return with_values(scene, {**dict.fromkeys(GAPS[:2], big * gap), GAPS[2]: end, FRICTION: friction})


CHOICES: Mapping[str, Callable[[Built, str], Scene]] = {
    "as written": lambda built, flow: built(flow),
    "shafts as a nozzle, 9.6 mm² at 160 mm": nozzle,
    "gas and oil through blow-holes at one speed": lambda built, flow: built(flow, [f"{HOLE}.model=homogeneous"]),
    "clearances of the shafts times 0.8": lambda built, flow: scaled(built(flow), (f"{SHAFTS}.clearance",), 0.8),
    "gaps times 0.7": lambda built, flow: scaled(built(flow), GAPS, 0.7),
    "gaps times 0.7, friction 12 %": lambda built, flow: with_values(scaled(built(flow), GAPS, 0.7), {FRICTION: 0.12}),
    "gaps times 0.7, 2 kg of oil per kg": lambda built, flow: with_values(scaled(built(flow), GAPS, 0.7), {OIL: 2.0}),
    "all clearances times 0.8": lambda built, flow: tighter(built(flow), 0.8),
    "all clearances times 0.8, friction 12 %": lambda built, flow: tighter(built(flow), 0.8, {FRICTION: 0.12}),
    f"{BY_FILMS}, end faces as a maker sets them": by_films,
    AS_TIPS: lambda built, flow: by_films(built, flow, as_tips=True),
    LADEN: lambda built, flow: by_films(built, flow, films_at="suction"),
    f"{LADEN}, end faces as far as tips": lambda built, flow: by_films(built, flow, True, "suction"),
    "end faces as a maker sets them, gas and oil through blow-holes at one speed, fitted again": fitted_again,
    "gas flashes from oil as suction ends": lambda built, flow: built(flow, dissolved(SUCTION)),
    "gas flashes as suction ends, 0.15 kg of oil per kg, all clearances times 0.6": lambda built, flow: tighter(
        built(flow, dissolved(SUCTION)), 0.6, {OIL: 0.15}
    ),
    "gas flashes from oil in closed chambers": lambda built, flow: built(flow, dissolved(CLOSED)),
    "gas flashes in closed chambers, all clearances times 0.8": lambda built, flow: tighter(
        built(flow, dissolved(CLOSED)), 0.8
    ),
}


def figures(scene: Scene, values: Mapping[str, float]) -> tuple[float, float] | None:
    """Return λ and electrical isentropic efficiency [%] at a condition.

    None where gas is dissolved in oil and there is no solution: the oil is hotter than the solubility is known.
    """
    result = simulate(with_values(scene, dict(values)), trace=False)
    if result.status != "ok":
        if SOLUBILITY in scene.effects:
            return None
        raise NotRun(f"a tried machine: {result.told}")
    own = result.performance
    return 100.0 * own.volumetric_efficiency, 100.0 * own.electrical_isentropic_efficiency


def at_mean_curves(here: Path) -> list[tuple[dict[str, float], float, float]]:
    """Return conditions of the mean curves at 50 Hz, with λ and electrical isentropic efficiency [%]."""
    found = []
    for row in read_table(here.parent / "bitzer" / "conditions.csv"):
        names = ("evaporating", "condensing")
        values = {f"operation.{name}_temperature": float(row[f"{name}_degC"]) + ZERO for name in names}
        shaft = MEAN_MOTOR * float(row["isentropic_efficiency"])
        found.append((values, 100.0 * float(row["volumetric_efficiency"]), 100.0 * shaft))
    return found


def told(scene: Scene, points: Sequence[tuple[Mapping[str, float], float, float]]) -> str:
    """Return the root mean squares of both figures' differences [points], and how many of these had no solution."""
    found = [(figures(scene, values), filled, work) for values, filled, work in points]
    off = [(ours[0] - filled, ours[1] - work) for ours, filled, work in found if ours is not None]
    missing = f", {len(found) - len(off)} of {len(found)} too hot" if len(off) < len(found) else ""
    rms = "/".join(f"{sqrt(sum(each[figure] ** 2 for each in off) / len(off)):.1f}" for figure in (0, 1))
    return f"{rms}{missing}"


def over_speed(built: Built, by_model: Mapping[str, Sequence[Any]], name: str, films_at: str = "") -> Row:
    """Return how the efficiency of machines with friction by films and bearings, of a name, changes with the speed."""
    ours, theirs = [], []
    for ratings in by_model.values():
        at = {one.frequency: one for one in ratings if one.name == AT}
        if SLOW not in at or FAST not in at:
            continue
        flow, machine = ratings[0].displacement, by_films(built, ratings[0].displacement, films_at=films_at)
        found = {each: figures(machine, at[each].values) for each in (SLOW, FULL, FAST)}
        own = {each: told[1] for each, told in found.items() if told is not None}
        rated = {each: 100.0 * at[each].electrical_isentropic_efficiency for each in (SLOW, FULL, FAST)}
        for some, texts in ((own, ours), (rated, theirs)):
            texts.append(f"{flow}: {some[SLOW] - some[FULL]:+.1f}, {some[FAST] - some[FULL]:+.1f}")
    what = f"tried: {name}: electrical η_s at {SLOW:g} and {FAST:g} Hz less that at {FULL:g}, {AT} °C, by m³/h"
    return Row(what, "; ".join(ours), "; ".join(theirs), "estimate", "no verdict", note="points")


def rows(here: Path, built: Built, by_model: Mapping[str, Sequence[Any]], full: float) -> Iterator[Row]:
    """Yield the differences of each choice: by rated machine up to a full speed [Hz], then beside the curves."""
    curves = at_mean_curves(here)
    for name, choice in CHOICES.items():
        parts = []
        for ratings in by_model.values():
            flow, slow = ratings[0].displacement, [one for one in ratings if one.frequency <= full]
            theirs = ((one.volumetric_efficiency, one.electrical_isentropic_efficiency) for one in slow)
            points = [
                (one.values, 100.0 * filled, 100.0 * work) for one, (filled, work) in zip(slow, theirs, strict=True)
            ]
            parts.append(f"{flow}: {told(choice(built, flow), points)}")
        parts += [f"curves at {flow}: {told(choice(built, flow), curves)}" for flow in MEAN_SIZES]
        yield Row(
            f"tried: {name}: rms of λ/electrical η_s in points, by m³/h",
            "; ".join(parts),
            None,
            "estimate",
            "no verdict",
            note="ratings up to 50 Hz; mean curves of validation/bitzer, with its motor of 92 %",
        )
    yield over_speed(built, by_model, BY_FILMS)
    yield over_speed(built, by_model, LADEN, "suction")
