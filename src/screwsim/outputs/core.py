"""Figures of the core, which any result may have, whatever effects its scene names; and figures of two stages."""

from functools import partial

from screwsim.outputs.declared import (
    DIFFERENCE,
    LEAST_OIL,
    NET_FLOW,
    POWER,
    Figure,
    Scale,
    efficiency,
    over,
    power_figure,
)

_STAGES = (  # figures of two stages in series
    Figure("intermediate_pressure", "Pa", "pressure between the stages, in the first one's discharge line"),
    Figure("intermediate_temperature", "K", "saturation temperature of a pure refrigerant between the stages"),
    Figure("second_suction_temperature", "K", "suction temperature of the second stage"),
    Figure("intercooler_heat", "W", "heat removed from the gas between the stages", over("shaft_power")),
    Figure("vapour_mass_flow", "kg s-1", "vapour from the flash tank that mixes in between the stages"),
    Figure("gas_mass_flow", "kg s-1", "net mass flow into the first stage"),
    Figure("first_shaft_power", "W", "shaft power of the first stage"),
    Figure("second_shaft_power", "W", "shaft power of the second stage"),
    Figure("shaft_power", "W", "shaft power of both stages"),
    Figure("electrical_power", "W", "electrical power of both stages, if both have a motor"),
    Figure("first_separator_temperature", "K", "temperature of gas and oil in the separator of the first stage"),
    Figure("second_separator_temperature", "K", "temperature of gas and oil in the separator of the second stage"),
    Figure(
        "first_oil_cooler_duty",
        "W",
        "heat removed by the oil cooler of the first stage, with oil supplied as stated",
        over("shaft_power"),
    ),
    Figure(
        "second_oil_cooler_duty",
        "W",
        "heat removed by the oil cooler of the second stage, with oil supplied as stated",
        over("shaft_power"),
    ),
    Figure(
        "first_pressure_ratio",
        "1",
        "pressure at the first machine's discharge over that of its suction line, of a package at its inlet",
    ),
    Figure(
        "second_pressure_ratio",
        "1",
        "pressure at the second machine's discharge, not at a package's outlet, over that of its suction line",
    ),
    Figure("first_discharge_temperature", "K", "flow-weighted mean gas temperature at discharge of the first stage"),
    Figure("discharge_temperature", "K", "flow-weighted mean gas temperature at discharge of the second stage"),
    efficiency("isothermal_efficiency", "isothermal efficiency of both stages together"),
    efficiency(
        "ideal_isothermal_efficiency", "isothermal efficiency of both stages together, with the work of an ideal gas"
    ),
    efficiency(
        "isentropic_efficiency", "isentropic efficiency of both stages together, whose ideal has no cooling in between"
    ),
    Figure("cooling_capacity", "W", "cooling capacity of both stages together"),
    Figure("cop", "1", "coefficient of performance of both stages together"),
    Figure("heating_capacity", "W", "heating capacity of both stages together, without that of the oil coolers"),
    Figure("heating_cop", "1", "heating coefficient of performance of both stages together"),
    Figure("electrical_cop", "1", "cooling capacity over the electrical power of both stages"),
    Figure("electrical_heating_cop", "1", "heating capacity over the electrical power of both stages"),
    Figure(
        "free_air_delivered",
        "m3 s-1",
        "flow delivered by two stages of air, as volume at the inlet of the first one",
        shown="m3 min-1",
    ),
    Figure("package_input_power", "W", "electrical power of both stages' motors, inverters and fans"),
    Figure("package_specific_power", "W s m-3", "input power of both stages over free air delivered"),
    efficiency("package_isentropic_efficiency", "isentropic power of ISO 1217 over the input power of both stages"),
    Figure(
        "flow_mismatch",
        "1",
        "relative difference between the flow into the second stage and what it takes in",
        Scale(1.0, alone=True, unasked=True),
    ),
)
STAGES = {figure.name: figure for figure in _STAGES}
# conditions that call for a figure of the core, beside keys of a scene (`figures.called_for`)
OILED, EXPANDED = ("oil_supply",), ("machine.mode: expander",)
NEEDS_CONDENSER = ("operation.condensing_temperature and machine.mode: compressor", "operation.gas_cooler")
HUMID = ("gas.relative_humidity",)
# roles of effects, declared by the effects themselves (`effects.base`)
HEATED = ("an effect that gives the oil a temperature",)
CHANGED = ("an effect with a SuctionChange",)
WALLED = ("an effect with a Wall",)
HELD = ("an effect by which the oil gives off its gas over time",)
SUBCRITICAL = ("gas.model: real with suction gas below its critical temperature",)
GLIDING = (f"{SUBCRITICAL[0]}, a blend",)
WETTED = (f"{SUBCRITICAL[0]} and gas.two_phase: equilibrium, a pure fluid",)
AFTERCOOLED = ("operation.aftercooler_temperature", "with gas.relative_humidity, an effect with an aftercooler")
# of condensate: relatively, saturation changes at least 15 times as much as temperature
CONDENSED = Scale(15.0, ("water_flow",))

