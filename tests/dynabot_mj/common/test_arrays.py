import numpy as np
import pytest

from dynabot_mj.common.arrays import measured, rms


def test_a_converter_reads_the_nearest_of_its_steps():
    read = measured(np.array([0.26, -0.26, 0.24, 0.0]), 0.1)
    np.testing.assert_allclose(read, [0.3, -0.3, 0.2, 0.0], atol=1e-12)


def test_one_without_a_resolution_reads_the_value_itself():
    value = np.array([0.123456789])
    assert measured(value, 0.0) is value


def test_the_root_mean_square_is_of_all_values_or_along_an_axis():
    values = np.array([[3.0, -4.0], [0.0, 0.0]])
    assert rms(values) == pytest.approx(2.5)
    np.testing.assert_allclose(rms(values, axis=1), [np.sqrt(12.5), 0.0])
