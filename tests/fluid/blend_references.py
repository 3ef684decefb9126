"""What stands beside our blends: CoolProp's states of them, teqp's models, and the points of ours that are compared."""

import json
import math
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

import screwsim.fluid
from screwsim.fluid.description import describe
from screwsim.fluid.mixture import paired
from screwsim.fluid.phase_envelope import envelope

DEPARTURES = json.loads((Path(screwsim.fluid.__file__).parent / "departures.json").read_text(encoding="utf-8"))
R = 8.31446261815324  # [J/(mol K)], CoolProp's for mixtures


def coolprop():
    return pytest.importorskip("CoolProp.CoolProp")


def reference(fluid):
    """Return CoolProp's state of a blend."""
    known = describe(fluid)
    state = coolprop().AbstractState("HEOS", "&".join(known.components))
    state.set_mole_fractions(list(known.fractions))
    return state


@lru_cache
def teqp_model(fluid):
    """Return teqp's model of a blend, of CoolProp's fluids with one gas constant, and the pairs and functions here."""
    teqp, CP = pytest.importorskip("teqp"), coolprop()
    known, fluids, pairs = describe(fluid), [], []
    for name in known.components:
        found = json.loads(CP.get_fluid_param_string(name, "JSON"))
        found = found[0] if isinstance(found, list) else found
        found["EOS"][0]["gas_constant"] = R
        found["EOS"][0].pop("SUPERANCILLARY", None)  # read for seconds, and not asked for
        fluids.append(found)
    for i, j, pair in paired(known):
        ends = enumerate((naming(fluids[n], known.components[n]) for n in (i, j)), 1)
        names = {f"{what}{k}": called for k, both in ends for what, called in both}
        numbers = zip(("betaT", "gammaT", "betaV", "gammaV", "F"), pair[:5], strict=True)
        pairs.append({**names, **dict(numbers), "function": pair.departure})
    named = {each["function"] for each in pairs if each["F"]}
    functions = [{"Name": name, "aliases": [], **DEPARTURES[name]} for name in sorted(named)]
    return teqp.build_multifluid_model(list(map(json.dumps, fluids)), "", json.dumps(pairs), {}, json.dumps(functions))


def naming(fluid, name):
    return ("Name", name), ("CAS", fluid["INFO"]["CAS"])


@lru_cache
def traced(fluid):
    return envelope(describe(fluid))


def phases(fluid, T, side):
    """Return the moles per volume of liquid and vapour at a dew (-1) or bubble point (+1)."""
    around = traced(fluid)
    u, f = around.phases(np.array([side * math.sqrt(1.0 - T / around.T_m)]))[:, 0], around.f
    w, z = f.z * np.exp(u[: f.n] + u[f.n]), f.z * math.exp(u[f.n + 1])
    return (w, z) if side < 0 else (z, w)
