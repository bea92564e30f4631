import numpy as np

from dynabot_mj.formation.band import Band, within
from dynabot_mj.formation.metrics import Formation
from dynabot_mj.plants.plant import FleetState

FORMATION = Formation(
    well_radius=3.0, spacing=5.0, width=0.5, settling_band=0.5, tolerance=1.0, collision_distance=0.4,
    length=0.4, breadth=0.3,
)  # fmt: skip


def at(second):
    vectors, scalars = np.zeros((2, 2, 2)), np.zeros((2, 2))
    return FleetState(
        time=float(second), position_w=vectors, velocity_w=vectors, heading=scalars, yaw_rate=scalars,
        velocity_increment_b=vectors,
    )  # fmt: skip


def test_what_holds_is_counted_and_what_holds_long_enough_is_a_formation():
    band = Band(FORMATION, np.zeros(2), 2)
    near, far = np.full((1, 2), 3.2), np.full((1, 2), 9.0)
    for second in range(8):
        # The second trial is in the band from 1 s on, but for a moment at 3 s.
        radius = np.concatenate([far, far if second in (0, 3) else near])
        found = band.see(at(second), radius, np.full((2, 1), 5.2), 1.0)
        assert found.tolist() == [False, second not in (0, 3)]
    np.testing.assert_array_equal(band.time, [0.0, 6.0])
    assert np.isnan(band.formed).all()  # it has held for 3 s again
    for second in (8, 9):
        band.see(at(second), np.concatenate([far, near]), np.full((2, 1), 5.2), 1.0)
    np.testing.assert_array_equal(band.formed, [np.nan, 4.0])


def test_one_value_outside_is_outside():
    values = np.array([[1.0, 2.0], [1.0, 3.1]])
    assert within(values, 1.5, 2.5, 0.5).tolist() == [True, False]
