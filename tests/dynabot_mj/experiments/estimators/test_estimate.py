import dataclasses
import json

import numpy as np
import pytest

from dynabot_mj import cli
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.experiments.estimators import estimate, kinematic
from dynabot_mj.figures import log as log_figure
from dynabot_mj.perception import estimators
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.faults import Fault
from dynabot_mj.sensing.logs import log as logs
from dynabot_mj.sensing.options import SensorOptions, WheelErrors


def recorded(duration, *faults):
    truth = kinematic.follow("circle", 1, 5, duration, 0.018)
    samples = replay.record(truth, SensorOptions(faults=faults), 0.036, 5)
    return logs.from_run(samples, truth, 0, WheelErrors())


@pytest.fixture(scope="module")
def log():
    return recorded(9.0)


@pytest.fixture(scope="module")
def found(log):
    return estimate.run("log.csv", log)


def test_the_summary_is_that_of_the_tracks(found, log):
    assert [row.estimator for row in found.rows] == list(estimators.NAMES) == list(found.tracks)
    for row in found.rows:
        track = found.tracks[row.estimator]
        known = track.known[:, 0]
        distance = np.linalg.norm((track.position_w[:, 0] - log.position_w)[known], axis=-1)
        assert (row.samples, row.fixes) == (len(log.time), np.isfinite(log.fix_time).sum())
        assert (row.fixes_rejected, row.restarts) == (0, 0)
        assert row.largest_position_error_m == pytest.approx(distance.max(), rel=1e-12)
        assert row.rms_position_error_m == pytest.approx(np.sqrt((distance**2).mean()), rel=1e-12)
        assert row.rms_heading_error_rad < 0.2
        assert row.final_position_m == tuple(track.position_w[-1, 0])
        # The first fix, of time 0, arrives before 0.18 s; the next ones in time.
        assert row.stale_share == pytest.approx(0.18 / 9.0, abs=1e-9)


def test_an_outage_is_stale_and_a_jump_is_rejected():
    log = recorded(
        14.0, Fault(kind="outage", start=6.01, end=8.01), Fault(kind="jump", start=11.01, end=12.01, size=15.0)
    )
    rows = {row.estimator: row for row in estimate.run("log", log).rows}
    # The fix of 6.0 s is the last one; that of 8.2 s arrives in the sample of 8.352 s. Stamps are 30 ms late.
    stale = 0.18 + 8.352 - (6.03 + 0.5)
    assert rows["gps"].stale_share == pytest.approx(stale / 14.0, abs=0.003)
    assert rows["gps"].fixes_rejected == 0
    for name in ("decoupled", "coupled"):
        assert rows[name].fixes_rejected == 5
        # Which makes the last believed fix older than half a second, too.
        assert rows[name].stale_share > rows["gps"].stale_share + 0.5 / 14.0


def test_errors_are_known_where_estimate_and_truth_are(log):
    truth = log.position_w.copy()
    truth[100:120] = np.nan
    partly = dataclasses.replace(log, position_w=truth, heading=None)
    one = estimate.run("log", partly, ["gps", "gps"])
    assert list(one.tracks) == ["gps"]
    wrong = estimate.errors(partly, one.tracks["gps"])
    assert np.isnan(wrong.heading).all()
    known = one.tracks["gps"].known[:, 0].copy()
    known[100:120] = False
    np.testing.assert_array_equal(np.isfinite(wrong.position_w).all(axis=-1), known)
    assert one.rows[0].rms_position_error_m is not None
    assert one.rows[0].rms_heading_error_rad is None
    assert "heading RMS" in estimate.markdown(one)
    bare = estimate.run("log", dataclasses.replace(partly, position_w=None), ["gps"])
    assert bare.rows[0].largest_position_error_m is None
    assert "error" not in estimate.markdown(bare)


