"""Drive: motor, coupling and rotors as two masses joined by a spring; the speed varies over a lobe pitch.

What: two inertias on a shaft (M210), the coupling between them (M211: a linear spring, or the rubber-cord coupling of
docs/reference/coupling.md; viscous damping), the motor's line (M212), and on the rotors the gas torque M144 and the
torque of the losses (M213); their periodic motion (M214), found together with the cycle (M217), its energies (M215) and
the torsional frequency (M216).
Source: two-mass oscillator (textbook); for the rubber cords V. A. Ilyichev, V. S. Korneev, S. A. Korneev: Discrete
mathematical model of a rubber-cord flat coupling, Omsk Scientific Bulletin, 2015 (in Russian); M. Kloss 1916 for the
induction motor.
Assumptions: rotors without play, the female's inertia referred to the male shaft; of a cylinder no torque accelerates
piston and rod; losses are a constant torque of their mean power; damping is viscous; the motor's torque follows its
speed at once. docs/reference/drive.md says when it matters.
Parameters: motor_inertia, rotor_inertia, speed, coupling, motor.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from screwsim.effects.base import Effect, Faults, Given, Reading, Shaft
from screwsim.effects.gas_torque import smooth_torque
from screwsim.inputs.declare import choice, quantity
from screwsim.inputs.faults import Fault
from screwsim.machine.drive.collocation import POINTS
from screwsim.machine.drive.response import NoMotion, Response, extremes, peak_to_peak, respond
from screwsim.machine.drive.rubber_cord_coupling import RubberCordCoupling, check_coupling
from screwsim.machine.drive.train import LinearCoupling, Motor, Train, check_motor
from screwsim.numerics.identity_cache import keep
from screwsim.outputs import Figure, Trace, names_of, power_figure
from screwsim.outputs.customary import RPM

KEPT = 3  # motions remembered: those before and after a turn, and that of the turn that estimates the error
SWING = "coupling_torque_amplitude", "twist_amplitude"  # the coupling's loss is proportional to their square
FIGURES = (
    Figure("mean_speed", "rad s-1", "mean speed of the rotors, over time"),
    Figure("no_load_speed", "rad s-1", "speed at which the motor's torque vanishes"),
    Figure("speed_ripple", "1", "largest minus smallest speed of the rotors, over the mean", swing_of="speed"),
    Figure(
        "motor_speed_ripple", "1", "largest minus smallest speed of the motor, over the mean", swing_of="motor_speed"
    ),
    Figure("coupling_torque_mean", "N m", "mean torque of the coupling over the rotors' angle"),
    Figure(
        "coupling_torque_amplitude",
        "N m",
        "half of the coupling torque's range, from lowest to highest",
        swing_of="coupling_torque",
    ),
    Figure("coupling_torque_peak", "N m", "largest magnitude of the coupling torque"),
    Figure("twist_mean", "rad", "mean twist of the coupling over the rotors' angle"),
    Figure("twist_amplitude", "rad", "half of the twist's range, from lowest to highest", swing_of="twist"),
    Figure("torsional_frequency", "Hz", "first torsional frequency of small motions about the mean twist, undamped"),
    Figure("resonance_speed", "rad s-1", "speed at which the lobe frequency equals the torsional frequency"),
    power_figure("motor_power", "mean power from the motor to the coupling"),
    Figure(
        "coupling_loss",
        "W",
        "mean power dissipated by the coupling's damping",
        curve=SWING,
        square_of=("motor_speed", "speed"),
    ),
)
TRACES = (  # values of `Response`, by its names
    Trace("speed", "rad s-1", "speed of the male rotor"),
    Trace("motor_speed", "rad s-1", "speed of the motor"),
    Trace("twist", "rad", "twist of the coupling, the motor ahead"),
    Trace("coupling_torque", "N m", "torque of the coupling"),
    Trace("motor_torque", "N m", "torque of the motor"),
)


@dataclass(frozen=True)
class Coupling:
    """The spring between motor and rotors, of one of two kinds, and its damping."""

    linear: LinearCoupling | None = None
    rubber_cord: RubberCordCoupling | None = None
    damping: float = quantity("torsional_damping", "torque over the difference of the speeds", 0.0, ge=0.0)

    @property
    def spring(self) -> LinearCoupling | RubberCordCoupling:
        """The spring that is given, of the two kinds."""
        given = self.linear or self.rubber_cord
        assert given is not None  # `check`
        return given


@dataclass(frozen=True)
class Parameters:
    """Inertias on the male rotor's shaft, coupling, motor, and what operation.speed means."""

    motor_inertia: float = quantity("inertia", "inertia of the motor and its half of the coupling", gt=0.0)
    rotor_inertia: float = quantity(
        "inertia", "inertia of the rotors and their half of the coupling, on the male shaft", gt=0.0
    )
    coupling: Coupling = field(kw_only=True)
    motor: Motor = field(kw_only=True)
    speed: str = choice(
        "meaning of operation.speed: the mean speed that a controller holds, or the motor's no-load speed",
        ("mean", "no_load"),
        "mean",
    )


def energies(motion: Response) -> tuple[float, float, float]:
    """Return the means over time of motor power, coupling loss and load power [W] (M215)."""
    slip = motion.motor_speed - motion.speed
    loss = motion.power(motion.train.damping * slip, slip)
    return motion.power(motion.motor_torque, motion.motor_speed), loss, motion.power(motion.load, motion.speed)


