import pytest

from dynabot_mj.controllers.vehicle import Vehicle


@pytest.fixture(scope="session")
def vehicle():
    """Round numbers near those of the Dynabot."""
    return Vehicle(
        mass=12.0,
        yaw_inertia=0.45,
        mass_centre_height=0.09,
        mass_centre_forward=0.0,
        wheel_inertia=0.007,
        wheel_damping=0.002,
        wheel_radius=0.1,
        track=0.42,
        wheelbase=0.34,
        length=0.5,
        breadth=0.49,
        margin=0.01,
        friction=0.75,
        resistance=0.7,
        torque_constant=0.23,
        voltage=24.0,
        torque_limit=2.0,
        servo_gain=0.5,
    )
