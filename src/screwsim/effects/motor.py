"""Motor: the electrical power behind the shaft power, from a curve of losses over the load.

What: P_el = (P_shaft + P_loss)/η_d, P_loss = ℓ P_r [c + (1 − c) x²], x = P_shaft/P_r, ℓ = 1/η_r − 1 (M148): of the loss
at rated load the share c does not depend on the load, the rest is proportional to its square. Efficiencies and COP of
P_el follow (M149). Alternatively a table gives η over the load x, and the loss of the motor is interpolated (M204).
With `inverter` the losses of motor and inverter depend on speed and torque (M431–M433).
Source: separation of losses of induction machines (textbook; IEC 60034-2-1); IEC 60034-30-1 states η_r by class and
size (M450): a four-pole IE3 motor of 75 kW at 50 Hz has 0.950, which is the default.
Assumptions: without `inverter` the loss depends on the speed only through the power; it heats neither gas nor oil, or
with `cooling: suction_gas` (semi-hermetic machines) it heats the gas on its way to the suction line (M275). An
expander's generator loses the same at the same load. The ledger divides the shaft power, so it does not hold this loss.
Above SERVICE_FACTOR times the rated power there is a warning, behind an inverter above the rated power, or above that
factor of the rated torque (assumed: NEMA has none below rated speed). Above BREAKDOWN times a motor stalls (IEC
60034-12 asks for 1.6 to 2 times the rated torque, catalogues state up to 3.5), and the point has failed; above the
rated speed of an inverter both fall with the speed squared.
Parameters: rated_power, efficiency or efficiency_class with poles, constant_share or efficiency_file, cooling,
drive_efficiency or inverter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import inf, pi

import numpy as np

from screwsim.effects.base import Effect, Faults, Given, Reading, SuctionHeat
from screwsim.effects.parts import inverter as inverters
from screwsim.effects.parts import motor_classes
from screwsim.effects.parts.usual import DRIVE
from screwsim.inputs.declare import Derived, ReplaceableDefault, choice, count, file, number, quantity
from screwsim.inputs.faults import Fault, UsageError
from screwsim.inputs.sheets import read_sheet, sheet_or_usage_error
from screwsim.inputs.textfiles import once_per_file
from screwsim.machine.protocol import ROTORS
from screwsim.numerics.pchip import Pchip
from screwsim.outputs import Figure, cooling_figure, efficiency, names_of, power_figure

FIGURES = (
    Figure("motor_loss", "W", "loss of motor and inverter"),
    power_figure("electrical_power", "electrical power"),
    efficiency("motor_efficiency", "efficiency of motor and inverter"),
    efficiency("electrical_isothermal_efficiency", "isothermal efficiency of the electrical power", by_flow=True),
    efficiency("electrical_isentropic_efficiency", "isentropic efficiency of the electrical power", by_flow=True),
    cooling_figure("electrical_cop", "1", "coefficient of performance: cooling capacity over electrical power"),
    cooling_figure(
        "electrical_heating_cop", "1", "heating coefficient of performance: heating capacity over electrical power"
    ),
)
NEITHER = "shaft power and electrical power have opposite signs: the motor's loss exceeds the power"
BESIDE_CLASS = (
    "is given as well as efficiency_class (remove one of the two; a base's value is dropped by {1}: null, or --set "
    "{0}.{1}=null)"
)
# times the rated power that common motors carry for long, on the mains and behind an inverter: NEMA MG 1, parts 12, 31
SERVICE_FACTOR, SERVICE_FACTOR_OF_INVERTED = 1.15, 1.0
KNOWN_LOSS, BREAKDOWN = 1.25, 3.5  # times the rated power, or torque: range of M148, and what no motor carries
TOO_GOOD = 0.015  # excess of the default efficiency over that of its class at the rated power, above which it is told
SUCTION, STATED = "suction_gas", "stated"
ON_ELECTRICAL = ("isothermal_efficiency", "isentropic_efficiency", "cop", "heating_cop")


@dataclass(frozen=True)
class Parameters:
    """Rated point and loss curve of the motor, and the efficiency of its inverter."""

    rated_power: float = quantity("power", "P_r: rated power at the shaft", gt=0.0)
    efficiency: float = number(
        "eta_r: efficiency at rated power (default: IE3, 75 kW, four poles)",
        ReplaceableDefault(0.95),
        gt=0.0,
        le=1.0,
        hardly=(0.3, 0.995),
    )
    efficiency_class: str = choice(
        "class of IEC 60034-30-1 at 50 Hz, in place of efficiency; uses rated_power and poles (M450)",
        (STATED, *motor_classes.CLASSES),
        STATED,
    )
    poles: int | None = count(
        "2, 4 or 6 (default: 4), for efficiency_class and for starts per hour on data sheets", None
    )
    constant_share: float = number("c: share of the rated loss that does not depend on the load", 0.4, ge=0.0, le=1.0)
    efficiency_file: str | None = file(
        "CSV with columns load, efficiency (shaft power over rated power, efficiency of the motor), in place of "
        "efficiency and efficiency_class"
    )
    cooling: str = choice(
        "ambient: its loss leaves the package; suction_gas: its loss heats the gas that is sucked in",
        ("ambient", "suction_gas"),
        "ambient",
    )
    drive_efficiency: float = number(
        "eta_d: efficiency of the inverter (1: none)", 1.0, gt=0.0, le=1.0, hardly=(0.5, None)
    )
    inverter: inverters.Inverter | None = None

    def __post_init__(self) -> None:
        """Set what follows from the rated power and is not stated: a class's efficiency, the loss by an inverter."""
        poles = self.poles or 4
        unstated = isinstance(self.efficiency, ReplaceableDefault | Derived)
        if unstated and self.is_of_class and poles in motor_classes.POLES:
            efficiency = motor_classes.class_efficiency(self.efficiency_class, poles, self.rated_power)
            object.__setattr__(self, "efficiency", Derived(efficiency))
        if self.inverter is not None:
            object.__setattr__(self, "inverter", inverters.of_size(self.inverter, self.rated_power))

    @property
    def is_of_class(self) -> bool:
        """Whether the efficiency follows from an efficiency class."""
        return self.efficiency_class in motor_classes.CLASSES

    @property
    def inverts(self) -> bool:
        """Whether the electrical power includes losses of an inverter."""
        return self.inverter is not None or self.drive_efficiency < 1.0

    @property
    def service_factor(self) -> float:
        """Times the rated power, or behind an inverter the rated current, that common motors carry for long."""
        return SERVICE_FACTOR_OF_INVERTED if self.inverts else SERVICE_FACTOR

    def carried(self, omega: float) -> float:
        """Return the power [W] that it carries for long at a speed [rad/s] of the male rotor.

        That is the rated one; above the rated speed of an inverter whose voltage rises on there, as much more.
        """
        return self.rated_power if self.inverter is None else self.rated_power * inverters.reach(self.inverter, omega)


