import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.common.exceptions import InfeasibleScheduleError, InputError
from dynabot_mj.testbed import schedule
from dynabot_mj.testbed.paper import TABLE_II, TABLE_III


@pytest.mark.parametrize(
    ("bound", "expected"),
    [
        (1.0, {"gps": 27.05, "decoupled": 36.45, "coupled": 155.98}),
        (0.95, {"gps": 28.76, "decoupled": 38.76, "coupled": 165.85}),
    ],
)
def test_eq_3_for_three_robots(bound, expected):
    for name, period_ms in expected.items():
        period = schedule.period(3, TABLE_II[name].estimation_time, bound)
        assert 1e3 * period == pytest.approx(period_ms, abs=0.005)


@pytest.mark.parametrize("name", list(TABLE_II))
def test_rounded_periods_are_those_of_table_iii(name):
    exact = schedule.period(3, TABLE_II[name].estimation_time)
    assert schedule.rounded(exact) == pytest.approx(TABLE_III[name].period, abs=1e-12)


def test_authors_ten_ms_is_not_eq_3():
    assert 1e3 * schedule.period(3, 0.0) == pytest.approx(20.0, abs=0.05)


@given(robots=st.integers(2, 7), estimation_time=st.floats(0.0, 1.0), bound=st.floats(0.17, 1.0))
def test_eq_2_at_the_period_of_eq_3_is_the_bound(robots, estimation_time, bound):
    period = schedule.period(robots, estimation_time, bound)
    assert schedule.utilisation(robots, estimation_time, period, period) == pytest.approx(bound, rel=1e-12)
    schedule.require_feasible(robots, estimation_time, period, period, bound)


@given(robots=st.integers(2, 6), estimation_time=st.floats(0.0, 1.0))
def test_more_robots_need_a_longer_period(robots, estimation_time):
    assert schedule.period(robots + 1, estimation_time) > schedule.period(robots, estimation_time)


def test_control_slower_than_sampling_gains_what_the_paper_says():
    # "increasing T_c from T_s to infinity results in at most a 10 % decrease in T_s": 9.2 % for GPS, n = 3.
    common = schedule.period(3, TABLE_II["gps"].estimation_time)
    work = common * (1.0 - 0.16) - 3 * 0.7e-3
    assert 1.0 - work / (1.0 - 0.16) / common == pytest.approx(0.092, abs=5e-4)


def test_gps_parsing_alone_can_fill_the_processor():
    with pytest.raises(InfeasibleScheduleError, match=r"0\.1600.*bound is 0\.1"):
        schedule.period(3, 0.0059, 0.1)


def test_an_infeasible_set_names_load_and_bound():
    with pytest.raises(
        InfeasibleScheduleError, match=r"load the processor 1\.0\d+, the utilisation bound is 1;.*27\.05 ms"
    ):
        schedule.require_feasible(3, 0.0059, 0.026, 0.026)


def test_a_coarse_timer_rounds_up():
    assert schedule.rounded(0.02705, 0.02) == pytest.approx(0.04)
    with pytest.raises(InfeasibleScheduleError, match=r"load the processor 1\.2960"):
        schedule.require_feasible(3, 0.0059, 0.02, 0.02, tick=0.02)


def test_periods_of_table_iii_are_feasible_although_their_rounded_load_is_not():
    for name, figures in TABLE_II.items():
        period = TABLE_III[name].period
        schedule.require_feasible(3, figures.estimation_time, period, period)
    assert schedule.utilisation(3, TABLE_II["decoupled"].estimation_time, 0.036, 0.036) == pytest.approx(
        1.0106, abs=5e-5
    )


@pytest.mark.parametrize(
    ("robots", "estimation_time", "bound"),
    [(1, 0.0, 1.0), (8, 0.0, 1.0), (3, -1e-3, 1.0), (3, 0.0, 0.0), (3, 0.0, 1.7), (3, float("nan"), 1.0)],
)
def test_values_out_of_range_are_refused(robots, estimation_time, bound):
    with pytest.raises(InputError, match="given"):
        schedule.period(robots, estimation_time, bound)
