"""All chambers alive at once, over one lobe pitch: each interface is evaluated once, so what leaves one enters another.

Source: docs/model.md M1–M13, M24. Chamber j stands at s + j pitch; the states are y[j N + i]. The flows between
chambers cancel exactly in the sum. The same kernels serve the Rosenbrock method and scipy's integrators.

A context is the tuple (P, TAB, R, places, changed, work): parameters, tables, run-time cells, one place a chamber and a
spare one, then the phase in which each chamber's gas is held during a step (`slots.FREE`: in none); a spare state, and
working memory for sums and derivatives.

Where effects open chambers beyond the injection angle to suction, or others to discharge, what enters the chambers
before that angle from those beyond it is counted with what the lines' sums take for the other side's (`sideways`).
"""

from __future__ import annotations

from screwsim.model.film import add_film, film_between, film_beyond, film_flow
from screwsim.model.places import (
    IMPOSSIBLE,
    angle_terms,
    fill_place,
    perturbation,
    place_derivatives,
    relative_error,
    share_before_border,
)
from screwsim.model.port_oil import add_flash, add_release, oil_slopes, release_slopes
from screwsim.model.pulsation import fill_lines
from screwsim.model.room import gas_mass, locked
from screwsim.model.slopes import gap_slopes, opening_slopes, pulsating_slopes
from screwsim.model.slots import (
    ACROSS,
    ALL_LINES,
    BETWEEN,
    BEYOND,
    CATEGORIES,
    CHAMBERS,
    DISCHARGE_IN,
    DISSOLVES,
    E_ANGLE,
    E_AREAS,
    E_VOLUME,
    FILMED,
    FIRST_OWN,
    FLASHED,
    GAP_OFFSET,
    N_GAPS,
    N_PLENUM,
    OFFSETS,
    OWN_PLENUMS,
    P_GAP_WIDTH,
    P_H_PORT,
    P_INJECTION,
    P_OMEGA,
    P_PITCH,
    P_PORT_WIDTH,
    PLACE,
    PLENUM,
    PORT_OIL,
    PORTED,
    PRESSURE,
    PULSATING,
    Q_HEAT,
    Q_STREAMS,
    Q_WALLS,
    Q_WORK,
    R_DISCHARGE,
    RESISTED,
    SUCTION_IN,
    TPT,
    VOLUMED,
    WALLS,
    WIDTH,
    N,
    gap_area,
    gas_phase,
    oil_inflow,
)
from screwsim.model.streams import (
    add_stream,
    category,
    finish,
    held_back,
    place_flow,
)
from screwsim.numerics.kernel import kernel


@kernel
def all_surroundings(s, middle, context, E):
    """Fill E for all chambers, the first at angle s: angle terms and, for the trailing side, areas of the gaps."""
    P, TAB, _R, _places, _changed, _work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    for j in range(CHAMBERS):
        phi = s + j * P[P_PITCH]
        angle_terms(phi, middle + j * P[P_PITCH], P, TAB, E, j * size)
        for i in range(N_GAPS):
            E[j * size + E_AREAS + N_PLENUM + i] = gap_area(i, phi, P, TAB)
    if PULSATING == 1:
        fill_lines(s, P, _R, E, ALL_LINES)


