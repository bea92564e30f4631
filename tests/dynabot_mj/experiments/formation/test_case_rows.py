import numpy as np
import pytest

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation import case_rows


@pytest.fixture
def told(dataset):
    """A study of GPS on both plants, three trials of 14 s, with outcomes of our own."""
    changed = dataset.copy(deep=True)
    particle = {"case": 0}
    changed.settling[particle] = [10.0, np.nan, 12.0]
    changed.settled[particle] = [1.0, 0.0, 1.0]
    changed.collision[particle] = [0.0, 0.0, 0.0]
    changed.arrival[particle] = [4.0, 6.0, np.nan]
    changed.formation[particle] = [5.0, 8.0, np.nan]
    changed.contact[particle] = [np.nan, 7.0, np.nan]
    changed.overturned[particle] = [np.nan, np.nan, np.nan]
    changed.collision_footprint[particle] = [0.0, 1.0, 0.0]
    return changed


def test_undefined_trials_are_left_out_of_means_and_count_in_shares(told):
    row = case_rows.rows(told)[0]
    assert (row.settling_s.mean, row.settling_s.n, row.settling_s.hulls) == (11.0, 2, 0)
    assert (row.settling_s.unsettled.k, row.settling_s.unsettled.n) == (1, 3)
    assert (row.arrival_s.mean, row.arrival_s.n) == (5.0, 2)
    assert (row.arrival_s.not_arrived.k, row.arrival_s.not_arrived.n) == (1, 3)


def test_restricted_means_count_the_horizon_for_what_did_not_happen_or_after_a_contact(told):
    row = case_rows.rows(told)[0]
    formation = row.time_to_formation_s
    # 5 s; touched at 7 s before it formed at 8 s; never: (5 + 14 + 14) / 3.
    assert formation.mean == pytest.approx(11.0)
    assert (formation.without.k, formation.without.n, formation.horizon_s) == (2, 3, 14.0)
    assert formation.median.median is None  # less than half form
    # Arrival came before the contact: (4 + 6 + 14) / 3, and half arrive by 6 s.
    assert row.arrival_s.restricted.mean == pytest.approx(8.0)
    assert row.arrival_s.restricted.median.median == 6.0
    # Exactly half of two trials: the median is beyond the horizon, or before it.
    two = case_rows.row(told.isel(case=0, trial=[0, 2]))
    assert two.arrival_s.restricted.median.median is None


def test_the_hazard_counts_from_arrival_to_contact_or_end_and_leaves_earlier_contacts_out(told):
    hazard = case_rows.rows(told)[0].collision_hulls_per_min
    # At risk: 4 to 14 s, and 6 to 7 s, which ends in a contact.
    assert (hazard.k, hazard.excluded) == (1, 0)
    assert hazard.minutes == pytest.approx(11.0 / 60.0)
    assert hazard.rate == pytest.approx(intervals.hazard(1, 11.0 / 60.0).rate)
    told.contact[{"case": 0, "trial": 0}] = 3.0
    early = case_rows.rows(told)[0].collision_hulls_per_min
    assert (early.k, early.excluded) == (1, 1)
    assert early.minutes == pytest.approx(1.0 / 60.0)


def test_bodies_have_no_collision_of_centres_and_overturned_ones_are_counted(told):
    told.overturned[{"case": 1}] = [np.nan, 2.0, 3.0]
    particle, rigid = case_rows.rows(told)
    assert particle.collision.n == 3
    assert rigid.collision is None
    assert (particle.overturned, rigid.overturned) == (0, 2)
    assert (particle.label, rigid.label) == ("particle/gauss-markov/gps", "rigid/gauss-markov/gps")


def test_diverged_trials_count_as_such_and_nowhere_else(told):
    told.diverged[{"case": 0, "trial": 2}] = 1
    row = case_rows.rows(told)[0]
    assert row.diverged == 1
    assert row.time_to_formation_s.without.n == row.arrival_s.not_arrived.n == 2


def test_a_study_of_an_older_version_has_rows_without_what_it_does_not_tell(told):
    old = told.drop_vars(["arrival", "formation", "in_band", "contact", "overturned"])
    row = case_rows.rows(old)[0]
    assert row.arrival_s.mean is row.time_to_formation_s.mean is row.collision_hulls_per_min.rate is None
    assert row.overturned is row.collision_hulls_per_min.excluded is None
    assert row.arrival_s.not_arrived.n == row.time_to_formation_s.without.n == 0
    assert row.settling_s.mean == 11.0
