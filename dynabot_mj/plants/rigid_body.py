"""MuJoCo models of the Dynabot, all trials stepped at once, each robot tracking its force command with its local laws.

The local laws run at a period of their own, the gap divided so that it is at most 39 ms: at the 156 ms of the coupled
EKF they would limit-cycle. The physics step divides that period again. Both divide evenly, so nothing drifts.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np
from mujoco import batch

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.frames import along
from dynabot_mj.controllers import traction
from dynabot_mj.controllers.vehicle import Vehicle
from dynabot_mj.plants import free_joint, scene
from dynabot_mj.plants.local_laws import Drivers, LocalLaws
from dynabot_mj.plants.plant import LONGEST_SUBSTEP, FleetState, NavigationError
from dynabot_mj.plants.replay import Recording

LOCAL_PERIOD = 0.039  # longest period of the local laws [s]
PHYSICS_STEP = 0.005  # longest physics step [s]; the contacts behave alike from 0.5 to 5 ms

# After these a simulation means nothing: MuJoCo resets it, or drops its controls, and reports success all the same.
_BREAKDOWNS = [
    int(warning)
    for warning in (
        mujoco.mjtWarning.mjWARN_BADQPOS,
        mujoco.mjtWarning.mjWARN_BADQVEL,
        mujoco.mjtWarning.mjWARN_BADQACC,
        mujoco.mjtWarning.mjWARN_BADCTRL,
    )
]


class RigidBodyPlant:
    """Four-wheel skid-steer vehicles.

    Example:
        >>> laws = dy.local_laws(dy.build_scenario({}))
        >>> plant = dy.RigidBodyPlant(np.zeros((1, 1, 2)), np.zeros((1, 1)), laws)  # 1 trial, 1 robot
        >>> states = plant.step(np.array([[[12.0, 0.0]]]), 1.0)  # 12 N ahead for 1 s
        >>> plant.state.velocity_w[0, 0].round(1) + 0.0
        array([1.6, 0. ])
    """

    def __init__(
        self,
        position_w: Array,
        heading: Array,
        laws: LocalLaws,
        *,
        conditions: scene.Conditions = scene.NOMINAL,
        friction: Array | None = None,
        threads: int = 1,
    ) -> None:
        """Puts the robots at rest on their settled tyres.

        Args:
            position_w: Start positions, (B, n, 2) [m].
            heading: Start headings, (B, n) [rad].
            laws: Of each robot.
            conditions: Which robots, and on what ground.
            friction: Of tyres and ground in each trial, (B,); None: the same in all, by the conditions.
            threads: Of MuJoCo; they change the speed, never the result.
        """
        trials, robots = heading.shape
        # MuJoCo would print its warnings, from several threads, and append them to a file in the working directory;
        # the batch counts them, and those that matter are reported as divergence.
        mujoco.set_mju_user_warning(lambda message: None)
        robot = scene.read_robot(conditions)
        self._vehicle = robot.vehicle
        model = scene.compose(robots, conditions).compile()
        self._batch = batch.Batch(model, nsim=trials, nthread=threads)
        self._timestep = self._batch.expand("opt.timestep")  # (B,)
        if friction is not None:
            # Kept, since the batch looks at it in every step.
            self._friction = self._batch.expand("pair_friction").reshape(trials, model.npair, -1)
            self._friction[..., :2] = friction[:, None, None]
        # Each robot's coordinates begin with its free joint; the four wheels follow.
        self._qpos = self._batch.bind("qpos").reshape(trials, robots, -1)
        self._qvel = self._batch.bind("qvel").reshape(trials, robots, -1)
        self._ctrl = self._batch.bind("ctrl").reshape(trials, robots, len(scene.WHEELS), 2)
        self._sensors = self._batch.bind("sensordata").reshape(trials, -1)
        self._hull_sensors = [int(model.sensor(f"{scene.prefix(i)}hull_contact").adr[0]) for i in range(robots)]
        free_joint.place(self._qpos, position_w, heading, robot.height, robot.orientation)
        self._diverged = np.zeros(trials, dtype=bool)
        self._hull_contact = np.zeros(trials, dtype=bool)
        self._wheel_slip = np.zeros(trials)
        # Views of what changes beneath them, components first.
        self._quaternion = np.moveaxis(self._qpos[..., 3:7], -1, 0)
        self._linear_w, self._spin_b = np.moveaxis(self._qvel[..., :3], -1, 0), np.moveaxis(self._qvel[..., 3:6], -1, 0)
        self._gravity_w = model.opt.gravity[:, None, None].copy()
        self._heading = heading.copy()
        self._axes_w = free_joint.orientation(self._quaternion).horizontal_w
        self._velocity_before_w = self._linear_w.copy()
        self._impulse_b = np.zeros((2, trials, robots))
        self._state = self._read(0.0, 0.0)
        self._drivers = Drivers(laws, robot.vehicle, self._state)
        self._recording: Recording | None = None

    @property
    def state(self) -> FleetState:
        """The state now; that of a diverged trial is the last one before it broke down."""
        return self._state

    @property
    def diverged(self) -> BoolArray:
        """Trials in which MuJoCo met a NaN or a huge value, (B,)."""
        return self._diverged

    @property
    def hull_contact(self) -> BoolArray:
        """Trials in which a hull has touched anything so far, (B,)."""
        return self._hull_contact

    @property
    def wheel_slip(self) -> Array:
        """Largest speed of a tyre along its wheel's plane against the ground so far, (B,) [m/s]."""
        return self._wheel_slip

    @property
    def odometry_w(self) -> Array:
        """Velocity by wheels and accelerometer, (B, n, 2) [m/s]."""
        return self._drivers.odometry_w

    @property
    def reference_w(self) -> Array:
        """Velocity of the point mass that the steering law imitates, (B, n, 2) [m/s]."""
        return self._drivers.reference_w

    def record(self) -> Recording:
        """Keeps all motors' commands from now on, which must be the start; friction must be the same in all trials."""
        self._recording = Recording(self._batch.get_model(0), self._qpos)
        return self._recording

    def step(self, force_w: Array, gap: float, error: NavigationError | None = None) -> Sequence[FleetState]:
        """Advances by local-law periods and physics steps; see `Plant.step`."""
        locals_, period, steps = divided(gap)
        self._timestep[:] = period / steps
        per_look = max(1, int(LONGEST_SUBSTEP / (period / steps) + 1e-9))
        start, states = self._state.time, []
        for local in range(locals_):
            self._act(force_w, period, _grown(error, local * period))
            if self._recording is not None:
                self._recording.take(self._ctrl, period / steps, steps)
            done = 0
            while done < steps:
                count = min(per_look, steps - done)
                done += count
                self._advance(count)
                # Rounded, so that sums of many gaps do not drift off the timer.
                time = round(start + period * (local + done / steps), 9)
                self._state = self._read(time, count * period / steps)
                self._wheel_slip = np.maximum(self._wheel_slip, self._slip())
                states.append(self._state)
        return states

    def _act(self, force_w: Array, period: float, error: NavigationError | None) -> None:
        """Runs the local laws and sets the motors' commands."""
        self._ctrl[..., 0], self._ctrl[..., 1] = self._drivers.drive(
            force_w, self._state, self._qvel[..., 5].copy(), self._qvel[..., 6:], period, error
        )

    def _advance(self, steps: int) -> None:
        """Steps the trials that have not diverged."""
        if self._diverged.all():
            return
        self._batch.step(np.nonzero(~self._diverged)[0] if self._diverged.any() else None, nstep=steps)
        self._diverged |= (self._batch.warning[:, _BREAKDOWNS, 1] > 0).any(axis=-1)
        self._hull_contact |= (self._sensors[:, self._hull_sensors] > 0.0).any(axis=-1)

    def _read(self, time: float, interval: float) -> FleetState:
        """Copies the planar state out of the batch, after an interval since it was last done."""
        orientation = free_joint.orientation(self._quaternion)
        self._heading = free_joint.continued(self._heading, orientation.yaw)
        self._feel(orientation.horizontal_w, interval)
        state = FleetState(
            time=time,
            position_w=self._qpos[..., :2].copy(),
            velocity_w=self._qvel[..., :2].copy(),
            heading=self._heading,
            yaw_rate=orientation.yaw_rate(self._spin_b),
            velocity_increment_b=self._impulse_b.transpose(1, 2, 0),
            pose=self._qpos.copy(),
            wheel_speed=self._qvel[..., 6:].copy(),
        )
        return self._frozen(state) if self._diverged.any() else state

    def _feel(self, axes_w: Array, interval: float) -> None:
        """Carries the accelerometers' integrals on over an interval that ends now."""
        velocity_w = self._linear_w.copy()
        self._impulse_b = self._impulse_b + free_joint.felt_increment_b(
            0.5 * (self._axes_w + axes_w), velocity_w - self._velocity_before_w, interval, self._gravity_w
        )
        self._axes_w, self._velocity_before_w = axes_w, velocity_w

    def _slip(self) -> Array:
        """Returns the largest slip of a tyre along its wheel's plane now, (B,) [m/s]."""
        slip = tyre_slip(self._state, self._qvel[..., 6:], self._vehicle).max(axis=(1, 2))
        return np.where(self._diverged, 0.0, slip)

    def _frozen(self, state: FleetState) -> FleetState:
        """Replaces what MuJoCo's reset left in the diverged trials by their last state before it."""
        last, gone = self._state, self._diverged
        self._heading = np.where(gone[:, None], last.heading, state.heading)
        return FleetState(
            time=state.time,
            position_w=np.where(gone[:, None, None], last.position_w, state.position_w),
            velocity_w=np.where(gone[:, None, None], last.velocity_w, state.velocity_w),
            heading=self._heading,
            yaw_rate=np.where(gone[:, None], last.yaw_rate, state.yaw_rate),
            velocity_increment_b=np.where(gone[:, None, None], last.velocity_increment_b, state.velocity_increment_b),
            pose=_kept(gone, last.pose, state.pose),
            wheel_speed=_kept(gone, last.wheel_speed, state.wheel_speed),
        )


