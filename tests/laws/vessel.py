"""A vessel of constant volume with one opening: the emitted chamber model, run without a compiler."""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scenes import DROP, scene_dict

from screwsim.build import build_parts
from screwsim.fluid.ideal_gas import IdealGas
from screwsim.model.compose import compose
from screwsim.model.slots import P_PORT_WIDTH, PORT_STATE, R_SIZE
from screwsim.model.trajectory import ChamberContext
from screwsim.scene import loads

VOLUME, AREA = 6e-4, 1e-6  # m³, m²: a pin hole, so that the vessel takes seconds


class Vessel(NamedTuple):
    """What a run needs: the names of the flat module, the composition, the gas."""

    names: dict[str, Any]
    composition: Any
    gas: IdealGas


def vessel(folder: Path) -> Vessel:
    """Return the vessel: volume and area laws are tables that do not change over the angle."""
    for name, column, value in (("V", "volume_m3", VOLUME), ("S", "area_m2", AREA)):
        (folder / f"{name}.csv").write_text(
            f"angle_deg,{column}\n" + "".join(f"{a},{value}\n" for a in (0, 180, 360, 540, 720))
        )
    scene = scene_dict(
        {
            "machine.volume": {"law": "table", "max": f"{VOLUME} m^3", "min": "1e-12 m^3", "file": "V.csv"},
            "machine.suction_port": {"law": "table", "file": "S.csv"},
            "machine.discharge_port": DROP,
            "oil": DROP,
            "oil_supply": DROP,
            "effects": {"suction_port": {}},
            "operation.speed": "1 rad/s",  # so that an angle is a time
        }
    )
    parts = build_parts(loads(json.dumps(scene), folder=str(folder)))
    return Vessel(plain(compose(parts).text), compose(parts), parts.gas)


@cache
def plain(text: str) -> dict[str, Any]:
    """Return the names of a generated module, run as plain Python."""
    names: dict[str, Any] = {}
    exec(text, names)
    return names


def run(v: Vessel, inside: tuple[float, float], outside: tuple[float, float], time: float) -> tuple[float, float]:
    """Return temperature and mass in the vessel after `time` [s], from (p, T) inside and outside."""
    P, R = v.composition.P.copy(), np.zeros(R_SIZE)
    P[P_PORT_WIDTH] = 1e-6  # Pa: no regularisation that could be seen
    R[:6] = v.gas.port_state(*outside)
    y = np.array([inside[1], v.gas.density(*inside)])
    nq, room, n = v.composition.n_quadratures, 3000, 2
    columns = n + v.composition.n_port_state
    history = np.zeros(room + 1), np.zeros((room, 4, columns)), np.zeros((room, nq))
    spaces = np.zeros(columns), np.append(np.zeros(PORT_STATE), -1.0)
    kept = np.zeros(2, np.int64)
    context = ChamberContext(
        P,
        v.composition.TAB,
        R,
        history[0],
        history[1],
        history[0],
        history[1],
        kept,
        np.zeros(64, np.int64),
        *spaces,
    )
    status, end, _ = v.names["rodas__integrate_one"](
        np.array([0.0, time]),
        2,
        y,
        np.zeros(nq),
        context,
        1e-9,
        1e-3 * time,
        v.composition.n_E,
        *history,
        kept,
        np.zeros(4, np.int64),
    )
    assert status == 0 and math.isclose(end, time)
    return float(y[0]), float(y[1]) * (VOLUME + 1e-12)
