"""Names that a composition defines in its generated module, used by the kernels of this package, and fixed indices.

Only from Python, by number: `path_area(i, phi, P, TAB)` (ports, then gaps; flow coefficient included),
`path_opening(i, drop, width, held, y, at, P)` → open share of a port at a pressure difference into the chamber,
`stop_push(i, p, p_suction, p_discharge, y, at, P)` and `push_on(i, T, rho, y, R, P, TAB)`, and `line_pulse(i, phi, P)`
→ (offset, pulsation) of the pressure of line i (0 suction, 1 discharge) over itself.

Also defined: the indices into P that depend on the number of own plenums, and those of `network.layout`. Indices into
P, R and a port state that are fixed for every composition stand here, too.
"""

from typing import Any

from screwsim.numerics.kernel import Slot, Structure

# ---- the gas ---------------------------------------------------------------------------------------------------------
# (T, rho, P, TAB)
gas_state: Any = Slot("gas_state")
# (T, rho, P, TAB) → 0 or 1
gas_phase: Any = Slot("gas_phase")
# (phase, T, rho, P, TAB) → the state in that phase, continued beyond its border
phased_state: Any = Slot("phased_state")
# (T, rho, P, TAB)
gas_entropy: Any = Slot("gas_entropy")
# (V, y, at, P) → gas [kg] in a chamber whose states begin at y[at]
gas_in: Any = Slot("gas_in", "chamber__gas")

# ---- machine and oil -------------------------------------------------------------------------------------------------
# (phi, P, TAB)
volume_at: Any = Slot("volume_at")
# (phi, P, TAB)
volume_slope_at: Any = Slot("volume_slope_at")
# by number, see above
path_area: Any = Slot("path_area")
# by number, see above
line_pulse: Any = Slot("line_pulse")
# (T, rho, y, R, P, TAB) → acceleration at rest of each that moves between a seat and a stop
push_on: Any = Slot("push_on")
# (i, T, m, p, rho, V, phi, T_oil, m_oil, d, P) → heat [W] that effect i brings from the oil to the gas
heat_part: Any = Slot("heat_part")
# (p, m, P) → oil [kg] offered to one chamber at the injection angle
injected_oil: Any = Slot("injected_oil")
# (phi, p, P, TAB) → oil [kg/s] through the oil ports of a chamber
oil_inflow: Any = Slot("oil_inflow")
# (y, phi, E, own, P, TAB) → gas [kg/s] that a chamber's oil releases, or that flashes out of entering oil
given_off: Any = Slot("given_off", "chamber__given_off")
# (w, P, TAB) → entropy [J/(kg K)] of gas dissolved in oil that holds w, and of all that a kilogram holds
solution_entropy: Any = Slot("solution_entropy")

# ---- a chamber among its neighbours ----------------------------------------------------------------------------------
# (phi, middle, context, E): fills E with the surroundings
around_chamber: Any = Slot("around_chamber", "chamber__surroundings")
# (columns, P, R, E, at): the port state of a neighbour, at E[at]
neighbour: Any = Slot("neighbour", "chamber__neighbour")
# (step, dense, context): what a history stores of a step beyond the states
keep_port_states: Any = Slot("keep_port_states", "chamber__keep_port_states")
# (theta, step, times, dense, E, y, P) → dm/dφ [kg/rad] of a chamber's gas along a step
mass_rate: Any = Slot("mass_rate", "chamber__mass_rate")
# (y, E, context, out): flow [kg/s] into a chamber through each path
path_flows: Any = Slot("path_flows", "chamber__path_flows")
# the same of oil films
films_into: Any = Slot("films_into", "chamber__oil_films")
# (flows, mass_rate, E, own, R, P) → the flow through the widest port from the mass balance
balanced: Any = Slot("balanced", "chamber__balanced")
# (flows, mass_rate) → that of the only port that is open to a line
balanced_alone: Any = Slot("balanced_alone", "chamber__balanced_alone")
# (phi, P, TAB) → whether a chamber is open to a line
faces_line: Any = Slot("faces_line", "chamber__faces_line")
# (phi, middle, P, TAB) → whether it is open to the discharge line, also by a gap beyond the last chamber
lets_out: Any = Slot("lets_out", "chamber__lets_out")
# (flows, phi, V, share, k, points, P, into, volume): adds a share of its flows into the lines
add_to_lines: Any = Slot("add_to_lines", "chamber__add_to_lines")
# (heat, mass, flows, T_oil, weight, E): adds what leaves it to the discharge line
add_outflow: Any = Slot("add_outflow", "chamber__add_outflow")
# (phi, y, mass_rate, E, context, flows, s_suction, s_discharge, dt, paths, heats, oil): adds to the ledger's sums
add_moment: Any = Slot("add_moment", "ledger__add_moment")

# ---- counts: states of a chamber, paths into it (both sides of gaps), chambers alive at once -------------------------
N: Any = Slot("N")
N_FLOWS: Any = Slot("N_FLOWS")
CHAMBERS: Any = Slot("CHAMBERS")


