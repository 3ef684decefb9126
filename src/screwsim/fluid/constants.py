"""Properties of fluids outside the compiled cycle: constants, saturation, enthalpies; CoolProp's answers are cached.

Blends are computed by `blend_border` instead of CoolProp. Importing CoolProp takes seconds, so each question is asked
once and its answer appended to a file, one whole line each: many processes may write it, and a torn or damaged line is
simply asked again. The file's name holds CoolProp's version, so a new version starts afresh. Neither file nor memory
grows with a sweep over conditions: a process writes only its first answers to the file, a full file is begun anew by
the next process, and the oldest answers in memory are dropped.
"""

import importlib.metadata
import json
import threading
from collections.abc import Callable
from functools import cache
from itertools import count
from typing import Any, NamedTuple

from screwsim.fluid.blend_border import BlendBorder, blend_border
from screwsim.fluid.blend_dome import blend_wet
from screwsim.fluid.blend_flash import table_name
from screwsim.fluid.composition import is_blend
from screwsim.fluid.coolprop_cache import no_fluid
from screwsim.fluid.description import describe
from screwsim.inputs.faults import UsageError
from screwsim.numerics.identity_cache import keep
from screwsim.numerics.store import append_line, checked_line, read_lines
from screwsim.outputs.customary import in_bar, in_celsius

_FULL = 1_000_000  # [byte] largest size of the file, some 10 000 answers; it is read at every start, in 10 ms
_MOST = 5000  # most answers in memory
_LEFT = 1000  # most answers of a process that go into the file: those that its scenes need at their start
LEAST_HEAT_CAPACITY = 2.5  # [R] cp0 of any gas: that of the motion of whole molecules,
ROUNDING = 1e-6  # a share of which CoolProp's may miss
BOILED_AT, PARTS_FROM = 1.01325e5, 1.0  # [Pa], [K]: glide there from which a pseudo-pure fluid parts as it boils
_alone = threading.RLock()  # setting a CoolProp state and reading it must not interleave


class Limits(NamedTuple):
    """Temperatures [K] and vapour pressures [Pa] between which a fluid saturates, and its equation's highest T."""

    T_triple: float
    T_critical: float
    p_triple: float
    p_critical: float
    T_max: float

    @property
    def gas_only(self) -> bool:
        """Whether it is a blend that is known as a gas only, from T_triple = T_critical on (M317)."""
        return self.p_critical == 0.0


@cache
def _file() -> str:
    return f"coolprop-{importlib.metadata.version('CoolProp')}.answers"


_known: dict[str, Any] = {}  # the answers of this process by their keys
_answered = count()  # answers that this process has computed


@cache
def _stored_lines() -> dict[str, str]:
    """Return the lines of the file by their keys; a line is parsed when it is needed."""
    return {line.partition('["')[2].partition('", ')[0]: line for line in read_lines(_file(), _FULL)}


def ask(key: str, question: Callable[[], Any]) -> Any:
    """Return the answer to a question to CoolProp, which is only asked where no answer is known for its key."""
    found = _known.get(key)  # without the lock: an answer never changes
    if found is not None:
        return found
    with _alone:
        if key not in _known:
            text = checked_line(_stored_lines().get(json.dumps(key)[1:-1], ""))
            answer = question() if text is None else json.loads(text)[1]
            keep(_known, key, answer, _MOST)
            if text is None and next(_answered) < _LEFT:
                append_line(_file(), json.dumps([key, answer]), _FULL)
        return _known[key]


@cache
def coolprop_state(fluid: str) -> Any:
    """Return CoolProp's state of a pure fluid, and CoolProp. Raises UsageError for an unknown one."""
    import CoolProp.CoolProp as coolprop

    try:
        return coolprop.AbstractState("HEOS", fluid), coolprop
    except ValueError as error:
        raise no_fluid(fluid, error) from None


def blend_of(fluid: str) -> BlendBorder | None:
    """Return the properties of a blend; None for any other name. Raises UsageError for a blend without data."""
    return blend_border(fluid) if is_blend(fluid) else None


