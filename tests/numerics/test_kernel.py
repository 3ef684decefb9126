"""Flattening: names, constants, slots, refusals, and text that follows every edit."""

import importlib
import inspect
import math
import os
import textwrap
from types import FunctionType

import numpy as np
import pytest

from screwsim.numerics.kernel import HEADER, Slot, Structure, flatten, kernel, math_spelling, source_of, written

FACTOR = 2.5
TABLE = np.array((1.0, 2.0))
law = Slot("law")
EXTRA = Structure("EXTRA")


@kernel
def inner(x):
    """Return FACTOR · x."""
    return FACTOR * x


@kernel
def outer(x: float) -> float:
    return inner(x) + TABLE[1] + math.sqrt(x)


@kernel
def slotted(x):
    return law(x) + inner(x)


@kernel
def above_slot(x):
    return slotted(x)


@kernel
def foreign(x):
    return os.getpid() + x


@kernel
def unknown(x):
    return helper(x)


def helper(x):
    return x


HERE = inner.flat_name.removesuffix("inner")  # this file, as flat names spell it


def run(text: dict[str, str], **names):
    space = {"math": math, "np": np, **names}
    exec("\n\n".join(text.values()), space)
    return space


ODDLY_LAID_OUT = [
    "def f(x):\n    return x\n\n# behind\nBEHIND = 1\n",
    "def f(\n    x,\n) -> float:\n    return (\n        x\n)\n\n\ndef g(x):\n    return 0\n",
    "@str\ndef f(x):\n# at the edge\n    y = x\n\n# and again\n\n    return y\nx = 1\n",
    'def f(x):\n    \'a\'\n    y = """\nat the edge\n"""\n    return y\nx = 1\n',
    "if True:\n    def f(x):\n        return x\n    g = 1\n",
    "f = lambda x: x\n",
]


@pytest.mark.parametrize("text", ODDLY_LAID_OUT)
def test_a_functions_text_is_that_which_python_reads(tmp_path, text):
    path = tmp_path / "odd.py"
    path.write_text(text)
    space = {"__name__": "odd", "str": lambda f: f}
    exec(compile(text, str(path), "exec"), space)
    assert source_of(space["f"]).rstrip() == textwrap.dedent(inspect.getsource(space["f"])).rstrip()


def test_a_functions_text_is_that_of_the_file_as_it_is(tmp_path):
    path, texts = tmp_path / "edited.py", []
    for number in (1, 22):
        path.write_text(f"def f(x):\n    return {number} * x\n")
        space = {"__name__": "edited"}
        exec(compile(path.read_text(), str(path), "exec"), space)
        texts.append(source_of(space["f"]))
    assert [text.count("22 * x") for text in texts] == [0, 1]


def test_names_carry_the_file():
    assert "test_kernel__" in HERE
    assert set(flatten((outer,))) == {HERE + name for name in ("FACTOR", "TABLE", "inner", "outer")}


def test_callees_come_first():
    order = list(flatten((outer,)))
    assert order.index(HERE + "inner") < order.index(HERE + "outer")


def test_the_flat_text_computes_the_same():
    assert run(flatten((outer,)))[HERE + "outer"](4.0) == outer(4.0)


def test_a_slot_takes_the_name_that_fills_it():
    space = run(flatten((slotted,), {"law": "mine"}), mine=lambda x: 100.0 * x)
    assert space[HERE + "slotted"](1.0) == 102.5


def test_kernels_above_a_slot_are_named_by_their_instance():
    text = flatten((above_slot,), {"law": "mine"}, "_a")
    assert {HERE + "above_slot_a", HERE + "slotted_a", HERE + "inner"} <= set(text)


def test_a_slot_outside_a_module_says_so():
    with pytest.raises(RuntimeError, match="law exists only inside a generated module"):
        slotted(1.0)


def test_a_foreign_module_is_refused():
    with pytest.raises(TypeError, match="foreign uses module os"):
        flatten((foreign,))


def test_a_plain_function_is_refused():
    with pytest.raises(TypeError, match="unknown uses helper"):
        flatten((unknown,))


