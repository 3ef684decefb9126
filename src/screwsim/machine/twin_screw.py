"""Twin-screw machines: what they offer to effects, and the bounds of their sizes."""

import math
from operator import attrgetter

from screwsim.inputs.faults import Fault
from screwsim.machine import protocol
from screwsim.machine.derived_sizes import stated_faults, table_port_faults, with_derived_sizes
from screwsim.machine.geometry import Geometry
from screwsim.machine.protocol import WIDEST, MachineKind, Measure, Size, Speed
from screwsim.machine.settings import TwinScrew, check_twin_screw


def _a_turn(machine: TwinScrew) -> float:
    """Return the volume [m³] of both bores per male lobe: the share that one chamber can have, as z1 pass in a turn."""
    both = 0.5 * math.pi * machine.rotor_diameter**2 * machine.rotor_length  # both of the male's size
    return both / machine.male_lobes


def _shell(machine: TwinScrew) -> float:
    """Return the area [m²] of both bores and their ends."""
    D, L = machine.rotor_diameter, machine.rotor_length
    return 2.0 * math.pi * D * L + math.pi * D**2


def _square(machine: TwinScrew) -> float:
    return machine.rotor_diameter**2


def _lobe(machine: TwinScrew) -> float:
    """Return the approximate height [m] of a lobe."""
    return 0.2 * machine.rotor_diameter


def _line(machine: TwinScrew) -> float:
    return machine.rotor_diameter + machine.rotor_length


_diameter = attrgetter("rotor_diameter")
_HOLDS = "of the volume that both rotors' bores offer a chamber"
_WALL = "of the area of both bores and their ends"
_D = "rotor diameters"
_ANY = 0.0
_SIZES = (
    Size("machine.rotor_length", _diameter, _D, 30.0, (0.4, 4.0), "choose shorter rotors, or a larger rotor_diameter"),
    Size(
        "machine.volume.max",
        _a_turn,
        _HOLDS,
        2.0,  # a female rotor larger than the male leaves more volume
        (0.03, 0.6),
        "choose a smaller volume, or a larger rotor_diameter or rotor_length; is the unit right?",
    ),
    Size("machine.volume.min", _a_turn, _HOLDS, 1.0, (_ANY, 0.1)),
    Size("machine.profile.centre_distance", _diameter, _D, 5.0, (0.7, 0.9)),
    Size("machine.profile.female_diameter", _diameter, _D, 5.0, (0.7, 1.1)),
    Size("machine.suction_port.area", _shell, _WALL, WIDEST, (_ANY, 0.5)),
    Size("machine.discharge_port.area", _shell, _WALL, WIDEST, (_ANY, 0.5)),
    Size("machine.suction_port.file", _shell, _WALL, math.inf, (_ANY, 0.5)),  # larger than WIDEST: see `tables`
    Size("machine.discharge_port.file", _shell, _WALL, math.inf, (_ANY, 0.5)),
    Size("oil_supply.orifice_diameter", _diameter, _D, 0.5, (_ANY, 0.2)),
)
_SCALES = {
    protocol.LOBE: Measure(_lobe, "of the height of a lobe"),
    protocol.DIAMETER: Measure(_diameter, _D),
    protocol.SQUARE: Measure(_square, "of the rotor diameter's square"),
    protocol.SPAN: Measure(_line, "of rotor diameter and length together"),
    protocol.SHELL: Measure(_shell, _WALL),
}


def _check(machine: TwinScrew) -> list[Fault]:
    found = check_twin_screw(machine)
    if not machine.volume.from_rotors and machine.profile is None:
        return list(found)
    from screwsim.machine.profile_law import check_profile_law  # here: rotors take long to import

    found = [*found, *check_profile_law(machine)]
    port = machine.discharge_port
    moves = machine.volume.from_rotors and port is not None and port.from_file
    return [*found, *table_port_faults(machine)] if moves and not found else found


def _dead_volume(machine: TwinScrew) -> tuple[str, float]:
    path = "machine.volume.min" if not machine.volume.from_file else ""
    return path, machine.volume.dead_of(Geometry(machine).swept_volume)


# [m/s] dry rotors run at 50 to 150 m/s, flooded ones slower (Brun, Kurz (eds.): Compression Machinery for Oil and Gas,
# Elsevier 2019, p. 260); how much slower is assumed: those of `validation` reach 50 m/s, the paper's sweep 67
USUAL_DRY, USUAL_WITH_OIL = 150.0, 80.0
_OFFERS = frozenset({protocol.PORTS, *protocol.GAPS, protocol.OIL, protocol.HOLES, protocol.ROTORS})
MACHINE = MachineKind(
    settings=TwinScrew,
    geometry=Geometry,
    offers=_OFFERS,
    check=_check,
    sizes=_SIZES,
    scales=_SCALES,
    speed=Speed("moves the rotors' tips at", 1000.0, USUAL_DRY, "steel bursts at about 500 m/s", USUAL_WITH_OIL),
    tables=Size("", _shell, _WALL, WIDEST, (_ANY, math.inf)),
    called=("screw", "double_screw"),
    chamber="a chamber",
    dead_volume=_dead_volume,
    derived=with_derived_sizes,
    stated=stated_faults,
)
