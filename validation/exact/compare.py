"""Cases with a closed form."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, log
from pathlib import Path

import numpy as np

from screwsim.build import build_gas
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.outputs import Result
from screwsim.scene import Scene, load, with_values
from screwsim.study.validation import Comparison, Panel, Row, Series, equal, solved

TITLE = "Closed forms"
CITATION = "Textbook thermodynamics; no machine, no measurement"
ABOUT = (
    "Limits in which the whole simulation has a closed form: a chamber between its ports, the same with oil, an ideal "
    "machine of fixed built-in volume ratio below, at and above its own pressure ratio, and one flooded with cold oil."
)
SHUT = (361.0, 624.9)  # angles [degree] between the ports, oil already in
OILED = 3.0  # oil over gas there
RATIOS = (1.7, 2.2, 2.7, 3.2, 4.0, 5.0, 6.5, 9.0)  # around the own pressure ratio of v_i = 2.95
IDEAL = 1e-4  # the port still takes a little angle to open: the error falls with speed over area, to the power 1/3


def trapped(result: Result, between: tuple[float, float]) -> list[np.ndarray]:
    """Return volume, pressure and temperature between two angles [degree]."""
    angle = result.cycle["angle"]
    inside = (angle >= between[0]) & (angle <= between[1])
    return [result.cycle[name][inside] for name in ("volume", "pressure", "gas_temperature")]


def spread(invariant: np.ndarray) -> float:
    """Return by how much of itself a constant changes."""
    return float(invariant.max() / invariant.min() - 1.0)


def shut_rows(here: Path) -> list[Row]:
    """Return the isentrope of a chamber between its ports, and its polytrope with oil."""
    file = here / "closed_ports.yaml"
    scene = with_values(load(file), {"oil_supply.ratio": OILED})
    gas, n = build_gas(scene), polytrope(scene, build_gas(scene))
    V, _, T = trapped(solved(file, trace=True), SHUT)
    V_oil, p_oil, _ = trapped(solved(file, values={"oil_supply.ratio": OILED}, trace=True), SHUT)
    return [
        equal(
            "between the ports: T V^(k-1), largest change",
            spread(T * V ** (gas.k - 1.0)),
            0.0,
            1e-9,
            "exact",
            basis="some hundred steps of 1e-11 each",
        ),
        equal(
            f"the same, oil of the gas's temperature: p V^n, n = {n:.4f}",
            spread(p_oil * V_oil**n),
            0.0,
            1e-5,
            "exact",
            basis="the gas lags behind the oil by 1e-6 of its temperature",
        ),
    ]


def polytrope(scene: Scene, gas: IdealGas) -> float:
    """Return n = 1 + R/(c_v + d c_o) of gas and oil that have one temperature."""
    assert scene.oil is not None
    assert scene.oil_supply is not None
    return 1.0 + gas.R / (gas.c_v + scene.oil_supply.ratio * scene.oil.heat_capacity)


def built_in_ratio(scene: Scene) -> float:
    """Return V at 360° over V at the opening of the discharge port by law (16), without dead volume."""
    machine = scene.machine
    c, x = degrees(machine.volume.phi_A) / 360.0, degrees(machine.discharge_port.opens) / 360.0
    return 1.0 / (1.0 + (x - 1.0) ** 2 / (c - 1.0))


def work(scene: Scene, ratio: float, n: float) -> float:
    """Return the work of a life [J]: fill at p_s, compress to v_i, equalise at that volume, push out at p_d."""
    v = built_in_ratio(scene)
    return scene.operation.suction.pressure * scene.machine.volume.max * ((v ** (n - 1) - 1) / (n - 1) + ratio / v - 1)


def ideal_works(here: Path, gas: IdealGas) -> tuple[list[float], list[float]]:
    """Return the works [J] of the ideal machine by pressure ratio, simulated and in closed form."""
    file = here / "ideal_machine.yaml"
    scene = load(file)
    p_s = scene.operation.suction.pressure
    found = [solved(file, values={"operation.discharge.pressure": ratio * p_s}) for ratio in RATIOS]
    return [each.performance.work_per_cycle for each in found], [work(scene, ratio, gas.k) for ratio in RATIOS]


def ideal_rows(ours: Sequence[float], theirs: Sequence[float], own: float) -> list[Row]:
    """Return rows for under-compression, near the own pressure ratio, and over-compression."""
    rows = []
    for index, name in ((RATIOS.index(1.7), "over"), (RATIOS.index(3.2), "nearly right"), (RATIOS.index(9.0), "under")):
        rows.append(
            equal(
                f"ideal machine, {name}-compression (pi = {RATIOS[index]:g}, own {own:.2f}): work, relative error"
                if name != "nearly right"
                else f"ideal machine near its own pressure ratio (pi = {RATIOS[index]:g}): work, relative error",
                ours[index] / theirs[index] - 1.0,
                0.0,
                IDEAL,
                "exact",
                basis="ports of finite width",
            )
        )
    return rows


def flooded_rows(here: Path, gas: IdealGas) -> list[Row]:
    """Return the flooded machine against its polytrope and against the isotherm."""
    file = here / "flooded.yaml"
    scene = load(file)
    n, v = polytrope(scene, gas), built_in_ratio(scene)
    ratio, p_s = v**n, scene.operation.suction.pressure
    found = solved(file, values={"operation.discharge.pressure": ratio * p_s}).performance
    isothermal = p_s * scene.machine.volume.max * log(ratio)
    return [
        equal(
            "flooded ideal machine: work, relative error",
            found.work_per_cycle / work(scene, ratio, n) - 1.0,
            0.0,
            IDEAL,
            "exact",
            basis="ports of finite width",
        ),
        equal(
            "the same over the isothermal work, less one",
            found.work_per_cycle / isothermal - 1.0,
            0.0,
            1e-3,
            "exact",
            basis="oil of 100 times the gas's mass still warms a little",
        ),
    ]


def consistency_row(here: Path, gas: IdealGas) -> Row:
    """Return isothermal over isentropic efficiency against the ratio of the two works."""
    scene = load(here / "ideal_machine.yaml")
    found = solved(here / "ideal_machine.yaml").performance
    ratio = scene.operation.discharge.pressure / scene.operation.suction.pressure
    works = log(ratio) * (gas.k - 1.0) / gas.k / (ratio ** ((gas.k - 1.0) / gas.k) - 1.0)
    return equal(
        "isothermal over isentropic efficiency",
        found.isothermal_efficiency / found.isentropic_efficiency,
        works,
        1e-12,
        "exact",
        basis="an identity: rounding",
    )


def compare(here: Path) -> Comparison:
    """Return all closed forms."""
    scene = load(here / "ideal_machine.yaml")
    gas = build_gas(scene)
    ours, theirs = ideal_works(here, gas)
    own = built_in_ratio(scene) ** gas.k
    rows = [*shut_rows(here), *ideal_rows(ours, theirs, own), *flooded_rows(here, gas), consistency_row(here, gas)]
    isentropic = [
        scene.operation.suction.pressure
        * scene.machine.volume.max
        * gas.k
        / (gas.k - 1.0)
        * (ratio ** ((gas.k - 1.0) / gas.k) - 1.0)
        for ratio in RATIOS
    ]
    panel = Panel(
        "pressure ratio π",
        "isentropic work / indicated work",
        (
            Series("simulated", RATIOS, [w / own_work for w, own_work in zip(isentropic, ours, strict=True)]),
            Series("closed form", RATIOS, [w / each for w, each in zip(isentropic, theirs, strict=True)], theirs=True),
        ),
    )
    return Comparison(TITLE, CITATION, ABOUT, rows, (panel,))
