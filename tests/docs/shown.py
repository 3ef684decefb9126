"""What a page shows below a command, held against what the command prints."""

import re

ESTIMATE = re.compile(r"\d(\.\d+)?e[+-]\d\d")  # of an error: two solvers that are as good differ in it
BRACKETS = "[](),;:%+*"


def lines(text: str) -> list[str]:
    return [line.rstrip() for line in text.splitlines() if line.strip()]


def commands(shell: str) -> list[tuple[str, list[str]]]:
    """Return the commands of a block, each with the lines shown under it; in a block without `$` each line is one."""
    found: list[tuple[str, list[str]]] = []
    prompted = re.search(r"^\$ ", shell, re.M) is not None
    for line in re.sub(r"\\\n\s*", "", shell).splitlines():
        if line.startswith("$ ") or (not prompted and line.strip() and not line.lstrip().startswith("#")):
            found.append((line.removeprefix("$ ").strip(), []))
        elif line.strip() and found:
            found[-1][1].append(line.rstrip())
    return found


def alike(shown: str, printed: str) -> bool:
    """Tell whether a line is the shown one, numbers within the accuracy; times and estimates are only to be there."""
    ours, theirs = shown.split(), printed.split()
    if len(ours) > 1 and ours[-1] == "…":  # the line goes on
        ours, theirs = ours[:-1], theirs[: len(ours) - 1]
    return len(ours) == len(theirs) and all(
        _same(a, b, before, later)
        for a, b, before, later in zip(ours, theirs, ["", *ours], [*ours[1:], ""], strict=False)
    )


def _same(shown: str, printed: str, before: str, later: str) -> bool:
    if ESTIMATE.fullmatch(shown):
        return ESTIMATE.fullmatch(printed) is not None
    shown, printed = (word.strip(BRACKETS) for word in (shown, printed))
    try:
        number, theirs = float(shown), float(printed)
    except ValueError:
        return shown == printed
    if later == "s":
        return True
    if before == "±":  # an estimate, too
        return 0.5 * number <= theirs <= 2.0 * number
    digits = len(shown.partition(".")[2]) if "e" not in shown else 0
    return abs(theirs - number) <= max(1e-3 * abs(number), 1.01 * 10.0**-digits if "." in shown else 1.0)


def missing(shown: list[str], printed: list[str]) -> str | None:
    """Return the first line of the page that is not printed in its place; anything may stand for `...` or `…`."""
    place, anywhere = 0, False
    for line in shown:
        if line.strip() in ("...", "…"):
            anywhere = True
            continue
        while anywhere and place < len(printed) and not alike(line, printed[place]):
            place += 1
        if place == len(printed) or not alike(line, printed[place]):
            return line
        place, anywhere = place + 1, False
    return None if anywhere or place == len(printed) else f"{printed[place]!r}, which is not on the page"
