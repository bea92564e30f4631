from dataclasses import replace

import pytest

from dynabot_mj import study
from dynabot_mj.study import configuration, idle_keys


@pytest.mark.parametrize(
    ("tree", "found"),
    [
        ({}, set()),
        ({"vehicle": {"friction": 0.3}}, set()),
        (
            {"vehicle": {"friction": 0.3, "gains": "first"}, "plants": ["particle"]},
            {"vehicle.friction", "vehicle.gains"},
        ),
        # They give point masses their mass.
        ({"vehicle": {"payload": 2.0}, "plants": ["particle"]}, set()),
        ({"start": {"headings": "leader"}, "plants": ["particle"]}, {"start.headings"}),
        # Sensors are mounted on headings.
        ({"start": {"headings": "leader"}, "plants": ["particle"], "perception": ["filter"]}, set()),
        ({"sensors": {"gps": {"latency": 0.3}}}, {"sensors"}),
        ({"sensors": {"gps": {"latency": 0.3}}, "perception": ["gauss-markov", "filter"]}, set()),
        ({"surrogate": {"sigma": "per-axis"}, "perception": ["filter"]}, {"surrogate"}),
        ({"fitted": {"seed": 3}}, {"fitted"}),
        ({"perception": ["filter"], "estimators": ["perfect"]}, {"perception"}),
        ({"processor": {"utilisation": 0.9}, "estimators": ["perfect"]}, {"processor.utilisation"}),
    ],
)
def test_keys_that_are_set_and_do_nothing_are_found(tree, found):
    assert set(idle_keys.changed(configuration.build(tree))) == found


def test_what_is_said_to_do_nothing_does_nothing(short, saved):
    """The friction of point masses, and sensors of the surrogate, leave every number as it was."""
    setup = replace(short, plants=("particle",), estimators=("gps",), trials=1)
    changed = replace(
        setup,
        vehicle=replace(setup.vehicle, friction=0.3, steering="heading", sensing="truth", gains="first"),
        start=replace(setup.start, headings="leader"),
        sensors=replace(setup.sensors, gps=replace(setup.sensors.gps, latency=0.3)),
        fitted=replace(setup.fitted, seed=3),
    )
    assert len(idle_keys.changed(changed)) == 7
    one, other = study.run(setup), study.run(changed)
    for name in set(one.data_vars) - {"final_heading"}:
        assert one[name].identical(other[name]), name
