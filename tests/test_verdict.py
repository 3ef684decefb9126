"""What may help follows from which limit a gas's equation has met, whatever the gas's words for it are."""

from types import SimpleNamespace

import numpy as np
import pytest

from screwsim.evaluate.verdict import REMEDIES, refused
from screwsim.fluid.limits import Limit, Outside


def a_gas(limit: Limit, what: str):
    return SimpleNamespace(first_outside=lambda T, rho: 0, why_outside=lambda T, rho: Outside(limit, what))


@pytest.mark.parametrize("limit", Limit)
def test_each_limit_has_its_remedy_even_where_the_words_name_another(limit):
    words = "the highest and the lowest of it"
    life = SimpleNamespace(times=np.radians([0.0, 90.0]), ends=(np.ones(1), np.ones(1)))
    assert refused(a_gas(limit, words), life) == f"at 90.00 deg {words}; {REMEDIES[limit]}"