def limits(fluid: str) -> Limits | None:
    """Return the limits of a fluid, of a blend by its dew line; None for an unknown fluid."""
    try:
        mixed = blend_of(fluid)
    except UsageError:  # reported by `names.why_no_blend`
        return None
    if mixed is not None:
        found = mixed.lines
        if found.always_gas:
            return Limits(found.T_low, found.T_low, 0.0, 0.0, mixed.known.T_max)
        return Limits(found.T_low, found.T_c, mixed.dew_pressure(found.T_low), found.p_c, mixed.known.T_max)

    def question() -> list[float] | None:
        try:
            state, coolprop = coolprop_state(fluid)
            if len(state.fluid_names()) != 1:
                return None
            T_triple = state.Ttriple()
            state.update(coolprop.QT_INPUTS, 1.0, T_triple)
            return [T_triple, state.T_critical(), state.p(), state.p_critical(), state.Tmax()]
        except (UsageError, ValueError):
            return None

    asked = ask(f"{fluid} limits", question)
    return None if asked is None else Limits(*asked)


def gas_constant(fluid: str) -> float:
    """Return the specific gas constant R [J/(kg K)]."""
    mixed = blend_of(fluid)
    if mixed is not None:
        return mixed.known.R

    def question() -> float:
        state, _ = coolprop_state(fluid)
        return state.gas_constant() / state.molar_mass()

    return ask(f"{fluid} R", question)


def ideal_heat_capacity(fluid: str, T: float) -> float:
    """Return cp0 [J/(kg K)], the ideal-gas heat capacity at temperature T [K]."""
    mixed = blend_of(fluid)
    if mixed is not None:
        return mixed.ideal_heat_capacity(T)

    def question() -> float:
        state, coolprop = coolprop_state(fluid)
        state.specify_phase(coolprop.iphase_gas)
        try:
            state.update(coolprop.DmassT_INPUTS, 1e-6, T)
            return state.cp0mass()
        finally:
            state.unspecify_phase()

    return ask(f"{fluid} cp0 {T!r}", question)


def isentropic_exponent(fluid: str, T: float) -> float:
    """Return k = cp0/(cp0 − R) at temperature T [K] (docs/model.md M6)."""
    c_p, R = ideal_heat_capacity(fluid, T), gas_constant(fluid)
    return c_p / (c_p - R)


def has_ideal_heat_capacity(fluid: str, T: float) -> bool:
    """Tell whether CoolProp has a heat capacity of the ideal gas at temperature T [K] that a gas can have.

    Far below the triple point some of its fits end, and others fall below 5/2 R or below zero.
    """
    try:
        return ideal_heat_capacity(fluid, T) >= LEAST_HEAT_CAPACITY * (1.0 - ROUNDING) * gas_constant(fluid)
    except ValueError:
        return False


def saturation_temperature(fluid: str, p: float) -> float:
    """Return the saturation temperature [K] of vapour (the dew point) at pressure p [Pa]."""
    mixed = blend_of(fluid)
    return _saturated(fluid, "T", "PQ_INPUTS", p, 1.0) if mixed is None else mixed.dew_temperature(p)


def boiling_temperature(fluid: str, p: float) -> float:
    """Return the saturation temperature [K] of liquid (the bubble point) at pressure p [Pa]."""
    mixed = blend_of(fluid)
    return _saturated(fluid, "T", "PQ_INPUTS", p, 0.0) if mixed is None else mixed.bubble_temperature(p)


def glide(fluid: str, p: float) -> float:
    """Return the dew point less the bubble point [K] at pressure p [Pa]."""
    return saturation_temperature(fluid, p) - boiling_temperature(fluid, p)


def parts_on_boiling(fluid: str) -> bool:
    """Tell whether vapour that boils off has another composition than the liquid: of a blend, pseudo-pure or not."""
    if is_blend(fluid):
        return True
    try:
        return describe(fluid).pseudo_pure and glide(fluid, BOILED_AT) > PARTS_FROM
    except UsageError:  # an unknown fluid, of which the checks of the scene tell
        return False


