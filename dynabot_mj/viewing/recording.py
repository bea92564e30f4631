"""One trial, frame by frame: what robots did, believed, heard and commanded; bit for bit the trial of a study."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import Array, BoolArray, Progress
from dynabot_mj.formation.scorer import Scorer, interpolate
from dynabot_mj.plants import scene
from dynabot_mj.plants.plant import FleetState
from dynabot_mj.plants.rigid_body import tyre_slip
from dynabot_mj.study import assembly, fleet, scenario
from dynabot_mj.study.scenario import Case, Scenario
from dynabot_mj.trial import loop
from dynabot_mj.trial.loop import Event

IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Messages:
    """M messages, each sent once to all others, in the order of sending."""

    sent_at: Array  # (M,) [s]
    sender: IntArray  # (M,)
    arrives_at: Array  # (M, n) [s]; inf where it never arrives: lost, or the sender itself
    lost: BoolArray  # (M, n)


@dataclass(frozen=True, kw_only=True)
class Recording:
    """One trial of one case at K times; what is held between events is as of the latest event before the time."""

    setup: Scenario
    case: Case
    trial: int
    time: Array  # (K,) even, from zero to the duration [s]
    position_w: Array  # (K, n, 2) true [m]
    velocity_w: Array  # (K, n, 2) true [m/s]
    heading: Array  # (K, n) true, not wrapped [rad]
    pose: Array | None  # (K, n, 11) MuJoCo's coordinates, see `FleetState`; None: point masses
    slip: Array  # (K, n) largest of a robot's tyres [m/s]; NaN for point masses
    force_w: Array  # (K, n, 2) command [N]
    believed_w: Array  # (K, n, 2) own position as each robot believes it [m]; NaN where it knows nothing
    covariance: Array  # (K, n, 2, 2) of that, as the robot believes it [m^2]; NaN likewise
    heard_w: Array  # (K, n receivers, n senders, 2) positions acted on [m]; NaN where nothing has arrived
    heard_age: Array  # (K, n, n) since they were sampled [s]; NaN likewise
    closest: Array  # (K,) smallest distance between two centres since the time before [m]
    overlapping: BoolArray  # (K, n) whose footprint has overlapped another since the time before
    near: BoolArray  # (K, n) whose centre has been nearer to another than the collision distance since then
    messages: Messages
    final_position_w: Array  # (n, 2) at the very end, which a study keeps [m]
    final_heading: Array  # (n,) likewise [rad]


def record(setup: Scenario, interval: float, progress: Progress = lambda share: None) -> Recording:
    """Runs one trial and keeps it.

    Args:
        setup: Of one trial of one case, see `scenario.one_trial`.
        interval: Between two times [s].
        progress: Called now and then.
    """
    (case,) = scenario.cases(setup)
    made = assembly.parts(setup, case, [setup.first_trial])
    scorer = Scorer(assembly.formation(setup, case.estimator), made.leader_w, (1, setup.robots), made.clocks.duration)
    recorder = _Recorder(setup, case, interval, scorer)
    loop.simulate(made, [recorder], progress)
    return recorder.recording()


class _Recorder:
    """Keeps the first of the trials that it is shown."""

    def __init__(self, setup: Scenario, case: Case, interval: float, scorer: Scorer) -> None:
        self._setup, self._case, self._scorer = setup, case, scorer
        self._vehicle = scene.read_robot(fleet.conditions(setup)).vehicle
        count = int(scenario.duration(setup) / interval + 1e-9) + 1
        self._time = interval * np.arange(count, dtype=np.float64)
        self._frames: list[dict[str, Array]] = []
        self._messages: list[tuple[float, int, Array, Array]] = []
        self._previous: FleetState | None = None
        self._event: Event | None = None
        self._closest, self._overlapping, self._near = _nobody_near(setup.robots)

    def event(self, event: Event) -> None:
        """Takes what is held from now on."""
        self._event = event
        if not self._frames:
            assert self._previous is not None  # the loop shows the start first
            self._keep(self._previous, self._previous, 0.0)
        if event.sample is not None:
            arrives_at, itself = event.sample.message.arrives_at[0], np.eye(self._setup.robots, dtype=bool)
            for sender in np.flatnonzero(event.sample.sent[0]).tolist():
                lost = ~np.isfinite(arrives_at[:, sender]) & ~itself[:, sender]
                self._messages.append((event.time, sender, arrives_at[:, sender].copy(), lost))

    def substep(self, state: FleetState) -> None:
        """Takes a state; the times up to it are interpolated."""
        self._scorer.substep(state)
        self._judge()
        before = self._previous
        if before is not None and self._event is not None:
            while len(self._frames) < len(self._time) and self._time[len(self._frames)] <= state.time + 1e-9:
                self._keep(before, state, float(self._time[len(self._frames)]))
        self._previous = state

    def recording(self) -> Recording:
        """Returns what was kept."""
        kept = {name: np.stack([frame[name] for frame in self._frames]) for name in self._frames[0]}
        n, last = self._setup.robots, self._previous
        assert last is not None  # trials have a duration
        return Recording(
            setup=self._setup,
            case=self._case,
            trial=self._setup.first_trial,
            time=self._time[: len(self._frames)],
            position_w=kept["position_w"],
            velocity_w=kept["velocity_w"],
            heading=kept["heading"],
            pose=kept.get("pose"),
            slip=kept["slip"],
            force_w=kept["force_w"],
            believed_w=kept["believed_w"],
            covariance=kept["covariance"],
            heard_w=kept["heard_w"],
            heard_age=kept["heard_age"],
            closest=kept["closest"],
            overlapping=kept["overlapping"].astype(bool),
            near=kept["near"].astype(bool),
            messages=Messages(
                sent_at=np.array([message[0] for message in self._messages]),
                sender=np.array([message[1] for message in self._messages], dtype=np.int64),
                arrives_at=np.array([message[2] for message in self._messages]).reshape(-1, n),
                lost=np.array([message[3] for message in self._messages], dtype=bool).reshape(-1, n),
            ),
            final_position_w=last.position_w[0].copy(),
            final_heading=last.heading[0].copy(),
        )

    def _judge(self) -> None:
        """Takes from the scorer who is near whom in the latest state."""
        first, second = self._scorer.pairs
        distance, overlapping = self._scorer.distance[0], self._scorer.overlapping[0]
        self._closest = min(self._closest, float(distance.min()))
        for pairs, robot in ((distance < self._setup.collision_distance, self._near), (overlapping, self._overlapping)):
            robot[first[pairs]] = robot[second[pairs]] = True

    def _keep(self, before: FleetState, after: FleetState, time: float) -> None:
        """Keeps one time between two states."""
        assert self._event is not None
        belief, heard = self._event.belief, self._event.heard
        share = (time - before.time) / (after.time - before.time) if after.time > before.time else 0.0

        def between(a: Array, b: Array) -> Array:
            return a[0] + share * (b[0] - a[0])

        known, arrived = belief.known[0, :, None], heard.known[0]
        frame = {
            "position_w": interpolate(before, after, time)[0],
            "velocity_w": between(before.velocity_w, after.velocity_w),
            "heading": between(before.heading, after.heading),
            "slip": np.full(self._setup.robots, np.nan),
            "force_w": self._event.force_w[0],
            "believed_w": np.where(known, belief.position_w[0], np.nan),
            "covariance": np.where(known[..., None], belief.position_covariance[0], np.nan),
            "heard_w": np.where(arrived[..., None], heard.position_w[0], np.nan),
            "heard_age": np.where(arrived, time - heard.sampled_at[0], np.nan),
            "closest": np.asarray(self._closest),
            "overlapping": self._overlapping.astype(float),
            "near": self._near.astype(float),
        }
        if before.pose is not None and after.pose is not None and after.wheel_speed is not None:
            pose = between(before.pose, after.pose)
            # In the few milliseconds between two states a straight line between two rotations is as good as an arc.
            pose[:, 3:7] /= np.linalg.norm(pose[:, 3:7], axis=1, keepdims=True)
            frame["pose"] = pose
            frame["slip"] = tyre_slip(after, after.wheel_speed, self._vehicle)[0].max(axis=-1)
        self._frames.append(frame)
        self._closest, self._overlapping, self._near = _nobody_near(self._setup.robots)
        self._judge()


def _nobody_near(count: int) -> tuple[float, BoolArray, BoolArray]:
    """Returns the smallest distance, who has overlapped and who has been too near, before any state."""
    return np.inf, np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
