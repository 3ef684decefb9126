"""A figure that has the name of an axis is that axis: the file has it once."""

from pathlib import Path

from screwsim.outputs import Figures, Result
from screwsim.results import open_results
from screwsim.scene import load
from screwsim.study.sweep import run_sweep

POINT = Path(__file__).parents[2] / "configs" / "r134a" / "point.yaml"


def echoed(scene) -> Result:
    figures = Figures(oil_supply_temperature=scene.oil_supply.temperature, shaft_power=1e3)
    return Result("ok", performance=figures, error=Figures(dict.fromkeys(figures, 1e-6)))


def test_oil_supply_temperature_may_vary_where_it_is_a_figure_too(tmp_path):
    scene = load(POINT).with_({"sweep.oil_supply.temperature": ["50 degC", "60 degC"]})
    run_sweep(scene, tmp_path / "x.h5", jobs=1, simulate=echoed)
    results = open_results(tmp_path / "x.h5")
    assert results.axes["oil_supply.temperature"].tolist() == [323.15, 333.15]
    assert results.figures == ["shaft_power"]
    assert results.to_xarray(None).oil_supply_temperature.values.tolist() == [323.15, 333.15]
