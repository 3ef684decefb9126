"""Motion of the piston of an offset slider-crank, and the chamber volume over the angle of its life.

x counts from the crankshaft's axis towards the cylinder head, α from the direction of the cylinder, e from the
crankshaft's axis to the cylinder's. The chamber's angle φ begins at top dead centre: V(0) is the clearance.
Source: vector loop; V. V. Solovyova, "Optimization of the transfer function of a piston compressor", 2019 (in Russian),
for x(α) and the signs. Needs rod > crank + |offset|. Equations: docs/reference/slider-crank.md.
"""

import math

from screwsim.numerics.kernel import kernel


@kernel
def position(alpha, crank, rod, offset):
    """Return the piston's position x [m] (S1)."""
    u = crank * math.sin(alpha) - offset
    return crank * math.cos(alpha) + math.sqrt(rod * rod - u * u)


@kernel
def slope(alpha, crank, rod, offset):
    """Return dx/dα [m/rad] (S2)."""
    u = crank * math.sin(alpha) - offset
    return -crank * math.sin(alpha) - crank * math.cos(alpha) * u / math.sqrt(rod * rod - u * u)


@kernel
def second_slope(alpha, crank, rod, offset):
    """Return d²x/dα² [m/rad²] (S3)."""
    u = crank * math.sin(alpha) - offset
    du = crank * math.cos(alpha)
    height = math.sqrt(rod * rod - u * u)
    dheight = -u * du / height
    return -crank * math.cos(alpha) - (du * du - u * crank * math.sin(alpha) + dheight * dheight) / height


@kernel
def velocity(alpha, omega, crank, rod, offset):
    """Return the piston's speed dx/dt [m/s], positive towards the head (S3)."""
    return omega * slope(alpha, crank, rod, offset)


@kernel
def acceleration(alpha, omega, domega_dt, crank, rod, offset):
    """Return the piston's acceleration [m/s²] (S3)."""
    return omega * omega * second_slope(alpha, crank, rod, offset) + domega_dt * slope(alpha, crank, rod, offset)


@kernel
def top_angle(crank, rod, offset):
    """Return the crank angle of the top dead centre [rad] (S4)."""
    return math.asin(offset / (rod + crank))


@kernel
def bottom_angle(crank, rod, offset):
    """Return the crank angle of the bottom dead centre [rad] (S4)."""
    return math.pi + math.asin(offset / (rod - crank))


@kernel
def stroke(crank, rod, offset):
    """Return the distance between the dead centres [m] (S4)."""
    far, near = rod + crank, rod - crank
    return math.sqrt(far * far - offset * offset) - math.sqrt(near * near - offset * offset)


@kernel
def volume(phi, V_c, A_piston, crank, rod, offset):
    """Return the chamber volume [m³] (S5)."""
    far = rod + crank
    top = math.sqrt(far * far - offset * offset)
    return V_c + A_piston * (top - position(phi + top_angle(crank, rod, offset), crank, rod, offset))


@kernel
def volume_slope(phi, A_piston, crank, rod, offset):
    """Return dV/dφ [m³/rad] (S5)."""
    return -A_piston * slope(phi + top_angle(crank, rod, offset), crank, rod, offset)
