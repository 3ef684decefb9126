"""What a simulation gives: the names, units and meanings of all results, and the record that carries them.

One table serves the JSON of `run`, the HDF5 file and the labels of figures. SI units; a figure of an effect that is
not simulated is None (null in JSON, NaN with its fill value in HDF5).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np


class Variable(NamedTuple):
    """Unit (SI, CF style) and meaning of one result."""

    units: str
    long_name: str


STATUSES = ("ok", "not_closed", "failed")  # HDF5 stores the index

PERFORMANCE = {
    "isothermal_efficiency": Variable("1", "isothermal efficiency of the shaft power"),
    "ideal_isothermal_efficiency": Variable("1", "ideal-gas isothermal power at suction temperature over shaft power"),
    "isentropic_efficiency": Variable("1", "isentropic efficiency of the shaft power"),
    "volumetric_efficiency": Variable("1", "volumetric efficiency"),
    "gas_mass_flow": Variable("kg s-1", "net gas mass flow from the suction line"),
    "oil_mass_flow": Variable("kg s-1", "injected oil mass flow"),
    "oil_ratio": Variable(
        "1",
        "oil to gas mass ratio in the chamber at 360 degrees (rotors: where suction closes; oil_injection: its end)",
    ),
    "oil_flow_ratio": Variable("1", "injected oil over net suction gas"),
    "indicated_power": Variable("W", "indicated power"),
    "oil_lift_power": Variable("W", "power that lifts the oil to discharge pressure"),
    "oil_pump_power": Variable("W", "shaft power of the oil pump"),
    "hydromechanical_power": Variable("W", "hydromechanical loss"),
    "mechanical_power": Variable("W", "mechanical loss"),
    "oil_drag_power": Variable("W", "drag of oil in tip and end gaps"),
    "bearing_power": Variable("W", "friction of the bearings"),
    "shaft_power": Variable("W", "shaft power"),
    "shaft_torque": Variable("N m", "mean torque at the shaft: shaft power over speed"),
    "discharge_temperature": Variable("K", "flow-weighted mean gas temperature at discharge"),
    "oil_discharge_temperature": Variable("K", "flow-weighted mean oil temperature at discharge"),
    "peak_pressure": Variable("Pa", "highest chamber pressure up to the widest opening of the discharge port"),
    "work_per_cycle": Variable("J", "work on the gas of one chamber per cycle, minus the integral of p dV"),
    "trapped_mass": Variable("kg", "gas mass in a chamber at 360 degrees (rotors: where suction closes)"),
    "injection_pressure": Variable(
        "Pa",
        "chamber pressure where oil is injected: at 360 degrees (rotors: where suction closes; oil_injection: mean)",
    ),
    "suction_pressure": Variable("Pa", "pressure of the suction line"),
    "suction_temperature": Variable("K", "temperature of the suction line"),
    "discharge_pressure": Variable("Pa", "pressure of the discharge line"),
    "pressure_ratio": Variable("1", "pressure of the discharge line over that of the suction line (expander: inverse)"),
    "displacement": Variable("m3", "swept volume of all chambers in a revolution of the male rotor or the crank"),
    "displacement_flow": Variable("m3 s-1", "displacement times speed"),
    "built_in_volume_ratio": Variable(
        "1", "chamber volume where suction closes over that where the discharge port opens (profiles: as stated)"
    ),
    "specific_power": Variable("W s m-3", "shaft power over the volume flow of suction gas"),
    "cooling_capacity": Variable("W", "cooling capacity: net gas flow times the real fluid's refrigerating effect"),
    "cop": Variable("1", "coefficient of performance: cooling capacity over shaft power"),
    "volumetric_cooling_capacity": Variable("J m-3", "cooling capacity over the volume flow of suction gas"),
    "intake_pressure": Variable("Pa", "pressure of the gas that the machine sucks, behind throttle and bypass"),
    "intake_temperature": Variable("K", "temperature of the gas that the machine sucks, behind throttle and bypass"),
    "droplet_diameter": Variable("m", "Sauter diameter of the droplets of oil"),
    "output_power": Variable("W", "power that an expander gives at its shaft"),
    "filling_factor": Variable(
        "1", "net gas flow of an expander over that which fills its chambers at the inlet's closing"
    ),
    "motor_loss": Variable("W", "loss of motor and inverter"),
    "electrical_power": Variable("W", "electrical power"),
    "motor_efficiency": Variable("1", "efficiency of motor and inverter"),
    "electrical_isothermal_efficiency": Variable("1", "isothermal efficiency of the electrical power"),
    "electrical_isentropic_efficiency": Variable("1", "isentropic efficiency of the electrical power"),
    "electrical_cop": Variable("1", "coefficient of performance: cooling capacity over electrical power"),
    "gas_torque_mean": Variable("N m", "mean torque of the gas on the male rotor's shaft, the female's included"),
    "gas_torque_peak_to_peak": Variable("N m", "torque of the gas, from its lowest to its highest value"),
    "gas_torque_harmonic_1": Variable("N m", "amplitude of the gas torque at the lobe frequency"),
    "gas_torque_harmonic_2": Variable("N m", "amplitude of the gas torque at twice the lobe frequency"),
    "gas_torque_harmonic_3": Variable("N m", "amplitude of the gas torque at three times the lobe frequency"),
    "gas_torque_harmonic_4": Variable("N m", "amplitude of the gas torque at four times the lobe frequency"),
    "male_gas_torque": Variable("N m", "mean torque of the gas on the male rotor itself"),
    "female_gas_torque": Variable("N m", "mean torque of the gas on the female rotor itself, about its own axis"),
    "axial_gas_force": Variable("N", "mean axial force of the gas on a rotor, by the stated area"),
    "axial_gas_force_peak": Variable("N", "largest axial force of the gas on a rotor"),
    "radial_gas_force": Variable("N", "mean radial force of the gas on a rotor, by the stated area"),
    "radial_gas_force_peak": Variable("N", "largest radial force of the gas on a rotor"),
    "mean_speed": Variable("rad s-1", "mean over time of the rotors' speed"),
    "no_load_speed": Variable("rad s-1", "speed at which the motor's torque vanishes"),
    "speed_ripple": Variable("1", "largest less smallest speed of the rotors over the mean"),
    "motor_speed_ripple": Variable("1", "largest less smallest speed of the motor over the mean"),
    "coupling_torque_mean": Variable("N m", "mean torque of the coupling over the rotors' angle"),
    "coupling_torque_amplitude": Variable("N m", "half of the coupling torque's way from its lowest to its highest"),
    "coupling_torque_peak": Variable("N m", "largest magnitude of the coupling torque"),
    "twist_mean": Variable("rad", "mean twist of the coupling over the rotors' angle"),
    "twist_amplitude": Variable("rad", "half of the twist's way from its lowest to its highest value"),
    "torsional_frequency": Variable("Hz", "first torsional frequency of small motions about the mean twist, undamped"),
    "resonance_speed": Variable("rad s-1", "speed at which the lobe frequency is the torsional frequency"),
    "motor_power": Variable("W", "mean power that the motor gives to the coupling"),
    "coupling_loss": Variable("W", "mean power that the damping of the coupling takes"),
    "suction_valve_power": Variable("W", "power that cylinder pressure below the suction line costs"),
    "discharge_valve_power": Variable("W", "power that cylinder pressure above the discharge line costs"),
    "wall_heat": Variable("W", "net heat from walls into the gas"),
    "economizer_mass_flow": Variable("kg s-1", "net mass flow from the economizer"),
    "economizer_flow_ratio": Variable("1", "economizer flow over net suction flow"),
    "economizer_draw_ratio": Variable("1", "vapour that the economizer's port draws over that which the liquid makes"),
    "economizer_capacity_gain": Variable("1", "cooling capacity that the economizer adds, at the same suction flow"),
    "dissolved_gas_ratio": Variable("1", "refrigerant dissolved in the injected oil, per oil"),
    "discharge_dissolved_gas_ratio": Variable("1", "refrigerant dissolved in oil that leaves to discharge, per oil"),
    "flash_mass_flow": Variable("kg s-1", "refrigerant that flashes out of the injected oil, less what it takes up"),
    "flash_flow_ratio": Variable("1", "refrigerant that flashes out of the oil, over net suction flow"),
    "liquid_injection_mass_flow": Variable("kg s-1", "net flow of injected liquid"),
    "liquid_injection_flow_ratio": Variable("1", "injected liquid over net suction flow"),
    "suction_plenum_pressure": Variable("Pa", "mean pressure in the suction plenum"),
    "suction_pulsation_peak_to_peak": Variable(
        "Pa", "pressure in the suction plenum, from its lowest to its highest value"
    ),
    "suction_pulsation_harmonic_1": Variable(
        "Pa", "amplitude of the pressure in the suction plenum at the lobe frequency"
    ),
    "suction_pulsation_harmonic_2": Variable(
        "Pa", "amplitude of the pressure in the suction plenum at twice the lobe frequency"
    ),
    "suction_pulsation_harmonic_3": Variable(
        "Pa", "amplitude of the pressure in the suction plenum at three times the lobe frequency"
    ),
    "suction_pulsation_harmonic_4": Variable(
        "Pa", "amplitude of the pressure in the suction plenum at four times the lobe frequency"
    ),
    "discharge_plenum_pressure": Variable("Pa", "mean pressure in the discharge plenum"),
    "discharge_pulsation_peak_to_peak": Variable(
        "Pa", "pressure in the discharge plenum, from its lowest to its highest value"
    ),
    "discharge_pulsation_harmonic_1": Variable(
        "Pa", "amplitude of the pressure in the discharge plenum at the lobe frequency"
    ),
    "discharge_pulsation_harmonic_2": Variable(
        "Pa", "amplitude of the pressure in the discharge plenum at twice the lobe frequency"
    ),
    "discharge_pulsation_harmonic_3": Variable(
        "Pa", "amplitude of the pressure in the discharge plenum at three times the lobe frequency"
    ),
    "discharge_pulsation_harmonic_4": Variable(
        "Pa", "amplitude of the pressure in the discharge plenum at four times the lobe frequency"
    ),
    "discharge_line_least_flow": Variable("kg s-1", "least mass flow from the discharge plenum into its line"),
    "rotor_temperature": Variable("K", "temperature of the rotors"),
    "housing_temperature": Variable("K", "temperature of the housing"),
    "wall_heat_power": Variable("W", "net heat from walls to gas: what cools the walls outside, negative"),
    "tip_gap": Variable("m", "clearance between tips and housing, warm"),
    "interlobe_gap": Variable("m", "clearance between the rotors, warm"),
    "end_face_gap": Variable("m", "clearance of the discharge end faces, warm"),
}

STAGES = {  # of two stages in a row
    "intermediate_pressure": Variable("Pa", "pressure between both stages, of the first one's discharge line"),
    "second_suction_temperature": Variable("K", "temperature of what the second stage sucks"),
    "intercooler_heat": Variable("W", "heat taken from the gas between both stages"),
    "vapour_mass_flow": Variable("kg s-1", "vapour of the flash tank that mixes in between both stages"),
    "gas_mass_flow": Variable("kg s-1", "net mass flow that the first stage sucks"),
    "first_shaft_power": Variable("W", "shaft power of the first stage"),
    "second_shaft_power": Variable("W", "shaft power of the second stage"),
    "shaft_power": Variable("W", "shaft power of both stages"),
    "first_pressure_ratio": Variable("1", "pressure ratio of the first stage"),
    "second_pressure_ratio": Variable("1", "pressure ratio of the second stage"),
    "discharge_temperature": Variable("K", "flow-weighted mean gas temperature at discharge of the second stage"),
    "isothermal_efficiency": Variable("1", "isothermal efficiency of the whole"),
    "ideal_isothermal_efficiency": Variable("1", "isothermal efficiency of the whole, with an ideal gas's work"),
    "isentropic_efficiency": Variable("1", "isentropic efficiency of the whole, without cooling between the stages"),
    "cooling_capacity": Variable("W", "cooling capacity of the whole"),
    "cop": Variable("1", "coefficient of performance of the whole"),
    "flow_mismatch": Variable("1", "what comes to the second stage against what it takes, relative difference"),
}

BALANCE = {
    "mass": Variable("1", "relative residue of the gas mass balance"),
    "energy": Variable("1", "relative residue of the energy balance"),
    "entropy": Variable("1", "relative residue of the entropy balance: of the ledger, over shaft power and losses"),
    "oil_mass": Variable("1", "relative residue of the oil mass balance (oil.transport: carried)"),
    "oil_residue": Variable(
        "W", "heat taken up by the oil beyond what injected oil carries to discharge (oil.transport: paper)"
    ),
    "drive": Variable("1", "relative residue of the drive's powers: motor, coupling, shaft"),
    "bound": Variable("1", "bound on the residues of mass, energy and entropy"),
}

NUMERICS = {
    "rtol": Variable("1", "relative tolerance of a step"),
    "turns": Variable("1", "chamber lives integrated until closed (coupled chambers: pitches over chambers alive)"),
    "steps": Variable("1", "accepted integration steps"),
    "rhs_evaluations": Variable("1", "evaluations of the right-hand side of one chamber, those for Jacobians included"),
    "jacobians": Variable("1", "Jacobians of one chamber"),
    "wall_time": Variable("s", "time of the solution alone, compiled and warm"),
    "estimating_time": Variable("s", "time of estimating the errors, on top of the solution"),
}
NUMERICS_TEXT = {"integrator": "integrator", "closing": "way in which the cycle was closed"}

CYCLE = {
    "angle": Variable("degree", "angle of the male rotor, or of the crank"),
    "volume": Variable("m3", "chamber volume"),
    "pressure": Variable("Pa", "chamber pressure"),
    "gas_temperature": Variable("K", "gas temperature"),
    "oil_temperature": Variable("K", "oil temperature"),
    "gas_mass": Variable("kg", "gas mass in the chamber"),
    "oil_mass": Variable("kg", "oil mass in the chamber"),
    "dissolved_gas_ratio": Variable("1", "refrigerant dissolved in the chamber's oil, per oil"),
    "work": Variable("J", "work on the gas since 0 degrees"),
    "suction_valve_lift": Variable("1", "lift of the suction valve over that of its stop"),
    "suction_valve_speed": Variable("1", "speed of the suction valve over its scale"),
    "discharge_valve_lift": Variable("1", "lift of the discharge valve over that of its stop"),
    "discharge_valve_speed": Variable("1", "speed of the discharge valve over its scale"),
    "suction_plenum_pressure": Variable("Pa", "pressure in the suction plenum, by the youngest chamber's angle"),
    "discharge_plenum_pressure": Variable("Pa", "pressure in the discharge plenum, by the youngest chamber's angle"),
    "gas_torque": Variable("N m", "torque of the gas in all chambers on the male rotor's shaft"),
    "male_gas_torque": Variable("N m", "torque of the gas in all chambers on the male rotor itself"),
    "female_gas_torque": Variable("N m", "torque of the gas on the female rotor itself, about its own axis"),
    "speed": Variable("rad s-1", "speed of the male rotor"),
    "motor_speed": Variable("rad s-1", "speed of the motor"),
    "twist": Variable("rad", "twist of the coupling, the motor ahead"),
    "coupling_torque": Variable("N m", "torque of the coupling"),
    "motor_torque": Variable("N m", "torque of the motor"),
    "axial_gas_force": Variable("N", "axial force of the gas in all chambers on a rotor"),
    "radial_gas_force": Variable("N", "radial force of the gas in all chambers on a rotor"),
}


LEDGER = {
    "ambient_temperature": Variable("K", "ambient temperature of the ledger"),
    "shaft_power": Variable("W", "shaft power"),
    "gas_exergy_rise": Variable("W", "exergy rise of the delivered gas from suction to discharge state"),
    "oil_exergy_rise": Variable("W", "exergy rise of the oil from its supply to discharge"),
    "exergy_destroyed": Variable("W", "exergy destroyed by all effects together"),
    "residue": Variable("W", "shaft power less exergy rises and exergy destroyed: numerical"),
    "relative_residue": Variable("1", "residue of the ledger over shaft power"),
}
LEDGER_ENTRY = {  # of each effect, `<name>_<effect>`
    "gas_moved": Variable("kg s-1", "gas moved"),
    "energy_moved": Variable("W", "energy moved"),
    "entropy_generated": Variable("W K-1", "entropy generated"),
    "exergy_destroyed": Variable("W", "exergy destroyed"),
}

KNOCK_OUT_STATUSES = (*STATUSES, "needed")  # the scene cannot do without the effect
KNOCK_OUT = {  # of each effect that is left out, with what that changes
    name: Variable(units, f"{meaning} without the effect")
    for name, units, meaning in (
        ("shaft_power", "W", "shaft power"),
        ("specific_work", "J kg-1", "shaft power over net gas flow"),
        ("cooling_capacity", "W", "cooling capacity"),
        ("cop", "1", "coefficient of performance"),
    )
}
KNOCK_OUT |= {
    f"change_of_{name}": each._replace(long_name=f"{each.long_name}, less that with it")
    for name, each in KNOCK_OUT.items()
}


def ledger_variable(name: str) -> Variable:
    """Return unit and meaning of a ledger's total, or of an entry `<quantity>_<effect>`."""
    if name in LEDGER:
        return LEDGER[name]
    quantity = next(quantity for quantity in LEDGER_ENTRY if name.startswith(f"{quantity}_"))
    units, meaning = LEDGER_ENTRY[quantity]
    return Variable(units, f"{meaning}, {name.removeprefix(f'{quantity}_').replace('_', ' ')}")


