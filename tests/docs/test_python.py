"""The page on Python is true: its pieces run in the order of the page."""

import re
import shutil

import pytest
from folders import CONFIGS, ROOT

pytestmark = pytest.mark.around
PAGE = (ROOT / "docs" / "how-to" / "python.md").read_text(encoding="utf-8")
PIECES = re.findall(r"^```python\n(.*?)^```$", PAGE, re.M | re.S)


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    """Run all pieces of the page in one module, in a folder with shipped scenes; return names and folder."""
    folder = tmp_path_factory.mktemp("page")
    shutil.copytree(CONFIGS / "paper", folder / "configs" / "paper")
    names: dict = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for piece in PIECES:
            exec(piece, names)
    return names, folder


def test_every_piece_runs(outcome):
    names, folder = outcome
    assert len(PIECES) == 5 and (folder / "both.png").stat().st_size > 10_000
    assert names["gain"] > 1.0
    assert len(names["rows"]) == 3 and (names["rows"]["expanded"] > 0.0).all()


def test_sweep_table_and_optimum_agree(outcome):
    names, _ = outcome
    data, frame, best = names["data"], names["frame"], names["best"]
    assert list(frame["isothermal_efficiency"]) == pytest.approx(data.isothermal_efficiency.values.ravel().tolist())
    assert best.status == "ok" and best.figure >= names["result"].performance.isothermal_efficiency - 1e-3
