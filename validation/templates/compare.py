"""What the machines that `screwsim new` writes do, beside machines of their kind that were measured or rated."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from CoolProp.CoolProp import PropsSI

from screwsim.build import build_parts
from screwsim.effects.parts.rating import STANDARDS
from screwsim.outputs import Figures
from screwsim.scene import Scene, loads, value_at
from screwsim.simulate import simulate
from screwsim.study.validation import Comparison, NotRun, Panel, Row, Series, equal, read_table, sibling, trend
from screwsim.template import new_scene, request_of
from screwsim.template.sizes import GAP, KNOWN_DIAMETER

ratings, slides = (sibling(Path(__file__).parent / f"{name}.py") for name in ("ratings", "slides"))
physics = sibling(Path(__file__).parents[1] / "cagi/physics.py")

TITLE = "New scenes: volumetric and isentropic efficiencies beside those of real machines"
CITATION = (
    "Screws: mean curves of validation/bitzer. Reciprocating: ratings of validation/energyplus. Air: 10 CFR 431.345 "
    "and the sheet of validation/cagi. Expanders: Hsu et al., Energies 7 (2014) 6172; Ziviani et al. in the library "
    "ORCmKit; Dumont et al., ORC 2017 (expanders.csv says what of each was at hand). Slide valves: 24 screw chillers "
    "of EnergyPlus (chillers.csv)"
)
ABOUT = """\
Machines as `screwsim new KIND` writes them. Nothing is adjusted to what they are compared with, but that gaps, ports
and friction of flooded screws were fitted to one machine within those mean curves (160 mm, R134a). Tolerances are
taken, not the sources' own: a template is no machine of a maker, and a mean holds machines of several sizes. What was
found:

- Air packages: the curve from which 10 CFR 431.345 counts losses rises with their size by more than ours do, and small
  ones of ours are too efficient. V-belts, which lose 2 to 5 % (Gates) and are assumed up to 22 kW, are 2 points of
  that. What else small ones lose, in seals and fans, is not known to us.
- Clearances that shrink less than the rotors, as tolerances do, would be one point more. But screws on R134a of 84 to
  192 m³/h would then leak 2 to 5 points more, and those of 140 and 192 leak too much as it is (validation/hsk).
- End faces as a maker sets them, and one speed of gas and oil in the blow-holes, make every package more efficient,
  small ones most (rows 'tried'). Small screws on R134a are too efficient as well.
