import numpy as np

from dynabot_mj.common.arrays import measured


def test_a_converter_reads_the_nearest_of_its_steps():
    read = measured(np.array([0.26, -0.26, 0.24, 0.0]), 0.1)
    np.testing.assert_allclose(read, [0.3, -0.3, 0.2, 0.0], atol=1e-12)


def test_one_without_a_resolution_reads_the_value_itself():
    value = np.array([0.123456789])
    assert measured(value, 0.0) is value