def judged(motion: Response) -> tuple[str, tuple[str, ...], float]:
    """Return a text on what rules a motion out (empty: nothing), warnings, and the residual of its powers (M215).

    The residual is relative to the largest of the three powers.
    """
    train, torque = motion.train, motion.coupling_torque
    sound = train.coupling.state(float(motion.twist[np.argmax(np.abs(motion.twist))]))
    why = "" if sound == "sound" else f"under the steady ripple {sound}"
    most = float(np.max(np.abs(motion.motor_torque)))
    if not why and most > train.motor.most:
        why = (
            f"the motor would have to give {most:.4g} N m at the peak of its ripple, and gives {train.motor.most:.4g} "
            "N m at most (choose a larger motor, or a flatter line)"
        )
    warnings = []
    low, high = extremes(torque)
    if low * high < 0.0:
        warnings.append(
            f"the coupling torque changes its sign ({low:.4g} to {high:.4g} N m): flanks and cords would hammer, and "
            "this model of the drive has no play (choose more inertia or damping, or a speed farther from resonance)"
        )
    order = train.near_resonance(float(motion.twist.mean()), motion.mean_speed)
    if order is not None:
        at = train.resonance_speed(float(motion.twist.mean()), order) / RPM
        warnings.append(
            f"resonance: lobe harmonic {order} meets the torsional frequency at {at:.5g} rpm, and the speed is "
            f"{motion.mean_speed / RPM:.5g} rpm; the amplitude depends on the damping"
        )
    power, loss, load = energies(motion)
    return why, tuple(warnings), abs(power - loss - load) / max(abs(power), abs(loss), abs(load), 1e-300)


def build(parameters: Parameters, machine) -> list[Shaft | Reading]:
    lobes = round(2.0 * math.pi / machine.pitch)

    def train(speed: float) -> Train:
        coupling = parameters.coupling
        inertias, held = (parameters.motor_inertia, parameters.rotor_inertia), parameters.speed == "mean"
        return Train(*inertias, coupling.spring, coupling.damping, parameters.motor, held, speed, lobes)

    last: dict[Any, Response | NoMotion] = {}  # figures, traces and the closing of the cycle need the same motions

    def motion(figures) -> Response:
        # torque of gas and losses on the rotors at the collocated angles of a pitch [N m] (M144, M213)
        losses = (figures.shaft_power - figures.indicated_power) / figures.omega
        load = smooth_torque(figures.pitch(), POINTS) + losses
        key = load.tobytes(), figures.set_speed, figures.omega
        found = last.get(key)
        if found is None:
            try:  # from the load alone, not from an earlier motion: the bits do not depend on what was solved before
                found = respond(train(figures.set_speed), load, figures.omega)
            except NoMotion as reason:
                found = reason
            keep(last, key, found, KEPT)
        if isinstance(found, NoMotion):
            raise found
        return found

    def read(figures) -> Given:
        """Return the figures of the drive (M214–M216), or a text that says why it has no steady motion."""
        try:
            found = motion(figures)
        except NoMotion as reason:
            return dict.fromkeys(names_of(FIGURES), str(reason))
        train, torque, twist = found.train, found.coupling_torque, found.twist
        mean_twist = float(twist.mean())
        power, loss, _ = energies(found)
        values = (
            found.mean_speed,
            found.no_load_speed,
            found.ripple,
            peak_to_peak(found.motor_speed) / found.mean_speed,
            float(torque.mean()),
            0.5 * peak_to_peak(torque),
            max(map(abs, extremes(torque))),
            mean_twist,
            0.5 * peak_to_peak(twist),
            train.frequency(mean_twist),
            train.resonance_speed(mean_twist),
            power,
            loss,
        )
        return dict(zip(names_of(FIGURES), values, strict=True))

    def traces(figures) -> dict[str, Any]:
        """Return speeds, twist and torques over a pitch; empty where there is no steady motion."""
        try:
            found = motion(figures)
        except NoMotion:
            return {}
        return {each.name: getattr(found, each.name) for each in TRACES}

    return [Shaft(train, motion, judged), Reading(names_of(FIGURES), read, traces)]


def check(parameters: Parameters, facts) -> Faults:
    path, coupling = "effects.drive.coupling", parameters.coupling
    yield from check_motor(parameters.motor, "effects.drive.motor")
    if (coupling.linear is None) == (coupling.rubber_cord is None):
        yield Fault(path, "needs one of linear and rubber_cord (write e.g. linear: {spring: 5000 N m/rad})")
    for fault in check_coupling(coupling.rubber_cord) if coupling.rubber_cord is not None else ():
        yield Fault(fault.path.replace("coupling", f"{path}.rubber_cord", 1), fault.what)


EFFECT = Effect(
    name="drive",
    title="motor, coupling and rotors; the speed follows from their torques",
    equations=("M210", "M211", "M212", "M213", "M214", "M215", "M216", "M217"),
    source="two-mass oscillator (textbook); Ilyichev et al. 2015 (cords); Kloss 1916",
    parameters=Parameters,
    build=build,
    check=check,
    figures=FIGURES,
    traces=TRACES,
)
