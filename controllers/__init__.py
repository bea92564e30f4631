"""What a robot decides: laws on arrays, with no simulator inside.

A law written for one robot works for `(trials, robots)` as well: these axes lead, vectors being `(..., 2)`, but in the
local laws, whose vectors are `(2, ...)`; see `axes`. World-frame quantities end in `_w`, body-frame ones in `_b`; SI
units and radians.
"""
