"""Output on the uncertainty of a scene's figures due to its inputs, beside the numerical error; and that of sweeps."""

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from itertools import compress
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.figures import declared
from screwsim.figures.engineering import engineering, figure_unit, shown_name
from screwsim.figures.errors import error_in_unit
from screwsim.inputs.suggestions import counted
from screwsim.outputs import Result
from screwsim.outputs.derivatives import PACKAGE_FIGURES, usual_figures
from screwsim.outputs.display import picked
from screwsim.printing.tables import plain_table, print_scene_title, print_table, print_text, print_wrapped, wrapped
from screwsim.results.left_out import left_out_words, parts_left_out
from screwsim.results.read import Results
from screwsim.screen import say
from screwsim.study.asked.varied import Varied
from screwsim.study.columns import Column, write_columns
from screwsim.study.uncertainty.sampled import rounding
from screwsim.study.uncertainty.spreads import COVERAGE, FigureUncertainty, Uncertainty

MOST_FIGURES = 3
EFFICIENCY_SUFFIX = "efficiency"
MOST_CONTRIBUTORS = 3  # most contributors named for a figure ...
LEAST_SHARE = 0.01  # ... and their least share of its variance
NEGLIGIBLE = 1e-6  # of a figure: smaller uncertainties are ignored
RANGE_FIGURES = (
    *PACKAGE_FIGURES,
    *("isothermal_efficiency", "isentropic_efficiency", "volumetric_efficiency", "gas_mass_flow", "cooling_capacity"),
    *("cop", "shaft_power", "electrical_power", "intermediate_pressure", "discharge_temperature"),
    *("oil_mass_flow", "work_per_cycle"),
)


def print_uncertainty(result: Result) -> None:
    """Print for the usual figures value, numerical error, uncertainty due to the inputs, and the error of the model.

    The three are independent of each other; below a figure stand the inputs that contribute most to its uncertainty.
    """
    found, model = result.uncertainty.get("figures", {}), result.uncertainty.get("model", {})
    by_model = model.get("figures", {})
    rows, causes = [], []
    every = dict.fromkeys((*RANGE_FIGURES, *by_model))
    for name in (name for name in every if name in found or name in by_model):
        spread = found.get(name, {"expanded": 0.0, "contributors": ()})
        if spread["expanded"] > NEGLIGIBLE * abs(result.performance[name]) or name in by_model:
            rows.append([shown_name(name), *_uncertainty_row(result, name, spread["expanded"], model)])
            causes.append(contributors_text(spread["contributors"]))
    say()
    if rows:
        heads = ["uncertain by", "value", "unit", "numerical", "inputs", "model"]
        kept = [True, True, True, True, bool(found), bool(by_model)]
        table = plain_table([*compress(heads, kept)], [[*compress(row, kept)] for row in rows], 1)
        say("\n".join(table[: -len(rows)]))  # heads take two lines above short names
        for line, text in zip(table[-len(rows) :], causes, strict=True):
            say(line)
            if text:
                say(textwrap.indent(wrapped(f"  {text}"), "  "))
    if found:
        told = f"inputs: half of the 95 % interval (coverage factor {COVERAGE:g}), linear, by their tolerances alone"
        other = "" if model else "; the model's own error comes on top (screwsim validate)"
        print_text(f"{told}; shares are those of the variance{other}")
        lost = left_out_words(list(result.uncertainty["left_out"]))
        print_wrapped([f"warning: the sums of inputs are {lost}, so they are too small"] if lost else [])
    print_wrapped(model_lines(model))


def contributors_text(contributors: Sequence[Mapping[str, Any]]) -> str:
    """Return the inputs that contribute most to a figure's uncertainty, with their shares of its variance."""
    some = [each for each in contributors[:MOST_CONTRIBUTORS] if each["share"] >= LEAST_SHARE]
    paths = (" + ".join(path.replace("effects.", "", 1) for path in each["paths"]) for each in some)
    return ", ".join(f"{path} {each['share']:.0%}" for path, each in zip(paths, some, strict=True))


