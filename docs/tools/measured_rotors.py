"""Draw measured points of known rotors and tell what is found from them. Run: measured_rotors.py [DRAWS].

Points 20 to 80 µm apart, with 1 µm of normal noise in both coordinates, of the rotors (a), (b), (c) of
docs/reference/rotors.md at 100 mm; `tolerance` 4 µm. Told: how many draws are refused, and by how much V_max and the
blow-holes of the others err.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from screwsim.inputs.faults import UsageError
from screwsim.machine.rotors.export import profile_csv
from screwsim.machine.rotors.rotors import Rotors, make_rotors
from screwsim.machine.rotors.settings import FAMILIES, Profile

D, LENGTH = 0.1, 0.11  # m
NOISE, TOLERANCE, APART = 1e-6, 4e-6, (2e-5, 8e-5)  # m


def exact(name: str) -> Rotors:
    """Return the rotors of a family at 100 mm."""
    family = FAMILIES[name]
    lengths: dict[str, Any] = {key: D * share for key, share in family.shares.items()}
    profile = Profile(kind=family.kind, wrap_angle=family.wrap_angle, pressure_angle=family.pressure_angle, **lengths)
    return make_rotors(profile, family.male_lobes, family.female_lobes, D, LENGTH)


def measured(rotors: Rotors, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points [m] of the male lobe as if measured."""
    random = np.random.default_rng(seed)
    first, last = rotors.chain.edges
    x, y = (line[first : last + 1] for line in rotors.chain.male)
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    one = np.concatenate([[True], np.diff(way) > 1e-9])
    at = np.cumsum(random.uniform(*APART, 10_000))
    at = np.concatenate([[0.0], at[at < way[-1] - APART[0]], way[-1:]])
    px, py = (np.interp(at, way[one], line[one]) + NOISE * random.standard_normal(len(at)) for line in (x, y))
    return px, py


def found(rotors: Rotors, seed: int, folder: Path) -> tuple[float, float] | None:
    """Return the errors of V_max and of the worse blow-hole, as shares; None: refused."""
    pair, path = rotors.pair, folder / "lobe.csv"
    path.write_text(profile_csv(*measured(rotors, seed)), encoding="utf-8")
    profile = Profile(
        kind="points",
        centre_distance=pair.centre_distance,
        female_diameter=2.0 * pair.female_radius,
        wrap_angle=rotors.wrap,
        file=str(path),
        tolerance=TOLERANCE,
    )
    try:
        again = make_rotors(profile, pair.male_lobes, pair.female_lobes, D, LENGTH)
    except UsageError:
        return None
    own, known = again.coefficients(), rotors.coefficients()
    share = {key: abs(own[key][0] / known[key][0] - 1.0) for key in own}
    return share["largest_volume"], max(share["blow_hole_area"], share["suction_blow_hole_area"])


def main(draws: int) -> None:
    """Print a line a pair of rotors."""
    for name in FAMILIES:
        rotors = exact(name)
        with tempfile.TemporaryDirectory() as folder:
            errors = [each for seed in range(draws) if (each := found(rotors, seed, Path(folder)))]
        volume, hole = np.transpose(errors)
        print(
            f"({name}) {draws - len(errors)} of {draws} refused; V_max: median {np.median(volume):.1e}, worst "
            f"{volume.max():.1e}; blow-holes: median {np.median(hole):.1e}, worst {hole.max():.1e}"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 25)
