import dataclasses

import numpy as np
import pytest

from dynabot_mj.experiments.estimators import estimate
from dynabot_mj.perception import estimators
from dynabot_mj.sensing.faults import Fault


def test_the_summary_is_that_of_the_tracks(replayed, driven):
    assert [row.estimator for row in replayed.rows] == list(estimators.NAMES) == list(replayed.tracks)
    for row in replayed.rows:
        track = replayed.tracks[row.estimator]
        known = track.known[:, 0]
        distance = np.linalg.norm((track.position_w[:, 0] - driven.position_w)[known], axis=-1)
        assert (row.samples, row.fixes) == (len(driven.time), np.isfinite(driven.fix_time).sum())
        assert (row.fixes_rejected, row.restarts) == (0, 0)
        assert row.largest_position_error_m == pytest.approx(distance.max(), rel=1e-12)
        assert row.rms_position_error_m == pytest.approx(np.sqrt((distance**2).mean()), rel=1e-12)
        assert row.rms_heading_error_rad < 0.2
        assert row.final_position_m == tuple(track.position_w[-1, 0])
        # The first fix, of time 0, arrives before 0.18 s; the next ones in time.
        assert row.stale_share == pytest.approx(0.18 / 9.0, abs=1e-9)


def test_an_outage_is_stale_and_a_jump_is_rejected(recorded):
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


def test_errors_are_known_where_estimate_and_truth_are(driven):
    truth = driven.position_w.copy()
    truth[100:120] = np.nan
    partly = dataclasses.replace(driven, position_w=truth, heading=None)
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


def test_a_track_is_written_to_the_last_bit(replayed):
    track = replayed.tracks["coupled"]
    lines = [line.split(",") for line in estimate.track_csv(track).splitlines()]
    assert lines[0] == list(estimate.TRACK_COLUMNS)
    values = np.array([[float(cell or "nan") for cell in line] for line in lines[1:]])
    known = track.known[:, 0]
    np.testing.assert_array_equal(values[:, 0], track.time)
    assert np.isnan(values[~known, 1:]).all()
    np.testing.assert_array_equal(values[known, 1:3], track.position_w[known, 0])
    np.testing.assert_array_equal(values[known, 6] ** 2, np.sqrt(track.position_covariance[known, 0, 0, 0]) ** 2)
    assert (np.abs(values[known, 5]) <= np.pi).all()