Loss = Callable[[float], float]


def loss_of_shares(parameters: Parameters) -> Loss:
    """Return the motor's loss over its rated power as a function of the load, from its two shares (M148)."""
    rated, share = 1.0 / parameters.efficiency - 1.0, parameters.constant_share
    return lambda load: rated * (share + (1.0 - share) * load * load)


@once_per_file
def read_table(path: str) -> list[tuple[float, ...]]:
    """Return (load, efficiency), shares of the rated power and of 1, of a CSV file; raise UsageError in one line."""
    words = "is not a CSV file with numbers in the columns load, efficiency"
    with sheet_or_usage_error("name a CSV file with the columns load, efficiency"):
        rows = read_sheet(path).numbers("load", "efficiency", words=words)
    loads = [load for load, _ in rows]
    if len(rows) < 2 or not 0.0 < loads[0] or not all(a < b < inf for a, b in pairwise(loads)):
        raise UsageError("needs two rows or more, with increasing loads above 0 (sort them)")
    if loads[-1] > BREAKDOWN:
        most = f"{BREAKDOWN:g} times the rated power, which no motor carries"
        raise UsageError(f"has a load of {loads[-1]:g}, above {most} (give shares of rated_power, not percent or kW)")
    if not all(0.0 < efficiency <= 1.0 for _, efficiency in rows):
        raise UsageError("has an efficiency that is not above 0 and at most 1 (give shares, not percent)")
    return rows


def loss_of_table(rows: list[tuple[float, ...]]) -> Loss:
    """Return the motor's loss over its rated power as a function of the load, from a table of efficiencies (M204)."""
    load, efficiency = np.array(rows).T
    loss, last = load * (1.0 / efficiency - 1.0), float(load[-1])
    curve = Pchip(load, loss)

    def at(x: float) -> float:
        x = abs(x)
        return curve(max(x, float(load[0]))) if x <= last else float(loss[-1]) * x / last

    return at


def motor_loss(parameters: Parameters, load: float, loss: Loss) -> tuple[float, float]:
    """Return a motor's losses [W], alone and with its inverter, at a load [W], negative as generator (M148, M204)."""
    own = parameters.rated_power * loss(load / parameters.rated_power)
    inner = load + own
    driven = inner / parameters.drive_efficiency if inner >= 0.0 else inner * parameters.drive_efficiency
    return own, driven - load


