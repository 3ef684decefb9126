"""Slider-crank machines: what they offer to effects, and what of their sizes can be."""

from operator import attrgetter

from screwsim.machine.protocol import BORE, CYLINDER, PISTON, MachineKind, Measure, Size, Speed
from screwsim.machine.slider_crank.cylinder import Cylinder
from screwsim.machine.slider_crank.settings import SliderCrank, check_slider_crank

_bore, _piston, _swept = (attrgetter(name) for name in ("bore", "piston_area", "swept_volume"))
_BORE = "of the bore"
_SIZES = (
    Size("machine.crank_radius", _bore, _BORE, 100.0, (0.05, 5.0)),
    Size("machine.rod_length", _bore, _BORE, 1000.0, (0.1, 30.0)),
    Size("machine.clearance", _swept, "of the swept volume", 100.0, (1e-4, 0.5)),
)

MACHINE = MachineKind(
    settings=SliderCrank,
    geometry=Cylinder,
    offers=frozenset({CYLINDER}),
    check=check_slider_crank,
    sizes=_SIZES,
    scales={BORE: Measure(_bore, _BORE), PISTON: Measure(_piston, "of the piston's area")},
    speed=Speed("moves the piston, in the mean, at", 300.0, 25.0, "those of engines for races move at 25 m/s"),
    called=("piston", "reciprocating"),
    chamber="a cylinder",
    dead_volume=lambda machine: ("machine.clearance", machine.clearance),
)
