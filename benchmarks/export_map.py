"""Compare an exported map's compiled C with the simulator at 200 random points inside, and time calls of it and of
the same map in Python.

    python benchmarks/export_map.py [SCENE [ERROR]]

The map is over evaporating and condensing temperature and speed of the R134a machine. Times are those of the thread.
"""

from __future__ import annotations

import ctypes
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from screwsim.export.fmu import compile_shared, source_files
from screwsim.export.map_table import MapTable
from screwsim.export.source import DEFAULT_ERROR, map_of
from screwsim.export.table import scales
from screwsim.scene import load, with_values
from screwsim.simulate import simulate_many

ROOT = Path(__file__).parents[1]
OVER = (
    "operation.evaporating_temperature=-10 degC..10 degC",
    "operation.condensing_temperature=30 degC..50 degC",
    "operation.speed=2000 rpm..4000 rpm",
)
POINTS, CALLS = 200, 100_000
TIMED = """\
#include "map.h"
#include <time.h>
#define EXPORT __attribute__((visibility("default")))
EXPORT int evaluate(const double *x, double *y) { return map_evaluate(x, y, 0); }
EXPORT double seconds(const double *points, int count, int calls)
{
    double y[MAP_OUTPUTS];
    volatile double kept = 0.0;
    clock_t began = clock();
    int i;
    for (i = 0; i < calls; i++) {
        map_evaluate(points + (i % count) * MAP_INPUTS, y, 0);
        kept += y[0];
    }
    return (double)(clock() - began) / CLOCKS_PER_SEC / calls;
}
"""


def main(scene_file: str = str(ROOT / "configs" / "r134a" / "point.yaml"), error: str = str(DEFAULT_ERROR)) -> None:
    began = time.perf_counter()
    table = map_of(scene_file, OVER, wanted=float(error), jobs=1)
    nodes = " x ".join(str(len(each)) for each in table.grid.nodes)
    print(f"map of {nodes} nodes from {table.cases} cases, {time.perf_counter() - began:.0f} s; error {table.how}")
    library = compiled(source_files(table, "2"))
    low, high = (np.array([getattr(one, end) for one in table.inputs]) for end in ("low", "high"))
    x = np.random.default_rng(2026).uniform(low, high, (POINTS, len(low)))
    scene, paths = load(scene_file), [one.path for one in table.inputs]
    results = simulate_many((with_values(scene, dict(zip(paths, at, strict=True))) for at in x), False)
    true = np.array([[result.performance.get(each.name, np.nan) for each in table.outputs] for result in results])
    y = (ctypes.c_double * len(table.outputs))()
    found, inside = np.empty_like(true), np.empty(POINTS, bool)
    for number, at in enumerate(x):
        inside[number] = library.evaluate((ctypes.c_double * len(at))(*at), y)
        found[number] = y
    errors = np.abs(found - true) / scales(table.outputs, true)
    for i, each in enumerate(table.outputs):
        stated, largest = table.errors[i], np.nanmax(errors[inside, i])
        print(f"{each.name:<24} stated {stated:.1e}   largest at {inside.sum()} of {POINTS} points {largest:.1e}")
    outside = low - 0.1 * (high - low) * np.eye(len(low))
    flags = [library.evaluate((ctypes.c_double * len(at))(*at), y) for at in outside]
    print(f"flags of {len(flags)} points outside: {flags}")
    library.seconds.restype = ctypes.c_double
    flat = (ctypes.c_double * x.size)(*x.ravel())
    one = sorted(library.seconds(flat, POINTS, CALLS) for _ in range(7))[3]
    print(f"one call: {1e6 * one:.2f} us (median of 7 runs of {CALLS} calls)")
    many = np.random.default_rng(2026).uniform(low, high, (CALLS, len(low)))
    print(f"in Python {rate(table, [many]):.0f} points a second at a time, {rate(table, many[:2000]):.0f} one by one")


def rate(table: MapTable, points: Iterable[np.ndarray]) -> float:
    """Return how many points a second of processor time are evaluated by calls with these points."""
    began, count = time.process_time(), 0
    for each in points:
        found = table.evaluate(**dict(zip((one.name for one in table.inputs), each.T, strict=True)))
        count += found[table.outputs[0].name].size
    return count / (time.process_time() - began)


def compiled(sources: dict[str, str]) -> ctypes.CDLL:
    """Return the map as a library with a loop that times it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "map.so"
        path.write_bytes(compile_shared({**sources, "timed.c": TIMED}, ("map.c", "timed.c"), "so"))
        return ctypes.CDLL(str(path))


if __name__ == "__main__":
    main(*sys.argv[1:])
