"""What the site is made of: every page in its tree, no link that leads out, a picture for each piece of the gallery."""

import importlib.util
import re
from pathlib import Path

import pytest

import screwsim

ROOT = Path(__file__).parents[2]
SPEC = importlib.util.spec_from_file_location("site_script", ROOT / "scripts" / "docs_site.py")
site = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(site)


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """Return a folder with the pages as they are given to Sphinx."""
    folder = tmp_path_factory.mktemp("site")
    site.copy_pages(folder)
    (folder / "reference" / "api.md").write_text(site.api_page(), encoding="utf-8")
    return folder


def test_every_page_is_in_the_tree(source):
    listed = re.findall(r"^[\w./-]+$", site.index(source), re.M)
    pages = {str(path.relative_to(source)).removesuffix(".md") for path in source.rglob("*.md")}
    assert pages <= set(listed)


def test_links_stay_inside(source):
    for page in source.rglob("*.md"):
        for _, target in site.LINK.findall(page.read_text(encoding="utf-8")):
            file = target.partition("#")[0]
            assert not file or (page.parent / file).is_file() or file.endswith("gallery.md"), (page, target)


def test_the_reference_has_every_public_name(source):
    text = (source / "reference" / "api.md").read_text(encoding="utf-8")
    for name in screwsim.__all__:
        assert name.startswith("__") or f"## screwsim.{name}" in text, name
    assert "## screwsim.plot.pressure_volume" in text


def test_each_piece_of_the_gallery_draws(tmp_path):
    page = site.gallery(ROOT / "docs" / "gallery.md", tmp_path)
    pieces = page.count("```python\n")
    assert pieces == 4 == page.count("![") == len(list((tmp_path / "gallery").glob("*.png")))
