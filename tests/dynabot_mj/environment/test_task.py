import re
from pathlib import Path

import dm_env
import numpy as np
import pytest
from absl.testing import absltest
from dm_env import test_utils

from dynabot_mj import environment
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import potential_field
from dynabot_mj.study import assembly, configuration, scenario
from dynabot_mj.testbed.paper import SPACING, WELL_RADIUS


class TestForceAndTruth(test_utils.EnvironmentTestMixin, absltest.TestCase):
    def make_object_under_test(self):
        return environment.load(duration=0.3, estimator="perfect")

    def make_action_sequence(self):
        for _ in range(40):
            yield self.make_action()


class TestWheelsAndHeard(TestForceAndTruth):
    def make_object_under_test(self):
        return environment.load(2, "wheels", "heard", "gps", duration=0.3)


def play(env, law, episodes=1):
    """Returns the time steps of whole episodes."""
    steps = []
    for _ in range(episodes):
        steps.append(env.reset())
        while not steps[-1].last():
            steps.append(env.step(law(steps[-1].observation)))
    return steps


def field_law(setup, estimator):
    field = assembly.field(setup, estimator)

    def law(seen):
        return potential_field.total_force(
            seen["position"],
            seen["velocity"],
            seen["leader"],
            seen["heard_position"],
            seen["heard_known"],
            field,
        )

    return law


@pytest.mark.parametrize(("estimator", "duration"), [("perfect", 2.0), ("decoupled", 1.8), ("coupled", 1.56)])
def test_an_episode_is_a_trial_of_the_study(estimator, duration):
    """Same starts, errors, messages, local laws and physics, told by the study's own law."""
    setup = configuration.build(
        {}, robots=3, duration=duration, seed=5, plants=["rigid"], estimators=[estimator], trials=2
    )
    outcome = assembly.simulate(setup, scenario.cases(setup)[0], [0, 1])
    env = environment.load(3, "force", "heard", estimator, duration, seed=5)
    for trial in range(2):
        last = play(env, field_law(setup, estimator))[-1]
        assert env.task.trial == trial
        assert last.observation["time"] == pytest.approx(duration)
        np.testing.assert_allclose(env.physics.state.position_w[0], outcome.final_position_w[trial], atol=1e-9)
        np.testing.assert_allclose(env.physics.state.heading[0], outcome.final_heading[trial], atol=1e-9)


