"""A cycle: the problem to be solved, and the methods that close it.

Words used throughout: a *life* is the course of one chamber over 720°; a *history* is a life as stored, with its dense
output. A *turn* integrates one life among stored histories (a sweep of waveform relaxation), a *pitch* all chambers
over one lobe pitch (simultaneous closing). Both are maps: the *image* of the states and feedback unknowns is what a
turn or pitch ends with (`unknowns_in` are those that it is integrated with, `unknowns_out` their image). *Closing*
iterates until image and origin agree and the balances hold. *Tangents* are the linearised pitch, *coordinates* are
mostly logarithms (`coordinates`).
"""
