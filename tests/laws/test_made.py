"""What the cycle makes beside its states, by an effect of a user: a wall's temperature, a factor on areas."""

import pytest
from known_figures import known_solution
from scenes import BASE, CARRIED, RADAU, change, make, run

from screwsim.build import build_parts
from screwsim.explain import explain
from screwsim.model.compose import compose

ACCURACY = 3e-4
OWN = "own_effects.warm_wall"


def wall(conductance=5.0, widening=0.0, **changes):
    own = {OWN: {"conductance": conductance, "widening": widening}}
    return {"effects": {**BASE["effects"], **own}, **CARRIED, **changes}


@pytest.mark.parametrize(
    "changes",
    [{}, {"oil.transport": "paper"}, {"numerics": {"closing": "coupled"}}, {"operation.speed": "500 rpm"}],
    ids=str,
)
def test_mass_energy_and_entropy_are_kept(changes):
    result = run(wall(**changes))
    assert result.status == "ok"
    assert max(result.balance[name] for name in ("mass", "energy", "entropy")) <= ACCURACY
    assert abs(result.ledger.relative_residue) <= ACCURACY


def test_a_wall_that_is_left_alone_gives_what_it_takes():
    result = run(wall())
    assert abs(result.ledger[f"energy_moved_{OWN}"]) < ACCURACY * result.performance.shaft_power
    assert result.ledger[f"exergy_destroyed_{OWN}"] > 1e-3 * result.performance.shaft_power
    assert change(result, run(CARRIED)) > 1e-3  # it warms the gas that is sucked in


def test_both_closings_find_one_cycle():
    assert (
        change(run(wall(widening=0.01)), run(wall(widening=0.01, numerics={"closing": "coupled", "error": "none"})))
        < ACCURACY
    )


def test_what_acts_on_nothing_changes_nothing():
    assert change(run(wall(conductance=1e-6)), run(CARRIED)) < ACCURACY


def test_a_factor_widens_the_areas_of_another_effect():
    """At the wall's temperature of some 300 K the factor is that of a blow-hole as much wider."""
    widened = run(wall(conductance=1e-6, widening=0.05))
    flow, plain = (r.ledger.gas_moved_blow_hole for r in (widened, run(CARRIED)))
    assert flow > 1.5 * plain


@pytest.mark.slow
def test_radau_finds_the_same():
    assert change(run(wall()), known_solution(make(wall(numerics=RADAU)))) < ACCURACY


def test_explain_tells_of_them():
    text = str(explain(make(wall())))
    assert "heat between gas and wall" in " ".join(text.split())
    assert "wall temperature, found with the cycle" in " ".join(text.split())
    assert "2 values of effects, besides the discharge line" in " ".join(text.split())


def test_without_them_the_text_knows_none():
    text = compose(build_parts(make(CARRIED))).text
    assert "wall" not in text


def test_unknown_names_are_told():
    parts = build_parts(make(wall()))
    parts.made.pop("blow_hole_scale")
    with pytest.raises(TypeError, match="no effect declares 'blow_hole_scale'"):
        compose(parts)
