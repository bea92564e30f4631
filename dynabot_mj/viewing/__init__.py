"""One trial frame by frame: recorded, set up as a MuJoCo model, played back, in a window or in the browser.

Comes in: what is watched or kept of a single trial. Judging it is `formation`'s.
"""
