import numpy as np
import pytest
from scipy import stats

from dynabot_mj.common.exceptions import OutOfFittedRangeError
from dynabot_mj.testbed.radio import INSTANT_LINK, Link, Radio, dynabot_link

TICK = 6.5e-4


@pytest.mark.parametrize(("robots", "length"), [(2, 1), (3, 20), (7, 125)])
def test_latency_has_the_distribution_of_eqs_4_to_6(robots, length):
    link = dynabot_link(robots, length)
    draws = np.random.default_rng(0).random(200_000)
    k = link.latency(draws) / TICK - np.floor(0.08 * length + 21 + 5.25 * (robots - 1))
    expected = (0.018 * robots - 0.02) * length + 0.06 * robots**2 - 0.15 * robots + 3
    # k is a whole number, since the floor of offset + k is floor(offset) + k. Its mean has standard deviation
    # sqrt(lambda / N), its variance sqrt((lambda + 2 lambda^2) / N); 4.5 of them.
    np.testing.assert_allclose(k, np.round(k), atol=1e-9)
    assert abs(k.mean() - expected) < 4.5 * np.sqrt(expected / 200_000)
    assert abs(k.var() - expected) < 4.5 * np.sqrt((expected + 2 * expected**2) / 200_000)


def test_one_uniform_number_per_message_inverts_the_poisson_distribution():
    link = Link(offset=0.0, poisson_mean=3.77, tick=1.0, loss=0.0)
    below_one = np.nextafter(1.0, 0.0)
    uniform = np.array([0.0, 0.01, 0.5, 0.999, below_one])
    np.testing.assert_array_equal(link.latency(uniform)[:4], [0.0, *stats.poisson.ppf(uniform[1:4], 3.77)])
    assert link.latency(uniform)[4] < 50.0


def test_papers_three_robots():
    link = dynabot_link(3, 20)
    # By hand: floor(0.08 * 20 + 21 + 10.5) = 33 ticks, lambda = 0.034 * 20 + 3.09, p = (9.09 - 8.46 + 2.04) / 1000.
    assert np.floor(link.offset) == 33
    assert link.poisson_mean == pytest.approx(3.77)
    assert link.loss == pytest.approx(2.67e-3)


@pytest.mark.parametrize(("robots", "length"), [(8, 20), (1, 20), (3, 126), (3, 0)])
def test_outside_the_fitted_range_it_refuses(robots, length):
    with pytest.raises(OutOfFittedRangeError, match="fitted for"):
        dynabot_link(robots, length)


class Bench:
    """Two or more robots of one trial, whose messages the tests send by hand."""

    def __init__(self, link, robots=2, trials=1):
        self.radio = Radio(link, robots, 0, range(trials))
        self.shape = (trials, robots)

    def send(self, time, value, due=None):
        position = np.full((*self.shape, 2), float(value))
        due = np.ones(self.shape, bool) if due is None else np.array([due])
        self.radio.broadcast(position, np.full(self.shape, float(time)), due)

    def heard(self, time):
        return self.radio.heard(np.full(self.shape, float(time)))


def test_never_heard_is_a_state_of_its_own():
    bench = Bench(Link(offset=10.0, poisson_mean=0.0, tick=1e-3, loss=0.0))
    assert not bench.heard(0.0).known.any()
    bench.send(0.0, 7.0)
    assert not bench.heard(0.009).known.any()
    heard = bench.heard(0.010)
    np.testing.assert_array_equal(heard.known[0], [[False, True], [True, False]])
    assert heard.position_w[0, 0, 1, 0] == 7.0
    assert heard.sampled_at[0, 0, 1] == 0.0


def test_an_overtaken_message_is_not_used():
    bench = Bench(Link(offset=10.0, poisson_mean=0.0, tick=1e-3, loss=0.0))
    bench.send(0.0, 1.0)
    # The second message is faster than the first, as a smaller k_m makes it.
    bench.radio._link = Link(offset=2.0, poisson_mean=0.0, tick=1e-3, loss=0.0)
    bench.send(0.005, 2.0)
    assert bench.heard(0.007).position_w[0, 0, 1, 0] == 2.0
    assert bench.heard(0.020).position_w[0, 0, 1, 0] == 2.0


def test_messages_in_flight_do_not_pile_up():
    bench = Bench(dynabot_link(7, 125), robots=7)
    for k in range(300):
        bench.send(0.01 * k, k)
        bench.heard(0.01 * k)
    # The longest latency at all, some 0.12 s, is twelve periods.
    assert len(bench.radio._in_flight) <= 13


def test_only_robots_that_are_due_send():
    bench = Bench(INSTANT_LINK, robots=3)
    bench.send(0.0, 1.0, due=[True, False, False])
    np.testing.assert_array_equal(bench.heard(0.0).known[0], [[0, 0, 0], [1, 0, 0], [1, 0, 0]])


def test_loss_is_drawn_per_receiver_with_the_rate_of_eq_7():
    link = dynabot_link(7, 20)
    bench = Bench(Link(offset=0.0, poisson_mean=0.0, tick=TICK, loss=link.loss), robots=7, trials=200)
    lost = missed_by_all = 0
    for k in range(100):
        bench.send(k, k)
        fresh = bench.heard(k).sampled_at == k
        missing = ~fresh & ~np.eye(7, dtype=bool)
        lost += missing.sum()
        missed_by_all += (missing.sum(axis=1) == 6).sum()
    n = 100 * 200 * 42
    # Binomial: standard deviation sqrt(p (1 - p) / n), 4.5 of them; p = 31.8e-3 at n = 7.
    assert link.loss == pytest.approx(31.79e-3)
    assert abs(lost / n - link.loss) < 4.5 * np.sqrt(link.loss * (1 - link.loss) / n)
    # Independent receivers: p^6 = 1e-9 of the 140,000 messages are missed by all.
    assert missed_by_all == 0


def test_latency_is_the_same_for_all_receivers():
    bench = Bench(dynabot_link(7, 20), robots=7)
    bench.send(0.0, 1.0)
    arrives = bench.radio._in_flight[0].arrives_at[0]
    for sender in range(7):
        times = arrives[np.isfinite(arrives[:, sender]), sender]
        assert np.ptp(times) == 0.0


@pytest.mark.parametrize(("period", "robots"), [(13, 3), (26, 3), (39, 7), (52, 7)])
def test_what_arrives_with_an_event_is_heard_at_it(period, robots):
    """Multiples of t_k and of the timer's tick meet at multiples of 13 ms; as floats they differ in the last bit."""
    ticks = round(period * 1e-3 / TICK) * (1 if robots == 7 else round(26 / period))
    late = ticks * TICK  # the latency of every message: a whole number of periods
    radio = Radio(Link(offset=ticks, poisson_mean=0.0, tick=TICK, loss=0.0), robots, 0, [0])
    periods = round(late / (period * 1e-3))
    everybody = np.ones((1, robots), dtype=bool)
    for event in range(400):
        now = np.full((1, robots), event * period * 1e-3)
        heard = radio.heard(now)
        age = (now[..., None] - heard.sampled_at)[heard.known]
        np.testing.assert_allclose(age, late, atol=1e-9)
        assert heard.known.any() == (event >= periods)
        radio.broadcast(np.zeros((1, robots, 2)), now, everybody)
