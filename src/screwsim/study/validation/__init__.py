"""Validation: published references beside computed values, with verdicts that can be `fails`.

A source is a folder `validation/<name>/` of the checkout: data with their source and uncertainty, scenes, and
`compare.py` with one function, `compare(here: Path) -> Comparison`. This package has everything that such a module
needs.
"""

from screwsim.study.validation.discrepancy import compared, model_errors
from screwsim.study.validation.record import (
    Comparison,
    NotRun,
    Panel,
    Row,
    Series,
    ValidationPoint,
    equal,
    trend,
    value_text,
)
from screwsim.study.validation.sources import (
    INTERRUPTED,
    SourceOutcome,
    document,
    errors_of,
    folder_of,
    names_of,
    read_table,
    run_sources,
    sibling,
    solved,
)
