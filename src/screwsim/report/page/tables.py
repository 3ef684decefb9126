"""The page's words and tables: cases, figures, balances with their bounds, best evaluations, origin of the results."""

import hashlib
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from screwsim.figures.engineering import engineering, figure_text, shown_name
from screwsim.inputs.suggestions import counted
from screwsim.outputs import BALANCE, STATUSES
from screwsim.outputs.customary import small_number_text
from screwsim.report.families import efficiency_name
from screwsim.report.front import front_of, objective_names
from screwsim.report.page.data import BALANCES, Selection
from screwsim.report.page.uncertain import half_of, half_text
from screwsim.report.quantities import is_numeric, shown_axis, value_of
from screwsim.results import Results
from screwsim.results.optimum import AIM, ERROR
from screwsim.results.schema import quantities_along
from screwsim.results.warning_kinds import cases_with_warnings, warning_kinds
from screwsim.screen import printable

MOST_KINDS = 8  # of warnings, listed for a sweep
MOST_BEST = 12  # evaluations of a front that are shown, evenly spread along its first objective; all are in the file
VERDICTS = {True: "kept", False: "exceeded"}
_VERSIONS = ("python_version", "numpy_version", "scipy_version", "llvmlite_version", "coolprop_version")


class BalanceCheck(NamedTuple):
    """One residual: its name, the largest over all cases, its bound, and whether that was kept."""

    what: str
    largest: str
    bound: str
    verdict: str


class BestTable(NamedTuple):
    """The best of an optimisation: what was sought, heads with classes and rows of a table, and a line below it."""

    sought: str
    heads: list[tuple[str, str]]
    rows: list[list[str]]
    note: str


def counts(results: Results) -> list[tuple[str, int]]:
    """Return the non-zero numbers of cases by status; cases with warnings are separate from those plainly ok."""
    warned = int(np.count_nonzero(cases_with_warnings(results) & (results.status == "ok")))
    words = (*STATUSES, "not_computed")
    found = {word.replace("_", " "): int(np.count_nonzero(results.status == word)) for word in words}
    found = {"ok": found.pop("ok") - warned, "ok with warnings": warned, **found}
    return [(word, count) for word, count in found.items() if count]


def warnings(results: Results) -> tuple[str, list[str]]:
    """Return the heading of the warnings, and a line for each kind of them; both empty without any."""
    found, cases = warning_kinds(results), int(np.count_nonzero(cases_with_warnings(results)))
    if not results.axis_list:
        return (f"{len(found)} warnings" if len(found) > 1 else "Warning" if found else ""), [k.text for k in found]
    lines = [f"{counted(kind.cases, 'case')}: {kind.text}" for kind in found[:MOST_KINDS]]
    if len(found) > MOST_KINDS:
        lines.append(f"{len(found) - MOST_KINDS} other kinds of warnings (see the file)")
    whole = f"{cases} of {results.status.size} cases {'warns' if cases == 1 else 'warn'}"
    return (whole if cases else ""), lines


def axes(results: Results) -> Iterator[str]:
    """Yield a line about each axis of a sweep: its name, its number of values, and their range."""
    for axis in quantities_along(results.axis_list):
        count = f"{len(axis.values)} values" if len(axis.values) > 1 else "one value"
        if not is_numeric(axis):
            yield f"{axis.path}: {count}: {', '.join(str(value) for value in axis.values)}"
            continue
        how, ends = shown_axis(axis), (int(np.argmin(axis.values)), int(np.argmax(axis.values)))
        low, high = (value_of(axis, end).rpartition(" = ")[2] for end in ends)
        yield f"{how.words}: {count}, {low} to {high}" if low != high else f"{how.words}: {low}"
    if not objective_names(results):
        joined = (axis for axis in results.axis_list if axis.joined)
        yield from (f"{len(axis.values)} cases in which these vary together" for axis in joined)


