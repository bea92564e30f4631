import mujoco
import numpy as np
import pytest

from dynabot_mj.common.legend import ROBOT_COLOURS
from dynabot_mj.plants import scene
from dynabot_mj.study import assembly, configuration, scenario
from dynabot_mj.viewing import stage
from dynabot_mj.viewing.stage import Snapshot, Stage

PLACES = np.array([[1.0, 2.0], [-3.0, 4.0], [5.0, -6.0]])


def staged(plant, estimator="decoupled"):
    setup = configuration.build({}, plants=[plant], estimators=[estimator], trials=1)
    return setup, Stage(setup, scenario.cases(setup)[0])


def snapshot(time=0.0, position_w=PLACES, pose=None, believed_w=PLACES):
    return Snapshot(time=time, position_w=position_w, pose=pose, believed_w=believed_w)


def test_rigid_robots_stand_in_their_poses_and_wear_the_colours_of_the_figures():
    _, shown = staged("rigid")
    pose = np.zeros((3, 11))
    pose[:, :2], pose[:, 2], pose[:, 3] = PLACES, 0.1, 1.0
    pose[1, 8] = 0.7
    shown.place(snapshot(pose=pose))
    for robot, place in enumerate(PLACES):
        name = scene.prefix(robot)
        np.testing.assert_allclose(shown.data.body(f"{name}chassis").xpos, [*place, 0.1])
        paint = shown.model.material(f"{name}paint").rgba[:3]
        assert "#" + bytes(np.round(255.0 * paint).astype(np.uint8)).hex().upper() == ROBOT_COLOURS[robot].upper()
    assert shown.data.joint(f"{scene.prefix(1)}{scene.WHEELS[1]}").qpos == pytest.approx(0.7)


def test_point_masses_are_as_wide_as_the_distance_at_which_they_collide():
    setup, shown = staged("particle")
    assert shown.model.nq == 0
    shown.place(snapshot())
    for robot, place in enumerate(PLACES):
        body = shown.model.body(f"point{robot}")
        radius = shown.model.geom_size[body.geomadr[0], 0]
        assert 2.0 * radius == pytest.approx(setup.collision_distance)
        np.testing.assert_allclose(shown.data.body(f"point{robot}").xpos, [*place, radius])


def test_ghosts_are_where_robots_believe_to_be_and_out_of_sight_where_they_believe_nothing():
    _, shown = staged("particle")
    believed_w = PLACES + 0.5
    believed_w[2] = np.nan
    shown.place(snapshot(believed_w=believed_w))
    ghosts = np.array([shown.data.body(f"ghost{robot}").xpos for robot in range(3)])
    np.testing.assert_allclose(ghosts[:2, :2], PLACES[:2] + 0.5)
    assert ghosts[2, 2] < -10.0


def test_perfect_information_has_no_ghosts():
    _, shown = staged("rigid", "perfect")
    names = [shown.model.body(body).name for body in range(shown.model.nbody)]
    assert not any(name.startswith("ghost") for name in names)


def test_rings_lie_at_the_edges_of_the_wells_floor():
    setup, shown = staged("rigid")
    well = assembly.field(setup, "decoupled").leader
    boxes = (shown.model.geom_bodyid == 0) & (shown.model.geom_type == mujoco.mjtGeom.mjGEOM_BOX)
    radii = np.unique(np.hypot(*shown.model.geom_pos[boxes, :2].T).round(6))
    np.testing.assert_allclose(radii, [well.radius, well.radius + well.width], atol=1e-6)


def test_nothing_on_the_stage_but_the_robots_themselves_can_be_touched():
    _, shown = staged("rigid")
    for geom in range(shown.model.ngeom):
        name = shown.model.body(shown.model.geom_bodyid[geom]).name
        if name.startswith("ghost") or (name == "world" and shown.model.geom(geom).name != "floor"):
            assert shown.model.geom_contype[geom] == shown.model.geom_conaffinity[geom] == 0


def test_a_trail_ends_at_the_robot_and_keeps_its_points_while_it_moves_on():
    path = [snapshot(time=0.05 * k, position_w=PLACES + np.array([0.1 * k, 0.0])) for k in range(1000)]
    before, after = stage.trail(path, 704), stage.trail(path, 706)
    np.testing.assert_array_equal(before[:, -1], path[704].position_w)
    shared = [tuple(point) for point in before[0] if point in after[0][:-1]]
    assert len(shared) > 90
    # Every other piece is a dash, which stays where it is as well: an even point is never an odd one later.
    for k in range(700, 740):
        first = stage.trail(path, k)[0, 0, 0] - PLACES[0, 0]
        assert round(first / 0.1) % 8 == 0  # four snapshots from point to point
    reached = (before[0, -1, 0] - before[0, 0, 0]) / 0.1 * 0.05
    assert stage.TRAIL - 2.0 * stage.TRAIL_SPACING < reached <= stage.TRAIL
    assert stage.trail(path, 0).shape == stage.trail(path[:1], 0).shape == (3, 1, 2)
