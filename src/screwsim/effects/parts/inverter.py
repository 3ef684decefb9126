"""Inverter of a motor: its loss by frequency and current, and the loss of the motor by speed and torque.

What: f is the speed over that of the motor's rated frequency, i the torque over the rated one, to which the
torque-producing current is proportional. P_i = ℓ [c_0 + c_1 i + (1 − c_0 − c_1) i f/0.9] (M431): the loss without load,
that of switching and conduction, and that of rectifier and choke. ℓ is the loss at 90 % of the frequency and full
current, which EU 2019/1781 has makers state; or the law is fitted to the points that it has them state (M432). The
motor's loss is ℓ_m P_r (1 + r) [c f^1.5 + (1 − c) i²] (M433): iron and friction by speed, copper by torque; for a motor
given by a table, 1 + r times the table's loss, whose efficiencies have to be those at the speed of each load. Above the
rated speed, or `full_field_speed`, the voltage stays, so that the field weakens with 1/f: a torque takes f times the
current, the first term stays, and the breakdown torque falls with 1/f².
Source: operating points: IEC 61800-9-2; 1.5: between hysteresis, 1, and eddies, 2 (textbook). The shares c_0, c_1 are
estimated; r is 0.15 up to 90 kW and 0.25 above as we know IEC TS 60034-30-2, whose text was not at hand.
Assumptions: torque and field times current in proportion; in a weaker field iron loses as much less as friction
loses more; the loss heats nothing that the machine's model sees.
Parameters: rated_speed, full_field_speed; loss, standing_share, current_share or points_file; harmonic_loss.
"""

from dataclasses import dataclass, replace
from math import isfinite
from typing import NamedTuple

import numpy as np

from screwsim.effects.base import Faults
from screwsim.inputs.declare import Derived, ReplaceableDefault, file, number, quantity
from screwsim.inputs.faults import Fault, UsageError
from screwsim.inputs.sheets import read_sheet, sheet_or_usage_error
from screwsim.inputs.textfiles import once_per_file

FREQUENCY = 0.9  # relative frequency of the point at which the loss is stated
IRON = 1.5
COLUMNS = "speed", "current", "loss"
FEWEST, POOR = 5, 0.1  # fewest rows of a file; largest deviation of its fit, over the largest loss
SMALL, SMALL_R, LARGE_R = 100e3, 0.15, 0.25  # [W] between the standard sizes 90 and 110 kW: r below it, and above
LEAST_BREAKDOWN = 1.6  # times the rated torque, of common motors: IEC 60034-12


@dataclass(frozen=True)
class Inverter:
    """An inverter, by what its manufacturer states."""

    rated_speed: float = quantity(
        "speed",
        "speed of the male rotor at which the motor runs at its rated frequency and gives its rated torque",
        gt=0.0,
    )
    loss: float | None = quantity(
        "power", "its loss at 90 % of the rated frequency and the rated current (IEC 61800-9-2)", None, ge=0.0
    )
    standing_share: float = number("c_0: share of that loss that remains without current", 0.3, ge=0.0, le=1.0)
    current_share: float = number("c_1: share of that loss proportional to the current alone", 0.4, ge=0.0, le=1.0)
    points_file: str | None = file(
        "CSV with columns speed, current (shares of the rated ones), loss (W): the manufacturer's points, in place of "
        "these three"
    )
    harmonic_loss: float = number(
        "r: additional loss of the motor on the inverter, over its loss on the mains (default: 0.15, of a rated_power "
        "above 100 kW 0.25)",
        ReplaceableDefault(SMALL_R),
        ge=0.0,
        le=2.0,
        hardly=(None, 0.5),
    )
    full_field_speed: float | None = quantity(
        "speed",
        "speed up to which the voltage rises with the frequency, beyond which it stays and the field weakens (absent: "
        "rated_speed; of windings for 230 V at 50 Hz on 400 V that of 87 Hz)",
        None,
        gt=0.0,
    )


def of_size(inverter: Inverter, rated: float) -> Inverter:
    """Return an inverter with the additional loss of a motor of a rated power [W], where none is stated (M433)."""
    if not isinstance(inverter.harmonic_loss, ReplaceableDefault | Derived):
        return inverter
    return replace(inverter, harmonic_loss=Derived(SMALL_R if rated <= SMALL else LARGE_R))


class Turning(NamedTuple):
    """Speed and torque of a motor over the rated ones."""

    speed: float
    torque: float
    full_field: float = 1.0  # speed up to which the field stays

    @property
    def weakening(self) -> float:
        """The rated field over that of this speed: where the voltage stays, the field falls with 1/f."""
        return max(self.speed / self.full_field, 1.0)

    @property
    def current(self) -> float:
        """Current that gives the torque in this field, over the rated one."""
        return self.torque * self.weakening

    @property
    def pull(self) -> float:
        """Torque over the rated one that loads a motor of full field as near to its breakdown: that falls with 1/f²."""
        return self.torque * self.weakening**2


def turning(inverter: Inverter, power: float, rated: float, omega: float) -> Turning:
    """Return speed and torque of a motor of a rated power [W] that gives `power` [W] at a rotor speed omega [rad/s]."""
    speed, full = omega / inverter.rated_speed, inverter.full_field_speed or inverter.rated_speed
    return Turning(speed, abs(power) / rated / speed, full / inverter.rated_speed)