def liquid_below(fluid: str, p: float, T: float) -> float | None:
    """Return the temperature [K] below which a fluid at p [Pa] is liquid; None where it is a gas at T [K].

    Above the critical pressure that is the critical temperature, although there is no phase border there.
    """
    known = limits(fluid)
    if known is None or T >= known.T_critical or p < known.p_triple:
        return None
    boiling = known.T_critical if p >= known.p_critical else saturation_temperature(fluid, p)
    return boiling if T < boiling * (1.0 - 1e-12) else None


def dew_pressure(fluid: str, T: float) -> float:
    """Return the pressure [Pa] of saturated vapour at temperature T [K] (M42)."""
    mixed = blend_of(fluid)
    return _saturated(fluid, "p", "QT_INPUTS", 1.0, T) if mixed is None else mixed.dew_pressure(T)


def bubble_pressure(fluid: str, T: float) -> float:
    """Return the pressure [Pa] of saturated liquid at temperature T [K] (M42)."""
    mixed = blend_of(fluid)
    return _saturated(fluid, "p", "QT_INPUTS", 0.0, T) if mixed is None else mixed.bubble_pressure(T)


def condensing_pressure(fluid: str, T: float) -> float:
    """Return the pressure [Pa] in a condenser at T [K]: of the bubble point, for a blend of the dew point (M42, M316).

    Dew point is the convention of EN 12900 and AHRI 540 for fluids with glide.
    """
    return dew_pressure(fluid, T) if blend_of(fluid) is not None else bubble_pressure(fluid, T)


def condensed(fluid: str, T: float) -> float:
    """Return the temperature [K] of saturated liquid behind a condenser at T [K]: lower for a blend (M43, M316)."""
    mixed = blend_of(fluid)
    return T if mixed is None else mixed.bubble_temperature(mixed.dew_pressure(T))


def saturated_liquid_enthalpy(fluid: str, T: float) -> float:
    """Return the enthalpy [J/kg] of saturated liquid at temperature T [K], on CoolProp's default reference."""
    mixed = blend_of(fluid)
    return _saturated(fluid, "hmass", "QT_INPUTS", 0.0, T) if mixed is None else mixed.saturated_liquid(T)[0]


def saturated_liquid_density(fluid: str, T: float) -> float:
    """Return the density [kg/m³] of saturated liquid at temperature T [K]."""
    mixed = blend_of(fluid)
    return _saturated(fluid, "rhomass", "QT_INPUTS", 0.0, T) if mixed is None else mixed.saturated_liquid(T)[1]


def wet_enthalpy(fluid: str, p: float, quality: float) -> float:
    """Return the enthalpy [J/kg] of liquid and vapour in equilibrium at p [Pa]; `quality`: mass share of vapour."""
    if blend_of(fluid) is not None:
        T, rho = _wet(fluid, p, quality)
        return blend_wet(fluid).value(T, 1.0 / rho, False)
    return _saturated(fluid, "hmass", "PQ_INPUTS", p, quality)


def wet_temperature(fluid: str, p: float, quality: float) -> float:
    """Return the temperature [K] of liquid and vapour in equilibrium at p [Pa]; `quality`: mass share of vapour."""
    return saturation_temperature(fluid, p) if blend_of(fluid) is None else _wet(fluid, p, quality)[0]


def _wet(fluid: str, p: float, quality: float) -> tuple[float, float]:
    """Return (T [K], ρ [kg/m³]) of a blend in two phases at p [Pa] and a quality."""
    T, rho = ask(f"{table_name(fluid)} wet {p!r} {quality!r}", lambda: blend_wet(fluid).of_quality(p, quality))
    return T, rho


def _saturated(fluid: str, wanted: str, name: str, first: float, second: float) -> float:
    by_pressure = name == "PQ_INPUTS"

    def refused(p_critical: float) -> UsageError:
        at = in_bar(first) if by_pressure else in_celsius(second)
        return UsageError(f"gas.fluid: {fluid} has no saturation at {at} (critical: {in_bar(p_critical)})")

    def question() -> float:
        state, coolprop = coolprop_state(fluid)
        try:
            state.update(getattr(coolprop, name), first, second)
            return getattr(state, wanted)()
        except ValueError:
            raise refused(state.p_critical()) from None

    known = limits(fluid) if by_pressure else None
    if known is not None and first > known.p_critical:
        raise refused(known.p_critical)  # without CoolProp, which takes seconds to import
    return ask(f"{fluid} {wanted} {name} {first!r} {second!r}", question)


