"""Efficiency classes of motors: the nominal efficiency of a class at a rated power (docs/model.md M450).

Source: IEC 60034-30-1:2014, interpolation at 50 Hz from 0.75 kW to 200 kW; nominal efficiencies of the same standard as
Regulation (EU) 2019/1781, annex I, prints them, which the polynomials meet within their last digit. Above 200 kW, up to
1000 kW, the efficiency is that at 200 kW. Eight poles, 60 Hz, IE1 and powers below 0.75 kW are not included.
"""

from math import log10

IE2, IE3, IE4 = CLASSES = ("IE2", "IE3", "IE4")
POLES = (2, 4, 6)
SMALLEST, FLAT, LARGEST = 750.0, 200e3, 1000e3  # [W]
_COEFFICIENTS = {  # coefficients of powers 3, 2, 1, 0 of lg(P/kW); the result is in percent
    (IE2, 2): (0.2972, -3.3454, 13.0651, 79.0770),
    (IE2, 4): (0.0278, -1.9247, 10.4395, 80.9761),
    (IE2, 6): (0.0148, -2.4978, 13.2470, 77.5603),
    (IE3, 2): (0.3569, -3.3076, 11.6108, 82.2503),
    (IE3, 4): (0.0773, -1.8951, 9.2984, 83.7025),
    (IE3, 6): (0.1252, -2.6130, 11.9963, 80.4769),
    (IE4, 2): (0.3400, -3.0479, 10.2930, 84.8208),
    (IE4, 4): (0.2412, -2.3608, 8.4460, 86.8321),
    (IE4, 6): (0.3598, -3.2107, 10.7933, 84.1070),
}


def class_efficiency(name: str, poles: int, rated_power: float) -> float:
    """Return the nominal efficiency of a motor of a class by its number of poles and rated power [W] (M450)."""
    x = log10(1e-3 * min(max(rated_power, SMALLEST), FLAT))
    a, b, c, d = _COEFFICIENTS[name, poles]
    return 0.01 * (((a * x + b) * x + c) * x + d)
