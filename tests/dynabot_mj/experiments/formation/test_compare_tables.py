from dynabot_mj import study
from dynabot_mj.experiments.formation import compare, compare_tables
from dynabot_mj.study import configuration


def test_bodies_on_a_slope_beside_point_masses_on_the_level_are_told():
    sloped = study.run(configuration.build({}, trials=1, duration=1.0, estimators=["gps"], slope=0.05))
    text = compare_tables.markdown(compare.compared(sloped))
    assert "Bodies drive on a slope of 0.05; point masses know no ground." in text


def test_tables_of_several_perceptions_tell_interactions_and_equivalence(perceptions):
    one = perceptions.isel(case=perceptions.estimator.values != "gps")
    text = compare_tables.markdown(compare.compared(one))
    assert "| decoupled | particle/gauss-markov - particle/filter |" in text
    assert "truth (gauss-markov), estimate (filter), estimate (fitted)" in text
    assert "Does the body matter more with one perception?" in text
    assert "fitted on seed 0, this very one: judge it on another." in text
