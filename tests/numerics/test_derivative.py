"""Derivatives made from a kernel's source are those of the kernel: against differences, for every kernel of scalars."""

from __future__ import annotations

import ast
import importlib
import math
import pkgutil
from functools import cache

import numpy as np
import pytest
from each_row import each_row

from screwsim.fluid.nozzle import choking
from screwsim.model import speed
from screwsim.numerics.derivative import tangent
from screwsim.numerics.kernel import Kernel, Slot, Structure, flatten, kernel
from screwsim.numerics.spline import pack_curve

DRAWS, ENOUGH = 400, 20
STEP = 1e-6  # relative, of the differences: they err by its square and by rounding over it
AGREE = 1e-5
RANGES = {  # where a kernel has no meaning at numbers near one
    "phi": (0.1, 12.0),
    "p": (1e5, 2e6),
    "p_1": (1e5, 2e6),
    "p_2": (1e5, 2e6),
    "p_s": (1e5, 5e5),
    "drop": (-1e5, 1e5),
    "dp": (-1e5, 1e6),
    "width": (10.0, 1e4),
    "T": (250.0, 450.0),
    "T_oil": (270.0, 380.0),
    "x": (0.0, 0.99),
    "a": (0.55, 0.99),
    "a_1": (0.55, 0.99),
    "a_2": (0.55, 0.99),
    "choke": (0.4, 0.5),
    "choke_1": (0.4, 0.5),
    "choke_2": (0.4, 0.5),
    "y": (-0.3, 0.3),
    "k": (1.02, 1.7),
    "log_r": (-1.0, -0.01),
    "reynolds": (20.0, 2e4),
    "transition": (800.0, 6000.0),
    "gap": (2e-5, 1e-4),
    "length": (1e-3, 1e-2),
    "passage": (1e-3, 1e-2),
    "flux": (10.0, 3e3),
    "oil_ratio": (-0.1, 5.0),
    "oil_room": (9e-4, 1.1e-3),
    "density": (2.0, 60.0),
    "viscosity": (1e-5, 2e-2),
    "gas_viscosity": (1e-5, 2e-5),
    "oil_viscosity": (1e-3, 5e-2),
    "oil_density": (800.0, 1100.0),
    "phi_A": (0.5, 6.0),
    "phi_B": (0.5, 3.0),
    "phi_dis": (8.0, 9.0),
    "phi_C": (9.2, 10.0),
    "opens": (1.0, 2.0),
    "full": (2.5, 3.0),
    "falls": (4.0, 5.0),
    "closes": (7.0, 8.0),
    "start": (1.0, 2.0),
    "fall": (4.0, 5.0),
    "end": (7.0, 8.0),
    "pitch": (1.5, 1.6),
    "crank": (0.05, 0.1),
    "rod": (0.3, 0.5),
    "offset": (0.0, 0.02),
    "held": (-1.0, -1.0),
    "sign": (-1.0, 1.0),
    "separator_pressure": (1e6, 2e6),
    "upstream_pressure": (1e6, 2e6),
    "pressure_loss": (0.0, 1e4),
    "bore_diameter": (1e-3, 5e-3),
    "bore_length": (4e-3, 2e-2),
    "diameter": (1e-3, 5e-3),
    "p_sat": (2e6, 3e6),
    "r_A": (0.2, 0.22),
    "r_B": (0.28, 0.3),
    "lean": (0.45, 0.6),
    "lean_plus": (0.45, 0.6),
    "lean_minus": (0.45, 0.6),
    "phi_0": (0.1, 0.3),
    "theta": (-0.1, 0.1),
    "eps": (-0.1, 0.3),
    "slenderness": (2.0, 10.0),
    "lambda_12": (0.5, 0.9),
    "lambda_21": (0.5, 0.9),
    "mass_ratio": (0.1, 0.3),
}
NO_LAWS = {"context", "dense", "which", "near"}  # arguments of what steps over arrays, or searches in a cubic


@cache
def parts_of(source: str) -> tuple[ast.AST, ...]:
    return tuple(ast.walk(ast.parse(source)))


def names_in(item: Kernel) -> set[str]:
    return {node.id for node in parts_of(item.source) if isinstance(node, ast.Name)}


