"""Grids, samples and lists of cases: solved in shards that survive a kill, on one machine or a cluster."""

from screwsim.study.sweep.run import run_sweep, sweep