@kernel
def all_rates(y, E, context, f, g):
    """Fill f = dy/dφ of all chambers, and g: quadrature rates summed over the chambers.

    The last of g is the gas that enters the chambers before the injection angle from those beyond it.
    """
    P, TAB, R, places, _changed, work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    n_sums = CATEGORIES * width
    for i in range(CHAMBERS * n_sums):
        work[i] = 0.0
    for j in range(CHAMBERS):
        fill_place(places[(CHAMBERS + 1) * PLACE + j], y, j * N, P, TAB, places, j * PLACE)
    for j in range(CHAMBERS):
        e = j * size + E_AREAS
        for i in range(N_PLENUM):
            if E[e + i] > 0.0:
                b = R_DISCHARGE * PLENUM[i]
                if PULSATING == 0:
                    m = place_flow(E[e + i], places, j * PLACE, R, b, P[P_PORT_WIDTH + PLENUM[i]])
                    at = j * n_sums + category(PLENUM[i], m) * width
                    if m >= 0.0:
                        add_stream(work, at, m, R, b)
                    else:
                        add_stream(work, at, m, places, j * PLACE)
                else:
                    m = place_flow(E[e + i], places, j * PLACE, E, ALL_LINES + b, P[P_PORT_WIDTH + PLENUM[i]])
                    at = j * n_sums + category(PLENUM[i], m) * width
                    if m >= 0.0:
                        add_stream(work, at, m, E, ALL_LINES + b)
                    else:
                        add_stream(work, at, m, places, j * PLACE)
        for i in range(N_GAPS):
            area = E[e + N_PLENUM + i]
            if area > 0.0:
                ahead = j + OFFSETS[GAP_OFFSET[i]]
                if ahead < CHAMBERS:
                    m = place_flow(area, places, j * PLACE, places, ahead * PLACE, P[P_GAP_WIDTH])
                    if RESISTED == 1:
                        m = held_back(i, m, area, places, j * PLACE, places, ahead * PLACE, P)
                    source = (ahead if m >= 0.0 else j) * PLACE
                    add_stream(work, j * n_sums + BETWEEN * width, m, places, source)
                    add_stream(work, ahead * n_sums + BETWEEN * width, -m, places, source)
                    if FILMED == 1:
                        q = film_flow(i, area, places, j * PLACE, places, ahead * PLACE, P)
                        source = (ahead if q >= 0.0 else j) * PLACE
                        add_film(work, j * n_sums + BETWEEN * width, q, places, source)
                        add_film(work, ahead * n_sums + BETWEEN * width, -q, places, source)
                else:
                    if PULSATING == 0:
                        m = place_flow(area, places, j * PLACE, R, R_DISCHARGE, P[P_GAP_WIDTH])
                        if RESISTED == 1:
                            m = held_back(i, m, area, places, j * PLACE, R, R_DISCHARGE, P)
                        if m >= 0.0:
                            add_stream(work, j * n_sums + DISCHARGE_IN * width, m, R, R_DISCHARGE)
                        else:
                            add_stream(work, j * n_sums + (DISCHARGE_IN + 1) * width, m, places, j * PLACE)
                        if FILMED == 1:
                            q = film_flow(i, area, places, j * PLACE, R, R_DISCHARGE, P)
                            if q >= 0.0:
                                add_film(work, j * n_sums + DISCHARGE_IN * width, q, R, R_DISCHARGE)
                            else:
                                add_film(work, j * n_sums + (DISCHARGE_IN + 1) * width, q, places, j * PLACE)
                    else:
                        m = place_flow(area, places, j * PLACE, E, ALL_LINES + R_DISCHARGE, P[P_GAP_WIDTH])
                        if RESISTED == 1:
                            m = held_back(i, m, area, places, j * PLACE, E, ALL_LINES + R_DISCHARGE, P)
                        if m >= 0.0:
                            add_stream(work, j * n_sums + DISCHARGE_IN * width, m, E, ALL_LINES + R_DISCHARGE)
                        else:
                            add_stream(work, j * n_sums + (DISCHARGE_IN + 1) * width, m, places, j * PLACE)
                        if FILMED == 1:
                            q = film_flow(i, area, places, j * PLACE, E, ALL_LINES + R_DISCHARGE, P)
                            if q >= 0.0:
                                add_film(work, j * n_sums + DISCHARGE_IN * width, q, E, ALL_LINES + R_DISCHARGE)
                            else:
                                add_film(work, j * n_sums + (DISCHARGE_IN + 1) * width, q, places, j * PLACE)
    if PORTED == 1:
        for j in range(CHAMBERS):
            oil = oil_inflow(E[j * size + E_ANGLE], places[j * PLACE + PRESSURE], P, TAB)
            work[j * n_sums + PORT_OIL * width + 2] = oil
            work[j * n_sums + PORT_OIL * width + 3] = oil * P[P_H_PORT]
            if FLASHED == 1:
                add_flash(oil, places[j * PLACE + PRESSURE], P, TAB, work, j * n_sums)
            if DISSOLVES == 1:
                add_release(y, j * N, E, j * size, oil, places, j * PLACE, P, TAB, work, j * n_sums)
    total_rates(y, E, P, R, places, work, f, g)


@kernel
def total_rates(y, E, P, R, places, work, f, g):
    """Fill f and g from the summed streams."""
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    n_sums = CATEGORIES * width
    for i in range(Q_STREAMS + n_sums + 1):
        g[i] = 0.0
    for j in range(CHAMBERS):
        finish(y, j * N, E, j * size, places, j * PLACE, R, P, work, j * n_sums, f, g)
        for i in range(n_sums):
            g[Q_STREAMS + i] += work[j * n_sums + i] / P[P_OMEGA]
        if side_of(j, P) == 0:
            g[Q_STREAMS + n_sums] += work[j * n_sums + BETWEEN * width] / P[P_OMEGA]
            if OWN_PLENUMS > 0:
                for c in range(2 * FIRST_OWN, CATEGORIES):
                    g[Q_STREAMS + n_sums] += work[j * n_sums + c * width] / P[P_OMEGA]
        if ACROSS == 1:
            g[Q_STREAMS + n_sums] += sideways(j, work, j * n_sums, P) / P[P_OMEGA]


