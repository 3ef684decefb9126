"""What a command that is interrupted says of its work, where nothing of it is kept."""

from collections.abc import Iterator
from contextlib import contextmanager

from screwsim.cli.options import INTERRUPTED, print_error, progress_bar
from screwsim.study.progress import Progress, TolerantProgress


@contextmanager
def counted_progress(title: str, what: str) -> Iterator[Progress]:
    """Give a progress display; after Ctrl-C, say on stderr how much was done, in a word for the points (`machines`)."""
    counted = TolerantProgress(progress_bar(title))
    try:
        yield counted
    except KeyboardInterrupt:
        done, there_are = counted.counts
        if done:
            kept = "none is kept, and the same command begins anew"
            print_error(f"{title}: {done} of {there_are} {what} were done; {kept}", INTERRUPTED)
        raise
