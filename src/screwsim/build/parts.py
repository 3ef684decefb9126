"""Builds the parts that the composer takes (geometry, gas, oil, effects) and prepares them for a sweep."""

from screwsim.build.parts_cache import PartsCache, build_gas, build_site
from screwsim.build.temperatures import completed
from screwsim.effects.base import Made, OilContent, OilGas, OilSolution, Plenum
from screwsim.fluid.gas import Gas
from screwsim.fluid.reservoir import Reservoir
from screwsim.inputs.faults import checked_own_number
from screwsim.model.parts import Effects, OilPart, Parts, Widths
from screwsim.scene.checks import cross_check
from screwsim.scene.grid import case, case_count, with_sweep_over
from screwsim.scene.lines import Lines, lines, refrigerating_effect
from screwsim.scene.operation import SPEED
from screwsim.scene.types import Scene

WIDTH = 0.25  # width of the regularisation over the requested accuracy
LEAST = 1e-300  # smallest positive value of a plenum's pressure, temperature and density
MOST_PREPARED = 10_000  # largest number of operating conditions of a sweep whose fluid data are fetched in advance


def build_oil(scene: Scene, at: Lines) -> OilPart | None:
    """Return the oil of a scene and its supply; None without oil or without a supply temperature."""
    oil, supply = scene.oil, scene.oil_supply
    if oil is None or supply is None or supply.temperature is None:
        return None
    known = oil.at(supply.temperature)
    if supply.pumped:
        numbers = {"ratio": float(supply.ratio or 0.0)}
    else:
        diameter = float(supply.orifice_diameter or 0.0)
        numbers = {
            "density": known.density,
            "viscosity": float(known.viscosity or 0.0),
            "diameter": diameter,
            "length": supply.orifice_length or 2.0 * diameter,
            "number": supply.orifice_count,
            "separator_pressure": at.p_d,
        }
        if supply.line is not None and supply.line.pressure_loss > 0.0:
            numbers |= {"line_loss": supply.line.pressure_loss, "line_flow": supply.line.flow}
    source = at.p_s if supply.from_sump else at.p_d
    with_gas = numbers["ratio"] if scene.machine.expands else 0.0
    return OilPart(known.density, known.heat_capacity, supply.temperature, oil.carried, numbers, source, with_gas)


def build_parts(scene: Scene, cache: PartsCache | None = None, set_speed: float | None = None) -> Parts:
    """Return the built parts of a scene for the composer, reusing parts of previous scenes from `cache`."""
    return parts_of(completed(scene), cache or PartsCache(), set_speed)


def parts_of(scene: Scene, cache: PartsCache, set_speed: float | None = None) -> Parts:
    """Return what `build_parts` does, from a completed scene."""
    at = lines(scene)
    geometry = cache.geometry(scene.machine)
    effects = cache.effects(scene, geometry, at)
    gas = cache.gas(scene)
    plenums, made, content = _site_states(effects, scene, gas)
    return Parts(
        geometry=geometry,
        gas=gas,
        omega=scene.operation.speed,
        widths=_widths(scene, at),
        effects=effects,
        oil=build_oil(scene, at),
        plenums=plenums,
        made=made,
        set_speed=set_speed,
        oil_content=content,
    )


def _site_states(
    effects: Effects, scene: Scene, gas: Gas
) -> tuple[dict[str, Reservoir], dict[str, float], OilContent | OilSolution | None]:
    """Return states of the effects' own plenums, guesses of feedback unknowns, and the gas dissolved in injected oil.

    Feedback unknowns are numbers that the cycle determines (`effects.parts.made`).
    """
    plenums, made, brings = ([part for _, part in effects.all(kind)] for kind in (Plenum, Made, OilGas))
    if not (plenums or made or brings):
        return {}, {}, None
    site = build_site(scene, gas)
    guesses = {part.entry.name: part.guess(site) for part in made}
    for name, part in effects.all(Made):
        checked_own_number(name, f"the guess of {part.entry.name}", guesses[part.entry.name])
    if len(guesses) < len(made):
        names = ", ".join(sorted(part.entry.name for part in made))
        raise TypeError(f"two effects declare one of {names} as found by the cycle")
    states = {part.name: part.state(site) for part in plenums}
    for name, part in effects.all(Plenum):
        for what in ("p", "T", "rho"):
            checked_own_number(name, f"{what} of its plenum {part.name}", getattr(states[part.name], what), LEAST)
        checked_own_number(name, f"h of its plenum {part.name}", states[part.name].h)
    return states, guesses, brings[0].content(site) if brings else None


def regularisation(scene: Scene) -> tuple[float, float, float]:
    """Return the regularisation widths ε of pressure differences: of suction port and discharge port [Pa], and of gaps.

    The width of gaps is a share of the mean pressure at their ends. ε is `WIDTH` times the requested accuracy times the
    pressure. Error control lets the pressure err by about as much: a narrower ε would let that error jump across the
    steep middle of the flow law, a wider one would cost accuracy that no step size recovers
    (docs/explanation/integrator.md).
    """
    return _widths(scene, lines(scene))[:3]


def _widths(scene: Scene, at: Lines) -> Widths:
    width = WIDTH * scene.numerics.accuracy
    return width * at.p_s, width * at.p_d, width, width * max(at.p_s, at.p_d)


def prepare(scene: Scene) -> None:
    """Fetch from CoolProp once the data that the cases of a sweep need, so that no worker imports it."""
    asked = (path for path in scene.sweep if path.startswith(("operation.", "gas.")) and path != SPEED)
    conditions = with_sweep_over(scene, asked)
    for index in range(min(case_count(conditions), MOST_PREPARED) if conditions.sweep else 0):
        one = case(conditions, index)
        if not cross_check(one):
            build_gas(one)
            refrigerating_effect(one)
