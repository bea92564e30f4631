import numpy as np
import pytest

from dynabot_mj.study import configuration
from dynabot_mj.study.assembly import simulate
from dynabot_mj.trial import judge

from .conftest import case, run


def test_point_masses_have_neither_hulls_nor_wheels():
    outcome = run("particle", "perfect", range(2), duration=2.0)
    assert np.isnan(outcome.hull_contact).all()
    assert np.isnan(outcome.wheel_slip).all()


def test_trajectory_covers_the_run_from_start_to_end():
    outcome = run("particle", "coupled", range(2), recorded=1, duration=10.0)
    assert outcome.time[0] == 0.0
    assert outcome.time[-1] == pytest.approx(10.0)
    assert np.isfinite(outcome.trajectory_w).all()
    np.testing.assert_allclose(outcome.trajectory_w[0, -1], outcome.final_position_w[0], atol=1e-9)


@pytest.mark.slow
def test_long_runs_keep_their_last_sample():
    outcome = run("particle", "coupled", [0], recorded=1, duration=1600.0)
    assert outcome.time[-1] == pytest.approx(1600.0)
    assert np.isfinite(outcome.trajectory_w).all()


def test_mean_message_age_is_sampling_period_and_latency():
    # A message arrives 33 + k_m radio ticks after it was sampled, 23.9 ms on average. With T = 27 ms it is used at the
    # next event unless k_m > 8, so its age is 27 ms and a little; one lost message in 375 adds a period.
    for estimator, age in (("gps", 28e-3), ("decoupled", 36.5e-3), ("coupled", 156.5e-3)):
        measured = run("particle", estimator, range(20), duration=20.0).message_age.mean()
        assert measured == pytest.approx(age, abs=1e-3)
    np.testing.assert_array_equal(run("particle", "perfect", range(2), duration=2.0).message_age, 0.0)


def test_clocks_of_their_own_shorten_the_age_of_the_slow_estimators_messages():
    # With phases of 0, 52 and 104 of 156 ms, a robot acts 52 ms after one of the others sampled and 104 ms after the
    # other, and practically no latency exceeds 52 ms: 78 ms on average, against 156 ms on a common clock. A lost
    # message adds a period: 0.267 % of 156 ms.
    phase, setup = np.array([0, 52, 104]), configuration.build({}, duration=20.0)
    outcome = simulate(setup, case("particle", "coupled"), range(20), phase=phase)
    assert outcome.message_age.mean() == pytest.approx(0.0784, abs=1e-3)
    alone = simulate(setup, case("particle", "coupled"), [7], phase=phase)
    np.testing.assert_array_equal(alone.final_position_w[0], outcome.final_position_w[7])


@pytest.mark.parametrize("plant", ["particle", "rigid"])
def test_settling_sees_every_control_event_and_the_end(plant, monkeypatch):
    seen = []

    class Spy(judge.Scorer):
        def control(self, state):
            super().control(state)
            seen.append(state.time)

    monkeypatch.setattr(judge, "Scorer", Spy)
    setup = configuration.load("[method.gps]\nsample_period = 0.027\ncontrol_period = 0.054", "test", duration=1.0)
    simulate(setup, case(plant, "gps"), [0])
    np.testing.assert_allclose(seen, [*np.arange(0.0, 1.0, 0.054), 1.0], atol=1e-9)
