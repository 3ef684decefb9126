"""The lowest temperature from which a blend has one phase at any density (M317).

Process gases (natural gas with carbon dioxide, hydrogen with methane) are used far above their phase envelope, which
lies below the range of a component's equation, or is not closed, so that no line can be followed around it. Such a
blend is a gas from a temperature on at which no second phase is in equilibrium with it: the equations of M315 have no
solution at that temperature, from starts at densities from thin gas to dense fluid and phases enriched in each
component. Temperatures are tried upwards; two phases that are only metastable count as two phases.
"""

import numpy as np

from screwsim.fluid.description import Description
from screwsim.fluid.fugacity import Fugacities
from screwsim.fluid.phase_envelope import TINY, Array, R, liquid_density, normal, solved

ABOVE = 1.02  # temperature tried first, over the hottest known point of two phases
WARMER = 1.03  # ratio of temperatures tried one after the other
THIN, DENSE, DENSITIES = 1e-3, 2.0, 16  # range of ρ_z over the reducing density, and its number of starts
LIQUIDS = (0.1, 0.8, 2.4)  # densities of the starts' second phase over its reducing density
SHARES = (0.5, 0.95)  # of one component in the starts' second phase
PURE = 1e-3  # share of each other component in a drop
P_MOST = 1e8  # [Pa] pressure up to which a second phase is looked for; equations extrapolate to false ones far above
STEPS = 40  # most Newton steps
ALIKE = 0.02  # largest difference of ln ρ and of ln(w/z) of two phases that are the same one


def has_two_phases(f: Fugacities, T: float) -> bool:
    """Tell whether a second phase in equilibrium with the blend is found at T [K], at any density up to P_MOST."""
    return any(_any_apart(f, T, starts(f, T)) for starts in (_drops, _near))


def _any_apart(f: Fugacities, T: float, starts: Array) -> bool:
    """Tell whether any start [m, n + 3] leads to two phases that differ."""
    if not len(starts):
        return False
    u, good = solved(f, starts.T, -1, STEPS)
    n = f.n
    apart = np.maximum(np.abs(u[:n]).max(axis=0), np.abs(u[n] - u[n + 1])) > ALIKE
    return bool((good & apart & _sound(f, u, T)).any())


def _near(f: Fugacities, T: float) -> Array:
    """Return starts [m, n + 3]: densities of the blend, with second phases enriched in one component."""
    v_r = float(f.reducing(f.z)[1][0])
    found = []
    for w in ((1.0 - share) * f.z + share * one for share in SHARES for one in np.eye(f.n)):
        dense = np.log(np.array(LIQUIDS) / float(f.reducing(w)[1][0]))
        k = np.log(w / f.z)
        for log_z in np.log(np.geomspace(THIN, DENSE, DENSITIES) / v_r):
            found += [[*k, log_w, log_z, np.log(T)] for log_w in dense]
    return np.array(found)


def _drops(f: Fugacities, T: float) -> Array:
    """Return starts [m, n + 3] of drops of one component, with the others dissolved in it, in the thin blend.

    The blend's density is that at which the component has the fugacity of its liquid.
    """
    found = []
    for i in np.flatnonzero(f.T_c > T):
        x = np.full(f.n, PURE)
        x[i] = 1.0 - PURE * (f.n - 1)
        v_r = float(f.reducing(x)[1][0])
        rho = liquid_density(f, T, 0.0, x, v_r)
        log_f = f(T, rho, x)[0]
        rho_z = float(np.exp(log_f[i])) / f.z[i]
        w = np.minimum(f.z * rho_z / np.exp(log_f - np.log(x)), 0.1 * x[i])
        w[i] = x[i]
        found.append([*np.log(w / w.sum() / f.z), np.log(rho), np.log(rho_z), np.log(T)])
    return np.array(found).reshape(-1, f.n + 3)


def _sound(f: Fugacities, u: Array, T: float) -> Array:
    """Tell which columns u are two phases of positive compressibility, at a pressure above zero and up to P_MOST."""
    n, sound = f.n, np.asarray(np.isfinite(u).all(axis=0))
    z = np.repeat(f.z[:, None], u.shape[1], axis=1)
    with np.errstate(all="ignore"):
        for log_rho, x in ((u[n], normal(f, u)), (u[n + 1], z)):
            p = f(T, np.exp(log_rho) * (1.0 + 1j * TINY), x)[1]
            sound &= (np.real(p) > 0.0) & (np.real(p) * R * T < P_MOST) & (np.imag(p) > 0.0)
    return sound


def gas_from(known: Description, hottest: float) -> float | None:
    """Return the temperature [K] from which a blend is a gas at any density; None where it is not found up to T_max.

    `hottest` is the highest temperature of two phases found so far, 0 where there is none.
    """
    f, T = Fugacities(known), max(known.T_min, ABOVE * hottest)
    while has_two_phases(f, T):
        T *= WARMER
        if T > known.T_max:
            return None
    return T
