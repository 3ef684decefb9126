"""Print cost and errors of the predefined blends, compared with R134a and CoolProp.

Run: python benchmarks/blends.py [-o PAGE.md] [NAME ...]. Without names: all for which CoolProp has data, which takes
some minutes the first time. Times are those of `properties.py`, as multiples of R134a's state measured beside each;
compare ratios. Errors are the largest over 0.5-40 bar from the dew point (or 1.02 of the highest temperature of two
phases) to 150 C, at the same temperature and density; those of dew and bubble pressure are against CoolProp's flashes
at -20, 2 and 45 C where they converge. With `--points` it prints instead the processor time and the evaluations of
configs/r454b/point.yaml on some blends, as multiples of R134a's.
"""

from __future__ import annotations

import sys
import time
from math import log, sqrt
from pathlib import Path
from typing import Any

import CoolProp.CoolProp as coolprop
import numpy as np
from properties import loop_cost

from screwsim.codegen.modules import for_speed
from screwsim.cycle.close import close
from screwsim.cycle.guess import lease_for
from screwsim.cycle.problem import ClosingTask, Problem, problem_of
from screwsim.fluid import constants
from screwsim.fluid.composition import composition, predefined
from screwsim.fluid.description import Description, describe
from screwsim.fluid.real_gas import RealGas
from screwsim.fluid.saturation import saturation
from screwsim.inputs.faults import UsageError
from screwsim.scene import load

POINT = Path(__file__).resolve().parent.parent / "configs" / "r454b" / "point.yaml"
RUNS = 25
POINTS = ("R134a", "R454B", "R513A", "R407C.mix", "R448A")
HEAD = """\
# Blends

Made by `python benchmarks/blends.py -o docs/reference/blends.md`: every predefined mixture of CoolProp {version} for
whose pairs it has data, by the name to write as `gas.fluid`. Names with `.mix` are those whose short name is a
pseudo-pure fluid's. Time: that of one state (p, h, c_v, T ∂p/∂T, 1/k, choking) as a multiple of R134a's ({ns:.0f} ns)
measured beside it; on a shared machine, good to some tenths. Errors: the largest of p, c_v and w (relative), h (over
R T) and s (over R, but for what CoolProp's own misses Maxwell's relation by, M311: 1e-6 and less times ln δ) against
CoolProp at equal temperature and density; and of dew and bubble pressure against those of CoolProp's flashes that
converge, with their number of six. T_m: the highest temperature of two phases, or *gas from* the temperature from which
the blend is known, as a gas only (M317); T_max: the least of the components' highest temperatures, beyond which a cycle
is refused. Glide: dew less bubble temperature at the dew pressure of 45 °C, or of 0.8 T_m where that is lower.

| blend | components | time | equation's error | dew and bubble | glide | T_m | T_max |
|---|---|---|---|---|---|---|---|
"""
BAR = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0)
FLASHES = (253.15, 275.15, 318.15)  # [K]


def reference(known: Description) -> Any:
    """Return CoolProp's state of a blend."""
    state = coolprop.AbstractState("HEOS", "&".join(known.components))
    state.set_mole_fractions(list(known.fractions))
    return state


def inconsistent(known: Description) -> float:
    """Return by how much the weights of CoolProp's ideal parts miss 1, and thus its entropy its pressure (M311)."""
    parts = [describe(name) for name in known.components]
    weights = (x * one.R * one.molar_mass for x, one in zip(known.fractions, parts, strict=True))
    return sum(weights) / (known.R * known.molar_mass) - 1.0


def equation_error(name: str, gas: RealGas) -> float:
    """Return the largest error of p, c_v, w, h and s."""
    state, found, worst = reference(gas.known), saturation(name), 0.0
    state.specify_phase(coolprop.iphase_gas)
    for p in (1e5 * bar for bar in BAR):
        T_dew = gas.saturation_temperature(p)
        first = 1.02 * found.T_c if T_dew is None else T_dew + 0.1
        for T in np.linspace(first, max(423.15, 1.1 * first), 6):
            rho = gas.density(p, float(T))
            state.update(coolprop.DmassT_INPUTS, rho, float(T))
            ours, h, c_v, _, a, *_ = gas.state(float(T), rho)
            off = [ours / state.p() - 1.0, c_v / state.cvmass() - 1.0]
            off += [sqrt(ours / (rho * a)) / state.speed_sound() - 1.0]
            s = gas.specific_entropy(float(T), rho) - gas.R * inconsistent(gas.known) * log(rho / gas.known.rho_r)
            off += [(h - state.hmass()) / (gas.R * T), (s - state.smass()) / gas.R]
            worst = max(worst, *map(abs, off))
    return worst


