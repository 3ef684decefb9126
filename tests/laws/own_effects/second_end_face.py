"""A user's effect: a second leak by the law of effects.end_face_leakage, beside it."""

from dataclasses import replace

from screwsim.effects.end_face_leakage import EFFECT as FIRST

EFFECT = replace(FIRST, name="second_end_face")