@kernel
def all_jacobian(y, E, E_next, delta, context, f, g, J, Jq, f_phi, g_phi):
    """Fill f, g and their derivatives by y and φ, as `chamber.jacobian` does, for all chambers and interfaces."""
    P, TAB, R, places, changed, work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    n_sums = CATEGORIES * width
    n_all = CHAMBERS * N
    d = CHAMBERS * n_sums  # work: sums; place derivatives by each state, then by φ; derivatives of the sums
    ds = d + (n_all + CHAMBERS) * PLACE
    spare = ds + CHAMBERS * (n_all + 1) * n_sums
    phases = (CHAMBERS + 1) * PLACE
    for i in range(d):
        work[i] = 0.0
    for i in range(ds, spare):
        work[i] = 0.0
    for j in range(CHAMBERS):
        places[phases + j] = gas_phase(y[j * N], y[j * N + 1])
        fill_place(places[phases + j], y, j * N, P, TAB, places, j * PLACE)
        place_derivatives(places[phases + j], y, j * N, P, TAB, places, j * PLACE, changed, work[d + j * N * PLACE :])
        row = d + (n_all + j) * PLACE
        for i in range(PLACE):
            work[row + i] = 0.0
    for j in range(CHAMBERS):
        for i in range(N_PLENUM + N_GAPS):
            area = E[j * size + E_AREAS + i]
            darea = (E_next[j * size + E_AREAS + i] - area) / delta
            if area > 0.0 or darea > 0.0:
                ahead = j + OFFSETS[GAP_OFFSET[i - N_PLENUM]] if i >= N_PLENUM else -1
                if i >= N_PLENUM and ahead < CHAMBERS:
                    if RESISTED == 0:
                        gap_slopes(area, darea, j, ahead, BETWEEN * width, context, d, ds)
                    if RESISTED == 1:
                        gap_slopes(area, darea, j, ahead, BEYOND + i - N_PLENUM, context, d, ds)
                    if FILMED == 1:
                        film_between(i - N_PLENUM, area, darea, j, ahead, context, d, ds)
                else:
                    to = PLENUM[i] if i < N_PLENUM else 1
                    epsilon = P[P_PORT_WIDTH + to] if i < N_PLENUM else P[P_GAP_WIDTH]
                    if RESISTED == 1:
                        to = to if i < N_PLENUM else BEYOND + i - N_PLENUM
                    if PULSATING == 0:
                        opening_slopes(area, darea, j, to, epsilon, context, d, ds)
                    if PULSATING == 1:
                        pulsating_slopes(area, darea, j, to, epsilon, delta, E, E_next, context, d, ds)
                    if FILMED == 1 and i >= N_PLENUM:
                        gap = i - N_PLENUM
                        if PULSATING == 0:
                            film_beyond(gap, area, darea, j, R, R, R_DISCHARGE, delta, context, d, ds)
                        if PULSATING == 1:
                            film_beyond(gap, area, darea, j, E, E_next, ALL_LINES + R_DISCHARGE, delta, context, d, ds)
    if PORTED == 1:
        n_cols = n_all + 1
        for j in range(CHAMBERS):
            at = j * n_sums + PORT_OIL * width + 2
            own = ds + (j * n_cols + j * N) * n_sums + PORT_OIL * width + 2
            over_phi = ds + (j * n_cols + n_all) * n_sums + PORT_OIL * width + 2
            first = d + j * N * PLACE
            oil_slopes(E, E_next, j * size, delta, places, j * PLACE, P, TAB, work, at, first, own, n_sums, over_phi)
            if DISSOLVES == 1:
                e = j * size
                row = j * PLACE
                release_slopes(
                    y, j * N, E, E_next, e, delta, places, row, P, TAB, work, at, first, own, n_sums, over_phi
                )
    total_rates(y, E, P, R, places, work, f, g)
    for c in range(CHAMBERS):
        for k in range(N):
            column(y, E, c, k, context, d, ds, spare, f, g, J, Jq)
    angle_columns(y, E_next, delta, context, ds, f, g, f_phi, g_phi)


