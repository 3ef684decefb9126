"""Results files without a simulation: efficiencies with a known optimum, a cycle of simple shapes."""

import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from result_fakes import CYCLE as CYCLE  # beside those of this module
from result_fakes import SCENE

from screwsim.outputs import Figures, Result
from screwsim.results import Results, open_results, save
from screwsim.results.schema import Axis, axis_of
from screwsim.scene import Scene, grid, loads

DISPLACED = SCENE.replace("kind: pump, ratio: 3", "kind: displacement, orifice_diameter: 3 mm")
SPEEDS = "  operation.speed: [5000 rpm, 3000 rpm, 1000 rpm, 500 rpm, 250 rpm]\n"
RATIOS = "  oil_supply.ratio: {from: 0.1, to: 10, count: 20, spacing: log}\n"
PUMP = SCENE + "sweep:\n" + SPEEDS + RATIOS
SPEED = DISPLACED + "sweep:\n  operation.speed: {from: 250 rpm, to: 6000 rpm, count: 14, spacing: log}\n"
BEST_RATIO, BEST = 1.7, 0.6  # of every curve over the ratio


def cycle(peak: float = 14e5) -> dict[str, np.ndarray]:
    """Return traces of a compression from 1.5 bar; the pressure ends in a spike of one degree."""
    angle = np.arange(0.0, 721.0)
    volume = 5e-4 * np.sin(np.radians(angle / 4.0)) ** 2 + 1e-7
    pressure = np.where(angle < 360.0, 1.5e5, np.minimum(1.5e5 * 5e-4 / volume, 12e5))
    pressure[-1] = peak
    flow = np.where(angle > 600.0, -1.0, 0.0)
    return {
        "angle": angle,
        "volume": volume,
        "pressure": pressure,
        "gas_temperature": 280.0 + pressure / 2e4,
        "oil_temperature": np.where(angle < 360.0, np.nan, 293.0),
        "gas_mass": 1e-3 + 1e-9 * pressure,
        "mass_flow_suction_port": np.where(angle < 360.0, 0.4, 0.0),
        "mass_flow_discharge_port": flow,
        "mass_flow_tip_leakage_leading": 0.01 * np.sin(np.radians(angle)),
        "mass_flow_tip_leakage_trailing": -0.01 * np.sin(np.radians(angle)),
    }


def ok(case: Scene, keep: bool = False) -> Result:
    """Return figures of a case: η is a parabola in ln d around BEST_RATIO; without a given d, d falls with speed."""
    speed = case.operation.speed
    ratio = case.oil_supply.ratio or 300.0 / speed
    efficiency = BEST - 0.03 * np.log(ratio / BEST_RATIO) ** 2 + 1e-5 * speed
    figures = Figures(
        isothermal_efficiency=efficiency,
        isentropic_efficiency=0.9 * efficiency,
        volumetric_efficiency=0.9,
        shaft_power=10.0 * speed,
        gas_mass_flow=1e-3 * speed,
        discharge_temperature=330.0 + 1e-9 * ratio,
        oil_ratio=ratio,
    )
    return Result("ok", performance=figures, cycle=cycle() if keep else {})


def some_fail(case: Scene) -> Result:
    """Fail at the two lowest ratios, do not close at the highest, and lose the value of one more."""
    result, ratio = ok(case), case.oil_supply.ratio
    if ratio < 0.13:
        return Result("failed", message="the integration stopped")
    return Result("not_closed" if ratio > 9.0 else "ok", performance=result.performance)


LEDGER = Figures(
    ambient_temperature=298.15,
    shaft_power=3141.0,
    gas_exergy_rise=2200.0,
    oil_exergy_rise=-59.0,
    exergy_destroyed=999.9,
    residue=0.1,
    relative_residue=0.1 / 3141.0,
    exergy_destroyed_suction_port=1.0,
    exergy_destroyed_discharge_port=250.0,
    exergy_destroyed_tip_leakage=799.0,
    exergy_destroyed_blow_hole=1.9,
    exergy_destroyed_oil_supply=-52.0,
)


def with_ledger(case: Scene) -> Result:
    """Return figures, a cycle and a ledger."""
    return replace(with_cycle(case), ledger=LEDGER)


def file(path: Path, text: str, simulate=ok) -> Path:
    """Write a results file of a scene, of its sweep when it has one."""
    path.write_bytes(_made(text, simulate))
    return path


@lru_cache(maxsize=16)
def _made(text: str, simulate: Callable[[Scene], Result]) -> bytes:
    """Return a results file: many tests change a copy of the same one."""
    scene = loads(text)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "made.h5"
        if scene.sweep:
            results = [simulate(grid.case(scene, i)) for i in range(grid.case_count(scene))]
            save(path, scene, results, "sweep")
        else:
            save(path, scene, simulate(scene))
        return path.read_bytes()


WARNING = "the estimated error of shaft_power, 0.0012, is above the wanted accuracy 0.0003"


def some_warn(case: Scene) -> Result:
    """Return what `with_ledger` does; slow machines warn once, and of much oil twice."""
    result = with_ledger(case)
    told = [WARNING] if case.operation.speed < 110.0 else []
    told += ["the oil would fill 120% of the chamber"] if told and case.oil_supply.ratio > 3.5 else []
    return replace(result, warnings=tuple(told))


def cooling(case: Scene) -> Result:
    """Return figures with a capacity and a COP."""
    result, speed = ok(case), case.operation.speed
    more = {"cooling_capacity": 400.0 * speed, "cop": 4.0 - 0.002 * speed + 0.1 * case.oil_supply.ratio}
    return replace(result, performance=Figures(result.performance, **more))


def expanding(case: Scene) -> Result:
    """Return the cycle of an expander with its ledger: the gas gives 3141 W, the shaft 2200 W."""
    ledger = Figures(LEDGER, shaft_power=-2200.0, gas_exergy_rise=-3141.0, oil_exergy_rise=-58.9)
    result = with_cycle(case)
    figures = Figures(result.performance, shaft_power=-2200.0, output_power=2200.0)
    return replace(result, performance=figures, ledger=ledger)


def without_warnings(path: Path) -> Path:
    """Take the variable of the warnings out of a results file, as one that never had it."""
    import h5py

    with h5py.File(path, "r+") as file:
        for name in {"warnings", "warnings_text"} & set(file["performance"]):
            del file["performance"][name]
    return path


def design(path: Path) -> Results:
    """Return the results of a sweep over the oil ratio as if the speed and an oil temperature varied with it."""
    results = open_results(path)
    (ratio,) = results.axis_list
    count = len(ratio.values)
    speed = axis_of("operation.speed", np.linspace(30.0, 500.0, count), "rad/s", "speed")
    oil = axis_of("oil_supply.temperature", 280.0 + 20.0 * np.sin(np.arange(count)), "K", "temperature of the oil")
    return replace(results, axis_list=(Axis("case", np.arange(count, dtype=np.int32), "1", "", (ratio, speed, oil)),))


def with_cycle(case: Scene) -> Result:
    """Return figures and a cycle."""
    return ok(case, keep=True)
