"""The compositions of a series of scenes: one that differs only in its numbers is not written anew."""

from __future__ import annotations

from screwsim.model.compose import compose
from screwsim.model.composition import Composition
from screwsim.model.parts import Parts
from screwsim.model.renumbering import differ_in_numbers_only, operating_numbers, renumbered
from screwsim.numerics.frozen import with_changes
from screwsim.numerics.identity_cache import keep

WRITTEN = 3  # written compositions kept: a table may change, and change back


class Composer:
    """Composes the scenes of a series; a scene that differs from an earlier one only in its operation shares its text.

    Each gets its own vector P: a solution never sees what another does to its numbers.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[int, int], tuple[Parts, Composition]] = {}  # by ids of geometry and effects, kept alive
        self._written: list[tuple[Parts, Composition]] = []  # those that were written, the last one of use first

    def lent(self) -> Composer:
        """Return a composer with the same knowledge that keeps new compositions to itself."""
        found = Composer()
        found._known, found._written = dict(self._known), list(self._written)
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
        return keep(self._known, key, (parts, self._renumbered_or_written(parts)))[1]

    def _renumbered_or_written(self, parts: Parts) -> Composition:
        """Return a composition with numbers of its own and the text of one that was written, or one written anew."""
        for place, written in enumerate(self._written):
            found = renumbered(*written, parts)
            if found is not None:
                self._written.insert(0, self._written.pop(place))
                return found
        found = compose(parts)
        self._written = [(parts, found), *self._written[: WRITTEN - 1]]
        return found
