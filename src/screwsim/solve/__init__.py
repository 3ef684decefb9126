"""Solve a problem: a cycle closed as accurately as the scene asks, with its drive and its surroundings."""
