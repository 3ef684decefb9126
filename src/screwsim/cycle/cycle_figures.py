"""What power losses and readings may use of a closed cycle, and powers besides gas work (docs/model.md M28–M33)."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from screwsim.build import surroundings_of
from screwsim.cycle import suction_line
from screwsim.cycle.balances import incoming_oil, injection_pressure, outflow_of, streams_of, wall_drag_work
from screwsim.cycle.pitch import Pitch, pitch_of
from screwsim.cycle.problem import Problem
from screwsim.effects.base import DISCHARGE, SUCTION, PowerLoss, PressureLosses, Turn
from screwsim.fluid.moist_air import after_draining
from screwsim.inputs.faults import checked_own_number
from screwsim.model.parts import Parts
from screwsim.model.port_states import SOME_OIL
from screwsim.model.slots import PORT_STATE, PRESSURE, Q_WORK, R_SUCTION
from screwsim.model.trajectory import Array, Trajectory
from screwsim.numerics.frozen import fast_init

ViscosityAt = Callable[[float], float | None]


@fast_init
@dataclass(frozen=True)
class CycleFigures:
    """Quantities of a closed cycle for power losses and readings (SI units); `set_speed` to `turn`: readings only."""

    omega: float
    tip_speed: float
    indicated_power: float
    oil_mass_flow: float
    oil_volume_flow: float
    oil_viscosity: float | None  # of pure oil
    injection_pressure: float
    delivery_pressure: float  # mean pressure to which a pump lifts the oil, without the loss of its line (M31, M255)
    oil_source_pressure: float
    drag_power: float  # of walls that drag oil through gaps, where oil takes room; negative where oil drives them
    plenum_pressure: float  # mean pressure behind the discharge port, in its plenum or the line
    oil_temperature: float | None
    oil_discharge_temperature: float | None
    oil_viscosity_at: ViscosityAt  # of pure oil
    oil_density_at: Callable[[float], float | None]
    pitch: Callable[[], Pitch]
    set_speed: float | None = None  # stated in the scene; omega where it is constant
    shaft_power: float | None = None
    isothermal_efficiency: float | None = None
    isentropic_efficiency: float | None = None
    cop: float | None = None
    heating_cop: float | None = None
    motor_power: float | None = None  # where a drive lies between motor and shaft
    turn: Turn | None = None
    leaked_oil_flow: float = 0.0  # [m³/s] from the discharge line to suction, bypassing the chambers
    intake_pressure: float = 0.0  # before the suction port
    package: PressureLosses | None = None  # pressures that a package loses around the machine
    enthalpy: Callable[[float, float], float] | None = None  # [J/kg] of the gas at a pressure and a temperature
    drained: Callable[[float, float], tuple[float, Any]] | None = None  # at p, T: share that is not liquid, and its gas
    suction_density: float = 0.0  # of the gas in the suction line
    theoretical_torque: Callable[[], float] | None = None  # [N m] of the whole displacement without loss (M460)
    fluid: str = ""
    film_viscosity_at: ViscosityAt = lambda T: None  # of oil with what it holds dissolved (M199)
    supply_viscosity: float | None = None  # the same of the oil that is supplied
    found: Mapping[str, Any] = field(default_factory=dict)  # the figures known so far


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
    parts, oil = problem.parts, problem.scene.oil
    T_oil = parts.oil.temperature if parts.oil is not None else None
    p_injection = injection_pressure(problem, life.R)
    p_source = parts.oil.source_pressure if parts.oil is not None else problem.lines.p_d
    p_delivery = max(p_injection, p_source)
    if problem.composition.ported:
        mass, pressure, lift = life.port_oil()
        if mass > 0.0:
            p_injection, p_delivery = pressure / mass, p_source + lift / mass
    rate = problem.rate
    oil_flow = incoming_oil(problem, life.R, q) * rate if parts.oil is not None else 0.0
    leaked = suction_line.leak(problem, life.R).oil * rate / parts.oil.density if parts.oil is not None else 0.0
    taken_in = problem.inlet.density * parts.geometry.swept_volume / parts.geometry.pitch  # [kg/rad], at best
    pure, film, supply = _viscosities(problem)
    return CycleFigures(
        omega=parts.omega,
        tip_speed=parts.geometry.settings.surface_speed(parts.omega),
        indicated_power=float(q[Q_WORK]) * rate,
        oil_mass_flow=oil_flow,
        oil_volume_flow=oil_flow / parts.oil.density if parts.oil is not None else 0.0,
        oil_viscosity=pure(T_oil) if T_oil is not None else None,
        injection_pressure=p_injection,
        delivery_pressure=p_delivery,
        oil_source_pressure=p_source,
        drag_power=0.0 - wall_drag_work(problem.composition, q) * rate,
        plenum_pressure=chamber_end_pressure(problem, life, DISCHARGE) or problem.lines.p_d,
        oil_temperature=T_oil,
        oil_discharge_temperature=_oil_discharge_temperature(problem, life, q) if oil is not None else None,
        oil_viscosity_at=pure,
        oil_density_at=lambda T: oil.at(T).density if oil is not None else None,
        pitch=pitch or lazy_pitch(problem, life, q),
        set_speed=parts.omega if parts.set_speed is None else parts.set_speed,
        turn=turn,
        leaked_oil_flow=leaked,  # (M274)
        intake_pressure=problem.suction.pressure,
        package=problem.scene.losses,
        enthalpy=parts.gas.enthalpy,
        drained=lambda p, T: after_draining(parts.gas, p, T),
        suction_density=problem.inlet.density,
        theoretical_torque=lambda: taken_in * (problem.h_isentropic - problem.inlet.enthalpy),  # (M460)
        fluid=problem.scene.gas.name,
        film_viscosity_at=film,
        supply_viscosity=supply(T_oil) if T_oil is not None else None,
    )


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


def oil_lift(parts: Parts, known: CycleFigures) -> float:
    """Return the power [W] that lifts the oil to discharge (M28).

    Where oil takes room ∮ p dV contains it, except for the work of walls that drag oil through gaps (M257).
    """
    if parts.oil_room:
        return known.drag_power
    lifted = known.oil_volume_flow * (known.plenum_pressure - known.injection_pressure)
    return lifted + known.leaked_oil_flow * (known.plenum_pressure - known.intake_pressure)


def power_losses(parts: Parts, known: CycleFigures) -> dict[str, float]:
    """Return the power losses [W], summed by name; raise Impossible where a user's effect gives no number or a gain."""
    found = {}
    for name, part in parts.all(PowerLoss):
        power = part.power(known)
        if "." in name and math.isfinite(known.indicated_power):
            checked_own_number(name, f"its power {part.figure} [W]", power, 0.0)
        found[part.figure] = found.get(part.figure, 0.0) + float(power)
    return found


def kept_in_oil(parts: Parts, known: CycleFigures) -> float:
    """Return the part of the losses' powers [W] that raises the oil's pressure (M58)."""
    return sum(float(part.kept(known)) for _, part in parts.all(PowerLoss) if part.kept is not None)


def brought_by_oil(problem: Problem, known: CycleFigures) -> float:
    """Return the flow work [W] that the oil brings to an expander, less what the shaft's own pump gave it (M491)."""
    return known.oil_volume_flow * (problem.lines.p_s - problem.lines.p_d) - kept_in_oil(problem.parts, known)


def shaft_power(parts: Parts, known: CycleFigures) -> float:
    """Return the shaft power [W] (M29)."""
    lift = oil_lift(parts, known) if parts.oil is not None else 0.0
    return known.indicated_power + lift + sum(power_losses(parts, known).values())
