import json
from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.estimation import kalman, motion
from dynabot_mj.estimation.decoupled_ekf import GROUPS
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.experiments.estimators import grouping
from dynabot_mj.sensing.options import matched


@pytest.fixture(scope="module")
def found():
    return grouping.run(0, runs=2)


def test_gains_give_the_sub_states_of_the_decoupled_filter(found):
    assert found.agrees
    assert sorted(map(sorted, found.groups)) == sorted(map(sorted, GROUPS))
    assert sorted(map(len, found.groups)) == [2, 2, 2, 4]


def test_grouping_follows_the_gains(found):
    """With another largest share the groups are others: they are derived."""
    tampered = found.share.copy()
    tampered[motion.NAMES.index("X"), grouping.MEASUREMENTS.index("velocity")] *= 2.0
    other = replace(found, share=tampered)
    assert not other.agrees
    assert "not those of the decoupled EKF" in grouping.markdown(other)


def test_a_receiver_with_useless_velocities_groups_otherwise():
    useless = replace(DEFAULT, velocity_noise=20.0)
    assert not grouping.run(0, 1, matched(useless), useless).agrees


def test_close_choices_are_reported(found):
    margins = dict(zip(motion.NAMES, found.margin, strict=True))
    assert min(margins, key=margins.get) in ("X", "Y")
    assert 1.1 < margins["X"] < 1.6
    assert sorted(margins.values())[2] > 10.0


def test_shares_of_the_components_add_up_to_what_the_update_removes():
    rng = np.random.default_rng(0)
    root = rng.standard_normal((3, 10, 10))
    covariance, observation = root @ np.swapaxes(root, 1, 2), rng.standard_normal((3, 4, 10))
    update = kalman.update(np.zeros((3, 10)), covariance, np.zeros((3, 4)), observation, np.eye(4), np.inf)
    before, after = (np.diagonal(some, axis1=1, axis2=2) for some in (covariance, update.covariance))
    found = grouping.shares(covariance, observation, update.innovation_covariance)
    np.testing.assert_allclose(found.sum(axis=-1), ((before - after) / before).mean(axis=0))


def test_share_of_a_single_measurement_is_the_normalised_gain_squared():
    rng = np.random.default_rng(1)
    root = rng.standard_normal((1, 10, 10))
    covariance, observation = root @ np.swapaxes(root, 1, 2), rng.standard_normal((1, 1, 10))
    spread = observation @ covariance @ np.swapaxes(observation, 1, 2) + 0.3
    gain = (covariance @ np.swapaxes(observation, 1, 2) / spread)[0, :, 0]
    normalised = gain * np.sqrt(spread[0, 0, 0]) / np.sqrt(np.diagonal(covariance[0]))
    np.testing.assert_allclose(grouping.shares(covariance, observation, spread)[:, 0], normalised**2)


def test_document_and_table(found):
    document = json.loads(json.dumps(grouping.document(found), allow_nan=False))
    assert document["agrees"] is True
    assert [row["state"] for row in document["rows"]] == list(motion.NAMES)
    assert "the sub-states of the decoupled EKF" in grouping.markdown(found)
