import numpy as np
import pytest

from dynabot_mj.experiments.formation.stages import STAGES, shares
from dynabot_mj.study import assembly, configuration, scenario


@pytest.mark.parametrize("plant", ["particle", "rigid"])
@pytest.mark.parametrize("perception", ["gauss-markov", "filter"])
def test_the_shares_are_all_there_is_and_timing_changes_nothing(plant, perception):
    setup = configuration.build({}, plants=[plant], estimators=["gps"], perception=[perception], duration=0.54)
    case = scenario.cases(setup)[0]
    parts = assembly.parts(setup, case, range(2))
    judge = assembly.judge(setup, case, parts)
    found = shares(parts, judge)
    assert list(found) == list(STAGES)
    assert sum(found.values()) == pytest.approx(1.0)
    assert min(found.values()) > 0.0
    plain = assembly.simulate(setup, case, range(2))
    np.testing.assert_array_equal(judge.outcome().final_position_w, plain.final_position_w)
