"""Gas torque: the torque of the gas in all chambers on the male rotor's shaft, and its forces on the rotors, by angle.

What: M(φ) = −Σ (p − p_s) dV/dφ over the chambers alive (virtual work, M144), its share on each rotor (M145), its
harmonics of the lobe frequency (M147); forces F = A Σ (p − p_s) on stated projected areas (M146).
Source: virtual work (textbook); with a rotor profile each rotor's part of dV/dφ is known (docs/reference/rotors.md).
Assumptions: quasi-steady, rigid rotors in phase; the lower line's pressure around the rotors; the forces of all
chambers point in one direction, so they are upper limits. The torque does not act back on the cycle; with `drive` it
moves the shaft.
Parameters: male_share, axial_area, radial_area.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from screwsim.effects.base import Effect, Faults, Reading
from screwsim.inputs.declare import number, optional
from screwsim.inputs.faults import Fault
from screwsim.machine.protocol import ROTORS
from screwsim.outputs import Figure, Trace, names_of, over

FORCES = ("axial", "radial")
SWING = over("gas_torque_peak_to_peak")  # scale of the errors of means that may pass through zero
SHARED = (".male_share", "machine.profile")
WHICH = ("the", "twice the", "three times the", "four times the")
HARMONICS = tuple(f"gas_torque_harmonic_{k}" for k in range(1, len(WHICH) + 1))
OF_SWING = "torque of the gas, highest minus lowest value"
OF_FEMALE = "mean torque of the gas on the female rotor itself"
FIGURES = (
    Figure(
        "gas_torque_mean",
        "N m",
        "mean torque of the gas on the male rotor's shaft, that of the female rotor included",
        SWING,
    ),
    Figure("gas_torque_peak_to_peak", "N m", OF_SWING, SWING, swing_of="gas_torque"),
    *(
        Figure(name, "N m", f"amplitude of the gas torque at {which} lobe frequency", SWING)
        for name, which in zip(HARMONICS, WHICH, strict=True)
    ),
    Figure("male_gas_torque", "N m", "mean torque of the gas on the male rotor itself", SWING, SHARED),
    Figure("female_gas_torque", "N m", f"{OF_FEMALE}, about its own axis", SWING, SHARED),
    *(
        Figure(
            f"{way}_gas_force{what}",
            "N",
            f"{of} {way} force of the gas on a rotor{by}",
            over(f"{way}_gas_force_peak"),
            (f".{way}_area",),
        )
        for way in FORCES
        for what, of, by in (("", "mean", ", from the stated area"), ("_peak", "largest", ""))
    ),
)


@dataclass(frozen=True)
class Parameters:
    """What the machine's laws do not know: the rotors' share, and the areas on which the gas presses."""

    male_share: float | None = number(
        "share of the male rotor in the work of the torque (known for rotors with a profile)", None, ge=0.0, le=1.0
    )
    axial_area: float | None = optional("area", "projected axial area of one chamber")
    radial_area: float | None = optional("area", "projected radial area of one chamber")


def torque(pitch) -> np.ndarray:
    """Return the gas torque at the points of a pitch [N m] (M144); its mean is the indicated power over ω.

    The sum over the points misses that mean by an error of the trace, which is spread evenly over the points.
    """
    raw = raw_torque(pitch)
    return raw + (pitch.torque_mean - raw.mean())


def raw_torque(pitch) -> np.ndarray:
    """Return the gas torque at the points of a pitch [N m] as the trace gives it, without that correction."""
    return _work(pitch.pressure - pitch.low_pressure, pitch.slope)


def smooth_torque(pitch, points: int) -> np.ndarray:
    """Return the torque [N m] at `points` (odd) even angles of a pitch, from its Fourier integrals (M144, M147).

    The quadrature intervals are at most half a wave of the highest harmonic long.
    """
    within = pitch.within(points)
    return within.smooth(_work(within.pressure - pitch.low_pressure, within.slope), pitch.torque_mean, points)


def _work(excess: np.ndarray, slope: np.ndarray) -> np.ndarray:
    return -(excess * slope).sum(axis=1)


def on_rotors(parameters: Parameters, pitch, ratio: float) -> tuple[float | None, float | None]:
    """Return the mean torques on male and female shaft [N m]; `ratio`: female over male lobes (M145).

    Both are None where no share of the rotors is known.
    """
    share = parameters.male_share
    if pitch.male_slope is not None:
        within = pitch.within()
        excess = within.pressure - pitch.low_pressure
        work = within.mean(_work(excess, within.slope))
        share = within.mean(_work(excess, within.male_slope)) / work if work != 0.0 else None
    if share is None:
        return None, None
    return share * pitch.torque_mean, (1.0 - share) * pitch.torque_mean * ratio


def rotor_torques(parameters: Parameters, pitch, ratio: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the torques on male and female shaft at the points of a pitch [N m]; None where no share is known (M145).

    Each is about the rotor's own axis; their means are those of `on_rotors`.
    """
    means, curve = on_rotors(parameters, pitch, ratio), torque(pitch)
    if means[0] is None or means[1] is None:
        return None
    if pitch.male_slope is None:
        male = (parameters.male_share or 0.0) * curve
    else:
        male = -((pitch.pressure - pitch.low_pressure) * pitch.male_slope).sum(axis=1)
        male += means[0] - male.mean()
    return male, (curve - male) * ratio


