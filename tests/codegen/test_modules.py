"""Compiled modules: kept, healed when damaged, never run from where others write, told while they are made."""

import hashlib
import os
import sys
from pathlib import Path

import pytest

from screwsim.codegen import emit, modules

TEXT = "def twice(x):\\n    return 2.0 * x\\n"
RUN = f"""
from screwsim.numerics.compiling import announced
from screwsim.codegen import modules
from screwsim.codegen.modules import load
modules.PATIENCE = 0.1  # most of a minute for this code: none is written for speed because the machine is busy
with announced("test", "a test", "a moment"):
    module = load("{TEXT}", "test")
    print(module.twice(21.0), len(module.made))
"""
MADE, TAKEN = "42.0 1\n", "42.0 0\n"


def damage(path: Path, how: str) -> None:
    held = bytearray(path.read_bytes())
    if how == "flipped":
        held[len(held) // 2] ^= 0xFF
    path.write_bytes(b"" if how == "emptied" else held[: len(held) // 2] if how == "truncated" else held)


def test_what_was_compiled_once_is_loaded_in_silence(python, tmp_path):
    first, second = (python(RUN, SCREWSIM_CACHE=str(tmp_path / "cache")) for _ in range(2))
    assert (first.stdout, second.stdout, second.stderr) == (MADE, TAKEN, "")
    assert first.stderr.startswith("screwsim: compiling a test, once (a moment) ...\nscrewsim: compiled in ")


@pytest.mark.parametrize("how", ["emptied", "truncated", "flipped"])
def test_a_damaged_cache_heals(python, tmp_path, how):
    cache = tmp_path / "cache"
    assert python(RUN, SCREWSIM_CACHE=str(cache)).stdout == MADE
    kept = sorted(cache.iterdir())
    assert {path.suffix for path in kept} == {".code", ".json", ".py"}
    sound = {path: path.read_bytes() for path in kept if path.suffix == ".py"}
    for path in kept:
        damage(path, how)
    healed, after = (python(RUN, SCREWSIM_CACHE=str(cache)) for _ in range(2))
    assert (healed.returncode, healed.stdout) == (0, MADE), healed.stderr
    assert "Traceback" not in healed.stderr and "compiling a test, once" in healed.stderr
    assert (after.stdout, after.stderr) == (TAKEN, "")
    assert {path: path.read_bytes() for path in sound} == sound


@pytest.mark.skipif(os.name != "posix", reason="modes of POSIX")
def test_compiled_code_that_others_could_have_put_there_is_not_run(python, tmp_path):
    """Machine code of x + 100, under the name of 2 x and with a sound digest."""
    cache, elsewhere = tmp_path / "cache", tmp_path / "elsewhere"
    python(RUN, SCREWSIM_CACHE=str(cache))
    [code] = cache.glob("*.code")
    module, function, kinds, _ = code.name.split(".")
    another = f"""
from screwsim.codegen import kinds, library, machine, program
together = library.Library(program.read("def twice(x):\\n    return x + 100.0\\n"))
returned, text = together.entry("twice", (kinds.FLOAT,), "{module}.{function}.{kinds}")
open(r"{elsewhere}", "wb").write(str(returned).encode() + b"\\n" + machine.compiled(text))
"""
    assert python(another, SCREWSIM_CACHE=str(cache)).returncode == 0
    content = elsewhere.read_bytes()
    code.write_bytes(hashlib.sha256(code.name.encode() + b"\n" + content).digest() + content)
    cache.chmod(0o777)
    assert python(RUN, SCREWSIM_CACHE=str(cache), TMPDIR=str(tmp_path)).stdout == MADE
    cache.chmod(0o700)  # it would have been run
    assert python(RUN, SCREWSIM_CACHE=str(cache)).stdout == "121.0 0\n"


LONG = (
    RUN
    + """
import itertools, types
modules.time = types.SimpleNamespace(thread_time=itertools.count().__next__)  # a second a call
values = {module.twice(0.1 * k) == 0.2 * k for k in range(5000)}
print(values, len(module.made), module.twice(21.0))
"""
)


def test_what_has_run_for_a_while_is_written_for_speed_once(python, tmp_path):
    """And taken from there by the next process, which writes nothing."""
    cache = tmp_path / "cache"
    assert python(LONG, SCREWSIM_CACHE=str(cache)).stdout == f"{MADE}{{True}} 2 42.0\n"
    assert {path.suffix for path in cache.iterdir()} == {".code", ".fast", ".json", ".py"}
    next(cache.glob("*.code")).unlink()
    again = python(LONG, SCREWSIM_CACHE=str(cache))
    assert (again.stdout, again.stderr) == (f"{TAKEN}{{True}} 0 42.0\n", "")


PARTLY = f"""
import itertools, types
from screwsim.codegen import modules
modules.PATIENCE, modules.time = 1.0, types.SimpleNamespace(thread_time=itertools.count().__next__)  # a second a call
module = modules.load("{TEXT}", "test")
for _ in range(2):
    value, variant = module.twice(21.0), next(iter(module.twice._variants.values()))
    for _ in range(int(0.2 * getattr(variant, "_size", 0.0))):
        module.twice(21.0)
print(value, len(module.made))
"""


def test_what_runs_for_a_while_in_many_processes_is_written_for_speed(python, tmp_path):
    """Each runs it for two fifths of the time that the code has: the third writes it again, the fourth has it."""
    cache = tmp_path / "cache"
    assert [python(PARTLY, SCREWSIM_CACHE=str(cache)).stdout for _ in range(2)] == [MADE, TAKEN]
    assert {path.suffix for path in cache.iterdir()} == {".code", ".py", ".ran"}
    assert [python(PARTLY, SCREWSIM_CACHE=str(cache)).stdout for _ in range(2)] == [MADE, TAKEN]
    assert {path.suffix for path in cache.iterdir()} == {".code", ".py", ".fast"}


FULL = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (200, 200))\n"


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_a_cache_that_takes_no_more_keeps_what_is_compiled_in_memory(python, tmp_path):
    found = python(FULL + RUN, SCREWSIM_CACHE=str(tmp_path / "cache"))
    assert (found.returncode, found.stdout) == (0, MADE)
    [line] = [line for line in found.stderr.splitlines() if "compil" not in line.partition(";")[0]]
    assert line.startswith(f"screwsim: {tmp_path / 'cache'}: cannot be written: ")
    assert not list((tmp_path / "cache").glob("*.tmp"))


def test_many_processes_may_compile_and_load_at_once(python, tmp_path):
    many = f"""
import subprocess, sys
text = {RUN!r}
all = [subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True) for _ in range(4)]
print(*sorted({{each.communicate()[0].split()[0] for each in all}}), sum(each.returncode for each in all))
"""
    assert python(many, SCREWSIM_CACHE=str(tmp_path / "cache")).stdout == "42.0 0\n"
    assert python(RUN, SCREWSIM_CACHE=str(tmp_path / "cache")).stdout == TAKEN
    assert not list((tmp_path / "cache").glob("*.tmp"))


def test_the_time_of_the_last_compilation_is_told_before_the_next(python, tmp_path):
    python(RUN, SCREWSIM_CACHE=str(tmp_path / "cache"))
    another = python(RUN.replace("2.0", "3.0"), SCREWSIM_CACHE=str(tmp_path / "cache"))
    assert another.stderr.startswith("screwsim: compiling a test, once (the last one took ")


def test_who_measures_times_beside_another_leaves_nothing_behind():
    """Two threads may enter and leave in any order: code is written soon again when the last one is done."""

    def is_soon():
        module = modules.Module("measured", "def twice(x):\n    return 2.0 * x\n", checks=True)  # never kept
        assert module.twice(1.5) == 3.0
        return isinstance(next(iter(module.twice._variants.values())), modules._Tried)

    one, other = modules.for_speed(), modules.for_speed()
    one.__enter__()
    other.__enter__()
    one.__exit__(None, None, None)
    assert not is_soon()
    other.__exit__(None, None, None)
    assert is_soon()


CALLING = """def half(x):
    return 0.5 * x


def quarter(x):
    return half(half(x))
"""


@pytest.mark.parametrize("number", [1, 2])
def test_what_was_interrupted_while_it_was_written_is_written_anew(number, monkeypatch):
    module, written, calls = modules.Module("interrupted", CALLING, checks=True), emit.Emitter.written, []

    def interrupted(self, symbol):
        calls.append(symbol)
        if len(calls) == number:  # 1: on beginning `quarter`; 2: within it, on beginning `half`
            raise KeyboardInterrupt
        return written(self, symbol)

    monkeypatch.setattr(emit.Emitter, "written", interrupted)
    with pytest.raises(KeyboardInterrupt):
        module.quarter(8.0)
    assert (module.quarter(8.0), module.half(8.0)) == (2.0, 4.0)
