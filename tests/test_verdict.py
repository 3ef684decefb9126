"""What may help follows from which limit a gas's equation has met, whatever the gas's words for it are."""

from types import SimpleNamespace

import numpy as np
import pytest

from screwsim.evaluate.verdict import REMEDIES, refused
from screwsim.fluid.limits import Limit, Outside
from screwsim.outputs import Figures, Result
from screwsim.study.accuracy.kept import warns


def a_gas(limit: Limit, what: str):
    return SimpleNamespace(first_outside=lambda T, rho: 0, why_outside=lambda T, rho: Outside(limit, what))


@pytest.mark.parametrize("limit", Limit)
def test_each_limit_has_its_remedy_even_where_the_words_name_another(limit):
    words = "the highest and the lowest of it"
    life = SimpleNamespace(times=np.radians([0.0, 90.0]), ends=(np.ones(1), np.ones(1)))
    assert refused(a_gas(limit, words), life) == f"at 90.00 deg {words}; {REMEDIES[limit]}"


@pytest.mark.parametrize(("error", "warned"), [(2e-3, True), (5e-4, False)])
def test_whether_accuracy_is_warned_of_follows_from_errors_and_not_from_words(error, warned):
    told = ("an estimated sentence of another kind",)
    assert warns(Result("ok", warnings=told, error=Figures(shaft_power=error)), 1e-3) == warned
    assert warns(Result("ok", error=Figures(shaft_power=None)), 1e-3)
