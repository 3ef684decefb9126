"""What is shown by default of an air package: flow and power of the package, not of its machine alone."""

from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "configs" / "air" / "fixed_speed_7.yaml"
OWN = "package specific power", "free air delivered", "package input power"


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "package.yaml"
    path.write_text(f"base: {PACKAGE}\neffects: {{tip_leakage: {{gap: 36 um ± 5 um}}}}\n", encoding="utf-8")
    return str(path)


def test_derivatives_are_those_of_the_package(scene, command):
    answer = command("sensitivity", scene, "--local", "operation.speed")
    head = " ".join(answer.out.split("operation.speed")[0].split())  # heads are wrapped
    assert answer.code == 0 and "specific free air input" in head and "isothermal" not in head
    assert "kW/(m³/min) of package specific power" in answer.out


def test_uncertainties_begin_with_those_of_the_package(scene, command):
    told = command("run", scene).out.split("uncertain by")[1].splitlines()
    assert [line[:22].strip() for line in told if line.startswith(OWN)] == list(OWN)


def test_a_sought_speed_shows_what_the_package_takes(scene, command):
    found = command("find", scene, "--vary", "operation.speed", "--for", "free_air_delivered=16 m^3/min")
    assert found.code == 0
    assert all(f"  {name}  " in found.out for name in OWN)
