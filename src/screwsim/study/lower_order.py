"""A cycle integrated by Rodas3 instead of Rodas4, all else as it is: what the order of the method is worth.

For studies of cost and accuracy (`screwsim accuracy`): it saves next to nothing where few digits are asked for, and
costs more where more are, so `numerics.integrator` does not know it.
"""

from __future__ import annotations

import re
from dataclasses import replace

from screwsim.model.run import Machinery
from screwsim.numerics import rodas3
from screwsim.numerics.kernel import constant_text
from screwsim.scene.types import Scene
from screwsim.solution import Solution


def with_rodas3(text: str) -> str:
    """Return a model's text with the constants of the other method."""
    for name, value in rodas3.CONSTANTS.items():
        text, found = re.subn(
            rf"^rodas__{name} = .*$", f"rodas__{name} = {constant_text(value)}", text, flags=re.MULTILINE
        )
        assert found == 1, name
    return text


def solution_with_rodas3(scene: Scene) -> Solution:
    """Return the solution of a scene whose chambers go by Rodas3."""
    solution = Solution(scene)
    composition = solution.machinery.composition
    machinery = Machinery(replace(composition, text=with_rodas3(composition.text)))
    solution.machinery = solution.balances.machinery = machinery
    return solution
