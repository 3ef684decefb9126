"""Solving a problem: closed as accurately as it asks, together with its drive."""