_oiled, _cooled, _changed = (partial(Figure, needs=needs) for needs in (OILED, NEEDS_CONDENSER, CHANGED))
_saturating, _gliding = (partial(Figure, needs=needs) for needs in (SUBCRITICAL, GLIDING))
_wetted = partial(Figure, needs=WETTED)
_humid = partial(Figure, needs=HUMID)
_water = partial(_humid, shown="kg h-1")
# proportional to the net gas flow
cooling_figure = partial(Figure, scale=NET_FLOW, needs=NEEDS_CONDENSER, by_flow=True)
_CORE = (
    efficiency("isothermal_efficiency", "isothermal efficiency of the shaft power", by_flow=True),
    efficiency(
        "ideal_isothermal_efficiency",
        "ideal-gas isothermal power at suction temperature over shaft power",
        by_flow=True,
    ),
    efficiency("isentropic_efficiency", "isentropic efficiency of the shaft power", by_flow=True),
    efficiency("volumetric_efficiency", "volumetric efficiency", by_flow=True),
    Figure("gas_mass_flow", "kg s-1", "net gas mass flow from the suction line", NET_FLOW, by_flow=True),
    _oiled(
        "oil_mass_flow",
        "kg s-1",
        "injected oil mass flow (expander: with the gas)",
        Scale(LEAST_OIL, ("gas_mass_flow",)),
        by_oil=True,
    ),
    _oiled(
        "oil_ratio",
        "1",
        "oil-to-gas mass ratio in the chamber at 360 degrees (rotors: where suction closes; oil_injection: at its end)",
        Scale(LEAST_OIL),
    ),
    _oiled(
        "oil_flow_ratio",
        "1",
        "injected oil over net suction gas",
        Scale(LEAST_OIL, times="filling"),
        by_flow=True,
        by_oil=True,
    ),
    power_figure("indicated_power", "indicated power"),
    power_figure(
        "oil_lift_power", "power to raise the oil to discharge pressure, in addition to indicated power", needs=OILED
    ),
    power_figure("shaft_power", "shaft power"),
    Figure("shaft_torque", "N m", "mean torque at the shaft: shaft power over speed", Scale(times="ideal")),
    Figure("discharge_temperature", "K", "flow-weighted mean gas temperature at discharge"),
    Figure("oil_discharge_temperature", "K", "flow-weighted mean oil temperature at discharge", needs=HEATED),
    Figure(
        "peak_pressure",
        "Pa",
        "highest chamber pressure up to the widest opening of the discharge port, not of what is squeezed as it closes",
    ),
    Figure("work_per_cycle", "J", "work on the gas of one chamber per cycle: minus the integral of p dV"),
    Figure("trapped_mass", "kg", "gas mass in a chamber at 360 degrees (rotors: where suction closes)"),
    _oiled(
        "injection_pressure",
        "Pa",
        "chamber pressure where oil is injected: at 360 degrees (rotors: where suction closes; oil_injection: mean; "
        "expander: that of the suction line)",
    ),
    Figure("suction_pressure", "Pa", "pressure of the suction line"),
    Figure("suction_temperature", "K", "temperature of the suction line"),
    Figure("discharge_pressure", "Pa", "pressure of the discharge line, in a package before its separator element"),
    Figure(
        "pressure_ratio",
        "1",
        "pressure of the discharge line over that of the suction line (expander: inverse); of a package that at its "
        "machine's discharge over that at its inlet",
    ),
    Figure("displacement", "m3", "swept volume of all chambers per revolution of the male rotor or the crank"),
    Figure("displacement_flow", "m3 s-1", "displacement times speed"),
    Figure(
        "built_in_volume_ratio",
        "1",
        "chamber volume where suction closes over that where the discharge port opens (profiles: as stated)",
        needs=("machine.kind: twin_screw",),
    ),
    Figure("specific_power", "W s m-3", "shaft power over the volume flow of suction gas", NET_FLOW, by_flow=True),
    cooling_figure(
        "cooling_capacity", "W", "cooling capacity: net gas flow times the real fluid's refrigerating effect"
    ),
    cooling_figure("cop", "1", "coefficient of performance: cooling capacity over shaft power"),
    cooling_figure(
        "heating_capacity",
        "W",
        "heating capacity: heat that the gas gives off in the condenser or gas cooler, oil cooler excluded",
    ),
    cooling_figure("heating_cop", "1", "heating coefficient of performance: heating capacity over shaft power"),
    _cooled("volumetric_cooling_capacity", "J m-3", "cooling capacity over the volume flow of suction gas"),
    _changed("intake_pressure", "Pa", "intake pressure of the machine, after filter, valve, throttle and bypass"),
    _changed("intake_temperature", "K", "intake temperature of the machine, after mixing with all that returns"),
    _saturating("evaporating_temperature", "K", "saturation temperature at suction pressure; of a blend its dew point"),
    _saturating(
        "condensing_temperature", "K", "saturation temperature at discharge pressure; of a blend its dew point"
    ),
    _gliding("evaporating_bubble_temperature", "K", "bubble point of a blend at suction pressure"),
    _gliding("condensing_bubble_temperature", "K", "bubble point of a blend at discharge pressure"),
    _saturating("suction_superheat", DIFFERENCE, "temperature of the suction line above the dew point there"),
    _saturating(
        "discharge_superheat",
        DIFFERENCE,
        "mean gas temperature at discharge above the dew point there",
        over("discharge_temperature", alone=True),
    ),
    _wetted("discharge_quality", "1", "mass share of vapour in the gas as it leaves the chambers; 1 where it is dry"),
    _humid("humidity_ratio", "1", "water vapour per dry air in the suction line, by mass"),
    _humid("pressure_dew_point", "K", "dew point of the delivered air at discharge pressure"),
    _humid(
        "lowest_safe_oil_temperature",
        "K",
        "lowest temperature of gas and oil that keeps gas.dew_point_margin above the pressure dew point",
    ),
    _water("water_flow", "kg s-1", "water vapour in the net gas flow from the suction line", NET_FLOW, by_flow=True),
    _water(
        "condensate_flow",
        "kg s-1",
        "water that condenses in the separator, where gas and oil have mixed (dry machine: at discharge temperature)",
        CONDENSED,
    ),
    _water("vapour_flow", "kg s-1", "water that leaves the separator as vapour", CONDENSED),
    Figure(
        "aftercooler_condensate_flow",
        "kg s-1",
        "water that condenses in the aftercooler",
        CONDENSED,
        AFTERCOOLED,
        shown="kg h-1",
    ),
    _humid(
        "chamber_condensate_share",
        "1",
        "largest share of the water trapped in a chamber that is liquid",
        Scale(1.0, alone=True, unasked=True),
    ),
    _humid(
        "water_residual",
        "1",
        "water that enters less what leaves as vapour and condensate, over what enters",
        Scale(1.0, alone=True, unasked=True),
    ),
    power_figure("output_power", "shaft power of an expander", needs=EXPANDED),
    Figure(
        "filling_factor",
        "1",
        "net gas flow of an expander, over the flow that would fill its chambers when the inlet closes",
        needs=EXPANDED,
        by_flow=True,
    ),
    Figure(
        "inlet_backflow_heat",
        "W",
        "heat that gas and oil take with them where they flow back into an expander's inlet",
        POWER,
        needs=EXPANDED,
    ),
    Figure("wall_heat", "W", "net heat from walls into the gas", POWER, WALLED),
    Figure(
        "discharge_dissolved_gas_ratio",
        "1",
        "refrigerant dissolved in the oil that leaves to discharge, per oil",
        needs=HELD,
    ),
)
PERFORMANCE = {figure.name: figure for figure in _CORE}  # figures of the core; effects declare their own