def test_equal_seeds_are_equal_trajectories_and_others_are_not():
    def trajectory(seed):
        env = environment.load(2, observation="heard", duration=0.4, seed=seed)
        return [step.observation for step in play(env, lambda seen: 20.0 - seen["position"], episodes=2)]

    one, same, other = trajectory(1), trajectory(1), trajectory(2)
    for a, b in zip(one, same, strict=True):
        assert all(np.array_equal(a[name], b[name]) for name in a)
    assert not np.array_equal(one[0]["position"], other[0]["position"])
    assert not np.array_equal(one[0]["position"], one[len(one) // 2]["position"])  # the next trial


def test_time_limit_is_no_failure():
    env = environment.load(duration=0.36, estimator="decoupled")
    steps = play(env, lambda seen: np.zeros((3, 2)))
    assert len(steps) == 1 + 10
    assert steps[-1].discount == 1.0
    assert env.control_timestep() == pytest.approx(0.036)
    assert env.step(np.zeros((3, 2))).step_type is dm_env.StepType.FIRST


def test_local_laws_divide_the_longest_control_period():
    env = environment.load(duration=0.2, estimator="coupled")
    assert env.control_timestep() == pytest.approx(0.156)
    assert env.physics.period == pytest.approx(0.039)


def test_forces_are_limited_in_norm():
    """The bounds hold per axis; a force along the diagonal is no larger than one along an axis."""

    def end(force):
        env = environment.load(2, duration=0.4)
        play(env, lambda seen: np.full((2, 2), force))
        return env.physics.state.position_w

    spec = environment.load(2).action_spec()
    assert (spec.minimum.min(), spec.maximum.max()) == (-50.0, 50.0)
    np.testing.assert_array_equal(end(50.0), end(50.0 / np.sqrt(2.0)))
    assert not np.array_equal(end(50.0), end(30.0))


def test_wheels_turn_as_told():
    env = environment.load(2, "wheels", duration=1.5)
    assert env.action_spec().maximum.max() == pytest.approx(104.0, rel=0.01)
    speeds = np.array([[10.0] * 4, [-5.0, 5.0, -5.0, 5.0]])
    start = env.reset().observation
    last = play(env, lambda seen: speeds)[-1].observation
    forward = np.stack([np.cos(last["heading"]), np.sin(last["heading"])], axis=-1)
    speed = (last["velocity"] * forward).sum(axis=-1)
    assert speed[0] == pytest.approx(1.0, rel=0.1)
    assert speed[1] == pytest.approx(0.0, abs=0.05)
    assert last["yaw_rate"][0] == pytest.approx(0.0, abs=0.05)
    assert last["yaw_rate"][1] > 0.3
    assert set(start) == set(env.observation_spec())


def test_what_is_heard_is_late_and_wrong_and_never_oneself():
    env = environment.load(3, observation="heard", estimator="decoupled", duration=2.0)
    first, *_, last = (step.observation for step in play(env, lambda seen: np.zeros((3, 2))))
    assert not first["heard_known"].any()
    assert not first["heard_age"].any()
    np.testing.assert_array_equal(last["heard_known"], ~np.eye(3, dtype=bool))
    others = ~np.eye(3, dtype=bool)
    assert (last["heard_age"][others] > 0.02).all()
    true = env.physics.state.position_w[0]
    error = last["heard_position"][others] - np.broadcast_to(true, (3, 3, 2))[others]
    assert 0.01 < np.abs(error).max() < 6.0
    assert 0.01 < np.abs(last["position"] - true).max() < 6.0


def test_information_from_what_is_heard():
    env = environment.load(3, observation="heard", duration=0.5)
    first, *_, last = (step.observation for step in play(env, lambda seen: np.zeros((3, 2))))
    assert np.isinf(environment.information(first).heard_age).all()
    known = environment.information(last)
    others = ~np.eye(3, dtype=bool)
    assert known.time == pytest.approx(0.504)
    np.testing.assert_array_equal(known.position_w, last["position"])
    np.testing.assert_array_equal(known.heard_age[others], last["heard_age"][others])
    np.testing.assert_array_equal(known.heard_known, others)


def test_information_from_the_truth():
    known = environment.information(environment.load(3).reset().observation)
    np.testing.assert_array_equal(known.heard_position_w[0, 1:], known.position_w[1:])
    np.testing.assert_array_equal(known.heard_known, ~np.eye(3, dtype=bool))
    assert not known.heard_age[0, 1:].any()


def test_the_example_of_the_document_forms(tmp_path, monkeypatch, capsys):
    text = (Path(__file__).parents[3] / "docs" / "environment.md").read_text(encoding="utf-8")
    law, driver = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    (tmp_path / "my_module.py").write_text(law)
    monkeypatch.syspath_prepend(tmp_path)
    exec(driver, {})
    found = re.fullmatch(r"reward ([0-9.]+) at [0-9.]+ s\n", capsys.readouterr().out)
    assert float(found[1]) > 0.7


@pytest.fixture
def placed():
    """An environment whose robots are put somewhere."""
    env = environment.load(3, duration=1.0)

    def put(position_w):
        env.reset()
        with env.physics.reset_context():
            env.physics.place(np.array([position_w], dtype=float), np.zeros((1, 3)))
        return env

    return put


def polygon(radius):
    angle = np.pi * np.array([0.5, 0.5 + 2.0 / 3.0, 0.5 + 4.0 / 3.0])
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def reward(env):
    return env.step(np.zeros((3, 2))).reward


def test_a_formation_is_worth_one_and_less_the_further_off(placed):
    assert reward(placed(polygon(WELL_RADIUS + 0.2))) == 1.0
    # 3.0 m too far from the floor's outer edge; the sides are longer than theirs by this.
    sides = np.sqrt(3.0) * 7.0 - (SPACING + 1.0)
    assert reward(placed(polygon(7.0))) == pytest.approx(1.0 / (1.0 + 3.0 + sides), rel=1e-3)


def test_a_collision_is_worth_nothing_while_it_lasts(placed):
    env = placed([[3.5, 0.0], [3.5, 0.3], [-3.5, 0.0]])
    assert reward(env) == 0.0
    for _ in range(8):
        env.step(np.zeros((3, 2)))
    env.physics.place(polygon(3.2)[None], np.zeros((1, 3)))
    assert reward(env) > 0.9


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"action": "torque"}, "action = 'torque' given, it must be one of: force, wheels"),
        ({"observation": "pixels"}, "observation = 'pixels' given, it must be one of: truth, heard"),
        ({"robots": 9}, "robots = 9"),
        ({"estimator": "best"}, "estimators = 'best'"),
        ({"seed": -1}, "seed = -1"),
    ],
)
def test_nonsense_is_refused(options, message):
    with pytest.raises(InputError, match=message):
        environment.load(**options)


@pytest.mark.parametrize("action", ["force", "wheels"])
def test_an_action_that_is_none_is_refused(action):
    env = environment.load(2, action, duration=1.0)
    env.reset()
    good = np.zeros(env.action_spec().shape)
    bad = good.copy()
    bad[1, 0] = np.nan
    with pytest.raises(InputError, match="an action that is not finite given to robot 2 at 0 s"):
        env.step(bad)
    with pytest.raises(InputError, match=r"an action of shape \(2,\) given, `action_spec` has"):
        env.step(good[:, 0])
