"""Slopes by differences."""


def difference(f, x, step):
    """Return df/dx by central differences of fourth order."""
    return (8.0 * (f(x + step) - f(x - step)) - f(x + 2.0 * step) + f(x - 2.0 * step)) / (12.0 * step)
