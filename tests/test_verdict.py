"""What may help follows from which limit a gas's equation has met, whatever the gas's words for it are."""

from types import SimpleNamespace

import numpy as np
import pytest

from screwsim.fluid.limits import Limit, Outside
from screwsim.verdict import REMEDIES, refused


def a_solution(limit: Limit, what: str):
    gas = SimpleNamespace(first_outside=lambda T, rho: 0, why_outside=lambda T, rho: Outside(limit, what))
    last = np.radians([0.0, 90.0]), np.ones((1, 4, 2)), np.ones((1, 1)), 1
    return SimpleNamespace(parts=SimpleNamespace(gas=gas), machinery=SimpleNamespace(last=lambda: last))


@pytest.mark.parametrize("limit", Limit)
def test_each_limit_has_its_remedy_even_where_the_words_name_another(limit):
    words = "the highest and the lowest of it"
    assert refused(a_solution(limit, words)) == f"at 90.00 deg {words}; {REMEDIES[limit]}"
