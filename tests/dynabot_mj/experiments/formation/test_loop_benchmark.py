import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.experiments.formation import loop_benchmark
from dynabot_mj.plants.replay import Engine


@pytest.fixture(scope="module")
def engines():
    return []


@pytest.fixture(scope="module")
def report(engines, small_loop):
    class Kept(Engine):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            engines.append(self)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(loop_benchmark, "Engine", Kept)
        return loop_benchmark.run(robots=2, repetitions=2)


def test_every_row_is_measured(report):
    rows = [(row.perception, row.trials, row.threads) for row in report.rigid]
    assert rows == [(one, b, t) for one in ("gauss-markov", "filter") for b in (1, 3) for t in (1, 2)]
    assert [row.trials for row in report.particle] == [1, 5]
    for row in report.rigid:
        numbers = [row.loop_us, row.raw_us, row.overhead_ratio, row.wall_ratio]
        assert np.isfinite(numbers).all()
        assert min(numbers) > 0.0
    for row in report.particle:
        assert np.isfinite(row.env_steps_per_second)
        assert row.env_steps_per_second > 0.0
    assert report.control_period_ms == pytest.approx(34.0)  # of two robots
    assert report.seconds == pytest.approx({"rigid": 6 * 0.034, "particle": 8 * 0.034})


def test_the_ratio_of_the_headline_is_that_of_its_row(report):
    row = next(row for row in report.rigid if (row.perception, row.trials, row.threads) == loop_benchmark.HEADLINE)
    assert report.overhead_ratio == row.overhead_ratio


def test_shares_are_of_both_plants_and_perceptions(report):
    assert len({(row.plant, row.perception) for row in report.shares}) == len(report.shares) == 4
    for row in report.shares:
        assert sum(row.shares.values()) == pytest.approx(1.0)


def test_the_engine_has_gone_all_the_way_in_turn_with_the_loop(report, engines, small_loop):
    """What is timed is the same physics: the bits at the end are those of the run that was recorded."""
    assert len(engines) == 2 * len(report.rigid)
    for perception, first in (("gauss-markov", 0), ("filter", 4)):
        for index, trials in ((first, 1), (first + 2, 3)):
            setup = loop_benchmark._setup(2, "rigid", perception)
            case = loop_benchmark._case(setup)
            parts = loop_benchmark.assembly.parts(setup, case, range(trials))
            loop_benchmark.loop.simulate(parts)
            for engine in (engines[index], engines[index + 1]):  # by one thread, and by two
                np.testing.assert_array_equal(engine.qpos.reshape(trials, 2, -1), parts.plant.state.pose)


def test_the_number_of_robots_is_judged():
    with pytest.raises(InputError, match="robots"):
        loop_benchmark.run(robots=1, repetitions=1)
