"""Loads and sound of a machine: forces on rotors and bearings, flows of both lines, spectra, surfaces.

Everything repeats with each lobe pitch, so spectra are harmonics of the lobe frequency. Pressures on the surfaces over
one revolution are for finite elements: XDMF text beside HDF5. The mesh is in the rotor's own frame, with z along its
axis from the suction end; cells have the pressure above suction, one field per step of the revolution.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple
from xml.sax.saxutils import quoteattr

import numpy as np

from screwsim.build import build_parts
from screwsim.export.rotor_loads import Pressures, Spans, Supports, loads_of, pressures_of
from screwsim.export.rotor_supports import supports_of
from screwsim.figures import rotor_speed
from screwsim.inputs.faults import UsageError
from screwsim.machine.kinds import TWIN_SCREW, twin_screw
from screwsim.machine.rotors.loads import NAMES, Diameters
from screwsim.machine.rotors.pair import Array
from screwsim.machine.rotors.surface import Surface, chamber_angles, surfaces
from screwsim.model.parts import Parts
from screwsim.outputs import Result
from screwsim.results.atomic import make_folder, replacing, write_csv, write_text
from screwsim.results.guarded import new_hdf5
from screwsim.results.protection import protect_other_json, protect_other_text
from screwsim.scene import Scene

HARMONICS = 20
FLOW_POINTS = 360  # points of a pitch
LINES = {"suction": 1.0, "discharge": -1.0}  # sign of a flow into the chambers along the machine's direction
REVOLUTION_STEPS = 48  # of one revolution of a rotor
PROFILE_PIECES = 60  # of a pitch of the profile, on the written surfaces
WHOLE, ANGLE, ORDER = "loads.json", "angle [deg]", "harmonic"  # file of everything; first heads of the other files
_UNITS = {"force": "N", "bearing": "N", "torque": "N m", "mass_flow": "kg/s", "volume_flow": "m^3/s"}
CELLS_ALONG = 60  # cells along the rotor
DATA = "/mesh/points", "/mesh/cells"


class Harmonic(NamedTuple):
    """One harmonic: number, frequency [Hz], amplitude in the unit of its curve, phase [rad] of a cosine."""

    number: int
    frequency: float
    amplitude: float
    phase: float


def harmonics(values: Array, frequency: float) -> list[Harmonic]:
    """Return mean (number 0) and harmonics of a curve sampled evenly over one period, without its end.

    value = Σ amplitude cos(2π number t/T + phase).
    """
    found = np.fft.rfft(values) / len(values)
    numbers = range(1, min(HARMONICS, (len(values) - 1) // 2) + 1)
    mean = Harmonic(0, 0.0, float(found[0].real), 0.0)
    return [mean, *(Harmonic(n, n * frequency, 2.0 * float(abs(found[n])), float(np.angle(found[n]))) for n in numbers)]


def flows_of(scene: Scene, result: Result) -> tuple[Array, dict[str, Array]]:
    """Return the angle over one pitch [rad], and mass [kg/s] and volume flows [m³/s] of all chambers through each port.

    They are positive in the machine's direction of flow, and have the names of the lines: an expander takes in through
    its `machine.discharge_port` (M150). Volume flows are at the state of the line: suction as stated, discharge at its
    pressure and at the temperature of the leaving gas. Raise UsageError where the cycle has no ports.
    """
    parts = build_parts(scene)
    pitch, life = parts.geometry.pitch, math.radians(float(result.cycle["angle"][-1]))
    angle = np.arange(FLOW_POINTS) * pitch / FLOW_POINTS
    chambers = angle[:, None] + pitch * np.arange(max(1, round(life / pitch)))
    figures, found = result.performance, {}
    ported = any(f"mass_flow_{line}_port" in result.cycle for line in LINES)
    for line, sign in LINES.items() if ported else ():
        traces = list(_through(parts, line, result.cycle))
        if traces:
            flow = np.interp(chambers, np.radians(result.cycle["angle"]), sum(traces))
            found[f"{line}_mass_flow"] = sign * flow.sum(axis=1)
            density = parts.gas.density(float(figures[f"{line}_pressure"]), float(figures[f"{line}_temperature"]))
            found[f"{line}_volume_flow"] = found[f"{line}_mass_flow"] / density
    if not found and scene.machine.kind != TWIN_SCREW:
        raise UsageError(f"loads are those of a {TWIN_SCREW}, whose ports have flows of their own (name such a scene)")
    if not found:
        raise UsageError("the cycle has no flow through a port (add effects.suction_port and effects.discharge_port)")
    return angle, found


def _through(parts: Parts, line: str, cycle: Mapping[str, Array]) -> Iterator[Array]:
    """Yield the flows [kg/s] of a chamber through each opening to a line, over the angles of a cycle.

    A slide valve opens to both lines, one after the other, and has one curve.
    """
    angle = np.radians(cycle["angle"])
    begins: dict[str, dict[str, float]] = {}
    for name, path in parts.ports:
        if path.to in LINES and f"mass_flow_{name}" in cycle:
            begins.setdefault(name, {})[path.to] = min(path.breakpoints, default=0.0)
    for name, at in begins.items():
        if line not in at:
            continue
        flow, last = cycle[f"mass_flow_{name}"], max(at, key=lambda each: at[each])
        if len(at) > 1:
            flow = np.where((angle >= at[last]) == (line == last), flow, 0.0)
        yield flow


@dataclass(frozen=True, eq=False)
class ExportedLoads:
    """Results to export: curves over one pitch [rad] by group, spectra by curve, lobe frequency [Hz], and omissions.

    `supports`: where what holds each rotor is, its length [m] with it; None without forces.
    """

    title: str
    frequency: float
    curves: Mapping[str, tuple[Array, Mapping[str, Array]]]
    spectra: Mapping[str, Sequence[Harmonic]]
    without: str
    supports: tuple[Supports, float] | None = None


def loads(scene: Scene, result: Result, spans: Spans | None = None, shafts: Diameters | None = None) -> ExportedLoads:
    """Return loads and flows of a result that keeps its cycle; for rotors without a profile only the flows.

    `spans` and `shafts` [m] are those of `rotor_supports.supports_of`, which takes what is None from the scene.
    """
    speed = rotor_speed(result.performance, scene.operation.speed)
    frequency = speed / build_parts(scene).geometry.pitch  # [Hz] at which chambers pass
    curves, supports = {"flows": flows_of(scene, result)}, None
    if not has_rotors(scene):
        without = "forces and surfaces need rotors with a profile (machine.volume.law: profile)"
    else:
        pressures, without = pressures_of(twin_screw(scene.machine), result), ""
        supports = supports_of(scene, result, spans, shafts), pressures.laid.rotors.length
        curves["forces"] = loads_of(pressures, supports[0])
    spectra = {name: harmonics(values, frequency) for _, columns in curves.values() for name, values in columns.items()}
    return ExportedLoads(scene.title, frequency, curves, spectra, without, supports)


def has_rotors(scene: Scene) -> bool:
    """Tell whether a scene has rotors with known surfaces, as those with a profile."""
    return scene.machine.kind == TWIN_SCREW and twin_screw(scene.machine).volume.from_rotors


def check_rotors(scene: Scene, option: str) -> None:
    """Raise UsageError where an option of forces and surfaces is given and the scene has no rotors for them."""
    if option and not has_rotors(scene):
        what = "applies to forces and surfaces of rotors with a profile"
        profile = "write machine.volume.law: profile, or " if scene.machine.kind == TWIN_SCREW else ""
        raise UsageError(f"{option}: {what} ({profile}remove {option}: flows are written)")


def protect_other_loads(folder: Path) -> None:
    """Raise UsageError where a folder holds other files under the names of curves, spectra or the whole document."""
    for group in ("flows", "forces"):
        protect_other_text({folder / f"{group}.csv": ANGLE, folder / f"{group}_spectrum.csv": ORDER})
    protect_other_json(folder / WHOLE, "lobe_frequency", "curves", "spectra")


def write_loads(scene: Scene, result: Result, found: ExportedLoads, folder: Path, steps: int) -> list[str]:
    """Write curves and spectra as CSV, all of it as JSON, the surfaces as XDMF; return the paths."""
    make_folder(folder)
    files = []
    for group, (angle, columns) in found.curves.items():
        heads = [ANGLE, *(f"{name} [{unit_of(name)}]" for name in columns)]
        rows = zip(np.degrees(angle).tolist(), *(values.tolist() for values in columns.values()), strict=True)
        files.append(write_csv(folder / f"{group}.csv", heads, rows))
        files.append(_write_spectra(folder / f"{group}_spectrum.csv", {name: found.spectra[name] for name in columns}))
    text = json.dumps(document(found), indent=1, allow_nan=False) + "\n"
    files.append(write_text(folder / WHOLE, text))
    if has_rotors(scene):
        pressures = pressures_of(twin_screw(scene.machine), result)
        speed = rotor_speed(result.performance, scene.operation.speed)
        for name, surface in zip(("male", "female"), surfaces(pressures.laid.rotors, PROFILE_PIECES), strict=True):
            files += write_surface(folder / f"{name}_rotor", surface, pressures, steps, speed)
    return files


def _write_spectra(path: Path, spectra: Mapping[str, Sequence[Harmonic]]) -> str:
    heads = [ORDER, "frequency [Hz]"]
    for name in spectra:
        heads += [f"{name} amplitude [{unit_of(name)}]", f"{name} phase [rad]"]
    numbers = range(min(map(len, spectra.values())))
    first = next(iter(spectra.values()))
    rows = [
        [n, first[n].frequency, *(part for each in spectra.values() for part in (each[n].amplitude, each[n].phase))]
        for n in numbers
    ]
    return write_csv(path, heads, rows)


def document(found: ExportedLoads) -> dict[str, Any]:
    """Return everything as one document, in SI units."""
    return {
        "title": found.title,
        "lobe_frequency": found.frequency,
        "left_out": found.without,
        "supports": {} if found.supports is None else _supports(*found.supports),
        "curves": {
            group: {
                "angle": angle.tolist(),
                "columns": {
                    name: {"units": unit_of(name), "mean": float(values.mean()), "values": values.tolist()}
                    for name, values in columns.items()
                },
            }
            for group, (angle, columns) in found.curves.items()
        },
        "spectra": {name: [row._asdict() for row in rows] for name, rows in found.spectra.items()},
    }


def _supports(supports: Supports, length: float) -> dict[str, Any]:
    """Return what holds each rotor: where its bearings are along z, its shaft, and the force of its piston.

    Each says whether it is stated; the forces are those of the value also where it is assumed.
    """
    found = {}
    for name, (before, after), shaft, push, located, sized in zip(NAMES, *supports, strict=True):
        at = {"suction_bearing_z": 0.0 - before, "discharge_bearing_z": length + after}
        at |= {"suction_bearing_distance": before, "discharge_bearing_distance": after}
        rows = [("rotor_length", length, True), *((key, value, located) for key, value in at.items())]
        rows.append(("shaft_diameter", shaft, sized))
        lengths = {key: {"units": "m", "value": value, "stated": stated} for key, value, stated in rows}
        found[name] = {**lengths, "balance_piston_force": {"units": "N", "value": push, "stated": True}}
    return found


def unit_of(name: str) -> str:
    """Return the unit of a curve from its name."""
    return next(unit for word, unit in _UNITS.items() if word in name)


def mesh(surface: Surface, pressures: Pressures, along: int = CELLS_ALONG) -> tuple[Array, Array]:
    """Return points (n, 3) [m] and cells (m, 4) of a rotor in its own frame."""
    rotors = pressures.laid.rotors
    z = np.linspace(0.0, rotors.length, along + 1)
    lobe = np.arange(surface.lobes)[:, None, None] * surface.pitch
    turned = lobe - surface.turns * (z / rotors.h)[None, None, :]
    x, y = surface.x[None, :, None], surface.y[None, :, None]
    c, s = np.cos(turned), np.sin(turned)
    axial = np.broadcast_to(z, (*turned.shape[:1], len(surface.x), len(z)))
    points = np.stack([c * x - s * y, s * x + c * y, axial], -1)
    number = np.arange(points[..., 0].size).reshape(points.shape[:3])
    corners = (number[:, :-1, :-1], number[:, 1:, :-1], number[:, 1:, 1:], number[:, :-1, 1:])
    return points.reshape(-1, 3), np.stack([corner.ravel() for corner in corners], -1)


def write_surface(stem: Path, surface: Surface, pressures: Pressures, steps: int, speed: float) -> list[str]:
    """Write the surface with pressures over one revolution and return both paths; `speed` is the male's [rad/s]."""
    turn = 2.0 * math.pi / abs(surface.turns)  # male angle during one revolution of this rotor
    angles = np.arange(steps) * turn / steps
    points, cells = mesh(surface, pressures)
    rotors = pressures.laid.rotors
    z = np.linspace(0.0, rotors.length, CELLS_ALONG + 1)
    middle = 0.5 * (z[1:] + z[:-1])
    turned = pressures.turned(angles).tolist()
    found = [pressures.at(chamber_angles(surface, rotors, phi, middle)) - pressures.low for phi in turned]
    values = np.stack([each.ravel() for each in found])
    data, text = stem.with_suffix(".h5"), stem.with_suffix(".xdmf")
    with replacing(data) as temporary, new_hdf5(temporary) as file:
        file.create_dataset("mesh/points", data=points, compression="gzip")
        file.create_dataset("mesh/cells", data=cells.astype(np.int64), compression="gzip")
        for number, row in enumerate(values):
            file.create_dataset(f"pressure/{number}", data=row, compression="gzip")
    write_text(text, xdmf(data.name, len(points), len(cells), [float(a) / speed for a in angles]))
    return [str(text), str(data)]