def figures(results: Results, index: tuple[int, ...]) -> list[tuple[str, str, str, str, str]]:
    """Return name, number, unit and estimated error of each figure of one case, as in the table of `run`.

    The last is half the interval due to the inputs' tolerances, in the unit of the number.
    """
    rows = []
    for name in results.figures:
        value, error = (float(each[name][index]) for each in (results.performance, results.error))
        if np.isfinite(value):
            written, half = engineering(results.figure(name), value), float(half_of(results, name)[index])
            told = small_number_text(error) if np.isfinite(error) else ""
            rows.append((shown_name(name), *written, told, half_text(half, value, written)))
    return rows


def ranges(results: Results) -> Iterator[tuple[str, str, str, str, str]]:
    """Yield name, lowest, highest, largest estimated error and interval due to the inputs of each figure."""
    there = results.status != "failed"
    for name in results.figures:
        values, about = np.where(there, results.performance[name], np.nan), results.figure(name)
        finite = values[np.isfinite(values)]
        if finite.size:
            low, high = (figure_text(about, float(end)) for end in (finite.min(), finite.max()))
            errors = results.error[name][np.isfinite(results.error[name]) & there]
            half = half_of(results, name)
            where, most = int(np.argmax(np.nan_to_num(half))), ""
            if np.isfinite(half.flat[where]):
                number, unit = engineering(about, float(values.flat[where]))
                text = half_text(float(half.flat[where]), float(values.flat[where]), (number, unit))
                most = f"{text} {'K' if unit.startswith('K') else unit}".strip()
            yield shown_name(name), low, high, small_number_text(float(errors.max())) if errors.size else "", most


def checks(results: Results) -> Iterator[BalanceCheck]:
    """Yield the largest residual of each balance over all closed cases, against its bound; then the largest error."""
    for stage, own in results.stages.items():
        yield from (check._replace(what=f"{stage} stage: {check.what}") for check in checks(own))
    closed = results.status == "ok"
    for name in (name for name in BALANCES if name in results.balance):
        values = np.where(closed, results.balance[name], np.nan)
        there = np.isfinite(values)
        if there.any():
            bound = results.balance["bound"]
            kept = bool(np.all(values[there] <= bound[there]))
            largest, most = (small_number_text(float(each[there].max())) for each in (values, bound))
            yield BalanceCheck(BALANCE[name].long_name, largest, most, VERDICTS[kept])
    wanted = results.accuracy
    bounds = np.where(wanted > 0.0, wanted, 1.0)
    every = {name: np.where(closed, results.error[name], np.nan) for name in results.error}
    known = {name: errors for name, errors in every.items() if np.isfinite(errors).any()}
    shares = [(float(np.nanmax(errors / bounds)), name, errors) for name, errors in known.items()]
    if shares:
        share, name, errors = max(shares, key=lambda each: each[0])
        worst = np.nanargmax(errors / bounds)
        words = f"largest estimated error of a figure beside its accuracy ({shown_name(name)})"
        bound = float(wanted.flat[worst])
        told = (small_number_text(bound), VERDICTS[share <= 1.0]) if np.isfinite(bound) else ("", "")
        yield BalanceCheck(words, small_number_text(float(errors.flat[worst])), *told)


def headline_efficiency(results: Results) -> str:
    """Return the best efficiency of a sweep, or that of a run, in one sentence; empty without one."""
    name = efficiency_name(results)
    if name is None:
        return ""
    score = np.where(results.status == "ok", results.performance[name], np.nan)
    if not np.isfinite(score).any():
        return ""
    best = np.unravel_index(int(np.nanargmax(score)), results.shape)
    text = f"{shown_name(name)} {' '.join(engineering(results.figure(name), float(score[best])))}"
    where = ", ".join(_plain(value_of(axis, int(i))) for axis, i in zip(results.axis_list, best, strict=True))
    return f"Best {text} at {where}" if where else text[0].upper() + text[1:]


