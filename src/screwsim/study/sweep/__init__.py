"""Grids, samples and lists of cases: solved in shards that survive a kill, on one machine or a cluster."""
