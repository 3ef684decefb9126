"""The composition of blends: CoolProp's predefined mixtures by their names, and blends of the user's own.

A blend has one name wherever a fluid is named: that of CoolProp without its ending (`R454B`), with it where a
pseudo-pure fluid has the short one (`R407C.mix`), and for the user's own `R32/R1234yf (0.689/0.311)`, by mass, or with
`(mole 0.8/0.2)`.
"""

import re
from collections.abc import Sequence
from functools import cache, lru_cache
from typing import Any, NamedTuple

from screwsim.fluid.coolprop_cache import cached_answer
from screwsim.inputs.faults import UsageError

ENDING = ".mix"
REMEDY = "choose another blend, such as R454B, R513A or R448A, or a pure fluid"
_OWN = re.compile(r"(?P<names>[^ ]+/[^ ]+) \((?P<mole>mole )?(?P<fractions>[0-9.e/+-]+)\)")
_NUMBER = re.compile(r"[0-9]*\.?[0-9]+(e[+-]?[0-9]{1,3})?|[0-9]+\.")


class BlendComposition(NamedTuple):
    """The components of a blend, by their names, and their fractions, by mass or by mole."""

    components: tuple[str, ...]
    fractions: tuple[float, ...]
    by_mole: bool


def own_blend(components: Sequence[str], fractions: Sequence[float], by_mole: bool) -> str:
    """Return the name of a blend of the user's own."""
    return f"{'/'.join(components)} ({'mole ' if by_mole else ''}{'/'.join(repr(float(x)) for x in fractions)})"


def stated_composition(fluid: str) -> BlendComposition | None:
    """Return the composition that the name of a user's own blend states, as written; None for any other name."""
    found = _OWN.fullmatch(fluid)
    numbers = [] if found is None else found["fractions"].split("/")
    if found is None or not all(_NUMBER.fullmatch(each) for each in numbers):
        return None
    return BlendComposition(tuple(found["names"].split("/")), tuple(map(float, numbers)), found["mole"] is not None)


def _own(fluid: str) -> BlendComposition | None:
    found = stated_composition(fluid)
    total = sum(found.fractions) if found is not None else 0.0
    return found._replace(fractions=tuple(x / total for x in found.fractions)) if found and total > 0.0 else None


@cache
def predefined() -> dict[str, str]:
    """Return CoolProp's names of its predefined mixtures, by the names used here."""

    def question() -> dict[str, str]:
        import CoolProp.CoolProp as coolprop

        def pure(name: str) -> bool:
            try:
                return bool(coolprop.AbstractState("HEOS", name))
            except ValueError:
                return False

        listed = coolprop.get_global_param_string("predefined_mixtures").split(",")
        names = [each for each in listed if each.endswith(ENDING)]
        return {each if pure(each.removesuffix(ENDING)) else each.removesuffix(ENDING): each for each in names}

    return cached_answer("predefined mixtures", question)


def predefined_name(name: str) -> str | None:
    """Return the name used here of a predefined mixture, given with or without its ending; None for others."""
    known = predefined()
    short = name.removesuffix(ENDING)
    return name if name in known else short if name == f"{short}{ENDING}" and short in known else None


@lru_cache(maxsize=256)
def is_blend(fluid: str) -> bool:
    """Tell whether a name is that of a blend, whether or not data for it exist."""
    return _own(fluid) is not None or predefined_name(fluid) is not None


@lru_cache(maxsize=256)
def composition(fluid: str) -> BlendComposition | None:
    """Return the composition of a blend; None for any other name. Predefined blends are by mole."""
    own = _own(fluid)
    name = None if own is not None else predefined_name(fluid)
    if name is None:
        return own

    def question() -> list[list[str] | list[float]]:
        state = abstract_state(name, predefined()[name])
        return [state.fluid_names(), state.get_mole_fractions()]

    components, fractions = cached_answer(f"composition {name}", question)
    return BlendComposition(tuple(components), tuple(fractions), True)


def abstract_state(fluid: str, called: str) -> Any:
    """Return the CoolProp state of a name of CoolProp's. Raises UsageError, in one line, where it has none."""
    import CoolProp.CoolProp as coolprop

    try:
        return coolprop.AbstractState("HEOS", called)
    except ValueError as error:
        reason = str(error).splitlines()[0]
    pair = re.search(r"binary pair \[([0-9-]+),([0-9-]+)\]", reason)
    if pair is not None:
        pure = coolprop.get_global_param_string("FluidsList").split(",")
        numbers = {coolprop.get_fluid_param_string(each, "CAS"): each for each in pure}
        first, second = (numbers.get(number, number) for number in pair.groups())
        what = f"CoolProp has no data of the pair {first} and {second}"
    else:
        unknown = re.search(r"key \[(.+?)\]", reason)
        what = f"CoolProp has no pure fluid {unknown[1]!r}" if unknown else f"CoolProp refuses it ({reason[:120]})"
    raise UsageError(f"gas.fluid: {fluid}: {what}; {REMEDY}")
