"""How fast the housing slides over the gaps of screw rotors, seen from the rotors: over their tips and end faces.

Source: docs/model.md M256; kinematics of helical rotors (textbook). The tips of both rotors are helices of one lead
angle each, the lobes' end faces lie between root and outer circle.
"""

from math import hypot, radians

from screwsim.machine.protocol import END_GAP, TIP_GAP
from screwsim.machine.settings import TwinScrew

WRAP, CENTRES = radians(300.0), 0.8  # of the 4/6 pair of M20 and M21: wrap angle, distance of the axes over D


def wall_speeds(machine: TwinScrew) -> dict[str, float]:
    """Return the mean speed across the line of a gap over that of the male tips, by the kind of gap (M256).

    Without a profile the female rotor is as large as the male, and wrap and distance of the axes are those of a usual
    pair.
    """
    profile, male, ratio = machine.profile, 0.5 * machine.rotor_diameter, machine.male_lobes / machine.female_lobes
    female = 0.5 * profile.female_diameter if profile is not None else male
    wrap = profile.wrap_angle if profile is not None else WRAP
    centres = profile.centre_distance if profile is not None else CENTRES * machine.rotor_diameter
    lead = machine.rotor_length / wrap  # [m/rad] of the male rotor
    tips = male, ratio * female  # speeds over that of the male rotor [m]
    lines = sum(hypot(speed, lead) for speed in tips)
    faces = 0.5 * (male + centres - female), 0.5 * ratio * (female + centres - male)  # at the middle of the lobes
    return {TIP_GAP: lead * sum(tips) / (lines * male), END_GAP: 0.5 * sum(faces) / male}
