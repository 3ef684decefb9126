"""How often a motor on the mains may be started per hour.

Source: NEMA MG 10, table 2-3, columns A (as in EASA's Electrical Engineering Handbook, Allowable Starts and Starting
Intervals): of designs A and B, at rated voltage, against a torque that rises with the square of the speed to the rated
one, with an inertia of the load within the bounds of NEMA MG 1, 12.54. An inverter starts its motor without such a
limit.
"""

from bisect import bisect_left

from screwsim.outputs.us_units import HORSEPOWER

POWERS = (  # rated [hp]
    *(1.0, 1.5, 2.0, 3.0, 5.0, 7.5, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0, 75.0, 100.0, 125.0, 150.0),
    *(200.0, 250.0),
)
STARTS = {  # most per hour, by the number of poles
    2: (15.0, 12.9, 11.5, 9.9, 8.1, 7.0, 6.2, 5.4, 4.8, 4.4, 4.1, 3.7, 3.4, 3.2, 2.9, 2.6, 2.4, 2.2, 2.0, 1.8),
    4: (30.0, 25.7, 23.0, 19.8, 16.3, 13.9, 12.5, 10.7, 9.6, 8.8, 8.2, 7.4, 6.8, 6.3, 5.8, 5.2, 4.8, 4.5, 4.0, 3.7),
    6: (34.0, 29.1, 26.1, 22.4, 18.4, 15.8, 14.2, 12.1, 10.9, 10.0, 9.3, 8.4, 7.7, 7.2, 6.6, 5.9, 5.4, 5.1, 4.5, 4.2),
}
IN_WORDS = {2: "two-pole", 4: "four-pole", 6: "six-pole"}
USUAL_POLES = 4  # of a motor that states none
SOURCE = "NEMA MG 10"


def most_starts(power: float, poles: int = USUAL_POLES) -> float | None:
    """Return how often per hour a motor of a rated power [W] may be started; None for one larger than the table's.

    Between two rows it is that of the larger motor.
    """
    row = bisect_left(POWERS, round(power / HORSEPOWER, 1))
    return STARTS[poles][row] if row < len(POWERS) else None
