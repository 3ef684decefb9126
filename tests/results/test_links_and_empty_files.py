"""What is written where a link or an empty file lies: the link stays, and an empty file holds nothing to be kept."""

import os
from pathlib import Path

import pytest

from screwsim.cli import exit_code
from screwsim.inputs.faults import UsageError
from screwsim.results.atomic import HDF5_SIGNATURE, has_content, link_target, protect_others, write_text
from screwsim.results.protection import protect_other_heads
from screwsim.results.write import Draft
from screwsim.scene import load
from screwsim.study.optimize import store
from screwsim.study.sweep import run_sweep
from screwsim.study.sweep.shards import Parts

POINT = str(Path(__file__).parents[2] / "configs" / "paper" / "point.yaml")
ROUGH = ["--set", "numerics.accuracy=1e-2", "--set", "numerics.error=none"]
SWEEP = ["--set", "sweep={oil_supply.ratio: [1, 2]}", "--jobs", "1"]
WANTED = ["--vary", "oil_supply.ratio=1..3", "--maximize", "isothermal_efficiency", "--evaluations", "12"]


@pytest.fixture
def linked(tmp_path):
    """Return a link to a file in another folder, which is not there yet, and that file."""
    there = tmp_path / "there" / "out.h5"
    there.parent.mkdir()
    link = tmp_path / "link.h5"
    link.symlink_to(there)
    return link, there


@pytest.mark.parametrize("command", [["run", POINT], ["sweep", POINT, *SWEEP]])
def test_results_go_where_a_link_leads(command, linked):
    link, there = linked
    for _ in range(2):  # nothing there, then what lies there
        assert exit_code([*command, *ROUGH, "-o", str(link)]) == 0
        assert link.is_symlink() and has_content(there) and not there.is_symlink()
    assert sorted(path.name for path in link.parent.iterdir()) == ["link.h5", "there"]
    assert [path.name for path in there.parent.iterdir()] == ["out.h5"]


def test_a_text_goes_where_a_chain_of_links_leads(tmp_path):
    other = tmp_path / "a.csv"
    other.symlink_to("b.csv")
    (tmp_path / "b.csv").symlink_to("c.csv")
    write_text(other, "x,y\n")
    assert (tmp_path / "c.csv").read_text(encoding="utf-8") == "x,y\n"
    assert other.is_symlink() and (tmp_path / "b.csv").is_symlink()
    assert link_target(tmp_path / "c.csv") == tmp_path / "c.csv"


def test_two_sweeps_by_two_links_to_one_file_are_not_written_at_once(linked, tmp_path):
    link, there = linked
    other = tmp_path / "other.h5"
    other.symlink_to(there)
    assert Parts(link, {}).folder == Parts(other, {}).folder == Parts(there, {}).folder


def test_a_draft_is_made_on_the_disk_of_the_file_that_a_link_names(linked):
    link, there = linked
    with Draft(link, load(POINT), (), "run") as draft:
        assert draft._temporary.parent == there.parent


@pytest.mark.parametrize(
    "command", [["run", POINT], ["sweep", POINT, *SWEEP], ["optimize", POINT, *WANTED, "--jobs", "1"]]
)
def test_an_empty_file_is_replaced(command, tmp_path):
    output = tmp_path / "made_ahead.h5"
    output.touch()
    assert exit_code([*command, *ROUGH, "-o", str(output)]) == 0
    assert output.read_bytes().startswith(HDF5_SIGNATURE)


def test_a_file_with_one_byte_is_kept(tmp_path):
    mine = tmp_path / "mine.h5"
    mine.write_bytes(b"\x89")
    with pytest.raises(UsageError, match="is not a file of this kind"):
        protect_others(mine, HDF5_SIGNATURE)


def test_a_table_whose_first_line_is_blank_is_kept(tmp_path):
    mine = tmp_path / "mine.csv"
    mine.write_text("\nmeasured,1\n", encoding="utf-8")
    with pytest.raises(UsageError, match="is not a file of this kind"):
        protect_other_heads(mine, lambda heads: "status" in heads)
    mine.write_text("", encoding="utf-8")
    protect_other_heads(mine, lambda heads: "status" in heads)


@pytest.mark.parametrize("what", ["foreign", "run"])
def test_an_optimisation_that_begins_anew_replaces_an_optimisation_only(what, tmp_path, capsys):
    h5py = pytest.importorskip("h5py")
    output = tmp_path / "out.h5"
    if what == "run":
        assert exit_code(["run", POINT, *ROUGH, "-o", str(output)]) == 0
    else:
        with h5py.File(output, "w") as file:
            file["measured"] = [1.0, 2.0]
    before = output.read_bytes()
    capsys.readouterr()
    assert exit_code(["optimize", POINT, *WANTED, *ROUGH, "--jobs", "1", "--restart", "-o", str(output)]) == 2
    told = "another program" if what == "foreign" else "does not hold results of an optimisation (choose another -o"
    assert told in capsys.readouterr().err
    assert output.read_bytes() == before
    own = tmp_path / "own.h5"
    for _ in range(2):
        assert exit_code(["optimize", POINT, *WANTED, *ROUGH, "--jobs", "1", "--restart", "-o", str(own)]) == 0
    assert store.read_attributes(own)["history"].endswith(f" {store.COMMAND_NAME}")


def test_a_sweep_into_a_pipe_computes_nothing(tmp_path):
    pipe = tmp_path / "out.h5"
    os.mkfifo(pipe)

    def forbidden(scene):
        raise AssertionError("a case was computed")

    assert has_content(pipe) and has_content(tmp_path) and not has_content(tmp_path / "none")
    with pytest.raises(UsageError, match="is a pipe or a device, not a file"):
        run_sweep(load(POINT, SWEEP[1:2]), pipe, jobs=1, simulate=forbidden)
