from dynabot_mj.experiments.estimators import troubles
from dynabot_mj.sensing import options


def test_every_trouble_is_allowed_and_over_in_time():
    found = troubles.every()
    assert len({one.name for one in found}) == len(found) == 18
    for one in found:
        options.check(one.options, robots=1)
        assert one.begin <= one.end <= troubles.BEGIN + troubles.LONGEST