def reach(inverter: Inverter, omega: float) -> float:
    """Return the power at the rated current over the rated one, at a rotor speed [rad/s] from the rated one on; else 1.

    It rises with the speed as long as the field stays.
    """
    at = turning(inverter, 0.0, 1.0, omega)
    return max(min(at.speed, at.full_field), 1.0)


def loss_of(inverter: Inverter) -> tuple[float, float, float, float]:
    """Return the terms of an inverter's loss [W]: constant, by current, its square, and current × frequency (M431)."""
    if inverter.points_file is not None:
        return fitted(read_points(inverter.points_file))
    assert inverter.loss is not None  # checked
    standing, current = inverter.standing_share, inverter.current_share
    by_power = (1.0 - standing - current) / FREQUENCY
    return inverter.loss * standing, inverter.loss * current, 0.0, inverter.loss * by_power


def inverter_loss(terms: tuple[float, float, float, float], at: Turning) -> float:
    """Return the loss of an inverter [W] (M431, M432)."""
    standing, current, square, power = terms
    return standing + at.current * (current + square * at.current) + power * at.torque * at.speed


def motor_share(constant_share: float, at: Turning) -> float:
    """Return a motor's loss on a sinusoidal supply over that at its rated point (M433)."""
    return constant_share * min(at.speed, at.full_field) ** IRON + (1.0 - constant_share) * at.current**2


@once_per_file
def read_points(path: str) -> list[tuple[float, ...]]:
    """Return (speed, current, loss [W]) of a maker's points; raise UsageError in one line where the file has none."""
    columns = f"the columns {', '.join(COLUMNS)}"
    words = f"has a cell that is not a number in {columns} (write one)"
    with sheet_or_usage_error(f"name a CSV file with {columns}"):
        rows = read_sheet(path).numbers(*COLUMNS, words=words)
    if not all(0.0 <= f <= 2.0 and 0.0 <= i <= 2.0 and isfinite(w) and w > 0.0 for f, i, w in rows):
        raise UsageError(
            "has a speed or current outside 0 to 2, or a loss not above 0 (give shares, not percent, and W)"
        )
    return rows


def fitted(rows: list[tuple[float, ...]]) -> tuple[float, float, float, float]:
    """Return the four terms that fit a maker's points best (M432); raise UsageError where they give no such law."""
    f, i, loss = np.array(rows).reshape(-1, 3).T
    terms = np.stack([np.ones_like(i), i, i * i, i * f], axis=1)
    if len(rows) < FEWEST or np.linalg.matrix_rank(terms) < terms.shape[1]:
        what = f"needs at least {FEWEST} points, with three currents and two speeds among them"
        raise UsageError(f"{what} (write all eight of IEC 61800-9-2)")
    found = np.linalg.lstsq(terms, loss, rcond=None)[0]
    left = float(np.max(np.abs(terms @ found - loss)))
    if left > POOR * float(loss.max()):
        raise UsageError(f"has points up to {left:.3g} W away from the law of M432 (check their speeds and currents)")
    standing, current, square, power = found.tolist()
    _check_course((standing, current, square, power), POOR * float(loss.max()))
    return standing, current, square, power


def _check_course(terms: tuple[float, float, float, float], slack: float) -> None:
    """Raise UsageError where a fitted loss is not above 0, or falls by more than `slack` [W] as the current grows."""
    for speed in (0.0, 1.0):
        course = [inverter_loss(terms, Turning(speed, current)) for current in np.linspace(0.0, 1.0, 21)]
        highest = np.maximum.accumulate(course)
        if min(course) <= 0.0 or float(np.max(highest - course)) > slack:
            what = f"implies {course[0]:.4g} W without current and {min(course):.4g} W at the least"
            raise UsageError(
                f"{what}, at {speed:g} times the rated speed: too narrow to find the loss elsewhere "
                "(write all eight of IEC 61800-9-2)"
            )


def told(at: Turning) -> tuple[str, ...]:
    """Return the warning of a motor in a weakened field with a torque near its breakdown; empty where there is none."""
    if at.weakening <= 1.0 or at.pull <= LEAST_BREAKDOWN:
        return ()
    least = LEAST_BREAKDOWN / at.weakening**2
    return (
        f"the motor turns at {at.speed:.3g} times effects.motor.inverter.rated_speed with {at.torque:.3g} times its "
        f"rated torque, and there one of the least breakdown torque, {LEAST_BREAKDOWN:g} times the rated one "
        f"(IEC 60034-12), stalls at {least:.3g} times (choose a larger motor)",
    )


def faults(inverter: Inverter, path: str) -> Faults:
    """Yield keys that an inverter lacks, that state the same twice, or a field that weakens below the rated speed."""
    if inverter.full_field_speed is not None and inverter.full_field_speed < inverter.rated_speed:
        what = "is below rated_speed, where the motor has its rated field"
        yield Fault(f"{path}.full_field_speed", f"{what} (write rated_speed or more, or remove it)")
    if inverter.points_file is not None:
        if inverter.loss is not None:
            yield Fault(
                f"{path}.loss", f"is given as well as {path}.points_file, which contains it (remove one of the two)"
            )
        try:
            fitted(read_points(inverter.points_file))
        except UsageError as error:
            yield Fault(f"{path}.points_file", str(error))
    elif inverter.loss is None:
        yield Fault(f"{path}.loss", "is missing (write e.g. loss: 2.3 kW, or points_file: points.csv)")
    if inverter.standing_share + inverter.current_share > 1.0:
        yield Fault(
            f"{path}.current_share", "exceeds the rest of the loss after standing_share (their sum may be 1 at most)"
        )
