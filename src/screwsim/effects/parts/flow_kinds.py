"""Kinds of flow through a path: which streams pass it, and how they follow from the port states on both sides.

A kind is one class. It says all that the network has to know of it: the kernels it calls, the streams it consists of,
what a scene may compare and check. The network knows streams alone: it adds them to the sums of the balances, takes
their derivatives, and reads them again for traces, balances and the ledger.

Source: docs/model.md M10–M13, M190, M252, M256.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import ClassVar, NamedTuple

from screwsim.numerics.kernel import Kernel
from screwsim.numerics.path_stream import GAS, OIL, PathStream

SIDES = ("1", "own"), ("2", "beyond")  # in the names of a `Law`: whose port state
PORT_STATE = ("p", "rho", "h", "exponent", "oil_ratio")  # numbers of a port state that a `Law` may ask for


class Bounds(NamedTuple):
    """Where the values of a kernel must lie, with what it is and its unit."""

    what: str
    unit: str
    least: float
    most: float = float("inf")


@dataclass(frozen=True)
class FlowKind:
    """A kind of flow: a frozen dataclass whose kernels are fields, named in `roles`.

    `values` are numbers [SI] of the kernels' arguments, beside those of the path. `title` describes it for `screwsim
    explain`; empty for a nozzle. Other fields are taken as part of the text: scenes that differ in them share none.
    """

    values: Mapping[str, float] = field(default_factory=dict, kw_only=True)
    title: str = field(default="", kw_only=True)

    # the fields with kernels, None where one is not used: the arguments that the statements set
    roles: ClassVar[Mapping[str, tuple[str, ...]]] = MappingProxyType({})
    # of those of them that are checked along a closed cycle: their arguments are among flux, density, oil_ratio, drop
    bounds: ClassVar[Mapping[str, Bounds]] = MappingProxyType({})
    in_gaps_alone: ClassVar[bool] = False  # whether it belongs between chambers, not to lines and plenums

    def kernels(self) -> dict[str, Kernel]:
        """Return the kernels that are used, by their roles."""
        found = {role: getattr(self, role) for role in self.roles}
        return {role: kernel for role, kernel in found.items() if kernel is not None}

    def streams(self, calls: Mapping[str, str]) -> Sequence[PathStream]:
        """Return the streams: one of gas, then any of oil; `calls` are the calls of the kernels by role."""
        raise NotImplementedError

    def with_oil(self) -> bool:
        """Return whether oil passes beside the gas."""
        return any(each.of == OIL for each in self.streams(dict.fromkeys(self.roles, "")))


NOZZLE_STREAM = (PathStream(GAS, (), "{nozzle}"),)


@dataclass(frozen=True)
class Nozzle(FlowKind):
    """A nozzle of the path's area (M12, M13)."""

    def streams(self, calls: Mapping[str, str]) -> Sequence[PathStream]:
        """Return the stream of gas."""
        return NOZZLE_STREAM


NOZZLE = Nozzle()


@dataclass(frozen=True)
class Law(FlowKind):
    """A flux of gas by a law of its own.

    `flux` returns the mass flux [kg/(m² s)] over the area into the chamber, from the chamber's own port state, `p_1`
    [Pa], `rho_1` [kg/m³], `h_1` [J/kg], `exponent_1` (1/k), `oil_ratio_1` (0 without carried oil), and the port state
    beyond, `p_2` …; with `width`, values and symbols. It must be smooth, zero at equal pressures, have the sign of
    p_2 − p_1, and be the same with the opposite sign where both port states change places.
    """

    flux: Kernel

    roles = MappingProxyType({"flux": (*(f"{name}_{side}" for side in "12" for name in PORT_STATE), "width")})

    def streams(self, calls: Mapping[str, str]) -> Sequence[PathStream]:
        """Return the stream of gas."""
        stands = {f"{name}_{side}": f"{whose}.{name}" for side, whose in SIDES for name in PORT_STATE}
        stands["width"] = "width"
        asked = (name for name in self.flux.arguments if name in stands)
        return (PathStream(GAS, [f"{name} = {{{stands[name]}}}" for name in asked], calls["flux"]),)


@dataclass(frozen=True)
class Resistance(FlowKind):
    """Flow resistance of a gap between chambers, beyond that of a nozzle (M190), and oil that passes beside the gas.

    `share` returns the share, 0 to 1, of the nozzle's mass flux `flux` [kg/(m² s)] that passes. It may take the
    upstream port state's `oil_ratio` and `density` [kg/m³], numbers of `values`, and symbols. It must be smooth, and
    flux times share must grow with the flux.

    `film`, where given, returns the mass flux of oil [kg/(m² s)] over the gap's area that flows in addition to the gas
    and the oil in the gas (M252), at the pressure difference `drop` ≥ 0 [Pa] from the upstream to the downstream port
    state. It may take the upstream `oil_ratio` and the like; it must be smooth, and zero without a drop and without
    oil.

    `drag`, where given, returns the mass flux of oil [kg/(m² s)] that a moving wall drags along, from the leading port
    state to the trailing chamber whatever their pressures (M256). It may take the leading port state's `oil_ratio`, and
    is zero without oil. It holds at the mean speed of the rotors, and is scaled with the speed.
    """

    share: Kernel
    film: Kernel | None = None
    drag: Kernel | None = None

    roles = MappingProxyType(
        {"share": ("flux", "density", "oil_ratio"), "film": ("drop", "oil_ratio"), "drag": ("oil_ratio",)}
    )
    bounds = MappingProxyType(
        {
            "share": Bounds("share of a gap", "", 0.0, 1.0),
            "film": Bounds("film of oil", "kg/(m² s)", 0.0),
            "drag": Bounds("dragged oil", "kg/(m² s)", 0.0),
        }
    )
    in_gaps_alone = True

    def with_oil(self) -> bool:
        """Return whether oil passes beside the gas."""
        return self.film is not None or self.drag is not None

    def streams(self, calls: Mapping[str, str]) -> Sequence[PathStream]:
        """Return the stream of gas, and those of oil beside it."""
        before = ["nozzle = {nozzle}"]
        before += ["if nozzle >= 0.0:", "    density = {beyond.rho}", "    oil_ratio = {beyond.oil_ratio}"]
        before += ["else:", "    density = {own.rho}", "    oil_ratio = {own.oil_ratio}"]
        found = [PathStream(GAS, [*before, "flux = abs(nozzle)"], f"nozzle * {calls['share']}")]
        if self.film is not None:
            film = calls["film"]
            before = ["drop = {beyond.p} - {own.p}"]
            before += ["if drop >= 0.0:", "    oil_ratio = {beyond.oil_ratio}", f"    film = {film}"]
            before += ["else:", "    oil_ratio = {own.oil_ratio}", "    drop = -drop", f"    film = -{film}"]
            found.append(PathStream(OIL, before, "film"))
        if self.drag is not None:
            before = ["oil_ratio = {leading.oil_ratio}", f"drag = {calls['drag']}{{per_slow}}"]
            found.append(PathStream(OIL, before, "drag", driven=True))
        return found
