"""Rules of mistaken commands: what is told is true, and whoever follows it gets what was meant."""

import pytest
from each_row import each_row

from screwsim.cli import _parser
from screwsim.cli.declare import Command
from screwsim.outputs import Figures, Result
from screwsim.scene import load
from screwsim.study.asked.figures import figure_named, figure_of, figures_of
from screwsim.study.sweep import run_sweep

FIT = "scene: small.yaml\ndata: points.csv\nparameters:\n  effects.tip_leakage.gap: {from: 20 um, to: 80 um}\n"
STAGES = "stages: [small.yaml, small.yaml]\n"


def powered(scene) -> Result:
    """Return a result of two figures."""
    return Result("ok", performance=Figures(shaft_power=1e4, gas_mass_flow=0.5))


@pytest.fixture
def files(folder):
    """Work in a folder with a fit, stages and results, too."""
    (folder / "x.fit.yaml").write_text(FIT)
    (folder / "x.stages.yaml").write_text(STAGES)
    run_sweep(load("swept.yaml"), "out.h5", jobs=1, simulate=lambda scene: Result("ok"))
    return folder


RESULTS = "results are HDF5, so the name must end in .h5, .hdf5, .hdf, .nc, .nc4"
TABLE = "write -o out.h5; screwsim export cases makes a table of it"
FILES = "several files are written, so name a folder"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("run", "small.yaml", "-o", "out.csv"), f"-o out.csv: {RESULTS} ({TABLE})"),
        (("run", "x.stages.yaml", "-o", "out.csv"), f"-o out.csv: {RESULTS} ({TABLE})"),
        (("sweep", "swept.yaml", "-o", "a.json"), f"-o a.json: {RESULTS} (write -o a.h5)"),
        (
            ("sweep", "swept.yaml", "-o", "a.html"),
            f"-o a.html: {RESULTS} (write -o a.h5; screwsim report makes a page of it)",
        ),
        (("sweep", "swept.yaml", "-o", "."), "-o .: is a folder (name a file in it, e.g. -o out.h5)"),
        (
            ("report", "out.h5", "-o", "page.pdf"),
            "-o page.pdf: a page is written, so the name must end in .html or .htm (write -o page.html)",
        ),
        (("plot", "out.h5", "-o", "a.png"), f"-o a.png: {FILES} (e.g. -o a)"),
        (("plot", "out.h5", "-o", "out.h5"), f"-o out.h5: {FILES} (e.g. -o out)"),
        (("rotors", "small.yaml", "-o", "a.html"), f"-o a.html: {FILES} (e.g. -o a)"),
        (("accuracy", "small.yaml", "-o", "a.csv"), f"-o a.csv: {FILES} (e.g. -o a)"),
        (("calibrate", "x.fit.yaml", "-o", "a.yaml"), f"-o a.yaml: {FILES} (e.g. -o a)"),
        (("tolerance", "small.yaml", "-o", "a.png"), f"-o a.png: {FILES} (e.g. -o a)"),
        (("startup", "small.yaml", "-o", "a.csv"), f"-o a.csv: {FILES} (e.g. -o a)"),
        (("validate", "-o", "a.json"), f"-o a.json: {FILES} (e.g. -o a)"),
    ],
)
def test_a_name_of_another_kind_of_file_is_refused(files, command, arguments, told):
    before = sorted(files.iterdir())
    assert command(*arguments) == (2, "", f"{told}\n")
    assert sorted(files.iterdir()) == before


TWO = (
    "describes two stages, which only `screwsim run`, `sweep`, `datasheet`, `optimum`, `optimize`, `find`, "
    "`sensitivity`, `explain` and `export` accept "
    "(run one of these on x.stages.yaml, or name the "
)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("run", "x.fit.yaml"), "x.fit.yaml:1:1: is a fit, not a scene (run screwsim calibrate x.fit.yaml)"),
        (("sweep", "x.fit.yaml"), "x.fit.yaml:1:1: is a fit, not a scene (run screwsim calibrate x.fit.yaml)"),
        (("rotors", "x.stages.yaml"), f"x.stages.yaml:1:1: {TWO}scene of one stage here)"),
        (("calibrate", "x.stages.yaml"), f"x.stages.yaml:1:1: {TWO}scene of one stage here)"),
        (
            ("calibrate", "small.yaml"),
            "small.yaml:1:1: is a scene, not a fit "
            "(run screwsim run small.yaml; a fit has scene:, data: and parameters:)",
        ),
        (
            ("run", "out.h5"),
            "out.h5:1:1: is a file of results, not a scene "
            "(screwsim scene out.h5 -o again.yaml writes the scene that it contains)",
        ),
        (("run", "smal.yaml"), "smal.yaml:1:1: cannot be read: No such file or directory; did you mean 'small.yaml'?"),
        (("run", "small"), "small:1:1: cannot be read: No such file or directory (there is small.yaml)"),
    ],
)
def test_a_file_of_another_kind_is_told_with_what_reads_it(files, command, arguments, told):
    assert command(*arguments) == (3, "", f"{told}\n")