def xdmf(data: str, points: int, cells: int, times: list[float]) -> str:
    """Return the description of a mesh with one field per time [s]."""
    mesh_text = f"""    <Grid Name="mesh" GridType="Uniform">
      <Geometry GeometryType="XYZ">{_item(data, DATA[0], f"{points} 3", "Float")}</Geometry>
      <Topology TopologyType="Quadrilateral" NumberOfElements="{cells}" NodesPerElement="4">
        {_item(data, DATA[1], f"{cells} 4", "Int")}</Topology>
    </Grid>"""
    shared = '<xi:include xpointer="xpointer(//Grid[@Name=&quot;mesh&quot;]/*[self::Topology or self::Geometry])"/>'
    steps = "\n".join(
        f"""      <Grid>{shared}<Time Value="{time!r}"/>
        <Attribute Name="pressure" AttributeType="Scalar" Center="Cell">
          {_item(data, f"/pressure/{number}", str(cells), "Float")}</Attribute></Grid>"""
        for number, time in enumerate(times)
    )
    return f"""<?xml version="1.0"?>
<Xdmf Version="3.0" xmlns:xi="http://www.w3.org/2001/XInclude">
  <Domain>
    <Grid Name="TimeSeries" GridType="Collection" CollectionType="Temporal">
{steps}
    </Grid>
{mesh_text}
  </Domain>
</Xdmf>
"""


def _item(data: str, path: str, shape: str, kind: str) -> str:
    name = quoteattr(path)[1:-1]
    return f'<DataItem DataType="{kind}" Dimensions="{shape}" Format="HDF" Precision="8">{data}:{name}</DataItem>'