def test_the_header_imports_what_kernels_may_use():
    compile(HEADER, "header", "exec")
    assert all(name in HEADER for name in ("math", "numpy as np"))


def test_two_files_of_one_name_do_not_take_each_others_kernels():
    """A user's own my_package/tip_leakage.py beside the built-in one: the names must differ, or be refused."""

    def of_module(item, module):
        copied = FunctionType(item.function.__code__, item.function.__globals__, item.__name__)
        copied.__module__ = module
        return kernel(copied)

    first, second = of_module(inner, "package_a.gap"), of_module(inner, "package_b.gap")
    try:
        text = flatten((first, second))
    except TypeError:
        return
    assert len([name for name in text if name.endswith("inner")]) == 2


# ---- kernels from text -------------------------------------------------------------------------------------------

TEXT = "def twice(x):\n    return GAIN * inner(x) + TABLE[0]\n"


def test_a_written_kernel_runs_as_it_is_and_flat():
    item = written(TEXT, "R134a (E)", {"GAIN": 2.0, "inner": inner, "TABLE": TABLE})
    assert item.arguments == ("x",) and item(3.0) == 2.0 * 7.5 + 1.0
    assert run(flatten((item,)))[item.flat_name](3.0) == item(3.0)


def test_a_written_kernel_is_named_by_what_it_is_of_and_a_hash():
    item = written(TEXT, "R134a (E)", {"GAIN": 2.0, "inner": inner, "TABLE": TABLE})
    assert item.flat_name.startswith("r134a_e_") and item.flat_name.endswith("__twice")


def test_one_text_is_one_kernel_and_another_is_another():
    uses = {"GAIN": 2.0, "inner": inner, "TABLE": TABLE}
    first = written(TEXT, "gas", uses)
    assert written(TEXT, "gas", dict(uses)) is first
    others = (written(TEXT.replace("+", "-"), "gas", uses), written(TEXT, "gas", uses | {"GAIN": 3.0}))
    assert len({first.flat_name, *(other.flat_name for other in others)}) == 3
    assert set(flatten((first, *others))) >= {first.flat_name, *(other.flat_name for other in others)}


def test_nothing_is_rounded_otherwise_than_it_is_written():
    """Where the compiler may join or reorder operations, the last bits depend on what is compiled together."""
    item = written("def once(x):\n    return 2.0 * x + 1.0\n", "gas")
    texts = [flatten((item,))[item.flat_name], flatten((inner,))[HERE + "inner"]]
    assert not any("fastmath" in text for text in texts)


@kernel
def structured(x):
    return EXTRA * x


def test_a_number_of_the_composition_is_a_constant_of_the_text():
    """`Structure`: two compositions have two texts; where an instance is named and slots are used, it names it, too."""
    for number in (0, 2):
        found = flatten((structured,), numbers={"EXTRA": number})
        assert f"{HERE}EXTRA = {number}" in found.values()
        assert run(found)[structured.flat_name](3.0) == 3.0 * number


def test_a_package_with_a_hyphen_gives_names_that_python_takes(tmp_path, monkeypatch):
    (tmp_path / "my-package").mkdir()
    text = "from screwsim.numerics.kernel import kernel\n\nSIZE = 2.0\n\n\n@kernel\ndef area(x):\n    return SIZE * x\n"
    (tmp_path / "my-package" / "effect.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    area = importlib.import_module("my-package.effect").area
    found = flatten((area,))
    assert run(found)[area.flat_name](3.0) == 6.0


def test_a_function_that_was_imported_from_math_is_refused_with_how_to_write_it():
    assert math_spelling(math.sqrt) == " (import math, and write math.sqrt)"
    assert math_spelling(len) == math_spelling(None) == math_spelling(2.0) == ""


def test_a_fluid_whose_name_begins_with_a_digit_has_names_that_python_takes():
    """1-Butene: its chamber's text could not be parsed."""
    found = written("def state(T):\n    return 2.0 * T\n", "1-Butene_equilibrium")
    assert found.flat_name.isidentifier() and found(3.0) == 6.0
