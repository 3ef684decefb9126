"""A map for TESPy's PolynomialCompressor: polynomials of isentropic and volumetric efficiency.

TESPy has P = ṁ (h_is − h_1)/η_s and ṁ = η_v V n/v_1, which are our definitions; it loses a constant share of the power
as heat, on which only the discharge temperature depends: the mean over the map is used, and its spread stated.
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from screwsim.build import build_parts
from screwsim.effects.base import Plenum
from screwsim.export.polynomials import Polynomials, check_conditions, document, polynomials
from screwsim.fluid.composition import is_blend
from screwsim.fluid.gas import Gas
from screwsim.fluid.models import condenses
from screwsim.inputs.faults import UsageError
from screwsim.outputs.customary import in_celsius
from screwsim.results import Results
from screwsim.scene import Scene, lines
from screwsim.scene.grid import case, case_count, joints_of
from screwsim.scene.operation import EVAPORATING, SPEED, SUBCOOLING
from screwsim.study.asked.varied import Varied
from screwsim.study.maps.performance_map import temperature_paths

FIGURES = ("isentropic_efficiency", "volumetric_efficiency")
SEPARATOR = "separator_temperature"
SAME_VALUE = 1e-6  # relative difference up to which the values of one map are considered equal
OTHER_MACHINE = 5e-3  # relative difference of its flow or power from ours above which an export is refused
ONE_MACHINE = (  # why two stages are refused, and what to do
    "TESPy's compressor is one machine, with one swept volume (use export en12900 or csv, or the sweep of one stage)"
)
_ONE_VALUE = (
    "{} varies together with a temperature, but TESPy's compressor takes a single one (vary it on an axis of its own)"
)
_NEEDED = (
    "displacement",
    "displacement_flow",
    "gas_mass_flow",
    "shaft_power",
    "cooling_capacity",
    "heating_capacity",
    "discharge_temperature",
    "suction_pressure",
    "discharge_pressure",
)


def check_scene(scene: Varied) -> None:
    """Raise UsageError for a sweep that is no machine of TESPy's, as its scene tells before it is simulated.

    Of a gas that is not the real fluid the density in the suction line is compared; the results tell the rest.
    """
    if not isinstance(scene, Scene):
        raise UsageError(f"two stages: {ONE_MACHINE}")
    check_conditions(scene)
    _refuse_blend(scene.gas.name, is_blend(scene.gas.name))
    for joint in joints_of(scene):
        if SPEED in joint.paths and set(temperature_paths(False)) & set(joint.paths):
            raise UsageError(_ONE_VALUE.format(SPEED))
    parts = build_parts(scene)
    besides = next((name for name, part in parts.all(Plenum) if part.product), "")
    if besides:
        what = "lets in vapour or liquid, and TESPy's compressor takes gas from one inlet"
        raise UsageError(f"effects.{besides}: {what} (leave it out, or use export en12900)")
    if not condenses(scene.gas):
        gas = parts.gas
        ratios = [_density_ratio(gas, case(scene, index)) for index in range(case_count(scene))]
        _refuse_off("gas.model", {"flow": max(ratios, key=lambda ratio: abs(ratio - 1.0))})


def _density_ratio(gas: Gas, scene: Scene) -> float:
    """Return the density of a gas in the suction line over that of the real fluid."""
    p, T = lines(scene).p_s, lines(scene).T_s
    second = ("T", T) if scene.operation.superheat else ("Q", 1)
    return gas.density(p, T) / _property("D", "P", p, *second, scene.gas.name)


def _refuse_blend(fluid: str, refused: bool) -> None:
    """Raise UsageError for a blend, to whose dew point condensing temperatures refer (M316)."""
    if refused:
        what = f"is the blend {fluid}, whose condensing temperature is that of its dew point"
        theirs = "TESPy's compressor uses that of the bubble point (use export en12900 or csv)"
        raise UsageError(f"gas.fluid: {what}; {theirs}")


def _refuse_off(where: str, ratios: Mapping[str, float]) -> None:
    """Raise UsageError where TESPy's quantities, as ratios to ours, are off by more than `OTHER_MACHINE`."""
    off = {name: abs(ratio - 1.0) for name, ratio in ratios.items()}
    name = max(off, key=lambda each: off[each])
    if off[name] > OTHER_MACHINE:
        what = f"TESPy's compressor, which takes real gas from one inlet, would be up to {off[name]:.1%} off in {name}"
        remedy = "write gas.model: real, leave out vapour or liquid that enters elsewhere, or use export en12900"
        raise UsageError(f"{where}: {what} ({remedy})")


