import numpy as np
import pytest

from dynabot_mj.plants.plant import FleetState
from dynabot_mj.study import configuration
from dynabot_mj.viewing import playback, recording
from dynabot_mj.viewing.playback import Clock, ClosedError, Pacer
from dynabot_mj.viewing.stage import Snapshot


class Wall:
    """Time that passes only where someone sleeps."""

    def __init__(self, monkeypatch):
        self.now = 0.0
        monkeypatch.setattr(playback.time, "sleep", self.sleep)

    def __call__(self):
        return self.now

    def sleep(self, duration):
        self.now += duration


class Recorder:
    """A screen that remembers what was shown and when, and is closed at some time."""

    def __init__(self, wall, closes):
        self.wall, self.closes, self.shown, self.settled = wall, closes, [], False

    @property
    def open(self):
        return self.wall.now < self.closes

    def show(self, snapshots, index):
        self.shown.append((self.wall.now, snapshots[index].time))

    def settle(self):
        self.settled = True


@pytest.fixture
def wall(monkeypatch):
    return Wall(monkeypatch)


def snapshots(duration):
    zero = np.zeros((2, 2))
    return [
        Snapshot(time=float(time), position_w=zero, pose=None, believed_w=zero)
        for time in np.arange(0.0, duration + 1e-9, 0.04)
    ]


def test_a_clock_runs_at_its_speed_and_stands_while_halted(wall):
    clock = Clock(2.0, wall)
    wall.now = 1.5
    assert clock.time == pytest.approx(3.0)
    clock.speed = 0.5
    wall.now = 2.5
    assert clock.time == pytest.approx(3.5)
    clock.playing = False
    wall.now = 9.0
    assert clock.time == pytest.approx(3.5)
    clock.playing = True
    clock.time = 1.0
    wall.now = 10.0
    assert clock.time == pytest.approx(1.5)


def test_a_replay_keeps_to_the_clock_and_halts_at_the_end(wall):
    screen, clock = Recorder(wall, 4.0), Clock(2.0, wall)
    playback.replay(snapshots(5.0), screen, clock)
    assert screen.settled
    for now, shown in screen.shown:
        assert shown <= min(2.0 * now, 5.0) + 1e-6
        assert shown >= min(2.0 * now, 5.0) - 0.04 - 1e-6
    assert not clock.playing
    assert clock.time == pytest.approx(5.0)


def test_a_replay_starts_anew_where_play_is_pressed_at_the_end(wall):
    clock = Clock(1.0, wall)

    class Pressed(Recorder):
        def show(self, snapshots, index):
            super().show(snapshots, index)
            if wall.now > 2.0 and not clock.playing and len(self.shown) < 75:
                clock.playing = True

    screen = Pressed(wall, 2.5)
    playback.replay(snapshots(1.0), screen, clock)
    times = [shown for _, shown in screen.shown]
    assert max(times) == pytest.approx(1.0)
    assert times[-1] < 0.6


def test_a_replay_goes_where_the_clock_is_set(wall):
    clock = Clock(1.0, wall)
    clock.time, clock.playing = 3.0, False
    screen = Recorder(wall, 0.2)
    playback.replay(snapshots(5.0), screen, clock)
    np.testing.assert_allclose([shown for _, shown in screen.shown], 3.0)


def run(pacer, wall, duration, cost):
    """Steps of 10 ms, each of which takes the simulation some time."""
    zero = np.zeros((1, 2))
    for step in range(round(duration / 0.01) + 1):
        wall.now += cost
        place = np.stack([zero, zero], axis=1)
        pacer.substep(
            FleetState(
                time=0.01 * step,
                position_w=place,
                velocity_w=place,
                heading=zero,
                yaw_rate=zero,
                velocity_increment_b=place,
            )
        )


def test_a_fast_simulation_is_held_back_to_the_clock(wall):
    screen, clock = Recorder(wall, 100.0), Clock(1.0, wall)
    pacer = Pacer(screen, clock, 2)
    run(pacer, wall, 5.0, 0.001)
    assert wall.now == pytest.approx(5.0, abs=0.05)
    gaps = np.diff([snapshot.time for snapshot in pacer.snapshots])
    assert gaps.mean() == pytest.approx(playback.FRAME, rel=0.02)


def test_a_slow_simulation_does_not_rush_once_it_is_fast(wall):
    screen, clock = Recorder(wall, 100.0), Clock(1.0, wall)
    pacer = Pacer(screen, clock, 2)
    run(pacer, wall, 1.0, 0.05)  # five times slower than the clock
    assert clock.time == pytest.approx(1.0, abs=0.2)


def test_a_simulation_waits_while_halted_and_ends_with_its_screen(wall):
    screen, clock = Recorder(wall, 3.0), Clock(1.0, wall)
    clock.playing = False
    pacer = Pacer(screen, clock, 2)
    with pytest.raises(ClosedError):
        run(pacer, wall, 1.0, 0.0)
    assert len(pacer.snapshots) == 1  # that of the start


@pytest.mark.parametrize("plant", ["particle", "rigid"])
def test_live_and_recorded_trials_look_alike(wall, plant):
    setup = configuration.build({}, trials=1, duration=1.0, plants=[plant], estimators=["gps"])
    shown = playback.live(setup, Recorder(wall, 100.0), Clock(1.0, wall))
    recorded = playback.snapshots(recording.record(setup, 0.001))
    for one in shown[1:]:
        other = recorded[round(one.time / 0.001)]
        np.testing.assert_allclose(one.position_w, other.position_w, atol=1e-3)
        np.testing.assert_array_equal(one.pose is None, plant == "particle")
        if plant == "rigid":
            np.testing.assert_allclose(one.pose, other.pose, atol=0.02)
    beliefs = np.unique([one.believed_w for one in recorded], axis=0)
    assert all((one.believed_w == beliefs).all(axis=(1, 2)).any() for one in shown[1:])


def test_a_closed_screen_leaves_nothing_to_replay(wall):
    setup = configuration.build({}, trials=1, duration=1.0, plants=["particle"], estimators=["gps"])
    assert playback.live(setup, Recorder(wall, 0.5), Clock(1.0, wall)) is None
