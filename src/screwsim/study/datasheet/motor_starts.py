"""How often a motor on the mains may be started per hour.

Source: NEMA MG 10, table 2-3, column A for four poles (as in EASA's Electrical Engineering Handbook, Allowable Starts
and Starting Intervals): of designs A and B, at rated voltage, against a torque that rises with the square of the speed
to the rated one, with an inertia of the load within the bounds of NEMA MG 1, 12.54. An inverter starts its motor
without such a limit.
"""

from bisect import bisect_left

from screwsim.outputs.us_units import HORSEPOWER

# (rated power [hp], most starts per hour)
FOUR_POLES = (
    *((1.0, 30.0), (1.5, 25.7), (2.0, 23.0), (3.0, 19.8), (5.0, 16.3), (7.5, 13.9), (10.0, 12.5), (15.0, 10.7)),
    *((20.0, 9.6), (25.0, 8.8), (30.0, 8.2), (40.0, 7.4), (50.0, 6.8), (60.0, 6.3), (75.0, 5.8), (100.0, 5.2)),
    *((125.0, 4.8), (150.0, 4.5), (200.0, 4.0), (250.0, 3.7)),
)
SOURCE = "NEMA MG 10"


def most_starts(power: float) -> float | None:
    """Return how often per hour a motor of a rated power [W] may be started; None for one larger than the table's.

    Between two rows it is that of the larger motor.
    """
    row = bisect_left([hp for hp, _ in FOUR_POLES], round(power / HORSEPOWER, 1))
    return FOUR_POLES[row][1] if row < len(FOUR_POLES) else None
