"""Units of the United States in SI, exact by definition; the Btu of the International Table (NIST SP 811, B.8)."""

FOOT, INCH, POUND = 0.3048, 0.0254, 0.45359237  # [m], [m], [kg]
POUND_FORCE = POUND * 9.80665  # [N]
HORSEPOWER = 550.0 * FOOT * POUND_FORCE  # [W]
PSI = POUND_FORCE / INCH**2  # [Pa]
CFM = FOOT**3 / 60.0  # [m³/s], a cubic foot per minute
GALLON = 231.0 * INCH**3  # [m³]
BTU = 2326.0 * POUND  # [J]
