"""Failures that random scenes found (`tests/tools/fuzz.py`), one of each kind."""

from __future__ import annotations

from case import Case
from found_scenes import (
    BETWEEN,
    BLOWN,
    COLD_OIL,
    DRENCHED,
    FAINT,
    FILLED_WITH_LIQUID,
    FLOODED,
    HELIUM,
    HOT,
    LEAPT_OVER,
    NO_OUTFLOW,
    SHUT_IN,
    SLOW_TO_HEAT,
    STARVED,
    STILL,
    SWINGING,
    THROTTLED,
    WET_AND_LEAKY,
)

COUPLED_HYDROGEN = {"gas.fluid": "Hydrogen", "numerics.closing": "coupled"}


def _without_end() -> list[Case]:
    """Return machines whose gas can hardly get out: it heats, and few of them run steadily."""
    heats = (
        "all but nothing gets out: what leaks back is compressed again and again, and gas of more than 10 000 K, which "
        "the model has no walls to cool, drives out the fresh; "
    )
    swings = heats + "over time the chambers heat, empty, cool and fill in a swing of many pitches"
    beside = swings + ". A steady cycle is there beside it, and a search by Newton's method finds it"
    found = "the cycle closed only with Newton's method from afar"
    afar = found, "the machine does not stay on this cycle"
    nearly = heats + "the chambers swing for long; a small change grows by 1 % a pitch about the cycle that is found"
    return [
        Case("found: heats without end", BLOWN, beside, says=afar, slow=True),
        Case("found: heats and empties in a swing", SWINGING, beside, says=afar, slow=True),
        Case("found: swings for long", {**BLOWN, **COUPLED_HYDROGEN}, nearly, says=(found,), slow=True),
        Case("found: swings, hot", HOT, beside, says=afar, slow=True),
        Case("found: swings, at hardly any pressure ratio", HELIUM, beside, says=afar, slow=True),
    ]


def found_cases() -> list[Case]:
    """Return the cases."""
    at_once = (
        "a trace of oil (1e-9) takes the temperature of what flows in within less than the smallest step; its error "
        "counts as little as there is of it"
    )
    new_map = (
        "the work of so small a pressure rise is little beside the heat of so much oil, and asks for fine steps; other "
        "steps make another map, and the acceleration must forget the old one"
    )
    finer = (
        "a change of the states by 1e-7 of themselves is more energy than the work of so small a pressure rise: more "
        "pitches are called for, not finer steps"
    )
    return [
        *_without_end(),
        Case(
            "found: closes only without acceleration",
            SLOW_TO_HEAT,
            "the discharge line takes 500 pitches to heat, past a state where next to nothing changes; acceleration "
            "loses its way there",
            says=("the cycle closed only with closing without acceleration",),
            slow=True,
        ),
        Case(
            "found: closes by Newton, wet",
            WET_AND_LEAKY,
            "wet gas flows back and forth between the line and the chambers; at four times the speed less of it does. "
            "Without Newton's correction it closes from there alone",
            slow=True,
        ),
        Case(
            "found: closes only with tighter steps",
            BETWEEN,
            "13 rpm, a wide suction port and much oil: they close with finer steps than usual",
            says=("the cycle closed only with a tighter tolerance of the steps",),
        ),
        Case(
            "found: held to the lines",
            STILL,
            "p follows the lines within 1e-6 of itself at 46 rpm: the error of a step is more than what is balanced",
        ),
        Case(
            "found: a step along a closing port",
            LEAPT_OVER,
            "no breakpoint for 125° along which a wide port closes: a step saw nothing of it and was off by 0.7 %",
            radau=True,
        ),
        Case(
            "found: shut in by a closing port",
            SHUT_IN,
            "a wide port holds p to the line's until its last degrees: one step over them saw no flow at its end, and "
            "no error, and shut in 3e-4 too much whatever the tolerance",
            radau=True,
        ),
        Case(
            "found: throttled suction",
            THROTTLED,
            "the suction port throttles, p_s is far below the line's, and the discharge line's liquid flows back",
            says=("no net gas is delivered",),
            slow=True,
        ),
        Case(
            "found: entropy closes last",
            STARVED,
            "mass and energy close at once where next to no gas goes through; entropy asks for two tighter closings",
        ),
        Case("found: oil all at once", FLOODED, at_once),
        Case(
            "found: oil all at once, cold",
            COLD_OIL,
            "as the case before, colder: the first steps are of 1e-14 rad",
        ),
        Case("found: tiny work, many turns", FAINT, finer, says=("no net gas is delivered",), slow=True),
        Case("found: tiny work, much oil", DRENCHED, new_map, says=("the oil would fill",), slow=True),
        Case(
            "found: nothing flows at the discharge port",
            NO_OUTFLOW,
            "a turn on the way neither lets out nor takes in gas at the port: there is no mean state of what flows out",
        ),
        Case(
            "found: nothing flows at the discharge port, coupled",
            {**NO_OUTFLOW, "numerics.closing": "coupled"},
            "the same by coupled chambers, which acceleration leads astray",
            most=10_000_000,  # 0.5 to 8.3 million, by the last bits: acceleration throws pitches back, or not
            says=("closing without acceleration",),
            slow=True,
        ),
        Case(
            "found: filled with liquid",
            FILLED_WITH_LIQUID,
            "cold oil condenses the gas until a chamber holds liquid alone; the choking of what flows from it, a cubic "
            "across the border of the phases, dipped below none",
            most=40_000,
        ),
    ]
