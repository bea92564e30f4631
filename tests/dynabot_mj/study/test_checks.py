import pytest

from dynabot_mj.common.exceptions import InfeasibleScheduleError, InputError
from dynabot_mj.study import configuration


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("duration = 0.001", "at least the control period of perfect, 0.01 s"),
        ("[method.gps]\nuncertainty = 0.0", "positive for all others"),
        ("mass = 10.0", "mass = 10 kg given; with the rigid plant it must be the model's and its payload, 12 kg"),
        ("[field]\nneighbour_range = 4.0", "beyond the well's floor, which ends at 6.19615 m"),
        ("[field]\nspacing = 9.5", "field.neighbour_range = 10 m given"),
        ("[start]\ndistance = 100.0", "field.leader_range = 60 m given; it must reach the start"),
        ("[start]\nspacing = 0.1", "start.spacing = 0.1 m given"),
        ("[start]\nspacing = 0.7", "beyond the diagonal of a robot's footprint, 0.728 m"),
        ('plants = ["particle"]\n[vehicle]\nslope = 0.1', "with point masses alone, which know no ground"),
        (
            "[method.decoupled]\ncontrol_period = 36.0",
            "method.decoupled.control_period = 36 given, it must be at most 2",
        ),
        ("[method.gps]\nestimation_time = 5.9", "is 0.0059 meant?"),
        ("[surrogate]\ncorrelation_time = 80.0", "surrogate.correlation_time = 80 given"),
        ("[start]\ndistance = 50e3", "is 50 meant?"),
        ("[sensors.imu]\nacceleration_drift_time = 1e5", "sensors.imu.acceleration_drift_time = 100000 given"),
        ("[filter]\nvelocity_error_time = 2000.0", "is 2 meant?"),
        ("mass = 12000.0", "is 12 meant?"),
        ("mass = 0.012", "mass = 0.012 given, it must be at least 0.04 kg; is 12 meant?"),
        ("[field]\nspacing = 0.0052", "must be at least 0.0173205 m; is 5.2 meant?"),
        ("[vehicle]\npayload = 4000.0", "must be at most 100 kg; is 4 meant?"),
        ("[vehicle]\nfriction = [0.9, 0.3]", "vehicle.friction = 0.9..0.3 given, the first must not be above"),
        ("[vehicle]\ngains = 'absent'", "gains 'absent' given, it must be a gain file or one of: first, "),
        ("plants = ['particle']\n[vehicle]\ngains = 'absent'", "gains 'absent' given, it must be a gain file or"),
        ("[vehicle]\nmodel = 'absent.xml'", "absent.xml"),
        ("velocity = 'odometry'", "velocity = 'odometry' given with point masses"),
        ("perception = ['filter']\n[filter]\nimplementation = 'filterpy'", "'filterpy' given with 100 trials"),
        (
            "perception = ['filter']\n[vehicle]\nslope = 0.1",
            "vehicle.slope = 0.1 and sensors.ground.slope = 0.00785398",
        ),
        (
            "[filter]\nacceleration_density = 1e200",
            "filter.acceleration_density = 1e+200 given, it must be at most 30",
        ),
        ("[filter]\ngate = 1.5", "filter.gate = 1.5 given, it must be between 0 and 1"),
        ("[sensors.gps]\nlatency = 0.0", "sensors.gps.stamp_error = 0.03 s given, it must not exceed gps.latency, 0 s"),
        ("[[sensors.faults]]\nkind = 'outage'\nrobots = [3]", "robot 3 given, there are the robots 0 to 2"),
        ("mass = 12.0\n[vehicle]\npayload = 4.0", "it must be the model's and its payload, 16 kg"),
    ],
)
def test_what_does_not_fit_together_is_named_in_one_line(text, message):
    with pytest.raises(InputError) as error:
        configuration.load(text, "study.toml")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_infeasible_periods_are_refused():
    with pytest.raises(InfeasibleScheduleError, match="load the processor"):
        configuration.load("[method.coupled]\nsample_period = 0.05", "study.toml")