def flash_error(name: str, known: Description) -> tuple[float, int]:
    """Return the largest relative difference of dew and bubble pressures, and how many flashes converge."""
    state, worst, count = reference(known), 0.0, 0
    for T in FLASHES:
        for quality, ours in ((1.0, constants.dew_pressure), (0.0, constants.bubble_pressure)):
            try:
                wanted = ours(name, T)
                state.update(coolprop.QT_INPUTS, quality, T)
            except (UsageError, ValueError):
                continue
            if np.isfinite(state.p()):
                worst, count = max(worst, abs(wanted / state.p() - 1.0)), count + 1
    return worst, count


def least(gas: RealGas, T: float, rho: float) -> float:
    """Return the shortest of several times of one state [ns]."""
    return min(loop_cost(gas.state, T, rho) for _ in range(4))


def row(name: str) -> str:
    """Return the table row of a blend."""
    gas = RealGas(name)
    known, lines = gas.known, saturation(name)
    rho = 0.5 * gas.density(2e5, max(300.0, 1.02 * lines.T_c))
    cost = least(gas, max(300.0, 1.02 * lines.T_c), rho) / least(RealGas("R134a"), 300.0, 10.0)
    off, count = flash_error(name, known)
    T = max(min(318.15, 0.8 * lines.T_c), 1.001 * lines.T_low)
    try:
        glide = f"{T - constants.condensed(name, T):.2f} K"
    except UsageError:  # a wide boiling range, of which a narrow part is covered
        glide = "–"
    parts = ", ".join(known.components)
    dew = f"{off:.0e} of {count}" if count else "none of them converges"
    error = equation_error(name, gas)
    ends = f"{glide} | {'gas from ' if lines.always_gas else ''}{lines.T_c:.2f} K | {known.T_max:g} K"
    return f"| {name} | {parts} | {cost:.1f} | {error:.0e} | {dew} | {ends} |"


def closing(problem: Problem) -> tuple[float, int]:
    """Return the processor time [ms] of one closing of a cycle, and its evaluations."""
    machinery = lease_for(problem)
    before, started = machinery.counts.copy(), time.process_time()
    close(ClosingTask(problem, machinery, problem.criteria))
    return 1e3 * (time.process_time() - started), int((machinery.counts - before)[2])


def points() -> None:
    """Print the least of several processor times of a point on some blends, compared with R134a; blends take turns."""
    problems = {name: problem_of(load(str(POINT), overrides=[f"gas.fluid={name}"])) for name in POINTS}
    rounds = [{name: closing(problem) for name, problem in problems.items()} for _ in range(RUNS)]
    base, base_evaluations = min(one["R134a"] for one in rounds)
    for name in POINTS:
        least_time, evaluations = min(one[name] for one in rounds)
        times, more = least_time / base, evaluations / base_evaluations
        print(f"{name:<12}{least_time:>8.2f} ms {times:>6.2f} times {evaluations:>8} evaluations {more:>6.2f} times")


@for_speed()
def main() -> None:
    """Print the table, or write it to a page."""
    words = sys.argv[1:]
    if "--points" in words:
        points()
        return
    page = Path(words[words.index("-o") + 1]) if "-o" in words else None
    names = [word for word in words if word != "-o" and (page is None or word != str(page))] or sorted(predefined())
    base = least(RealGas("R134a"), 300.0, 10.0)
    rows, without = [], {}
    for name in names:
        started = time.perf_counter()
        try:
            composition(name)
            rows.append(row(name))
            print(rows[-1], f"{time.perf_counter() - started:.1f} s", flush=True)
        except UsageError as error:
            without[name] = str(error).removeprefix(f"gas.fluid: {name}: ").partition(";")[0]
            print(name, without[name], flush=True)
    if page is not None:
        text = HEAD.format(version=coolprop.get_global_param_string("version"), ns=base) + "\n".join(rows)
        refused = "\n".join(f"- {name}: {why}" for name, why in without.items())
        page.write_text(f"{text}\n\nRefused, in one line that says why:\n\n{refused}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
