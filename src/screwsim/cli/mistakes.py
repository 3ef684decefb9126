"""Invalid arguments: suggest what may have been meant, where following the suggestion is safe."""

import re
import shlex
from collections.abc import Iterable, Sequence

import typer

from screwsim.inputs.suggestions import nearest

# options whose values may contain blanks
_OPTIONS_WITH_VALUES = ("--set", "--path", "--from", "--to", "--vary", "--for", "--subject-to", "--catalogue")


def explain_mistake(error: typer.TyperException, arguments: Sequence[str], commands: Iterable[str]) -> None:
    """Improve an error message on arguments: missing quotes, the nearest command, the nearest option."""
    text = str(getattr(error, "message", ""))
    offered = getattr(error, "possibilities", None)
    if offered:
        near = nearest(str(getattr(error, "option_name", "")), offered)
        error.possibilities = [near] if near else []  # type: ignore[attr-defined]
    elif text.startswith("No such command"):
        error.message = _command(arguments[0] if arguments else "", list(commands))  # type: ignore[attr-defined]
    elif "unexpected extra argument" in text and (remedy := _with_quotes(arguments) or _repeated_option(arguments)):
        error.message = f"{text}: {remedy}"  # type: ignore[attr-defined]


def _command(name: str, commands: list[str]) -> str:
    if name in ("help", "version"):
        return f"No such command '{name}' (write screwsim --{name})"
    near = nearest(name, commands)
    if near is not None:
        return f"No such command '{name}': did you mean '{near}'?"
    if re.search(r"\.(ya?ml|h5)$", name):
        usual = "report" if name.endswith("h5") else "run"
        verb = usual if usual in commands else f"export {commands[0]}"
        return f"No such command '{name}': the command must come first (write screwsim {verb} {shlex.quote(name)})"
    return f"No such command '{name}' (there are: {', '.join(commands)})"


def _with_quotes(arguments: Sequence[str]) -> str | None:
    """Return the first option whose value seems to continue in the next arguments, quoted for a shell."""
    for place, option in enumerate(arguments[:-1]):
        name, equals, value = option.partition("=")
        if name in _OPTIONS_WITH_VALUES:
            first = place + 1 if equals else place + 2
            words = [value if equals else arguments[place + 1]]
            while first < len(arguments) and not re.search(r"^--|^-o$|\.(ya?ml|h5)$", arguments[first]):
                words.append(arguments[first])
                first += 1
            if len(words) > 1:
                return f"a value with spaces needs quotes (write {name} {shlex.quote(' '.join(words))})"
    return None


def _repeated_option(arguments: Sequence[str]) -> str | None:
    """Return the remedy where --without is given several names."""
    if "--without" not in arguments[:-2]:
        return None
    place = list(arguments).index("--without") + 1
    return f"--without takes one name (write --without {arguments[place]} --without {arguments[place + 1]})"
