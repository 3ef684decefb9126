"""Gases as users write them: each a module of its own with a variable GAS."""
