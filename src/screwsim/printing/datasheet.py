"""Output of `screwsim datasheet`."""

import textwrap

from screwsim.printing.tables import WIDTH, print_table, print_wrapped, wrapped
from screwsim.screen import say
from screwsim.study.datasheet import Sheet


def print_sheet(sheet: Sheet) -> None:
    """Print a data sheet: its lines, its tables, the verdict, notes."""
    print_wrapped(filter(None, (sheet.title, sheet.heading)))
    say()
    width = max((len(name) for name, _ in sheet.lines), default=0) + 2
    for name, text in sheet.lines:
        say(textwrap.fill(text, WIDTH - 1, initial_indent=name.ljust(width), subsequent_indent=" " * width))
    for table in sheet.tables:
        say()
        if len(sheet.tables) > 1:
            say(wrapped(table.title))
        print_table(table.heads, table.rows, table.left)
        if table.note:
            say(wrapped(table.note))
    if sheet.verdict is not None:
        what, text, _ = sheet.verdict
        say()
        say(wrapped(f"{what}: {text}"))
    say()
    print_wrapped(sheet.notes)
