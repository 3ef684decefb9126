"""What a file of stages simulates, in words: what lies between both, then each stage as a scene."""

import textwrap

from screwsim.explain import WIDTH, explain
from screwsim.inputs.declare import KINDS
from screwsim.scene.lines import lines
from screwsim.scene.units import readable_quantity
from screwsim.study.stages.read import BETWEEN, NAMES, Chain, Intercooler


def explain_stages(chain: Chain) -> str:
    """Return the text. Raises UsageError for a fluid that is not there."""
    p_s, p_d = lines(chain.first).p_s, lines(chain.second).p_d
    ends = " to ".join(readable_quantity(KINDS["pressure"], p) for p in (p_s, p_d))
    found = (
        f"Two stages, {ends}. The pressure between them is found: that at which what the first stage gives is what the "
        f"second one takes (M200). {_between(chain.intercooler)} The discharge line of the first scene and the suction "
        "line of the second follow from that, in place of what these scenes state."
    )
    head = [chain.title] if chain.title else []
    blocks = [*head, textwrap.fill(found, WIDTH)]
    for name, scene in zip(NAMES, (chain.first, chain.second), strict=True):
        title = f"The {name} stage"
        blocks += [f"{title}\n{'=' * len(title)}", str(explain(scene))]
    return "\n\n".join(blocks)


def _between(between: Intercooler) -> str:
    words = BETWEEN[between.kind]
    if between.outlet_temperature is not None:
        words = words.format(T=readable_quantity(KINDS["temperature"], between.outlet_temperature))
    if between.pressure_drop > 0.0:
        lost = readable_quantity(KINDS["pressure_difference"], between.pressure_drop)
        words += f" Both lines differ by a pressure drop of {lost}."
    return words
