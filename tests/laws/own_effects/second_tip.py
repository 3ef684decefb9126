"""A user's effect: a second leak by the law of effects.tip_leakage, beside it."""

from dataclasses import replace

from screwsim.effects.tip_leakage import EFFECT as FIRST

EFFECT = replace(FIRST, name="second_tip")
