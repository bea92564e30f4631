"""A film of one trial, drawn offscreen and encoded frame by frame."""