def is_beyond(share: float, factor: float) -> bool:
    """Return whether a load, a share of the rated one, exceeds a service factor; that of an inverter to a percent."""
    return (round(share, 2) if factor == SERVICE_FACTOR_OF_INVERTED else share) > factor


def beyond_rating(share: float, factor: float) -> str:
    """Return in words that a load, a share of the rated power, lies above it; empty where it does not, to a percent.

    `factor` is the motor's service factor.
    """
    if round(share, 2) <= 1.0:
        return ""
    if factor == SERVICE_FACTOR_OF_INVERTED:
        return "above its rating, which is all that it carries for long on an inverter (NEMA MG 1)"
    place = " and" if is_beyond(share, factor) else ", within"
    return f"above its rating{place} a service factor of {factor:g} (NEMA MG 1)"


def losses_of(parameters: Parameters) -> Callable[[float, float], tuple[float, float]]:
    """Return the losses [W] of a motor, alone and with its inverter, as a function of its load [W] and speed [rad/s].

    The speed is that of the male rotor.
    """
    stated, drive, rated = parameters.efficiency_file, parameters.inverter, parameters.rated_power
    loss = loss_of_shares(parameters) if stated is None else loss_of_table(read_table(stated))
    if drive is None:
        return lambda load, omega: motor_loss(parameters, load, loss)
    terms = inverters.loss_of(drive)

    def lost(load: float, omega: float) -> tuple[float, float]:
        at = inverters.turning(drive, load, rated, omega)
        mains = loss(load / rated) if stated else loss(1.0) * inverters.motor_share(parameters.constant_share, at)
        own = rated * mains * (1.0 + drive.harmonic_loss)
        return own, own + inverters.inverter_loss(terms, at)

    return lost


def build(parameters: Parameters, machine) -> list[Reading | SuctionHeat]:
    losses = losses_of(parameters)

    def load_of(figures) -> float:
        return figures.shaft_power if figures.motor_power is None else figures.motor_power

    def judge(figures) -> tuple[str, tuple[str, ...]]:
        """Return a text where the motor cannot give its load (empty: it can), and warnings of an overload."""
        load, rated = abs(load_of(figures)), parameters.rated_power
        drive = parameters.inverter
        share, beyond, of = load / rated, _too_good(parameters), "power"
        if drive is not None:
            at = inverters.turning(drive, load, rated, figures.omega)
            share = at.current  # that of the power above rated speed, below it more
            if at.weakening > 1.0 and at.pull > BREAKDOWN:
                what = (
                    f"the motor's torque is {at.torque:.3g} times its rated one at {at.speed:.3g} times its rated speed"
                )
                least = f"no motor carries more than {BREAKDOWN / at.weakening**2:.3g} times there, in a weaker field"
                return f"{what}: {least} (choose a larger one)", ()
            beyond = (*beyond, *inverters.told(at))
            if at.speed < 1.0 or at.full_field > 1.0:
                of = "torque" if at.weakening == 1.0 else "current"
        by_power = is_beyond(load / parameters.carried(figures.omega), parameters.service_factor)
        if not by_power and share <= SERVICE_FACTOR:
            return "", beyond
        factor = parameters.service_factor
        if drive is not None and figures.omega < drive.rated_speed:
            factor, of = (SERVICE_FACTOR, "torque") if share > SERVICE_FACTOR else (factor, "power")
        what = f"the motor's load is {1e-3 * load:.4g} kW, {load / rated:.3g} times effects.motor.rated_power"
        if of != "power":
            what = f"the motor's {of} is {share:.3g} times its rated one, at {figures.omega * 30.0 / pi:.4g} rpm"
        if share > BREAKDOWN:
            return f"{what}: no motor carries more than {BREAKDOWN:g} times its rated {of} (choose a larger one)", ()
        lost = ", and its losses are outside the range of M148" if share > KNOWN_LOSS else ""
        why = f"{what}: it would not last {_limit_in_words(factor)} (NEMA MG 1){lost}"
        return "", (f"{why} (choose a larger one)", *beyond)

    def read(figures) -> Given:
        """Return loss, electrical power and the figures that refer to it (M148, M149)."""
        shaft, load = figures.shaft_power, load_of(figures)
        _, loss = losses(load, figures.omega)
        electrical = load + loss
        driving = shaft > 0.0 and electrical > 0.0
        giving = shaft < 0.0 and electrical < 0.0
        share = shaft / electrical if driving else electrical / shaft if giving else None
        found: dict[str, float | str | None] = {"motor_loss": loss, "electrical_power": electrical}
        found["motor_efficiency"] = NEITHER if share is None else share
        for name in ON_ELECTRICAL:
            value = getattr(figures, name)
            none = NEITHER if share is None else f"there is no {name.replace('_', ' ')} of the shaft power"
            found[f"electrical_{name}"] = none if value is None or share is None else value * share
        return found

    reading = Reading(names_of(FIGURES), read, judge=judge)
    heat = SuctionHeat(lambda power, omega: losses(power, omega)[0])  # the motor's loss (M275)
    return [reading, heat] if parameters.cooling == SUCTION else [reading]


