"""Results files of others: nothing outside the file is read, and what is odd is told in one line by every command."""

import h5py
import numpy as np
import pytest
import report_fakes
from result_fakes import GRID, SCENE

from screwsim.inputs.faults import UsageError
from screwsim.report import style
from screwsim.results import open_results
from screwsim.results.read import count_statuses
from screwsim.scene import loads
from screwsim.study.sweep import run_sweep

SECRET = "what lies in another file"
SHORT = "sweep:\n  operation.speed: [1000 rpm, 2000 rpm, 3000 rpm]\n  oil_supply.ratio: [0.5, 1, 2, 4]\n"


@pytest.fixture(autouse=True)
def pages_of_pixels(monkeypatch, sketched):
    """Sketch figures, and those of pages as small PNG, the form that is searched here, and not as PDF too."""
    monkeypatch.setattr(style, "_FORMATS", {"png": style._FORMATS["png"]})
    monkeypatch.setattr(style, "DPI", 30)


@pytest.fixture
def figures_as_texts(monkeypatch, pages_of_pixels):
    """Write of each figure its texts alone: they can be searched, which in pixels they cannot."""
    from matplotlib.text import Text

    def write(figure, folder, name):
        path = folder / f"{name}.png"
        path.write_text("\n".join(text.get_text() for text in figure.findobj(Text)), encoding="utf-8")
        return [str(path)]

    monkeypatch.setattr(style, "write", write)


@pytest.fixture
def run(tmp_path):
    """Return the results of one run, with traces, that may be changed."""
    return report_fakes.file(tmp_path / "run.h5", SCENE, report_fakes.with_ledger)


@pytest.fixture
def swept(tmp_path):
    """Return the results of a sweep that may be changed."""
    return report_fakes.file(tmp_path / "sweep.h5", SCENE + SHORT, report_fakes.some_fail)


@pytest.fixture
def secret(tmp_path):
    """Return the name, without an ending, of a text and an HDF5 file that nobody names."""
    (tmp_path / "secret.txt").write_text(SECRET)
    with h5py.File(tmp_path / "secret.h5", "w") as file:
        file["text"] = np.frombuffer(SECRET.encode(), "S1")
    return tmp_path / "secret"


def external_link(group, name, secret):
    group[name] = h5py.ExternalLink(f"{secret}.h5", "/text")


def external_storage(group, name, secret):
    group.create_dataset(name, (len(SECRET),), "S1", external=[(f"{secret}.txt", 0, len(SECRET))])


def virtual(group, name, secret):
    layout = h5py.VirtualLayout((len(SECRET),), "S1")
    layout[:] = h5py.VirtualSource(f"{secret}.h5", "text", (len(SECRET),))
    group.create_virtual_dataset(name, layout)


def soft_link(group, name, secret):
    group["other"] = h5py.ExternalLink(f"{secret}.h5", "/text")
    group[name] = h5py.SoftLink(f"{group.name}/other")


@pytest.mark.parametrize("lead", [external_link, external_storage, virtual, soft_link])
@pytest.mark.parametrize("verb", ["report", "plot", "compare"])
@pytest.mark.usefixtures("figures_as_texts")
def test_no_other_file_is_read(lead, verb, run, secret, command, tmp_path):
    with h5py.File(run, "r+") as file:
        old = dict(file["performance/message"].attrs.items())
        del file["performance/message"]
        lead(file["performance"], "message", secret)
        if lead in (external_storage, virtual):
            for key in ("units", "long_name"):
                file["performance/message"].attrs[key] = old[key]
    more = [run] if verb == "compare" else ["-o", tmp_path / ("page.html" if verb == "report" else "drawn")]
    answer = command(verb, run, *more)
    texts = [path.read_bytes() for path in tmp_path.rglob("*") if path.is_file() and path.suffix in (".html", ".png")]
    assert not any(SECRET.encode() in text for text in texts)
    assert SECRET not in answer.out + answer.err
    if verb != "report" and lead in (external_storage, virtual):
        assert verb == "compare" or texts
        return  # messages are not read for those figures
    assert answer.code == 2
    assert answer.err.startswith(f"{run}: ")
    assert answer.err.count("\n") == 1


def test_values_packed_by_a_program_that_would_be_loaded_are_refused(swept):
    with h5py.File(swept, "r+") as file:
        how = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        how.set_chunk((3, 4))
        how.set_filter(32015, h5py.h5z.FLAG_OPTIONAL, (1,))
        old = dict(file["performance/status"].attrs.items())
        del file["performance/status"]
        space = h5py.h5s.create_simple((3, 4))
        h5py.h5d.create(file["performance"].id, b"status", h5py.h5t.NATIVE_INT8, space, how)
        for key in ("units", "long_name"):
            file["performance/status"].attrs[key] = old[key]
    with pytest.raises(UsageError, match=r"packs /performance/status in a way that results never use"):
        open_results(swept).status  # noqa: B018