def test_a_command_that_is_proposed_may_be_copied_whatever_the_name_of_the_file(files, command):
    (files / "my machine.yaml").write_text((files / "small.yaml").read_text())
    assert "(run screwsim run 'my machine.yaml';" in command("calibrate", "my machine.yaml").err


def test_a_source_is_no_file(files, command):
    (files / "validation" / "small").mkdir(parents=True)
    (files / "validation" / "small" / "compare.py").write_text("")
    answer = command("validate", "x.fit.yaml", "--folder", "validation")
    assert answer.code == 2
    assert answer.err == (
        "x.fit.yaml: is a file, but a source is named, not a file (screwsim run x.fit.yaml simulates a scene, "
        "screwsim calibrate x.fit.yaml fits one; known: small)\n"
    )


def test_a_sweep_that_is_not_run_is_said_in_one_line(folder, command):
    assert command("run", "swept.yaml").code == 0  # compiles, and says so
    answer = command("run", "swept.yaml", "--json")
    assert answer.code == 0
    assert answer.err == (
        "swept.yaml: its sweep of 2 cases is ignored, and the scene's own point is used (screwsim sweep swept.yaml "
        "simulates the sweep)\n"
    )
    assert command("run", "small.yaml", "--json").err == ""


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ("run", "small.yaml", "--set", "operation.suction.temperature=-10", "C"),
            "Error: Got unexpected extra argument(s) (C): a value with spaces needs quotes "
            "(write --set 'operation.suction.temperature=-10 C')",
        ),
        (
            ("run", "--set", "operation.speed=1000", "rpm", "small.yaml"),
            "Error: Got unexpected extra argument(s) (small.yaml): a value with spaces needs quotes "
            "(write --set 'operation.speed=1000 rpm')",
        ),
        (
            ("optimum", "oiled.yaml", "--from=-10", "degC"),
            "Error: Got unexpected extra argument(s) (degC): a value with spaces needs quotes "
            "(write --from '-10 degC')",
        ),
        (
            ("run", "small.yaml", "--without", "tip_leakage", "blow_hole"),
            "Error: Got unexpected extra argument(s) (blow_hole): --without takes one name "
            "(write --without tip_leakage --without blow_hole)",
        ),
        (("help",), "Error: No such command 'help' (write screwsim --help)"),
        (("run", "small.yaml", "other.yaml"), "Error: Got unexpected extra argument(s) (other.yaml)"),
        (("run", "small.yaml", "--sett", "a=1"), "Error: No such option: --sett (Possible options: --set)"),
        (("run", "small.yaml", "--jobs", "4"), "Error: No such option: --jobs"),  # --json does another thing
        (("swep", "small.yaml"), "Error: No such command 'swep': did you mean 'sweep'?"),
        (
            ("small.yaml",),
            "Error: No such command 'small.yaml': the command must come first (write screwsim run small.yaml)",
        ),
        (("out.h5",), "Error: No such command 'out.h5': the command must come first (write screwsim report out.h5)"),
        (
            ("export", "out.h5"),
            "Error: No such command 'out.h5': the command must come first (write screwsim export fmu out.h5)",
        ),
    ],
)
def test_mistaken_arguments_are_told_with_what_was_meant(folder, command, arguments, told):
    answer = command(*arguments)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.splitlines()[-1] == told


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (("run", "small.yaml", "-o", "a.h5", "-o", "b.h5"), "-o"),
        (("run", "small.yaml", "--set", "operation.speed=1 rpm", "-o", "a.h5", "-o=b.h5"), "-o"),
        (("sweep", "swept.yaml", "--jobs", "1", "--jobs=2"), "--jobs"),
        (("optimum", "small.yaml", "--path", "oil_supply.ratio", "--path", "operation.speed"), "--path"),
        (("export", "fmu", "out.h5", "-o", "a", "-o", "a"), "-o"),
    ],
)
def test_an_option_with_one_value_that_is_given_twice_is_refused(folder, command, arguments, option):
    """The last one was taken."""
    answer = command(*arguments)
    told = f"{option}: is given twice, and takes one value (remove one)\n"
    assert (answer.code, answer.out, answer.err) == (2, "", told)


@pytest.mark.parametrize(
    ("words", "path"),
    [
        ("run small.yaml --set operation.speed=1000rpm --set operation.speed=2000rpm", "operation.speed"),
        ("explain small.yaml --set oil=null --set=effects.motor=off --set=oil=null", "oil"),
        ("export loads small.yaml --set oil_supply.ratio=1 --set oil_supply.ratio=2", "oil_supply.ratio"),
        ("run two.stages.yaml --set first.oil.density=1 --set first.oil.density=2", "first.oil.density"),
    ],
)
def test_a_path_that_is_set_twice_is_refused(files, command, words, path):
    """The last one was taken."""
    answer = command(*words.split())
    assert (answer.code, answer.out, answer.err) == (2, "", f"--set {path}: is given twice (remove one)\n")


