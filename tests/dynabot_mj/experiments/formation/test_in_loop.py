import numpy as np
import pytest

from dynabot_mj.experiments.formation import case_rows, in_loop
from dynabot_mj.study import configuration


def test_errors_in_the_loop_are_measured_and_can_be_imitated(perceptions):
    rows = [row for row in case_rows.rows(perceptions) if row.estimator in ("perfect", "decoupled")]
    by_case = {row.perception: row.estimate_error for row in rows if row.plant == "rigid"}
    assert by_case[None] is None
    # Table II's 1.1 m is that of the planar distance; six robots' means over 2 s scatter by about 10 %.
    assert by_case["gauss-markov"].position_rms_m == pytest.approx(1.1 / np.sqrt(2.0), rel=0.3)
    assert by_case["gauss-markov"].heading_rms_deg is None
    assert by_case["filter"].heading_rms_deg > 0.5
    written = in_loop.fitted_toml(perceptions)
    setup = configuration.load(written, "the written table", trials=1, perception=["fitted"])
    assert setup.fitted.seed == perceptions.attrs["seed"]
    deviation = np.sqrt(sum(one.deviation**2 for one in setup.fitted.decoupled.position))
    measured = next(row for row in rows if row.perception == "filter")  # of the first plant
    assert deviation == pytest.approx(measured.estimate_error.position_rms_m, rel=0.1)


def test_a_study_without_filters_has_none_to_imitate(dataset):
    assert in_loop.fitted_toml(dataset) is None
