"""What power losses and readings may use of a closed cycle."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, NamedTuple

from screwsim.build import surroundings_of
from screwsim.cycle import suction_line
from screwsim.cycle.balances import incoming_oil, injection_pressure, outflow_of, streams_of, wall_drag_work
from screwsim.cycle.pitch import Pitch, pitch_of
from screwsim.cycle.problem import Problem
from screwsim.effects.base import DISCHARGE, SUCTION, PressureLosses, Turn
from screwsim.fluid.moist_air import after_draining
from screwsim.model.port_states import SOME_OIL
from screwsim.model.slots import PORT_STATE, PRESSURE, Q_WORK, R_SUCTION
from screwsim.model.trajectory import Array, Trajectory
from screwsim.numerics.frozen import fast_init

ViscosityAt = Callable[[float], float | None]


def _found(name: str) -> Any:
    """Return a property that is the figure of that name; None where it is not known yet."""
    return property(lambda known: known.found.get(name))


@fast_init
@dataclass(frozen=True)
class CycleFigures:
    """Quantities of a closed cycle for power losses and readings (SI units); `set_speed` to `turn`: readings only."""

    omega: float
    tip_speed: float
    indicated_power: float
    oil_mass_flow: float
    oil_volume_flow: float
    leaked_oil_flow: float  # [m³/s] from the discharge line to suction, bypassing the chambers
    oil_viscosity: float | None  # of pure oil
    supply_viscosity: float | None  # of the supplied oil, with what it holds dissolved (M199)
    injection_pressure: float
    delivery_pressure: float  # mean pressure to which a pump lifts the oil, without the loss of its line (M31, M255)
    oil_source_pressure: float
    drag_power: float  # of walls that drag oil through gaps, where oil takes room; negative where oil drives them
    intake_pressure: float  # before the suction port
    plenum_pressure: float  # mean pressure behind the discharge port, in its plenum or the line
    oil_temperature: float | None
    oil_discharge_temperature: float | None
    oil_viscosity_at: ViscosityAt  # of pure oil
    film_viscosity_at: ViscosityAt  # of oil with what it holds dissolved (M199)
    oil_density_at: Callable[[float], float | None]
    pitch: Callable[[], Pitch]
    theoretical_torque: Callable[[], float]  # [N m] of the whole displacement without loss (M460)
    set_speed: float  # stated in the scene; omega where it is constant
    package: PressureLosses | None  # pressures that a package loses around the machine
    fluid: str
    suction_density: float  # of the gas in the suction line
    enthalpy: Callable[[float, float], float]  # [J/kg] of the gas at a pressure and a temperature
    drained: Callable[[float, float], tuple[float, Any]]  # at p, T: share that is not liquid, and its gas
    turn: Turn | None
    found: Mapping[str, Any] = field(default_factory=dict)  # the figures known so far, these among them:
    shaft_power, motor_power = _found("shaft_power"), _found("motor_power")  # of a drive between motor and shaft
    isothermal_efficiency, isentropic_efficiency = _found("isothermal_efficiency"), _found("isentropic_efficiency")
    cop, heating_cop = _found("cop"), _found("heating_cop")


def lazy_pitch(problem: Problem, life: Trajectory, q: Array) -> Callable[[], Pitch]:
    """Return a function that returns one pitch of all chambers of a life, computed on the first call.

    It holds no reference to its readers, so that an unused life is freed at once.
    """

    @cache
    def pitch() -> Pitch:
        """Return the pitch; its lines are as the chambers meet them, in plenums with these."""
        geometry = problem.parts.geometry
        own = {SUCTION: float(life.R[R_SUCTION + PRESSURE]), DISCHARGE: problem.lines.p_d}
        met = [chamber_end_pressure(problem, life, to) or p for to, p in own.items()]
        return pitch_of(life, geometry, min(met), float(q[Q_WORK]) / geometry.pitch, max(met))

    return pitch


def cycle_figures(
    problem: Problem, life: Trajectory, q: Array, pitch: Callable[[], Pitch] | None = None, turn: Turn | None = None
) -> CycleFigures:
    """Return the quantities of a life with quadratures q; `turn` may be None where no reading needs it."""
    parts, oil, rate = problem.parts, problem.parts.oil, problem.rate
    T_oil = oil.temperature if oil is not None else None
    oil_flow = incoming_oil(problem, life.R, q) * rate if oil is not None else 0.0
    leaked = suction_line.leak(problem, life.R).oil * rate  # (M274)
    pressures, (pure, film, supply) = _oil_pressures(problem, life), _viscosities(problem)
    taken_in = problem.inlet.density * parts.geometry.swept_volume / parts.geometry.pitch  # [kg/rad], at best
    return CycleFigures(
        omega=parts.omega,
        tip_speed=parts.geometry.settings.surface_speed(parts.omega),
        indicated_power=float(q[Q_WORK]) * rate,
        oil_mass_flow=oil_flow,
        oil_volume_flow=oil_flow / oil.density if oil is not None else 0.0,
        leaked_oil_flow=leaked / oil.density if oil is not None else 0.0,
        oil_viscosity=pure(T_oil) if T_oil is not None else None,
        supply_viscosity=supply(T_oil) if T_oil is not None else None,
        injection_pressure=pressures.injection,
        delivery_pressure=pressures.delivery,
        oil_source_pressure=pressures.source,
        drag_power=0.0 - wall_drag_work(problem.composition, q) * rate,
        intake_pressure=problem.suction.pressure,
        plenum_pressure=chamber_end_pressure(problem, life, DISCHARGE) or problem.lines.p_d,
        oil_temperature=T_oil,
        oil_discharge_temperature=_oil_discharge_temperature(problem, life, q) if oil is not None else None,
        oil_viscosity_at=pure,
        film_viscosity_at=film,
        oil_density_at=lambda T: problem.scene.oil.at(T).density if problem.scene.oil is not None else None,
        pitch=pitch or lazy_pitch(problem, life, q),
        theoretical_torque=lambda: taken_in * (problem.h_isentropic - problem.inlet.enthalpy),
        set_speed=parts.omega if parts.set_speed is None else parts.set_speed,
        package=problem.scene.losses,
        fluid=problem.scene.gas.name,
        suction_density=problem.inlet.density,
        enthalpy=parts.gas.enthalpy,
        drained=lambda p, T: after_draining(parts.gas, p, T),
        turn=turn,
    )


class OilPressures(NamedTuple):
    """Mean pressures [Pa] where oil comes in, to which a pump lifts it (M31, M255), and of its source."""

    injection: float
    delivery: float
    source: float


def _oil_pressures(problem: Problem, life: Trajectory) -> OilPressures:
    """Return the pressures of the oil's supply."""
    oil, injection = problem.parts.oil, injection_pressure(problem, life.R)
    source = oil.source_pressure if oil is not None else problem.lines.p_d
    if problem.composition.ported:
        mass, pressure, lift = life.port_oil()
        if mass > 0.0:
            return OilPressures(pressure / mass, source + lift / mass, source)
    return OilPressures(injection, max(injection, source), source)