def by_inputs_line(size: str, spread: FigureUncertainty) -> str:
    """Return what the tolerances of inputs leave uncertain, half of the 95 % interval as text, and most by which."""
    most = contributors_text([each._asdict() for each in spread.contributors])
    return f"  by the inputs' tolerances ± {size} (95 %): {most}"


def _uncertainty_row(result: Result, name: str, expanded: float, model: Mapping[str, Any]) -> list[str]:
    value, about = result.performance[name], declared(name, result.performance)
    factor, unit = figure_unit(about, value)
    error = error_in_unit(name, result.performance, result.error)
    number = f"{value:.2f}" if about.units == "K" else engineering(about, value)[0]
    numerical = "" if error is None else f"± {factor * error:.1g}"
    inputs = f"± {factor * expanded:.2g}" if expanded else ""
    return [number, unit, numerical, inputs, ends_text(name, model, factor)]


def ends_text(name: str, model: Mapping[str, Any], factor: float) -> str:
    """Return the ends of the model's error of a figure; in brackets if the scene lies outside the validated range."""
    told = model.get("figures", {}).get(name)
    if told is None:
        return ""
    text = " … ".join(f"{factor * told[end]:+.2g}" for end in ("low", "high"))
    return f"({text})" if model["outside"] else text


def model_lines(model: Mapping[str, Any]) -> list[str]:
    """Return the lines on the model's error: its source, what is unknown, and whether it applies here."""
    if not model:
        return []
    figures = model["figures"]
    if not figures:
        return [f"model: {model['of']} states no error for any figure of this scene"]
    points = max(figure["points"] for figure in figures.values())
    missing = list(_not_stated({name: figure["not_stated"] for name, figure in figures.items()}))
    lines = [f"model: ours less theirs at the {points} points of {model['of']} not used in any fit, E ± 2 u_val"]
    lines[0] += f"; without {', '.join(missing)}, which the source does not state" if missing else ""
    lines[0] += f". {model['citation']}"
    outside = "(…): found under other conditions than this scene's, as the warning says"
    return [*lines, outside if model["outside"] else "this scene lies within the validated range"]


