import numpy as np
import pytest

from dynabot_mj.plants.replay import Engine
from dynabot_mj.study import assembly, configuration, scenario
from dynabot_mj.trial import loop


def recorded(estimator, duration, trials=3, threads=1, **options):
    setup = configuration.build({}, plants=["rigid"], estimators=[estimator], duration=duration, **options)
    case = scenario.cases(setup)[0]
    parts = assembly.parts(setup, case, range(trials), threads=threads)
    recording = parts.plant.record()
    loop.simulate(parts)
    return recording, parts


# 36 ms is one period of the local laws, 156 ms are four.
@pytest.mark.parametrize(("estimator", "periods"), [("decoupled", 1), ("coupled", 4)])
@pytest.mark.parametrize("threads", [1, 2])
def test_the_engine_repeats_the_run_bit_for_bit(estimator, periods, threads):
    recording, parts = recorded(estimator, 10 * periods * 0.039)
    assert len(recording.commands) == pytest.approx(10 * periods, abs=2 * periods)
    engine = Engine(recording, threads)
    engine.run()
    np.testing.assert_array_equal(engine.qpos.reshape(parts.plant.state.pose.shape), parts.plant.state.pose)


def test_the_engine_repeats_real_filters_in_the_loop_and_a_friction():
    recording, parts = recorded("decoupled", 0.72, perception=["filter"], friction=0.4)
    engine = Engine(recording)
    engine.run()
    np.testing.assert_array_equal(engine.qpos.reshape(parts.plant.state.pose.shape), parts.plant.state.pose)


def test_a_recording_is_repeated_in_parts_too():
    recording, _ = recorded("decoupled", 0.72)
    whole, parts = Engine(recording), Engine(recording)
    whole.run()
    for _ in range(4):
        parts.run(3)
    assert not np.array_equal(parts.qpos, whole.qpos)
    parts.run()
    np.testing.assert_array_equal(parts.qpos, whole.qpos)


def test_recording_changes_nothing():
    recording, parts = recorded("decoupled", 0.72)
    setup = configuration.build({}, plants=["rigid"], estimators=["decoupled"], duration=0.72)
    unwatched = assembly.simulate(setup, scenario.cases(setup)[0], range(3))
    np.testing.assert_array_equal(unwatched.final_position_w, parts.plant.state.position_w)
    assert all(command.ctrl.shape == (3, 3 * 4 * 2) for command in recording.commands)