def is_of_scalars(item: Kernel, seen: frozenset[str] = frozenset()) -> bool:
    """Tell whether a kernel and all that it calls take and give numbers alone, as text that stands by itself."""
    known = item.function.__globals__
    if NO_LAWS & set(item.arguments):
        return False
    for node in parts_of(item.source):
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id in item.arguments:
            return False
        if isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store):
            return False
    used = [known.get(name) for name in names_in(item) if name != item.__name__]
    if any(isinstance(one, Slot | Structure) for one in used):
        return False
    inner = [one for one in used if isinstance(one, Kernel)]
    return all(one.__name__ in seen or is_of_scalars(one, seen | {item.__name__}) for one in inner)


def all_kernels() -> dict[str, Kernel]:
    found = {}
    for package in ("fluid", "machine", "effects", "model", "numerics"):
        home = importlib.import_module(f"screwsim.{package}")
        for info in pkgutil.walk_packages(home.__path__, f"{home.__name__}."):
            module = importlib.import_module(info.name)
            for name, item in vars(module).items():
                if isinstance(item, Kernel) and item.function.__module__ == info.name and item.arguments:
                    found[f"{info.name.removeprefix('screwsim.')}.{name}"] = item
    return found


KERNELS = {name: item for name, item in all_kernels().items() if is_of_scalars(item)}


def values_of(answer) -> tuple[float, ...]:
    return answer if isinstance(answer, tuple) else (answer,)


def draw(item: Kernel, random: np.random.Generator) -> list[float]:
    return [float(random.uniform(*RANGES.get(name, (0.5, 2.0)))) for name in item.arguments]


