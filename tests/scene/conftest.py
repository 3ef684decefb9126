"""A complete scene, written as a person writes it; small changes of it make the cases of these tests."""

from pathlib import Path

import pytest

EXAMPLE = """\
title: example
machine:
  kind: twin_screw
  male_lobes: 4
  female_lobes: 6
  rotor_diameter: 160 mm
  rotor_length: 176 mm
  volume: {law: paper, max: 600 cm^3, phi_A: 60 deg}
  suction_port: {law: paper, area: 40 cm^2, phi_B: 60 deg}
  discharge_port: {law: paper, area: 12 cm^2, opens: 600 deg, phi_C: 640 deg}
gas:
  fluid: R134a
  model: ideal
oil:
  density: 1000 kg/m^3
  heat_capacity: 2 kJ/(kg K)
  viscosity: 20 mPa s
  transport: paper
operation:
  speed: 3000 rpm
  suction:
    pressure: 1.5 bar
    temperature: 283 K
  discharge:
    pressure: 12 bar
oil_supply:
  kind: pump
  ratio: 3
  temperature: 293 K
effects:
  suction_port:
  discharge_port:
  tip_leakage: {gap: 50 um}
  interlobe_leakage: {gap: 40 um, length: 150 mm}
  blow_hole: {area: 6 mm^2}
  end_face_leakage: {gap: 50 um, length: 80 mm}
  oil_heat:
    droplet_radius: 100 um
    heat_transfer_coefficient: 500 W/(m^2 K)
  oil_pump: {efficiency: 0.6}
  hydromechanical:
  mechanical: {fraction: 0.05}
"""


@pytest.fixture(scope="session")  # hypothesis calls a test many times with one fixture
def example() -> str:
    """Return the text of a complete scene."""
    return EXAMPLE


@pytest.fixture
def scene_file(tmp_path: Path):
    """Return a function that writes a scene into a folder of its own and gives the path."""

    def write(text: str, name: str = "x.yaml") -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write
