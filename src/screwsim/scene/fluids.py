"""Checks of the gas of a scene: that the fluid exists, the components of a blend are known, and humid air is valid."""

from collections.abc import Iterator
from typing import Any

from screwsim.fluid import constants, names, water
from screwsim.fluid.composition import is_blend, own_blend, stated_composition
from screwsim.fluid.description import describe
from screwsim.fluid.settings import GasSettings
from screwsim.inputs.declare import KINDS
from screwsim.inputs.faults import Fault
from screwsim.outputs.customary import in_celsius
from screwsim.scene.fields import Leaf, section_of
from screwsim.scene.lines import Lines
from screwsim.scene.units import Refused, readable_quantity
from screwsim.scene.values import convert, shown

HUMIDITY, MARGIN = "gas.relative_humidity", "gas.dew_point_margin"
AFTERCOOLER = "operation.aftercooler_temperature"
HIGHEST_PRESSURE = 1e7  # [Pa] highest pressure of the lines: beyond it third virial coefficients matter (M324)
FRACTION_SUM_TOLERANCE = 1e-6  # tolerance on the sum of fractions
_PURE = "is not a fluid or predefined blend of CoolProp"
_GAS_LEAVES = {name: item for name, item in section_of(GasSettings).fields.items() if isinstance(item, Leaf)}
_AS_LISTED = "write NAME, or for a blend {fluid: [NAME, NAME], mass_fractions: [0.7, 0.3]}"
_FRACTIONS = ("mass_fractions", "mole_fractions")


def fluid_faults(gas: GasSettings) -> Iterator[Fault]:
    """Yield faults of a gas's fluid, or of the composition of a user-defined blend."""
    found = list(_stated(gas))
    yield from found
    if not found and constants.limits(gas.name) is None:
        yield Fault("gas.fluid", names.why_no_blend(gas.name) or _unknown_fluid(gas.name))


def listed_fluid(raw: Any) -> str:
    """Return the name of a fluid listed on an axis: a name, or a mapping of a blend's components and fractions.

    Raise `Refused` for one that is unknown or badly stated. What an existing fluid lacks (data of its pairs, a
    saturation at the temperatures of the lines) is reported for its cases.
    """
    if isinstance(raw, str):
        gas = GasSettings(fluid=raw)
    elif isinstance(raw, dict) and "fluid" in raw and raw.keys() <= {"fluid", *_FRACTIONS}:
        gas = GasSettings(**{name: convert(_GAS_LEAVES[name], node.value) for name, node in raw.items()})
    else:
        raise Refused(f"{shown(raw)} is not a fluid ({_AS_LISTED})")
    faults = list(_stated(gas))
    if faults:
        told = ((fault.path.removeprefix("gas."), fault.what) for fault in faults)
        raise Refused("; ".join(what if name == "fluid" else f"{name}: {what}" for name, what in told))
    if not is_blend(gas.name) and constants.limits(gas.name) is None:
        raise Refused(_unknown_fluid(gas.name))
    own = stated_composition(gas.name)
    return gas.name if own is None else own_blend(*own)


def _stated(gas: GasSettings) -> Iterator[Fault]:
    """Yield faults in how a gas's fluid is stated, before any of its data are looked up."""
    if not isinstance(gas.fluid, str):
        yield from _own_blend(gas, gas.fluid)
        return
    for name in _FRACTIONS:
        if getattr(gas, name) is not None:
            what = "applies only to the components of a blend of your own"
            yield Fault(f"gas.{name}", f"{what} (write fluid: [NAME, NAME], or remove it; null drops a base's value)")
    own = stated_composition(gas.fluid)
    if own is not None:
        by_mass, by_mole = (None, own.fractions) if own.by_mole else (own.fractions, None)
        blend = GasSettings(fluid=own.components, mass_fractions=by_mass, mole_fractions=by_mole)
        yield from (Fault("gas.fluid", f"{gas.fluid!r}: {fault.what}") for fault in _own_blend(blend, own.components))


def _own_blend(gas: GasSettings, fluids: tuple[str, ...]) -> Iterator[Fault]:
    if len(fluids) < 2:
        yield Fault("gas.fluid", "lists fewer than two components (write fluid: NAME for a pure fluid)")
        return
    for place, name in enumerate(fluids):
        what = _component(name) if name not in fluids[:place] else f"component {name!r} is listed twice (remove one)"
        if what is not None:
            yield Fault("gas.fluid", what)
    given = [name for name in _FRACTIONS if getattr(gas, name) is not None]
    if not given:
        yield Fault("gas.mass_fractions", f"is missing (write one number for each of {', '.join(fluids)})")
    elif len(given) > 1:
        yield Fault("gas.mole_fractions", "is given as well as mass_fractions (remove one of the two)")
    else:
        yield from _fractions(f"gas.{given[0]}", getattr(gas, given[0]), fluids)


