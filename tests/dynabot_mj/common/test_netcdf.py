import xarray as xr

from dynabot_mj.common import netcdf


def test_what_is_written_is_read_and_equal_datasets_are_equal_bytes(tmp_path):
    made = [xr.Dataset({"a": ("x", [1.0, 2.0], {"units": "m"})}, attrs={"seed": 0}) for _ in range(2)]
    assert netcdf.content(made[0]) == netcdf.content(made[1])
    (tmp_path / "a.nc").write_bytes(netcdf.content(made[0]))
    with xr.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as found:
        xr.testing.assert_identical(found.load(), made[0])
