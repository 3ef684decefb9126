"""Slider-crank machines: motion, tolerances, the flexible connecting rod (docs/reference/slider-crank.md)."""
