"""Samples of a real or simulated robot as CSV and NetCDF; docs/logs.md.

Comes in: what of a robot's samples is in a file.
"""
