"""Faults of text that is not YAML: the parser's message, and the most likely remedy."""

import re

from ruamel.yaml.error import MarkedYAMLError

_ANY = "fix the indentation, brackets or quotes here"
_LINE = "write NAME: value, with a space after the colon and indented like its neighbours; also check the line above"
_ONE = "a scene is one document: remove the line with --- or ... and all that follows it"
_REMEDIES = (  # pattern in the parser's message, and the remedy
    (r"cannot start any token", "write the text in quotes"),
    (r"mapping values are not allowed|could not find expected ':'|expected <block end>", _LINE),
    (
        r"sequence entries are not allowed",
        "a list begins on its own line, or is in [ ]; a minus sign has no space after it",
    ),
    (r"another document", _ONE),
    (r"expected '<document start>'", "a scene consists of lines NAME: value only"),
    (r"expected the node content", "a value is missing here: write it, or remove the comma"),
    (r"undefined alias", "write the value out, or quote a text that begins with *"),
)
_BLANKS = {"\t": "a tab", "\u00a0": "a no-break space", "\u202f": "a no-break space", "\u3000": "a wide space"}


def not_yaml(error: MarkedYAMLError, text: str) -> str:
    """Return what is wrong with a text that is not YAML, with the remedy."""
    what = " ".join(str(error.problem or error.context).split())
    return f"is not YAML: {what} ({_blank(error, text) or _remedy(what) or _opened(error) or _ANY})"


def _remedy(what: str) -> str | None:
    return next((remedy for words, remedy in _REMEDIES if re.search(words, what)), None)


def _blank(error: MarkedYAMLError, text: str) -> str | None:
    """Return the remedy where this line or the one above has a character that only looks like a blank, e.g. a tab."""
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return None
    lines = text.splitlines()
    for number in (mark.line, mark.line - 1):
        line = lines[number] if 0 <= number < len(lines) else ""
        found = next((name for letter, name in _BLANKS.items() if letter in line), None)
        if found is not None:
            return f"line {number + 1} has {found}: replace it by spaces"
    return None


def _opened(error: MarkedYAMLError) -> str | None:
    """Return the remedy where a quote or a bracket is not closed: where it was opened."""
    words, mark = str(error.context or ""), error.context_mark
    if mark is None:
        return None
    place = f"in line {mark.line + 1}, column {mark.column + 1}"
    if "quoted scalar" in words:
        return f"close the quote that opens {place}"
    if "flow" in words:
        bracket, close = ("{", "}") if "mapping" in words else ("[", "]")
        return f"close the {bracket} that opens {place} with {close}, and separate what is inside by commas"
    return None
