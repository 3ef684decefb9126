"""Look at the site of the docs: pictures of pages, light, dark, on a phone; a page wider than its window is an error.

    python docs/tools/site_pictures.py [SITE] [-o FOLDER]     (defaults: results/site/html and results/site/pictures)

Needs chromium on PATH, and the site of `python docs/tools/docs_site.py`. Every page is measured, some are drawn.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from playwright.sync_api import Page

PICTURED = (
    "index",
    "start/tutorial",
    "how-to/python",
    "reference/scene",
    "reference/api",
    "reference/equations",
    "model",
    "gallery",
)
LOOKS: dict[str, tuple[int, int, Literal["light", "dark"]]] = {
    "light": (1360, 900, "light"),
    "dark": (1360, 900, "dark"),
    "phone": (390, 844, "light"),
    "phone-dark": (390, 844, "dark"),
    "tablet": (1020, 900, "light"),
}


def look(page: Page, site: Path, folder: Path, name: str) -> list[str]:
    """Draw the pages in one look; return those that are wider than the window."""
    wide = []
    for file in sorted(site.rglob("*.html")):
        page.goto(file.as_uri())
        if page.evaluate("document.documentElement.scrollWidth > window.innerWidth"):
            wide.append(f"{file.relative_to(site)} is wider than its window ({name})")
        which = file.relative_to(site).with_suffix("").as_posix()
        if which in PICTURED:
            page.screenshot(path=folder / f"{which.replace('/', '-')}_{name}.png")
    return wide


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("site", nargs="?", type=Path, default=Path("results/site/html"))
    parser.add_argument("-o", "--output", type=Path, default=Path("results/site/pictures"))
    asked = parser.parse_args()
    site, path = asked.site.resolve(), shutil.which("chromium") or shutil.which("chromium-browser")
    if not (site / "index.html").is_file():
        raise SystemExit(f"{asked.site}: holds no site (python docs/tools/docs_site.py makes it)")
    if path is None:
        raise SystemExit("no chromium on PATH (apt-get install chromium)")
    from playwright.sync_api import sync_playwright

    asked.output.mkdir(parents=True, exist_ok=True)
    wide: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        for name, (width, height, scheme) in LOOKS.items():
            page = browser.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)
            wide += look(page, site, asked.output, name)
        browser.close()
    print("\n".join([*wide, str(asked.output)]))
    return 1 if wide else 0


if __name__ == "__main__":
    sys.exit(main())