@pytest.mark.parametrize(
    ("name", "kind", "what"),
    [
        ("performance/message", "S1", "/performance/message is not text"),
        ("inputs/operation_speed", "f8", r"/inputs/operation_speed states \d+ bytes and has 0"),
        ("cycle/pressure", "f8", "does not match the axes"),
    ],
)
@pytest.mark.parametrize("packed", [True, False])
def test_a_size_that_the_file_cannot_hold_is_refused_before_it_is_made(name, kind, what, packed, run):
    with h5py.File(run, "r+") as file:
        old = dict(file[name].attrs.items())
        del file[name]
        how = {"chunks": (1 << 20,), "compression": "gzip"} if packed else {}
        made = file.create_dataset(name, (1 << 40,), kind, **how)
        for key in ("units", "long_name"):
            made.attrs[key] = old[key]
    with pytest.raises(UsageError, match=what):
        group, _, variable = name.partition("/")
        getattr(open_results(run), group)[variable]


def coordinate_of_another_group(file, path):
    file.move("performance/shaft_power", "performance/angle")


def truncated(file, path):
    file.close()
    path.write_bytes(path.read_bytes()[:3000])


def statuses_out_of_range(file, path):
    file["performance/status"][...] = 7


def statuses_nan(file, path):
    replaced(file, "performance/status", np.full((3, 4), np.nan))


def status_missing(file, path):
    del file["performance/status"]


def group_missing(file, path):
    del file["error"]


def group_for_a_variable(file, path):
    del file["performance/shaft_power"]
    file["performance"].create_group("shaft_power").attrs["units"] = "W"


def transposed(file, path):
    replaced(file, "performance/shaft_power", np.ones((4, 3)))


def texts_for_numbers(file, path):
    replaced(file, "performance/shaft_power", np.full((3, 4), b"x", "S5"))


def compound(file, path):
    replaced(file, "performance/shaft_power", np.zeros((3, 4), [("a", "f8"), ("b", "i4")]))


def axis_of_nothing(file, path):
    file["performance/operation_speed"][...] = np.nan


def axis_of_another_path(file, path):
    file["performance/operation_speed"].attrs["path"] = "operation.sped"


def attribute_of_another_type(file, path):
    file["performance/shaft_power"].attrs["units"] = np.zeros(3)


def attribute_missing(file, path):
    del file["performance/shaft_power"].attrs["long_name"]


def scene_missing(file, path):
    del file.attrs["scene_yaml"]


def schema_of_words(file, path):
    file.attrs["screwsim_schema"] = "one"


def no_utf_8(file, path):
    file.attrs["title"] = np.bytes_(b"\xff\xfe")


def numbers_of_no_texts(file, path):
    file["performance/message"][...] = 99


def replaced(file, name, values):
    old = {key: file[name].attrs[key] for key in ("units", "long_name")}
    del file[name]
    file[name] = values
    file[name].attrs.update(old)


ODD = [
    coordinate_of_another_group,
    truncated,
    statuses_out_of_range,
    statuses_nan,
    status_missing,
    group_missing,
    group_for_a_variable,
    transposed,
    texts_for_numbers,
    compound,
    axis_of_nothing,
    axis_of_another_path,
    attribute_of_another_type,
    attribute_missing,
    scene_missing,
    schema_of_words,
    no_utf_8,
    numbers_of_no_texts,
]


@pytest.mark.parametrize("change", ODD, ids=lambda change: change.__name__)
@pytest.mark.parametrize("verb", ["report", "plot", "compare", "map"])
def test_an_odd_file_is_told_in_one_line(change, verb, swept, command, tmp_path):
    with h5py.File(swept, "r+") as file:
        change(file, swept)
    good = report_fakes.file(tmp_path / "good.h5", SCENE + SHORT)
    more = {"compare": [good], "map": [], "plot": ["-o", tmp_path / "figures"]}.get(verb, ["-o", tmp_path / "out.html"])
    answer = command(verb, swept, *more)
    assert "internal" not in answer.err
    assert answer.code in ((0, 2) if change is numbers_of_no_texts else (2,))
    if answer.code == 2:
        assert answer.err.startswith(f"{swept}: ")
        assert answer.err.count("\n") == 1
        assert "(" in answer.err  # the remedy


@pytest.mark.parametrize("change", [statuses_out_of_range, statuses_nan, status_missing, truncated])
def test_a_sweep_does_not_count_statuses_of_an_odd_file(change, swept):
    with h5py.File(swept, "r+") as file:
        change(file, swept)
    with pytest.raises(UsageError):
        count_statuses(swept)


def test_parts_that_are_not_whole_are_computed_again(tmp_path):
    scene = loads(SCENE + GRID)
    done = []

    def stopped(case):
        done.append(case)
        if len(done) > 12:
            raise KeyboardInterrupt
        return report_fakes.ok(case)

    out = tmp_path / "out.h5"
    with pytest.raises(KeyboardInterrupt):
        run_sweep(scene, out, jobs=1, simulate=stopped)
    parts = sorted((tmp_path / "out.h5.parts").glob("cases_*"))
    assert parts
    for part in parts:
        arrays = dict(np.load(part))
        arrays["status"] = np.full_like(arrays["status"], 7)
        np.savez(part, **arrays)
    assert run_sweep(scene, out, jobs=1, simulate=report_fakes.ok).reused == 0
    assert set(open_results(out).status.ravel()) == {"ok"}
