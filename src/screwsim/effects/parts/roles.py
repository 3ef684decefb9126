"""Roles of effects that the core asks for in words: an effect says in `Effect.roles` that it has one.

Those that call for figures are declared with these (`outputs.core`).
"""

WAY_IN = "a way between the suction line and the chambers"
WAY_OUT = "a way between the chambers and the discharge line"
SUCTION_BACK = "what flows back to suction comes in again"
PUMPS = "what pumping the oil costs"
SLIDES = "where a slide stands"