def differences(item: Kernel, arguments: list[float], plain: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the differences to the right and to the left by each argument, one a row, and the steps as a column."""
    steps = [STEP * max(abs(argument), 1e-3) for argument in arguments]

    def moved(sign: float) -> np.ndarray:
        rows = []
        for k, step in enumerate(steps):
            others = list(arguments)
            others[k] += sign * step
            rows.append(values_of(item(*others)))
        return np.array(rows, float)

    column = np.array(steps)[:, None]
    return (moved(1.0) - plain) / column, (plain - moved(-1.0)) / column, column


def compared(item: Kernel, both, arguments: list[float]) -> bool:
    """Compare the derivatives with differences; where there is no number, nothing is compared.

    Where the differences to both sides disagree lies a kink, which has no derivative to be compared with.
    """
    try:
        plain = np.array(values_of(item(*arguments)), float)
        found = np.array(values_of(both(*arguments)), float)
        right, left, step = differences(item, arguments, plain)
    except (ValueError, ZeroDivisionError, OverflowError):
        return False  # no number of the kernel's
    if not np.isfinite(plain).all():
        return False
    count = len(plain)
    assert found[:count].tolist() == plain.tolist()
    slope = found[count:].reshape(len(arguments), count)
    size = np.maximum(np.abs(right), np.abs(left))
    noise = 1e-13 * np.abs(plain) / step  # what rounding makes of the value, over the step
    smooth = np.abs(right - left) <= AGREE * size + noise
    off = smooth & ~(np.abs(slope - 0.5 * (right + left)) <= AGREE * size + noise)
    assert [item.arguments[k] for k in np.flatnonzero(off.any(axis=1))] == []
    return True


@pytest.mark.parametrize("name", KERNELS)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_derivative_is_that_of_its_kernel(name):
    item, random = KERNELS[name], np.random.default_rng(7)
    both = tangent(item, item.arguments)
    assert sum(compared(item, both, draw(item, random)) for _ in range(DRAWS)) >= ENOUGH


# ---- laws that read tables, or numbers of the scene --------------------------------------------------------------

TABLES = {"TAB", "P", "curve", "volume_curve", "rest", "first", "count", "pitch"}  # no seeds: where and what is read
OF_TABLES = (
    *(
        "effects.parts.gap.length_area",
        "effects.parts.gap.table_area",
        "fluid.solubility.entropies",
        "fluid.solubility.given_off",
    ),
    *("machine.laws.area", "machine.laws.volume", "machine.laws.volume_slope"),
    *("model.writing_oil.table_content", "numerics.spline.table_value", "numerics.spline.table_slope"),
    *("model.oil_displacement.density_of", "model.oil_displacement.gas_mass", "model.oil_displacement.gas_mass_slope"),
    *("model.oil_displacement.gas_share", "model.pulsation.harmonics", "model.speed.slowness"),
)
TELLING = {  # give a truth, a count or a place, or step over a history
    *("fluid.limits.first_outside", "model.borders.closes", "model.borders.stiff"),
    *("model.oil_displacement.locked", "model.port_states.gas_at_third", "model.port_states.jumps"),
    *("model.port_states.row_of_third", "model.port_states.held_to_a_line", "model.trace.peak_pressure"),
    "model.trace.port_oil",
    *("numerics.history.locate", "numerics.spline.table_interval"),
}
ARRAYS = {"R", "E", "y", "own", "times", "out"}
ROOM = {"P_ROOM": 0}


class Filled:
    """A kernel whose tables and port states are filled in: of its seeds alone."""

    def __init__(self, item: Kernel, random: np.random.Generator) -> None:
        self.arguments = tuple(name for name in item.arguments if name not in TABLES)
        ends = RANGES["p"] if self.arguments == ("p",) else (-3.0, 13.0)
        x = np.linspace(*ends, 40) + 0.2 * (ends[1] - ends[0]) / 40 * random.uniform(-1.0, 1.0, 40)
        curves = [pack_curve(x, random.uniform(0.5, 2.0, 40)) for _ in range(2)]
        data = {"TAB": np.concatenate(curves), "curve": 0, "volume_curve": 0, "rest": len(curves[0])}
        data |= {"P": random.uniform(0.5e-3, 2e-3, 8), "first": 1, "count": 2, "pitch": 1.5}
        if item.__name__ == "slowness":
            wave = 0.3 * np.sin(np.linspace(0.0, 2.0 * math.pi, speed.ROWS))
            data["P"] = speed.curve_of(1.0 + wave, np.gradient(wave, 1.5 / (speed.ROWS - 1)), 1.5)
        both = tangent(item, self.arguments)
        space = {"math": math, "np": np}
        exec("\n".join(flatten((item, both), {}, numbers=ROOM).values()), space)
        self._names, self._data = item.arguments, data
        self._one, self._both = space[item.flat_name], space[both.flat_name]

    def _of(self, function, seeds):
        given = dict(zip(self.arguments, seeds, strict=True)) | self._data
        return function(*(given[name] for name in self._names))

    def __call__(self, *seeds):
        return self._of(self._one, seeds)

    def both(self, *seeds):
        """Return the values and their derivatives by the seeds."""
        return self._of(self._both, seeds)


@pytest.mark.parametrize("name", OF_TABLES)
def test_a_derivative_of_what_reads_a_table_is_that_of_its_kernel(name):
    random = np.random.default_rng(11)
    item = Filled(all_kernels()[name], random)
    assert sum(compared(item, item.both, draw(item, random)) for _ in range(DRAWS)) >= ENOUGH


def test_every_kernel_that_has_derivatives_is_compared():
    """What is left fills arrays, searches, or calls what stands in a generated module alone."""
    kernels = all_kernels()
    assert not {*KERNELS, *TELLING} & {*OF_TABLES} and {*OF_TABLES, *TELLING} <= {*kernels}
    for name in sorted({*kernels} - {*KERNELS, *OF_TABLES, *TELLING}):
        by = tuple(each for each in kernels[name].arguments if each not in TABLES | ARRAYS | {"context", "dense"})
        if by:
            with pytest.raises(TypeError, match="cannot be differentiated"):
                tangent(kernels[name], by)


def test_most_laws_are_kernels_of_scalars():
    """The test above would pass with none to be tested."""
    assert len(KERNELS) > 90
    for name in ("fluid.nozzle.flow", "fluid.gap_flow.mcadams_mixture", "model.balance.temperature_slope"):
        assert name in KERNELS


def test_the_slopes_of_the_nozzle_are_homogeneous_as_its_flow_is():
    """It is of first degree in pressures, densities and width together, and goes by the root of ρ upstream."""
    random, by = np.random.default_rng(3), ("p_1", "p_2", "width", "rho_1", "rho_2")
    flow = KERNELS["fluid.nozzle.flow"]
    both, ways = tangent(flow, by), set()
    for _ in range(DRAWS):
        arguments = dict(zip(flow.arguments, draw(flow, random), strict=True))
        arguments["p_2"] = arguments["p_1"] * (1.0 + float(10.0 ** random.uniform(-6.0, 1.0)))
        if random.random() < 0.5:
            arguments["p_1"], arguments["p_2"] = arguments["p_2"], arguments["p_1"]
        for side in ("1", "2"):
            arguments[f"choke_{side}"], arguments[f"choked_{side}"] = choking(1.0 / arguments[f"a_{side}"])
        ways.add(arguments["p_1"] < arguments["p_2"])
        m, *slopes = both(*arguments.values())
        terms = [arguments[name] * slope for name, slope in zip(by, slopes, strict=True)]
        above, below = (3, 4) if arguments["p_1"] > arguments["p_2"] else (4, 3)
        assert m == pytest.approx(flow(*arguments.values()), rel=1e-15)
        assert sum(terms) == pytest.approx(m, rel=1e-11, abs=1e-11 * max(map(abs, terms)))
        assert terms[above] == pytest.approx(0.5 * m, rel=1e-12) and terms[below] == 0.0
    assert len(ways) == 2


def test_nothing_depends_on_what_is_not_named():
    """A derivative by one argument costs no term of the others."""
    both = tangent(KERNELS["fluid.nozzle.flow"], ("rho_1",))
    assert "__p_1" not in both.source and "__rho_2" not in both.source


@kernel
def stepwise(x, y):
    """Assigns to its arguments, loops, unpacks, and leaves early."""
    y = max(y, 0.25)
    if x < 0.0:
        return -x, y
    total = 0.0
    for i in range(3):
        total += math.sin(i * x) * y
        if total > 2.0:
            break
    x, y = y, x
    y *= x if x > 1.0 else 2.0
    return total * x, abs(y - 1.0) ** 1.5


@each_row("x", [-0.5, 0.3, 1.2, 2.7])
@each_row("y", [0.1, 0.8, 1.9])
def test_statements_of_all_kinds_are_differentiated(x, y):
    found = tangent(stepwise, ("x", "y"))(x, y)
    assert found[:2] == stepwise(x, y)
    right, left, _ = differences(stepwise, [x, y], np.array(found[:2]))
    assert found[2:] == pytest.approx((0.5 * (right + left)).ravel(), rel=1e-8, abs=1e-9)


def test_a_clip_at_its_end_has_the_slope_of_the_side_that_is_taken():
    both = tangent(stepwise, ("y",))
    assert both(-1.0, 0.1)[3] == 0.0
    assert both(-1.0, 0.5)[3] == 1.0


def test_a_root_of_nothing_has_no_infinite_slope():
    """max(0, …) under a root: where it is held at nothing, nothing changes."""
    value, by_ratio = tangent(KERNELS["fluid.gap_flow.volume_share"], ("oil_ratio",))(1e3, 5.0, 1e-3)
    assert (value, by_ratio) == (0.5, 0.0)


@kernel
def writes(x, out):
    out[0] = x
    return x


@kernel
def formats(x):
    return len(str(x)) * x


def test_what_cannot_be_differentiated_is_named():
    with pytest.raises(TypeError, match=r"kernel writes cannot be differentiated: it has 'out\[0\] = x'"):
        tangent(writes, ("x",))
    with pytest.raises(TypeError, match="kernel stepwise has no argument z"):
        tangent(stepwise, ("z",))


@kernel
def weighed(x, P, at):
    """Return a number of an array over the one behind it, weighted."""
    return x * P[at] / P[at + 1]


@kernel
def of_array(x, P):
    """Return what reads an array, itself and through another kernel."""
    total = P[0] * x
    for i in range(2):
        total += weighed(x, P, i + 1)
    return total * P[0]


def test_numbers_of_an_array_are_read():
    P = np.array([2.0, 3.0, 5.0, 7.0])
    by_x = of_array(1.0, P)  # which is linear in x
    assert tangent(of_array, ("x",))(1.5, P) == pytest.approx((1.5 * by_x, by_x), rel=1e-14)
