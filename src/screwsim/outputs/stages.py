"""The figures of two stages in a row."""

from screwsim.outputs.declared import Figure, Scale, efficiency, over

UNASKED = Scale(unasked=True)

_STAGES = (  # of two stages in a row
    Figure("intermediate_pressure", "Pa", "pressure between both stages, of the first one's discharge line"),
    Figure("second_suction_temperature", "K", "temperature of what the second stage sucks"),
    Figure("intercooler_heat", "W", "heat taken from the gas between both stages", over("shaft_power")),
    Figure("vapour_mass_flow", "kg s-1", "vapour of the flash tank that mixes in between both stages"),
    Figure("gas_mass_flow", "kg s-1", "net mass flow that the first stage sucks"),
    Figure("first_shaft_power", "W", "shaft power of the first stage"),
    Figure("second_shaft_power", "W", "shaft power of the second stage"),
    Figure("shaft_power", "W", "shaft power of both stages"),
    Figure("first_separator_temperature", "K", "temperature of gas and oil in the separator of the first stage"),
    Figure("second_separator_temperature", "K", "temperature of gas and oil in the separator of the second stage"),
    Figure(
        "first_oil_cooler_duty",
        "W",
        "heat that the oil cooler of the first stage takes, its supply as stated",
        over("shaft_power"),
    ),
    Figure(
        "second_oil_cooler_duty",
        "W",
        "heat that the oil cooler of the second stage takes, its supply as stated",
        over("shaft_power"),
    ),
    Figure("first_pressure_ratio", "1", "pressure ratio of the first stage"),
    Figure("second_pressure_ratio", "1", "pressure ratio of the second stage"),
    Figure("discharge_temperature", "K", "flow-weighted mean gas temperature at discharge of the second stage"),
    efficiency("isothermal_efficiency", "isothermal efficiency of the whole"),
    efficiency("ideal_isothermal_efficiency", "isothermal efficiency of the whole, with an ideal gas's work"),
    efficiency("isentropic_efficiency", "isentropic efficiency of the whole, without cooling between the stages"),
    Figure("cooling_capacity", "W", "cooling capacity of the whole"),
    Figure("cop", "1", "coefficient of performance of the whole"),
    Figure("heating_capacity", "W", "heating capacity of the whole, without the oil coolers'"),
    Figure("heating_cop", "1", "coefficient of performance of heating of the whole"),
    Figure("flow_mismatch", "1", "what comes to the second stage against what it takes, relative difference", UNASKED),
)
STAGES = {figure.name: figure for figure in _STAGES}
