"""Output of `screwsim sweep`: what became of its cases, the first failures and the kinds of warnings."""

from collections.abc import Mapping
from typing import Any

from screwsim.inputs.suggestions import counted
from screwsim.outputs import STATUSES
from screwsim.outputs.display import grouped, picked
from screwsim.printing.tables import print_text
from screwsim.printing.uncertain import ranges_text, uncertainty_ranges
from screwsim.results import open_results
from screwsim.results.warning_kinds import cases_with_warnings, warning_kinds
from screwsim.scene import Scene, case_values
from screwsim.screen import say
from screwsim.study.asked.inputs import shown_value
from screwsim.study.sweep.run import SweepSummary

MOST_FAILURES = 20  # listed for one sweep; all are in its file
MOST_WARNINGS = 8  # kinds of warnings, likewise


def sweep_document(scene: Scene, summary: SweepSummary) -> dict[str, Any]:
    """Return what `sweep --json` prints: numbers of cases, the first that are not ok, the kinds of warnings."""
    results = open_results(summary.path)
    status = results.performance["status"].ravel()
    bad = status.nonzero()[0][:MOST_FAILURES]
    messages = results.performance.texts_at("message", bad)
    warned = cases_with_warnings(results).ravel()
    return {
        **picked(summary, "path", "cases", "ok", "not_closed", "failed", "reused", "seconds"),
        "failures": [
            {"case": case, "status": STATUSES[status[case]], "values": case_values(scene, case), "message": message}
            for case, message in zip(bad.tolist(), messages, strict=True)
        ],
        "warned": int(warned.sum()),
        "warned_by_status": {name: int((warned & (status == code)).sum()) for code, name in enumerate(STATUSES)},
        "warnings": [
            {"cases": kind.cases, "case": kind.first, "values": case_values(scene, kind.first), "warning": kind.text}
            for kind in warning_kinds(results)
        ],
        **({"uncertainty": uncertainty_ranges(results)} if len(results.uncertainty) else {}),
    }


def _status_counts(document: Mapping[str, Any]) -> str:
    """Return how many cases have each status, and how many of those warn: `28 ok (3 of them with warnings)`."""
    told = []
    for name in ("ok", "not_closed", "failed"):
        warned = document["warned_by_status"].get(name, 0)
        if document[name] or name == "ok":
            of_them = f" ({warned} of them with warnings)" if warned else ""
            told.append(f"{document[name]} {name.replace('_', ' ')}{of_them}")
    return ", ".join(told)


def print_sweep(document: Mapping[str, Any], scene: Scene) -> None:
    """Print the outcome of a sweep: the file, the first failures, the kinds of warnings, last the numbers of cases.

    Failures with the same message are one entry, at the first of their cases; `scene` is the one that was swept.
    """

    def where(values: Mapping[str, Any]) -> str:
        return ", ".join(f"{path} = {shown_value(scene, path, value)}" for path, value in values.items())

    counts = f"{document['cases']} cases: {_status_counts(document)}"
    counts += f" ({document['reused']} from an earlier run)" if document["reused"] else ""
    say(document["path"])
    alike = grouped(((each["status"], each["message"]), where(each["values"])) for each in document["failures"])
    for (status, message), (place, *others) in alike.items():
        others_too = f" and {len(others)} more" if others else ""
        print_text(f"{status} at {place}{others_too}: {message}")
    more = document["cases"] - document["ok"] - len(document["failures"])
    if more:
        say(f"… and {more} more (see the file)")
    for kind in document["warnings"][:MOST_WARNINGS]:
        first = f"first at {where(kind['values'])}" if kind["cases"] > 1 else f"at {where(kind['values'])}"
        cases = counted(kind["cases"], "case")
        print_text(f"warning in {cases}, {first}: {kind['warning']}")
    more = len(document["warnings"]) - MOST_WARNINGS
    if more > 0:
        say(f"… and {more} other kinds of warnings (see the file)")
    if "uncertainty" in document:
        print_text(f"uncertainty from the inputs alone: {ranges_text(document['uncertainty'])}")
    say(f"{counts}, {document['seconds']:.1f} s")
