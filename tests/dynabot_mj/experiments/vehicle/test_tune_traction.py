from dataclasses import replace

import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import gains
from dynabot_mj.controllers.design import tuning
from dynabot_mj.experiments.vehicle import manoeuvres, tune_traction
from dynabot_mj.experiments.vehicle.tune_traction import TuningRequest
from dynabot_mj.figures import tracking


def test_gains_that_are_not_better_are_not_adopted(monkeypatch, small_tuning):
    first = gains.load("first")
    spoilt = replace(first, traction=replace(first.traction, yaw_gain=0.3, scrub_torque=0.5))
    verdict = tune_traction.validate(TuningRequest(), first, spoilt)
    assert not verdict.better
    # A set against itself is no better either: the interval is zero.
    assert not tune_traction.validate(TuningRequest(), first, first).better
    assert tune_traction.validate(TuningRequest(), spoilt, first).improvement.difference == pytest.approx(
        -verdict.improvement.difference
    )


def test_the_other_law_can_be_tuned(small_tuning):
    result = tune_traction.run(TuningRequest(steering="heading"))
    assert result.solution.cost_after < result.solution.cost_before
    assert result.solution.gains.hand_point == gains.load("first").hand_point
    assert tracking.tuning(result).axes


def test_courses_of_a_file_are_what_is_tuned_on(small_tuning, tmp_path):
    file = tmp_path / "courses.toml"
    file.write_text('[[manoeuvre]]\nkind = "circle"\nforce = 20.0\n')
    request = TuningRequest(courses=tuple(manoeuvres.load(file)))
    assert tune_traction.run(request).courses.force_w.shape == (1, 56, 2)


def test_an_unknown_law_is_not_tuned():
    with pytest.raises(InputError, match="period"):
        tune_traction.check(TuningRequest(period=3.0))


@pytest.mark.slow
def test_a_second_start_point_reaches_the_same_cost():
    request = TuningRequest()
    courses = manoeuvres.sampled(manoeuvres.random(0, tune_traction.COURSES, 0), tune_traction.DURATION, 0.036)
    problem = tune_traction.problem(request, courses)
    first = gains.load("first")
    other = replace(
        first,
        hand_point=replace(first.hand_point, offset=0.5, hold=2.5, catch_up=0.5, preview=0.05, turning_speed=1.2),
        traction=replace(first.traction, yaw_gain=1.0, speed_gain=1.0, scrub_torque=1.0),
    )
    costs = []
    for start in (first, other):
        solution = tuning.tune(problem, start, limit=60)
        assert solution.converged
        costs.append(solution.cost_after)
    assert costs[0] == pytest.approx(costs[1], rel=0.02)