def _fractions(path: str, fractions: tuple[float, ...], fluids: tuple[str, ...]) -> Iterator[Fault]:
    total = sum(fractions)
    if len(fractions) != len(fluids):
        what = f"has {len(fractions)} numbers for {len(fluids)} components"
        yield Fault(path, f"{what} (write one for each of {', '.join(fluids)})")
    elif not all(x > 0.0 for x in fractions):
        absent = ", ".join(fluid for fluid, x in zip(fluids, fractions, strict=True) if not x > 0.0)
        yield Fault(path, f"has a share of 0 for {absent} (leave that component out)")
    elif abs(total - 1.0) > FRACTION_SUM_TOLERANCE:
        scaled = ", ".join(f"{x / total:.6g}" for x in fractions)
        yield Fault(path, f"add up to {total:.7g}, not to 1 (if they are ratios, write [{scaled}])")


def _component(name: str) -> str | None:
    """Return what is wrong with a component of a blend, or None."""
    if is_blend(name):
        return f"component {name!r} is a blend itself (list its components)"
    if constants.limits(name) is None:
        return f"component {_unknown_fluid(name, 'R134a, R1234yf, R32, R744 or Ammonia')}"
    if describe(name).pseudo_pure:
        return f"component {name!r} is a mixture described as if it were pure (list its components)"
    return None


def _unknown_fluid(fluid: str, such: str = "R134a, R1234yf, R32, R744, Ammonia or R454B") -> str:
    """Return what is wrong with the name of a fluid; another fluid is never suggested in its place."""
    shown = repr(fluid[:40])
    same, blend = names.same_fluid(fluid), names.suggested_blend(fluid)
    if same is not None:
        return f"{shown} {_PURE}; did you mean {same}?"
    if blend is not None:
        return f"{shown} {_PURE}; {blend}"
    return f"{shown} {_PURE} (name one of them, such as {such})"


def humidity_faults(gas: GasSettings, aftercooler: float | None) -> Iterator[Fault]:
    """Yield faults of what cannot be combined with a relative humidity, whatever the states of the lines."""
    if gas.relative_humidity is None:
        for path, value in ((MARGIN, gas.dew_point_margin), (AFTERCOOLER, aftercooler)):
            if value is not None:
                yield Fault(path, f"needs {HUMIDITY} (write e.g. relative_humidity: 0.6 there, or remove this)")
        return
    if not gas.is_air:
        what = f"applies only to air, and the gas is {gas.name}"
        yield Fault(HUMIDITY, f"{what} (remove it, or write fluid: air; null drops a base's value)")
    elif "." in gas.model:
        what = "needs gas.model: ideal or real, which treat air as dry air"
        yield Fault(HUMIDITY, f"{what} (write one of them, or remove this)")
    elif gas.equilibrium:
        what = "applies only to a pure fluid; the water of moist air always condenses in equilibrium"
        yield Fault("gas.two_phase", f"{what} (remove it, or write refuse)")


def line_faults(gas: GasSettings, lines: Lines) -> Iterator[Fault]:
    """Yield faults of a relative humidity where water boils, or at pressures beyond the range of its virial terms."""
    if not gas.relative_humidity:
        return
    if lines.T_s >= water.T_MOST or lines.p_s <= water.saturation(lines.T_s)[0]:
        p, T = (readable_quantity(KINDS[name], x) for name, x in (("pressure", lines.p_s), ("temperature", lines.T_s)))
        what = f"has no meaning at {p} and {T}, where water boils"
        yield Fault(HUMIDITY, f"{what} (choose a lower operation.suction.temperature, or a higher pressure)")
        return
    told = readable_quantity(KINDS["pressure"], max(lines.p_s, lines.p_d))
    vapour = gas.relative_humidity * water.saturation(lines.T_s)[0] * max(lines.p_d / lines.p_s, 1.0)
    if vapour >= water.saturation(water.T_MOST)[0]:
        what = f"brings so much water that it condenses above {in_celsius(water.T_MOST)} at {told}"
        yield Fault(HUMIDITY, f"{what}, where that is not modelled (choose drier or colder air, or a lower pressure)")
    elif max(lines.p_s, lines.p_d) > HIGHEST_PRESSURE:
        most = f"{1e-5 * HIGHEST_PRESSURE:g} bar"
        yield Fault(HUMIDITY, f"is modelled up to {most}, not at {told} (remove it, or lower the pressure)")
