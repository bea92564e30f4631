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
    found = case_rows.rows(told)[0].measured
    settling, arrival = found["settling_s"], found["arrival_s"]
    assert (settling.mean, settling.n, settling.hulls) == (11.0, 2, 0)
    assert (settling.unsettled.k, settling.unsettled.n) == (1, 3)
    assert (arrival.mean, arrival.n) == (5.0, 2)
    assert (arrival.not_arrived.k, arrival.not_arrived.n) == (1, 3)


def test_restricted_means_count_the_horizon_for_what_did_not_happen_or_after_a_contact(told):
    found = case_rows.rows(told)[0].measured
    formation = found["time_to_formation_s"]
    # 5 s; touched at 7 s before it formed at 8 s; never: (5 + 14 + 14) / 3.
    assert formation.mean == pytest.approx(11.0)
    assert (formation.without.k, formation.without.n, formation.horizon_s) == (2, 3, 14.0)
    assert formation.median.median is None  # less than half form
    # Arrival came before the contact: (4 + 6 + 14) / 3, and half arrive by 6 s.
    assert found["arrival_s"].restricted.mean == pytest.approx(8.0)
    assert found["arrival_s"].restricted.median.median == 6.0
    # Exactly half of two trials: the median is beyond the horizon, or before it.
    two = case_rows.row(told.isel(case=0, trial=[0, 2]))
    assert two.measured["arrival_s"].restricted.median.median is None


def test_the_hazard_counts_from_arrival_to_contact_or_end_and_leaves_earlier_contacts_out(told):
    hazard = case_rows.rows(told)[0].measured["collision_hulls_per_min"]
    # At risk: 4 to 14 s, and 6 to 7 s, which ends in a contact.
    assert (hazard.k, hazard.excluded) == (1, 0)
    assert hazard.minutes == pytest.approx(11.0 / 60.0)
    assert hazard.rate == pytest.approx(intervals.hazard(1, 11.0 / 60.0).rate)
    told.contact[{"case": 0, "trial": 0}] = 3.0
    early = case_rows.rows(told)[0].measured["collision_hulls_per_min"]
    assert (early.k, early.excluded) == (1, 1)
    assert early.minutes == pytest.approx(1.0 / 60.0)


def test_bodies_have_no_collision_of_centres_and_overturned_ones_are_counted(told):
    told.overturned[{"case": 1}] = [np.nan, 2.0, 3.0]
    particle, rigid = case_rows.rows(told)
    assert particle.measured["collision"].n == 3
    assert rigid.measured["collision"] is None
    assert (particle.overturned, rigid.overturned) == (0, 2)
    assert (particle.label, rigid.label) == ("particle/gauss-markov/gps", "rigid/gauss-markov/gps")


def test_diverged_trials_count_as_such_and_nowhere_else(told):
    told.diverged[{"case": 0, "trial": 2}] = 1
    row = case_rows.rows(told)[0]
    assert row.diverged == 1
    assert row.measured["time_to_formation_s"].without.n == row.measured["arrival_s"].not_arrived.n == 2


def test_a_study_of_an_older_version_has_rows_without_what_it_does_not_tell(told):
    old = told.drop_vars(["arrival", "formation", "in_band", "contact", "overturned"])
    row = case_rows.rows(old)[0]
    arrival, formation = row.measured["arrival_s"], row.measured["time_to_formation_s"]
    hazard = row.measured["collision_hulls_per_min"]
    assert arrival.mean is formation.mean is hazard.rate is None
    assert row.overturned is hazard.excluded is None
    assert arrival.not_arrived.n == formation.without.n == 0
    assert row.measured["settling_s"].mean == 11.0


def test_a_document_has_every_measure_under_its_own_name_between_the_case_and_what_broke(told):
    row = case_rows.rows(told)[0]
    document = case_rows.document(row)
    names = list(document)
    assert "measured" not in names
    assert names[names.index("alpha_d") + 1 : names.index("overturned")] == list(row.measured)
    assert document["arrival_s"]["not_arrived"]["k"] == 1
