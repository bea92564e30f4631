"""What a robot decides: laws on arrays, with no simulator inside.

Leading axes broadcast: a law written for one robot works for `(trials, robots)` as well. World-frame quantities end in
`_w`, body-frame ones in `_b`; SI units and radians.
"""
