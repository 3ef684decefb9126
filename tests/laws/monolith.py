"""All chambers and the drive as one system of equations over the angle, integrated by scipy's Radau.

It shares the chambers' right-hand side with the simulator, at a speed that is one of the states; nothing of how
chambers and drive are closed by turns, of the speed as a curve, or of the collocation.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from screwsim.cycle.simultaneous import chambers_at_pitches
from screwsim.machine.drive.train import Train
from screwsim.model.all_chambers import inject, moved_on, pitch_breakpoints
from screwsim.model.slots import E_AREAS, E_SLOPE, FREE, P_OMEGA, PORT_STATE, PRESSURE


class Monolith:
    """States: those of all chambers, then rotor speed, motor speed, twist, time; the machinery has a constant speed."""

    def __init__(self, machinery, train: Train, no_load: float, low_pressure: float, loss_torque: float) -> None:
        self.machinery, self.train, self.no_load = machinery, train, no_load
        self.low, self.loss = low_pressure, loss_torque
        c = machinery.composition
        self.n, self.size = c.chambers * machinery.n, E_AREAS + len(c.ports) + len(c.gaps)
        self.E, self.f, self.g = np.empty(c.n_E_all), np.empty(self.n), np.empty(machinery.nq + 1)

    def rates(self, s: float, middle: float, y: np.ndarray) -> np.ndarray:
        """Return dy/dφ."""
        module, context, c, train = self.machinery.together, self.machinery.coupled_context, self.c, self.train
        omega, motor_speed, twist, _ = y[self.n :]
        c.P[P_OMEGA] = omega
        context[3][-c.chambers :] = FREE
        module.chambers__surroundings(s, middle, context, self.E)
        module.chambers__rates(np.ascontiguousarray(y[: self.n]), self.E, context, self.f, self.g)
        pressures = context[3][: c.chambers * PORT_STATE].reshape(-1, PORT_STATE)[:, PRESSURE]
        gas = -float((pressures - self.low) @ self.E.reshape(c.chambers, self.size)[:, E_SLOPE])
        spring = train.coupling.torque(twist) + train.damping * (motor_speed - omega)
        drive = train.motor.limited_torque(motor_speed, self.no_load)
        own = (
            (spring - gas - self.loss) / (train.rotor_inertia * omega),
            (drive - spring) / (train.motor_inertia * omega),
            (motor_speed - omega) / omega,
            1.0 / omega,
        )
        return np.concatenate([self.f, own])

    @property
    def c(self):
        return self.machinery.composition

    def pitch(self, y: np.ndarray, rtol: float = 1e-7) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return (angles, states along them, end) of one pitch from y, oil injected at its start."""
        y = y.copy()
        chambers = y[: self.n].copy()
        inject(self.machinery, chambers)
        y[: self.n] = chambers
        angles, states = [], []
        breakpoints = pitch_breakpoints(self.machinery)
        for first, last in pairwise(breakpoints):
            middle = 0.5 * (first + last)
            found = solve_ivp(
                lambda s, state, middle=middle: self.rates(s, middle, state),
                (first, last),
                y,
                "Radau",
                rtol=rtol,
                atol=rtol * np.maximum(np.abs(y), 1e-6),
            )
            assert found.status == 0
            angles.append(found.t[:-1])
            states.append(found.y.T[:-1])
            y = found.y[:, -1]
        end = np.concatenate([moved_on(self.machinery, y[: self.n]), y[self.n :]])
        return np.concatenate(angles), np.concatenate(states), end


def start_of(machinery, motion) -> np.ndarray:
    """Return the state at 0° of a cycle closed with its drive."""
    own = [motion.speed[0], motion.motor_speed[0], motion.twist[0], 0.0]
    return np.concatenate([chambers_at_pitches(machinery), own])
