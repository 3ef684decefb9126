"""Pressures on a rotor's surface over one revolution, for finite elements: XDMF text beside HDF5.

The mesh is in the rotor's own frame, with z along its axis from the suction end; cells have the pressure above suction,
one field per step of the revolution.
"""

import math
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from screwsim.export.rotor_loads import Pressures
from screwsim.export.rotor_surface import Surface, chamber_angles
from screwsim.machine.rotors.pair import Array
from screwsim.results.atomic import replacing, write_text
from screwsim.results.guarded import new_hdf5

CELLS_ALONG = 60  # cells along the rotor
DATA = "/mesh/points", "/mesh/cells"


def mesh(surface: Surface, pressures: Pressures, along: int = CELLS_ALONG) -> tuple[Array, Array]:
    """Return points (n, 3) [m] and cells (m, 4) of a rotor in its own frame."""
    rotors = pressures.laid.rotors
    z = np.linspace(0.0, rotors.length, along + 1)
    lobe = np.arange(surface.lobes)[:, None, None] * surface.pitch
    turned = lobe - surface.turns * (z / rotors.h)[None, None, :]
    x, y = surface.x[None, :, None], surface.y[None, :, None]
    c, s = np.cos(turned), np.sin(turned)
    points = np.stack(
        [c * x - s * y, s * x + c * y, np.broadcast_to(z, (*turned.shape[:1], len(surface.x), len(z)))], -1
    )
    number = np.arange(points[..., 0].size).reshape(points.shape[:3])
    corners = (number[:, :-1, :-1], number[:, 1:, :-1], number[:, 1:, 1:], number[:, :-1, 1:])
    return points.reshape(-1, 3), np.stack([each.ravel() for each in corners], -1)


def write_surface(stem: Path, surface: Surface, pressures: Pressures, steps: int, speed: float) -> list[str]:
    """Write the surface with pressures over one revolution and return both paths; `speed` is the male's [rad/s]."""
    turn = 2.0 * math.pi / abs(surface.turns)  # male angle during one revolution of this rotor
    angles = np.arange(steps) * turn / steps
    points, cells = mesh(surface, pressures)
    rotors = pressures.laid.rotors
    z = np.linspace(0.0, rotors.length, CELLS_ALONG + 1)
    middle = 0.5 * (z[1:] + z[:-1])
    found = [pressures.at(chamber_angles(surface, rotors, float(phi), middle)) - pressures.low for phi in angles]
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