def _not_stated(missing: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Yield the parts that a source does not state, with the figure's name where it states them of others."""
    for word in dict.fromkeys(word for words in missing.values() for word in words):
        lacking = [shown_name(name) for name, words in missing.items() if word in words]
        yield word if len(lacking) == len(missing) else f"{word} of {' and '.join(lacking)}"


def print_check(scene: Varied, found: Uncertainty) -> None:
    """Print the results of a Sobol sample beside the linear uncertainties, and warn where the latter are wrong."""
    print_scene_title(scene.title)
    say()
    if found.slopes.result.status != "ok":
        print_text(f"no uncertainty: {found.slopes.result.told}")
        return
    if not found.sampled:
        print_text(f"no conclusion from the sample: {found.message or 'it has none of these figures'}")
        return
    rows, wrong = [], []
    for name, sampled in found.sampled.items():
        value = found.slopes.result.performance[name]
        if found.spreads[name].expanded <= max(NEGLIGIBLE * abs(value), rounding(name, value)):
            continue
        factor, unit = figure_unit(declared(name, found.slopes.result.performance), value)
        two = (COVERAGE * found.spreads[name].standard, COVERAGE * sampled.standard)
        shown = [f"{factor * value:.5g}", f"{factor * sampled.mean:.5g}", *(f"± {factor * each:.2g}" for each in two)]
        rows.append([shown_name(name), *shown, unit])
        if sampled.wrong:
            wrong.append(f"warning: the linear estimate is wrong for {shown_name(name)}: {sampled.wrong}")
    if rows:
        print_table(["", "value", "mean", "linear", "sampled", "unit"], rows, 1)
    else:
        say("no figure here depends on the inputs with a tolerance")
    print_text(f"{found.samples} samples (Sobol's sequence) of the inputs within their tolerances")
    if found.message:
        wrong.append(f"warning: mean and spread are those of the others, as {found.message}")
    left_out = (f"warning: the linear estimate lacks {path}: {why}" for path, why in found.left_out.items())
    print_wrapped([*wrong, *left_out])
    if rows and not wrong:
        say("the linear estimate holds for all of these figures")


def write_check(path: Path, found: Uncertainty) -> None:
    """Write a row per figure, as CSV or HDF5: half of the 95 % interval, linear and of the sample, in SI units."""
    names, here = list(found.sampled), found.slopes.result.performance
    ends = {
        "linear": ([found.spreads[name].expanded for name in names], "by the inputs' tolerances, linear"),
        "sampled": ([COVERAGE * found.sampled[name].standard for name in names], "twice the sample's deviation"),
    }
    columns = {
        "figure": Column(names, "", "figure"),
        "units": Column([declared(name, here).units for name in names], "", "SI unit of the figure"),
        "value": Column([here[name] for name in names], "1", "the figure, SI unit"),
        "mean": Column([found.sampled[name].mean for name in names], "1", "mean of the sample, SI unit"),
        **{
            name: Column(values, "1", f"half of the 95 % interval {what}, SI unit")
            for name, (values, what) in ends.items()
        },
        "wrong": Column([found.sampled[name].wrong for name in names], "", "what is wrong with the linear one"),
    }
    write_columns(path, "linear and sampled uncertainties", columns)


def check_document(scene: Varied, found: Uncertainty) -> dict[str, Any]:
    """Return what `sensitivity --check-sobol --json` prints."""
    figures = {name: each._asdict() for name, each in found.sampled.items()}
    return {**found.as_json(), "sampled": {**picked(found, "samples", "message"), "figures": figures}}


def uncertainty_ranges(results: Results) -> dict[str, Any]:
    """Return the part of `sweep --json` on uncertainty: each figure's least and largest half of a 95 % interval [SI].

    It includes the share of each input in the variance, as the mean over the cases. `left_out` has the inputs without
    a derivative in some cases and the number of these, in which all intervals are too small.
    """
    figures, known = {}, results.contributions
    labels = known["contributor"].tolist() if "contributor" in known else []
    for name in results.uncertainty:
        expanded = COVERAGE * results.uncertainty[name]
        there = np.isfinite(expanded)
        if not there.any() or not np.nanmax(expanded):
            continue
        square = np.square(np.nan_to_num(known[name][there]))
        total = square.sum(axis=-1)
        shares = (square[total > 0.0] / total[total > 0.0, None]).mean(axis=0)
        least, largest = float(np.nanmin(expanded)), float(np.nanmax(expanded))
        figures[name] = {"least": least, "largest": largest, "shares": dict(zip(labels, shares.tolist(), strict=True))}
    lost = parts_left_out(results)
    cases = lost.reshape(-1, lost.shape[-1]).sum(axis=0).tolist()
    left_out = {label: count for label, count in zip(labels, cases, strict=True) if count}
    return {"coverage_factor": COVERAGE, "figures": figures, "left_out": left_out}


def ranges_text(found: Mapping[str, Any]) -> str:
    """Return in words the uncertainty of the first figures, and the input that contributes most."""
    parts, lost = [], found["left_out"]
    cases = f" in up to {counted(max(lost.values()), 'case')}" if lost else ""
    without = f"; {left_out_words(list(lost))}{cases}, so too small there" if lost else ""
    names = usual_figures(found["figures"])[:MOST_FIGURES]
    for name in names:
        each = found["figures"][name]
        factor, unit = figure_unit(declared(name), each["largest"])
        unit = "points" if unit == "%" and name.endswith(EFFICIENCY_SUFFIX) else unit
        low, high = (f"{factor * each[end]:.2g}" for end in ("least", "largest"))
        reach = f"± {low}" if low == high else f"± {low} to {high}"
        parts.append(f"{shown_name(name)} {reach} {unit}".strip())
    if not parts:
        return f"none of the usual figures (all are in group uncertainty of the file){without}"
    shares = found["figures"][names[0]]["shares"]
    path, share = max(shares.items(), key=lambda item: item[1])
    most = f"{path.replace('effects.', '')} causes {share:.0%} of the first one's variance"
    return f"{'; '.join(parts)} (95 %, linear; {most}; all in the file){without}"
