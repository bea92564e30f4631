import json
from dataclasses import replace

import matplotlib.pyplot as plt
import pytest

from dynabot_mj import study
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.experiments.formation import case_rows, paired_tests, sensitivity
from dynabot_mj.experiments.formation.paired_tests import Paired
from dynabot_mj.figures import sensitivity as sensitivity_figure
from dynabot_mj.study import checks, configuration


def test_each_reading_changes_one_thing_and_is_allowed():
    setup = sensitivity.prepared(configuration.build({}))
    found = [one.changed(setup) for one in sensitivity.readings(setup)]
    assert found[0] == setup
    texts = [configuration.dump(one).splitlines() for one in found]
    for reading, changed, text in zip(sensitivity.readings(setup)[1:], found[1:], texts[1:], strict=True):
        checks.check(changed)
        lines = {line.split(" = ")[0] for line in set(text) ^ set(texts[0])}
        expected = {"gains 650, 300 for all": {"alpha_h", "alpha_d"}}.get(reading.name)
        assert lines == expected if expected else len(lines) == 1
    assert len({one.name for one in sensitivity.readings(setup)}) == len(found)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"plants": ("rigid",)}, "plants = rigid given"),
        ({"perception": ("filter",)}, "perception = filter given"),
        ({"estimators": ("perfect", "gps")}, "estimators = perfect, gps given"),
    ],
)
def test_it_is_of_point_masses_with_the_papers_error(changed, message):
    with pytest.raises(InputError, match=message):
        sensitivity.prepared(replace(configuration.build({}), **changed))


def test_estimators_that_cannot_be_told_apart_are_not_ranked(dataset):
    row = case_rows.rows(dataset)[0]

    def of(name, rate):
        common = replace(row.measured["completion_common"], rate=rate)
        return replace(row, estimator=name, measured={**row.measured, "completion_common": common})

    def paired(a, b, difference, p):
        return Paired(
            factor="estimator", a=f"particle/gauss-markov/{a}", b=f"particle/gauss-markov/{b}",
            metric="completion_common", difference=difference, low=None, high=None, n=100, p=p, p_holm=p,
        )  # fmt: skip

    rows = [of("gps", 0.0), of("decoupled", 0.5), of("coupled", 0.6)]

    def told(gps_decoupled, gps_coupled, decoupled_coupled):
        differences = [
            paired("gps", "decoupled", -0.5, gps_decoupled),
            paired("gps", "coupled", -0.6, gps_coupled),
            paired("decoupled", "coupled", -0.1, decoupled_coupled),
        ]
        return sensitivity.ranking("completion_common", rows, differences)

    assert told(0.01, 0.01, 0.2) == "decoupled ~ coupled < gps"
    assert told(0.01, 0.01, 0.01) == "coupled < decoupled < gps"
    # The first and the last differ, but neither from the one between them.
    assert told(0.3, 0.01, 0.3) == "gps ~ decoupled ~ coupled"
    # Means over other trials than those of the test are no order.
    against = [paired("gps", "decoupled", 0.5, 0.01), paired("gps", "coupled", 0.5, 0.01)]
    assert sensitivity.ranking("completion_common", rows, against) == "gps ~ decoupled ~ coupled"


def test_the_whole_is_told_as_tables_json_and_a_figure():
    setup = sensitivity.prepared(configuration.build({}, trials=2, duration=14.0, estimators=["decoupled", "coupled"]))
    ran = []

    def run(name, changed):
        ran.append(name)
        # Long runs are not needed here.
        return study.run(replace(changed, duration=1.0))

    found = sensitivity.examine(setup, run)
    assert ran == [one.name for one in sensitivity.readings(setup)]
    document = json.loads(json.dumps(sensitivity.document(found), allow_nan=False))
    assert [one["reading"] for one in document["readings"]] == ran
    assert set(document["readings"][0]["ranking"]) == set(sensitivity.RANKED)
    text = sensitivity.markdown(found)
    assert "nan" not in text
    assert "| tau 0.3 s" in text
    figure = sensitivity_figure.sensitivity(found)
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ran
    plt.close(figure)
    assert paired_tests.of_factor(paired_tests.paired(run("again", setup)), "estimator")
