"""The written text of a model states each port, gap, line and state by name, in straight lines: nothing is left to look
up or branch on while it runs that the structure of the machine knows."""

import ast
import re
from functools import cache

import pytest
from each_row import each_row
from folders import CONFIGS

from screwsim.cycle.problem import problem_of
from screwsim.model.compose import compose
from screwsim.scene import load

SCENES = {
    "paper": ("paper/point.yaml",),
    "carried": ("paper/point.yaml", "oil.transport=carried"),
    "economizer": ("r134a/point.yaml",),
    "everything": ("everything.yaml",),
    "slider-crank": ("slider_crank/air.yaml",),
    "expander": ("expander/point.yaml",),
}
WRITTEN = ("chamber__", "chambers__", "area__", "opening__", "pulse__", "push__", "push_on__", "ledger__add_moment")
# what a text counts along: the chambers, their columns, and the points of a step's cubic
COUNTED = {"CHAMBERS", "GIVEN", "COLUMNS", "GIVEN_SLOPES", "GIVEN_SLOPES_EXACT", "Q_crossing"}
CUBIC = "range(0 if fresh else 1, 4)"
SIZES = {"N_FLOWS", "N_FILMS"}
PIECES = {"dense", "context.d_old"}  # of a dense output: the four pieces of a step have numbers
BY_NUMBER = {"path_area", "path_opening", "line_pulse", "heat_part", "wall_conductance", "state_rate"}
BY_NUMBER |= {"gap_share", "gap_film", "gap_drag", "stop_push", "push_on"}  # chosen by a number, for Python
READING = {"trace__areas_along", "trace__heats_along", "line_flow__line_pulses"}  # what Python has along angles


@cache
def functions(scene):
    """Return the functions of a scene's texts, those of one chamber and of all together, by name."""
    name, *changes = SCENES[scene]
    composition = compose(problem_of(load(CONFIGS / name, changes)).parts)
    texts = composition.text, composition.together()
    return {node.name: node for text in texts for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}


@cache
def parts_of(scene):
    """Return the parts of each function of a scene's texts, by its name: a walk through all of them takes long."""
    return {name: tuple(ast.walk(node)) for name, node in functions(scene).items()}


def written(scene):
    return {name: node for name, node in functions(scene).items() if name.startswith(WRITTEN)}


def each(kind, node):
    return [part for part in ast.walk(node) if isinstance(part, kind)]


def each_of(kind, scene, name):
    return [part for part in parts_of(scene)[name] if isinstance(part, kind)]


@pytest.mark.parametrize("scene", SCENES)
def test_nothing_is_gone_through_that_the_structure_knows(scene):
    assert len(written(scene)) > 20
    for name in written(scene):
        for loop in each_of(ast.For, scene, name):
            spelled = ast.unparse(loop.iter)
            named = {part.id for part in each(ast.Name, loop.iter)} - {"range"}
            assert spelled == CUBIC or (named and named <= COUNTED and name.startswith("chambers__")), (name, spelled)


@pytest.mark.parametrize("scene", SCENES)
def test_no_kernel_goes_through_ports_gaps_or_valves(scene):
    """Counts of them say how long an array is; no loop ends there, and no table tells what each of them is."""
    for name in functions(scene):
        for loop in each_of(ast.For, scene, name):
            assert not {part.id for part in each(ast.Name, loop.iter)} & SIZES, (name, ast.unparse(loop.iter))
    text = compose(problem_of(load(CONFIGS / SCENES[scene][0], SCENES[scene][1:])).parts).text
    tables = re.findall(r"^(\w+) = np\.array\(", text, re.MULTILINE)
    assert tables and all("__" in name for name in tables)  # of kernels, as the integrator's coefficients


@pytest.mark.parametrize("scene", SCENES)
def test_an_index_is_a_name(scene):
    """A number in the text would be a second place where an index stands; `- 1` is the one before, `+ 1` the next."""
    for name in written(scene):
        for found in each_of(ast.Subscript, scene, name):
            parts = found.slice.elts if isinstance(found.slice, ast.Tuple) else [found.slice]
            if ast.unparse(found.value) in PIECES:
                parts = [parts[0], parts[2]]
            numbers = [part for of in parts for part in each(ast.Constant, of)]
            assert all(part.value == 1 and part not in parts for part in numbers), (name, ast.unparse(found))


@pytest.mark.parametrize("scene", SCENES)
def test_what_is_chosen_by_number_is_for_python_alone(scene):
    for name in functions(scene):
        called = {call.func.id for call in each_of(ast.Call, scene, name) if isinstance(call.func, ast.Name)}
        assert name in READING or not called & BY_NUMBER, (name, called & BY_NUMBER)


@each_row("scene", SCENES)
def test_each_area_flow_and_line_is_stated_once_in_a_function(scene):
    """What fills a number of the surroundings, or a flow, is one statement of its name."""
    for name, filled in (("chamber__surroundings", ("E[A_", "E[E_")), ("chamber__path_flows", "out[FLOW_")):
        stored = [
            ast.unparse(to)
            for one in each_of(ast.Assign, scene, name)
            for to in one.targets
            if ast.unparse(to).startswith(filled) and ast.unparse(one.value) != "0.0"  # of a port that is shut
        ]
        assert stored and len(set(stored)) == len(stored), name
