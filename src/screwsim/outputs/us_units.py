"""US customary units in SI, exact by definition (NIST Special Publication 811, appendix B)."""

FOOT = 0.3048  # [m]
INCH = FOOT / 12.0  # [m]
CUBIC_FOOT = FOOT**3  # [m³]
GALLON = 231.0 * INCH**3  # [m³]
CFM = CUBIC_FOOT / 60.0  # [m³/s], cubic foot per minute
POUND = 0.45359237  # [kg]
POUND_FORCE = POUND * 9.80665  # [N]
PSI = POUND_FORCE / INCH**2  # [Pa]
STANDARD_STATE = 273.15 + 28.0 / 1.8, 14.696 * PSI  # [K], [Pa] of a standard cubic foot: 60 degF, 14.696 psia
HORSEPOWER = 550.0 * FOOT * POUND_FORCE  # [W]
BTU = 2326.0 * POUND  # [J], of the International Table
TON = 12000.0 * BTU / 3600.0  # [W], of refrigeration
