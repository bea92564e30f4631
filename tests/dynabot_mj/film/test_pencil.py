import mujoco
import numpy as np
import pytest

from dynabot_mj.film.pencil import Pencil

RED = (1.0, 0.0, 0.0, 1.0)
EMPTY = mujoco.MjModel.from_xml_string("<mujoco/>")


@pytest.fixture
def scene():
    """Room for a hundred shapes; no picture is drawn of it."""
    return mujoco.MjvScene(EMPTY, maxgeom=100)


def ends(scene):
    """Returns where the lines of a scene are from and to, (lines, 2, 3)."""
    found = []
    for geom in scene.geoms[: scene.ngeom]:
        assert geom.type == mujoco.mjtGeom.mjGEOM_LINE
        # A line begins at its place and goes on along its own z axis.
        found.append([geom.pos, geom.pos + geom.size[2] * geom.mat[:, 2]])
    return np.array(found)


def test_a_path_goes_from_point_to_point(scene):
    points = np.array([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 3.0, 1.5]])
    Pencil(scene).path(points, RED)
    assert scene.ngeom == 2
    np.testing.assert_allclose(ends(scene), [points[:2], points[1:]], atol=1e-6)
    np.testing.assert_array_equal(scene.geoms[0].rgba, RED)


def test_an_ellipse_reaches_as_far_as_its_axes_and_closes(scene):
    axes = np.array([[2.0, 0.0], [0.0, 0.5]])
    Pencil(scene).ellipse(np.array([10.0, 20.0, 0.3]), axes, RED)
    points = ends(scene)
    np.testing.assert_allclose(np.ptp(points[:, 0], axis=0), [4.0, 1.0, 0.0], atol=1e-5)
    np.testing.assert_allclose(points[-1, 1], points[0, 0], atol=1e-5)
    # On it everywhere: (x / 2)^2 + (y / 0.5)^2 = 1.
    way = (points[:, 0, :2] - [10.0, 20.0]) / [2.0, 0.5]
    np.testing.assert_allclose((way**2).sum(axis=-1), 1.0, atol=1e-5)


def test_a_box_is_turned_by_its_heading(scene):
    Pencil(scene).box(np.array([1.0, 2.0, 0.1]), (0.25, 0.2, 0.07), np.pi / 2.0, RED)
    box = scene.geoms[0]
    assert box.type == mujoco.mjtGeom.mjGEOM_BOX
    np.testing.assert_allclose(box.size, [0.25, 0.2, 0.07], rtol=1e-6)
    np.testing.assert_allclose(box.mat @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-6)  # faces north


def test_it_draws_after_what_is_there_until_the_scene_is_full(scene):
    scene.ngeom = 98
    pencil = Pencil(scene)
    for _ in range(3):
        pencil.ball(np.zeros(3), 0.2, RED)
        pencil.line(np.zeros(3), np.ones(3), RED)
    assert scene.ngeom == 100
    assert [geom.type for geom in scene.geoms[98:100]] == [mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_LINE]
