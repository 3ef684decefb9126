"""A law over a table as one test: separate tests would cost several milliseconds per row."""

import inspect
from collections.abc import Callable, Iterable
from typing import Any

import pytest

Test = Callable[..., None]


def each_row(names: str | tuple[str, ...], values: Iterable[Any], ids: object = None) -> Callable[[Test], Test]:
    """Return a decorator that runs a test for every row, as `pytest.mark.parametrize` does, but as one test.

    All rows run, and each failure is reported with its row; a table without rows fails. `ids` name rows in pytest's
    reports: here their values do.
    """
    keys = [name.strip() for name in names.split(",")] if isinstance(names, str) else list(names)
    table = [tuple(row) if len(keys) > 1 else (row,) for row in values]

    def decorated(test: Test) -> Test:
        def of_all(**fixtures: Any) -> None:
            assert table, "there is no row"
            failed = []
            for row in table:
                given = dict(zip(keys, row, strict=True))
                try:
                    test(**fixtures, **given)
                except (Exception, pytest.fail.Exception) as error:  # noqa: BLE001 - of any kind
                    failed.append(f"{given}: {type(error).__name__}: {error}")
            if failed:
                pytest.fail("\n".join([f"{len(failed)} of {len(table)} rows fail", *failed]), pytrace=False)

        asked = inspect.signature(test)
        kept = [parameter for name, parameter in asked.parameters.items() if name not in keys]
        of_all.__signature__ = asked.replace(parameters=kept)  # type: ignore[attr-defined]
        of_all.__name__, of_all.__doc__, of_all.__module__ = test.__name__, test.__doc__, test.__module__
        of_all.__qualname__ = test.__qualname__
        of_all.pytestmark = list(getattr(test, "pytestmark", []))  # type: ignore[attr-defined]
        return of_all

    return decorated