def ledger_entries(ledger: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return {effect: {quantity: value}} of a ledger, in its order."""
    entries: dict[str, dict[str, Any]] = {}
    for name, value in ledger.items():
        for quantity in LEDGER_ENTRY:
            if name not in LEDGER and name.startswith(f"{quantity}_"):
                entries.setdefault(name.removeprefix(f"{quantity}_"), {})[quantity] = value
    return entries


def sorted_entries(ledger: Mapping[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Return the entries of a ledger by the exergy that they destroy, the dearest first."""
    return sorted(ledger_entries(ledger).items(), key=lambda entry: -float(entry[1]["exergy_destroyed"]))


def cycle_variable(name: str) -> Variable:
    """Return unit and meaning of a cycle trace, of flow paths too (`mass_flow_<effect>[_leading]`, `oil_flow_…`)."""
    if name.startswith("mass_flow_"):
        return Variable("kg s-1", f"mass flow into the chamber, {name.removeprefix('mass_flow_').replace('_', ' ')}")
    if name.startswith("oil_flow_"):
        gap = name.removeprefix("oil_flow_").replace("_", " ")
        return Variable("kg s-1", f"oil that flows into the chamber without gas, {gap}")
    return CYCLE.get(name) or Variable("1", name.replace("_", " "))


class Figures(dict[str, Any]):
    """A mapping whose names are attributes too: `result.performance.isothermal_efficiency`."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"no figure {name!r}; known: {', '.join(self)}") from None


@dataclass(frozen=True)
class Result:
    """One simulated operating point; every mapping has the names of the tables above.

    `cycle` holds arrays of one length over `angle` [degree]; empty when the run failed before a whole life.
    `notes` say why a figure is None although its effect is simulated. `failure_angle` is in degrees.
    """

    status: str
    message: str = ""
    warnings: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    performance: Figures = field(default_factory=Figures)
    balance: Figures = field(default_factory=Figures)
    error: Figures = field(default_factory=Figures)
    numerics: Figures = field(default_factory=Figures)
    notes: Mapping[str, str] = field(default_factory=dict)
    cycle: Mapping[str, np.ndarray] = field(default_factory=dict)
    ledger: Figures = field(default_factory=Figures)  # empty without the cycle
    knock_out: tuple[Figures, ...] = ()  # what leaving each effect out changes, where it was asked for

    def as_json(self) -> dict[str, Any]:
        """Return what `run --json` prints (the cycle stays in the HDF5 file)."""
        asked = {"knock_out": [dict(cost) for cost in self.knock_out]} if self.knock_out else {}
        return {
            "status": self.status,
            "message": self.message,
            "warnings": list(self.warnings),
            "effects": list(self.effects),
            "states": list(self.states),
            "performance": dict(self.performance),
            "balance": dict(self.balance),
            "error": dict(self.error),
            "ledger": dict(self.ledger),
            "numerics": dict(self.numerics),
            "notes": dict(self.notes),
            **asked,
        }
