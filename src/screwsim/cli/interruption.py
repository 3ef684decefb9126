"""What a command that is interrupted says of its work, where nothing of it is kept."""

from collections.abc import Iterator
from contextlib import contextmanager

from screwsim.cli.options import INTERRUPTED, print_error, progress_bar
from screwsim.study.progress import Progress, TolerantProgress


class CountedProgress(TolerantProgress):
    """Forward to another progress, and count the finished cases."""

    def __init__(self, told: Progress) -> None:
        """Count what is forwarded to `told`."""
        super().__init__(told)
        self.cases = self.done = 0

    def start(self, cases: int, reused: int) -> None:
        """Begin to count, from the cases that are reused."""
        self.cases, self.done = cases, reused
        super().start(cases, reused)

    def advance(self, cases: int, failed: int) -> None:
        """Count finished cases."""
        self.done += cases
        super().advance(cases, failed)

    def more(self, cases: int) -> None:
        """Expect more cases."""
        self.cases += cases
        super().more(cases)


@contextmanager
def counted_progress(title: str, what: str) -> Iterator[Progress]:
    """Give a progress display; after Ctrl-C, say on stderr how much was done, in a word for the cases (`machines`)."""
    counted = CountedProgress(progress_bar(title))
    try:
        yield counted
    except KeyboardInterrupt:
        if counted.done:
            kept = "none is kept, and the same command begins anew"
            print_error(f"{title}: {counted.done} of {counted.cases} {what} were done; {kept}", INTERRUPTED)
        raise
