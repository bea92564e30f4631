from dynabot_mj import sensor_errors
from dynabot_mj.experiments import troubles


def test_every_trouble_is_allowed_and_over_in_time():
    found = troubles.every()
    assert len({one.name for one in found}) == len(found) == 18
    for one in found:
        sensor_errors.check(one.options, robots=1)
        assert one.begin <= one.end <= troubles.BEGIN + troubles.LONGEST
