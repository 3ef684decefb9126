"""Roles of effects, as texts by which the core asks for them: an effect declares in `Effect.roles` that it has one.

Roles that call for figures are declared beside those (`outputs.core`).
"""

WAY_IN = "a path between the suction line and the chambers"
WAY_OUT = "a path between the chambers and the discharge line"
SUCTION_BACK = "what flows back to suction is taken in again"
PUMPS = "power to pump the oil"
SLIDES = "position of a slide"
