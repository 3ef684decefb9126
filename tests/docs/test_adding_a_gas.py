"""The page on adding a gas names all that the protocol asks, and nothing else."""

import re
from pathlib import Path

from screwsim.fluid.gas import CommonGas, Gas
from screwsim.fluid.models import GasRequest

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "adding-a-gas.md").read_text(encoding="utf-8")


def test_every_part_of_the_protocol_has_its_row():
    rows = re.findall(r"^\| (`[a-z_`, A-Z*]+) \|", PAGE, flags=re.MULTILINE)
    given = {name: star for row in rows for name, star in re.findall(r"`(\w+)`(\*?)", row)}
    of_all, of_some = ({name for name in vars(part) if not name.startswith("_")} for part in (CommonGas, Gas))
    assert given.keys() == of_all | of_some
    assert {name for name, star in given.items() if star} == of_all - of_some


def test_what_a_gas_is_made_of_is_named():
    assert set(GasRequest._fields) <= set(re.findall(r"`(\w+)", PAGE))