@pytest.mark.parametrize("words", ["new air", "datasheet small.yaml", "report out.h5", "calibrate x.fit.yaml"])
def test_an_empty_name_of_an_output_is_refused(files, command, words):
    """Of an unset variable of a shell: it stood for the present folder, or ended in an internal error."""
    before = sorted(files.iterdir())
    answer = command(*words.split(), "-o", "")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "-o: is empty (name a file or folder, or leave it out)\n"
    assert sorted(files.iterdir()) == before


def test_every_command_refuses_an_option_given_twice():
    group = _parser("")
    inner = [each for one in group.commands.values() for each in getattr(one, "commands", {}).values()]
    every = [each for each in (*group.commands.values(), *inner) if not hasattr(each, "commands")]
    assert len(every) > 25 and all(isinstance(each, Command) for each in every)


def test_a_command_that_is_none_is_told_with_those_there_are(folder, command):
    answer = command("frobnicate", "small.yaml")
    assert answer.code == 2
    assert "(there are: new, run, sweep, explain, " in answer.err and "did you mean" not in answer.err


def test_a_value_below_zero_is_read_on_the_command_line(folder, command):
    below = ("--set", "operation.suction.temperature=-10 C")
    assert "-10 °C" in command("explain", "small.yaml", *below).out
    answer = command(
        "optimum", "oiled.yaml", "--path", "operation.suction.temperature", "--from", "-10 C", "--to", "-12 degC"
    )
    assert "the range -10 °C … -12 °C is empty" in answer.err
    answer = command("sensitivity", "oiled.yaml", "--path", "operation.suction.temperature=-10 °C..-12 °C")
    assert "the range -10 °C … -12 °C is empty" in answer.err
    answer = command("sensitivity", "oiled.yaml", "--path", "operation.suction.temperature=-10..5")
    assert answer.err == "operation.suction.temperature: '-10' has no unit (write e.g. '285 K')\n"


@each_row(
    ("text", "figure"),
    [
        ("COP", "cop"),
        ("Shaft Power", "shaft_power"),
        ("ISENTROPIC-EFFICIENCY", "isentropic_efficiency"),
        ("λ", "volumetric_efficiency"),
        ("lambda", "volumetric_efficiency"),
        ("eta_s", "isentropic_efficiency"),
        ("η_s", "isentropic_efficiency"),
        ("eta_T", "isothermal_efficiency"),
        ("η_iso", "isothermal_efficiency"),
        ("P_el", "electrical_power"),
        ("m_dot", "gas_mass_flow"),
        ("T_d", "discharge_temperature"),
        ("Q_0", "cooling_capacity"),
    ],
)
def test_a_figure_is_known_by_its_symbol_and_in_any_case(text, figure):
    assert figure_named(text) == figure


@pytest.mark.parametrize("text", ["eta", "power", "P", "efficiency", "xyz", "cp"])
def test_a_name_of_several_figures_is_told_with_those_that_the_scene_has(folder, command, text):
    answer = command("optimum", "oiled.yaml", "--figure", text)
    assert answer.code == 2
    assert answer.err.startswith(f"--figure {text}: is not known (use one of isothermal_efficiency, ideal_")
    assert "oil_lift_power" in answer.err and "cop" not in answer.err and answer.err.count("\n") == 1


def test_a_figure_that_the_scene_cannot_have_is_told_before_anything_is_solved(folder, command):
    answer = command("optimum", "oiled.yaml", "--figure", "COP")
    assert answer.code == 2
    assert answer.err.startswith(
        "--figure COP: is not a figure of this scene: it needs operation.condensing_temperature and machine.mode: "
        "compressor or operation.gas_cooler (use one of isothermal_efficiency, "
    )


def test_the_figures_of_a_scene_are_those_of_its_result(folder):
    from screwsim import simulate

    scene = load("oiled.yaml")
    result = simulate(scene)
    assert [name for name in figures_of(scene) if result.performance[name] is None] == []
    assert figure_of(scene, "λ") == "volumetric_efficiency"


def test_a_figure_that_is_none_is_told_with_those_that_the_file_has(folder, command):
    axes = ("evaporating_temperature: [270 K, 275 K]", "condensing_temperature: [310 K, 315 K]")
    rated = "operation: {suction: null, discharge: null, superheat: 5 K, evaporating_temperature: 275 K, "
    text = f"base: small.yaml\n{rated}condensing_temperature: 310 K}}\nsweep:\n"
    (folder / "rated.yaml").write_text(text + "".join(f"  operation.{axis}\n" for axis in axes))
    run_sweep(load("rated.yaml"), "rated.h5", jobs=1, simulate=powered)
    answer = command("map", "rated.h5", "--figure", "power")
    told = "--figure power: is not known (use one of gas_mass_flow, shaft_power)\n"
    assert (answer.code, answer.err) == (2, told)


@pytest.mark.parametrize("arguments", [("--help",), ("export", "-h")])
def test_the_list_of_commands_says_whole_what_each_does(command, arguments):
    listed = command(*arguments).out.partition("Commands:")[2]
    assert listed and "..." not in listed
    assert max(map(len, listed.splitlines())) <= 80
