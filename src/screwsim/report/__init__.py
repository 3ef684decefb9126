"""Publication-quality figures from stored results only, as PNG (200 dpi) and vector PDF."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from screwsim.inputs.faults import UsageError

if TYPE_CHECKING:
    from screwsim.figures.indicated import Indicated
    from screwsim.results import Results

__all__ = ["plot"]


def plot(
    path: str | Path,
    folder: str | Path | None = None,
    measured: Indicated | None = None,
    at: Mapping[str, Any] | None = None,
) -> list[str]:
    """Write every figure that a results file has data for, and return the paths of the files.

    `folder` (default: beside the file, named after its stem) is created if missing; pressures `measured` in a chamber
    are drawn beside those of the cycle, which in a sweep is that of the best case, or of the best one `at` values of
    its paths (`Results.showing`). Raise UsageError in one line when the file is not a results file or has nothing
    to draw, or when the folder cannot be written.
    """
    from screwsim.report import cycle, entropy, front, ledger, maps, samples, sweeps
    from screwsim.report.style import write_all
    from screwsim.results import open_results

    path = Path(path)
    results = open_results(path)
    if at:
        results = results.showing(at)
        _check_cycle(path, results)
    kinds = (front, sweeps, samples, maps, cycle, entropy, ledger)
    plans = dict(plan for kind in kinds for plan in kind.plans(results, *([measured] if kind is cycle else [])))
    for stage, own in results.stages.items():
        plans |= {f"{stage}_{name}": drawn for kind in kinds for name, drawn in kind.plans(own)}
    if not plans:
        raise UsageError(f"{path}: has nothing to draw: {_why(results)}")
    return write_all(plans, path.with_suffix("") if folder is None else folder)


def _check_cycle(path: Path, results: Results) -> None:
    """Raise UsageError where the case that is asked for has no cycle to draw."""
    from screwsim.report.trace import best_case

    if results.stages:
        raise UsageError(f"{path}: holds no cycles of the cases of two stages (simulate this one with screwsim run -o)")
    if "angle" not in results.cycle:
        raise UsageError(f"{path}: holds no cycle of a case to draw (write output.keep: cycle in its scene)")
    if best_case(results) is None:
        raise UsageError(f"{path}: holds no cycle of this case, which failed (choose another)")


def _why(results: Results) -> str:
    """Return why a file has nothing to draw, with the remedy."""
    from screwsim.report import front

    if set(results.status.reshape(-1).tolist()) == {"failed"}:
        first = str(results.messages.ravel()[0]).splitlines()
        return f"all cases failed (the first: {first[0] if first else 'no message'})"
    if not results.axis_list:
        return "no cycle (write it with `screwsim run -o`)"
    if front.objective_names(results):
        return "nothing was varied (screwsim report makes a page of its operating points)"
    if any(axis.joined for axis in results.axis_list):
        return "its paths vary together, and none of them is numeric (read it with xarray, or sweep one path)"
    bad = int((results.status != "ok").sum())
    if bad and max(results.shape) > 1:
        few = f"no two points along an axis closed, {bad} of {results.status.size} cases did not, and there is no cycle"
        return f"{few} (sweep other values, or write output.keep: cycle)"
    return "no axis with two or more values, and no cycle (sweep a path, or write output.keep: cycle)"
