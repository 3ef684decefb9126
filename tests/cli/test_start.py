"""The front door opens without the house: what must not be imported, and the public names."""

import json

import pytest

HEAVY = {"llvmlite", "CoolProp", "matplotlib", "h5py", "scipy", "pint", "numpy", "pandas", "xarray"}
LOADED = "print(json.dumps(sorted({name.partition('.')[0] for name in sys.modules})), file=sys.stderr)"


def _loaded(answer) -> set[str]:
    return set(json.loads(answer.stderr.splitlines()[-1]))


HELP = ["--help"], ["run", "--help"], ["--version"]
FRONT = f"""\
import json, sys, screwsim
{LOADED}
from screwsim import cli
for arguments in {HELP!r}:
    assert cli.exit_code(arguments) == 0, arguments
    {LOADED}
"""


def test_the_package_imports_nothing_and_help_nothing_heavy(new_python):
    answer = new_python("-c", FRONT)
    assert answer.returncode == 0, answer.stderr
    package, *helps = ({*json.loads(line)} for line in answer.stderr.splitlines())
    assert not package & (HEAVY | {"typer", "rich", "ruamel"})
    assert len(helps) == len(HELP) and not any(loaded & HEAVY for loaded in helps)


def test_module_is_the_command(new_python):
    answer = new_python("-m", "screwsim", "--version")
    assert (answer.returncode, answer.stderr) == (0, "")
    assert answer.stdout.startswith("screwsim 0.")


OWN = "print(json.dumps(sorted(name for name in sys.modules if name.startswith('screwsim.'))), file=sys.stderr)"
UNUSED = {  # packages of what a command does not do
    "run": ("study.stages", "study.sweep", "study.pool", "study.uncertainty", "derivatives", "results", "explain"),
    "explain": ("study.stages", "study.sweep", "solve", "simulate", "evaluate", "derivatives", "results"),
}


@pytest.mark.parametrize("command", UNUSED)
def test_a_command_imports_nothing_that_it_does_not_use(command, folder, new_python):
    code = f"import json, sys; from screwsim import cli; cli.exit_code(['{command}', 'small.yaml']); {OWN}"
    loaded = json.loads(new_python("-c", code).stderr.splitlines()[-1])
    assert "screwsim.scene.load" in loaded
    assert [name for name in loaded if name.removeprefix("screwsim.").startswith(UNUSED[command])] == []


ORDERS = (
    "import screwsim; screwsim.simulate",
    "import screwsim; import screwsim.simulate",
    "import screwsim.simulate",
    "from screwsim.simulate import warm_up; import screwsim",
    "import screwsim; screwsim.simulate; import screwsim.simulate",
    "import screwsim; screwsim.sweep; from screwsim.simulate import simulate",
    "import screwsim; from screwsim import simulate",
)
EACH_ANEW = f"""\
import pickle, sys, types
for code in {ORDERS!r}:
    for name in [name for name in sys.modules if name.partition(".")[0] == "screwsim"]:
        del sys.modules[name]
    here = {{}}
    exec(code, here)
    screwsim = here["screwsim"]
    assert isinstance(screwsim.simulate, types.FunctionType), code
    assert pickle.loads(pickle.dumps(screwsim.simulate)) is screwsim.simulate, code
assert all(getattr(screwsim, name) is not None for name in screwsim.__all__)
screwsim.nonsense
"""


def test_simulate_is_the_function_in_any_order_of_imports_and_every_public_name_is_there(new_python):
    answer = new_python("-c", EACH_ANEW)
    assert answer.stderr.splitlines()[-1] == "AttributeError: module 'screwsim' has no attribute 'nonsense'"


def test_explaining_imports_no_compiler_and_with_known_constants_no_coolprop(folder, new_python):
    code = f"import json, sys; from screwsim import cli; cli.exit_code(['explain', 'rated.yaml']); {LOADED}"
    states = "evaporating_temperature: 2 degC, condensing_temperature: 45 degC, superheat: 10 K, subcooling: 5 K"
    text = f"base: small.yaml\noperation: {{suction: null, discharge: null, {states}}}\n"
    (folder / "rated.yaml").write_text(text)
    first, second = (new_python("-c", code, SCREWSIM_CACHE=str(folder / "cache")) for _ in range(2))
    assert "dew point at 2 °C" in second.stdout and second.stdout == first.stdout
    assert "CoolProp" in _loaded(first)
    assert "CoolProp" not in _loaded(second)
    for each in (first, second):
        assert not _loaded(each) & {"llvmlite", "matplotlib", "h5py", "scipy", "pint", "xarray"}
