"""Two stages described: what lies between them, and what is simulated of each."""

import textwrap

from screwsim.explain import explain
from screwsim.explain.parameters import WIDTH
from screwsim.inputs.declare import KINDS
from screwsim.scene.lines import lines
from screwsim.scene.units import readable_quantity, to_customary
from screwsim.study.stages.axes import INTERCOOLER_KINDS
from screwsim.study.stages.chain import StageChain


def explain_stages(chain: StageChain) -> str:
    """Return the explanation as text. Raises UsageError for a fluid that is not available."""
    p_s, p_d = lines(chain.first).p_s, lines(chain.second).p_d
    ends = " to ".join(f"{to_customary(KINDS['pressure'], p):.4g} bar" for p in (p_s, p_d))
    between = chain.intercooler
    words = INTERCOOLER_KINDS[between.kind]
    if between.outlet_temperature is not None:
        words = words.format(T=readable_quantity(KINDS["temperature"], between.outlet_temperature))
    if between.pressure_drop > 0.0:
        lost = readable_quantity(KINDS["pressure_difference"], between.pressure_drop)
        words += f" The pressure drop between both lines is {lost}."
    found = (
        f"Two stages, {ends}. The pressure between them is found so that the second stage takes what the first one "
        f"delivers (M200). {words} It replaces the discharge line that the first scene states and the suction line "
        f"that the second one states."
    )
    head = [chain.title] if chain.title else []
    blocks = [*head, textwrap.fill(found, WIDTH)]
    for name, scene in chain.by_stage.items():
        title = f"The {name} stage"
        blocks += [f"{title}\n{'=' * len(title)}", str(explain(scene))]
    return "\n\n".join(blocks)
