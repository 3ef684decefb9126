"""The rating of an air package: ISO 1217's isentropic power, and the least efficiency of 10 CFR 431.345.

Source: ISO 1217:2009 with amendment 1:2016 (isentropic power of air, exponent 1.4); 10 CFR 431.345, table 1,
from public copies. Loads of variable speed and their weights are those of appendix A to subpart T of part 431 as we
know it: its text was not at hand.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import log

from screwsim.outputs.us_units import CFM, HORSEPOWER, PSI

K = 1.4  # isentropic exponent of air, as ISO 1217 has it
WEIGHTS = {0.4: 0.25, 0.7: 0.5, 1.0: 0.25}  # weight of each load (share of full flow) in the variable-speed rating
GAUGE = 75.0 * PSI, 200.0 * PSI  # [Pa] range of gauge pressures that the regulation covers
FLOW = 35.0 * CFM, 1250.0 * CFM  # [m³/s] range of flows at full load that it covers, beyond which ...
MOTOR = 10.0 * HORSEPOWER, 200.0 * HORSEPOWER  # [W] ... a rated power from, or up to, these brings a package under it


def isentropic_power(flow: float, suction: float, discharge: float) -> float:
    """Return the power [W] of isentropic compression of a flow at suction [m³/s] between pressures [Pa] (M347)."""
    return K / (K - 1.0) * suction * flow * ((discharge / suction) ** ((K - 1.0) / K) - 1.0)


@dataclass(frozen=True)
class Standard:
    """The least package isentropic efficiency of a class of packages, as a curve over ln(flow in L/s) (M349)."""

    square: float
    linear: float
    constant: float
    d: float
    more: float = 0.0

    def reference(self, flow: float) -> float:
        """Return the reference curve, from which losses count (d = 0), at a flow at full load [m³/s]."""
        L = log(1000.0 * flow)
        return self.square * L**2 + self.linear * L + self.constant

    def least(self, flow: float) -> float:
        """Return the least efficiency of a package with a flow at full load [m³/s]."""
        reference = self.reference(flow)
        return self.more + reference + (1.0 - reference) * self.d / 100.0


FIXED = -0.00928, 0.13911, 0.27110
VARIABLE = -0.01549, 0.21573, 0.00905
LIQUID = 0.02349
STANDARDS = {  # by speed and coolant
    ("fixed", "air"): Standard(*FIXED, -15.0),
    ("variable", "air"): Standard(*VARIABLE, -10.0),
    ("fixed", "liquid"): Standard(*FIXED, -15.0, LIQUID),
    ("variable", "liquid"): Standard(*VARIABLE, -15.0, LIQUID),
}


def part_load_efficiency(efficiencies: Mapping[float, float]) -> float:
    """Return the efficiency by which a variable-speed package is judged, from {load: efficiency} (M349)."""
    return sum(weight * efficiencies[load] for load, weight in WEIGHTS.items())


def outside_scope(flow: float, gauge: float, rated: float) -> str:
    """Return why the regulation does not cover a package; empty where it does (10 CFR 431.344).

    It has a full-load flow [m³/s], a gauge pressure [Pa] and a motor's rated power [W].
    """
    if not GAUGE[0] <= gauge <= GAUGE[1]:
        return f"{gauge / PSI:.0f} psi above the inlet pressure is outside 75 to 200 psi"
    cfm, hp = f"{flow / CFM:.0f} cfm", f"{rated / HORSEPOWER:.0f} hp"
    if flow < FLOW[0] and rated < MOTOR[0]:
        return f"{cfm} is below 35 cfm, and {hp} below 10 hp"
    if flow > FLOW[1] and rated > MOTOR[1]:
        return f"{cfm} is above 1250 cfm, and {hp} above 200 hp"
    return ""