def _limit_in_words(factor: float) -> str:
    """Return above what a motor of a service factor would not last."""
    if factor == SERVICE_FACTOR_OF_INVERTED:
        return "above its rating on an inverter"
    return f"above a service factor of {factor:g}"


def _too_good(parameters: Parameters) -> tuple[str, ...]:
    """Return a warning where the default efficiency, of a motor of 75 kW, is not that of one so small; else empty."""
    if not isinstance(parameters.efficiency, ReplaceableDefault) or parameters.efficiency_file is not None:
        return ()
    known, rated = motor_classes.class_efficiency(motor_classes.IE3, 4, parameters.rated_power), parameters.rated_power
    if parameters.efficiency - known <= TOO_GOOD:
        return ()
    what = f"effects.motor.efficiency is not stated, and {100.0 * parameters.efficiency:.3g} % of a motor of 75 kW"
    if rated < motor_classes.SMALLEST:
        return (f"{what} is taken for one of {rated:.4g} W (write its effects.motor.efficiency)",)
    of = f"one of {1e-3 * rated:.4g} kW and class IE3 has {100.0 * known:.3g} %"
    return (f"{what} is taken: {of} (write effects.motor.efficiency_class: IE3, or its efficiency)",)


def check(parameters: Parameters, facts) -> Faults:
    if parameters.efficiency_file is not None:
        try:
            read_table(parameters.efficiency_file)
        except UsageError as error:
            yield Fault("effects.motor.efficiency_file", str(error))
    yield from _of_class(parameters)
    if parameters.inverter is not None:
        if parameters.drive_efficiency < 1.0:
            what = "is given as well as effects.motor.inverter, whose losses go by frequency and current"
            yield Fault("effects.motor.drive_efficiency", f"{what} (remove one of the two)")
        yield from inverters.faults(parameters.inverter, "effects.motor.inverter")
    if parameters.cooling != SUCTION:
        return
    path = "effects.motor.cooling"
    if "suction_line" not in facts.effects:
        yield Fault(path, "suction_gas needs effects.suction_line, which takes the warmed gas (add it)")
    if "drive" in facts.effects:
        yield Fault(path, "suction_gas cools a motor on the machine's own shaft (remove effects.drive, or cooling)")
    if facts.machine.expands:
        yield Fault(path, "suction_gas applies only to machine.mode: compressor (remove it)")


def _of_class(parameters: Parameters) -> Faults:
    """Yield what an efficiency class does not cover, and what is stated beside it."""
    path, known = "effects.motor", motor_classes
    if parameters.poles not in (None, *known.POLES):
        yield Fault(
            f"{path}.poles", f"{parameters.poles} is not covered, only 2, 4 and 6 are (choose one, or leave it out)"
        )
    if not parameters.is_of_class:
        stated = parameters.efficiency_file is not None or not isinstance(parameters.efficiency, ReplaceableDefault)
        if parameters.poles is not None and not stated:
            what = "needs the efficiency of such a motor"
            yield Fault(f"{path}.poles", f"{what} (write efficiency_class: IE3, or efficiency, or remove it)")
        return
    if parameters.poles in (None, *known.POLES) and not isinstance(parameters.efficiency, Derived):
        yield Fault(f"{path}.efficiency", BESIDE_CLASS.format(path, "efficiency"))
    if parameters.efficiency_file is not None:
        yield Fault(f"{path}.efficiency_file", BESIDE_CLASS.format(path, "efficiency_file"))
    if not known.SMALLEST <= parameters.rated_power <= known.LARGEST:
        what = f"{1e-3 * parameters.rated_power:.4g} kW: classes cover 0.75 kW to 1000 kW"
        yield Fault(f"{path}.efficiency_class", f"{what} (write efficiency)")


EFFECT = Effect(
    name="motor",
    title="electrical power of motor and inverter",
    equations=("M148", "M149", "M204", "M275", "M431", "M432", "M433", "M450"),
    source="separation of losses; IEC 60034-30-1; IEC 61800-9-2",
    parameters=Parameters,
    build=build,
    check=check,
    figures=FIGURES,
    usual={ROTORS: DRIVE},
)
