import dataclasses
import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.experiments.estimators import kinematic
from dynabot_mj.perception import estimators
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.faults import Fault
from dynabot_mj.sensing.logs import log as logs
from dynabot_mj.sensing.logs.columns import COLUMNS
from dynabot_mj.sensing.options import SensorOptions, WheelErrors

FIELDS = [field.name for field in dataclasses.fields(logs.Log)]
DOCUMENT = Path(__file__).parents[4] / "docs" / "logs.md"


@pytest.fixture(scope="module")
def drive():
    """Two runs of a circle with wheels, and samples with every kind of gap."""
    truth = kinematic.follow("circle", 2, 3, 8.0, 0.012)
    phase = truth.time[:, None, None] + np.arange(4) + np.arange(2)[:, None]
    truth = dataclasses.replace(truth, wheel_speed=30.0 * np.sin(phase), motor_current=5.0 * np.cos(phase))
    faults = (
        Fault(kind="nan", channel="gyro", start=1.0, end=1.5),
        Fault(kind="nan", channel="gps_velocity", start=2.0, end=2.5),
        Fault(kind="outage", start=4.0, end=5.0),
    )
    return truth, replay.record(truth, SensorOptions(faults=faults), 0.036, 3)


@pytest.fixture(scope="module")
def log(drive):
    truth, samples = drive
    return logs.from_run(samples, truth, 1, WheelErrors(speed=0.2, current=0.0))


def equal(one, other):
    for name in FIELDS:
        a, b = getattr(one, name), getattr(other, name)
        assert (a is None) == (b is None), name
        if a is not None:
            np.testing.assert_array_equal(a, b, strict=True, err_msg=name)


@pytest.mark.parametrize("extension", ["csv", "nc"])
def test_what_is_written_is_read_to_the_last_bit(log, tmp_path, extension):
    first, second = (tmp_path / f"{name}.{extension}" for name in "ab")
    logs.write(first, log)
    found = logs.read(first)
    equal(found, log)
    logs.write(second, found)
    assert first.read_bytes() == second.read_bytes()
    bare = dataclasses.replace(log, wheel_speed=None, motor_current=None, position_w=None, heading=None)
    logs.write(first, bare)
    equal(logs.read(first), bare)


@pytest.mark.parametrize("extension", ["csv", "nc"])
def test_a_file_gives_the_estimates_of_the_samples_in_memory(drive, log, tmp_path, extension):
    _, recorded = drive
    path = tmp_path / f"log.{extension}"
    logs.write(path, log)
    for name in estimators.NAMES:
        tracks = [replay.follow(one, estimators.build(name, (1,))) for one in (logs.read(path).samples, log.samples)]
        for field in dataclasses.fields(replay.Track):
            a, b = (getattr(track, field.name) for track in tracks)
            np.testing.assert_array_equal(a, b)
        # Of the run itself they differ by the rounding of time - age.
        run = replay.follow(recorded, estimators.build(name, (2,)))
        np.testing.assert_allclose(tracks[0].position_w[:, 0], run.position_w[:, 1], atol=1e-9)
        np.testing.assert_array_equal(tracks[0].known[:, 0], run.known[:, 1])


def test_a_log_of_a_run_has_its_samples_and_its_truth(drive, log):
    truth, recorded = drive
    samples = log.samples
    np.testing.assert_array_equal(samples.imu.period[:, 0], recorded.imu.period[:, 1])
    np.testing.assert_array_equal(samples.imu.magnetic_heading[:, 0], recorded.imu.magnetic_heading[:, 1])
    # A fix with a velocity that is not a number is none.
    usable = recorded.fix.received[:, 1] & np.isfinite(recorded.fix.velocity_w[:, 1]).all(axis=-1)
    assert usable.sum() < recorded.fix.received[:, 1].sum()
    np.testing.assert_array_equal(samples.fix.received[:, 0], usable)
    np.testing.assert_allclose(samples.fix.age[usable, 0], recorded.fix.age[usable, 1], atol=1e-12)
    np.testing.assert_array_equal(log.position_w, truth.position_w[::3, 1])
    np.testing.assert_array_equal(log.heading, truth.heading[::3, 1])
    assert np.abs(log.wheel_speed - truth.wheel_speed[::3, 1]).max() == pytest.approx(0.1, abs=0.02)
    np.testing.assert_array_equal(log.motor_current, truth.motor_current[::3, 1])


def test_a_log_that_would_be_refused_is_not_written(tmp_path, log):
    nothing = np.full_like(log.fix_time, np.nan)
    silent = dataclasses.replace(
        log,
        fix_time=nothing,
        fix_position_w=np.stack([nothing] * 2, -1),
        fix_velocity_w=np.stack([nothing] * 2, -1),
    )
    with pytest.raises(InputError, match="there is no fix"):
        logs.write(tmp_path / "log.csv", silent)
    assert list(tmp_path.iterdir()) == []


NUMBERS = st.floats(allow_infinity=False, allow_nan=False)
SAMPLES = st.floats(allow_infinity=False)  # NaN: missing


@settings(max_examples=40)
@given(
    times=st.lists(st.floats(0.0, 2e9), min_size=2, max_size=6, unique=True),
    samples=st.lists(SAMPLES, min_size=6 * 9, max_size=6 * 9),
    fixes=st.lists(NUMBERS, min_size=6 * 4, max_size=6 * 4),
    fixed=st.lists(st.booleans(), min_size=6, max_size=6),
    extension=st.sampled_from(["csv", "nc"]),
)
def test_every_log_survives(times, samples, fixes, fixed, extension):
    count = len(times)
    received = np.array(fixed[:count]) | (np.arange(count) == 0)
    values = np.array(samples).reshape(6, 9)[:count]
    fix = np.where(received[:, None], np.array(fixes).reshape(6, 4)[:count], np.nan)
    time = np.sort(times)
    written = logs.Log(
        time=time,
        specific_force_b=values[:, :2],
        yaw_rate=values[:, 2],
        bearing=np.clip(np.where(received, np.nan_to_num(values[:, 3]), values[:, 3]), -6.0, 6.0),
        fix_time=np.where(received, time, np.nan),
        fix_position_w=fix[:, :2],
        fix_velocity_w=fix[:, 2:],
        wheel_speed=values[:, 4:8],
        heading=values[:, 8],
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"log.{extension}"
        logs.write(path, written)
        equal(logs.read(path), written)


def test_the_example_of_the_documentation_is_a_log(tmp_path):
    document = DOCUMENT.read_text(encoding="utf-8")
    example = re.search(r"```csv\n(.*?)```", document, re.DOTALL).group(1)
    assert len(example.splitlines()) == 10
    (tmp_path / "my_robot.csv").write_text(example)
    found = logs.read(tmp_path / "my_robot.csv")
    assert np.isfinite(found.fix_time).sum() == 1
    assert np.isnan(found.bearing).sum() == 1
    # The error that is shown there.
    lines = [line.replace(",-0.209,", ",,") for line in example.splitlines()]
    (tmp_path / "my_robot.csv").write_text("\n".join(lines))
    with pytest.raises(InputError) as caught:
        logs.read(tmp_path / "my_robot.csv")
    assert f"dynabot: {str(caught.value).replace(str(tmp_path) + '/', '')}" in document
    described = [name for name in COLUMNS if not re.search("wheel|motor", name)]
    assert all(f"`{name}`" in document for name in described)
