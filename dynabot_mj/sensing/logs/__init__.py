"""Samples of a real or simulated robot as CSV and NetCDF; docs/logs.md."""
