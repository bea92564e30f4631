from dataclasses import replace

from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import campaign, configuration, trial_chunks


def made(**options):
    return trial_chunks.chunks(campaign.single(configuration.build({}, estimators=["gps"], **options)))


def test_trials_of_each_case_are_cut_into_chunks_of_its_size(monkeypatch):
    monkeypatch.setitem(KINDS, "particle", replace(KINDS["particle"], chunk=2))
    found = made(trials=5, first_trial=3)
    particle = [(one.start, one.size) for one in found if one.label.startswith("particle")]
    assert particle == [(3, 2), (5, 2), (7, 1)]
    assert [(one.start, one.size) for one in found if one.label.startswith("rigid")] == [(3, 5)]
    # The path of the first trial alone is kept.
    assert [one.inputs["recorded"] for one in found] == [1, 0, 0, 1]


def test_work_is_weighed_by_trials_robots_and_duration():
    def weight(**options):
        return made(plants=["rigid"], **options)[0].weight

    assert weight(trials=40) > weight(trials=20)
    assert weight(trials=20, robots=5) > weight(trials=20)
    assert weight(trials=20, duration=90.0) > weight(trials=20)
    assert weight(trials=20, perception=["filter"]) > weight(trials=20)
