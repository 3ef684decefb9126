"""The fitted machine as a scene file: its base, and the paths that the fit changed."""

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from screwsim.effects import catalogue
from screwsim.scene.fields import effect_keys
from screwsim.scene.write import quoted
from screwsim.study.calibration.solve import Calibration
from screwsim.study.inputs import shown_value

VALUE_DIGITS = 7  # of a fitted value: far below its error
FIRST_LINE = "# Fitted by: screwsim calibrate"  # start of a scene that a calibration wrote


def fitted_text(found: Calibration, folder: Path) -> str:
    """Return the YAML text of the fitted machine, to be written into a folder."""
    fit = found.fit
    tree: dict[str, Any] = {}
    for path, value in fit.changes(found.values).items():
        put(tree, keys(path), shown_value(fit.scene, path, value, VALUE_DIGITS).replace("°C", "degC"))
    title = fit.title or fit.scene.title
    lines = [
        f"{FIRST_LINE} {os.path.basename(fit.name)}; {quality_in_words(found)}.",
        f"title: {quoted(f'{title}, fitted' if title else 'fitted')}",
        f"base: {quoted(_relative(fit.scene_file, folder))}",
        *lines_of(tree),
    ]
    return "\n".join(lines) + "\n"


def quality_in_words(found: Calibration) -> str:
    """Return the quality of the fit, in a few words."""
    fitted = sum(point.fitted for point in found.fit.points)
    text = f"chi squared {found.chi_squared:.3g} with {found.freedom} degrees of freedom, {fitted} points"
    return text if found.status == "ok" else f"{text}; {found.status}"


def keys(path: str) -> list[str]:
    """Return the keys of a dotted path; names of a user's own effects contain dots."""
    if not path.startswith("effects."):
        return path.split(".")
    name, below = effect_keys(path, catalogue())
    return ["effects", name, *below]


def put(tree: dict[str, Any], where: Sequence[str], text: str | dict[str, Any]) -> None:
    """Put a text into a tree under its keys; a text on the way there gives place to a mapping, {} keeps one."""
    *above, last = where
    for name in above:
        if not isinstance(tree.get(name), dict):
            tree[name] = {}
        tree = tree[name]
    if text or not isinstance(tree.get(last), dict):
        tree[last] = text


def lines_of(tree: Mapping[str, Any], indent: str = "") -> Iterator[str]:
    """Yield the lines of a tree of texts as YAML."""
    for name, item in tree.items():
        if isinstance(item, dict) and item:
            yield f"{indent}{name}:"
            yield from lines_of(item, indent + "  ")
        else:
            yield f"{indent}{name}: {item}"


def _relative(path: str, folder: Path) -> str:
    try:
        return os.path.relpath(os.path.realpath(path), os.path.realpath(folder))
    except ValueError:  # on another drive
        return os.path.abspath(path)
