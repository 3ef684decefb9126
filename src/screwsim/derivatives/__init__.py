"""Derivatives of a closed cycle's figures by the numbers of its scene, by the implicit-function theorem.

The cycle is written as polynomials on slices of a pitch (`slices`, `pitch`), closed by Newton's method (`closed`) and
linearised (`linear`); a number of the scene moves what the rates take (`directions`), that moves the cycle, and with it
the figures and what lies around the machine (`solving`).

Source: docs/explanation/derivatives.md.
"""
