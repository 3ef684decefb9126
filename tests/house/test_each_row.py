"""A test of every row of a table asks all of them, and names each that fails."""

import pytest
from each_row import each_row


def test_all_rows_are_asked_and_those_that_fail_are_named():
    asked = []

    @each_row("tens", [10, 20])
    @each_row(("ones", "word"), [(1, "one"), (2, "two"), (3, "three")])
    def law(tens, ones, word):
        asked.append(tens + ones)
        assert tens + ones not in (12, 23)
        with pytest.raises(ZeroDivisionError):
            1 / (ones - 1)

    with pytest.raises(pytest.fail.Exception) as told:
        law()
    assert asked == [11, 12, 13, 21, 22, 23]
    found = str(told.value)
    assert "2 of 2 rows fail" in found and found.count("2 of 3 rows fail") == 2
    assert "{'ones': 2, 'word': 'two'}: AssertionError" in found and "{'ones': 3, 'word': 'three'}: Assert" in found


def test_a_table_of_nothing_fails():
    @each_row("name", [])
    def law(name):
        raise AssertionError

    with pytest.raises(AssertionError, match="there is no row"):
        law()


@each_row("name", ["one", "two"])
def test_fixtures_are_those_of_the_test(name, tmp_path):
    assert tmp_path.is_dir() and name in ("one", "two")
