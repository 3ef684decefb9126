"""Draw docs/figures/explore.png: the live page of a machine, its last settings pale.

python docs/tools/explore_picture.py [SCENE] [-o PICTURE.png] [--dark] [--phone]
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "configs" / "rotors" / "b.yaml"
PICTURE = ROOT / "docs" / "figures" / "explore.png"
BEFORE, CHANGED, ANGLE = "2500 rpm", "2950 rpm", 620
SIZES = {"desktop": (1360, 1180), "phone": (390, 844)}
DRAWN = "shown !== null && sent.size === 0 && !moved && !typing && around.left === 0"


def picture(url: str, target: Path, dark: bool, phone: bool) -> None:
    """Open the page, change a setting as a hand would, and take its picture."""
    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        raise SystemExit("no chromium on PATH (apt-get install chromium)")
    width, height = SIZES["phone" if phone else "desktop"]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        page = browser.new_page(
            viewport={"width": width, "height": height},
            color_scheme="dark" if dark else "light",
            reduced_motion="reduce",
        )
        page.goto(f"{url}#operation.speed={BEFORE.replace(' ', '%20')}")
        wait(page)
        if phone:
            page.click("#settings summary")
        page.evaluate("around.left = -1")
        page.locator("#of-operation-speed").fill(CHANGED.partition(" ")[0])
        wait(page)
        page.evaluate(f"scrub({ANGLE})")
        target.parent.mkdir(parents=True, exist_ok=True)
        page.mouse.click(2, 2)
        page.screenshot(path=target, full_page=phone)
        browser.close()


def wait(page: object) -> None:
    """Wait until all is drawn and the sliders have their colours."""
    for _ in range(600):
        time.sleep(0.1)
        if page.evaluate(DRAWN):  # type: ignore[attr-defined]
            return
    raise SystemExit("the page did not come to rest within a minute")


def main() -> None:
    """Serve the scene, and take the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", default=str(SCENE))
    parser.add_argument("-o", "--output", type=Path, default=PICTURE)
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--phone", action="store_true")
    chosen = parser.parse_args()
    command = [sys.executable, "-m", "screwsim", "explore", chosen.scene, "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            match = re.match(r"http://\S+", process.stdout.readline())
            if match is None:
                raise SystemExit("screwsim explore printed no address")
            picture(match[0], chosen.output, chosen.dark, chosen.phone)
        finally:
            process.terminate()
    print(chosen.output)


if __name__ == "__main__":
    main()
