"""Print how near the paper's laws (16)-(18) come to rotors: their fits to V(phi), and the figures of fitted scenes.

Run: .venv/bin/python scripts/paper_laws.py. The law of volume has the angle phi_A; its whole axis may also be shifted
against the rotors', and its length be another than 720 deg: what either gains is shown. Then (b) of configs/rotors
beside scenes in which its curves are the paper's laws, fitted to it, suction closing at 360 deg.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares, minimize

from screwsim.machine.paper_law import bump, discharge_area, suction_area, volume
from screwsim.machine.profile_law import lay
from screwsim.machine.profile_tables import Table
from screwsim.machine.settings import LIFE, TURN, DischargePort, SuctionPort, VolumeLaw
from screwsim.scene import Scene, load
from screwsim.scene.grid import with_values
from screwsim.simulate import simulate

CONFIGS = Path(__file__).resolve().parent.parent / "configs" / "rotors"
GAPS = ("tip_leakage", "interlobe_leakage", "end_face_leakage", "blow_hole")
DEG = math.pi / 180.0


def closing_side(scene: Scene, points: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Return angles [rad, 0 where the volume is largest] and V/V_max of the closing side of a scene's rotors."""
    rotors = lay(scene.machine).rotors
    phi = np.linspace(rotors.largest[0], rotors.wrap, points)
    return phi - rotors.largest[0], rotors.volume(phi) / rotors.largest[1]


def fits(name: str, scene: Scene) -> None:
    """Print the closest fits (least largest deviation) of law (16) to the closing side of a scene's rotors."""
    phi, V = closing_side(scene)

    def law(phi_A: float, shift: float, half: float) -> np.ndarray:
        c = min(max(phi_A / half, 1e-3), 1.0)
        return np.array([bump(max(1.0 + (p - shift) / half, 1.0), c) for p in phi])

    printed = _closest(lambda phi_A: law(phi_A, 0.0, TURN), V, [2.0])
    shifted = _closest(lambda phi_A, shift: law(phi_A, shift, TURN), V, [printed[0][0], 0.0])
    longer = _closest(law, V, [2.0, -0.7, 1.2 * TURN])
    for text, (found, off) in (("as printed", printed), ("shifted", shifted), ("shifted, of another length", longer)):
        numbers = zip(("phi_A", "shift", "half length"), found / DEG, strict=False)
        shown = ", ".join(f"{label} {value:.1f}" for label, value in numbers)
        print(f"({name}) {text:<28} off by {off:.4f} V_max   {shown} deg")


def _closest(model: Callable[..., np.ndarray], V: np.ndarray, start: list[float]) -> tuple[np.ndarray, float]:
    """Return the parameters of the least largest deviation from V, and that deviation."""

    def deviation(x: np.ndarray) -> float:
        return float(np.max(np.abs(model(*x) - V)))

    found = least_squares(lambda x: model(*x) - V, start).x
    found = min((found, np.array(start)), key=deviation)
    for _ in range(3):
        found = minimize(deviation, found, method="Nelder-Mead", options={"xatol": 1e-5, "fatol": 1e-8}).x
    return found, deviation(found)


def figures(scene: Scene) -> str:
    """Return λ and η_s of a scene, and its status where it is not ok."""
    result = simulate(scene, trace=False)
    found = result.performance
    text = f"{found.volumetric_efficiency:8.4f} {found.isentropic_efficiency:8.4f}"
    return text if result.status == "ok" else f"{text} {result.status}"


