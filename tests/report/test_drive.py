"""Figures of drives: harmonics of the lobes, resonances where they meet the torsional frequency."""

import math

import numpy as np
import pytest

from screwsim.report.drive import DrivePoint, campbell_figure, crossing

RPM = math.pi / 30.0
SPEEDS = np.arange(250.0, 5001.0, 50.0)
POINTS = [DrivePoint(n * RPM, 100.0, 115.0, 1e5 / n, 0.01) for n in SPEEDS]
FAILED = DrivePoint(5050.0 * RPM, None, None, None, None)


def test_resonances_are_marked_where_a_lobe_harmonic_has_the_frequency():
    """100 Hz with four lobes: 1500, 750 and 500 rpm."""
    left, right = campbell_figure({"one": [*POINTS, FAILED]}, 4).axes
    marks = [line.get_xdata()[0] for line in left.lines if line.get_marker() == "o"]
    assert marks == pytest.approx([1500.0, 750.0, 500.0], rel=1e-9)
    assert [line.get_xdata()[0] for line in right.lines if list(line.get_ydata()) == [0, 1]] == marks


def test_a_drive_that_failed_at_a_speed_leaves_a_gap_at_its_end():
    left, _ = campbell_figure({"one": [*POINTS, FAILED]}, 4).axes
    curve = next(line for line in left.lines if line.get_label() == "one")
    assert curve.get_xdata()[-1] == pytest.approx(5000.0)


def test_a_curve_that_does_not_pass_zero_has_no_crossing():
    assert crossing(SPEEDS, np.ones_like(SPEEDS)) is None
    assert crossing(np.array([0.0, 1.0]), np.array([-1.0, 3.0])) == pytest.approx(0.25)
