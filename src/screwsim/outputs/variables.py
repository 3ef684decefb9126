"""Units and meanings of a result's other numbers: balances, numerics, curves, ledger, knock-outs."""

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from screwsim.outputs.declared import Variable

STATUSES = OK, NOT_CLOSED, FAILED = "ok", "not_closed", "failed"  # stored in HDF5 by index

BALANCE = {
    "mass": Variable("1", "relative residual of the gas mass balance"),
    "energy": Variable("1", "relative residual of the energy balance"),
    "entropy": Variable(
        "1", "relative residual of the entropy balance: that of the ledger, over shaft power and losses"
    ),
    "oil_mass": Variable("1", "relative residual of the oil mass balance (oil.transport: carried)"),
    "oil_residue": Variable(
        "W", "heat taken up by the oil, beyond what the injected oil carries to discharge (oil.transport: paper)"
    ),
    "drive": Variable("1", "relative residual of the power balance of the drive: motor, coupling, shaft"),
    "bound": Variable("1", "bound for the residuals of mass, energy and entropy"),
}

NUMERICS = {
    "rtol": Variable("1", "relative tolerance of a step"),
    "turns": Variable(
        "1", "chamber lives integrated until the cycle closed (coupled chambers: pitches over number of chambers)"
    ),
    "steps": Variable("1", "accepted integration steps"),
    "rhs_evaluations": Variable(
        "1",
        "evaluations of the right-hand side of one chamber until the cycle closed, including those for Jacobians, "
        "without those for the error estimate",
    ),
    "jacobians": Variable("1", "Jacobian evaluations of one chamber"),
    "wall_time": Variable("s", "time of the solution alone, with compiled code loaded"),
    "estimating_time": Variable("s", "time to estimate the errors, in addition"),
}
NUMERICS_TEXT = {"integrator": "integrator", "closing": "method by which the cycle was closed"}

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
}


LEDGER = {
    "ambient_temperature": Variable("K", "ambient temperature of the ledger"),
    "shaft_power": Variable("W", "shaft power"),
    "gas_exergy_rise": Variable("W", "exergy rise of the delivered gas from suction to discharge state"),
    "oil_exergy_rise": Variable("W", "exergy rise of the oil from its supply to discharge"),
    "exergy_destroyed": Variable("W", "exergy destroyed by all effects together"),
    "residue": Variable("W", "shaft power less exergy rises and exergy destroyed: the numerical residue"),
    "relative_residue": Variable("1", "residue of the ledger over shaft power"),
}
LEDGER_SUMMARY = ("shaft_power", "gas_exergy_rise", "oil_exergy_rise", "residue", "ambient_temperature")  # of a page
LEDGER_ENTRY = {  # quantities of each effect, named `<quantity>_<effect>`
    "gas_moved": Variable("kg s-1", "gas moved"),
    "energy_moved": Variable("W", "energy moved"),
    "entropy_generated": Variable("W K-1", "entropy generated"),
    "exergy_destroyed": Variable("W", "exergy destroyed"),
}

KNOCK_OUT_STATUSES = (*STATUSES, "needed")  # needed: the scene cannot be simulated without the effect
KNOCK_OUT = {  # figures without an effect; their changes are added below
    name: Variable(units, f"{meaning} without the effect")
    for name, units, meaning in (
        ("shaft_power", "W", "shaft power"),
        ("specific_work", "J kg-1", "shaft power over net gas flow"),
        ("cooling_capacity", "W", "cooling capacity"),
        ("cop", "1", "coefficient of performance"),
    )
}
KNOCK_OUT |= {
    f"change_of_{name}": each._replace(long_name=f"{each.long_name}, minus that with it")
    for name, each in KNOCK_OUT.items()
}


def effect_words(name: str) -> str:
    """Return the name of an effect, or of another entry, as people write it; of one's own without its package.

    Effects that a name joins by `+` stay joined.
    """
    return "+".join(each.rpartition(".")[2] for each in name.split("+")).replace("_", " ")


def words_of_effects(names: Iterable[str]) -> dict[str, str]:
    """Return the words of each effect or entry; those with the same words alike have their whole names instead."""
    words = {name: effect_words(name) for name in names}
    count = Counter(words.values())
    return {name: name if count[told] > 1 else told for name, told in words.items()}


def ledger_variable(name: str) -> Variable:
    """Return unit and meaning of a total of the ledger, or of an entry `<quantity>_<effect>`."""
    if name in LEDGER:
        return LEDGER[name]
    quantity = next(quantity for quantity in LEDGER_ENTRY if name.startswith(f"{quantity}_"))
    units, meaning = LEDGER_ENTRY[quantity]
    return Variable(units, f"{meaning}, {effect_words(name.removeprefix(f'{quantity}_'))}")


def ledger_entries(ledger: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return {effect: {quantity: value}} of a ledger, in its order."""
    entries: dict[str, dict[str, Any]] = {}
    for name, value in ledger.items():
        for quantity in LEDGER_ENTRY:
            if name not in LEDGER and name.startswith(f"{quantity}_"):
                entries.setdefault(name.removeprefix(f"{quantity}_"), {})[quantity] = value
    return entries


def sorted_entries(ledger: Mapping[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Return the entries of a ledger, sorted by exergy destroyed, the largest first."""
    return sorted(ledger_entries(ledger).items(), key=lambda entry: -float(entry[1]["exergy_destroyed"]))


def cycle_variable(name: str) -> Variable:
    """Return unit and meaning of a curve of the cycle, also of flows (`mass_flow_<effect>[_leading]`, `oil_flow_…`)."""
    if name.startswith("mass_flow_"):
        return Variable("kg s-1", f"mass flow into the chamber, {name.removeprefix('mass_flow_').replace('_', ' ')}")
    if name.startswith("oil_flow_"):
        gap = name.removeprefix("oil_flow_").replace("_", " ")
        return Variable("kg s-1", f"oil that flows into the chamber without gas, {gap}")
    if name.startswith("heat_"):
        return Variable("W", f"heat from the oil to the gas, {name.removeprefix('heat_').replace('_', ' ')}")
    return CYCLE.get(name) or Variable("1", name.replace("_", " "))
