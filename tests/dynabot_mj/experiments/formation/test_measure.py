import numpy as np

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation.measure import FACTORS, Measure, PairedRate


def test_an_entry_says_little_where_nothing_is_special():
    told = Measure(name="some", summary=lambda case: intervals.mean([1.0]))
    assert (told.columns, told.paper_columns, told.panels, told.ranking, told.note) == ((), (), {}, None, "")
    share = PairedRate(
        name="share", title="share", summary=lambda case: intervals.rate([1.0]), values=lambda case: np.ones(1)
    )
    assert (share.rate, share.scale, share.digits) == (True, 100.0, 0)
    assert (share.tested, share.factors) == (True, FACTORS)
