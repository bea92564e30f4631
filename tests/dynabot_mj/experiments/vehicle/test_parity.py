import numpy as np

from dynabot_mj.experiments.vehicle import parity
from dynabot_mj.plants import scene


def test_planar_model_and_mujoco_agree_on_the_acceptance_course():
    found = parity.parity()
    assert (found.error < 0.10).all()
    assert np.ptp(found.mujoco, axis=0)[0] > 10.0  # it does drive


def test_parity_holds_for_another_vehicle():
    found = parity.parity(scene.Conditions(payload=3.0, friction=0.5))
    assert (found.error < 0.10).all()
