"""Roles of effects, as texts by which the core asks for them: an effect declares in `Effect.roles` that it has one.

Roles that call for figures are declared beside those (`outputs.core`).
"""

WAY_IN = "a way between the suction line and the chambers"
WAY_OUT = "a way between the chambers and the discharge line"
SUCTION_BACK = "what flows back to suction comes in again"
PUMPS = "what pumping the oil costs"
SLIDES = "where a slide stands"