def tyre_slip(state: FleetState, wheel_speed: Array, vehicle: Vehicle) -> Array:
    """Returns how fast each tyre slips along its wheel's plane, (B, n, 4) [m/s].

    Args:
        state: Of the robots.
        wheel_speed: Of their wheels, (B, n, 4) [rad/s].
        vehicle: Their parameters.
    """
    forward = along(state.velocity_w, state.heading)[..., None]
    ground = forward + (vehicle.track / 2.0) * state.yaw_rate[..., None] * traction.SIDES
    slip: Array = np.abs(vehicle.wheel_radius * wheel_speed - ground)
    return slip


def divided(gap: float) -> tuple[int, float, int]:
    """Returns how many periods of the local laws a gap has, their length [s], and the physics steps in one."""
    periods = math.ceil(gap / LOCAL_PERIOD - 1e-9)
    return periods, gap / periods, math.ceil(gap / periods / PHYSICS_STEP - 1e-9)


def _kept(gone: BoolArray, last: Array | None, now: Array | None) -> Array | None:
    """Returns what there is now, but for trials that are gone, which keep what they had."""
    return now if last is None or now is None else np.where(gone[:, None, None], last, now)


def _grown(error: NavigationError | None, elapsed: float) -> NavigationError | None:
    """Returns the errors some time after the gap's beginning."""
    return None if error is None else replace(error, heading=error.heading + elapsed * error.yaw_rate)
