"""The numbers of docs/reference/slider-crank.md and docs/reference/coupling.md are those that the scripts print."""

import math
from dataclasses import replace

import numpy as np
import pytest
from folders import ROOT

from screwsim.machine.slider_crank import rod as rods
from screwsim.machine.slider_crank import tolerance as law
from screwsim.study.validation import sibling

pytestmark = pytest.mark.around
CRANK, COUPLING = (
    (ROOT / "docs" / "reference" / f"{name}.md").read_text(encoding="utf-8").replace("−", "-")
    for name in ("slider-crank", "coupling")
)


def script(name: str):
    return sibling(ROOT / "scripts" / f"{name}.py")


@pytest.fixture(scope="module")
def study():
    return script("tolerance_study")


@pytest.fixture(scope="module")
def table(study):
    return study.printed_table()


def test_agreement_with_the_printed_table_is_as_stated(study, table):
    counts = [
        int(np.sum(np.abs(function(table.angles, links) - table.values) <= table.half))
        for function, links in (
            (law.tabulated, study.NOMINAL),
            (law.tabulated, study.ROUNDED),
            (law.printed, study.NOMINAL),
            (law.right, study.NOMINAL),
        )
    ]
    assert counts == [32, 27, 2, 0]


def test_the_ten_deviations_are_as_stated(study, table):
    lines = [line for line in CRANK.splitlines() if line.count("|") == 9]
    for row in study.read_table(study.DATA / "deviations.csv")[:-1]:
        changed = study.NOMINAL.scaled(*(1 + 0.01 * float(row[key]) for key in ("crank_percent", "rod_percent")))
        theirs = float(row["deviation"])
        found = (
            law.deviation(law.tabulated, table.angles, study.NOMINAL, changed, table.values),
            law.deviation(law.tabulated, table.angles, study.NOMINAL, changed),
            law.deviation(law.right, table.angles, study.NOMINAL, changed),
        )
        cells = " | ".join(f"{1e3 * ours:.6f} | {100 * (ours / theirs - 1):+.1f} %" for ours in found)
        assert any(line.endswith(f"| {1e3 * theirs:.6f} | {cells} |") for line in lines), row


@pytest.mark.parametrize(("crank", "rod"), [(7, 7), (10, 10), (14, 14), (15, 15), (15, 16), (18, 18)])
def test_grades_are_as_stated(study, crank, rod):
    g = law.grade(law.right, study.TURN, study.NOMINAL, crank, rod)
    cells = f"| {1e3 * g.crank_width:.3f} mm | {1e3 * g.rod_width:.3f} mm | {100 * g.error:.2f} %"
    assert f"{cells} | ±{1e3 * g.head:.3f} mm |" in CRANK


def test_grades_for_a_share_are_as_stated(study):
    found = [law.coarsest(law.right, study.TURN, study.NOMINAL, share) for share in (0.05, 0.01, 0.005, 0.001)]
    assert [g.crank for g in found if g] == [18, 15, 14, 10]
    assert "within 1 % needs IT15, within 0.5 % IT14, within\n0.1 % IT10" in CRANK


def test_reference_rod_is_as_stated():
    module = script("connecting_rod")
    design = module.read_design()
    rod = module.rod_of(design)
    load = rods.SchmidtLoad(**{name: design[name] for name in ("bore", "p_min", "delta", "theta")})
    bending = rods.bend(rod, module.ALPHA, load.load(module.ALPHA))
    low = float(bending.load.min())
    assert f"| {low:.1f} … {bending.load.max():.1f} N |" in CRANK
    assert (
        f"| {rod.gamma(low):.3f}; {rods.critical_gamma(rod.beta):.3f} (buckles at {rods.buckling_load(rod):.1f} N"
        in CRANK
    )
    assert f"| {1e3 * rods.largest_moment_place(rod, low):.2f} mm of 23 mm |" in CRANK
    found = [rods.safety(bending, rods.Fatigue(concentration=factor)) for factor in module.FACTORS]
    assert f"| {1e-6 * found[0].lowest:.1f} … {1e-6 * found[0].highest:.1f} MPa (117.2 MPa" in CRANK
    assert f"| {1e-6 * found[0].amplitude:.1f} MPa about {1e-6 * found[0].mean:.1f} MPa |" in CRANK
    assert f"| {' / '.join(f'{each.factor:.2f}' for each in found)} | 2.7 |" in CRANK
    assert f"| {' / '.join(f'{2.7 * 600 / each.factor:.0f}' for each in found)} MPa |" in CRANK
    unit = rods.friction_power(bending, design["guide"], rod.crank_radius, 100 * math.pi, 1.0)
    assert f"| {' / '.join(f'{mu * unit:.2f}' for mu in module.FRICTION)} W | about 3 W |" in CRANK
    assert f"coefficient of friction of {3.0 / unit:.2f}" in CRANK


def test_coupling_is_as_stated():
    module = script("coupling")
    for lean in module.read_leans().values():
        each = replace(module.COUPLING, lean_plus=lean.mean, lean_minus=lean.mean)
        theta, far = each.twist(11768.0), each.twist(35304.0)
        eps = each.largest_strain(theta)
        force = module.pull(eps, each.cord_stiffness, each.cord_stiffening)
        cells = f"| {math.degrees(theta):.3f}° | {1e-3 * each.stiffness(theta):.1f} kN m/rad | {100 * eps:.2f} %"
        assert f"{cells} | {force:.2f} N | {math.degrees(far):.3f}° |" in COUPLING
    every = module.read_leans()["all"]
    bands = [module.torque_band(module.COUPLING, math.radians(x), every.low, every.high) for x in (1.0, 1.5)]
    for found in bands:
        for value in (found.least, found.largest):
            assert f"{value:,.0f}".replace(",", " ") in COUPLING
