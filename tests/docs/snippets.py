"""All blocks of code of the pages, fenced or indented, and the notes above them.

A note is a comment of the page, `<!-- snippet: … -->`, directly above a block, and says what the block is:

- `part of SCENE`: lines that go into that scene
- `file NAME`: the file of that name, for the blocks behind it; so does a first line `# NAME.yaml` in the block
- `given PYTHON`: what those lines make is there when the block runs
- `printed above`: what the command above prints
- `long, REASON`: it is run, as one script, where SCREWSIM_LONG_SNIPPETS is set, and else read as one that is not run
- `not run, REASON`: no more is checked than that a shell can read it and that the commands of screwsim in it exist
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from markdown_it import MarkdownIt

ROOT = Path(__file__).parents[2]
BLOCKS = MarkdownIt().disable(["inline", "text_join"])  # what stands within sentences takes most of the time
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
NOTE = re.compile(r"<!-- snippet: (part of|file|given|printed above|long,|not run,)\s*(.*?)\s*-->", re.S)
SHELL = ("bash", "sh", "console")
NAMED = re.compile(r"# (\S+\.yaml)$")
COMMAND = re.compile(r"(?:\$ )?(?:\.venv/bin/)?(?:screwsim|python3?|pip|scripts/\w+) ?")

PROMPTED = re.compile(r"\$ |screwsim [a-z0-9]+ \S*[./]\S")


@dataclass(frozen=True)
class Block:
    """A block of a page: where it is, its language as written (none: indented), text, and notes {what: more}."""

    page: str
    line: int
    language: str
    text: str
    notes: dict[str, str]

    @property
    def place(self) -> str:
        return f"{self.page}:{self.line}"

    @property
    def kind(self) -> str:
        """`python`, `yaml` or `shell`; `noted` where only a note says what it is; `unknown` has no check."""
        if self.notes.keys() & {"printed above", "long,", "not run,"}:
            return "noted"
        if self.language in ("python", "yaml"):
            return self.language
        if self.language in SHELL or (not self.language and COMMAND.match(self.text)):
            return "shell"
        return "noted" if "file" in self.notes else "unknown"

    @property
    def file(self) -> str | None:
        """The name of the file that the block is."""
        named = NAMED.match(self.text.partition("\n")[0])
        return self.notes.get("file") or (named[1] if named and self.language == "yaml" else None)


@cache  # the tests of two files begin with all pages, and read each again
def blocks(page: Path, text: str | None = None) -> tuple[Block, ...]:
    """Return the blocks of a page in its order."""
    found = []
    notes: dict[str, str] = {}
    for token in BLOCKS.parse(page.read_text(encoding="utf-8") if text is None else text):
        if token.type == "html_block":
            notes |= dict(NOTE.findall(token.content))
            continue
        if token.type in ("fence", "code_block"):
            name = page.relative_to(ROOT).as_posix()
            found.append(Block(name, token.map[0] + 1, token.info.strip(), token.content, notes))
        notes = {}
    return tuple(found)


def unchecked(found: Sequence[Block]) -> list[str]:
    """Return the places of blocks that no test could check."""
    return [block.place for block in found if block.kind == "unknown"]


def run_together(page: Path, text: str | None = None) -> list[str]:
    """Return the places of commands that are prose to readers of the page: below a list, with too few blanks before."""
    tokens = BLOCKS.parse(page.read_text(encoding="utf-8") if text is None else text)
    prose = [token for token in tokens if token.type == "inline" and PROMPTED.match(token.content)]
    return [f"{page.relative_to(ROOT).as_posix()}:{token.map[0] + 1}" for token in prose]


def named_commands(page: Path) -> list[str]:
    """Return the commands of screwsim that a page names within its sentences."""
    inline = [token for token in MarkdownIt().enable("table").parse(page.read_text(encoding="utf-8")) if token.children]
    words = [each.content for token in inline for each in token.children if each.type == "code_inline"]
    return [each for each in words if each.startswith("screwsim ")]