def tespy_document(results: Results) -> dict[str, Any]:
    """Return attributes for PolynomialCompressor.set_attr, one set per point of the sweep's other axes.

    Raise UsageError where the sweep lacks what they need.
    """
    if results.stages:
        raise UsageError(f"{results.path}: holds two stages, and {ONE_MACHINE}")
    lacking = [name for name in _NEEDED if name not in results.figures]
    if lacking:
        raise UsageError(f"{results.path}: has no {lacking[0]}, which TESPy's compressor needs")
    found = polynomials(results, FIGURES)
    _refuse_blend(found.fluid, found.condensing == "dew")
    return document(found) | {
        "for": "tespy.components.PolynomialCompressor: set_attr(**attributes), then frequency as given or another",
        "maps": [_map(results, found, number) for number in range(len(found.maps))],
    }


def _map(results: Results, found: Polynomials, number: int) -> dict[str, Any]:
    one = found.maps[number]
    there = results.status == "ok"
    for path, value in one.values.items():
        there = there & (results.along(path) == value)
    cases = np.flatnonzero(there.ravel())
    displaced, swept = (results.performance[name].ravel()[cases] for name in ("displacement_flow", "displacement"))
    frequency = _common_value(displaced / swept, results, SPEED)
    superheat = found.superheat(one)
    shares = dissipated_share(results, found.fluid, superheat, cases)
    _refuse_other_machine(results, _sucked(results, found.fluid, superheat, cases), shares, cases)
    share = max(float(np.mean(shares)), 0.0)  # TESPy accepts none below 0
    eta_s, eta_v = (one.fits[name] for name in FIGURES)
    reference = {
        "T_sh": superheat,
        "T_sc": found.condition(one, SUBCOOLING),
        "frequency_poly": frequency,
        "swept_volume": _common_value(swept, results, "displacement"),
    }
    return {
        "at": {path: float(value) for path, value in one.values.items()},
        "attributes": {
            "eta_s_poly": list(eta_s.coefficients),
            "eta_vol_poly": list(eta_v.coefficients),
            "dissipation_ratio": share,
            "reference_state": reference,
        },
        "frequency": frequency,
        "frequency_unit": "Hz",
        "envelope": [list(corner) for corner in one.envelope],
        "leaves_at": leaving_temperature_figure(results),
        "largest_error": {name: one.fits[name].largest for name in FIGURES},
        "dissipation_ratio_range": [float(shares.min()), float(shares.max())],
        "errors_by_dissipation_ratio": _errors_of_share(results, found.fluid, superheat, cases, share),
    }


def _common_value(values: np.ndarray, results: Results, name: str) -> float:
    """Return the common value of all cases of a map; raise UsageError where they differ."""
    value = float(np.mean(values))
    if np.ptp(values) > SAME_VALUE * value:
        raise UsageError(f"{results.path}: {_ONE_VALUE.format(name)}")
    return value


def leaving_temperature_figure(results: Results) -> str:
    """Return the figure for the temperature of the leaving gas: that behind the separator, where there is one."""
    return SEPARATOR if SEPARATOR in results.figures else "discharge_temperature"


