import numpy as np
import pytest

from dynabot_mj import study
from dynabot_mj.study import configuration
from dynabot_mj.viewing import recording


def setup_of(plant, perception="gauss-markov", **others):
    return configuration.build(
        {
            "plants": [plant],
            "estimators": ["decoupled"],
            "perception": [perception],
            "trials": 1,
            "first_trial": 3,
            "duration": 3.0,
            **others,
        }
    )


@pytest.mark.parametrize("plant", ["particle", "rigid"])
@pytest.mark.parametrize("perception", ["gauss-markov", "filter"])
def test_it_is_the_trial_of_the_study(plant, perception):
    setup = setup_of(plant, perception)
    kept, saved = recording.record(setup, 0.1), study.run(setup).isel(case=0, trial=0)
    np.testing.assert_array_equal(kept.position_w, saved.trajectory_w.values[0])
    assert kept.closest.min() == saved.closest.item()
    if plant == "rigid":
        assert 0.0 < kept.slip.max() <= saved.wheel_slip.item()
        np.testing.assert_allclose(kept.pose[:, :, :2], kept.position_w, atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(kept.pose[:, :, 3:7], axis=-1), 1.0, atol=1e-12)
    else:
        assert kept.pose is None
        assert np.isnan(kept.slip).all()


def test_robots_know_their_sigma_and_hear_late():
    setup = setup_of("particle", duration=20.0)
    kept = recording.record(setup, 0.1)
    # sigma is radial: half of its square on each axis.
    np.testing.assert_allclose(kept.covariance, np.broadcast_to(1.1**2 / 2.0 * np.eye(2), kept.covariance.shape))
    error = kept.believed_w - kept.position_w
    # 1,206 errors, nearly independent at 0.1 s with a correlation time of 0.08 s: five standard errors are 15 %.
    assert error.std() == pytest.approx(1.1 / np.sqrt(2.0), rel=0.15)
    pairs = ~np.eye(3, dtype=bool)
    assert np.isnan(kept.heard_age[:, ~pairs]).all()
    ages = kept.heard_age[10:, pairs]
    assert ages.min() > 0.0
    assert ages.max() < 1.0


def test_messages_arrive_after_they_were_sent_or_are_lost():
    messages = recording.record(setup_of("particle", duration=20.0), 0.1).messages
    receivers = np.arange(3) != messages.sender[:, None]
    assert len(messages.sender) == 3 * len(np.unique(messages.sent_at))
    np.testing.assert_array_equal(np.isfinite(messages.arrives_at), receivers & ~messages.lost)
    assert messages.lost.any()
    assert not messages.lost[~receivers].any()
    arrived = np.isfinite(messages.arrives_at)
    assert (messages.arrives_at - messages.sent_at[:, None])[arrived].min() > 0.0


def test_robots_that_overlap_are_told():
    # Robots that start 0.45 m apart have not collided (0.40 m between centres), but their footprints overlap.
    kept = recording.record(setup_of("particle", start={"spacing": 0.45}), 0.1)
    assert kept.overlapping[0].all()
    assert kept.closest[0] == pytest.approx(0.45)
    assert not recording.record(setup_of("particle"), 0.1).overlapping.any()
