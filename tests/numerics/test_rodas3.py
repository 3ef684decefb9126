"""Rodas3: its order conditions, its end and its dense output."""

from __future__ import annotations

import numpy as np
import pytest

from screwsim.numerics import rodas, rodas3
from screwsim.numerics.integrators import RODAS3

ROUNDING = 1e-14
ALPHA, GAMMA = RODAS3.couplings
WEIGHTS = RODAS3.constants["BETA"]
BETA = ALPHA + GAMMA
ONE = np.ones(rodas3.STAGES)
CONDITIONS = (ONE, BETA @ ONE, (ALPHA @ ONE) ** 2, BETA @ BETA @ ONE)  # orders 1, 2, 3, 3
SUMS = (1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 6.0)


def test_weights_meet_the_conditions_of_order_3():
    for condition, total in zip(CONDITIONS, SUMS, strict=True):
        assert WEIGHTS @ condition == pytest.approx(total, abs=ROUNDING)


def test_the_embedded_weights_meet_those_of_order_2_and_not_3():
    embedded = np.append(rodas3.A[-1], 0.0) @ GAMMA
    assert [embedded @ each for each in CONDITIONS[:2]] == pytest.approx(SUMS[:2], abs=ROUNDING)
    assert abs(embedded @ CONDITIONS[3] - SUMS[3]) > 0.01


def test_nodes_and_slopes_are_row_sums():
    np.testing.assert_allclose(ALPHA @ ONE, rodas3.NODES, atol=ROUNDING)
    np.testing.assert_allclose(GAMMA @ ONE, rodas3.D, atol=ROUNDING)


def test_the_last_stage_is_the_end_of_the_step():
    np.testing.assert_allclose(BETA[-1], WEIGHTS, atol=ROUNDING)  # stiffly accurate: hence L-stable


def test_the_dense_output_is_of_order_2_and_ends_at_the_step():
    w = rodas3.dense_weights()
    np.testing.assert_allclose(w.sum(axis=0), np.append(rodas3.A[-1], 1.0), atol=ROUNDING)
    for theta in (0.2, 0.5, 0.9):
        b = (theta ** np.arange(4)) @ w @ GAMMA
        assert [b @ each for each in CONDITIONS[:3]] == pytest.approx([theta, theta**2 / 2, theta**3 / 3], abs=ROUNDING)
        c3, c4 = rodas3.DENSE
        m = np.append(rodas3.A[-1], 1.0)
        assert theta * (m + (1 - theta) * (c3 + theta * c4)) @ GAMMA == pytest.approx(b, abs=ROUNDING)


def test_its_constants_are_all_by_which_the_methods_differ():
    lines = "\n".join(f"rodas__{name} = 0" for name in RODAS3.constants)
    assert RODAS3.into(f"{lines}\nrodas__GROWTH = 2.5").endswith("rodas__GROWTH = 2.5")
    for name, value in RODAS3.constants.items():
        assert np.ndim(value) == np.ndim(getattr(rodas, name))
    with pytest.raises(ValueError, match="POWER"):
        RODAS3.into(lines.replace("rodas__POWER", "another"))