def _plain(text: str) -> str:
    """Return a text without the markup of mathematical symbols."""
    for mark in ("$", "\\mathrm", "\\Delta ", "{", "}", "_"):
        text = text.replace(mark, "")
    return text


def provenance(results: Results) -> list[tuple[str, str]]:
    """Return the origin of the file: program, scene, time, versions, and the file's own digest."""
    about = results.attributes
    versions = ", ".join(f"{name.removesuffix('_version')} {about[name]}" for name in _VERSIONS if name in about)
    with results.path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    rows = [
        ("file", printable(results.path.name)),
        ("SHA-256 of the file", digest),
        ("SHA-256 of the scene", str(about.get("scene_sha256", ""))),
        ("fingerprint of the results", str(about.get("screwsim_fingerprint", ""))),
        ("written by", str(about.get("source", ""))),
        ("versions", versions),
        ("history", str(about.get("history", ""))),
        ("effects", str(about.get("effects", "")).replace("_", " ")),
        ("states", str(about.get("states", "")).replace("_", " ")),
        ("layout", f"netCDF-4 in HDF5, {about.get('Conventions', '')}, schema {about.get('screwsim_schema', '')}"),
    ]
    return [(what, text) for what, text in rows if text]


def notes(results: Results, shown: Selection) -> list[str]:
    """Return what the page leaves out of a large file, and the first message of a failed case."""
    strides = zip(results.axis_list, shown.strides, strict=True)
    thinned = [f"one in {stride} values of {axis.path}" for axis, stride in strides if stride > 1]
    lines = [f"This page shows {' and '.join(thinned)}; all are in the file."] if thinned else []
    failed = np.flatnonzero(results.status.reshape(-1) == "failed")
    if failed.size:
        first = str(np.asarray(results.messages).reshape(-1)[failed[0]]).splitlines()
        lines.append(f"{failed.size} cases failed; the first says: {first[0] if first else 'nothing'}")
    return lines


def best_table(results: Results) -> BestTable:
    """Return what an optimisation sought and found."""
    names, front = objective_names(results), front_of(results)
    evaluations, *points = results.axis_list
    varied = [axis for axis in quantities_along([evaluations]) if is_numeric(axis)]
    spread = np.linspace(0, len(front) - 1, min(len(front), MOST_BEST)).round().astype(int)
    shown = front[spread]
    words = [shown_axis(axis) for axis in varied]
    heads = [(head, "n") for head in (*map(shown_name, names), "error", *(how.words for how in words), "evaluation")]
    rows = [
        [
            *(figure_text(results.figure(name), float(results.optimum[AIM + name][int(row)])) for name in names),
            f"{_largest_error(results, names, int(row)):.0e}",
            *(how.value(float(axis.values[row])).rpartition(" = ")[2] for how, axis in zip(words, varied, strict=True)),
            str(row),
        ]
        for row in shown
    ]
    some = f"{len(shown)} of the {len(front)}" if len(shown) < len(front) else f"the {len(front)}"
    many = f"{some} evaluations that no other beats in all aims; " if len(names) > 1 else ""
    over = f" over {len(points[0].values)} operating points" if points and len(points[0].values) > 1 else ""
    lowest = [results.optimum.about[AIM + name].long_name.endswith("lowest") for name in names]
    senses = zip(names, lowest, strict=True)
    wanted = " and ".join(f"{'lowest' if least else 'highest'} {shown_name(name)}" for name, least in senses)
    sought = f"Search for the {wanted}{over}, {len(evaluations.values)} evaluations"
    return BestTable(sought, heads, rows, f"{many}error: estimated numerical error of an aim, relative")


def _largest_error(results: Results, names: list[str], row: int) -> float:
    """Return the largest relative error among the objectives of an evaluation."""
    sizes = ((results.optimum[ERROR + name][row], abs(results.optimum[AIM + name][row])) for name in names)
    return max((float(error / size) for error, size in sizes if size), default=0.0)