def test_a_track_is_written_to_the_last_bit(found):
    track = found.tracks["coupled"]
    lines = [line.split(",") for line in estimate.track_csv(track).splitlines()]
    assert lines[0] == list(estimate.TRACK_COLUMNS)
    values = np.array([[float(cell or "nan") for cell in line] for line in lines[1:]])
    known = track.known[:, 0]
    np.testing.assert_array_equal(values[:, 0], track.time)
    assert np.isnan(values[~known, 1:]).all()
    np.testing.assert_array_equal(values[known, 1:3], track.position_w[known, 0])
    np.testing.assert_array_equal(values[known, 6] ** 2, np.sqrt(track.position_covariance[known, 0, 0, 0]) ** 2)
    assert (np.abs(values[known, 5]) <= np.pi).all()


@pytest.mark.parametrize("judged", [True, False])
def test_each_estimator_is_drawn_in_a_column(found, log, judged):
    if not judged:
        found = dataclasses.replace(found, log=dataclasses.replace(log, position_w=None, heading=None))
    figure = log_figure.replay(found)
    axes = np.array(figure.axes).reshape(4, 3)
    assert [axis.get_title() for axis in axes[0]] == ["GPS", "decoupled EKF", "coupled EKF"]
    assert [axis.get_ylabel() for axis in axes[:, 0]] == (
        ["y [m]", "x error [m]", "y error [m]", "heading error [deg]"]
        if judged
        else ["y [m]", "position sigma [m]", "heading sigma [deg]", "fix age [s]"]
    )
    for row in axes:
        assert len({axis.get_ylim() for axis in row}) == 1


@pytest.mark.parametrize("extension", ["csv", "nc"])
def test_the_command_writes_the_same_from_both_formats(found, log, tmp_path, capsys, extension):
    path = tmp_path / f"log.{extension}"
    logs.write(path, log)
    assert cli.main(["estimate", str(path), "--out", str(tmp_path / "out"), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document == {**json.loads(json.dumps(estimate.document(found))), "log": path.name}
    assert json.loads((tmp_path / "out" / "estimate.json").read_text()) == document
    for name, track in found.tracks.items():
        assert (tmp_path / "out" / f"track_{name}.csv").read_text() == estimate.track_csv(track)
    assert (tmp_path / "out" / "estimate.png").stat().st_size > 10_000


def test_the_command_runs_the_estimators_that_are_asked_for(log, tmp_path, capsys):
    path, folder = tmp_path / "log.csv", tmp_path / "out"
    logs.write(path, log)
    chosen = ["--estimators", "coupled", "--filters", "filterpy", "--out", str(folder)]
    assert cli.main(["estimate", str(path), *chosen]) == 0
    printed = capsys.readouterr().out
    assert "| coupled " in printed
    assert "| gps " not in printed
    visible = {file.name for file in folder.iterdir() if not file.name.startswith(".")}
    assert visible == {"estimate.json", "estimate.md", "estimate.png", "track_coupled.csv"}
    assert json.loads((folder / "estimate.json").read_text())["filters"] == "filterpy"


def test_the_filters_assume_what_the_configuration_says(found, log, tmp_path, capsys):
    path, config = tmp_path / "log.csv", tmp_path / "robot.toml"
    logs.write(path, log)
    options = ["estimate", str(path), "--config", str(config), "--out", str(tmp_path / "out"), "--json"]
    config.write_text("runs = 3\n[filter]\nposition_noise = 5.0\n")
    assert cli.main(options) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["parameters"] == dataclasses.asdict(DEFAULT) | {"position_noise": 5.0}
    coupled = document["rows"][-1]
    assert coupled["final_position_m"] != pytest.approx(found.rows[-1].final_position_m, abs=0.01)
    config.write_text("[filter]\nposition_noise = -5.0\n")
    assert cli.main(options) == 2
    told = "dynabot: filter.position_noise = -5 given, it must be positive and at most 1e+06\n"
    assert capsys.readouterr().err == told


def test_a_malformed_log_is_one_line_and_exit_code_2(log, tmp_path, capsys):
    path = tmp_path / "log.csv"
    logs.write(path, log)
    lines = path.read_text().splitlines()
    lines[7] = "soon" + lines[7][lines[7].index(",") :]
    path.write_text("\n".join(lines))
    assert cli.main(["estimate", str(path), "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert printed.err == f"dynabot: {path}, line 8, column time_s: 'soon' is not a number\n"
    assert printed.out == ""
    assert not (tmp_path / "out").exists()