- Expanders: gaps and friction are assumed; a single screw is another kind of machine, shown for its size alone.
- Boosters that suck gas at pressure, and ammonia: no measured or rated volumetric or isentropic efficiency with its
  conditions was found, so that those rows have no verdict. λ and η_s rest on the laws and on what was fitted on
  R134a."""
FILLED, WORK, RECIPROCATING, EXPANDER = 0.04, 0.06, 0.05, 0.05  # tolerances
SIZES = (100, 250, 600, 1500, 3000)  # m³/h
BEST = 0.845  # of the sheet of validation/cagi at full flow
TAKEN = "taken: a mean over machines of several sizes"
AIR_SIZES, JUDGED = (100, 200, 400, 800, 1200, 2000), (200, 1200)  # m³/h of air packages; of them between two bounds
CURVE = "taken, as for screws; the curve from which 10 CFR 431.345 counts losses (d = 0), no machine"


def figures(kind: str, overrides: Callable[[Scene], Sequence[str]] = lambda _: (), **stated: object) -> Figures:
    """Return the figures of a new machine; raise NotRun where its cycle does not close.

    `overrides` gives what to change of its scene.
    """
    text = new_scene(kind, request_of(**stated))  # type: ignore[arg-type]
    result = simulate(loads(text, overrides=overrides(loads(text))), trace=False)
    if result.status != "ok":
        raise NotRun(f"new {kind} {stated}: {result.told}")
    return result.performance


def mean_curve(here: Path) -> tuple[float, float]:
    """Return λ and η_s of compact screws at 0/40 °C."""
    rows = read_table(here.parent / "bitzer" / "conditions.csv")
    row = next(row for row in rows if (row["evaporating_degC"], row["condensing_degC"]) == ("0", "40"))
    return float(row["volumetric_efficiency"]), float(row["isentropic_efficiency"])


def _screws(here: Path, found: Mapping[int, Figures]) -> Iterator[Row]:
    filled, work = mean_curve(here)
    for flow, each in found.items():
        name = f"refrigeration, R134a, 0/40 °C, {flow} m³/h"
        own = each.volumetric_efficiency, each.isentropic_efficiency
        yield equal(f"{name}: λ", 100.0 * own[0], 100.0 * filled, 100.0 * FILLED, "published", unit="%", basis=TAKEN)
        yield equal(f"{name}: η_s", 100.0 * own[1], 100.0 * work, 100.0 * WORK, "published", unit="%", basis=TAKEN)


def set_by_maker(scene: Scene) -> list[str]:
    """Return the changes that set the end faces of a scene as a maker does."""
    return physics.end_faces(physics.end_clearance(diameter(scene)))


def diameter(scene: Scene) -> float:
    """Return the diameter [m] of the male rotor of a scene with a profile of family b."""
    return float(build_parts(scene).geometry.settings.rotor_diameter)


def cleared(power: float) -> Callable[[Scene], list[str]]:
    """Return what gives all clearances of a scene those of 160 mm times a power of the diameter, films included."""

    def overrides(scene: Scene) -> list[str]:
        size = diameter(scene) / KNOWN_DIAMETER
        factor = size**power / (value_at(scene, CLEARANCES[0]) / GAP)
        return [f"{path}={1e6 * factor * value_at(scene, path):.6g} um" for path in CLEARANCES]

    return overrides


CLEARANCES = (
    *(f"effects.{name}.gap" for name in physics.GAPS),
    *(f"effects.oil_drag.{which}_gap" for which in ("tip", "end")),
    "effects.shaft_leakage.clearance",
)
GEARED = ["effects.mechanical.fraction=0.01", "effects.separator.friction_share=1"]
HOMOGENEOUS = "effects.blow_hole.model=homogeneous"
TRIED: Mapping[str, Callable[[Scene], list[str]]] = {
    "as written": lambda scene: [],
    "gears in place of belts": lambda scene: GEARED,
    "clearances of 160 mm at every size": cleared(0.0),
    "clearances by the cube root of the diameter, as tolerances": cleared(1.0 / 3.0),
    "end faces as a maker sets them": set_by_maker,
    "the same, gas and oil through blow-holes at one speed": lambda scene: [*set_by_maker(scene), HOMOGENEOUS],
}


def over_curve(found: Figures) -> str:
    """Return by how many points the package isentropic efficiency exceeds the reference curve."""
    reference = STANDARDS["fixed", "air"].reference(found["free_air_delivered"])
    return f"{100.0 * (found['package_isentropic_efficiency'] - reference):+.1f}"


def _air() -> Iterator[Row]:
    standard, tried = STANDARDS["fixed", "air"], {name: [] for name in TRIED}
    for flow in AIR_SIZES:
        found = figures("air", displacement=f"{flow} m^3/h")
        own, delivered = found["package_isentropic_efficiency"], found["free_air_delivered"]
        for what, overrides in TRIED.items():
            tried[what].append(f"{flow}: {over_curve(figures('air', overrides, displacement=f'{flow} m^3/h'))}")
        name = f"air, {flow} m³/h: isentropic efficiency of the package beside the reference curve"
        theirs = 100.0 * standard.reference(delivered)
        yield equal(name, 100.0 * own, theirs, 100.0 * WORK, "published", unit="%", basis=CURVE)
        if flow not in JUDGED:
            continue
        least = standard.least(delivered)
        yield trend(
            f"air, {flow} m³/h: isentropic efficiency of the package",
            f"{100.0 * own:.1f} %",
            f"{100.0 * least:.1f} % must be, {100.0 * BEST:.1f} % has the best sheet at hand",
            least <= own <= BEST,
        )
    for what, told in tried.items():
        name = f"tried: air, {what}: isentropic efficiency over the reference curve, by m³/h"
        yield Row(name, "; ".join(told), None, "estimate", "no verdict", note="points")


def _reciprocating() -> Iterator[Row]:
    for condition, superheat in ratings.POINTS:
        found = figures("reciprocating", fluid="R404A", condition=f"{condition} degC, {superheat} K")
        evaporating, condensing = (float(each) + 273.15 for each in condition.split("/"))
        every = ratings.ratings(evaporating, condensing)
        own = 100.0 * found["electrical_isentropic_efficiency"]
        name, middle = f"reciprocating, R404A, {condition} °C: electrical η_s", 50.0 * (min(every) + max(every))
        within = 50.0 * (max(every) - min(every)) + 100.0 * RECIPROCATING
        basis = "half the spread of six ratings, and 5 points, taken"
        note = "the motor is that of one cylinder; those rated have larger ones (validation/energyplus)"
        yield equal(name, own, middle, within, "published", unit="%", basis=basis, note=note)


def measured(here: Path) -> dict[str, dict[str, str]]:
    """Return the measured expanders by name."""
    return {row["name"]: row for row in read_table(here / "expanders.csv")}


def hermetic(row: Mapping[str, str], flow: str = "375 m^3/h") -> Figures:
    """Return the figures of a new expander of a size at the saturation pressures of a source, 5 K superheated."""
    T = [float(row[name]) + 273.15 for name in ("evaporating_degC", "condensing_degC")]
    high, low = (1e-5 * PropsSI("P", "T", each, "Q", 1, row["fluid"]) for each in T)
    at = f"{high:.5g}/{low:.5g} bar, {T[0] - 273.15 + 5.0:.5g} degC"
    return figures("expander", fluid=row["fluid"], displacement=flow, condition=at)


def grooved(row: Mapping[str, str]) -> Figures:
    """Return the figures of a new expander that displaces what the single screw of a source does, at its conditions."""
    flow = 60e-6 * float(row["groove_volume_cm3"]) * float(row["speed_rpm"])
    at = f"{row['inlet_bar']}/{row['outlet_bar']} bar, {row['inlet_degC']} degC"
    stated = {
        "displacement": f"{flow:.6g} m^3/h",
        "speed": f"{row['speed_rpm']} rpm",
        "vi": float(row["built_in_ratio"]),
    }
    return figures("expander", fluid=row["fluid"], condition=at, **stated)


def _expanders(here: Path) -> Iterator[Row]:
    known = measured(here)
    row = known["hermetic"]
    found = {flow: hermetic(row, f"{flow} m^3/h") for flow in (200, 375, 600)}
    electrical = {flow: 100.0 * each.electrical_isentropic_efficiency for flow, each in found.items()}
    shaft = 100.0 * found[375].isentropic_efficiency
    yield equal(
        "expander, R245fa, 101/45 °C, 375 m³/h: electrical η_s",
        electrical[375],
        100.0 * float(row["efficiency"]),
        100.0 * EXPANDER,
        "published",
        unit="%",
        basis="5 points, taken: the best that was measured, its size and speed not at hand",
        note=f"200 m³/h: {electrical[200]:.1f} %, 600: {electrical[600]:.1f} %; at the shaft of 375: {shaft:.1f} %",
    )
    row = known["single_screw"]
    single = grooved(row)
    name, why = "expander, R245fa, 10/1.67 bar, 147 m³/h", "a single screw: another kind of machine"
    pairs = (
        ("electrical η_s", 100.0, "%", single.electrical_isentropic_efficiency, "efficiency"),
        ("filling factor", 1.0, "", single.filling_factor, "filling_factor"),
    )
    for what, scale, unit, own, column in pairs:
        theirs = scale * float(row[column])
        yield equal(f"{name}: {what}", scale * own, theirs, None, "published", unit=unit, note=why, comparable=False)
    small = hermetic(known["hermetic"], "20 m^3/h")
    told = (
        f"{100.0 * small.electrical_isentropic_efficiency:.1f} % at {-1e-3 * small.electrical_power:.2f} kW, 101/45 °C"
    )
    theirs = f"{100.0 * float(known['oil_free']['efficiency']):.0f} % at some 2 kW"
    note = "a twin screw without oil; its conditions are not at hand"
    yield Row("expander, R245fa, 20 m³/h: electrical η_s", told, theirs, "published", "no verdict", note=note)


def _unmeasured() -> Iterator[Row]:
    cases = {
        "booster, methane, 5/20 bar, 600 m³/h": figures("booster"),
        "refrigeration, ammonia, -10/35 °C, 600 m³/h": figures(
            "refrigeration", fluid="Ammonia", condition="-10/35 degC"
        ),
    }
    for name, each in cases.items():
        told = f"λ {100.0 * each.volumetric_efficiency:.1f} %, η_s {100.0 * each.isentropic_efficiency:.1f} %"
        yield Row(name, told, "none found", "estimate", "no verdict")


def compare(here: Path) -> Comparison:
    """Return the rows of all kinds, and the figure of refrigeration machines over their size."""
    screws = {flow: figures("refrigeration", displacement=f"{flow} m^3/h") for flow in SIZES}
    rows = [*_screws(here, screws), *slides.slides(here), *_air(), *_reciprocating(), *_expanders(here), *_unmeasured()]
    mean, flows = mean_curve(here), [float(flow) for flow in SIZES]
    own = [
        [100.0 * getattr(each, name) for each in screws.values()]
        for name in ("volumetric_efficiency", "isentropic_efficiency")
    ]
    panels = tuple(
        Panel(
            "displacement / m³/h",
            label,
            (
                Series("new refrigeration machines, R134a, 0/40 °C", flows, values),
                Series("mean of compact screws", flows[1:4], [100.0 * theirs] * 3, theirs=True, error=100.0 * within),
            ),
            log_x=True,
        )
        for label, values, theirs, within in (
            ("volumetric efficiency / %", own[0], mean[0], FILLED),
            ("isentropic efficiency / %", own[1], mean[1], WORK),
        )
    )
    return Comparison(TITLE, CITATION, ABOUT, rows, panels)