# P: parameters of the run; the width of a port to plenum i is at P_PORT_WIDTH + i
P_OMEGA, P_PITCH, P_LIFE, P_INJECTION, P_PORT_WIDTH, P_DISCHARGE_WIDTH, P_GAP_WIDTH = range(7)
P_FIRST_OIL = 7  # without own plenums, whose widths come first
P_C_OIL: Any = Structure("P_C_OIL")
P_T_OIL: Any = Structure("P_T_OIL")
P_TO_RATIO: Any = Structure("P_TO_RATIO")
P_ROOM: Any = Structure("P_ROOM")  # specific volume of the oil; 0 where it takes no room
P_P_SOURCE: Any = Structure("P_P_SOURCE")  # pressure of the oil's source
P_H_PORT: Any = Structure("P_H_PORT")  # enthalpy over heat capacity of oil entering through ports
P_TRAPPED: Any = Structure("P_TRAPPED")  # trapped gas [kg], set by `inject`, to which a pump delivers its ratio
OIL_NUMBERS = ("P_C_OIL", "P_T_OIL", "P_TO_RATIO", "P_ROOM", "P_P_SOURCE", "P_H_PORT", "P_TRAPPED")

# a port state: pressure, density, enthalpy, 1/k, drop and ψ² at choking, oil per gas, oil temperature, c_v, T p_T, and
# dissolved gas per kilogram of oil.
# Where oil takes room the density is that used by flows, and the oil temperature is enthalpy over heat capacity of
# the oil (network.port_states).
PRESSURE, DENSITY, ENTHALPY, EXPONENT, CHOKE, CHOKED, OIL_RATIO, OIL_TEMPERATURE, C_V, TPT, DISSOLVED = range(11)
PORT_STATE = 11
S_T, S_RHO, S_T_OIL, S_X_OIL = range(4)  # states of a chamber: of the gas, of the oil, oil per gas
HELD = 4  # where oil dissolves: gas per oil
PLENUM_ENTROPY = C_V  # of an effect's own plenum: specific entropy
PHASE = PORT_STATE  # after a chamber's own port state: the phase in which its gas is held, FREE or 0 or 1
BEYOND = PORT_STATE  # after a neighbour's port state in E: 1 where it is the discharge line's, beyond the last chamber
LOOSE = -2.0  # of a switch, when reading a stored cycle: open within the error of the pressure
FREE = -1.0  # phase of a chamber that its state determines; otherwise it is held for a step of the integrator

# R: numbers that change in closing the cycle: both lines (port states), then those set at the injection angle;
# plenum i of the effects' own (i = 3, 4, …) is the port state at i · PORT_STATE
R_SUCTION = 0
R_DISCHARGE = PORT_STATE
R_RATIO, R_TRAPPED, R_PRESSURE, R_INJECTED, R_OIL_BEFORE, R_LOCK, R_SIZE = range(2 * PORT_STATE, 2 * PORT_STATE + 7)
FIRST_OWN = 3  # number of the first of the effects' own plenums

# E: what depends on the angle alone: volume, dV/dφ, oil present, angle, then areas and port states of neighbours
E_VOLUME, E_SLOPE, E_OILED, E_ANGLE, E_AREAS = range(5)

# categories of streams: suction in, suction out, discharge in, discharge out, between chambers (net); with own plenums
# or oil ports also the oil through ports, then in and out of each own plenum: 2 i and 2 i + 1 for plenum i
SUCTION_IN, SUCTION_OUT, DISCHARGE_IN, DISCHARGE_OUT, BETWEEN, PORT_OIL = range(6)

AHEAD, BEHIND = range(2)  # sides of a gap: the chamber on the other side of it

# sums of each: gas [kg], its enthalpy [J], oil [kg], oil times its temperature, gas dissolved in the oil [kg]
OF_GAS, OF_ENERGY, OF_OIL, OF_OIL_HEAT, OF_HELD = range(5)

# quadratures: work on the gas, heat from the oil, of each wall heat into the gas and conductance, then per category
# mass, enthalpy (oil mass, oil mass × T_oil, dissolved gas)
Q_WORK, Q_HEAT, Q_WALLS = range(3)

# names that written texts use
FIXED = (
    *("P_OMEGA", "P_PITCH", "P_LIFE", "P_INJECTION", "P_PORT_WIDTH", "P_DISCHARGE_WIDTH", "P_GAP_WIDTH"),
    *("PRESSURE", "DENSITY", "ENTHALPY", "EXPONENT", "CHOKE", "CHOKED", "OIL_RATIO", "OIL_TEMPERATURE", "C_V", "TPT"),
    *("DISSOLVED", "PORT_STATE", "PHASE", "BEYOND", "LOOSE", "FREE", "R_SUCTION", "R_DISCHARGE", "R_RATIO"),
    *("R_TRAPPED", "R_PRESSURE", "R_OIL_BEFORE", "R_INJECTED"),
    *("E_VOLUME", "E_SLOPE", "E_OILED", "E_ANGLE", "E_AREAS", "PLENUM_ENTROPY"),
)
