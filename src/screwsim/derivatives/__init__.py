"""Derivatives of a closed cycle's figures by numbers of its scene, by the implicit-function theorem.

The cycle is written as polynomials on a mesh of slices of a pitch (`mesh`, `pitch`), closed by Newton's method
(`collocation`, `newton`) and linearised (`linear`, `linear_cycle`). A number of the scene changes the arguments of the
rates (`directions`); these change the cycle, and with it the figures and the machine's surroundings (`solving`).

Source: docs/explanation/derivatives.md.
"""
