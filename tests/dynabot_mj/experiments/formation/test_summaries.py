import numpy as np

from dynabot_mj.experiments.formation import summaries
from dynabot_mj.testbed.paper import TABLE_III


def test_a_variable_that_an_older_study_lacks_has_neither_mean_nor_rate(dataset):
    case = dataset.isel(case=0).drop_vars(["top_speed", "completion"])
    assert summaries.mean("top_speed")(case).mean is None
    assert summaries.rate("completion")(case).rate is None


def test_centres_of_bodies_have_no_collision(dataset):
    particle, rigid = (summaries.collision_of_centres(dataset.isel(case=index)) for index in (0, 1))
    assert particle.n == 3
    assert rigid is None


def test_contacts_count_per_minute_at_risk(dataset):
    changed = dataset.copy(deep=True)
    changed.arrival[{"case": 0}] = [2.0, 4.0, np.nan]
    changed.contact[{"case": 0}] = [8.0, np.nan, 1.0]
    found = summaries.contact_hazard(changed.isel(case=0))
    # 6 s to the contact and 10 s to the end; who touched and never arrived is left out.
    assert (found.k, found.excluded) == (1, 1)
    assert found.minutes == 16.0 / 60.0


def test_the_papers_values_are_of_its_hundred_trials():
    row = TABLE_III["gps"]
    settling, collision = summaries.published_settling(row), summaries.published_rate(row.collision)
    assert (settling.mean, settling.sd, settling.n) == (68.0, 11.0, 100)
    assert (collision.rate, collision.k, collision.n) == (0.15, 15, 100)
