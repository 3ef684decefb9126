"""A self-contained page that shows the meshing rotors, with sliders for angle and section."""

import json
import math
from html import escape
from importlib import resources
from typing import Any

import numpy as np

from screwsim.machine.profile_law import LaidCurves
from screwsim.machine.rotors.pair import Array, outlines
from screwsim.machine.rotors.rotors import Rotors

MM, DEG = 1e3, 180.0 / math.pi
OUTLINE_TOLERANCE = 4e-3  # [mm] tolerance of drawn outlines


def polygon_points(x: Array, y: Array, off: float) -> list[int]:
    """Return the indices of points to keep, such that no point is farther from their polygon than `off`."""
    keep, todo = {0, len(x) - 1}, [(0, len(x) - 1)]
    while todo:
        first, last = todo.pop()
        if last - first < 2:
            continue
        dx, dy = x[last] - x[first], y[last] - y[first]
        px, py = x[first + 1 : last] - x[first], y[first + 1 : last] - y[first]
        length = math.hypot(dx, dy)
        away = np.abs(px * dy - py * dx) / length if length > 1e-9 else np.hypot(px, py)
        worst = int(np.argmax(away))
        if away[worst] > off:
            middle = first + 1 + worst
            keep.add(middle)
            todo += [(first, middle), (middle, last)]
    return sorted(keep)


def _path(x: Array, y: Array) -> str:
    index = polygon_points(MM * x, MM * y, OUTLINE_TOLERANCE)
    return "M" + "L".join(f"{MM * x[i]:.2f},{MM * y[i]:.2f}" for i in index) + "Z"


def _curve(angle: Array, value: Array, factor: float) -> list[list[float]]:
    x, y = DEG * angle, factor * value
    return [[round(float(x[i]), 2), float(f"{y[i]:.4g}")] for i in polygon_points(x, y / y.max() * x.max(), 0.3)]


def drawing(rotors: Rotors) -> dict[str, Any]:
    """Return the data from which a script draws and turns meshing rotors: lengths in millimetres, angles in degrees.

    The outlines are texts of SVG paths; each point of the contact line has its angle.
    """
    pair, chain = rotors.pair, rotors.chain
    male, female = outlines(pair, chain)
    index = polygon_points(MM * chain.x, MM * chain.y, OUTLINE_TOLERANCE)
    return {
        "A": MM * pair.centre_distance,
        "R1": MM * pair.male_radius,
        "R2": MM * pair.female_radius,
        "H": [MM * value for value in pair.cusp],
        "k": pair.k,
        "pitch": DEG * pair.pitch,
        "wrap": DEG * rotors.wrap,
        "chain": [[round(v, 3) for v in (DEG * chain.psi[i], MM * chain.x[i], MM * chain.y[i])] for i in index],
        "male": _path(*male),
        "female": _path(*female),
    }


def page(laid: LaidCurves, title: str) -> str:
    """Return the HTML text of the page."""
    drawn = drawing(laid.rotors)
    male, female = drawn.pop("male"), drawn.pop("female")
    data = drawn | {
        "start": DEG * (laid.rotors.start - laid.born),
        "life": DEG * laid.life,
        "born": DEG * laid.born,
        "closes": DEG * laid.injection,
        "opens": DEG * laid.opens,
        "ends": DEG * laid.ends,
        "volume": _curve(laid.volume.angle, laid.volume.value, 1e6),
        "suction": _curve(laid.suction.angle, laid.suction.value, 1e4),
        "discharge": _curve(laid.discharge.angle, laid.discharge.value, 1e4),
    }
    template = resources.files("screwsim.report").joinpath("rotors_page.html").read_text(encoding="utf-8")
    text = template.replace("@TITLE@", escape(title or "Rotors")).replace("@MALE@", male)
    return text.replace("@FEMALE@", female).replace("@DATA@", json.dumps(data))
