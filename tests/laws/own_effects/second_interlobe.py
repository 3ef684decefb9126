"""A user's effect: a second leak by the law of effects.interlobe_leakage, beside it."""

from dataclasses import replace

from screwsim.effects.interlobe_leakage import EFFECT as FIRST

EFFECT = replace(FIRST, name="second_interlobe")