@kernel
def angle_columns(y, E_next, delta, context, ds, f, g, f_phi, g_phi):
    """Fill ∂f/∂φ and ∂g/∂φ of all chambers, from the surroundings at φ + delta; the sums are used up."""
    P, _TAB, R, places, _changed, work = context
    width = WIDTH
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    for j in range(CHAMBERS):
        for i in range(n_sums):
            work[j * n_sums + i] += delta * work[ds + (j * n_cols + CHAMBERS * N) * n_sums + i]
    total_rates(y, E_next, P, R, places, work, f_phi, g_phi)
    for i in range(CHAMBERS * N):
        f_phi[i] = (f_phi[i] - f[i]) / delta
    for i in range(Q_STREAMS + n_sums + 1):
        g_phi[i] = (g_phi[i] - g[i]) / delta


@kernel
def column(y, E, c, k, context, d, ds, spare, f, g, J, Jq):
    """Fill the column of state k of chamber c: its own first law differenced, the others' linear in their streams."""
    P, _TAB, R, places, changed, work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    n_sums = CATEGORIES * width
    n_cols = CHAMBERS * N + 1
    col = c * N + k
    delta = perturbation(y, c * N, k)
    first = c  # of the chambers whose streams the state touches
    last = c
    for r in range(CHAMBERS):
        sums = ds + (r * n_cols + col) * n_sums
        for i in range(n_sums):
            if work[sums + i] != 0.0:
                first = min(first, r)
                last = max(last, r)
    for i in range(n_sums):
        total = 0.0
        for r in range(first, last + 1):
            total += work[ds + (r * n_cols + col) * n_sums + i]
        Jq[Q_STREAMS + i, col] = total / P[P_OMEGA]
        if i == BETWEEN * width or (OWN_PLENUMS > 0 and i >= 2 * FIRST_OWN * width and i % width == 0):
            crossing = 0.0
            for r in range(first, last + 1):
                if side_of(r, P) == 0:
                    crossing += work[ds + (r * n_cols + col) * n_sums + i]
            if i == BETWEEN * width:
                Jq[Q_STREAMS + n_sums, col] = crossing / P[P_OMEGA]
            if OWN_PLENUMS > 0 and i >= 2 * FIRST_OWN * width:
                Jq[Q_STREAMS + n_sums, col] += crossing / P[P_OMEGA]
    if ACROSS == 1:
        for r in range(CHAMBERS):
            Jq[Q_STREAMS + n_sums, col] += sideways(r, work, ds + (r * n_cols + col) * n_sums, P) / P[P_OMEGA]
    base = work[spare : spare + N + 2]
    new = work[spare + N + 2 : spare + 2 * N + 4]
    if WALLS > 0:
        base = work[spare : spare + N + Q_STREAMS]
        new = work[spare + N + Q_STREAMS : spare + 2 * (N + Q_STREAMS)]
    row = places[CHAMBERS * PLACE :]
    for r in range(CHAMBERS):
        if r < first or r > last:
            for i in range(N):
                J[r * N + i, col] = 0.0
            continue
        for i in range(N):
            changed[i] = y[r * N + i]
        e = r * size
        for i in range(PLACE):
            row[i] = places[r * PLACE + i]
        sums = ds + (r * n_cols + col) * n_sums
        if r == c:  # what the chamber adds to work and heat of all
            clear_heads(base)
            finish(changed, 0, E, e, row, 0, R, P, work, r * n_sums, base, base[N:])
            changed[k] += delta
            for i in range(PLACE):
                row[i] += delta * work[d + col * PLACE + i]
        for i in range(n_sums):
            work[sums + i] = work[r * n_sums + i] + delta * work[sums + i]
        clear_heads(new)
        finish(changed, 0, E, e, row, 0, R, P, work, sums, new, new[N:])
        for i in range(N):
            J[r * N + i, col] = (new[i] - f[r * N + i]) / delta
        if r == c:
            Jq[Q_WORK, col] = (new[N] - base[N]) / delta
            Jq[Q_HEAT, col] = (new[N + 1] - base[N + 1]) / delta
            if WALLS > 0:
                for i in range(Q_WALLS, Q_STREAMS):
                    Jq[i, col] = (new[N + i] - base[N + i]) / delta


@kernel
def clear_heads(filled):
    """Set to zero what stands behind N rates: work, heat and the like."""
    filled[N] = 0.0
    filled[N + 1] = 0.0
    if WALLS > 0:
        for i in range(Q_WALLS, Q_STREAMS):
            filled[N + i] = 0.0


@kernel
def no_knot(phi, y, context):
    """Leave the states alone: the only jump, oil injection, lies at the border between two pitches."""


