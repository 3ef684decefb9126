"""Gaps full of oil in the cycle: what leaks and what that generates, balances, limits, and independent integration."""

import numpy as np
import pytest
from each_row import each_row
from known_figures import known_solution
from scenes import DROP, FILM, FILMS, OIL_VOLUME, RADAU, SOLUBLE_RATE, TOGETHER, change, closed, make, refusal, run

from screwsim.build import build_parts
from screwsim.explain import explain
from screwsim.fluid.gap_flow import film_flux
from screwsim.model.compose import compose
from screwsim.model.slots import OIL_TEMPERATURE, PORT_STATE, PRESSURE

ACCURACY = 3e-4  # numerics.accuracy
PLENUMS = {
    "suction_volume": "8 l",
    "discharge_volume": "3 l",
    "suction_area": "40 cm^2",
    "discharge_area": "15 cm^2",
}
ROOM = {**OIL_VOLUME, **FILMS}
CASES = {
    "films": FILMS,
    "room": ROOM,
    "ports and room": {**TOGETHER, **FILMS},
    "oil that flashes over time": {**SOLUBLE_RATE, **FILMS},
    "plenums": {**FILMS, "effects.plenums": PLENUMS},
}
# the other gaps bring more oil than that everywhere; walls at rest, as those of all gaps of RESTING
SEALED = {**FILM, "filled_from": 1e-5, "wall_speed": 0}
RESTING = {**FILMS, "effects.tip_leakage.wall_speed": 0, "effects.end_face_leakage.wall_speed": 0}
GAP, PASSAGE, LENGTH = 50e-6, 2e-3, 9.83 * 0.16
OIL_VISCOSITY, OIL_DENSITY = 20e-3, 1000.0


def tip(base=FILMS, **changes):
    """Return the scene with a tip that is full of oil everywhere, with changes of its parameters; others nozzles."""
    plain = {name: value for name, value in base.items() if "_leakage" not in name}
    return {**plain, "effects.tip_leakage": {"gap": "50 um", "reading": "interface", **SEALED, **changes}}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_mass_energy_entropy_and_oil_close(case):
    result = run(CASES[case])
    assert result.status == "ok"
    balances = (result.balance[name] for name in ("mass", "energy", "entropy", "oil_mass"))
    assert max(balances) <= result.balance.bound


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_coupled_chambers_agree_with_histories(case):
    assert (
        change(run({**CASES[case], "numerics": {"closing": "coupled", "error": "none"}}), run(CASES[case])) < ACCURACY
    )


@pytest.mark.parametrize("case", ["films", "room"])
def test_radau_finds_the_same(case):
    assert change(run(CASES[case]), known_solution(make({**CASES[case], "numerics": RADAU}))) < ACCURACY


# ---- what leaks ----------------------------------------------------------------------------------------------------


def followed(cycle):
    """Return (angles, pressure drop to the chamber behind, tip area of that interface) of injected chambers."""
    phi = np.arange(400.0, 590.0)
    pressure = np.interp(phi, cycle["angle"], cycle["pressure"]) - np.interp(
        phi - 90.0, cycle["angle"], cycle["pressure"]
    )
    behind = phi - 90.0
    share = np.where(behind <= 360.0, behind / 360.0, 2.0 - behind / 360.0)  # M19
    return phi, pressure, 0.7 * GAP * LENGTH * share


def test_the_oil_that_leaks_is_that_of_a_film():
    cycle = run(RESTING).cycle
    phi, drop, area = followed(cycle)
    expected = area * np.array([film_flux(max(p, 0.0), GAP, PASSAGE, OIL_VISCOSITY, OIL_DENSITY) for p in drop])
    poiseuille = area * OIL_DENSITY * GAP**2 * drop / (12.0 * OIL_VISCOSITY * PASSAGE)
    found = -np.interp(phi, cycle["angle"], cycle["oil_flow_tip_leakage_trailing"])
    assert found == pytest.approx(expected, rel=1e-3)
    assert found == pytest.approx(poiseuille, rel=0.02)  # nearly all of it friction


def test_no_gas_leaks_out_of_a_chamber_that_has_oil():
    cycle = run(FILMS).cycle
    behind = (cycle["angle"] > 400.0) & (cycle["angle"] < 590.0)
    assert (cycle["mass_flow_tip_leakage_trailing"][behind] == 0.0).all()
    assert (cycle["oil_flow_tip_leakage_trailing"][behind] < 0.0).all()


def test_what_leaves_one_chamber_enters_the_one_behind():
    cycle = run(FILMS).cycle
    offsets = dict(compose(build_parts(make(FILMS))).gaps)
    for gap in ("tip_leakage", "interlobe_leakage"):  # one interface each
        phi = np.arange(10.0, 620.0 - 90.0 * offsets[gap])
        ahead, behind = cycle[f"oil_flow_{gap}_leading"], cycle[f"oil_flow_{gap}_trailing"]
        there = np.interp(phi, cycle["angle"], ahead)
        here = np.interp(phi + 90.0 * offsets[gap], cycle["angle"], behind)
        assert there == pytest.approx(-here, rel=2e-3, abs=2e-3 * abs(there).max()), gap


