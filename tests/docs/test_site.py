"""What the site is made of: every page in its tree, no link that leads out, a picture for each piece of the gallery.

And that it is made without a warning, which a link to nowhere would be.
"""

import re

import pytest
from folders import ROOT

import screwsim
from screwsim.study.validation import sibling

pytestmark = pytest.mark.around
site = sibling(ROOT / "docs" / "tools" / "docs_site.py")


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """Return a folder with the pages as they are given to Sphinx."""
    folder = tmp_path_factory.mktemp("site")
    site.copy_pages(folder)
    site.copy_notebooks(folder / "notebooks")
    (folder / "reference" / "api.md").write_text(site.api_page(), encoding="utf-8")
    return folder


def test_every_page_is_in_the_tree(source):
    listed = re.findall(r"^[\w./-]+$", site.index(source), re.M)
    pages = {str(path.relative_to(source)).removesuffix(".md") for path in source.rglob("*.md")}
    assert pages <= set(listed)
    assert {f"notebooks/{path.stem}" for path in (source / "notebooks").glob("*.ipynb")} <= set(listed)


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
    assert pieces == 9 == page.count("![") == len(list((tmp_path / "gallery").glob("*.png")))
    for number in range(1, pieces + 1):  # each behind its own lines, and with something in it
        assert f"![what the lines above draw](gallery/{number}.png)" in page.split("```python\n")[number]
        assert (tmp_path / "gallery" / f"{number}.png").stat().st_size > 10_000


def test_lines_of_the_gallery_that_draw_nothing_are_told(tmp_path):
    (tmp_path / "gallery.md").write_text("```python\nfrom matplotlib import pyplot\npyplot.figure()\n```\n")
    with pytest.raises(SystemExit, match="draw nothing"):
        site.gallery(tmp_path / "gallery.md", tmp_path)


def test_the_first_page_begins_with_what_it_is_and_shows_commands_and_a_picture(source):
    text = site.index(source)
    words = (ROOT / "README.md").read_text(encoding="utf-8").split("\n\n")[1]
    assert text.startswith(f"# screwsim\n\n{words}") and "screwsim run mine.yaml" in text
    (picture,) = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    assert (source / picture).is_file()
    assert text.count(":::{container} cards") == len(site.SECTIONS) == text.count("```{toctree}")


def test_words_that_are_a_file_name_become_its_heading():
    text = site.local_links(
        "[python.md](../how-to/python.md), [there](../how-to/python.md), [x](../../README.md)", ROOT / "docs" / "start"
    )
    assert text == "[From Python](../how-to/python.md), [there](../how-to/python.md), x"


def test_a_signature_has_a_parameter_a_line_where_it_is_long():
    def short(one: "int", *more: "str") -> "float": ...

    def long(
        scene: "str", *, the_first_of_them: "str | None" = None, the_second_of_them: "float" = 1.0, third: "int" = 2
    ): ...

    assert site._signature("short", short) == "short(one: int, *more: str) -> float"
    assert site._signature("long", long).splitlines()[:3] == ["long(", "    scene: str,", "    *,"]
    assert "    the_first_of_them: str | None = None,\n" in site._signature("long", long)


def test_an_index_stands_beside_a_letter_with_an_accent():
    conf: dict = {}
    exec(site.CONF.format(version="0"), conf)
    text = re.sub(r"\s|<math[^>]*>|</math>", "", conf["mathml"](r"\dot m_i + \sum_i x", True))
    assert text.startswith('<msub><moveraccent="true"><mi>m</mi>') and "munderover" not in text and "<munder>" in text


def test_two_digits_behind_a_fraction_are_its_numerator_and_its_denominator():
    conf: dict = {}
    exec(site.CONF.format(version="0"), conf)
    text = re.sub(r"\s|<math[^>]*>|</math>", "", conf["mathml"](r"\tfrac12 x", True))
    assert text.endswith("<mn>1</mn><mn>2</mn></mfrac><mi>x</mi>")


@pytest.mark.slow
def test_the_site_is_made_without_a_warning(tmp_path, capfd):
    assert site.main(str(tmp_path)) == 0, capfd.readouterr()
    made = {str(page.relative_to(tmp_path / "html")) for page in (tmp_path / "html").rglob("*.html")}
    pages = {str(page.relative_to(ROOT / "docs").with_suffix(".html")) for page in (ROOT / "docs").rglob("*.md")}
    assert pages - {"README.html"} < made and {"index.html", "reference/api.html"} < made
    page = (tmp_path / "html" / "notebooks" / "machine.html").read_text(encoding="utf-8")
    stored = (ROOT / "docs" / "notebooks" / "machine.ipynb").read_bytes()
    assert page.count('<div class="cell_output') > 5
    assert [path.read_bytes() for path in (tmp_path / "html" / "_downloads").rglob("machine.ipynb")] == [stored]


def test_a_warning_fails_the_site(tmp_path, capfd):
    """A link to a missing page is kept as the pages are copied, and told as a missing heading or picture is."""
    source = tmp_path / "source"
    (source / "notebooks" / "files").mkdir(parents=True)
    (source / "notebooks" / "files" / "notebooks.css").touch()
    (source / "_static").mkdir()
    (source / "conf.py").write_text(site.CONF.format(version="0"), encoding="utf-8")
    told = {
        "[a page](how-to/gone.md)": "how-to/gone.md",
        "[a heading](#gone)": "gone",
        "![a picture](gone.png)": "gone.png",
        "$\\gone x$": "gone",
        "{term}`gone`": "gone",
    }
    text = site.local_links("# Page\n\n" + "\n\n".join(told) + "\n", site.DOCS)
    (source / "index.md").write_text(text, encoding="utf-8")
    assert site.build(source, tmp_path / "html") == 1
    warnings = [line for line in capfd.readouterr().err.splitlines() if "WARNING" in line]
    assert len(warnings) == len(told)
    for found in told.values():
        assert any(found in line for line in warnings), (found, warnings)
    (source / "index.md").write_text("# Page\n\n[a heading](#page)\n", encoding="utf-8")
    assert site.build(source, tmp_path / "html") == 0
