"""The layout of all arrays by name: the indices that a network's texts use, each defined only here.

States are in y as `S_T` …, areas in E as `A_tip_leakage_ahead` …, port states of chambers and lines in E as `E_ahead_4`
or `E_discharge_line`, those of lines and plenums in R as `R_discharge_line` …, flows as `FLOW_tip_leakage_ahead` …,
quadratures as `Q_work` …; `slots` describes the arrays. Paths of one effect are numbered.
"""

from collections.abc import Iterable, Sequence
from functools import lru_cache

from screwsim.model.network.network import Gap, Network, Port, identifier
from screwsim.model.own_cells import AFTER_STOPS, FED, own_cells
from screwsim.model.slots import E_AREAS, P_PORT_WIDTH, PORT_STATE

WAYS = ("ahead", "behind")  # the two sides of a gap


class Layout:
    """Names of the indices of a network's texts, and their numbers."""

    def __init__(self, network: Network) -> None:
        self._network = network
        ports = [each.effect for each in network.ports]
        several = {effect for effect in ports if ports.count(effect) > 1}
        names = [f"{each.effect}_to_{each.cell}" if each.effect in several else each.effect for each in network.ports]
        self._labels = labels(*names, *(each.effect for each in network.gaps))

    def label(self, path: Port | Gap) -> str:
        """Return the name of a port or gap, as part of an identifier."""
        return self._labels[path.index + (0 if isinstance(path, Port) else len(self._network.ports))]

    # ---- names -------------------------------------------------------------------------------------------------

    def of_path(self, path: Port | Gap, way: str) -> str:
        """Return the name of a port, or of one side of a gap."""
        return f"{self.label(path)}_{way}" if way else self.label(path)

    def area(self, path: Port | Gap, way: str = "") -> str:
        """Return the index in E of an area; without a side for a gap of all chambers together."""
        return f"A_{self.of_path(path, way)}"

    def area_at(self, path: Port | Gap, phi: str) -> str:
        """Return a call for the area [m²] of a port or gap at an angle."""
        return f"area__{self.label(path)}({phi}, P, TAB)"

    def flow(self, path: Port | Gap, way: str = "") -> str:
        """Return the index of a path's flow among those into a chamber."""
        return f"FLOW_{self.of_path(path, way)}"

    def film(self, path: Port | Gap, way: str = "") -> str:
        """Return the index of the oil beside a path's gas among those into a chamber."""
        return f"FILM_{self.of_path(path, way)}"

    def neighbour(self, side: int, way: str) -> str:
        """Return the name of the chamber some lobe pitches ahead or behind: `ahead_4`."""
        return f"{way}_{self._network.offsets[side]}"

    def share(self, port: Port, what: str) -> str:
        """Return where a chamber's own port state has the open share (`OPENED`) or the switch (`HELD`) of a port."""
        return f"own[{what}_{self.label(port)}]"

    def line(self, cell: str, together: bool = False) -> tuple[str, str]:
        """Return array and index of the port state of a line or plenum; in E where lines pulsate (M184)."""
        if self._network.pulsating:
            return "E", f"{'ALL' if together else 'E'}_{cell}"
        return "R", f"R_{cell}"

    @property
    def stops(self) -> list[str]:
        """The names of everything that moves between a seat and a stop: those of the positions."""
        return [each.position for each in self._network.stops]

    @property
    def heats(self) -> tuple[str, ...]:
        """The names of all heats: from the oil, then from walls."""
        return labels(*(each.effect for each in (*self._network.heats, *self._network.walls)))

    @property
    def walls(self) -> tuple[str, ...]:
        """The names of the walls."""
        return self.heats[len(self._network.heats) :]

    # ---- numbers -----------------------------------------------------------------------------------------------

    @property
    def flows(self) -> list[str]:
        """The names of all flows into a chamber: ports, then each gap ahead and behind."""
        network = self._network
        return [*(self.flow(each) for each in network.ports), *(self.flow(*each) for each in self.sides)]

    @property
    def sides(self) -> list[tuple[Gap, str]]:
        """Each gap with its side ahead, and with its side behind."""
        return [(gap, way) for gap in self._network.gaps for way in WAYS]

    @property
    def oil_beside(self) -> list[tuple[Port | Gap, str]]:
        """The sides of all gaps, then the ports that oil passes beside the gas: in the order of the oil into it."""
        return [*self.sides, *((port, "") for port in self._network.ports if port.oily)]

    @property
    def met(self) -> list[str]:
        """The names of all neighbours, in the order of their indices."""
        return [self.neighbour(side, way) for side in range(len(self._network.offsets)) for way in WAYS]

    @property
    def lines(self) -> int:
        """The index in one chamber's E where the port states of pulsating lines begin."""
        network = self._network
        return E_AREAS + len(network.ports) + 2 * len(network.gaps) + (PORT_STATE + 1) * len(self.met)

    @property
    def size(self) -> int:
        """The number of entries in E for each of all chambers together."""
        return E_AREAS + len(self._network.ports) + len(self._network.gaps)

    def constants(self, columns: Sequence[str], quadratures: Sequence[str]) -> dict[str, int]:
        """Return the values of all names; a history has `columns` beyond the states."""
        network, ports = self._network, len(self._network.ports)
        cells = [(number, cell) for number, cell in enumerate(network.cells) if cell]
        opened = [port for port in network.ports if port.opening]
        own = own_cells(ports, len(network.stops))
        areas = [*(self.area(each) for each in network.ports), *(self.area(*each) for each in self.sides)]
        neighbours = {
            f"E_{each}": self.lines + (PORT_STATE + 1) * (i - len(self.met)) for i, each in enumerate(self.met)
        }
        found = {
            **_counted("S_", network.states),
            **_counted("COLUMN_", columns, len(network.states)),
            **_counted("", areas, E_AREAS),
            **{self.area(gap): E_AREAS + ports + gap.index for gap in network.gaps},
            **neighbours,
            **_counted("HINT_", self.met),
            **{f"R_{cell}": number * PORT_STATE for number, cell in cells},
            **{f"P_WIDTH_{cell}": P_PORT_WIDTH + number for number, cell in cells},
            **{f"OPENED_{self.label(port)}": own.opened.start + port.index for port in opened},
            **{f"HELD_{self.label(port)}": own.held.start + port.index for port in opened},
            **_counted("MODE_", self.stops, own.modes.start),
            **_counted("DUE_", self.stops, own.due.start),
            **_counted("", AFTER_STOPS if network.stops else (), own.after_stops.start),
            **_counted("", FED if network.flash is not None else (), own.fed.start),
            **_counted("", self.flows),
            **_counted("PATH_", self._labels),
            **_counted("HEAT_", self.heats),
            "E_CHAMBER": self.size,
            **_counted("", (self.film(*each) for each in self.oil_beside)),
            **{f"LINE_{cell}": number for number, cell in cells[:2]},
            **{f"OF_{quantity}": i for i, quantity in enumerate(network.quantities)},
            **_counted("", map(place_of_sum, [*quadratures, "q_crossing"])),
        }
        if network.pulsating:
            found |= {f"E_{cell}": self.lines + number * PORT_STATE for number, cell in cells}
            found |= {f"ALL_{cell}": network.chambers * self.size + number * PORT_STATE for number, cell in cells}
        return found


def _counted(head: str, names: Iterable[str], first: int = 0) -> dict[str, int]:
    """Return consecutive numbers by name, each with a prefix."""
    return {f"{head}{name}": i for i, name in enumerate(names, first)}


@lru_cache(maxsize=256)
def labels(*names: str) -> tuple[str, ...]:
    """Return names as parts of identifiers, made unique: the second of a name ends with 2 …."""
    found: list[str] = []
    for name in map(identifier, names):
        label, again = name, 2
        while label in found:
            label, again = f"{name}_{again}", again + 1
        found.append(label)
    return tuple(found)


def place_of_sum(name: str) -> str:
    """Return the name of a quadrature's index, from its local name `q_…`."""
    return name.replace("q_", "Q_", 1)