@pytest.mark.slow
@pytest.mark.parametrize("room", [False, True])
def test_the_ledger_has_what_films_generate(room):
    """M254 over a fine grid of angles, of films to the chamber behind and between the last one and the line.

    A dead volume that keeps its oil to the end: without it the last gas, squeezed, leaks after the oil.
    """
    scene = {**tip(ROOM if room else FILMS), "machine.volume.min": "20 cm^3"}
    entry = run(scene).ledger.entropy_generated_tip_leakage
    _, _, cycle = closed(make(scene))
    assert cycle.status == "ok"
    m, per_life = cycle.trajectory, 0.5 * np.pi

    def generated(q, T_u, p_u, T, p):
        drop = (p_u - p) / OIL_DENSITY if room else 0.0
        return np.maximum(q, 0.0) * ((2000.0 * (T_u - T) + drop) / T - 2000.0 * np.log(T_u / T))

    phi = np.linspace(per_life, 4.0 * np.pi, 63001)
    own, behind = (m.sample(angles)[0] for angles in (phi, phi - per_life))
    here, there = (own[:, 6], own[:, 1]), (behind[:, 6], behind[:, 1])
    q = m.oil_films(phi)[:, 1]
    between = generated(-q, *here, *there) + generated(q, *there, *here)
    beyond = np.linspace(3.5 * np.pi, 4.0 * np.pi, 9001)
    q, (last, _), line = m.oil_films(beyond)[:, 0], m.sample(beyond), m.R[PORT_STATE:]
    p, T = line[PRESSURE], line[OIL_TEMPERATURE]
    T -= p / (2000.0 * OIL_DENSITY) if room else 0.0
    to_and_fro = generated(q, T, p, last[:, 6], last[:, 1]) + generated(-q, last[:, 6], last[:, 1], T, p)
    expected = (np.trapezoid(between, phi) + np.trapezoid(to_and_fro, beyond)) / per_life
    assert min(between.min(), to_and_fro.min()) >= -1e-12
    assert entry == pytest.approx(expected, rel=2e-3)


def test_films_generate_entropy():
    for case in ("films", "room", "oil that flashes over time"):
        ledger = run(CASES[case]).ledger
        for gap in ("tip", "interlobe", "end_face"):
            assert ledger[f"entropy_generated_{gap}_leakage"] > 0.0


# ---- limits --------------------------------------------------------------------------------------------------------

WITHOUT = {"oil.transport": "carried", "effects.tip_leakage": DROP}


def test_viscous_oil_seals_the_gap():
    sealed = run({**tip(), "oil.viscosity": "20e6 mPa s"})
    assert change(sealed, run(WITHOUT)) < ACCURACY
    assert change(run(tip()), run(WITHOUT)) > ACCURACY  # and such oil as there is does not


def test_no_clearance_no_leak():
    assert change(run(tip(gap="0.1 um", filled_from=0.2)), run(WITHOUT)) < ACCURACY


def test_without_oil_the_gap_is_the_nozzle():
    dry = {"oil_supply.ratio": 0, "oil.transport": "carried"}
    plain = run(dry)
    assert change(run({**FILMS, **dry}), plain) < ACCURACY


def test_a_gap_that_is_never_full_is_the_nozzle():
    assert change(run(tip(filled_from=1e6)), run({"oil.transport": "carried"})) < ACCURACY


def test_oil_in_the_gaps_makes_a_better_machine():
    filled, plain = run(FILMS).performance, run({"oil.transport": "carried"}).performance
    assert filled.volumetric_efficiency > plain.volumetric_efficiency
    assert filled.isentropic_efficiency > plain.isentropic_efficiency


# ---- what is said --------------------------------------------------------------------------------------------------


def test_a_scene_without_films_has_none_in_its_text():
    text = compose(build_parts(make({"oil.transport": "carried"}))).text
    assert "film" not in text
    assert "chamber__film_flows" in compose(build_parts(make(FILMS))).text


def test_explain_names_the_film():
    text = " ".join(str(explain(make(FILMS))).split())
    assert "full of oil from 0.2 kg per kg of gas upwards: viscous film (M250-M252)" in text


@each_row(
    ("changes", "words"),
    [
        ({"filled_from": DROP}, "effects.tip_leakage.filled_from: is missing (model: oil_film needs it"),
        ({"passage": DROP}, "effects.tip_leakage.passage: is missing"),
        ({"filled_from": 0.0}, "effects.tip_leakage.filled_from"),
        ({"gas_viscosity": "12 uPa s"}, "gas_viscosity: has no meaning with model: oil_film"),
        ({"mixture_viscosity": "mcadams"}, "mixture_viscosity: has no meaning with model: oil_film"),
        ({"model": "nozzle", "passage": DROP}, "filled_from: has no meaning with model: nozzle"),
        ({"model": "oil_sealed", "mixture_viscosity": "mcadams"}, "filled_from: has no meaning with model: oil_sealed"),
    ],
)
def test_parameters_that_do_not_go_together_are_said(changes, words):
    assert words in refusal({**FILMS, **{f"effects.tip_leakage.{name}": value for name, value in changes.items()}})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"oil.transport": "paper"}, "oil_film needs oil.transport: carried"),
        ({"effects.oil_heat": DROP}, "oil_film needs oil in the chambers"),
        ({"oil.viscosity": DROP}, "oil.viscosity: is missing (effects.tip_leakage.model: oil_film needs it"),
    ],
)
def test_oil_that_is_not_there_is_said(changes, words):
    assert words in refusal({**FILMS, **changes})
