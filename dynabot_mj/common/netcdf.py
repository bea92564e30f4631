"""Datasets as NetCDF: equal ones give equal bytes, and a Dask client that is around does not matter."""

import contextlib
import sys

import xarray as xr


def content(dataset: xr.Dataset) -> bytes:
    """Returns a Dataset as the bytes of a file; whoever writes them gets an `OSError` where the library would crash."""
    with contextlib.ExitStack() as stack:
        if "dask" in sys.modules:
            # With a client of the user's xarray would ask its cluster for a lock on our bytes, which there is none of.
            import dask

            stack.enter_context(dask.config.set(scheduler="synchronous"))
        return bytes(dataset.to_netcdf(engine="h5netcdf"))
