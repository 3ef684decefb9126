"""A user's effect: a second leak by the law of effects.blow_hole, beside it."""

from dataclasses import replace

from screwsim.effects.blow_hole import EFFECT as FIRST

EFFECT = replace(FIRST, name="second_blow_hole")