def fitted(b: Scene, by_ratio: bool) -> Scene:
    """Return (b) with the paper's laws fitted to its curves, suction closing at 360°, and the built-in gaps' sizes.

    by_ratio: the port opens where the law has the built-in ratio, and not at the angle at which the rotors' opens.
    """
    laid = lay(b.machine)
    shift = laid.injection - TURN
    phi, V = _paper_axis(laid.volume, shift)
    phi_A = _fit(lambda x: [volume(p, laid.swept, 0.0, x[0]) for p in phi], V, [60 * DEG], [(1 * DEG, TURN)])[0]
    phi, S = _paper_axis(laid.suction, shift)
    area, phi_B = _fit(
        lambda x: [suction_area(p, x[0], x[1]) for p in phi], S, [S.max(), 90 * DEG], [(0.0, 1.0), (1 * DEG, TURN / 2)]
    )
    suction = SuctionPort(law="paper", area=area, phi_B=phi_B)
    opens = laid.opens - shift
    if by_ratio:
        opens = _where(
            lambda p: volume(p, laid.swept, 0.0, phi_A), laid.swept / float(b.machine.built_in_volume_ratio or 1.0)
        )
    part_of_life = (laid.discharge.angle - laid.opens) / (laid.ends - laid.opens)
    phi, S = opens + part_of_life * (LIFE - opens), laid.discharge.value
    half = 0.5 * (LIFE - opens)
    area, part = _fit(
        lambda x: [discharge_area(p, x[0], opens, opens + x[1] * half) for p in phi],
        S,
        [S.max(), 0.5],
        [(0.0, 1.0), (0.01, 1.0)],
    )
    discharge = DischargePort(law="paper", area=area, opens=opens, phi_C=opens + part * half)
    lines = [one.table.value.max() for one in laid.interfaces["interlobe_leakage"]]
    faces = {one.offset: one.table.value.max() for one in laid.interfaces["end_face_leakage"]}
    near, far = faces[1], sum(length for offset, length in faces.items() if offset > 1)
    angles = " ".join(
        f"{name} {angle / DEG:.1f}" for name, angle in (("phi_A", phi_A), ("phi_B", phi_B), ("opens", opens))
    )
    areas = f"{(suction.area or 0.0) * 1e4:.1f} and {area * 1e4:.1f} cm^2"
    print(f"paper's laws: {angles} phi_C {(discharge.phi_C or 0.0) / DEG:.1f} deg; areas {areas}")
    return with_values(
        b,
        {
            "machine.profile": None,
            "machine.built_in_volume_ratio": None,
            "machine.volume": VolumeLaw(law="paper", max=laid.swept, phi_A=phi_A),
            "machine.suction_port": suction,
            "machine.discharge_port": discharge,
            "effects.interlobe_leakage.length": float(max(lines)),
            "effects.blow_hole.area": float(laid.interfaces["blow_hole"][0].table.value.max()),
            "effects.end_face_leakage.length": float(near + far),
            "effects.end_face_leakage.suction_share": float(far / (near + far)),
        },
    )


def _where(law, wanted: float) -> float:
    """Return the angle after 360° [rad] at which a falling volume is the wanted one."""
    low, high = TURN, LIFE
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if law(middle) > wanted else (low, middle)
    return 0.5 * (low + high)


def _deviation(paper: Scene, b: Scene) -> float:
    """Return the largest deviation of a paper's volume from the rotors', over the swept volume."""
    laid, law = lay(b.machine), paper.machine.volume
    phi, V = _paper_axis(laid.volume, laid.injection - TURN)
    own = np.array([volume(p, laid.swept, 0.0, float(law.phi_A or 0.0)) for p in phi])
    return float(np.max(np.abs(own - V)) / laid.swept)


def _paper_axis(table: Table, shift: float) -> tuple[np.ndarray, np.ndarray]:
    return table.angle - shift, table.value


def _fit(law, curve: np.ndarray, start: list[float], bounds: list[tuple[float, float]]) -> list[float]:
    """Return the parameters of a law closest to a curve, in the mean of squares over its largest value."""
    found = least_squares(lambda x: (np.array(law(x)) - curve) / curve.max(), start, bounds=np.transpose(bounds))
    return [float(value) for value in found.x]


def without(scene: Scene, *names: str) -> Scene:
    """Return the scene without some effects."""
    return replace(scene, effects={name: active for name, active in scene.effects.items() if name not in names})


def main() -> None:
    """Print fits and figures."""
    for name in "abc":
        fits(name, load(CONFIGS / f"{name}.yaml"))
    print()
    b = load(CONFIGS / "b.yaml")
    laws = {"profile (b)": b, "fitted curves": fitted(b, False), "opens at the ratio": fitted(b, True)}
    for name, scene in laws.items():
        off = "" if scene is b else f"   volume off by {_deviation(scene, b):.3f} V_max"
        print(f"{name:<20} all {figures(scene)}   ports only {figures(without(scene, *GAPS))}{off}")


if __name__ == "__main__":
    main()
