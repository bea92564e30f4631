"""The formation task as a `dm_env` environment: rigid robots, one action for all of them per control period.

An episode is a trial of a study: the same starts, errors and radio draws, the same physics and local laws, so that a
controller sees here what `dynabot compare` will judge it by. Episode k of an environment is trial k of its seed.

Action, by name, held for the control period T_c of the estimator:

    force   total planar force on each robot, (n, 2) [N], limited in norm as the estimator's row limits it; the local
            laws turn it into motor commands, at periods of at most 39 ms
    wheels  speed of each wheel, (n, 4) [rad/s], front left, front right, rear left, rear right, without feed-forward

Observation, by name:

    truth   position, velocity, heading and yaw rate of all robots as they are
    heard   what the robots know: each one's belief of itself, with the errors of its estimator, and what it has heard
            of the others over the radio, delayed and with losses

Reward, on [0, 1]: 1 / (1 + e) with e the mean distance [m] of the robots from the floor of the leader's well plus the
mean distance of the formation's sides from the floor of the robots' wells, sides being between robots that follow each
other around the leader; 0 after a control period in which a hull touched anything. So 1 is a formation, anywhere on
the flat floors. Episodes end with the duration, with discount 1; nothing ends them before.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Literal, get_args

import numpy as np
from dm_env import specs

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import potential_field
from dynabot_mj.controllers.law import Information
from dynabot_mj.controllers.potential_field import Well
from dynabot_mj.controllers.vehicle import GRAVITY
from dynabot_mj.environment.physics import FleetPhysics
from dynabot_mj.estimation.measurements import wrap
from dynabot_mj.formation.leader import LEADER_W
from dynabot_mj.formation.starts import starts
from dynabot_mj.host import opengl
from dynabot_mj.plants import scene
from dynabot_mj.study import assembly, configuration, fleet, scenario
from dynabot_mj.study.scenario import Case, Scenario
from dynabot_mj.testbed.radio import Radio
from dynabot_mj.trial.team import Team

with opengl.for_dm_control():
    from dm_control.mujoco import wrapper
    from dm_control.rl import control

Action = Literal["force", "wheels"]
Observation = Literal["truth", "heard"]


def load(
    robots: int = 3,
    action: Action = "force",
    observation: Observation = "truth",
    estimator: str = "decoupled",
    duration: float = 80.0,
    seed: int = 0,
) -> "FormationEnvironment":
    """Returns the formation task.

    Args:
        robots: n, 2 to 7.
        action: What the robots are commanded by.
        observation: What is seen of them.
        estimator: Whose periods and limit of the force, and with `heard` whose errors, the robots have.
        duration: Of an episode [s]; the last control period that begins within it is completed.
        seed: Of all random numbers.

    Raises:
        InputError: If a value is not allowed.

    Example:
        >>> environment = dy.load_environment(robots=3, duration=0.1)
        >>> step = environment.reset()
        >>> while not step.last():
        ...     step = environment.step(np.zeros(environment.action_spec().shape))
        >>> step.observation["position"].shape
        (3, 2)
    """
    for name, value, allowed in (("action", action, Action), ("observation", observation, Observation)):
        if value not in get_args(allowed):
            raise InputError(f"{name} = {value!r} given, it must be one of: {', '.join(get_args(allowed))}")
    setup = configuration.build(
        {}, robots=robots, plants=["rigid"], estimators=[estimator], duration=float(duration), seed=seed
    )
    case = scenario.cases(setup)[0]
    period = scenario.periods(setup, estimator)[1] * setup.processor.tick
    physics = FleetPhysics.from_model(wrapper.MjModel(scene.compose(robots).compile()))
    physics.equip(setup, period)
    count = math.ceil(scenario.duration(setup) / period - 1e-9)
    return FormationEnvironment(
        physics,
        FormationTask(setup, case, action, observation),
        # The time limit is compared with a count of steps; half a step keeps rounding from adding one.
        time_limit=(count - 0.5) * period,
        n_sub_steps=physics.steps * round(period / physics.period),
    )


def information(observation: Mapping[str, Array]) -> Information:
    """Returns what a law is given, from an observation of either kind; of `truth`, all is heard at once.

    Args:
        observation: Of this environment.
    """
    position_w = observation["position"]
    others = ~np.eye(len(position_w), dtype=bool)
    known: BoolArray = np.asarray(observation.get("heard_known", others), dtype=bool)
    return Information(
        time=float(observation["time"]),
        position_w=position_w,
        velocity_w=observation["velocity"],
        leader_w=observation["leader"],
        heard_position_w=observation.get("heard_position", np.where(others[..., None], position_w, 0.0)),
        heard_known=known,
        heard_age=np.where(known, observation.get("heard_age", 0.0), np.inf),
    )


class FormationTask(control.Task):
    """What the robots know, what they are told, and how good that was."""

    def __init__(self, setup: Scenario, case: Case, action: Action, observation: Observation) -> None:
        """Prepares trial 0 of a case for the first episode.

        Args:
            setup: The study's configuration.
            case: Which robots and which estimator.
            action: What the robots are commanded by.
            observation: What is seen of them.
        """
        self._setup, self._case, self._action, self._observation = setup, case, action, observation
        self._field = assembly.field(setup, case.estimator)
        self._vehicle = scene.read_robot(fleet.conditions(setup)).vehicle
        limit = self._field.force_limit
        # Where the row has no limit, what tyres can transmit.
        transmitted = self._vehicle.friction * self._vehicle.mass * GRAVITY
        self._force_limit = limit if math.isfinite(limit) else transmitted
        self._trial = -1

    @property
    def trial(self) -> int:
        """Number of the episode, as the study numbers its trials."""
        return self._trial

    def initialize_episode(self, physics: FleetPhysics) -> None:
        """Starts the next trial."""
        self._trial += 1
        trials, setup = [self._trial], self._setup
        physics.place(*starts(setup.start, setup.robots, setup.seed, trials))
        period = scenario.periods(setup, self._case.estimator)[0] * setup.processor.tick
        perception = assembly.perception(setup, self._case, period, trials, physics.state)
        radio = Radio(assembly.link(setup, self._case.estimator), setup.robots, setup.seed, trials)
        self._team = Team(perception, radio, LEADER_W, physics.state)
        self._everybody = np.ones((1, setup.robots), dtype=bool)

    def before_step(self, action: Array, physics: FleetPhysics) -> None:
        """Commands the robots.

        Raises:
            InputError: If the action is not one: it would stop a robot for the rest of the episode, without a word.
        """
        commands = np.asarray(action, dtype=float)
        shape = (self._setup.robots, 2 if self._action == "force" else len(scene.WHEELS))
        if commands.shape != shape:
            raise InputError(f"an action of shape {commands.shape} given, `action_spec` has {shape}, a row per robot")
        if not np.isfinite(commands).all():
            robots = ", ".join(str(1 + i) for i in np.nonzero(~np.isfinite(commands).all(axis=1))[0])
            raise InputError(f"an action that is not finite given to robot {robots} at {physics.state.time:g} s")
        if self._action == "force":
            physics.command_force(potential_field.saturate(commands[None], self._force_limit))
        else:
            physics.command_wheels(commands[None])

    def get_observation(self, physics: FleetPhysics) -> dict[str, Array]:
        """Returns what is seen of the robots; with `heard`, they sample and broadcast now."""
        state = physics.state
        common = {"time": np.array(state.time), "leader": LEADER_W.copy()}
        motion = {"heading": wrap(state.heading[0]), "yaw_rate": state.yaw_rate[0]}
        if self._observation == "truth":
            return {**common, "position": state.position_w[0], "velocity": state.velocity_w[0], **motion}
        self._team.sample(state, state.time, self._everybody)
        known = self._team.listen(state.time)
        heard = known.heard_known[0]
        return {
            **common,
            "position": known.position_w[0].copy(),
            "velocity": known.velocity_w[0].copy(),
            **motion,
            "heard_position": np.where(heard[..., None], known.heard_position_w[0], 0.0),
            "heard_age": np.where(heard, known.heard_age[0], 0.0),
            "heard_known": heard.copy(),
        }

    def get_reward(self, physics: FleetPhysics) -> float:
        """Returns how good the formation is now; see above."""
        if physics.touched:
            return 0.0
        # In plain numbers: of so few robots, arrays take several times as long.
        places = (physics.state.position_w[0] - LEADER_W).tolist()
        around = sorted(places, key=lambda place: math.atan2(place[1], place[0]))
        sides = [math.dist(*ends) for ends in itertools.pairwise([*around, around[0]])]
        distances = [math.hypot(*place) for place in places]
        return 1.0 / (1.0 + _off_floor(distances, self._field.leader) + _off_floor(sides, self._field.neighbour))

    def action_spec(self, physics: FleetPhysics) -> specs.BoundedArray:
        """Returns what actions look like."""
        robots = self._setup.robots
        if self._action == "force":
            limit = self._force_limit
            return specs.BoundedArray((robots, 2), np.float64, -limit, limit, name="force")
        fastest = self._vehicle.voltage / self._vehicle.torque_constant  # of a wheel without load
        return specs.BoundedArray((robots, len(scene.WHEELS)), np.float64, -fastest, fastest, name="wheel_speed")

    def observation_spec(self, physics: FleetPhysics) -> dict[str, specs.Array]:
        """Returns what observations look like."""
        n = self._setup.robots
        seen = [
            specs.BoundedArray((), np.float64, 0.0, np.inf, name="time"),  # [s]
            specs.Array((2,), np.float64, name="leader"),  # [m]
            specs.Array((n, 2), np.float64, name="position"),  # [m]
            specs.Array((n, 2), np.float64, name="velocity"),  # [m/s]
            specs.BoundedArray((n,), np.float64, -np.pi, np.pi, name="heading"),  # from the world's x axis [rad]
            specs.Array((n,), np.float64, name="yaw_rate"),  # [rad/s]
        ]
        if self._observation == "heard":
            seen += [
                # Of receiver i from sender j at [i, j]; zeros where nothing has arrived yet, and of oneself.
                specs.Array((n, n, 2), np.float64, name="heard_position"),  # [m]
                specs.BoundedArray((n, n), np.float64, 0.0, np.inf, name="heard_age"),  # since it was sampled [s]
                specs.BoundedArray((n, n), bool, False, True, name="heard_known"),
            ]
        return {spec.name: spec for spec in seen}


class FormationEnvironment(control.Environment):
    """The formation task."""

    def reward_spec(self) -> specs.BoundedArray:
        """Returns what rewards look like."""
        return specs.BoundedArray((), float, 0.0, 1.0, name="reward")


def _off_floor(distances: Sequence[float], well: Well) -> float:
    """Returns the mean distance from a well's floor [m]."""
    inner, outer = well.radius, well.radius + well.width
    return sum(max(inner - distance, distance - outer, 0.0) for distance in distances) / len(distances)
