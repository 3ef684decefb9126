"""The compositions of a series of scenes: one that differs only in its numbers is not written anew."""

from __future__ import annotations

from screwsim.model.compose import compose
from screwsim.model.composition import Composition
from screwsim.model.parts import Parts
from screwsim.model.renumbering import differ_in_numbers_only, operating_numbers, renumbered
from screwsim.numerics.frozen import with_changes
from screwsim.numerics.identity_cache import keep


class Composer:
    """Composes the scenes of a series; a scene that differs from an earlier one only in its operation shares its text.

    Each gets its own vector P: a solution never sees what another does to its numbers.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[int, int], tuple[Parts, Composition]] = {}  # by ids of geometry and effects, kept alive
        self._last: tuple[Parts, Composition] | None = None  # the last one that was written

    def lent(self) -> Composer:
        """Return a composer with the same knowledge that keeps new compositions to itself."""
        found = Composer()
        found._known, found._last = dict(self._known), self._last
        return found

    def compose(self, parts: Parts) -> Composition:
        """Return the composition of parts, reusing an earlier text where possible.

        Where machine and effects are the same objects, their contents are not compared.
        """
        key = id(parts.geometry), id(parts.effects)
        last = self._known.get(key)
        if last is not None and parts.gas == last[0].gas and differ_in_numbers_only(parts, last[0]):
            P = operating_numbers(last[1].recipe, parts)
            P[list(last[1].made)] = list(parts.made.values())
            return with_changes(last[1], P=P)
        self._known.pop(key, None)
        found = None if self._last is None else renumbered(*self._last, parts)
        if found is None:
            found = compose(parts)
            self._last = parts, found
        return keep(self._known, key, (parts, found))[1]
