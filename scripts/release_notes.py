"""Print the section of CHANGELOG.md for one version, as the body of its release.

    python scripts/release_notes.py 1.3.0      or the tag, v1.3.0

A section headed "(unreleased)" is printed too, with a note on stderr, as the heading must be changed before the tag.
"""

import re
import sys
from collections.abc import Sequence
from pathlib import Path

CHANGELOG = Path(__file__).parents[1] / "CHANGELOG.md"
_HEADING = re.compile(r"^## +(\S+)(.*)$", flags=re.MULTILINE)


def sections(text: str) -> dict[str, tuple[str, str]]:
    """Return {version: (rest of the heading, body)} of a changelog, the newest first."""
    found = list(_HEADING.finditer(text))
    ends = [*(each.start() for each in found[1:]), len(text)]
    return {each[1]: (each[2].strip(), text[each.end() : end].strip()) for each, end in zip(found, ends, strict=True)}


def main(arguments: Sequence[str], changelog: Path = CHANGELOG) -> int:
    """Print the notes; return 2, with one line on the reason, if they cannot be printed."""
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print("usage: python scripts/release_notes.py VERSION (as 1.3.0 or v1.3.0)", file=sys.stderr)
        return 2
    version = arguments[0].removeprefix("v")
    found = sections(changelog.read_text(encoding="utf-8"))
    if version not in found:
        there = ", ".join(found) or "none"
        print(
            f"{changelog.name}: has no section of {version} (it has {there}; head one '## {version}')", file=sys.stderr
        )
        return 2
    heading, body = found[version]
    if not body:
        print(f"{changelog.name}: the section of {version} is empty (note what has changed)", file=sys.stderr)
        return 2
    if "unreleased" in heading:
        print(f"{changelog.name}: {version} is headed {heading}: change that before the tag", file=sys.stderr)
    print(body)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