def vapour_enthalpy(fluid: str, p: float, T: float) -> float:
    """Return the real vapour's enthalpy [J/kg] at p [Pa] and T [K], on CoolProp's default reference."""
    mixed = blend_of(fluid)
    return _single_phase(fluid, p, T, "iphase_gas") if mixed is None else mixed.vapour_enthalpy(p, T)


def liquid_enthalpy(fluid: str, p: float, T: float) -> float:
    """Return the liquid's enthalpy [J/kg] at p [Pa] and T [K], on CoolProp's default reference."""
    mixed = blend_of(fluid)
    return _single_phase(fluid, p, T, "iphase_liquid") if mixed is None else mixed.liquid_enthalpy(p, T)


def enthalpy(fluid: str, p: float, T: float) -> float:
    """Return the enthalpy [J/kg] at p [Pa] and T [K] of whichever single phase the fluid has there (M330).

    Raises UsageError between bubble and dew point of a fluid with glide.
    """
    known = limits(fluid)
    assert known is not None
    dense = p >= known.p_critical and blend_of(fluid) is None
    if T >= known.T_critical:
        return _single_phase(fluid, p, T, "iphase_supercritical") if dense else vapour_enthalpy(fluid, p, T)
    if p >= bubble_pressure(fluid, T):
        return _single_phase(fluid, p, T, "iphase_supercritical_liquid") if dense else liquid_enthalpy(fluid, p, T)
    if p > dew_pressure(fluid, T):
        what = f"{fluid} at {in_bar(p)}, {in_celsius(T)} is wet: it lies between bubble and dew point"
        raise UsageError(f"gas.fluid: {what}")
    return vapour_enthalpy(fluid, p, T)


class Compressed(NamedTuple):
    """A compressed gas: the work taken [J/kg], and its enthalpy above the dew point [J/kg]."""

    work: float
    over_dew: float


def compressed(fluid: str, p: float, T: float, p_end: float, efficiency: float) -> Compressed | None:
    """Return the real gas compressed from p [Pa], T [K] to `p_end` [Pa] with an isentropic efficiency.

    None for a blend, above the critical pressure, and where CoolProp has no such state.
    """
    if blend_of(fluid) is not None:
        return None

    def question() -> list[float]:
        state, coolprop = coolprop_state(fluid)
        try:
            state.update(coolprop.PQ_INPUTS, p_end, 1.0)
            dew = state.hmass()
            state.specify_phase(coolprop.iphase_gas)
            state.update(coolprop.PT_INPUTS, p, T)
            h, s = state.hmass(), state.smass()
            state.unspecify_phase()
            state.update(coolprop.PSmass_INPUTS, p_end, s)
            work = (state.hmass() - h) / efficiency
            return [work, h + work - dew]
        except ValueError:
            return []
        finally:
            state.unspecify_phase()

    found = ask(f"{fluid} compressed {p!r} {T!r} {p_end!r} {efficiency!r}", question)
    return Compressed(*found) if found else None


def _single_phase(fluid: str, p: float, T: float, phase: str) -> float:
    def question() -> float:
        state, coolprop = coolprop_state(fluid)
        state.specify_phase(getattr(coolprop, phase))  # on the saturation line p and T do not determine it
        try:
            state.update(coolprop.PT_INPUTS, p, T)
            return state.hmass()
        except ValueError:
            word = phase.removeprefix("iphase_")
            raise UsageError(f"gas.fluid: CoolProp has no {word} of {fluid} at {in_bar(p)}, {in_celsius(T)}") from None
        finally:
            state.unspecify_phase()

    return ask(f"{fluid} hmass {phase} {p!r} {T!r}", question)
