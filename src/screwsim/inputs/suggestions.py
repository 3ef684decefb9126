"""Suggestions for unknown names, made only where the suggestion cannot mean something else.

A typing error is corrected. Names that differ in a number, in one letter of a short word (phi_A, min and max) or in a
whole word (suction and discharge) are not suggested: they mean other things, and whoever followed the suggestion would
not notice. Also joins names as in a sentence, counts things, and puts an article before a noun.
"""

import re
from collections.abc import Iterable, Sequence

_SHORT, _LONG = 4, 7  # least number of letters of a word in which one typing error, and two, are corrected


def nearest(name: str, options: Iterable[str]) -> str | None:
    """Return the one option of which a name is a misspelling; None where there is none, or more than one."""
    options = list(dict.fromkeys(options))
    same = [option for option in options if _bare(option) == _bare(name)]
    if same:
        return same[0] if len(same) == 1 else None
    words = _words(name)
    found = {option: _typing_errors(words, _words(option)) for option in options}
    near = sorted((slips, option) for option, slips in found.items() if slips is not None)
    alone = near and (len(near) == 1 or near[0][0] < near[1][0])
    return near[0][1] if alone else None


def did_you_mean(name: str, options: Iterable[str]) -> str:
    """Return the question whether the nearest option was meant, to follow a statement; '' where none is near."""
    near = nearest(name, options)
    return f"; did you mean '{near}'?" if near else ""


def paths_ending_in(path: str, options: Iterable[str]) -> list[str]:
    """Return the dotted paths that end in a given path: 'speed' gives 'operation.speed'."""
    return [option for option in options if option.endswith(f".{path}")]


def names_containing(name: str, options: Iterable[str]) -> list[str]:
    """Return the names that contain every word of a name: 'lobes' gives 'male_lobes' and 'female_lobes'."""
    wanted = set(_words(name))
    return [option for option in options if wanted <= set(_words(option))]


def _bare(name: str) -> str:
    return re.sub(r"[\s_-]", "", name).lower()


def _words(name: str) -> list[str]:
    return re.split(r"[\s._-]+", name.lower())


def _typing_errors(words: list[str], others: list[str]) -> int | None:
    """Return the number of typing errors between two names, word by word; None where they are different names."""
    if len(words) != len(others):
        joined, other = "".join(words), "".join(others)
        return _word_typing_errors(joined, other)
    each = [_word_typing_errors(word, other) for word, other in zip(words, others, strict=True)]
    known = [slips for slips in each if slips is not None]
    return sum(known) if len(known) == len(each) else None


def _word_typing_errors(word: str, other: str) -> int | None:
    if word == other:
        return 0
    if re.findall(r"[0-9]+", word) != re.findall(r"[0-9]+", other):
        return None
    length = max(len(word), len(other))
    allowed = 2 if min(len(word), len(other)) >= _LONG else 1 if length >= _SHORT else 0
    slips = _edit_distance(word, other)
    return slips if slips <= allowed else None


def _edit_distance(a: str, b: str) -> int:
    """Return how many letters are left out, added, changed or swapped with their neighbour (optimal alignment)."""
    if abs(len(a) - len(b)) > 2:
        return 3  # more than any offer allows
    rows = [list(range(len(b) + 1))]
    for i, letter in enumerate(a, 1):
        row = [i]
        for j, other in enumerate(b, 1):
            best = min(rows[-1][j] + 1, row[-1] + 1, rows[-1][j - 1] + (letter != other))
            if i > 1 and j > 1 and letter == b[j - 2] and a[i - 2] == other:
                best = min(best, rows[-2][j - 2] + 1)
            row.append(best)
        rows.append(row)
    return rows[-1][-1]


def joined_names(names: Sequence[str]) -> str:
    """Return one or more names as in a sentence: a, b and c."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def counted(count: int, noun: str) -> str:
    """Return how many things there are: 1 case, 2 cases."""
    return f"{count} {noun}{'s' * (count != 1)}"


def with_article(noun: str) -> str:
    """Return a noun with its article: a length, an area."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