def force(area: float | None, pitch) -> np.ndarray | None:
    """Return the gas force [N] on each chamber's area [m²] at the points of a pitch (M146); None without one."""
    return None if area is None else area * (pitch.pressure - pitch.low_pressure).sum(axis=1)


def build(parameters: Parameters, machine) -> list[Reading]:
    areas = {"axial": parameters.axial_area, "radial": parameters.radial_area}
    ratio = machine.settings.female_lobes / machine.settings.male_lobes

    def read(figures) -> dict[str, float | None]:
        """Return the figures of torque and forces (M144–M147)."""
        pitch = figures.pitch()
        (low, high), (_, most) = pitch.extremes(
            lambda p, slope: _work(p - pitch.low_pressure, slope), lambda p, _: (p - pitch.low_pressure).sum(axis=1)
        )
        within = pitch.within()
        excess = within.pressure - pitch.low_pressure
        values: list[float | None] = [pitch.torque_mean, high - low]
        values += within.harmonics(_work(excess, within.slope), len(WHICH))
        values += on_rotors(parameters, pitch, ratio)
        mean = within.mean(excess.sum(axis=1))
        for area in (areas[way] for way in FORCES):
            values += [None, None] if area is None else [area * mean, area * most]
        return dict(zip(names_of(FIGURES), values, strict=True))

    def traces(figures) -> dict[str, Any]:
        pitch = figures.pitch()
        found = {"gas_torque": torque(pitch)}
        if (rotors := rotor_torques(parameters, pitch, ratio)) is not None:
            found |= zip(("male_gas_torque", "female_gas_torque"), rotors, strict=True)
        found |= {f"{way}_gas_force": force(areas[way], pitch) for way in FORCES if areas[way] is not None}
        return found

    return [Reading(names_of(FIGURES), read, traces)]


def check(parameters: Parameters, facts) -> Faults:
    if facts.machine.volume.from_rotors and parameters.male_share is not None:
        what = "is given as well as machine.volume.law: profile, which finds it by angle (remove it)"
        yield Fault("effects.gas_torque.male_share", what)


EFFECT = Effect(
    name="gas_torque",
    title="torque and forces of the gas on the rotors",
    equations=("M144", "M145", "M146", "M147"),
    source="virtual work (textbook)",
    parameters=Parameters,
    build=build,
    check=check,
    needs=frozenset({ROTORS}),
    figures=FIGURES,
    traces=(
        Trace("gas_torque", "N m", "torque of the gas in all chambers on the male rotor's shaft"),
        Trace("male_gas_torque", "N m", "torque of the gas in all chambers on the male rotor itself"),
        Trace("female_gas_torque", "N m", "torque of the gas on the female rotor itself, about its own axis"),
        Trace("axial_gas_force", "N", "axial force of the gas in all chambers on a rotor"),
        Trace("radial_gas_force", "N", "radial force of the gas in all chambers on a rotor"),
    ),
)
