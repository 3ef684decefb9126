"""The page of the hard cases, from their table and from what random scenes made."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from case import Case
from hard_cases import CASES

OUTCOME = Path(__file__).parent / "fuzz_outcome.json"
OF_FLUIDS = Path(__file__).parent / "fuzz_fluids_outcome.json"
OF_EFFECTS = Path(__file__).parent / "fuzz_effects_outcome.json"
OF_COURSES = Path(__file__).parent / "fuzz_courses_outcome.json"
OF_LAWS = Path(__file__).parent / "metamorphic_outcome.json"
RADAU = Path(__file__).parent / "against_radau.json"
OF_STEPS = 1e-3  # tolerance of a step over the wanted accuracy
COLD = "guess"  # from where Radau begins as the case does
HEAD = """\
# Hard cases

This page shows how stable the solver is. It lists scenes that a user could write and that break simpler programs, and
the outcome of random searches for more. `tests/hard` solves every scene of the table, and checks that

- the status is the one below;
- every number of the result and of its cycle is finite (except for the oil's temperature before it is injected), and
  p, T and m are positive;
- mass and energy close within the wanted accuracy;
- the right-hand side is evaluated at most as often as stated;
- where *Radau* is marked, work and trapped mass equal those of coupled chambers under a tight scipy Radau within the
  wanted accuracy.

How to read the table:

| word | meaning |
|---|---|
| *refused* | a bad scene: exit code 3, with the remedy |
| *failed* | exit code 4, with the angle |
| *(ok)* after another status | the scene is physically possible, but the solver does not reach its cycle yet |
| *start far off* | the first guess of the cycle is multiplied, and all figures come out the same |
| *found* | by random scenes, one case of each kind of failure |

## Further tries

If the first try does not close a cycle, others follow unless `numerics.closing` is `histories`:

- a tighter tolerance of the steps;
- closing without acceleration;
- damped closing, with searches by Newton's method in between;
- a continuation from four times the speed;
- longer searches.

A warning of the result says which try closed the cycle. Another warning says if the machine's own course leads away
from that cycle ([closing.md](closing.md#cycles-that-a-machines-own-course-leaves)). The error of such a cycle is
estimated by closing it again, finer, since one more life shows too little of it. If no try closes the cycle, the
message says how much the states still change and how hot the gas gets.

Scenes that need a further try in spite of Newton's correction have a case below (*closes only …*, *heats …*,
*swings …*). None needs the continuation any more (*closes by Newton, wet*).

## Floors

Quantities that are nearly zero are treated as follows. `tests/hard/test_floors.py` states what each floor changes; none
changes a figure by as much as the wanted accuracy, at ten times its size or a tenth.

| quantity | below | counts as |
|---|---|---|
| oil, when closing and in errors | 1e-4 of the gas | not waited for; its errors are relative to that much |
| work | 1e-6 p V | rounding |
| mass of the oil | – | it carries 1e-12 of the gas's |
| oil below zero | 1e-13 of the gas | rounding |
| oil, in the error of a step | 1e-6 of the gas | its mass as that much; its temperature is scaled down in proportion |

## The cases

This page is `hard_page.page()`; a test compares the two.

| case | status | evaluations, at most | Radau | reason |
|---|---|---|---|---|
"""
STATUSES = ("ok", "not_closed", "failed", "refused", "not finite", "crashed", "hung")
TIGHT = """
`tests/tools/hard_against_radau.py` solves the other cases that are ok by coupled chambers under scipy's Radau, at a
hundredth of the wanted accuracy, with steps of a thousandth of it. It stores in `tests/hard/against_radau.json` how
far work and trapped mass differ: {agree} of {count} by less than the wanted accuracy, the worst by {worst:.2g} times
it ({name}).

{cold} close from the cold guess. Radau does not find the others from there, just as our first try does not find some of
them. For these it starts from where the case itself closed, with fewer digits than required, and has to keep that cycle
or leave it for its own. That proves that the cycle solves the equations, not that it is the only one.

| case | started from | method | difference divided by the accuracy |
|---|---|---|---|
{rows}

{reasons}
"""
REASONS = {
    "a chamber that never opens": "any charge is a cycle of it, so closing has nothing to find. Radau follows all "
    "chambers for one life; they return as they were. There is no work; its difference is relative to m p/ρ.",
    "found: closes by Newton, wet": "the state is next to the critical point. In the last degree the exponent of "
    "the nozzle flow jumps at the phase boundary (M47, M48; k from 0.24 to 0.98, the choked flow by 1.8), and "
    "the slopes on both sides lead to that boundary. The state slides along it, where the equations have no solution "
    "in the classical sense. The steps of Radau and BDF vanish; ours hold the phase and cross, as LSODA's coarser ones "
    "do.",
}
RANDOM = """
## Random scenes

`{command}` draws {scenes} scenes from the space of
`tests/tools/fuzz_space.py` ({versions}): {ok:.1%} are ok. With a real gas, many scenes fail because
it condenses, or gets hotter than its equation allows. The outcome is in `tests/hard/fuzz_outcome.json`, from which this
section is made; the tests draw some 200 other scenes.
"""
FLUIDS = """
## Random scenes of fluids

`{command}` draws {scenes} scenes from the space of
`tests/tools/fluid_space.py` ({versions}). It contains

- three blends, one of them user-defined;
- a fluid at its dew line: a third of these scenes take in saturated vapour, a third gas within a millionth to a kelvin
  of it;
- wet ammonia;
- two wet blends, whose oil may be so cold that gas condenses on it;
- carbon dioxide with a gas cooler.

{ok:.1%} are ok. The others condense where the gas may not or where its two-phase table ends, or get hotter than the
equation allows (that of the blends ends at 410 to 435 K); each of them says so, with its remedy. The outcome is in
`tests/hard/fuzz_fluids_outcome.json`, from which this section is made.
"""
MADE = """
| structure | {names} |
|---|{lines}|
{rows}

- Worst balance of a scene that is ok: mass {mass:.1e}, energy {energy:.1e}; at most {over:.2g} of the requested
  accuracy.
- Most evaluations of the right-hand side: {most:.1e} in all, {most_ok:.1e} for a scene that is ok.
- Further tries needed: {tries}.
- {warned} scenes that are ok warn that the estimated error of a figure is above the wanted accuracy.
- {compared} scenes that are ok were solved again by coupled chambers under scipy's Radau at a thousandth of the
  wanted accuracy. {within} agree in all figures within the accuracy, {three} within three times it; the worst
  differs by {worst:.2g} times. {unwarned} differ by more than the accuracy without a warning; the worst without a
  warning differs by {worst_unwarned:.2g} times. For {no_answer}, Radau gave no answer.
{contradicted}"""


WITH_EFFECTS = """
## Random scenes with all effects

`{command}` draws {scenes} scenes from the space of
`tests/tools/effects_space.py`: few structures, which together contain all {effects} effects, with many numbers for
each. The outcome is in `tests/hard/fuzz_effects_outcome.json`, from which this section is made.

| structure | {names} |
|---|{lines}|
{rows}

- Worst balance of a scene that is ok: {over:.2g} of the wanted accuracy.
- {warned} scenes that are ok warn that the estimated error of a figure is above the wanted accuracy.
- {compared} scenes that are ok were solved again, by coupled chambers at a fiftieth of the wanted accuracy and finer.
  In {within} of them the true error of every figure is within the wanted accuracy, or a warning says that it need not
  be; in {three} it is within three times that, or a warning says so. Without a warning it is at most {worst:.2g} times
  the accuracy.
- The largest true error is in the median {median:.2g} times the largest estimate, and in 95 % at most {of_95:.2g}
  times.
- {no_answer} had no answer: the finer solutions did not close, or differed by more than a tenth of the accuracy.
- In {another}, solutions that start afresh at a finer accuracy reach another cycle of the machine, which has two. Such
  a scene is judged by finer solutions started from its own cycle, which stay on it.

Scene 4 of *gaps full of oil* is a machine with two cycles: its gaps pass oil if the chamber behind holds enough, and
gas if not. It closes at a volumetric efficiency of 57.8 %; started with little oil it stays at one of −24.4 %, and a
warning says so ([closing.md](closing.md#two-cycles-of-one-machine), `tests/hard/test_fuzz_effects.py`).
"""
COURSES = """
## Random courses

`tests/tools/{command}` solves {courses} courses of {kinds} kinds of machines. A course
starts each of its scenes from the cycles before it, as a sweep does; its scenes, {scenes} in all, are drawn far apart.
Each of {compared} that are ok is solved again alone, with a fortieth of the wanted accuracy. {beyond};
the worst is off by {worst} times the accuracy. The outcome is in `tests/hard/fuzz_courses_outcome.json`, from which
this section is made.

| kind | ok | worst, divided by the accuracy |
|---|---|---|
{rows}
"""

LAWS = """
## Laws over random scenes

`tests/tools/{command}` needs no second solver. It

- states random scenes of those kinds of machines in two ways that mean the same: other units, a course backwards, a
  file of one point, chambers closed coupled;
- checks what holds for any machine: a wider gap delivers no more, entropy never decreases, machines of one shape work
  alike, two of them in a row share the pressure ratio equally, air with next to no water is dry air.

Deviations are divided by what the wanted accuracy allows, so that 1 is the bound. A scene that is not ok, that has
warnings, or to which a law does not apply is not checked. Beyond the bound: {beyond}. The outcome is in
`tests/hard/metamorphic_outcome.json`.

| law | drawn | checked | worst, divided by the bound |
|---|---|---|---|
{rows}

`python tests/tools/relations.py --seed 1 --count 100` asks more of more kinds of scenes, those of
`tests/tools/effects_space.py` and of `screwsim new` among them, and holds each pair against the errors that both
results tell. It names effects at the value at which they do nothing, divides gaps in two, writes scenes otherwise,
states what was found, makes machines similar in size, mass and temperature, and gases rare or nearly pure; it solves
points alone, in rows, in lanes, in threads and at other accuracies. Of each result it asks that figures are sums,
quotients, balances and CoolProp's properties of each other, and of its exact derivatives that they add up as dimensions
ask for. It prints pairs that are three times as far apart as they tell, and what fails.
"""

COMMANDS = """
## Commands over random machines

`python tests/tools/fuzz_commands.py --seed 1 --count 40` asks the commands about machines that `screwsim new` writes
for random requests, and about shipped ones, and checks each answer in a second way (`tests/tools/command_laws.py`):
what `find` gives is run; points of a grid do not beat `optimum` or `optimize`; a derivative is the difference of two
fine runs, a band the derivative times the tolerance, a Sobol index their share; rows of a data sheet, nodes of a map
and stages of a plant are run alone; a scene written otherwise gives the same bits. Further laws
(`tests/tools/file_laws.py`) compare maps with numpy's least squares, FMUs with runs at fresh points, what flows between
stages with CoolProp, sizes of a catalogue with runs, and files with themselves. With `--told` it prints each refusal,
for a reader to judge.

`python tests/tools/fuzz_studies.py sweeps --count 40` does the same for sweeps: with two workers, in lanes, stopped and
resumed, and read back from every form. With `fits` it gives points of a machine with known parameters and noise to
`calibrate`, and tells how often the truth lies within the intervals of 90 %.

`python tests/tools/fuzz_fits.py fits --count 20` draws fits with priors, tolerances and correlated groups: chi squared,
standard errors and correlations must be those of a sum of squares written anew. With `plans` the gains must be those of
an information matrix by differences of runs, and no other points better; with `posteriors` the quantiles must be those
of an integral over a grid.
"""


def _with_effects() -> str:
    """Return what random scenes with all effects made, in words."""
    made = json.loads(OF_EFFECTS.read_text(encoding="utf-8"))
    true, counts = made["true"], {**made["structure"], "all": made["status"]}
    shown = [name for name in STATUSES if name in made["status"]]
    return WITH_EFFECTS.format(
        command=made["command"],
        scenes=made["scenes"],
        effects=len([name for name in made["effects"] if "." not in name]),
        names=" | ".join(shown),
        lines="|".join(["---"] * len(shown)),
        rows="\n".join(_row(name, *(count.get(status, 0) for status in shown)) for name, count in counts.items()),
        over=made["worst_balance_over_accuracy"]["value"],
        warned=made["warned"],
        compared=true["compared"],
        within=true["within_or_warned"],
        three=true["compared"] - len(true["beyond_three_times_unwarned"]),
        worst=true["worst_unwarned_over_accuracy"]["value"],
        median=true["true_over_estimate"]["median"],
        of_95=true["true_over_estimate"]["of 95 %"],
        no_answer=true["no_answer"],
        another=len(true["another_cycle"]),
    )


def _courses() -> str:
    """Return what courses of scenes far apart made, in words."""
    made = json.loads(OF_COURSES.read_text(encoding="utf-8"))
    kinds = made["kinds"]
    rows = [row for found in kinds.values() for row in found]
    beyond = [each for row in rows for each in row["beyond"]]
    alone = sum(each["alone"] is not None and each["alone"] > each["wanted"] for each in beyond)
    count = f"{len(beyond)} are" if beyond else "None is"
    told = f"{count} off by more than the accuracy without a warning"
    return COURSES.format(
        command=made["command"],
        courses=len(rows),
        scenes=sum(row["scenes"] for row in rows),
        kinds=len(kinds),
        compared=sum(row["compared"] for row in rows),
        beyond=f"{told}, {alone} of them alone, too" if beyond else told,
        worst=max(row["worst"] for row in rows),
        rows="\n".join(
            _row(name, sum(row["ok"] for row in found), max(row["worst"] for row in found))
            for name, found in kinds.items()
        ),
    )


def _laws() -> str:
    """Return what laws over random scenes made, in words."""
    made = json.loads(OF_LAWS.read_text(encoding="utf-8"))
    laws = made["laws"]
    return LAWS.format(
        command=made["command"],
        beyond=", ".join(
            f"{each['kind']} {each['seed']}, {each['in']}" for found in laws.values() for each in found["beyond"]
        )
        or "none",
        rows="\n".join(
            _row(name.replace("_", " "), found["drawn"], found["asked"], f"{found['worst']:.2g}")
            for name, found in laws.items()
        ),
    )


def _row(*cells: Any) -> str:
    return f"| {' | '.join(str(cell) for cell in cells)} |"


def _random(outcome: Path, head: str) -> str:
    """Return what random scenes made, in words."""
    made = json.loads(outcome.read_text(encoding="utf-8"))
    radau, versions = made["radau"], made["versions"]
    shown = [name for name in STATUSES if name in made["status"]]
    counts = {**made["structure"], "all": made["status"]}
    return (head + MADE).format(
        command=made["command"],
        scenes=made["scenes"],
        versions=", ".join(
            f"{name} {versions[name]}" for name in ("numpy", "numba", "llvmlite", "scipy") if name in versions
        ),
        ok=made["status"]["ok"] / made["scenes"],
        names=" | ".join(shown),
        lines="|".join(["---"] * len(shown)),
        rows="\n".join(
            f"| {name} | {' | '.join(str(count.get(status, 0)) for status in shown)} |"
            for name, count in counts.items()
        ),
        mass=made["worst_mass"]["value"],
        energy=made["worst_energy"]["value"],
        over=made["worst_balance_over_accuracy"]["value"],
        most=made["worst_rhs_evaluations"]["value"],
        most_ok=made["worst_rhs_evaluations_of_ok"]["value"],
        tries=", ".join(f"{name} {count}" for name, count in sorted(made["further_tries"].items())) or "none",
        warned=made["ok_above_accuracy"],
        compared=radau["compared"],
        within=radau["within_accuracy"],
        three=radau["within_three_times"],
        worst=radau["worst_over_accuracy"]["value"],
        unwarned=radau["beyond_accuracy_unwarned"],
        worst_unwarned=radau["worst_unwarned_over_accuracy"]["value"],
        no_answer=radau["no_answer"],
        contradicted="".join(
            f"- Scene {index} is contradicted: open, not looked at yet.\n"
            for index in radau["beyond_three_times_unwarned"]
        )
        + "".join(
            f"- Scene {index} is {status}: open, not looked at yet.\n"
            for status in STATUSES[4:]
            for index in made["not_ok"].get(status, ())
        ),
    )


def _tight() -> str:
    """Return how the stored comparisons with Radau came out."""
    rows = json.loads(RADAU.read_text(encoding="utf-8"))
    sizes = {name: row["difference"] / row["accuracy"] for name, row in rows.items() if "difference" in row}
    name = max(sizes, key=sizes.__getitem__)
    warm = {name: row for name, row in rows.items() if row["start"] != COLD}
    return TIGHT.format(
        agree=sum(size <= 1.0 for size in sizes.values()),
        count=len(rows),
        worst=sizes[name],
        name=name,
        cold=len(rows) - len(warm),
        rows="\n".join(
            _row(name, row["start"], _method(row), f"{sizes[name]:.2g}" if name in sizes else row["no_answer"])
            for name, row in warm.items()
        ),
        reasons="\n".join(f"- *{name}*: {why}" for name, why in REASONS.items()),
    )


def _method(row: dict[str, Any]) -> str:
    """Return the method of a row; with its steps, where they are not those of the others."""
    return row["method"] + ("" if row["of_steps"] == OF_STEPS else f", steps {row['of_steps']:g} of the accuracy")


def to_compare() -> list[Case]:
    """Return the cases that are compared with Radau once, and not in every run of the tests.

    Of cases that differ in the first guess alone the first; none that is compared there or stands for itself.
    """
    ok = [case for case in CASES if case.status == "ok"]
    plain = {repr(case.changes) for case in ok if case.guess is None}
    far = {repr(case.changes): case for case in reversed(ok) if case.guess is not None}
    others = [case for case in far.values() if repr(case.changes) not in plain]
    return [case for case in ok if case.guess is None and not case.radau] + others


def page() -> str:
    """Return the text of docs/explanation/hard-cases.md."""
    rows = [
        f"| {case.name} | {case.status}{f' ({case.deserves})' if case.deserves else ''} | "
        f"{case.most if case.status != 'refused' else '–'} | {'yes' if case.radau else ''} | {case.why} |"
        for case in CASES
    ]
    searched = _random(OUTCOME, RANDOM) + _random(OF_FLUIDS, FLUIDS) + _with_effects() + _courses() + _laws()
    return HEAD + "\n".join(rows) + "\n" + _tight() + searched + COMMANDS
