"""What goes wrong in `dynabot circle --faults`.

A frozen channel costs nothing while the vehicle's motion is as steady as on the circle, so the inertial channels freeze
a second time just before the robot begins to move.
"""

import math
from dataclasses import dataclass

from dynabot_mj.experiments.estimators import kinematic
from dynabot_mj.experiments.estimators.checks import PERIOD
from dynabot_mj.sensing.faults import Channel, Fault
from dynabot_mj.sensing.options import GpsErrors, ImuErrors, SensorOptions

BEGIN = 30.0  # of a fault, once estimators have settled and robots drive [s]
LONGEST = 10.0  # that a fault lasts [s]
_LONG, _SHORT = 5.0, 2.0  # how long others last [s]


@dataclass(frozen=True, kw_only=True)
class Trouble:
    """Something that goes wrong."""

    name: str
    options: SensorOptions
    begin: float  # from when on it is judged [s]
    end: float  # of the fault [s]
    lasts: bool = False  # to the end of the run; `end` is then from when on estimators should cope with it


def every() -> tuple[Trouble, ...]:
    """Returns all that goes wrong."""
    rest, end, bias = kinematic.REST, BEGIN + _LONG, ImuErrors(yaw_rate_bias=math.radians(2.0))
    turned, half_way = math.radians(170.0), rest + 0.5 * kinematic.SPEED / kinematic.ACCELERATION
    missing: dict[Channel, float] = {"gps_position": GpsErrors().period, "gps_velocity": GpsErrors().period}
    missing |= {"accelerometer": PERIOD, "gyro": PERIOD, "magnetometer": PERIOD}
    faults = {
        f"GPS outage, {_LONG:g} s": Fault(kind="outage", start=BEGIN, end=end),
        f"GPS jump of 15 m, {_SHORT:g} s": Fault(kind="jump", size=15.0, start=BEGIN, end=BEGIN + _SHORT),
        f"GPS jump of 15 m, {_LONG:g} s": Fault(kind="jump", size=15.0, start=BEGIN, end=end),
        f"30 % of fixes dropped, {LONGEST:g} s": Fault(
            kind="dropped", channel="gps_position", size=0.3, start=BEGIN, end=BEGIN + LONGEST
        ),
        f"GPS velocity NaN, {_LONG:g} s": Fault(kind="nan", channel="gps_velocity", start=BEGIN, end=end),
        **{
            f"one NaN, {channel.replace('_', ' ').replace('gps', 'GPS')}": _one_missing(channel, spacing)
            for channel, spacing in missing.items()
        },
        f"accelerometer frozen, {_LONG:g} s": _frozen("accelerometer", BEGIN),
        f"gyro frozen, {_LONG:g} s": _frozen("gyro", BEGIN),
        f"accelerometer frozen from rest, {_LONG:g} s": _frozen("accelerometer", rest),
        f"gyro frozen from rest, {_LONG:g} s": _frozen("gyro", rest),
        f"bearing off by 60°, {_LONG:g} s": Fault(kind="magnetic", size=math.radians(60.0), start=BEGIN, end=end),
        "starts turned by 170°, ends at rest": Fault(kind="magnetic", size=turned, end=rest - 0.5),
        "starts turned by 170°, ends in motion": Fault(kind="magnetic", size=turned, end=half_way),
    }
    return (
        *(
            Trouble(name=name, options=SensorOptions(faults=(fault,)), begin=fault.start, end=fault.end)
            for name, fault in faults.items()
        ),
        Trouble(name="gyro bias of 2°/s", options=SensorOptions(imu=bias), begin=rest, end=rest, lasts=True),
    )


def _one_missing(channel: Channel, spacing: float) -> Fault:
    """Makes the sample nearest to `BEGIN` of a channel, whose samples are some time apart, not a number."""
    at = spacing * round(BEGIN / spacing)
    return Fault(kind="nan", channel=channel, start=at - 0.5 * spacing, end=at + 0.5 * spacing)


def _frozen(channel: Channel, start: float) -> Fault:
    return Fault(kind="frozen", channel=channel, start=start, end=start + _LONG)