def _viscosities(problem: Problem) -> tuple[ViscosityAt, ViscosityAt, ViscosityAt]:
    """Return viscosities [Pa s] over T [K]: of pure oil, of oil in films and of supplied oil with what they hold."""
    oil, thinning = problem.scene.oil, problem.parts.oil_thinning

    def pure(T: float) -> float | None:
        return oil.at(T).viscosity if oil is not None else None

    if thinning is None:
        return pure, pure, pure
    around = surroundings_of(problem.scene, problem.lines)

    def thinned(by: Callable[[Any, float, float], float]) -> ViscosityAt:
        def viscosity(T: float) -> float | None:
            mu = pure(T)
            return None if mu is None else by(around, T, mu)

        return viscosity

    return pure, thinned(thinning.films), thinned(thinning.supply)


def chamber_end_pressure(problem: Problem, life: Trajectory, to: str) -> float | None:
    """Return the mean pressure [Pa] at the chambers' end of a line (M184); None if it does not pulsate."""
    parts, c = problem.parts, life.composition
    for part in parts.pulsations:
        if part.to == to:
            offset = float(c.P[c.made[list(parts.made).index(part.offset)]])
            return float(life.R[parts.number(to) * PORT_STATE + PRESSURE]) * (1.0 + offset)
    return None


def _oil_discharge_temperature(problem: Problem, life: Trajectory, q: Array) -> float | None:
    """Return the oil's flow-weighted mean temperature [K] at discharge; None without an oil temperature.

    Also None with less oil than `SOME_OIL` of the gas, as the error control does not cover its temperature.
    """
    c = problem.composition
    if not c.carried:  # weighted with the gas outflow; oil leaves at constant d (transport: paper)
        heat, mass = life.oil_with_outflow() if "T_oil" in c.states else (0.0, 0.0)
        return float(heat / mass) if mass != 0.0 else None
    mean = outflow_of(streams_of(c, q))
    if mean is None or not mean.T_oil > 0.0 or mean.oil_ratio < SOME_OIL:
        return None
    return mean.T_oil - problem.oil_pressure_term(problem.lines.p_d)