def dissipated_share(results: Results, fluid: str, superheat: float, cases: np.ndarray) -> np.ndarray:
    """Return the share of the shaft power that does not leave with the gas, at cases with a superheat [K].

    It is negative where other heat enters the gas, such as that of a motor in the suction gas.
    """
    figures = {name: results.performance[name].ravel()[cases] for name in _NEEDED}
    leaves = results.performance[leaving_temperature_figure(results)].ravel()[cases]
    shares = []
    for i, (h1, _, _) in enumerate(_sucked(results, fluid, superheat, cases)):
        try:
            h2 = _property("H", "P", figures["discharge_pressure"][i], "T", leaves[i], fluid)
        except ValueError:  # a temperature of saturation says not how wet it is
            what = f"gas leaves wet, at {in_celsius(leaves[i])}, and its temperature alone tells no enthalpy"
            raise UsageError(f"{results.path}: {what} (use warmer oil or less liquid, or export en12900)") from None
        shares.append(1.0 - figures["gas_mass_flow"][i] * (h2 - h1) / figures["shaft_power"][i])
    return np.array(shares)


def _errors_of_share(
    results: Results, fluid: str, superheat: float, cases: np.ndarray, share: float
) -> dict[str, float]:
    """Return the largest errors that one share of the power [1], lost at all points, makes of the gas behind it.

    Of its temperature [K], and of the condenser's heat, relative.
    """
    figures = {name: results.performance[name].ravel()[cases] for name in _NEEDED}
    leaves = results.performance[leaving_temperature_figure(results)].ravel()[cases]
    kept = (1.0 - share) * figures["shaft_power"]
    sucked = np.array([h for h, _, _ in _sucked(results, fluid, superheat, cases)])
    ends = zip(figures["discharge_pressure"], sucked + kept / figures["gas_mass_flow"], strict=True)
    warm = np.array([_property("T", "P", p, "H", h, fluid) for p, h in ends])
    heat = (figures["cooling_capacity"] + kept) / figures["heating_capacity"]
    return {
        leaving_temperature_figure(results): float(np.max(np.abs(warm - leaves))),
        "heating_capacity": float(np.max(np.abs(heat - 1.0))),
    }


def _property(*asked: Any) -> float:
    from CoolProp.CoolProp import PropsSI

    return float(PropsSI(*asked))


def _sucked(results: Results, fluid: str, superheat: float, cases: np.ndarray) -> Iterator[tuple[float, float, float]]:
    """Yield enthalpy [J/kg], density [kg/m³] and isentropic work [J/kg] of the real fluid's suction gas, by case."""
    low, high = (results.performance[f"{line}_pressure"].ravel()[cases] for line in ("suction", "discharge"))
    evaporating = results.along(EVAPORATING).ravel()[cases]
    for p_1, p_2, T in zip(low, high, evaporating, strict=True):
        second = ("T", T + superheat) if superheat > 0.0 else ("Q", 1)
        h, rho, s = (_property(wanted, "P", p_1, *second, fluid) for wanted in "HDS")
        yield h, rho, _property("H", "P", p_2, "S", s, fluid) - h


def _refuse_other_machine(
    results: Results, sucked: Iterable[tuple[float, float, float]], shares: np.ndarray, cases: np.ndarray
) -> None:
    """Raise UsageError where TESPy would make another flow, power or condenser heat of what is exported.

    It takes the real fluid's density and work (`sucked`), and all gas from one inlet; `shares` is that dissipated.
    """
    figures = {name: results.performance[name].ravel()[cases] for name in (*_NEEDED, *FIGURES)}
    gas, (_, rho, work) = figures["gas_mass_flow"], np.array(list(sucked)).T
    heat = figures["cooling_capacity"] + (1.0 - shares) * figures["shaft_power"]
    ratios = {
        "flow": figures["volumetric_efficiency"] * figures["displacement_flow"] * rho / gas,
        "power": gas * work / figures["isentropic_efficiency"] / figures["shaft_power"],
        "the condenser's heat": heat / figures["heating_capacity"],
    }
    worst = {
        name: max(np.nan_to_num(ratio, nan=1.0).tolist(), key=lambda one: abs(one - 1.0))
        for name, ratio in ratios.items()
    }
    _refuse_off(str(results.path), worst)
