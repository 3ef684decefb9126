"""Slider-crank machines: motion of the piston, its tolerances, the flexible connecting rod (docs/slider-crank.md)."""
