"""A film of one trial, drawn offscreen and encoded frame by frame.

Comes in: what only films need: cameras, overlays, the strip, the encoder. What windows show too is `viewing`'s.
"""