@kernel
def all_error_size(y0, y1, error, context):
    """Return the size of a step's error, the largest of all chambers."""
    P, _TAB, _R, places, _changed, _work = context
    worst = 0.0
    if VOLUMED == 1:
        for j in range(CHAMBERS):
            if locked(y1, j * N, P):
                return IMPOSSIBLE
    for j in range(CHAMBERS):
        worst = max(worst, relative_error(y0, y1, error, j * N, places, j * PLACE))
    return worst


@kernel
def all_share_in_phase(y, y1, u, rtol, context):
    """Return the share of a step after which the first chamber leaves its phase (`places.share_before_border`)."""
    _P, _TAB, _R, places, _changed, _work = context
    share = 1.0
    for j in range(CHAMBERS):
        held = places[(CHAMBERS + 1) * PLACE + j]
        steep = places[j * PLACE + TPT] / places[j * PLACE + PRESSURE]
        share = min(share, share_before_border(held, y, y1, u, j * N, steep, rtol))
    return share


@kernel
def all_conserve(y, y1, E, E_next, context, dq):
    """Let the mass balances of a step set the flows through the ports, as `chamber.conserve` does.

    Chambers before the injection angle are the suction side, the others the discharge side.
    """
    P, TAB, R, places, _changed, _work = context
    size = E_AREAS + N_PLENUM + N_GAPS
    width = WIDTH
    crossing = dq[Q_STREAMS + CATEGORIES * width]
    for side in range(2):
        at = Q_STREAMS + (SUCTION_IN + 2 * side) * width
        defect = -dq[at] - dq[at + width] - (crossing if side == 0 else -crossing)
        if OWN_PLENUMS > 0 and side == 1:  # what crosses holds what comes from own plenums to the suction side
            for c in range(2 * FIRST_OWN, CATEGORIES):
                defect -= dq[Q_STREAMS + c * width]
        widest = 0.0
        open_one = 0
        if ACROSS == 1:
            line = side
        for j in range(CHAMBERS):
            if side_of(j, P) == side:
                e = j * size
                if VOLUMED == 0:
                    defect += y1[j * N + 1] * E_next[e + E_VOLUME] - y[j * N + 1] * E[e + E_VOLUME]
                else:
                    defect += gas_mass(E_next[e + E_VOLUME], y1[j * N + 1], y1[j * N + 3], P)
                    defect -= gas_mass(E[e + E_VOLUME], y[j * N + 1], y[j * N + 3], P)
                for i in range(N_PLENUM):
                    area = E[e + E_AREAS + i] + E_next[e + E_AREAS + i]
                    if PLENUM[i] == side and area > widest:
                        widest = area
                        open_one = j
                        if ACROSS == 1:
                            line = side
                    if ACROSS == 1 and PLENUM[i] == 1 - side and area > widest:
                        widest = area
                        open_one = j
                        line = 1 - side
        if ACROSS == 1:
            at = Q_STREAMS + (SUCTION_IN + 2 * line) * width  # pyright: ignore[reportPossiblyUnboundVariable]
        if widest > 0.0:
            if dq[at] + dq[at + width] >= 0.0:
                if ACROSS == 0:
                    add_stream(dq, at, defect, R, R_DISCHARGE * side)
                if ACROSS == 1:
                    b = R_DISCHARGE * line  # pyright: ignore[reportPossiblyUnboundVariable]
                    add_stream(dq, at, defect, R, b)
            else:
                fill_place(
                    places[(CHAMBERS + 1) * PLACE + open_one], y1, open_one * N, P, TAB, places, open_one * PLACE
                )
                add_stream(dq, at + width, defect, places, open_one * PLACE)


@kernel
def sideways(j, sums, at, P):
    """Return the gas that the sums of both lines count to the side of the chambers on which chamber j is not.

    What comes from the discharge line into one before the injection angle, less what comes from the suction line into
    one beyond it: the sum of the suction line and this make what enters the chambers before it.
    """
    width = WIDTH
    if side_of(j, P) == 0:
        return sums[at + DISCHARGE_IN * width] + sums[at + (DISCHARGE_IN + 1) * width]
    return -sums[at + SUCTION_IN * width] - sums[at + (SUCTION_IN + 1) * width]


@kernel
def side_of(j, P):
    """Return 0 for a chamber before the injection angle, 1 for one beyond it."""
    return 0 if (j + 0.5) * P[P_PITCH] < P[P_INJECTION] else 1


@kernel
def no_places(step, dense, context):
    """Leave the places: they are filled when the pitch becomes a life (`places.places_along`)."""
